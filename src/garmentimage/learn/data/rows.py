"""Tensors in step: row k of each of them is of garment k."""

from collections.abc import Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import torch
from torch import Tensor

from garmentimage.errors import DatasetError, quoted
from garmentimage.system import shown_path

Rows = TypeVar("Rows", bound="TensorRows")
"""By hand, as the run-time shape checks cannot see what `Self` stands for."""


class TensorRows:
    """Base of a dataclass whose fields are tensors, or such dataclasses again, with a row a
    garment.

    Such dataclasses are not frozen: Lightning Fabric casts their fields where precision is mixed.
    """

    def _columns(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    def __len__(self) -> int:
        return len(next(iter(self._columns().values())))

    def batch(self: Rows, numbers: Tensor) -> Rows:
        """The rows of these numbers."""
        return type(self)(
            **{
                name: column.batch(numbers) if isinstance(column, TensorRows) else column[numbers]
                for name, column in self._columns().items()
            }
        )

    def parts(self: Rows, size: int = 256) -> Iterator[Rows]:
        """All rows in their order, in batches of this size."""
        return (self.batch(numbers) for numbers in torch.arange(len(self)).split(size))

    def to(self: Rows, device: torch.device) -> Rows:
        """The same on another device."""
        return type(self)(**{name: each.to(device) for name, each in self._columns().items()})


class ImageRows(TensorRows):
    """Such rows with an image each, in the field `pictures`."""

    pictures: Tensor

    def images(self) -> Tensor:
        """RGB from 0 to 1, [n, 3, pixel row, pixel column], the lowest row of pixels first."""
        return self.pictures.float() / 255


def join_rows(parts: Sequence[Rows], folder: str | Path, split: str) -> Rows:
    """The rows of all shards of a split.

    Raises:
        DatasetError: there are none.
    """
    if not parts:
        raise DatasetError(f"{shown_path(folder)}: its split {quoted(split)} has no rows")
    columns = zip(*(vars(part).values() for part in parts), strict=True)
    return type(parts[0])(*(torch.cat(column) for column in columns))
