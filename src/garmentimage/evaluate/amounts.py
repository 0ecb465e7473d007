"""How many garments each evaluation measures; imports little, so that the command is quick."""

from dataclasses import dataclass, fields
from typing import Any

from garmentimage.errors import LearnError


@dataclass(frozen=True)
class LatentAmounts:
    """How many garments, pairs and edits of a latent space are measured.

    Raises:
        LearnError: one of them is less than 1.
    """

    garments: int = 300
    """Garments that are reconstructed."""
    pairs: int = 200
    """Pairs to interpolate: half of them within a type, half across types."""
    triplets: int = 100
    """Triplets of each kind of edit."""

    def __post_init__(self) -> None:
        _check_least(self, 1)


@dataclass(frozen=True)
class ImageAmounts:
    """How many garments are predicted from their pictures.

    Raises:
        LearnError: one of them is negative.
    """

    seen: int = 1000
    """Garments of types that are in the training data."""
    unseen: int = 500
    """Garments of types that are not."""
    parts: int = 300
    """Garments for each ablation: other levels of repair, ground truth in place of a part."""
    draped: int = 200
    """Garments that are draped, on the default body."""

    def __post_init__(self) -> None:
        _check_least(self, 0)

    def of(self, split: str) -> int:
        """Garments of a split."""
        return self.seen if split == "test" else self.unseen


def _check_least(amounts: Any, least: int) -> None:
    for each in fields(amounts):
        value = getattr(amounts, each.name)
        if value < least:
            raise LearnError(f"{each.name} is {value}; give {least} or more")
