"""A latent space: a trained network that turns images into short vectors and back.

A space is a folder: `config.json` (what the network was made for), `encoder.onnx` and
`decoder.onnx` (channels to latent vectors and back, see `GarmentImage.to_channels`), and
`garments.npz` (the latent vectors of some training garments, with the ids of their rows).
"""

import json
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32

from garmentimage.compare.matching import match_panels
from garmentimage.compare.stitch_graph import stitch_graph
from garmentimage.compare.topology import topology_word
from garmentimage.compare.validity import structure_faults, validity
from garmentimage.draft.parameters import near
from garmentimage.errors import DecodeError, GarmentImageError, LearnError, quoted
from garmentimage.files import shown_path
from garmentimage.pattern.model import Pattern
from garmentimage.raster.decode import decode
from garmentimage.raster.encode import encode
from garmentimage.raster.image import CHANNEL_CONTRACT, GarmentImage, mirrored_channels
from garmentimage.raster.repair import RepairLevel, RepairReport, repair

SHIPPED = Path(str(files("garmentimage") / "weights"))
"""Where networks lie that come with the package."""
CONFIG, ENCODER, DECODER, GARMENTS = "config.json", "encoder.onnx", "decoder.onnx", "garments.npz"
DEFAULT = "vae-variety"
LIKE_IOU = 0.85
"""Garments whose panels come back with an IoU below this are unlike those that were trained on."""

EVEN_CM = 0.5
"""Edge vectors on the left and on the right of an even garment differ by less [cm]."""
LONGEST_CM = 1000.0
"""A cell's edge is no longer on a flat panel [cm]."""
MOST = 1e6
"""No number of a network's is as large."""
FEWEST = 2
"""Garments of each type that a space knows."""

Latent = Float32[np.ndarray, "latent"]


@dataclass(frozen=True)
class Garments:
    """Some garments of the training set."""

    ids: tuple[str, ...]
    types: tuple[str, ...]
    latents: Float32[np.ndarray, "n latent"]


