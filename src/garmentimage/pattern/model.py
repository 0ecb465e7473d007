"""The sewing pattern: small frozen values in cm.

Words of this file:

- An **edge** is one directed curve of a panel's boundary, from vertex `start` to vertex `end`.
  Its curvature is kept as pattern files give it, relative to the straight line between them.
- A **loop** is a closed chain of edges. A panel has one outer loop and any number of holes.
- Edges of a panel are numbered through: outer loop first, then the holes in order.
- Seen from outside the body a panel's outer loop runs counter-clockwise.
- A **side** is one edge of one panel; a **stitch** sews two sides together.
- Placement takes a panel point (x, y) to the world point R (x, y, 0) + T, with
  R = Rz Ry Rx from Euler angles in degrees about fixed axes; the world's y is up, +z is the
  front of the body.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import Arc, Bezier, Curve, Line, Point as Point, signed_area

Vector = tuple[float, float, float]

POLYGON_CHORDS = 16  # chords that stand for a curved edge in `polygon_of`


@dataclass(frozen=True)
class Quadratic:
    """One control point, in edge coordinates: along the edge, and to its left, per edge length."""

    control: Point


@dataclass(frozen=True)
class Cubic:
    """Two control points, in edge coordinates."""

    control: Point
    control2: Point


@dataclass(frozen=True)
class Circle:
    """Circular arc: radius [cm], the long way round or not, bulging right of the edge or not."""

    radius: float
    large: bool
    right: bool


Curvature = Quadratic | Cubic | Circle | None


@dataclass(frozen=True)
class Edge:
    """One directed curve of a loop, between two vertices of that loop."""

    start: int
    end: int
    curvature: Curvature = None
    label: str | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)
    """Fields of the file that we do not know; written back as they were."""


@dataclass(frozen=True)
class Loop:
    """A closed chain of edges: edge k ends where edge k + 1 starts."""

    vertices: tuple[Point, ...]
    edges: tuple[Edge, ...]

    @cached_property
    def curves(self) -> tuple[Curve, ...]:
        """Geometry of every edge, in panel coordinates [cm]."""
        return tuple(
            edge_curve(self.vertices[e.start], self.vertices[e.end], e.curvature)
            for e in self.edges
        )

    @cached_property
    def polygon(self) -> Float[np.ndarray, "n 2"]:
        """The loop as a polygon, not closed: see `polygon_of`."""
        return polygon_of(self.curves)

    @property
    def fine_polygon(self) -> Float[np.ndarray, "n 2"]:
        """The loop as a polygon, not closed: curves in the chords by which they are measured."""
        return np.concatenate([curve.polyline[:-1] for curve in self.curves])

    @cached_property
    def area(self) -> float:
        """Signed area [cm²]; positive when the loop runs counter-clockwise."""
        return signed_area(self.polygon)


@dataclass(frozen=True)
class Notch:
    """A matching mark on edge `edge`, at the share `at` (0..1) of its length."""

    edge: int
    at: float


@dataclass(frozen=True)
class Panel:
    """One flat piece of cloth and its place round the body."""

    name: str
    outline: Loop
    holes: tuple[Loop, ...] = ()
    translation: Vector = (0.0, 0.0, 0.0)
    """World position of the panel's origin [cm]."""
    rotation: Vector = (0.0, 0.0, 0.0)
    """Euler angles about the fixed axes x, y, z [degrees], applied in that order."""
    label: str | None = None
    grain: Point | None = None
    """Unit direction of the warp, in panel coordinates."""
    notches: tuple[Notch, ...] = ()
    cloth_layer: int = 0
    """0 next to the body; collars, lapels and pockets lie on 1 and up."""
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def loops(self) -> tuple[Loop, ...]:
        """Outer loop, then holes."""
        return (self.outline, *self.holes)

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """All edges, numbered through: outer loop, then holes."""
        return tuple(e for loop in self.loops for e in loop.edges)

    @property
    def edge_ranges(self) -> tuple[range, ...]:
        """For each loop the numbers of its edges."""
        ends = list(accumulate(len(loop.edges) for loop in self.loops))
        return tuple(map(range, (0, *ends), ends))

    @cached_property
    def curves(self) -> tuple[Curve, ...]:
        """Geometry of all edges, numbered as `edges` [cm]."""
        return tuple(c for loop in self.loops for c in loop.curves)

    @property
    def matrix(self) -> Float[np.ndarray, "3 3"]:
        """Rotation R = Rz Ry Rx."""
        return rotation_matrix(self.rotation)

    def to_world(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
        """Panel points placed round the body [cm]."""
        placed = np.asarray(points, float) @ self.matrix[:, :2].T
        return np.asarray(placed + np.array(self.translation))


@dataclass(frozen=True)
class Side:
    """One edge of one panel, as a stitch names it."""

    panel: str
    edge: int


@dataclass(frozen=True)
class Stitch:
    """Two sides sewn together; start meets end, or start meets start where `same_direction`."""

    a: Side
    b: Side
    same_direction: bool = False
    flag: str | None = None
    """A third entry of the file that we do not know; written back as it was."""
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def sides(self) -> tuple[Side, Side]:
        """Both sides."""
        return self.a, self.b


@dataclass(frozen=True)
class SewnOnto:
    """Edges of a panel that are sewn onto the cloth of another, away from its edges: a pocket."""

    panel: str
    edges: tuple[int, ...]
    """Of `panel`, in rising order."""
    on: str
    matrix: tuple[Point, Point]
    """2 x 2 orthogonal, rows: place on the panel `on` = matrix @ place on `panel` + offset."""
    offset: Point  # [cm]

    def carried(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """Places on `panel` as places on the panel that it is sewn onto [cm]."""
        return np.asarray(np.asarray(points, float) @ np.array(self.matrix).T + self.offset)

    @property
    def sides(self) -> tuple[Side, ...]:
        """The edges that are sewn on."""
        return tuple(Side(self.panel, edge) for edge in self.edges)


PleatFold = Literal["left", "right", "box", "inverted"]


@dataclass(frozen=True)
class Pleat:
    """A pressed pleat: two edges of an outline that follow each other, sewn to each other.

    Seen from outside, these edges at the top, a knife pleat is folded to the left or to the right:
    its visible fold points there. The two folds of a box pleat point away from each other, its
    cloth lies on top; those of an inverted pleat meet, its cloth lies beneath.
    """

    panel: str
    edges: tuple[int, int]
    """The second starts where the first ends."""
    fold: PleatFold
    pressed: float
    """How far from its edges the pleat is pressed [cm]."""

    @property
    def sides(self) -> tuple[Side, Side]:
        """The two edges."""
        first, second = self.edges
        return Side(self.panel, first), Side(self.panel, second)


@dataclass(frozen=True)
class Pattern:
    """A garment: panels and the stitches between them."""

    panels: tuple[Panel, ...]
    stitches: tuple[Stitch, ...] = ()
    name: str = field(default="", compare=False)
    """What to call the garment in messages and pictures: the file's stem. Not part of equality."""
    onto: tuple[SewnOnto, ...] = ()
    """Panels sewn onto the cloth of others."""
    pleats: tuple[Pleat, ...] = ()
    """Pleats that are pressed; one that is only sewn is a stitch like any other."""
    extra: Mapping[str, Any] = field(default_factory=dict)
    """What else the file held, by place: "top" (beside "pattern"), "pattern", "properties", and
    "ours" (in the field "garmentimage")."""

    @cached_property
    def by_name(self) -> Mapping[str, Panel]:
        """Panels by name."""
        return {p.name: p for p in self.panels}

    def curve(self, side: Side) -> Curve:
        """Geometry of one side, in panel coordinates [cm]."""
        return self.by_name[side.panel].curves[side.edge]

    def in_world(self, side: Side, t: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 3"]:
        """Points of one side at its parameters `t`, as the panels stand [cm]."""
        return self.by_name[side.panel].to_world(self.curve(side).at(t))

    @cached_property
    def partners(self) -> Mapping[Side, Side]:
        """For each sewn side, the side it is sewn to."""
        return {x: y for s in self.stitches for x, y in ((s.a, s.b), (s.b, s.a))}

    def sides(self) -> Iterator[Side]:
        """Every side of every panel."""
        return (Side(p.name, k) for p in self.panels for k in range(len(p.edges)))


def edge_curve(start: Point, end: Point, curvature: Curvature) -> Curve:
    """The curve from `start` to `end`: p = start + c_x e + c_y perp(e), perp(e) = (-e_y, e_x)."""
    match curvature:
        case None:
            return Line(start, end)
        case Circle(radius, large, right):
            return Arc(start, end, radius, large, right)
        case Quadratic(control):
            return Bezier(start, (_absolute(start, end, control),), end)
        case Cubic(control, control2):
            controls = _absolute(start, end, control), _absolute(start, end, control2)
            return Bezier(start, controls, end)


_STARTS = np.arange(POLYGON_CHORDS) / POLYGON_CHORDS
"""Parameters at which the chords of a curve begin."""


def chord_count(curve: Curve) -> int:
    """Sides of the polygon of `polygon_of` that stand for a curve."""
    return 1 if curve.is_straight else POLYGON_CHORDS


def polygon_of(curves: Sequence[Curve]) -> Float[np.ndarray, "n 2"]:
    """A closed chain of curves as a polygon, not closed [cm]; curves in `POLYGON_CHORDS` chords."""
    return np.concatenate([[c.start] if c.is_straight else c.at(_STARTS) for c in curves])


def curvature_of(curve: Curve) -> Curvature:
    """The relative curvature that gives back `curve`; the inverse of `edge_curve`."""
    if isinstance(curve, Arc):
        return Circle(curve.radius, curve.large, curve.right)
    if isinstance(curve, Bezier):
        controls = [relative_control(curve.start, curve.end, c) for c in curve.controls]
        return Quadratic(*controls) if len(controls) == 1 else Cubic(*controls)
    return None


def mirrored_curvature(curvature: Curvature) -> Curvature:
    """The curvature of an edge's mirror image, which runs the same way."""
    match curvature:
        case Quadratic((x, y)):
            return Quadratic((x, -y))
        case Cubic((x, y), (u, v)):
            return Cubic((x, -y), (u, -v))
        case Circle(radius, large, right):
            return Circle(radius, large, not right)
    return None


def relative_control(start: Point, end: Point, control: Point) -> Point:
    """A control point in the coordinates of the edge from `start` to `end`."""
    ex, ey = end[0] - start[0], end[1] - start[1]
    dx, dy = control[0] - start[0], control[1] - start[1]
    size = ex * ex + ey * ey
    return (dx * ex + dy * ey) / size, (dy * ex - dx * ey) / size


def _absolute(start: Point, end: Point, control: Point) -> Point:
    ex, ey = end[0] - start[0], end[1] - start[1]
    cx, cy = control
    return start[0] + cx * ex - cy * ey, start[1] + cx * ey + cy * ex


def loop_from_curves(curves: Sequence[Curve], labels: Sequence[str | None] = ()) -> Loop:
    """A loop whose edge k is `curves[k]`, labelled `labels[k]` if labels are given.

    Each curve starts where the one before it ends.
    """
    count = len(curves)
    edges = tuple(
        Edge(k, (k + 1) % count, curvature_of(curve), label)
        for k, (curve, label) in enumerate(zip(curves, labels or (None,) * count, strict=True))
    )
    return Loop(tuple(curve.start for curve in curves), edges)


def rotation_matrix(degrees: Vector) -> Float[np.ndarray, "3 3"]:
    """R = Rz Ry Rx for Euler angles about the fixed axes x, y, z [degrees]."""
    (ca, cb, cc), (sa, sb, sc) = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    rx = np.array([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])
    ry = np.array([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
    rz = np.array([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])
    return np.asarray(rz @ ry @ rx)


def euler_angles(matrix: Float[np.ndarray, "3 3"]) -> Vector:
    """Euler angles [degrees] with `rotation_matrix(euler_angles(R))` = R."""
    cb = float(np.hypot(matrix[0, 0], matrix[1, 0]))
    b = np.arctan2(-matrix[2, 0], cb)
    if cb > 1e-9:
        a = np.arctan2(matrix[2, 1], matrix[2, 2])
        c = np.arctan2(matrix[1, 0], matrix[0, 0])
    else:
        a, c = np.arctan2(-matrix[1, 2], matrix[1, 1]), 0.0
    x, y, z = (float(np.rad2deg(v)) for v in (a, b, c))
    return x, y, z
