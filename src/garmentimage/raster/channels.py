"""The channels of a layer: the one place that knows which of them is what.

    contract 1   contract 2
    0            0            inside flag
                 1            turned flag: the wrong side of the cloth is out
    1-4          2-9          type of the bottom grid edge, one-hot in the order of `EdgeType`
    5-8          10-17        type of the left grid edge, likewise
    9-16         18-25        (dx, dy) of the bottom, right, top and left edge vector [cm]

Layers follow each other, the front first. Contract 1 has the first four edge types. Numbers of
flags and types may also be probabilities or logits, as networks give them; nothing here looks at
values but `check_channels`.
"""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Bool, Float, Float64, Integer

from garmentimage.errors import ImageError

VECTOR_COUNT = 4  # edge vectors of a cell

MIN_GRID, MAX_GRID = 4, 256  # smallest and largest grid that files may have
MAX_LAYERS = 16

_FRONT_TO_BACK, _WRAP, _SHEET, _ONTO, _CREASE = (
    2,
    4,
    5,
    6,
    7,
)  # of `EdgeType`, which is made of what is here

Array = TypeVar("Array")  # a numpy array or a torch tensor


@dataclass(frozen=True)
class ChannelContract:
    """What channels mean: their order and units. Networks are made for one contract."""

    name: str
    flag_count: int
    edge_type_count: int

    @property
    def channels_per_layer(self) -> int:
        """Channels of one layer."""
        return self.flag_count + 2 * self.edge_type_count + 2 * VECTOR_COUNT


CONTRACT_1 = ChannelContract("garmentimage-1", 1, 4)
CONTRACT_2 = ChannelContract("garmentimage-2", 2, 8)
CONTRACTS = {1: CONTRACT_1, 2: CONTRACT_2}
Contract = Literal[1, 2]


@dataclass(frozen=True)
class ChannelLayout:
    """How many channels of each sort an image has, by its contract and number of layers."""

    contract: ChannelContract
    layers: int

    @property
    def flags(self) -> int:
        """Channels of flags."""
        return self.layers * self.contract.flag_count

    @property
    def types(self) -> int:
        """Channels of edge types, one-hot."""
        return 2 * self.layers * self.contract.edge_type_count

    @property
    def vectors(self) -> int:
        """Channels of edge vectors."""
        return 2 * self.layers * VECTOR_COUNT

    @property
    def channels(self) -> int:
        """Channels in all."""
        return self.layers * self.contract.channels_per_layer


PLAIN_LAYOUT = ChannelLayout(CONTRACT_1, 2)
"""Front and back as in the paper, 34 channels."""

CHANNELS_PER_LAYER = CONTRACT_1.channels_per_layer
EDGE_TYPE_COUNT = CONTRACT_1.edge_type_count
CHANNEL_CONTRACT = CONTRACT_1.name


class ChannelParts(NamedTuple):
    """What the channels of an image, or of several, hold: arrays or tensors, as they were given."""

    flags: Any
    """[..., layer, row, col]."""
    types: Any
    """[..., layer, 2, type, row, col], of the bottom and the left grid edge."""
    vectors: Any
    """[..., layer, 4, 2, row, col]."""
    turned: Any
    """[..., layer, row, col]; None in contract 1."""


def contract_of(channel_count: int) -> ChannelContract:
    """The contract of so many channels in all; up to 16 layers no number fits both.

    Raises:
        ImageError: neither.
    """
    for contract in CONTRACTS.values():
        layers, rest = divmod(channel_count, contract.channels_per_layer)
        if not rest and 1 <= layers <= MAX_LAYERS:
            return contract
    each = " or ".join(str(contract.channels_per_layer) for contract in CONTRACTS.values())
    two = " or ".join(str(2 * contract.channels_per_layer) for contract in CONTRACTS.values())
    raise ImageError(f"{channel_count} channels; each layer has {each} ({two} for two)")


