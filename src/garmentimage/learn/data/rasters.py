"""Rasters of a dataset as compact tensors, kept in memory for training."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32, Int8
from torch import Tensor

from garmentimage.dataset import raster_arrays, read_tables
from garmentimage.errors import DatasetError, ImageError
from garmentimage.learn.data.rows import TensorRows, join_rows
from garmentimage.raster import (
    CONTRACTS,
    EDGE_TYPE_COUNT,
    PLAIN_LAYOUT,
    BodyFrame,
    ChannelLayout,
    Contract,
    split_channels,
    with_contract,
)
from garmentimage.system import shown_path

LAYERS = PLAIN_LAYOUT.layers
VECTOR_CM = 10.0
"""Unit of the networks' edge vectors, which are differences from the undeformed grid's [cm]."""


@dataclass
class Rasters(TensorRows):
    """The GarmentImages of some garments, all with the same layers, the front first."""

    inside: Int8[Tensor, "n layer row col"]
    types: Int8[Tensor, "n edge row col"]
    """`EdgeType` of the bottom and the left grid edge of each layer."""
    vectors: Float[Tensor, "n vector row col"]
    """Edge vectors minus those of the undeformed grid [`VECTOR_CM`]; 0 outside."""
    turned: Int8[Tensor, "n turned_layer row col"]
    """Where the wrong side of the cloth is out; in contract 1, which has none, of no layers."""

    @property
    def grid(self) -> int:
        """Cells a side, N."""
        return self.inside.shape[-1]

    def mirrored(self) -> "Rasters":
        """The same garments with left and right exchanged."""
        types = self.types.flip(-1)
        # A cell's left edge is the right edge of its mirror image, that is, the left edge of the
        # next cell; the last column has no next cell.
        left = torch.roll(types[:, 1::2], 1, -1)
        left[..., 0] = 0
        types = torch.stack([types[:, ::2], left], 2).flatten(1, 2)
        vectors = mirrored_vectors(self.vectors)
        return Rasters(self.inside.flip(-1), types, vectors, self.turned.flip(-1))

    @property
    def layout(self) -> ChannelLayout:
        """Their contract and layers."""
        contract = CONTRACTS[2 if self.turned.shape[1] else 1]
        return ChannelLayout(contract, self.inside.shape[1])

    def flags(self) -> Int8[Tensor, "n flag row col"]:
        """Inside flags of all layers, then turned flags where the contract has them."""
        return torch.cat([self.inside, self.turned], 1)

    def inputs(self) -> Float32[Tensor, "n channel row col"]:
        """Input of the networks: flags, edge types one-hot, vectors."""
        count = self.layout.contract.edge_type_count
        kinds = torch.arange(count, device=self.types.device)[:, None, None]
        one_hot = (self.types[:, :, None] == kinds).flatten(1, 2)
        return torch.cat([self.flags().float(), one_hot.float(), self.vectors.float()], 1)


@dataclass(frozen=True)
class LabelledRasters:
    """Rasters of a dataset split, with ids and garment types."""

    rasters: Rasters
    ids: tuple[str, ...]
    types: tuple[str, ...]


def read_rasters(
    folder: str | Path, split: str, layout: ChannelLayout = PLAIN_LAYOUT
) -> LabelledRasters:
    """Load the rasters of a split.

    Args:
        folder: of the dataset.
        split: its name, such as `train`.
        layout: contract and layers of the rasters; garments with fewer layers get empty ones.

    Raises:
        DatasetError: there is no such split, or the layout does not hold one of its garments.
    """
    parts: list[Rasters] = []
    ids: list[str] = []
    names: list[str] = []
    for table in read_tables(folder, split, ["id", "type", "raster"]):
        if len(table):
            parts.append(column_rasters(table["raster"], folder, layout))
        ids += table["id"].to_pylist()
        names += table["type"].to_pylist()
    return LabelledRasters(join_rows(parts, folder, split), tuple(ids), tuple(names))


def column_rasters(
    column: Any, folder: str | Path, layout: ChannelLayout = PLAIN_LAYOUT
) -> Rasters:
    """The rasters of some rows of a dataset, one or more.

    Raises:
        DatasetError: the layout does not hold one of them.
    """
    images = raster_arrays(column)
    most = max(len(image) for image in images)
    if most > layout.layers:
        raise DatasetError(
            f"{shown_path(folder)}: has garments with a second sheet of cloth ({most} layers), and "
            f"the network {layout.layers}; of the networks, only the VAE can have more: train it "
            f"with --contract 2 --layers {most}"
        )
    try:
        return rasters_from_channels(np.stack([_padded(each, layout) for each in images]), layout)
    except ImageError as error:
        raise DatasetError(
            f"{shown_path(folder)}: {error}: train a VAE with --contract 2"
        ) from None


def _padded(
    image: Float32[np.ndarray, "layer channel row col"], layout: ChannelLayout
) -> Float32[np.ndarray, "all channel row col"]:
    """An image with empty layers after its own: no cloth, and grid edges that are the first type,
    NON_BOUNDARY, as no type is larger than it.
    """
    missing = layout.layers - len(image)
    empty = np.zeros((missing, *image.shape[1:]), image.dtype)
    return np.concatenate([image, empty]) if missing else image


def rasters_from_channels(
    channels: Float[np.ndarray, "n layer channel row col"], layout: ChannelLayout = PLAIN_LAYOUT
) -> Rasters:
    """Rasters of channels in the order of `GarmentImage.to_channels`, layer by layer.

    In contract 1, panels that wrap round the body are cut in a front and a back part.

    Raises:
        ImageError: contract 1 does not hold one of them.
    """
    count, grid = len(channels), channels.shape[-1]
    wanted: Contract = 1 if layout.contract == CONTRACTS[1] else 2
    converted = with_contract(channels.reshape(count, -1, grid, grid), wanted)
    flags, one_hot, edges, turned_flags = split_channels(converted)
    inside = flags > 0.5
    turned = inside[:, :0] if turned_flags is None else inside & (turned_flags > 0.5)
    types = one_hot.argmax(3).reshape(count, 2 * layout.layers, grid, grid)
    rest = rest_vectors(grid).reshape(4, 2, grid, grid)
    vectors = (edges - rest) / VECTOR_CM * inside[:, :, None, None]
    return Rasters(
        torch.from_numpy(inside.astype(np.int8)),
        torch.from_numpy(types.astype(np.int8)),
        torch.from_numpy(vectors.reshape(count, -1, grid, grid).astype(np.float16)),
        torch.from_numpy(turned.astype(np.int8)),
    )


def mirrored_flags(flags: Float[Tensor, "n 2 row col"]) -> Float[Tensor, "n 2 row col"]:
    """Flags with left and right exchanged."""
    return flags.flip(-1)


def mirrored_types(types: Float[Tensor, "n 16 row col"]) -> Float[Tensor, "n 16 row col"]:
    """Values for each edge type of contract 1 with left and right exchanged."""
    bottom, left = types.flip(-1).unflatten(1, (LAYERS, 2, EDGE_TYPE_COUNT)).unbind(2)
    # As in `Rasters.mirrored`; the last column has no next cell, so its own values are repeated.
    left = torch.cat([left[..., :1], left[..., :-1]], -1)
    return torch.stack([bottom, left], 2).flatten(1, 3)


def mirrored_vectors(
    vectors: Float[Tensor, "n vector row col"],
) -> Float[Tensor, "n vector row col"]:
    """Edge vectors of cells with left and right exchanged."""
    bottom, right, top, left = vectors.flip(-1).unflatten(1, (-1, 4, 2)).unbind(2)
    across, upright = (torch.tensor(signs).to(vectors) for signs in ([1, -1], [-1, 1]))
    turned = [
        edge * signs[:, None, None]
        for edge, signs in ((bottom, across), (left, upright), (top, across), (right, upright))
    ]
    return torch.stack(turned, 2).flatten(1, 3)


def rest_vectors(grid: int) -> Float32[np.ndarray, "8 row col"]:
    """(dx, dy) of the bottom, right, top and left edge of the cells of the undeformed grid [cm]."""
    frame = BodyFrame.standard(grid)
    vectors = np.zeros((4, 2, grid, grid), np.float32)
    vectors[[0, 2], 0] = np.diff(frame.columns)[None, :]
    vectors[[1, 3], 1] = np.diff(frame.rows)[:, None]
    return vectors.reshape(8, grid, grid)
