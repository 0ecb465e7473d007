"""Printed cloth: a tile of colours that repeats over every panel, in the panel's own plane.

A tile's rows run along the panel's y axis from the top down and its columns along x: a print lies
on the cloth as on the flat pattern and bends with it.
"""

from dataclasses import dataclass
from functools import lru_cache
from os import PathLike

import numpy as np
from jaxtyping import Float, Float32

from garmentimage.errors import RenderError
from garmentimage.render.worn.tint import Tint, linear, rgb
from garmentimage.system import shown_path

TILE, WEAVE_TILE = 64, 256  # rows and columns of a tile that we draw, and of one with random detail
MAX_PIXELS = 16_000_000  # largest picture that is read as a print
_OCTAVES = ((2, 0.5), (8, 0.35), (32, 0.6), (128, 0.8))
"""Waves over a tile, and their strength, that make up random detail."""


@dataclass(frozen=True, eq=False)
class Print:
    """A repeating tile."""

    tile: Float[np.ndarray, "row col 3"]  # colours [sRGB, 0 to 1]
    width: float  # width of the tile on the cloth [cm]
    height: float  # height of the tile on the cloth [cm]

    def __post_init__(self) -> None:
        if not (0 < self.width < np.inf and 0 < self.height < np.inf):
            raise RenderError(
                f"a print repeats after more than 0 cm, not {self.width} x {self.height} cm"
            )


def stripes(first: Tint, second: Tint, *, period: float = 4.0, along: bool = True) -> Print:
    """Stripes of equal width, along the panel's y axis or across it; `period` [cm] holds two."""
    tile = np.empty((TILE, TILE, 3))
    tile[:, : TILE // 2], tile[:, TILE // 2 :] = rgb(first), rgb(second)
    return Print(tile if along else tile.swapaxes(0, 1), period, period)


def checks(first: Tint, second: Tint, *, period: float = 5.0) -> Print:
    """Woven checks (gingham): where a band of the first colour crosses one of the second, a mix."""
    band = np.arange(TILE) < TILE // 2
    share = (band[:, None].astype(float) + band[None]) / 2
    return Print(_mixed(first, second, share), period, period)


def dots(ground: Tint, spot: Tint, *, period: float = 4.0, size: float = 0.4) -> Print:
    """Dots in staggered rows; `size` is their diameter as a share of the period."""
    place = (np.arange(TILE) + 0.5) / TILE
    gap = np.minimum(
        *(np.hypot(*np.meshgrid(_wave(place - s), _wave(place - s))) for s in (0.0, 0.5))
    )
    return Print(_mixed(ground, spot, (gap < size / 2).astype(float)), period, period)


def noise(first: Tint, second: Tint, rng: np.random.Generator, *, period: float = 24.0) -> Print:
    """Random mottle between two colours, as in melange yarn or washed cloth."""
    share = np.full((WEAVE_TILE, WEAVE_TILE), 0.5)
    for waves, strength in _OCTAVES:
        share += strength * (_periodic_noise(rng, waves) - 0.5)
    return Print(_mixed(first, second, np.clip(share, 0, 1)), period, period)


def picture_print(path: str | PathLike[str], *, width: float) -> Print:
    """A user's picture as a print that repeats every `width` cm.

    Raises:
        RenderError: the file is not a picture, or too large.
    """
    tile = read_picture(path) / 255
    return Print(tile, width, width * len(tile) / tile.shape[1])


def read_picture(path: str | PathLike[str]) -> Float[np.ndarray, "row col 3"]:
    """A picture file as 8-bit sRGB numbers.

    Raises:
        RenderError: the file is not a picture, or too large.
    """
    from PIL import Image

    try:
        with Image.open(path) as image:
            if image.width * image.height > MAX_PIXELS:
                raise RenderError(
                    f"{shown_path(path)}: has {image.width} x {image.height} pixels; "
                    f"make it smaller than {MAX_PIXELS // 1_000_000} million"
                )
            return np.asarray(image.convert("RGB"), float)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        if isinstance(error, RenderError):
            raise
        fault = "is not a picture that can be read; save it as PNG or JPEG"
        if reason := getattr(error, "strerror", None):
            fault = f"cannot be read ({reason}); name a picture file"
        elif isinstance(error, Image.DecompressionBombError):
            fault = f"has too many pixels; make it smaller than {MAX_PIXELS // 1_000_000} million"
        raise RenderError(f"{shown_path(path)}: {fault}") from None


@lru_cache(maxsize=32)
def light_tile(cloth_print: Print, sample: float) -> Float32[np.ndarray, "row col 3"]:
    """The tile in linear light, averaged down to texels of about `sample` cm.

    Detail finer than the picture's samples would show as false patterns.
    """
    from PIL import Image

    light = linear(cloth_print.tile)
    rows, cols = light.shape[:2]
    size = (
        int(np.clip(round(cloth_print.width / sample), 1, cols)),
        int(np.clip(round(cloth_print.height / sample), 1, rows)),
    )
    channels = [
        Image.fromarray(np.ascontiguousarray(light[..., k])).resize(size, Image.Resampling.BOX)
        for k in range(3)
    ]
    return np.stack([np.asarray(c, np.float32) for c in channels], axis=-1)


def _mixed(
    first: Tint, second: Tint, share: Float[np.ndarray, "row col"]
) -> Float[np.ndarray, "row col 3"]:
    """`first` where the share is 0, `second` where it is 1."""
    colours: np.ndarray = rgb(first) + share[..., None] * (rgb(second) - rgb(first))
    return colours


def _wave(place: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
    """Distance to the nearest whole number."""
    distance: np.ndarray = np.abs(place - np.rint(place))
    return distance


def _periodic_noise(rng: np.random.Generator, waves: int) -> Float[np.ndarray, "row col"]:
    """Random numbers from 0 to 1 on a grid of `waves` cells that repeats, smoothed between."""
    knots = rng.random((waves, waves))
    place = np.arange(WEAVE_TILE) * waves / WEAVE_TILE
    low = place.astype(int)
    share = place - low
    share = share * share * (3 - 2 * share)
    rows = knots[low] + share[:, None] * (knots[(low + 1) % waves] - knots[low])
    values: np.ndarray = rows[:, low] + share[None] * (rows[:, (low + 1) % waves] - rows[:, low])
    return values
