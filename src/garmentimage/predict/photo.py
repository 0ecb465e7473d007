"""Photographs framed like training images: one person, upright, on white, in the same box.

In training images, the wearer always fills the same bounding box. A photograph with a plain
background is framed alike: pixels that differ from the colour of its border are the wearer, who is
scaled to the height of the box and centred in it.
"""

import warnings
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, UInt8

from garmentimage.errors import LearnError
from garmentimage.system import shown_path

FORMATS = ("PNG", "JPEG", "WEBP", "TIFF", "BMP", "GIF")
MULTI_PICTURE_FORMAT = "MPO"
"""A JPEG with a second picture, for depth, as some phones save it."""
MAX_PIXELS = 50_000_000
MIN_SIDE = 32
"""Pictures with fewer pixels a side are refused."""
MAX_SIDE = 2048
"""Pictures with more pixels a side are scaled down."""
MAX_ASPECT = 8
"""Largest ratio of the sides of a picture."""
BACKGROUND_TOLERANCE = 24.0
"""Pixels that differ more from the colour of the border, of 255, are the wearer."""
MIN_BORDER_SHARE = 0.8
"""A background is plain where this share of the border has one colour."""
MAX_FRAME = 0.05
"""Widest frame that is cut off, as a share of the shorter side, on each side."""
MIN_FIGURE_HEIGHT = 0.02
"""Lower figures, as a share of the picture, are specks and not wearers."""
MIN_SECOND_FIGURE = 0.3
"""A second figure with more pixels, as a share of the largest one's, is a second wearer."""
PLACE_TOLERANCE = 0.02
"""A wearer this near to the box, as a share of the picture's side, is not moved."""
WHITE, WHITE_16_BIT = 255, 65535
"""White in 8 and in 16 bits."""
MIN_RESOLUTION = 0.75
"""A note is made where the wearer has less than this share of the network's pixels."""
CLUTTERED = "has no plain background, so its wearer could not be found; expect little"
EMPTY = "shows nothing in front of its background"
CROWDED = "shows more than one figure; the largest was taken"


@dataclass(frozen=True)
class Box:
    """A bounding box of the wearer, as shares of the picture's side from its top left corner."""

    top: float
    bottom: float
    left: float
    right: float

    def __post_init__(self) -> None:
        sides = (self.top, self.bottom), (self.left, self.right)
        numbers = [value for side in sides for value in side]
        if not all(type(value) is float for value in numbers) or not all(
            low >= 0 and low + MIN_FIGURE_HEIGHT <= high <= 1 for low, high in sides
        ):
            raise ValueError(f"a box from {sides[0]} to {sides[1]}; give shares of the picture")


@dataclass(frozen=True)
class Photo:
    """A picture, and notes on its conversion."""

    pixels: UInt8[np.ndarray, "row col 3"]
    notes: tuple[str, ...]
    """Remarks for the user, as sentences."""


def read_photo(path: str | PathLike[str]) -> Photo:
    """Read a picture file, upright, as 8-bit sRGB on white, no larger than `MAX_SIDE` a side.

    Raises:
        LearnError: the file is not a picture, is animated, or has too many or too few pixels.
    """
    from PIL import Image

    name = shown_path(path)
    if Path(path).exists() and not (Path(path).is_file() or Path(path).is_dir()):
        raise LearnError(f"{name}: is not an ordinary file; name a picture file")
    is_open = False
    try:
        # Pillow warns of sizes, which are checked here, and of damaged metadata of cameras.
        with warnings.catch_warnings(action="ignore"), Image.open(path, formats=FORMATS) as image:
            is_open = True
            _check_size(image, name)
            image.load()
            return _plain(image)
    except LearnError:
        raise
    except Image.DecompressionBombError:
        raise _too_many(name) from None
    except Exception as error:  # noqa: BLE001  decoders of six formats: no base class
        if is_open:
            raise LearnError(f"{name}: is damaged or cut short; get it again") from None
        reason = getattr(error, "strerror", None)
        if reason:
            raise LearnError(f"{name}: cannot be read ({reason}); name a picture file") from None
        raise LearnError(
            f"{name}: is not a picture that can be read; save it as PNG or JPEG"
        ) from None


