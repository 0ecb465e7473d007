"""Where the grid stands on the body: one fixed frame per grid size, the same for every garment.

Grid lines pass through landmarks of the body and are spread evenly between them, so a cell means
a place on the body, more cells lie where seams are, and nothing moves when a hood or a sleeve is
added. The body stands in a T-pose, feet on the floor. The landmarks lie where the seams of real
patterns gather, so that seams fall on grid lines and not between them.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

HEIGHTS = (
    # (height above the floor [cm], grid line at N = 16)
    (-20.0, 0.0),
    (10.0, 1.0),  # ankle
    (78.0, 6.0),  # crotch
    (99.0, 8.0),  # waist
    (138.0, 12.0),  # shoulder
    (174.0, 15.0),  # top of a hood
    (190.0, 16.0),
)
"""Landmark heights of the mean adult body and the grid lines that pass through them."""

WIDTHS = (
    # (distance from the body's axis [cm], columns from the centre at N = 16)
    (0.0, 0.0),
    (8.0, 1.0),  # side of the neck
    (24.0, 3.0),  # armpit
    (74.0, 7.0),  # wrist
    (120.0, 8.0),
)
"""Landmark distances from the body's axis and the grid lines that pass through them."""


@dataclass(frozen=True)
class BodyFrame:
    """Positions of the grid lines on the body.

    x runs to the right of a picture of the front, 0 on the body's axis; y is up, 0 on the floor.
    """

    columns: tuple[float, ...]
    """x of the N + 1 vertical grid lines [cm], increasing."""
    rows: tuple[float, ...]
    """y of the N + 1 horizontal grid lines [cm], increasing."""

    @classmethod
    def standard(cls, grid: int) -> "BodyFrame":
        """The frame that every garment of this grid size shares."""
        scale = grid / 16
        y, row = np.array(HEIGHTS).T
        x, column = np.array(WIDTHS).T
        lines = np.arange(grid + 1)
        rows = np.interp(lines, row * scale, y)
        full_x = np.concatenate([-x[:0:-1], x])
        full_column = grid / 2 + np.concatenate([-column[:0:-1], column]) * scale
        columns = np.interp(lines, full_column, full_x)
        return cls(tuple(map(float, columns)), tuple(map(float, rows)))

    @property
    def grid(self) -> int:
        """Cells along each side, N."""
        return len(self.columns) - 1

    @property
    def is_symmetric(self) -> bool:
        """Whether the body's axis is the middle grid line and both sides are alike."""
        return all(a == -b for a, b in zip(self.columns, reversed(self.columns), strict=True))

    def to_lattice(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """Body positions [cm] as lattice coordinates; beyond the grid the last cell goes on."""
        x, y = np.asarray(points, float).T
        return np.stack([_map(x, self.columns), _map(y, self.rows)], axis=1)

    def to_body(self, lattice: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """Lattice coordinates as body positions [cm]."""
        lines = np.arange(self.grid + 1)
        x, y = np.asarray(lattice, float).T
        return np.stack([np.interp(x, lines, self.columns), np.interp(y, lines, self.rows)], axis=1)


def _map(values: np.ndarray, lines: tuple[float, ...]) -> np.ndarray:
    count = len(lines) - 1
    inside = np.interp(values, lines, np.arange(count + 1))
    below = np.minimum(values - lines[0], 0) / (lines[1] - lines[0])
    above = np.maximum(values - lines[-1], 0) / (lines[-1] - lines[-2])
    return np.asarray(inside + below + above)
