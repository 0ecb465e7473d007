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
    CHANNELS_PER_LAYER,
    EDGE_TYPE_COUNT,
    BodyFrame,
    split_channels,
    with_contract,
)
from garmentimage.system import shown_path

LAYERS = 2
VECTOR_CM = 10.0
"""Unit of the networks' edge vectors, which are differences from the undeformed grid's [cm]."""
INPUT_CHANNELS = LAYERS * CHANNELS_PER_LAYER
"""Channels of an image, 34: flags, edge types (one-hot), edge vectors."""


@dataclass
class Rasters(TensorRows):
    """The GarmentImages of some garments, front and back."""

    inside: Int8[Tensor, "n 2 row col"]
    types: Int8[Tensor, "n 4 row col"]
    """`EdgeType` of the bottom and the left grid edge, front first."""
    vectors: Float[Tensor, "n 16 row col"]
    """Edge vectors minus those of the undeformed grid [`VECTOR_CM`]; 0 outside."""

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
        return Rasters(self.inside.flip(-1), types, mirrored_vectors(self.vectors))

    def inputs(self) -> Float32[Tensor, "n 34 row col"]:
        """Input of the networks: flags, edge types one-hot, vectors."""
        kinds = torch.arange(EDGE_TYPE_COUNT, device=self.types.device)[:, None, None]
        one_hot = (self.types[:, :, None] == kinds).flatten(1, 2)
        return torch.cat([self.inside.float(), one_hot.float(), self.vectors.float()], 1)


@dataclass(frozen=True)
class LabelledRasters:
    """Rasters of a dataset split, with ids and garment types."""

    rasters: Rasters
    ids: tuple[str, ...]
    types: tuple[str, ...]


def read_rasters(folder: str | Path, split: str) -> LabelledRasters:
    """Load the rasters of a split.

    Raises:
        DatasetError: there is no such split, or its garments do not have two layers.
    """
    parts: list[Rasters] = []
    ids: list[str] = []
    names: list[str] = []
    for table in read_tables(folder, split, ["id", "type", "raster"]):
        if len(table):
            parts.append(column_rasters(table["raster"], folder))
        ids += table["id"].to_pylist()
        names += table["type"].to_pylist()
    return LabelledRasters(join_rows(parts, folder, split), tuple(ids), tuple(names))


def column_rasters(column: Any, folder: str | Path) -> Rasters:
    """The rasters of some rows of a dataset, one or more.

    Raises:
        DatasetError: a garment does not have two layers.
    """
    images = raster_arrays(column)
    if any(len(image) != LAYERS for image in images):
        raise DatasetError(f"{shown_path(folder)}: has garments of more than one cloth layer")
    try:
        return rasters_from_channels(np.stack(images))
    except ImageError as error:
        raise DatasetError(f"{shown_path(folder)}: {error}") from None


def rasters_from_channels(channels: Float[np.ndarray, "n 2 channel row col"]) -> Rasters:
    """Rasters of channels in the order of `GarmentImage.to_channels`, layer by layer.

    Panels that wrap round the body are cut in a front and a back part.

    Raises:
        ImageError: there are turned panels.
    """
    count, grid = len(channels), channels.shape[-1]
    plain = with_contract(channels.reshape(count, -1, grid, grid), 1)
    flags, one_hot, edges, _ = split_channels(plain)
    inside = flags > 0.5
    types = one_hot.argmax(3).reshape(count, 2 * LAYERS, grid, grid)
    rest = rest_vectors(grid).reshape(4, 2, grid, grid)
    vectors = (edges - rest) / VECTOR_CM * inside[:, :, None, None]
    return Rasters(
        torch.from_numpy(inside.astype(np.int8)),
        torch.from_numpy(types.astype(np.int8)),
        torch.from_numpy(vectors.reshape(count, -1, grid, grid).astype(np.float16)),
    )


def mirrored_flags(flags: Float[Tensor, "n 2 row col"]) -> Float[Tensor, "n 2 row col"]:
    """Flags with left and right exchanged."""
    return flags.flip(-1)


def mirrored_types(types: Float[Tensor, "n 16 row col"]) -> Float[Tensor, "n 16 row col"]:
    """Values for each edge type with left and right exchanged."""
    bottom, left = types.flip(-1).unflatten(1, (LAYERS, 2, EDGE_TYPE_COUNT)).unbind(2)
    # As in `Rasters.mirrored`; the last column has no next cell, so its own values are repeated.
    left = torch.cat([left[..., :1], left[..., :-1]], -1)
    return torch.stack([bottom, left], 2).flatten(1, 3)


def mirrored_vectors(vectors: Float[Tensor, "n 16 row col"]) -> Float[Tensor, "n 16 row col"]:
    """Edge vectors of cells with left and right exchanged."""
    bottom, right, top, left = vectors.flip(-1).unflatten(1, (LAYERS, 4, 2)).unbind(2)
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
