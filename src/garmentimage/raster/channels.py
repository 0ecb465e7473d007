"""The 17 channels of a layer: the one place that knows which of them is what.

    0       inside flag
    1-4     type of the bottom grid edge, one-hot in the order of `EdgeType`
    5-8     type of the left grid edge, likewise
    9-16    (dx, dy) of the bottom, right, top and left edge vector [cm]

Layers follow each other, the front first. Numbers of flags and types may also be probabilities or
logits, as networks give them; nothing here looks at values but `check_channels`.
"""

from typing import Any, TypeVar

import numpy as np
from jaxtyping import Bool, Float64, Integer

from garmentimage.errors import ImageError

EDGE_TYPE_COUNT = 4
VECTOR_COUNT = 4
CHANNELS_PER_LAYER = 1 + 2 * EDGE_TYPE_COUNT + 2 * VECTOR_COUNT
CHANNEL_CONTRACT = "garmentimage-1"
"""What channels mean: their order and units, and the frame. Networks are made for one of these."""

MIN_GRID, MAX_GRID = 4, 256  # smallest and largest grid that files may have
MAX_LAYERS = 16

Array = TypeVar("Array")  # a numpy array or a torch tensor


def split_channels(channels: Array) -> tuple[Array, Array, Array]:
    """Flags, edge types and edge vectors of images; views where the memory allows.

    Args:
        channels: [..., 17 L, row, col], an array or a tensor.

    Returns:
        Flags [..., L, row, col]; types [..., L, 2, 4, row, col], of the bottom and the left grid
        edge; vectors [..., L, 4, 2, row, col].
    """
    array: Any = channels
    *images, depth, rows, cols = array.shape
    layers = depth // CHANNELS_PER_LAYER
    block = array.reshape(*images, layers, CHANNELS_PER_LAYER, rows, cols)
    first_vector = 1 + 2 * EDGE_TYPE_COUNT
    types = block[..., 1:first_vector, :, :]
    vectors = block[..., first_vector:, :, :]
    return (
        block[..., 0, :, :],
        types.reshape(*images, layers, 2, EDGE_TYPE_COUNT, rows, cols),
        vectors.reshape(*images, layers, VECTOR_COUNT, 2, rows, cols),
    )


def join_channels(flags: Array, types: Array, vectors: Array) -> Array:
    """Channels [..., 17 L, row, col] from what `split_channels` gives; a new array or tensor."""
    *images, layers, rows, cols = flags.shape  # type: ignore[attr-defined]
    parts = [
        part.reshape(*images, layers, -1, rows, cols)  # type: ignore[attr-defined]
        for part in (flags, types, vectors)
    ]
    joined: Any
    if isinstance(flags, np.ndarray):
        joined = np.concatenate(parts, axis=-3)
    else:
        from torch import cat

        joined = cat(parts, dim=-3)
    return joined.reshape(*images, layers * CHANNELS_PER_LAYER, rows, cols)  # type: ignore[no-any-return]


def one_hot(
    edge_type: Integer[np.ndarray, "*n row col"],
) -> Bool[np.ndarray, "*n 4 row col"]:
    """Which of the four types each grid edge has."""
    is_type: Bool[np.ndarray, "*n 4 row col"] = (
        edge_type[..., None, :, :] == np.arange(EDGE_TYPE_COUNT)[:, None, None]
    )
    return is_type


def check_channels(array: Any) -> Float64[np.ndarray, "channel row col"]:
    """`array` as float64 [17 L, N, N].

    Args:
        array: [17 L, N, N] or [L, 17, N, N], any real type.

    Raises:
        ImageError: a wrong shape, or values that are not finite.
    """
    try:
        array = np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ImageError(
            f"channels are not an array of numbers ({error}); load_image(path) reads a file"
        ) from None
    if array.ndim == 4 and array.shape[1] == CHANNELS_PER_LAYER:  # as rows of a dataset have it
        array = array.reshape(-1, *array.shape[2:])
    if array.ndim != 3 or array.shape[1] != array.shape[2]:
        raise ImageError(f"channels have shape {array.shape}; wanted [17 x layers, N, N]")
    count, grid = array.shape[0], array.shape[1]
    if count == 0 or count % CHANNELS_PER_LAYER or count > MAX_LAYERS * CHANNELS_PER_LAYER:
        raise ImageError(f"{count} channels; each layer has {CHANNELS_PER_LAYER} (34 for two)")
    if not MIN_GRID <= grid <= MAX_GRID:
        raise ImageError(f"a grid of {grid} cells; wanted {MIN_GRID} to {MAX_GRID}")
    if not (np.abs(array) <= np.finfo(np.float32).max).all():
        raise ImageError("channels hold values that are not finite (NaN, infinity or over 3e38)")
    checked: Float64[np.ndarray, "channel row col"] = array
    return checked
