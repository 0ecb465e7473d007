"""A trained cascade in use: a picture to a GarmentImage, and that to a pattern.

A network is a folder: `config.json` (sizes, and the wearer's bounding box in training images),
`predictor.onnx` (pictures to channels, see `GarmentImage.to_channels`) and `pictures.npz` (the
distribution of training images, to detect pictures outside it: `middle`, their mean, `axes`, their
principal axes, and `usual`, the distance threshold).
"""

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Float32, UInt8

from garmentimage.errors import LearnError
from garmentimage.networks import (
    CONFIG_FILE,
    DecodedGarment,
    OnnxNetwork,
    bundled_names,
    damaged_file,
    decoded_garment,
    network_folder,
    read_arrays,
    read_config,
)
from garmentimage.predict.photo import EMPTY, Box, Photo, as_photo, frame_photo
from garmentimage.raster import split_channels
from garmentimage.raster.repair import RepairLevel
from garmentimage.system import shown_path

if TYPE_CHECKING:
    from PIL.Image import Image

PREDICTOR_FILE, PICTURES_FILE = "predictor.onnx", "pictures.npz"
DEFAULT_NETWORK = "image-wide"
THUMBNAIL_PIXELS = 32
"""Pixels a side at which pictures are compared with training images."""
MIN_CONFIDENCE = 0.5
"""Less confidence is low."""
MIN_INSIDE = 0.05
"""A cell with a smaller probability of being inside counts as outside."""
OOD_THRESHOLD_LIMITS = 1e-4, 1.0
"""Smallest and largest valid out-of-distribution threshold, a root mean square of colours."""


@dataclass(frozen=True)
class Prediction:
    """The garment that a network predicts from a picture."""

    photo: Photo
    """Input of the network."""
    channels: Float32[np.ndarray, "34 row col"]
    """Probabilities, and vectors in cm, not repaired."""
    garment: DecodedGarment
    """Repaired, decoded and checked; it has no latent vector."""
    confidence: float
    """From 0 to 1: certainty of flags and edge types (`certainty`), times the likeness of the
    picture to training images (`PatternPredictor.likeness`)."""

    @property
    def doubts(self) -> Float[np.ndarray, "layer row col"]:
        """Uncertainty of each cell, see `uncertainty_of`."""
        return uncertainty_of(self.channels)

    @property
    def is_sure(self) -> bool:
        """Whether the confidence is not low.

        Whether the garment can be sewn is in `garment.faults`; draping shows whether it can be
        worn.
        """
        return self.confidence >= MIN_CONFIDENCE


