"""A trained cascade in use: a picture to a GarmentImage, and that to a pattern.

A network is a folder: `config.json` (what it was made for, and where it saw the wearer),
`predictor.onnx` (pictures to channels, see `GarmentImage.to_channels`) and `pictures.npz` (what the
pictures that it was trained on have in common, to tell others from them).
"""

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, Float32, UInt8

from garmentimage.networks import (
    DecodedGarment,
    bundled_names,
    damaged_file,
    decoded_garment,
    network_folder,
    open_session,
    read_config,
    run_session,
)
from garmentimage.predict.photo import EMPTY, Box, Photo, as_photo, frame_photo
from garmentimage.raster import split_channels
from garmentimage.raster.repair import RepairLevel

if TYPE_CHECKING:
    from PIL.Image import Image

PREDICTOR_FILE, PICTURES_FILE = "predictor.onnx", "pictures.npz"
DEFAULT_NETWORK = "image-wide"
THUMBNAIL_PIXELS = 32
"""Pixels a side at which pictures are compared."""
MIN_CONFIDENCE = 0.5
"""A confidence below this is low."""
OOD_THRESHOLD_LIMITS = 1e-4, 1.0
"""Least and most that pictures in training may be apart from what they have in common."""


@dataclass(frozen=True)
class Prediction:
    """What a network makes of a picture."""

    photo: Photo
    """As the network saw it."""
    channels: Float32[np.ndarray, "34 row col"]
    """Probabilities, and vectors in cm, not repaired."""
    garment: DecodedGarment
    """The garment, repaired, decoded and checked; it has no latent vector."""
    confidence: float
    """From 0 to 1: how sure the network is of flags and edge types; less where the picture is
    unlike those that it was trained on, 0 where it shows nothing."""

    @property
    def doubts(self) -> Float[np.ndarray, "layer row col"]:
        """How unsure the network is of each cell, see `uncertainty_of`."""
        return uncertainty_of(self.channels)

    @property
    def is_sure(self) -> bool:
        """Whether the confidence is not low.

        What cannot be sewn is told by `step.faults`, what cannot be worn by draping the pattern.
        """
        return self.confidence >= MIN_CONFIDENCE