@dataclass(frozen=True)
class Step:
    """A point of a latent space, and what garment it is."""

    z: Latent
    image: GarmentImage | None
    """Repaired; None where the network makes no images."""
    repairs: RepairReport | None
    pattern: Pattern | None
    """None where no garment can be read from the image."""
    faults: tuple[str, ...]
    """Why it cannot be cut and sewn; empty where it can."""


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
            raise damaged(self.folder / CONFIG)
        self.is_even = False  # whether all its garments are as their mirror images, see `fit_for`

    @classmethod
    def load(cls, name: str | Path = DEFAULT) -> "LatentSpace":
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
        if np.abs(image.deformation).max() > LONGEST_CM:
            raise LearnError(
                f"an image with an edge vector of more than {LONGEST_CM:g} cm; give it in cm"
            )
        return image

    def encode_channels(
        self, channels: Float32[np.ndarray, "n 34 row col"]
    ) -> Float32[np.ndarray, "n latent"]:
        """Latent vectors of images."""
        return run_session(self._encoder, self.folder / ENCODER, channels)

    def decode_channels(
        self, z: Float32[np.ndarray, "n latent"]
    ) -> Float32[np.ndarray, "n 34 row col"]:
        """Images of latent vectors: probabilities, and vectors in cm, not repaired."""
        channels = run_session(self._decoder, self.folder / DECODER, z)
        return (channels + mirrored_channels(channels)) / 2 if self.is_even else channels

    def fit_for(self, image: GarmentImage) -> "LatentSpace":
        """The same space, in which what comes of an even garment is even.

        Even is what is as its mirror image: there each image that the network gives and its mirror
        image are averaged.
        """
        channels = image.to_channels()[None]
        found = copy(self)
        found.is_even = bool(np.abs(channels - mirrored_channels(channels)).max() < EVEN_CM)
        return found

    def settled(self, z: Latent, times: int) -> Latent:
        """Where a point ends that is decoded and encoded again so many times, 0 or more.

        Each time brings it nearer to garments that the network knows: what does not go together
        in its image is not seen by the encoder.
        """
        for _ in range(times):
            z = self.encode_channels(self.decode_channels(z[None]))[0]
        return z

    def step(self, z: Latent, *, repair_level: RepairLevel = "full") -> Step:
        """The garment at a point of the space, repaired, decoded and checked.

        Raises:
            LearnError: a latent vector of another size, or with a number that is none.
        """
        if np.shape(z) != (self.latent,) or not np.isfinite(z).all():
            raise LearnError(
                f"a latent vector of shape {np.shape(z)}; this network's are {self.latent} numbers"
            )
        return step_of(z, self.decode_channels(z[None])[0], repair_level)

    def given(self, source: Pattern | GarmentImage) -> Step:
        """A garment as it is, where the network sees it.

        Raises:
            LearnError: an image that this network does not take, or that is no garment.
        """
        image = self.image(source)
        try:
            pattern = source if isinstance(source, Pattern) else decode(image)
        except DecodeError as error:
            raise LearnError(f"no garment can be read from the image: {error}") from None
        return Step(self.encode(image), image, None, pattern, tuple(validity(pattern)))

    def unlike(self, given: Step) -> str:
        """How a garment comes back otherwise than it was; empty where it does not.

        A network has seen little that is like a garment that comes back with other seams, or with
        panels whose mean IoU is below `LIKE_IOU`.
        """
        assert given.pattern is not None  # `given` has one
        again = self.step(given.z).pattern
        if again is None:
            return "it comes back as no garment"
        count, before = len(again.panels), len(given.pattern.panels)
        if topology_of(again) != topology_of(given.pattern):
            panels = f", as {count} panels of its {before}" if count != before else ""
            return f"it comes back with other seams{panels}"
        overlap = match_panels(given.pattern, again).mean_iou
        return f"its panels come back with an IoU of {overlap:.2f}" if overlap < LIKE_IOU else ""

    @cached_property
    def garments(self) -> Garments:
        """Some garments that it was trained on."""
        try:
            with np.load(self.folder / GARMENTS, allow_pickle=False) as file:
                ids, types, latents = (file[name] for name in ("ids", "types", "latents"))
            found = Garments(tuple(ids.tolist()), tuple(types.tolist()), latents.astype(np.float32))
        except Exception as error:  # zipfile, zlib and numpy each have their own.
            raise damaged(self.folder / GARMENTS) from error
        count = len(found.ids)
        if (
            found.latents.shape != (count, self.latent)
            or len(found.types) != count
            or not all(isinstance(each, str) for each in (*found.ids, *found.types))
            or not np.isfinite(found.latents).all()
            or any(found.types.count(name) < FEWEST for name in set(found.types))
            or not count
        ):
            raise damaged(self.folder / GARMENTS)
        return found

    @cached_property
    def _encoder(self) -> Any:
        sizes = {"channels": [34, self.grid, self.grid], "z": [self.latent]}
        return open_session(self.folder / ENCODER, sizes)

    @cached_property
    def _decoder(self) -> Any:
        sizes = {"z": [self.latent], "channels": [34, self.grid, self.grid]}
        return open_session(self.folder / DECODER, sizes)


def step_of(
    z: Latent, channels: Float32[np.ndarray, "34 row col"], repair_level: RepairLevel
) -> Step:
    """The garment of an image that need not be a garment, repaired, decoded and checked.

    Args:
        z: its latent vector, if it has one.
        channels: its flags and edge types as shares.
        repair_level: how much of it is mended.
    """
    image, repairs = repair(channels, level=repair_level, kind="shares")
    try:
        pattern = decode(image, repair=repair_level)
    except GarmentImageError as error:
        return Step(z, image, repairs, None, (str(error),))
    return Step(z, image, repairs, pattern, tuple(validity(pattern)))


def topology_of(pattern: Pattern) -> str:
    """See `topology_word`; empty where panels or stitches are at fault."""
    return "" if structure_faults(pattern) else topology_word(stitch_graph(pattern))


def space_names() -> tuple[str, ...]:
    """Names of the latent spaces that come with the package."""
    return shipped_names(DECODER)


def shipped_names(file: str) -> tuple[str, ...]:
    """Names of the networks that come with the package and have this file."""
    return tuple(sorted(found.parent.name for found in SHIPPED.glob(f"*/{file}")))


