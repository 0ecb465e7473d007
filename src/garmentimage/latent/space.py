"""A latent space: a trained VAE between GarmentImages and short vectors.

A space is a folder: `config.json` (sizes and training data), `encoder.onnx` and `decoder.onnx`
(channels to latent vectors and back, see `GarmentImage.to_channels`), and `garments.npz` (latent
vectors of some training garments, with the ids of their rows).
"""

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from garmentimage.compare import match_panels, pattern_faults
from garmentimage.errors import DecodeError, LearnError
from garmentimage.networks import (
    CONFIG_FILE,
    LATENT_CONTRACTS,
    DecodedGarment,
    Latent,
    OnnxNetwork,
    bundled_names,
    channel_layout,
    damaged_file,
    decoded_garment,
    network_folder,
    read_arrays,
    read_config,
    topology_or_empty,
)
from garmentimage.pattern import Pattern
from garmentimage.raster import (
    CONTRACTS,
    PLAIN_LAYOUT,
    Contract,
    GarmentImage,
    mirrored_channels,
)
from garmentimage.raster.decode import decode
from garmentimage.raster.encode import encode
from garmentimage.raster.repair import RepairLevel
from garmentimage.system import shown_path

ENCODER_FILE, DECODER_FILE, GARMENTS_FILE = "encoder.onnx", "decoder.onnx", "garments.npz"
DEFAULT_SPACE = "vae-variety"
MIN_RECONSTRUCTION_IOU = 0.85
"""Garments whose panels are reconstructed with a lower mean IoU are out of distribution."""

SYMMETRY_TOLERANCE_CM = 0.5
"""An image is symmetric where its edge vectors differ by less from its mirror image's [cm]."""
MAX_EDGE_CM = 1000.0
"""Longest edge vector of a cell that is accepted [cm]."""
MIN_GARMENTS_PER_TYPE = 2
"""Fewest stored garments of each type: a normal distribution needs two."""


@dataclass(frozen=True)
class KnownGarments:
    """Some garments of the training set."""

    ids: tuple[str, ...]
    """Of their rows in the dataset."""
    types: tuple[str, ...]
    """Garment types."""
    latents: Float32[np.ndarray, "n latent"]
    """Means of the encoder's posterior."""