def as_photo(picture: object) -> Photo:
    """A picture of any kind as a photo: a path, 8-bit RGB pixels, or a Pillow image.

    Args:
        picture: an array has shape [row, column, 3], the highest row first.

    Raises:
        LearnError: see `read_photo`.
        TypeError: it is of another type.
    """
    from PIL import Image

    if isinstance(picture, str | PathLike):
        return read_photo(picture)
    if isinstance(picture, Image.Image):
        _check_size(picture, "the picture")
        return _plain(picture)
    photo = Photo(picture, ()) if isinstance(picture, np.ndarray) else picture
    pixels = photo.pixels if isinstance(photo, Photo) else None
    if not isinstance(photo, Photo) or not isinstance(pixels, np.ndarray):
        raise TypeError(
            f"wanted a path, pixels or an image, not a value of type {type(picture).__name__}"
        )
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 3:
        raise TypeError(
            f"wanted 8-bit pixels of shape [row, column, 3], not {pixels.dtype} "
            f"{list(pixels.shape)}; PIL.Image.fromarray(...).convert('RGB') makes them of others"
        )
    image = Image.fromarray(pixels)
    _check_size(image, "the picture")
    return Photo(_plain(image).pixels, photo.notes)


def _check_size(image: Any, name: str) -> None:
    if image.width * image.height > MAX_PIXELS:
        raise _too_many(name)
    frames = getattr(image, "n_frames", 1)
    if frames > 1 and image.format != MULTI_PICTURE_FORMAT:
        raise LearnError(f"{name}: is animated, {frames} pictures; save one of them")
    if min(image.size) < MIN_SIDE:
        raise LearnError(
            f"{name}: has {image.width} x {image.height} pixels; give {MIN_SIDE} a side or more"
        )
    if max(image.size) > MAX_ASPECT * min(image.size):
        raise LearnError(
            f"{name}: has {image.width} x {image.height} pixels, too thin to show someone; cut it "
            "to what it should show"
        )


def _too_many(name: str) -> LearnError:
    return LearnError(
        f"{name}: has too many pixels; make it smaller than {MAX_PIXELS // 1_000_000} million"
    )


def _plain(image: Any) -> Photo:
    from PIL import Image, ImageOps

    notes = []
    image = ImageOps.exif_transpose(image)
    if image.mode in ("I", "F") or image.mode.startswith("I;16"):
        notes.append("has more than 8 bits a colour; they were brought to 8")
        levels = np.nan_to_num(np.asarray(image, float))
        low, high = float(levels.min()), max(float(levels.max()), float(levels.min()) + 1)
        if image.mode != "F" and low >= 0 and high <= WHITE_16_BIT:
            low, high = 0.0, float(WHITE_16_BIT)
        image = Image.fromarray(((levels - low) / (high - low) * WHITE).astype(np.uint8))
    if image.mode == "CMYK":
        notes.append("is CMYK; its colours were converted roughly")
    if image.has_transparency_data:
        clear = image.convert("RGBA")
        image = Image.alpha_composite(Image.new("RGBA", clear.size, "white"), clear)
    image = image.convert("RGB")
    image.thumbnail((MAX_SIDE, MAX_SIDE), Image.Resampling.BOX)
    return Photo(np.asarray(image), tuple(notes))