def network_folder(name: str | Path, known: Sequence[str], what: str) -> Path:
    """Where a network is that comes with the package, by name, or one in a folder.

    Raises:
        LearnError: there is none of that name, and no such folder.
    """
    if str(name) in known:
        return SHIPPED / str(name)
    try:
        is_folder = Path(name).is_dir()
    except (OSError, ValueError):  # a name that no file can have
        is_folder = False
    if is_folder:
        return Path(name)
    ways = f"{near(str(name), known)}, or " if known else ""
    raise LearnError(f"there is no {what} {quoted(str(name))}; {ways}name the folder of one")


def check_contract(config: Mapping[str, Any], where: str | Path) -> None:
    """Refuse a network that was made for other channels than this version has.

    Raises:
        LearnError: says so.
    """
    found = config.get("channels_contract")
    if found != CHANNEL_CONTRACT:
        raise LearnError(
            f"{shown_path(where)}: was made for channels {quoted(str(found))}, and this version "
            f"has {CHANNEL_CONTRACT!r}; train it again, or use the version that it came with"
        )


def read_config(folder: Path, sizes: Sequence[str]) -> dict[str, Any]:
    """What a network in a folder was made for.

    Args:
        folder: the network.
        sizes: names of whole numbers that its configuration must have.

    Raises:
        LearnError: there is none, or it was made for other channels than this version has.
    """
    file = folder / CONFIG
    try:
        config = json.loads(file.read_text(encoding="utf-8"))
        numbers: Sequence[Any] = [config[name] for name in sizes]
        if not all(type(n) is int and 1 <= n <= 4096 for n in numbers):
            raise ValueError
    except FileNotFoundError:
        raise LearnError(
            f"{shown_path(folder)}: holds no trained network (there is no {CONFIG})"
        ) from None
    except OSError as error:
        raise LearnError(f"{shown_path(file)}: cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise damaged(file) from None
    check_contract(config, file)
    return config


def open_session(file: Path, sizes: Mapping[str, Sequence[int]]) -> Any:
    """The network in a file, to be run on one core.

    Args:
        file: ONNX.
        sizes: by name, the shape of an example of what it takes, and then of what it gives.

    Raises:
        LearnError: the file cannot be read, or holds no network of these sizes.
    """
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        raw = file.read_bytes()
        if b"location" in raw:  # the word by which weights in other files are named
            raise ValueError
        session = onnxruntime.InferenceSession(raw, options, providers=["CPUExecutionProvider"])
        takes, gives = session.get_inputs(), session.get_outputs()
        if [each.name for each in (*takes, *gives)] != list(sizes):
            raise ValueError
        if not all(_is_of(each, sizes[each.name]) for each in (*takes, *gives)):
            raise ValueError
        return session
    except OSError as error:
        raise LearnError(f"{shown_path(file)}: cannot be read ({error.strerror})") from None
    except Exception as error:  # onnxruntime has no base class of its own for its errors.
        raise damaged(file) from error


def _is_of(found: Any, size: Sequence[int]) -> bool:
    """Whether an input or output takes any number of examples of a size."""
    count, *rest = found.shape
    return (
        found.type == "tensor(float)"
        and type(count) is not int
        and len(rest) == len(size)
        and all(type(n) is not int or n == m for n, m in zip(rest, size))
    )


def run_session(session: Any, file: Path, given: np.ndarray) -> np.ndarray:
    """What a network of one input and one output gives.

    Raises:
        LearnError: it fails, or gives what are no numbers.
    """
    (takes,), (gives,) = session.get_inputs(), session.get_outputs()
    try:
        (found,) = session.run(None, {takes.name: np.asarray(given, np.float32)})
    except Exception as error:  # onnxruntime has no base class of its own for its errors.
        raise damaged(file) from error
    is_whole = found.shape[:1] == given.shape[:1] and found.ndim == len(gives.shape)
    if not is_whole or not np.abs(found).max(initial=0) < MOST:
        raise damaged(file)
    return np.asarray(found)


def damaged(file: Path) -> LearnError:
    """The error of a network's file that does not hold what it should."""
    return LearnError(f"{shown_path(file)}: is damaged, or none of ours; get it again")
