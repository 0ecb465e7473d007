"""Polylines from the grid refitted to the lines and smooth curves that a pattern is drawn with.

A **run** is a stretch of boundary between two seam ends. It is cut at true corners, and each part
becomes one line, circular arc, quadratic or cubic curve where that follows the run within a
tolerance; else it is cut again where it turns most. Both sides of a seam are cut at the same grid
points, so every edge keeps one partner. Where no curve will do, the polyline's own chords stay.

The encoder lays grid points at even shares of an edge's length. So a curve is fitted such that
each grid point lies at its share of the *curve's* length, which gives the edge back almost exactly
even from two or three chords, and with it the seam's length.
"""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import Arc, Bezier, Curve, Line, to_point
from garmentimage.raster.decode._kernels_curve_fit import ARC, LINE, REFUSED, find_corners, fit_run

SMOOTH_JOINT = np.deg2rad(12.0)
"""Where a run was cut only because one curve would not do, and two curved parts meet at less than
this angle, they meet smoothly. At seam ends and beside lines patterns do have kinks this small."""


@dataclass(frozen=True)
class Part:
    """Points `first` to `last` of a run as one curve, on one or on both sides of a seam."""

    first: int
    last: int
    curves: tuple[Curve, ...]


def cut_run(sides: tuple[Float[np.ndarray, "n 2"], ...], *, chords: bool = False) -> list[Part]:
    """Cut a run into parts that are one curve each.

    Args:
        sides: the run's points [cm] on one side, or on both sides of a seam in the same order.
        chords: keep every chord as a straight edge.
    """
    count = len(sides[0])
    assert count > 1 and all(len(s) == count for s in sides)
    if chords or count == 2:
        return [_chord(sides, k) for k in range(count - 1)]
    looks = [find_corners(np.ascontiguousarray(s)) for s in sides]
    turns = np.maximum(looks[0][0], looks[-1][0])
    corners = np.logical_or(looks[0][1], looks[-1][1])
    cuts = [0, *(np.flatnonzero(corners) + 1).tolist(), count - 1]
    parts: list[Part] = []
    for first, last in pairwise(cuts):
        parts.extend(_fit_parts(sides, first, last, turns))
    return parts


def fit_curve(points: Float[np.ndarray, "n 2"]) -> Curve | None:
    """The line, circular arc or Bézier curve through the ends of `points` that follows the rest.

    Returns:
        None where no single curve stays within the tolerance.
    """
    kind, controls, radius, swept = fit_run(np.ascontiguousarray(points))
    start, end = to_point(points[0]), to_point(points[-1])
    if kind == REFUSED:
        return None
    if kind == LINE:
        return Line(start, end)
    if kind == ARC:
        return Arc(start, end, radius, large=abs(swept) > np.pi, right=swept > 0)
    return Bezier(start, tuple(to_point(c) for c in controls[:kind]), end)


def _join_smoothly(before: Curve, after: Curve) -> tuple[Curve, Curve]:
    """Turn the ends of two curves that meet nearly smoothly until they do.

    Only control points move; both keep their ends and, to second order, their lengths.
    """
    if not (isinstance(before, Bezier) and isinstance(after, Bezier)):
        return before, after
    into, out = _direction(before.reversed()), _direction(after)
    into = -into[0], -into[1]
    angle = math.atan2(into[0] * out[1] - into[1] * out[0], into[0] * out[0] + into[1] * out[1])
    if abs(angle) > SMOOTH_JOINT:
        return before, after
    turned = _turn_start(before.reversed(), angle / 2).reversed()
    return turned, _turn_start(after, -angle / 2)


def _direction(curve: Bezier) -> tuple[float, float]:
    """From the start of a curve towards its first control point."""
    (x, y), (u, v) = curve.start, curve.controls[0]
    return u - x, v - y


def _turn_start(curve: Bezier, angle: float) -> Bezier:
    """The curve with the direction at its start turned; one control point becomes two."""
    controls = curve.controls
    if len(controls) == 1:
        (cx, cy) = controls[0]
        ends = (curve.start, curve.end)
        controls = tuple(((x + 2 * cx) / 3, (y + 2 * cy) / 3) for x, y in ends)
    (x, y), (cx, cy) = curve.start, controls[0]
    cos, sin = math.cos(angle), math.sin(angle)
    dx, dy = cx - x, cy - y
    turned = (x + cos * dx - sin * dy, y + sin * dx + cos * dy)
    return Bezier(curve.start, (turned, controls[1]), curve.end)


def _fit_parts(
    sides: tuple[np.ndarray, ...], first: int, last: int, turns: np.ndarray
) -> list[Part]:
    if last == first + 1:
        return [_chord(sides, first)]
    curves: list[Curve] = []
    for side in sides:
        curve = fit_curve(side[first : last + 1])
        if curve is None:
            cut = first + 1 + int(np.argmax(turns[first : last - 1]))
            head, tail = _fit_parts(sides, first, cut, turns), _fit_parts(sides, cut, last, turns)
            meeting = zip(head[-1].curves, tail[0].curves, strict=True)
            before, after = zip(*(_join_smoothly(a, b) for a, b in meeting), strict=True)
            head[-1], tail[0] = replace(head[-1], curves=before), replace(tail[0], curves=after)
            return head + tail
        curves.append(curve)
    return [Part(first, last, tuple(curves))]


def _chord(sides: tuple[np.ndarray, ...], k: int) -> Part:
    return Part(k, k + 1, tuple(Line(to_point(s[k]), to_point(s[k + 1])) for s in sides))
