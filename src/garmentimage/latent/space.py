"""A latent space: a trained network that turns images into short vectors and back.

A space is a folder: `config.json` (what the network was made for), `encoder.onnx` and
`decoder.onnx` (channels to latent vectors and back, see `GarmentImage.to_channels`), and
`garments.npz` (the latent vectors of some training garments, with the ids of their rows).
"""

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32

from garmentimage.compare import (
    match_panels,
    pattern_faults,
)
from garmentimage.errors import DecodeError, LearnError
from garmentimage.networks import (
    CONFIG_FILE,
    DecodedGarment,
    Latent,
    bundled_names,
    damaged_file,
    decoded_garment,
    network_folder,
    open_session,
    read_config,
    run_session,
    topology_or_empty,
)
from garmentimage.pattern import Pattern
from garmentimage.raster import GarmentImage, mirrored_channels
from garmentimage.raster.decode import decode
from garmentimage.raster.encode import encode
from garmentimage.raster.repair import RepairLevel

ENCODER_FILE, DECODER_FILE, GARMENTS_FILE = "encoder.onnx", "decoder.onnx", "garments.npz"
DEFAULT_SPACE = "vae-variety"
MIN_RECONSTRUCTION_IOU = 0.85
"""Garments whose panels are reconstructed with a lower mean IoU are out of distribution."""

SYMMETRY_TOLERANCE_CM = 0.5
"""Edge vectors on the left and on the right of an even garment differ by less [cm]."""
MAX_EDGE_CM = 1000.0
"""A cell's edge is no longer on a flat panel [cm]."""
MIN_GARMENTS_PER_TYPE = 2
"""KnownGarments of each type that a space knows."""


@dataclass(frozen=True)
class KnownGarments:
    """Some garments of the training set."""

    ids: tuple[str, ...]
    types: tuple[str, ...]
    latents: Float32[np.ndarray, "n latent"]


