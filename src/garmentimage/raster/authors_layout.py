"""The two orders that channels come in: ours, and that of the GarmentImage authors' own files.

The authors' arrays are float64 [34, N, N], axes [channel, x, y], y = 0 at the bottom. Per layer:
inside flag; (dx, dy) of the bottom, left, top, right grid edge, less the edge at rest, in cells;
one-hot type of the bottom edge, then of the left edge (none, side-by-side, front-to-back,
boundary). Their cell measures 32 px at 2.75 px a cm; the file does not say.
"""

from enum import StrEnum

import numpy as np
from jaxtyping import Float, Float64

from garmentimage.errors import ImageError
from garmentimage.raster.channel_kind import are_channels
from garmentimage.raster.channels import (
    CHANNELS_PER_LAYER,
    EDGE_TYPE_COUNT,
    join_channels,
    one_hot,
    split_channels,
)
from garmentimage.raster.image import GarmentImage

AUTHORS_CELL_CM = 32 / 2.75  # side of a cell in the authors' files [cm], about 11.636

# Ours <-> theirs; both orders swap the second and the fourth of four, so each is its own inverse.
_TYPES = [0, 3, 2, 1]
_VECTORS = [0, 3, 2, 1]
_REST = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
"""Bottom, right, top, left vectors of a cell at rest, in cells."""

SHARE_TOL = 0.02  # how far four values may miss being the shares of one whole


class ChannelOrder(StrEnum):
    """Which order a bare array of channels is in."""

    OURS = "garmentimage"
    AUTHORS = "authors"


def to_authors(image: GarmentImage) -> Float64[np.ndarray, "34 x y"]:
    """The image as the authors store it.

    Raises:
        ImageError: the image does not have two layers, or contract 1 does not hold it.
    """
    if image.layers != 2:
        raise ImageError(
            f"the authors' .npy holds two layers, this image has {image.layers}; save it as .npz"
        )
    if image.contract != 1:
        raise ImageError(
            "the authors' .npy has no place for panels that wrap round or are turned, nor for "
            "pressed pleats; save it as .npz"
        )
    moved = image.deformation.astype(np.float64) / AUTHORS_CELL_CM - _REST[:, :, None, None]
    moved = np.where(image.inside[:, None, None], moved, 0.0)[:, _VECTORS]
    types = one_hot(image.edge_type)[:, :, _TYPES]
    # Joined as ours are, but their vectors stand where our types do, and the other way round.
    joined = join_channels(image.inside, moved, types)
    return np.ascontiguousarray(joined.transpose(0, 2, 1))


def channels_from_authors(array: Float[np.ndarray, "34 x y"]) -> Float[np.ndarray, "34 row col"]:
    """An array in the authors' order as channels in ours; soft values stay soft."""
    array = np.asarray(array, dtype=np.float64).transpose(0, 2, 1)
    block = array.reshape(2, CHANNELS_PER_LAYER, *array.shape[1:])
    moved = block[:, 1:9].reshape(2, 4, 2, *array.shape[1:])[:, _VECTORS]
    deformation = (moved + _REST[:, :, None, None]) * AUTHORS_CELL_CM
    types = block[:, 9:].reshape(2, 2, EDGE_TYPE_COUNT, *array.shape[1:])[:, :, _TYPES]
    return join_channels(block[:, 0], types, deformation)


def detect_channel_order(array: np.ndarray) -> ChannelOrder:
    """Which order the channels of `array` are in, detected by where the edge types stand.

    In each order two groups of four channels are the shares of the four types, which add up to
    one in every cell; the deformation, which stands there in the other order, is zero in the
    cells outside. So a garment that leaves one cell free fits one order at most. Where neither
    fits, channels that are shares but for the errors of a network do.

    Raises:
        ImageError: neither order fits (logits, say), or both do.
    """
    may_be_theirs = array.shape[0] == 2 * CHANNELS_PER_LAYER
    _, types, vectors, _ = split_channels(array)
    # The authors' types stand where our vectors do.
    other = vectors.reshape(types.shape) if may_be_theirs else types
    ours = theirs = False
    for are_shares in (_are_shares, are_channels):
        ours = are_shares(types)
        theirs = may_be_theirs and are_shares(other)
        if ours != theirs:
            return ChannelOrder.OURS if ours else ChannelOrder.AUTHORS
        if ours:
            break
    fits = "both orders of channels fit" if ours else "neither order of channels fits"
    raise ImageError(f"{fits}; say which it is, order 'garmentimage' or 'authors' (--order)")


def _are_shares(groups: Float[np.ndarray, "layer 2 type row col"]) -> bool:
    near_one = np.abs(groups.sum(axis=2) - 1) <= SHARE_TOL
    return bool(near_one.all() and groups.min() >= -SHARE_TOL and groups.max() <= 1 + SHARE_TOL)