class PatternPredictor:
    """A trained cascade.

    Args:
        folder: of its files.

    Raises:
        LearnError: a file is missing or damaged, or was made for another channel layout.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.config = read_config(self.folder, ("grid", "picture"))
        try:
            self.box = Box(**self.config["wearer"])
        except (KeyError, TypeError, ValueError):
            raise damaged_file(self.folder / CONFIG_FILE) from None
        grid = int(self.config["grid"])
        sizes = {"picture": [3, self.size, self.size], "channels": [34, grid, grid]}
        self._network = OnnxNetwork(self.folder / PREDICTOR_FILE, sizes)

    @classmethod
    def load(cls, name: str | Path = DEFAULT_NETWORK) -> "PatternPredictor":
        """A bundled network, by name, or one in a folder.

        Raises:
            LearnError: there is no bundled network of that name, and no such folder.
        """
        return cls(network_folder(name, predictor_names(), "network"))

    @property
    def size(self) -> int:
        """Pixels a side of its input."""
        return int(self.config["picture"])

    def predict(
        self,
        picture: "str | PathLike[str] | UInt8[np.ndarray, 'row col 3'] | Image | Photo",
        *,
        repair_level: RepairLevel = "full",
    ) -> Prediction:
        """Predict the pattern of the garment in a picture.

        Args:
            picture: a file, 8-bit RGB pixels with the highest row first, or a Pillow image.
            repair_level: how much of the network's output is repaired.

        Raises:
            LearnError: the picture cannot be read, has an invalid size (see `read_photo`), or shows
                nothing.
            TypeError: it, or its pixels, are of another type.
        """
        photo = frame_photo(as_photo(picture), self.box, self.size)
        if EMPTY in photo.notes:
            file = (
                f"{shown_path(picture)}:" if isinstance(picture, str | PathLike) else "the picture"
            )
            raise LearnError(f"{file} {EMPTY}; give one of someone in a garment, from the front")
        channels = self.channels(photo.pixels[None])[0]
        garment = decoded_garment(np.zeros(0, np.float32), channels, repair_level)
        confidence = certainty(channels) * self.likeness(photo.pixels)
        return Prediction(photo, channels, garment, confidence)

    def channels(
        self, pixels: UInt8[np.ndarray, "n pixel_row pixel_col 3"]
    ) -> Float32[np.ndarray, "n 34 row col"]:
        """Channels of pictures that are framed already (`frame_photo`)."""
        upward = pixels[:, ::-1].transpose(0, 3, 1, 2)
        images = np.ascontiguousarray(upward, np.float32) / 255
        return self._network(images)

    def likeness(self, pixels: UInt8[np.ndarray, "row col 3"]) -> float:
        """Likeness of a picture to training images, from 0 to 1: exp(-(d / t)^2 / 2).

        With d the distance from the plane of training images and t the threshold, which 1 in 100
        held-out images exceeds: 1 on the plane, .61 at the threshold. It falls from the start, as
        the distance of a wearer who is turned may still be below the threshold.
        """
        middle, axes, threshold = self._reference
        distance = plane_distance(thumbnail(pixels), middle, axes)
        return float(np.exp(-((distance / float(threshold)) ** 2) / 2))

    @cached_property
    def _reference(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mean and axes of training images, and threshold, from `pictures.npz`."""
        file = self.folder / PICTURES_FILE
        content = read_arrays(file, middle="f", axes="f", usual="f")
        middle, axes, threshold = (each.astype(float) for each in content)
        numbers = 3 * THUMBNAIL_PIXELS**2
        low, high = OOD_THRESHOLD_LIMITS
        if (
            middle.shape != (numbers,)
            or axes.shape[1:] != (numbers,)
            or threshold.shape != ()
            or not all(np.isfinite(each).all() for each in (middle, axes))
            or not low <= threshold <= high
        ):
            raise damaged_file(file)
        return middle, axes, threshold


def certainty(channels: Float32[np.ndarray, "34 row col"]) -> float:
    """Certainty of a network where there may be cloth, from 0 to 1.

    The mean of |2 p - 1| over the flags of these cells, times the mean of the largest probability
    over the types of their grid edges.
    """
    flags, types, may_be_inside = _certainties(channels)
    if not may_be_inside.any():
        return 0.0
    return float(flags[may_be_inside].mean() * types[may_be_inside].mean())


def uncertainty_of(
    channels: Float32[np.ndarray, "34 row col"],
) -> Float[np.ndarray, "layer row col"]:
    """Uncertainty of a network about each cell: 0 certain, 1 undecided.

    About its flag and, where it may be inside, about the types of its bottom and left grid edges.
    """
    flags, types, may_be_inside = _certainties(channels)
    return 1 - flags * np.where(may_be_inside, types, 1.0)


def _certainties(
    channels: Float32[np.ndarray, "34 row col"],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each cell: certainty of its flag, and of its edge types, and whether it may be inside."""
    inside, types, _, _ = split_channels(channels)
    return np.abs(2 * inside - 1), types.max(axis=2).mean(axis=1), inside > MIN_INSIDE


def thumbnail(pixels: UInt8[np.ndarray, "row col 3"]) -> Float[np.ndarray, " number"]:
    """A picture in few pixels, flattened, from 0 to 1."""
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
    """Distance of a picture from a plane, a root mean square of colours.

    Args:
        numbers: a `thumbnail`.
        middle: a point of the plane.
        axes: orthonormal directions of the plane.
    """
    rest = numbers - middle
    rest = rest - (axes @ rest) @ axes
    return float(np.sqrt((rest**2).mean()))


def predictor_names() -> tuple[str, ...]:
    """Names of the bundled cascades."""
    return bundled_names(PREDICTOR_FILE)