def layout_of(channel_count: int) -> ChannelLayout:
    """The contract and the layers of so many channels in all.

    Raises:
        ImageError: neither contract has so many.
    """
    contract = contract_of(channel_count)
    return ChannelLayout(contract, channel_count // contract.channels_per_layer)


def split_channels(channels: Array) -> ChannelParts:
    """Flags, edge types and edge vectors of images; views where the memory allows.

    Args:
        channels: [..., 17 L or 26 L, row, col], an array or a tensor.

    Raises:
        ImageError: neither contract has so many channels.
    """
    array: Any = channels
    *images, depth, rows, cols = array.shape
    contract = contract_of(depth)
    layers = depth // contract.channels_per_layer
    block = array.reshape(*images, layers, contract.channels_per_layer, rows, cols)
    first_type = contract.flag_count
    first_vector = first_type + 2 * contract.edge_type_count
    types = block[..., first_type:first_vector, :, :]
    vectors = block[..., first_vector:, :, :]
    return ChannelParts(
        block[..., 0, :, :],
        types.reshape(*images, layers, 2, contract.edge_type_count, rows, cols),
        vectors.reshape(*images, layers, VECTOR_COUNT, 2, rows, cols),
        block[..., 1, :, :] if contract.flag_count > 1 else None,
    )


def join_channels(flags: Array, types: Array, vectors: Array, turned: Array | None = None) -> Array:
    """Channels from what `split_channels` gives, of contract 2 with `turned`; a new array."""
    *images, layers, rows, cols = flags.shape  # type: ignore[attr-defined]
    parts = [
        part.reshape(*images, layers, -1, rows, cols)  # type: ignore[attr-defined]
        for part in (flags, turned, types, vectors)
        if part is not None
    ]
    joined: Any
    if isinstance(flags, np.ndarray):
        joined = np.concatenate(parts, axis=-3)
    else:
        from torch import cat

        joined = cat(parts, dim=-3)
    return joined.reshape(*images, layers * joined.shape[-3], rows, cols)  # type: ignore[no-any-return]


def with_contract(
    channels: Float[np.ndarray, "*n channel row col"], number: Contract
) -> Float[np.ndarray, "*n converted row col"]:
    """Channels of one contract in the order of another; shares stay shares.

    From contract 2 to 1, cloth that wraps round has a seam there, front to back.

    Raises:
        ImageError: contract 1 has no channels for what is turned or sewn to another sheet.
    """
    wanted = CONTRACTS[number]
    flags, types, vectors, turned = split_channels(channels)
    if types.shape[-3] == wanted.edge_type_count:
        return channels
    if turned is None:
        more = (*types.shape[:-3], wanted.edge_type_count - types.shape[-3], *types.shape[-2:])
        types = np.concatenate([types, np.zeros(more, types.dtype)], axis=-3)
        return join_channels(flags, types, vectors, np.zeros_like(flags))
    if turned.any():
        raise ImageError("contract 1 has no channels for panels that are turned; use contract 2")
    if types[..., [_SHEET, _ONTO], :, :].any():
        raise ImageError(
            "contract 1 has no channels for seams between sheets of cloth; use contract 2"
        )
    if types[..., _CREASE, :, :].any():
        raise ImageError("contract 1 has no channels for creases; use contract 2")
    kept = types[..., : wanted.edge_type_count, :, :].copy()
    kept[..., _FRONT_TO_BACK, :, :] += types[..., _WRAP, :, :]
    return join_channels(flags, kept, vectors)


def one_hot(
    edge_type: Integer[np.ndarray, "*n row col"], count: int = EDGE_TYPE_COUNT
) -> Bool[np.ndarray, "*n type row col"]:
    """Which of the first `count` types each grid edge has."""
    is_type: Bool[np.ndarray, "*n type row col"] = (
        edge_type[..., None, :, :] == np.arange(count)[:, None, None]
    )
    return is_type


def check_channels(array: Any) -> Float64[np.ndarray, "channel row col"]:
    """`array` as float64 [17 L or 26 L, N, N].

    Args:
        array: [17 L, N, N] or [L, 17, N, N], or so with 26, any real type.

    Raises:
        ImageError: a wrong shape, or values that are not finite.
    """
    try:
        array = np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ImageError(
            f"channels are not an array of numbers ({error}); load_image(path) reads a file"
        ) from None
    sizes = [contract.channels_per_layer for contract in CONTRACTS.values()]
    if array.ndim == 4 and array.shape[1] in sizes:  # as rows of a dataset have it
        array = array.reshape(-1, *array.shape[2:])
    if array.ndim != 3 or array.shape[1] != array.shape[2]:
        raise ImageError(f"channels have shape {array.shape}; wanted [17 x layers, N, N]")
    contract_of(array.shape[0])
    grid = array.shape[1]
    if not MIN_GRID <= grid <= MAX_GRID:
        raise ImageError(f"a grid of {grid} cells; wanted {MIN_GRID} to {MAX_GRID}")
    if not (np.abs(array) <= np.finfo(np.float32).max).all():
        raise ImageError("channels hold values that are not finite (NaN, infinity or over 3e38)")
    checked: Float64[np.ndarray, "channel row col"] = array
    return checked
