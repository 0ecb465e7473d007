"""Plane curves from one point to another: lines, Bezier curves, circular arcs.

All are small frozen values. `t` is the curve's own parameter in 0..1; `s` is the share of its
length, also 0..1. Lengths come from a fixed chord table, so they are the same on every run.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import hypot

import numpy as np
from jaxtyping import Float

from garmentimage.geometry.polygons import lengths_along

Point = tuple[float, float]

CHORDS = 64
"""Chords that stand for a curved curve when it is measured."""
_TABLE_PARAMETERS = np.linspace(0.0, 1.0, CHORDS + 1)
_ENDS = np.array([0.0, 1.0])


def _weights(t: Float[np.ndarray, " n"], controls: int) -> Float[np.ndarray, "n point"]:
    """Bernstein polynomials of a Bezier curve with one or two control points."""
    u = 1 - t
    if controls == 1:
        return np.stack([u * u, 2 * t * u, t * t], axis=1)
    return np.stack([u * u * u, 3 * t * u * u, 3 * t * t * u, t * t * t], axis=1)


_TABLE_WEIGHTS = {controls: _weights(_TABLE_PARAMETERS, controls) for controls in (1, 2)}


class Curve(ABC):
    """A curve, measured by its chords."""

    start: Point
    end: Point
    is_straight = False

    @abstractmethod
    def at(self, t: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Points at the parameters `t`."""

    @abstractmethod
    def split(self, t: float) -> tuple["Curve", "Curve"]:
        """The two parts before and after `t`."""

    @abstractmethod
    def reversed(self) -> "Curve":
        """The same curve walked the other way."""

    @cached_property
    def polyline(self) -> Float[np.ndarray, "n 2"]:
        """The chords by which it is measured: the two ends of a line, `CHORDS` + 1 points else."""
        return self.at(_TABLE_PARAMETERS)

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        return _ENDS if self.is_straight else _TABLE_PARAMETERS, lengths_along(self.polyline)

    @cached_property
    def length(self) -> float:
        """Length along the curve."""
        return float(self._table[1][-1])

    def parameter(self, s: float) -> float:
        """The parameter t at the share `s` of the length."""
        t, lengths = self._table
        return float(np.interp(s * lengths[-1], lengths, t))

    def sample(self, count: int) -> Float[np.ndarray, "n 2"]:
        """`count` + 1 points from start to end, evenly spaced by length; the ends are exact."""
        t, lengths = self._table
        points = self.at(np.interp(np.linspace(0, lengths[-1], count + 1), lengths, t))
        points[0], points[-1] = self.start, self.end
        return points


@dataclass(frozen=True)
class Line(Curve):
    """A straight line."""

    start: Point
    end: Point
    is_straight = True

    def at(self, t: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Points at the parameters `t`."""
        t = np.asarray(t, float)[:, None]
        return np.asarray((1 - t) * np.array(self.start) + t * np.array(self.end))

    @cached_property
    def polyline(self) -> Float[np.ndarray, "n 2"]:
        """The chords by which it is measured."""
        return np.array([self.start, self.end], float)

    @cached_property
    def length(self) -> float:
        """Length along the curve."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def sample(self, count: int) -> Float[np.ndarray, "n 2"]:
        """`count` + 1 points from start to end, evenly spaced by length; the ends are exact."""
        return np.array([self.start, self.end]) if count == 1 else super().sample(count)

    def split(self, t: float) -> tuple["Line", "Line"]:
        """The two parts before and after `t`."""
        (middle,) = self.at(np.array([t]))
        point = to_point(middle)
        return Line(self.start, point), Line(point, self.end)

    def reversed(self) -> "Line":
        """The same curve walked the other way."""
        return Line(self.end, self.start)


@dataclass(frozen=True)
class Bezier(Curve):
    """A quadratic (one control point) or cubic (two control points) Bezier curve."""

    start: Point
    controls: tuple[Point, ...]
    end: Point

    @property
    def points(self) -> Float[np.ndarray, "n 2"]:
        """Start, control points, end."""
        return np.array([self.start, *self.controls, self.end], float)

    def at(self, t: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Points at the parameters `t`."""
        return np.asarray(_weights(np.asarray(t, float), len(self.controls)) @ self.points)

    @cached_property
    def polyline(self) -> Float[np.ndarray, "n 2"]:
        """The chords by which it is measured."""
        return np.asarray(_TABLE_WEIGHTS[len(self.controls)] @ self.points)

    def split(self, t: float) -> tuple["Bezier", "Bezier"]:
        """The two parts before and after `t` (de Casteljau)."""
        rows = [self.points]
        while len(rows[-1]) > 1:
            p = rows[-1]
            rows.append((1 - t) * p[:-1] + t * p[1:])
        first = [to_point(r[0]) for r in rows]
        second = [to_point(r[-1]) for r in reversed(rows)]
        return (
            Bezier(self.start, tuple(first[1:-1]), first[-1]),
            Bezier(second[0], tuple(second[1:-1]), self.end),
        )

    def reversed(self) -> "Bezier":
        """The same curve walked the other way."""
        return Bezier(self.end, self.controls[::-1], self.start)


@dataclass(frozen=True)
class Arc(Curve):
    """A circular arc; `right` bulges to the right of start -> end, `large` takes the long way.

    A radius shorter than half the chord is read as half the chord (rounding makes such files).
    """

    start: Point
    end: Point
    radius: float
    large: bool
    right: bool

    @cached_property
    def _circle(self) -> tuple[np.ndarray, float, float, float]:
        """Centre, radius, first angle, swept angle (negative when clockwise)."""
        a, b = np.array(self.start), np.array(self.end)
        chord = b - a
        half = float(np.hypot(*chord)) / 2
        radius = max(self.radius, half)
        height = np.sqrt(max(radius * radius - half * half, 0.0))
        normal = np.array([-chord[1], chord[0]]) / (2 * half)
        # An arc that bulges right runs counter-clockwise round its centre, which then lies left.
        side = 1.0 if self.right != self.large else -1.0
        centre = (a + b) / 2 + side * height * normal
        first = np.arctan2(*(a - centre)[::-1])
        last = np.arctan2(*(b - centre)[::-1])
        swept = (last - first) % (2 * np.pi)
        if not self.right:
            swept -= 2 * np.pi
        return centre, radius, float(first), float(swept)

    def at(self, t: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Points at the parameters `t`."""
        centre, radius, first, swept = self._circle
        angle = first + np.asarray(t, float) * swept
        return centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def split(self, t: float) -> tuple["Arc", "Arc"]:
        """The two parts before and after `t`."""
        _, radius, _, swept = self._circle
        (middle,) = self.at(np.array([t]))
        point = to_point(middle)
        return (
            Arc(self.start, point, radius, abs(swept) * t > np.pi, self.right),
            Arc(point, self.end, radius, abs(swept) * (1 - t) > np.pi, self.right),
        )

    def reversed(self) -> "Arc":
        """The same curve walked the other way."""
        return Arc(self.end, self.start, self.radius, self.large, not self.right)


def to_point(xy: Float[np.ndarray, " 2"]) -> Point:
    """The point of an array."""
    return float(xy[0]), float(xy[1])