class LatentSpace:
    """A trained VAE, and some of its training garments.

    Args:
        folder: of its files.

    Raises:
        LearnError: a file is missing or damaged, or was made for another channel layout.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.config = read_config(self.folder, ("grid", "latent"), LATENT_CONTRACTS)
        try:
            self.layout = channel_layout(
                self.config["channels_contract"], self.config.get("layers", PLAIN_LAYOUT.layers)
            )
        except LearnError as error:
            raise LearnError(f"{shown_path(self.folder / CONFIG_FILE)}: {error}") from None
        recipe, seed = self.config.get("recipe"), self.config.get("seed")
        if not isinstance(recipe, str) or type(seed) is not int or not 0 <= seed < 2**63:
            raise damaged_file(self.folder / CONFIG_FILE)
        self.is_symmetric = False  # whether decoded images are symmetrised, see `symmetrised_for`
        size = [self.layout.channels, self.grid, self.grid]
        channels, z = ("channels", size), ("z", [self.latent])
        self._encoder = OnnxNetwork(self.folder / ENCODER_FILE, dict([channels, z]))
        self._decoder = OnnxNetwork(self.folder / DECODER_FILE, dict([z, channels]))

    @classmethod
    def load(cls, name: str | Path = DEFAULT_SPACE) -> "LatentSpace":
        """A bundled space, by name, or one in a folder.

        Raises:
            LearnError: there is no bundled space of that name, and no such folder.
        """
        return cls(network_folder(name, space_names(), "latent space"))

    @property
    def grid(self) -> int:
        """Cells a side, N."""
        return int(self.config["grid"])

    @property
    def latent(self) -> int:
        """Length of a latent vector."""
        return int(self.config["latent"])

    def encode(self, source: Pattern | GarmentImage) -> Latent:
        """The latent vector of a garment.

        Raises:
            LearnError: an image that this network does not take, see `image`.
            EncodeError: a pattern that does not fit the grid.
        """
        z: Latent = self.encode_channels(self.channels(self.image(source))[None])[0]
        return z

    def channels(self, image: GarmentImage) -> Float32[np.ndarray, "channel row col"]:
        """Channels of an image that `image` checked, as input of this network.

        Garments with fewer layers than the network has get empty ones.
        """
        number: Contract = 1 if self.layout.contract == CONTRACTS[1] else 2
        return image.to_channels(number, layers=self.layout.layers)

    def image(self, source: Pattern | GarmentImage) -> GarmentImage:
        """The image of a garment, checked as input of this network.

        For a network of contract 1, panels that wrap round the body are cut in a front and a back
        part, as it knows them.

        Raises:
            LearnError: an image of another grid, of more layers than the network has, without
                cloth, or, for a network of contract 1, with turned panels or creases.
            EncodeError: a pattern that does not fit the grid.
        """
        if not isinstance(source, Pattern | GarmentImage):
            raise TypeError(
                f"wanted a Pattern or a GarmentImage, not a value of type {type(source).__name__}; "
                "load_pattern(path) and load_image(path) read them"
            )
        image = encode(source, self.grid) if isinstance(source, Pattern) else source
        layers = self.layout.layers
        if image.grid == self.grid and image.layers > layers:
            raise LearnError(
                f"the garment has a second sheet of cloth ({image.layers} layers) and the network "
                f"{layers} layers: train one with --contract 2 --layers {image.layers}"
            )
        if image.grid != self.grid or image.layers < 2:
            raise LearnError(
                f"an image of {image.layers} layers of {image.grid} x {image.grid} cells; this "
                f"network takes {layers} of {self.grid} x {self.grid}"
            )
        if not image.inside.any():
            raise LearnError("an image without a cell of cloth; give one of a garment")
        if np.abs(image.deformation).max() > MAX_EDGE_CM:
            raise LearnError(
                f"an image with an edge vector of more than {MAX_EDGE_CM:g} cm; give it in cm"
            )
        if self.layout.contract != CONTRACTS[1]:
            return image
        if image.turned.any():
            raise LearnError(
                "a garment with panels that are sewn right side to wrong side, as collars and "
                "lapels are; this network was trained on none: train one with --contract 2"
            )
        image = image.cut_at_wraps()
        if image.contract != 1:
            raise LearnError(
                "a garment with pressed pleats; this network was trained on none: train one with "
                "--contract 2"
            )
        return image

    def encode_channels(
        self, channels: Float32[np.ndarray, "n channel row col"]
    ) -> Float32[np.ndarray, "n latent"]:
        """Latent vectors of images: means of the encoder's posterior."""
        return self._encoder(channels)

    def decode_channels(
        self, z: Float32[np.ndarray, "n latent"]
    ) -> Float32[np.ndarray, "n channel row col"]:
        """Channels of latent vectors: probabilities, and vectors in cm, not repaired."""
        channels = self._decoder(z)
        return (channels + mirrored_channels(channels)) / 2 if self.is_symmetric else channels

    def symmetrised_for(self, image: GarmentImage) -> "LatentSpace":
        """The same space, whose decoded images are symmetric if this image is.

        Decoded images are then averaged with their mirror images.
        """
        channels = self.channels(self.image(image))[None]
        found = copy(self)
        found.is_symmetric = bool(
            np.abs(channels - mirrored_channels(channels)).max() < SYMMETRY_TOLERANCE_CM
        )
        return found

    def reproject(self, z: Latent, times: int) -> Latent:
        """Project a latent vector onto the garments of the network, by decoding and encoding it.

        Each time brings it nearer to the training garments: inconsistencies of the decoded image
        are lost in the encoder.

        Args:
            z: the latent vector.
            times: how often, 0 or more.
        """
        for _ in range(times):
            z = self.encode_channels(self.decode_channels(z[None]))[0]
        return z

    def decode(self, z: Latent, *, repair_level: RepairLevel = "full") -> DecodedGarment:
        """The garment of a latent vector, repaired, decoded and checked.

        Args:
            z: the latent vector.
            repair_level: how much of the decoded image is repaired.

        Raises:
            LearnError: a latent vector of another length, or with NaN or infinite values.
        """
        if np.shape(z) != (self.latent,) or not np.isfinite(z).all():
            raise LearnError(
                f"a latent vector of shape {np.shape(z)}; this network's are {self.latent} numbers"
            )
        return decoded_garment(z, self.decode_channels(z[None])[0], repair_level)

    def locate(self, source: Pattern | GarmentImage) -> DecodedGarment:
        """A garment unchanged, with its latent vector.

        Raises:
            LearnError: an image that this network does not take, or that cannot be decoded.
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
        """How a garment's reconstruction differs from it; empty where it does not.

        Garments that are reconstructed with other seams, or with a mean IoU of panels below
        `MIN_RECONSTRUCTION_IOU`, are unlike the training set.
        """
        assert given.pattern is not None  # `locate` sets it
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
        """Some of its training garments."""
        file = self.folder / GARMENTS_FILE
        ids, types, latents = read_arrays(file, ids="U", types="U", latents="f")
        if (
            latents.shape != (ids.size, self.latent)
            or not ids.shape == types.shape == (ids.size,)
            or not ids.size
            or not np.isfinite(latents).all()
            or np.unique(types, return_counts=True)[1].min() < MIN_GARMENTS_PER_TYPE
        ):
            raise damaged_file(file)
        return KnownGarments(tuple(ids.tolist()), tuple(types.tolist()), latents.astype(np.float32))


def space_names() -> tuple[str, ...]:
    """Names of the bundled latent spaces."""
    return bundled_names(DECODER_FILE)
