"""Tensors in step: row k of each of them is of garment k."""

from dataclasses import fields
from typing import Any, TypeVar

import torch
from torch import Tensor

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

    def to(self: Rows, device: torch.device) -> Rows:
        """The same on another device."""
        return type(self)(**{name: each.to(device) for name, each in self._columns().items()})


class ImageRows(TensorRows):
    """Such rows with an image each, in the field `pictures`."""

    pictures: Tensor

    def images(self) -> Tensor:
        """RGB from 0 to 1, [n, 3, pixel row, pixel column], the lowest row of pixels first."""
        return self.pictures.float() / 255
