"""Lengths and points of the few curves that drafts consist of, many at once and without tables.

Drafting measures many short curves, once each; a constant matrix times the control points does it
with a handful of array operations for all curves of one degree.
"""

from collections.abc import Sequence
from itertools import accumulate
from math import comb, hypot

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import Bezier, Curve, Point

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_CHORDS = 16
"""Chords that stand for a curve in a polygon."""
_DEGREES = (2, 3)
"""Degrees of Bezier curves."""


def _bernstein(degree: int, t: np.ndarray) -> np.ndarray:
    """Bernstein polynomials of a degree at parameters t, as columns."""
    return np.stack(
        [comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)], axis=1
    )


_SPEED = {d: d * _bernstein(d - 1, (_NODES + 1) / 2) for d in _DEGREES}
_POINTS = {d: _bernstein(d, np.arange(_CHORDS) / _CHORDS) for d in _DEGREES}


def length_of(curve: Curve) -> float:
    """Length of a line or Bezier curve [cm], by Gauss-Legendre quadrature of its speed."""
    if not isinstance(curve, Bezier):
        return hypot(curve.end[0] - curve.start[0], curve.end[1] - curve.start[1])
    return float(_speeds(curve.points) @ _WEIGHTS / 2)


def lengths_of(curves: Sequence[Curve]) -> list[float]:
    """`length_of` each of the curves [cm], to the last bit."""
    lengths = [0.0 if isinstance(curve, Bezier) else length_of(curve) for curve in curves]
    for numbers, points in _beziers(curves):
        # Rows times a column: every curve is summed up as if it were alone.
        own = (_speeds(points)[:, None] @ _WEIGHTS[:, None] / 2).ravel()
        for number, length in zip(numbers, own.tolist(), strict=True):
            lengths[number] = length
    return lengths


def curve_points(curve: Bezier) -> Float[np.ndarray, "n 2"]:
    """Points of a Bezier curve, from its start to its end [cm]."""
    points = curve.points
    return np.concatenate([_POINTS[len(points) - 1] @ points, points[-1:]])


def chain_polygons(chains: Sequence[Sequence[Curve]]) -> list[Float[np.ndarray, "_ 2"]]:
    """Closed chains of lines and Bezier curves as polygons, not closed [cm]."""
    curves = [curve for chain in chains for curve in chain]
    firsts = [0, *accumulate(_CHORDS if isinstance(c, Bezier) else 1 for c in curves)]
    polygons = np.empty((firsts[-1], 2))
    polygons[firsts[:-1]] = [curve.start for curve in curves]
    for numbers, points in _beziers(curves):
        rows = np.array([firsts[number] for number in numbers])[:, None] + np.arange(_CHORDS)
        polygons[rows] = _POINTS[points.shape[1] - 1] @ points
    ends = [firsts[count] for count in accumulate(len(chain) for chain in chains)]
    return [polygons[start:end] for start, end in zip([0, *ends], ends, strict=False)]


def _speeds(points: Float[np.ndarray, "*n k 2"]) -> Float[np.ndarray, "*n 16"]:
    """Speeds of Bezier curves at the nodes, from their control points."""
    velocity = _SPEED[points.shape[-2] - 1] @ (points[..., 1:, :] - points[..., :-1, :])
    speeds: np.ndarray = np.sqrt((velocity * velocity).sum(axis=-1))
    return speeds


def _beziers(curves: Sequence[Curve]) -> list[tuple[list[int], Float[np.ndarray, "_ _ 2"]]]:
    """Of each degree: which of the curves have it, and their control points [cm]."""
    numbers: dict[int, list[int]] = {degree: [] for degree in _DEGREES}
    points: dict[int, list[tuple[Point, ...]]] = {degree: [] for degree in _DEGREES}
    for number, curve in enumerate(curves):
        if isinstance(curve, Bezier):
            degree = len(curve.controls) + 1
            numbers[degree].append(number)
            points[degree].append((curve.start, *curve.controls, curve.end))
    return [(numbers[d], np.array(points[d], float)) for d in _DEGREES if numbers[d]]