class PatternPredictor:
    """A trained cascade.

    Args:
        folder: where its files are.

    Raises:
        LearnError: they are not, or were made for other channels than this version has.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.config = read_config(self.folder, ("grid", "picture"))
        try:
            self.box = Box(**self.config["wearer"])
        except (KeyError, TypeError, ValueError):
            raise damaged_file(self.folder / "config.json") from None

    @classmethod
    def load(cls, name: str | Path = DEFAULT_NETWORK) -> "PatternPredictor":
        """A network that comes with the package, by name, or one in a folder.

        Raises:
            LearnError: there is none of that name, and no such folder.
        """
        return cls(network_folder(name, predictor_names(), "network"))

    @property
    def size(self) -> int:
        """Pixels a side of the pictures that it takes."""
        return int(self.config["picture"])

    def predict(
        self,
        picture: "str | PathLike[str] | UInt8[np.ndarray, 'row col 3'] | Image | Photo",
        *,
        repair_level: RepairLevel = "full",
    ) -> Prediction:
        """The pattern of the garment in a picture.

        Args:
            picture: a file, 8-bit RGB pixels with the highest row first, or an image of Pillow's.
            repair_level: of what the network gives.

        Raises:
            LearnError: it is no picture that will do.
            TypeError: it is of another type, or the pixels are.
        """
        seen = frame_photo(as_photo(picture), self.box, self.size)
        channels = self.channels(seen.pixels[None])[0]
        step = decoded_garment(np.zeros(0, np.float32), channels, repair_level)
        is_empty = EMPTY in seen.notes
        sure = 0.0 if is_empty else certainty(channels) * self.likeness(seen.pixels)
        return Prediction(seen, channels, step, sure)

    def channels(
        self, pixels: UInt8[np.ndarray, "n row col 3"]
    ) -> Float32[np.ndarray, "n 34 row col"]:
        """Images of pictures that are framed already."""
        upward = pixels[:, ::-1].transpose(0, 3, 1, 2)
        seen = np.ascontiguousarray(upward, np.float32) / 255
        return run_session(self._network, self.folder / PREDICTOR_FILE, seen)

    def likeness(self, pixels: UInt8[np.ndarray, "row col 3"]) -> float:
        """How like those that it was trained on a picture is, from 0 to 1.

        It falls with every distance, as that of a wearer who is turned may still be usual: 1 for a
        picture without any, .61 for one that only one in a hundred of training exceeds.
        """
        known = self._pictures
        apart = plane_distance(thumbnail(pixels), known["middle"], known["axes"])
        return float(np.exp(-((apart / float(known["usual"])) ** 2) / 2))

    @cached_property
    def _network(self) -> Any:
        grid = int(self.config["grid"])
        sizes = {"picture": [3, self.size, self.size], "channels": [34, grid, grid]}
        return open_session(self.folder / PREDICTOR_FILE, sizes)

    @cached_property
    def _pictures(self) -> dict[str, np.ndarray]:
        try:
            with np.load(self.folder / PICTURES_FILE, allow_pickle=False) as file:
                known = {name: file[name].astype(float) for name in ("middle", "axes", "usual")}
        except Exception as error:  # zipfile, zlib and numpy each have their own.
            raise damaged_file(self.folder / PICTURES_FILE) from error
        numbers = 3 * THUMBNAIL_PIXELS**2
        if (
            known["middle"].shape != (numbers,)
            or known["axes"].shape[1:] != (numbers,)
            or known["usual"].shape != ()
            or not all(np.isfinite(each).all() for each in known.values())
            or not OOD_THRESHOLD_LIMITS[0] <= known["usual"] <= OOD_THRESHOLD_LIMITS[1]
        ):
            raise damaged_file(self.folder / PICTURES_FILE)
        return known


def certainty(channels: Float32[np.ndarray, "34 row col"]) -> float:
    """How sure a network is where there is cloth: the mean share of its first choices.

    Of the flags of all cells that may be inside, and of the types of their grid edges; 1 is sure.
    """
    flags, types, maybe = _shares(channels)
    return float(flags[maybe].mean() * types[maybe].mean()) if maybe.any() else 0.0


def uncertainty_of(
    channels: Float32[np.ndarray, "34 row col"],
) -> Float[np.ndarray, "layer row col"]:
    """How unsure a network is of each cell: 0 sure, 1 it may be anything.

    Of its flag and, where it may be inside, of the types of its bottom and left grid edges.
    """
    flags, types, maybe = _shares(channels)
    return 1 - flags * np.where(maybe, types, 1.0)


def _shares(
    channels: Float32[np.ndarray, "34 row col"],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each cell how sure its flag is, and its edge types, and whether it may be inside."""
    inside, types, _ = split_channels(channels)
    return np.abs(2 * inside - 1), types.max(axis=2).mean(axis=1), inside > 0.05


def thumbnail(pixels: UInt8[np.ndarray, "row col 3"]) -> Float[np.ndarray, " number"]:
    """A picture as few numbers from 0 to 1."""
    from PIL import Image

    small = Image.fromarray(pixels).resize(
        (THUMBNAIL_PIXELS, THUMBNAIL_PIXELS), Image.Resampling.BOX
    )
    return np.asarray(small, float).ravel() / 255


def plane_distance(
    numbers: Float[np.ndarray, " number"],
    middle: Float[np.ndarray, " number"],
    axes: Float[np.ndarray, "axis number"],
) -> float:
    """Distance of a picture from the plane through many others (root mean square)."""
    rest = numbers - middle
    rest = rest - (axes @ rest) @ axes
    return float(np.sqrt((rest**2).mean()))


def predictor_names() -> tuple[str, ...]:
    """Names of the cascades that come with the package."""
    return bundled_names(PREDICTOR_FILE)