class LatentSpace:
    """A trained network and the garments that it was trained on.

    Args:
        folder: where its files are.

    Raises:
        LearnError: they are not, or were made for other channels than this version has.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.config = read_config(self.folder, ("grid", "latent"))
        recipe, seed = self.config.get("recipe"), self.config.get("seed")
        if not isinstance(recipe, str) or type(seed) is not int or not 0 <= seed < 2**63:
            raise damaged_file(self.folder / CONFIG_FILE)
        self.is_symmetric = (
            False  # whether all its garments are as their mirror images, see `symmetrised_for`
        )

    @classmethod
    def load(cls, name: str | Path = DEFAULT_SPACE) -> "LatentSpace":
        """A space that comes with the package, by name, or one in a folder.

        Raises:
            LearnError: there is none of that name, and no such folder.
        """
        return cls(network_folder(name, space_names(), "latent space"))

    @property
    def grid(self) -> int:
        """Cells a side, N."""
        return int(self.config["grid"])

    @property
    def latent(self) -> int:
        """Numbers of a latent vector."""
        return int(self.config["latent"])

    def encode(self, source: Pattern | GarmentImage) -> Latent:
        """The latent vector of a garment.

        Raises:
            LearnError: an image of another grid, or of more than one cloth layer.
            EncodeError: a pattern that does not fit the grid.
        """
        return self.encode_channels(self.image(source).to_channels()[None])[0]

    def image(self, source: Pattern | GarmentImage) -> GarmentImage:
        """A garment as this network sees it.

        Raises:
            LearnError: an image of another grid, of more than one cloth layer, or of no garment.
            EncodeError: a pattern that does not fit the grid.
        """
        if not isinstance(source, Pattern | GarmentImage):
            raise TypeError(
                f"wanted a Pattern or a GarmentImage, not a value of type {type(source).__name__}; "
                "load_pattern(path) and load_image(path) read them"
            )
        image = encode(source, self.grid) if isinstance(source, Pattern) else source
        if image.grid != self.grid or image.layers != 2:
            raise LearnError(
                f"an image of {image.layers} layers of {image.grid} x {image.grid} cells; this "
                f"network takes 2 of {self.grid} x {self.grid}"
            )
        if not image.inside.any():
            raise LearnError("an image without a cell of cloth; give one of a garment")
        if np.abs(image.deformation).max() > MAX_EDGE_CM:
            raise LearnError(
                f"an image with an edge vector of more than {MAX_EDGE_CM:g} cm; give it in cm"
            )
        return image

    def encode_channels(
        self, channels: Float32[np.ndarray, "n 34 row col"]
    ) -> Float32[np.ndarray, "n latent"]:
        """Latent vectors of images."""
        return run_session(self._encoder, self.folder / ENCODER_FILE, channels)

    def decode_channels(
        self, z: Float32[np.ndarray, "n latent"]
    ) -> Float32[np.ndarray, "n 34 row col"]:
        """Images of latent vectors: probabilities, and vectors in cm, not repaired."""
        channels = run_session(self._decoder, self.folder / DECODER_FILE, z)
        return (channels + mirrored_channels(channels)) / 2 if self.is_symmetric else channels

    def symmetrised_for(self, image: GarmentImage) -> "LatentSpace":
        """The same space, in which what comes of an even garment is even.

        Even is what is as its mirror image: there each image that the network gives and its mirror
        image are averaged.
        """
        channels = image.to_channels()[None]
        found = copy(self)
        found.is_symmetric = bool(
            np.abs(channels - mirrored_channels(channels)).max() < SYMMETRY_TOLERANCE_CM
        )
        return found

    def reproject(self, z: Latent, times: int) -> Latent:
        """Where a point ends that is decoded and encoded again so many times, 0 or more.

        Each time brings it nearer to garments that the network knows: what does not go together
        in its image is not seen by the encoder.
        """
        for _ in range(times):
            z = self.encode_channels(self.decode_channels(z[None]))[0]
        return z

    def decode(self, z: Latent, *, repair_level: RepairLevel = "full") -> DecodedGarment:
        """The garment at a point of the space, repaired, decoded and checked.

        Raises:
            LearnError: a latent vector of another size, or with a number that is none.
        """
        if np.shape(z) != (self.latent,) or not np.isfinite(z).all():
            raise LearnError(
                f"a latent vector of shape {np.shape(z)}; this network's are {self.latent} numbers"
            )
        return decoded_garment(z, self.decode_channels(z[None])[0], repair_level)

    def locate(self, source: Pattern | GarmentImage) -> DecodedGarment:
        """A garment as it is, where the network sees it.

        Raises:
            LearnError: an image that this network does not take, or that is no garment.
        """
        image = self.image(source)
        try:
            pattern = source if isinstance(source, Pattern) else decode(image)
        except DecodeError as error:
            raise LearnError(f"no garment can be read from the image: {error}") from None
        return DecodedGarment(
            self.encode(image), image, None, pattern, tuple(pattern_faults(pattern))
        )

    def out_of_distribution(self, given: DecodedGarment) -> str:
        """How a garment comes back otherwise than it was; empty where it does not.

        A network has seen little that is like a garment that comes back with other seams, or with
        panels whose mean IoU is below `MIN_RECONSTRUCTION_IOU`.
        """
        assert given.pattern is not None  # `given` has one
        again = self.decode(given.z).pattern
        if again is None:
            return "it comes back as no garment"
        count, before = len(again.panels), len(given.pattern.panels)
        if topology_or_empty(again) != topology_or_empty(given.pattern):
            panels = f", as {count} panels of its {before}" if count != before else ""
            return f"it comes back with other seams{panels}"
        overlap = match_panels(given.pattern, again).mean_iou
        return (
            f"its panels come back with an IoU of {overlap:.2f}"
            if overlap < MIN_RECONSTRUCTION_IOU
            else ""
        )

    @cached_property
    def garments(self) -> KnownGarments:
        """Some garments that it was trained on."""
        try:
            with np.load(self.folder / GARMENTS_FILE, allow_pickle=False) as file:
                ids, types, latents = (file[name] for name in ("ids", "types", "latents"))
            found = KnownGarments(
                tuple(ids.tolist()), tuple(types.tolist()), latents.astype(np.float32)
            )
        except Exception as error:  # zipfile, zlib and numpy each have their own.
            raise damaged_file(self.folder / GARMENTS_FILE) from error
        count = len(found.ids)
        if (
            found.latents.shape != (count, self.latent)
            or len(found.types) != count
            or not all(isinstance(each, str) for each in (*found.ids, *found.types))
            or not np.isfinite(found.latents).all()
            or any(found.types.count(name) < MIN_GARMENTS_PER_TYPE for name in set(found.types))
            or not count
        ):
            raise damaged_file(self.folder / GARMENTS_FILE)
        return found

    @cached_property
    def _encoder(self) -> Any:
        sizes = {"channels": [34, self.grid, self.grid], "z": [self.latent]}
        return open_session(self.folder / ENCODER_FILE, sizes)

    @cached_property
    def _decoder(self) -> Any:
        sizes = {"z": [self.latent], "channels": [34, self.grid, self.grid]}
        return open_session(self.folder / DECODER_FILE, sizes)


def space_names() -> tuple[str, ...]:
    """Names of the latent spaces that come with the package."""
    return bundled_names(DECODER_FILE)
