"""What stands behind a worn garment: linear light of any size, stretched over the picture."""

from os import PathLike

import numpy as np
from jaxtyping import Float32

from garmentimage.render.worn.prints import read_picture
from garmentimage.render.worn.tint import Tint, linear, rgb


def plain(tint: Tint) -> Float32[np.ndarray, "1 1 3"]:
    """One colour."""
    return linear(rgb(tint)[None, None])


def gradient(top: Tint, bottom: Tint) -> Float32[np.ndarray, "2 1 3"]:
    """From one colour at the top to another at the bottom."""
    return linear(np.stack([rgb(top), rgb(bottom)])[:, None])


def scenery(path: str | PathLike[str]) -> Float32[np.ndarray, "row col 3"]:
    """A user's picture, its middle square.

    Raises:
        RenderError: the file is not a picture, or too large.
    """
    image = read_picture(path)
    side = min(image.shape[:2])
    row, col = (np.array(image.shape[:2]) - side) // 2
    return linear(image[row : row + side, col : col + side] / 255)


PLAIN = plain("white")


def filled(
    background: Float32[np.ndarray, "row col 3"], size: int
) -> Float32[np.ndarray, "size size 3"]:
    """A background stretched over a picture."""
    if background.shape[:2] == (1, 1):
        return np.broadcast_to(background, (size, size, 3))
    return _along(_along(background, size).swapaxes(0, 1), size).swapaxes(0, 1)


def _along(image: Float32[np.ndarray, "row col 3"], size: int) -> Float32[np.ndarray, "size col 3"]:
    """The rows of an image, `size` of them: the first and the last row are kept."""
    place = np.linspace(0, len(image) - 1, size)
    low = np.minimum(place.astype(int), max(len(image) - 2, 0))
    high = np.minimum(low + 1, len(image) - 1)
    share = (place - low)[:, None, None].astype(np.float32)
    rows: np.ndarray = image[low] * (1 - share) + image[high] * share
    return rows
