"""Lengths and points of the few curves that drafts consist of, at once and without tables.

Drafting measures many short curves, once each; a constant matrix times the control points does it
with a handful of array operations.
"""

from math import comb, hypot

import numpy as np
from jaxtyping import Float

from garmentimage.geometry.curves import Bezier, Curve

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_CHORDS = 16
"""Chords that stand for a curve in a polygon."""


def _bernstein(degree: int, t: np.ndarray) -> np.ndarray:
    """Bernstein polynomials of a degree at parameters t, as columns."""
    return np.stack(
        [comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)], axis=1
    )


_SPEED = {d: d * _bernstein(d - 1, (_NODES + 1) / 2) for d in (2, 3)}
_POINTS = {d: _bernstein(d, np.arange(_CHORDS) / _CHORDS) for d in (2, 3)}


def length_of(curve: Curve) -> float:
    """Length of a line or Bezier curve [cm], by Gauss-Legendre quadrature of its speed."""
    if not isinstance(curve, Bezier):
        return hypot(curve.end[0] - curve.start[0], curve.end[1] - curve.start[1])
    points = curve.points
    velocity = _SPEED[len(points) - 1] @ (points[1:] - points[:-1])
    return float(np.sqrt((velocity * velocity).sum(axis=1)) @ _WEIGHTS / 2)


def curve_points(curve: Bezier) -> Float[np.ndarray, "n 2"]:
    """Points of a Bezier curve, from its start to its end [cm]."""
    points = curve.points
    return np.concatenate([_POINTS[len(points) - 1] @ points, points[-1:]])


def chain_polygon(curves: tuple[Curve, ...]) -> Float[np.ndarray, "n 2"]:
    """A closed chain of lines and Bezier curves as a polygon, not closed [cm]."""
    rows = [
        _POINTS[len(c.controls) + 1] @ c.points if isinstance(c, Bezier) else np.array([c.start])
        for c in curves
    ]
    return np.concatenate(rows)
