"""Photographs as the networks saw pictures: one person, upright, on white, in the same place.

The networks were trained on pictures in which the wearer always fills the same box. A photograph
with a plain background is brought to that: what differs from the colour of its border is taken for
the wearer, scaled to the height of the box and put over its middle.
"""

from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from jaxtyping import Bool, UInt8

from garmentimage.errors import LearnError
from garmentimage.files import shown_path

PIXEL_LIMIT = 50_000_000
SMALLEST = 32
"""Fewer pixels a side show no garment."""
PLAIN = 24.0
"""How far from the colour of the border, of 255, a pixel is the wearer's."""
BORDER_SHARE = 0.8
"""A background is plain where this share of the border has one colour."""
PLACE_TOLERANCE = 0.02
"""A wearer that is in place within this share of the picture's side stays as it is."""
WHITE = 255


@dataclass(frozen=True)
class Box:
    """Where the wearer is, as shares of the picture's side from its top left corner."""

    top: float
    bottom: float
    left: float
    right: float


@dataclass(frozen=True)
class Photo:
    """A picture, and what was done to it."""

    pixels: UInt8[np.ndarray, "row col 3"]
    notes: tuple[str, ...]
    """What the user should know of it, as sentences."""


def read_photo(path: str | PathLike[str]) -> Photo:
    """A picture file, upright, as 8-bit sRGB on white.

    Raises:
        LearnError: the file is no picture, is animated, or has too many or too few pixels.
    """
    from PIL import Image

    name = shown_path(path)
    try:
        with Image.open(path) as image:
            if image.width * image.height > PIXEL_LIMIT:
                raise Image.DecompressionBombError
            frames = getattr(image, "n_frames", 1)
            if frames > 1:
                raise LearnError(f"{name}: is animated, {frames} pictures; save one of them")
            if min(image.size) < SMALLEST:
                raise LearnError(
                    f"{name}: has {image.width} x {image.height} pixels; give {SMALLEST} a side "
                    "or more"
                )
            image.load()
            return _plain(image)
    except LearnError:
        raise
    except Image.DecompressionBombError:
        raise LearnError(
            f"{name}: has too many pixels; make it smaller than {PIXEL_LIMIT // 1_000_000} million"
        ) from None
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        reason = getattr(error, "strerror", None)
        if reason:
            raise LearnError(f"{name}: cannot be read ({reason}); name a picture file") from None
        raise LearnError(
            f"{name}: is no picture that can be read; save it as PNG or JPEG"
        ) from None


def _plain(image: Any) -> Photo:
    from PIL import Image, ImageOps

    notes = []
    image = ImageOps.exif_transpose(image)
    if image.mode in ("I", "F") or image.mode.startswith("I;16"):
        notes.append("has more than 8 bits a colour; its range was brought to 8")
        levels = np.asarray(image, float)
        low, high = float(levels.min()), max(float(levels.max()), float(levels.min()) + 1)
        image = Image.fromarray(((levels - low) / (high - low) * WHITE).astype(np.uint8))
    if image.mode == "CMYK":
        notes.append("is CMYK; its colours were converted roughly")
    if image.has_transparency_data:
        clear = image.convert("RGBA")
        image = Image.alpha_composite(Image.new("RGBA", clear.size, "white"), clear)
    return Photo(np.asarray(image.convert("RGB")), tuple(notes))


def framed(photo: Photo, box: Box, size: int) -> Photo:
    """A photograph as a square picture of `size` pixels a side, its wearer in the box.

    Args:
        photo: upright.
        box: where the networks saw the wearer.
        size: pixels a side.

    Returns:
        The picture; its notes say where nothing could be done.
    """
    rows, cols = photo.pixels.shape[:2]
    wearer = wearer_mask(photo.pixels)
    notes = list(photo.notes)
    if wearer is None:
        notes.append("has no plain background, so its wearer could not be found; expect little")
        return Photo(_resized(_squared(photo.pixels), size), tuple(notes))
    at = np.argwhere(wearer)
    (top, left), (bottom, right) = at.min(0), at.max(0) + 1
    cleared = np.where(wearer[..., None], photo.pixels, WHITE).astype(np.uint8)
    here = np.array([top / rows, bottom / rows, left / cols, right / cols])
    there = np.array([box.top, box.bottom, box.left, box.right])
    if rows == cols and np.abs(here - there).max() < PLACE_TOLERANCE:
        return Photo(_resized(cleared, size), tuple(notes))
    # The square around the wearer that looks as the networks' pictures do.
    side = (bottom - top) / (box.bottom - box.top)
    first_row = top - box.top * side
    first_col = (left + right) / 2 - (box.left + box.right) / 2 * side
    return Photo(_cut(cleared, first_row, first_col, side, size), tuple(notes))


def wearer_mask(pixels: UInt8[np.ndarray, "row col 3"]) -> Bool[np.ndarray, "row col"] | None:
    """What is not background; None where that is not plain, or nothing is before it."""
    from scipy import ndimage

    border = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]]).astype(float)
    colour = np.median(border, axis=0)
    if (np.abs(border - colour).max(1) < PLAIN).mean() < BORDER_SHARE:
        return None
    other = np.abs(pixels.astype(float) - colour).max(2) >= PLAIN
    parts, count = ndimage.label(other, np.ones((3, 3)))
    if not count:
        return None
    sizes = np.bincount(parts.ravel())
    sizes[0] = 0
    filled: np.ndarray = ndimage.binary_fill_holes(parts == sizes.argmax())
    return filled


def _squared(pixels: UInt8[np.ndarray, "row col 3"]) -> UInt8[np.ndarray, "side side 3"]:
    rows, cols = pixels.shape[:2]
    side = max(rows, cols)
    square = np.full((side, side, 3), WHITE, np.uint8)
    first_row, first_col = (side - rows) // 2, (side - cols) // 2
    square[first_row : first_row + rows, first_col : first_col + cols] = pixels
    return square


def _resized(pixels: UInt8[np.ndarray, "side side 3"], size: int) -> UInt8[np.ndarray, "n n 3"]:
    if len(pixels) == size:
        return pixels
    return _cut(pixels, 0, 0, len(pixels), size)


def _cut(
    pixels: UInt8[np.ndarray, "row col 3"], row: float, col: float, side: float, size: int
) -> UInt8[np.ndarray, "n n 3"]:
    """A square of the picture, white where it reaches over the edge."""
    from PIL import Image

    rows, cols = pixels.shape[:2]
    reach = [-row, -col, row + side - rows, col + side - cols]
    before, left, below, right = (max(int(np.ceil(each)), 0) for each in reach)
    around = ((before, below), (left, right), (0, 0))
    padded = Image.fromarray(np.pad(pixels, around, constant_values=WHITE))
    x, y = col + left, row + before
    return np.asarray(
        padded.resize((size, size), Image.Resampling.BOX, box=(x, y, x + side, y + side))
    )
