"""Rows of a dataset as a PyTorch stream: one row group in memory at a time."""

from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import torch
from torch.utils.data import IterableDataset, get_worker_info

from garmentimage.dataset.read import raster_arrays, read_header, row_group, shard_files
from garmentimage.errors import DatasetError, quoted
from garmentimage.system import did_you_mean, shown_path


class RowStream(IterableDataset[dict[str, Any]]):
    """The rows of a split, for a `DataLoader` with any number of workers.

    Each row is a dict: `raster` a float32 tensor (layer, 26, N, N), pictures uint8 tensors
    (3, row, col), `panels` a uint8 tensor (row, col), all else as it is in the dataset.

    Args:
        folder: what `garmentimage build` wrote.
        split: `train`, `validation`, `test` or `unseen`.
        columns: to read; all by default.
        without: types to leave out.
        only: types to read; all by default.
        seed: shuffles row groups and the rows in each; the same seed and epoch give the same
            order. None: in the order of the dataset.

    Raises:
        DatasetError: there is no such split, column or type, or an invalid seed.
    """

    def __init__(
        self,
        folder: str | Path,
        split: str = "train",
        *,
        columns: Collection[str] = (),
        without: Collection[str] = (),
        only: Collection[str] = (),
        seed: int | None = None,
    ) -> None:
        super().__init__()
        headers = {file: read_header(file) for file in shard_files(folder, split)}
        first = next(iter(headers.values()))
        self.columns = tuple(columns) or first.columns
        for name in self.columns:
            if name not in first.columns:
                raise DatasetError(f"{shown_path(folder)}: has no column {quoted(name)}")
        self.without, self.only = (_types(first.metadata.types, names) for names in (without, only))
        if seed is not None and (not isinstance(seed, int) or seed < 0):
            raise DatasetError(f"seed is {seed!r}; give a whole number from 0")
        self.seed, self.epoch = seed, 0
        self.groups = [(file, k) for file, each in headers.items() for k in range(each.row_groups)]

    def set_epoch(self, epoch: int) -> None:
        """Shuffle differently in each epoch."""
        self.epoch = epoch

    def __iter__(self) -> Iterator[dict[str, Any]]:
        order, info = list(range(len(self.groups))), get_worker_info()
        if self.seed is not None:
            np.random.default_rng([self.seed, self.epoch]).shuffle(order)
        if info is not None:
            order = order[info.id :: info.num_workers]
        for number in order:
            file, group = self.groups[number]
            table = row_group(file, group, [*{*self.columns, "type"}])
            yield from self._rows(table, number)

    def _rows(self, table: pa.Table, number: int) -> Iterator[dict[str, Any]]:
        types = table["type"].to_pylist()
        wanted = [
            k
            for k, name in enumerate(types)
            if name not in self.without and (not self.only or name in self.only)
        ]
        if self.seed is not None:
            np.random.default_rng([self.seed, self.epoch, number]).shuffle(wanted)
        images = raster_arrays(table["raster"]) if "raster" in self.columns else []
        plain = table.drop_columns(["raster"]) if images else table
        for k in wanted:
            row = plain.slice(k, 1).to_pylist()[0]
            row = {name: _tensor(name, row[name]) for name in self.columns if name in row}
            yield row | ({"raster": torch.from_numpy(images[k].copy())} if images else {})


def _types(known: Collection[str], names: Collection[str]) -> frozenset[str]:
    """Check the names of types."""
    if isinstance(names, str):
        raise DatasetError(f"types are given as a list, [{names!r}], not as {names!r}")
    for name in names:
        if name not in known:
            raise DatasetError(
                f"the dataset has no type {name!r}; {did_you_mean(str(name), known)}"
            )
    return frozenset(names)


def _tensor(name: str, value: Any) -> Any:
    if not isinstance(value, dict) or "bytes" not in value:
        return value
    from PIL import Image

    picture = Image.open(BytesIO(value["bytes"]))
    if name == "panels":
        return torch.from_numpy(np.array(picture))
    return torch.from_numpy(np.array(picture.convert("RGB"))).permute(2, 0, 1).contiguous()
