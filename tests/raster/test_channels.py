"""The one place that knows the order of the 17 channels of a layer."""

import numpy as np
import pytest

from garmentimage.raster.channels import (
    CHANNELS_PER_LAYER,
    CONTRACTS,
    EDGE_TYPE_COUNT,
    MAX_LAYERS,
    contract_of,
    join_channels,
    one_hot,
    split_channels,
)
from garmentimage.raster.image import EdgeType


def numbered(*images: int, layers: int = 2, grid: int = 4) -> np.ndarray:
    shape = (*images, CHANNELS_PER_LAYER * layers, grid, grid)
    return np.arange(np.prod(shape), dtype=np.float32).reshape(shape)


@pytest.mark.parametrize("images", [(), (3,), (2, 5)])
@pytest.mark.parametrize("layers", [1, 2, 4])
def test_joining_undoes_splitting(images, layers):
    channels = numbered(*images, layers=layers)
    flags, types, vectors, _ = split_channels(channels)
    assert flags.shape == (*images, layers, 4, 4)
    assert types.shape == (*images, layers, 2, EDGE_TYPE_COUNT, 4, 4)
    assert vectors.shape == (*images, layers, 4, 2, 4, 4)
    again = join_channels(flags, types, vectors)
    assert np.array_equal(again, channels) and again.dtype == channels.dtype


def test_channels_stand_where_the_documents_say():
    channels = numbered()
    flags, types, vectors, _ = split_channels(channels)
    assert np.array_equal(flags[1], channels[17])
    assert np.array_equal(types[0, 0], channels[1:5]) and np.array_equal(types[0, 1], channels[5:9])
    assert np.array_equal(vectors[1, 3], channels[17 + 15 : 17 + 17])


def test_tensors_are_split_and_joined_as_arrays_are():
    torch = pytest.importorskip("torch")
    channels = numbered(3)
    parts = split_channels(torch.from_numpy(channels))
    for tensor, array in zip(parts, split_channels(channels), strict=True):
        assert (tensor is None) == (array is None)
        assert array is None or np.array_equal(tensor.numpy(), array)
    assert np.array_equal(join_channels(*parts).numpy(), channels)


def test_each_edge_type_is_one_hot():
    kinds = np.array([[list(EdgeType)]], np.int8)
    for contract in CONTRACTS.values():
        count = contract.edge_type_count
        expected = np.eye(count, len(EdgeType), dtype=bool)
        assert np.array_equal(one_hot(kinds, count)[0, :, 0], expected)


@pytest.mark.parametrize("number", CONTRACTS)
@pytest.mark.parametrize("layers", range(1, MAX_LAYERS + 1))
def test_the_number_of_channels_tells_the_contract(number, layers):
    contract = CONTRACTS[number]
    assert contract_of(layers * contract.channels_per_layer) is contract


def test_joining_undoes_splitting_in_contract_2():
    channels = np.arange(3 * 52 * 16, dtype=np.float32).reshape(3, 52, 4, 4)
    parts = split_channels(channels)
    assert np.array_equal(parts.turned[:, 1], channels[:, 27])
    assert np.array_equal(parts.types[:, 0, 1], channels[:, 10:18])
    assert np.array_equal(parts.vectors[:, 1, 3], channels[:, 50:52])
    assert np.array_equal(join_channels(*parts), channels)