def frame_photo(photo: Photo, box: Box, size: int) -> Photo:
    """Frame a photograph: a square picture, its wearer in the box.

    Args:
        photo: upright.
        box: of the wearer in training images.
        size: pixels a side.

    Returns:
        The picture; its notes say why, where the wearer was not found.
    """
    photo = Photo(without_frame(photo.pixels), photo.notes)
    rows, cols = photo.pixels.shape[:2]
    wearer, note = find_wearer(photo.pixels)
    notes = (*photo.notes, note) if note else photo.notes
    if wearer is None:
        longer = max(rows, cols)
        corner = -((longer - rows) // 2), -((longer - cols) // 2)
        return Photo(_cut(photo.pixels, *corner, longer, size), notes)
    where = np.argwhere(wearer)
    (top, left), (bottom, right) = where.min(0), where.max(0) + 1
    # Side of the square in which the wearer is as high as the box.
    side = (bottom - top) / (box.bottom - box.top)
    if side < MIN_RESOLUTION * size:
        notes += (f"shows its wearer only {bottom - top} pixels high; give more for less doubt",)
    cleared = np.where(wearer[..., None], photo.pixels, WHITE).astype(np.uint8)
    found = np.array([top / rows, bottom / rows, left / cols, right / cols])
    wanted = np.array([box.top, box.bottom, box.left, box.right])
    if rows == cols and np.abs(found - wanted).max() < PLACE_TOLERANCE:
        return Photo(_cut(cleared, 0, 0, rows, size), notes)
    first_row = top - box.top * side
    first_col = (left + right) / 2 - (box.left + box.right) / 2 * side
    return Photo(_cut(cleared, first_row, first_col, side, size), notes)


def without_frame(pixels: UInt8[np.ndarray, "row col 3"]) -> UInt8[np.ndarray, "r c 3"]:
    """The picture without a thin frame of one colour around a plain background, if it has one."""
    colour, share = _border(pixels)
    if share < 1:
        return pixels
    for width in range(1, int(MAX_FRAME * min(pixels.shape[:2])) + 1):
        inner = pixels[width:-width, width:-width]
        other, share = _border(inner)
        if share >= MIN_BORDER_SHARE and np.abs(other - colour).max() >= BACKGROUND_TOLERANCE:
            return without_frame(inner)  # its edge may be blurred
    return pixels


def find_wearer(
    pixels: UInt8[np.ndarray, "row col 3"],
) -> tuple[Bool[np.ndarray, "row col"] | None, str]:
    """Find the wearer: the largest connected region that is not background, holes filled.

    Returns:
        A mask of the wearer, None where the background is not plain or nothing is before it; and a
        note, empty where there is nothing to remark.
    """
    from scipy import ndimage

    colour, share = _border(pixels)
    if share < MIN_BORDER_SHARE:
        return None, CLUTTERED
    other = np.abs(pixels.astype(float) - colour).max(2) >= BACKGROUND_TOLERANCE
    parts, _ = ndimage.label(other, np.ones((3, 3)))
    sizes = np.bincount(parts.ravel(), minlength=2)
    sizes[0] = 0
    filled: np.ndarray = ndimage.binary_fill_holes(parts == sizes.argmax())
    if not sizes.any() or np.ptp(np.flatnonzero(filled.any(1))) < MIN_FIGURE_HEIGHT * len(pixels):
        return None, EMPTY
    is_crowded = np.sort(sizes)[-2] > MIN_SECOND_FIGURE * sizes.max()
    return filled, CROWDED if is_crowded else ""


def _border(pixels: UInt8[np.ndarray, "row col 3"]) -> tuple[Float[np.ndarray, "3"], float]:
    """The colour of the outermost pixels, and the share of them that have it."""
    border = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]]).astype(float)
    colour = np.median(border, axis=0)
    return colour, float((np.abs(border - colour).max(1) < BACKGROUND_TOLERANCE).mean())


def _cut(
    pixels: UInt8[np.ndarray, "row col 3"], row: float, col: float, side: float, size: int
) -> UInt8[np.ndarray, "n n 3"]:
    """A square of the picture, white beyond its edges, scaled to `size` pixels a side."""
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
