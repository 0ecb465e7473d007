"""Panels while they are drawn: curves with the trade's names, counter-clockwise from outside.

Words of this file:

- A **half** is the part of a panel at x >= 0: curves from the lower end of the middle line round
  to its upper end. Seen from outside, x >= 0 is the wearer's left on the front and the wearer's
  right on the back.
- A **seam** is a run of edges, over one panel or several, in the order of the loops.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import hypot
from typing import NamedTuple

from garmentimage.body import BodyMeasurements
from garmentimage.draft.curves import length_of
from garmentimage.geometry import Bezier, Curve, Line, Point
from garmentimage.pattern import Loop, Vector

FRONT, BACK = "front", "back"
LEFT, RIGHT = "left", "right"
FACINGS = (FRONT, BACK)
SIDES = (LEFT, RIGHT)

GAP = 2.0
"""Between panels that lie beside each other before they are sewn [cm]."""
BODY_GAP = 3.0
"""Between the body and the panels in front of it and behind it [cm]."""
HANDLE = 0.25
"""Length of the handles of curves along the body, as a share of their height."""
STRAIGHT = 1e-6
"""A curve that leaves its chord by less is straight [cm]."""
UPRIGHT, ALONG = (0.0, 1.0), (1.0, 0.0)
"""Grain lines: down the body, or along an arm or a band."""
NO_ROTATION = (0.0, 0.0, 0.0)
BACK_ROTATION = (0.0, 180.0, 0.0)
"""Euler angles of a panel that is seen from behind [degrees]."""
_ONE_LINE = 1e-9


class NamedCurve(NamedTuple):
    """One edge of a panel, named as the trade does."""

    label: str
    curve: Curve
    side: str = ""
    """Side of the wearer; empty where it lies on neither or on both."""


Outline = tuple[NamedCurve, ...]


class EdgeRef(NamedTuple):
    """One drawn edge of one panel."""

    panel: str
    number: int


Seam = tuple[EdgeRef, ...]


@dataclass(frozen=True)
class PanelDraft:
    """A panel with its place round the body."""

    name: str
    outline: Outline
    translation: Vector
    rotation: Vector = NO_ROTATION
    label: str = "body"
    """The part of the body that it covers: body, arm or leg."""
    holes: tuple[Loop, ...] = ()
    grain: Point = UPRIGHT
    cloth_layer: int = 0

    def seam(self, label: str, side: str | None = None) -> Seam:
        """All edges with this label (of one side), in loop order."""
        return tuple(
            [
                EdgeRef(self.name, k)
                for k, named in enumerate(self.outline)
                if named.label == label and (side is None or side == named.side)
            ]
        )


def placed(
    name: str,
    outline: Outline,
    facing: str,
    origin: Vector,
    *,
    side: str = "",
    label: str = "body",
    holes: tuple[Loop, ...] = (),
    grain: Point = UPRIGHT,
) -> PanelDraft:
    """A panel in front of the body or behind it.

    Args:
        name: what a tailor calls it.
        outline: counter-clockwise, seen from outside.
        facing: front or back.
        origin: x and y of the panel's origin, and its distance from the body's middle [cm].
        side: of the wearer, if it lies on one; it is drawn as on the side at positive x.
        label: part of the body.
        holes: clockwise, seen from outside.
        grain: direction of the warp.
    """
    if side:
        outline = on_side(outline if side == plus_side(facing) else mirrored(outline), side)
    x, y, depth = origin
    z, rotation = (-depth, BACK_ROTATION) if facing == BACK else (depth, NO_ROTATION)
    return PanelDraft(name, outline, (x, y, z), rotation, label, holes, grain)


def layer_depth(body: BodyMeasurements) -> float:
    """Distance of front and back panels from the body's middle [cm]."""
    return max(body.bust_depth, body.waist_depth, body.hip_depth) / 2 + BODY_GAP


def other(side: str) -> str:
    """Left for right, right for left."""
    return RIGHT if side == LEFT else LEFT


def plus_side(facing: str) -> str:
    """The wearer's side that lies at positive x, seen from outside."""
    return LEFT if facing == FRONT else RIGHT


def lines(label: str, *points: Point) -> Outline:
    """Straight edges from point to point."""
    return tuple(NamedCurve(label, Line(a, b)) for a, b in pairwise(points))


def mirrored(outline: Outline) -> Outline:
    """The outline seen in a mirror at x = 0, still counter-clockwise."""
    return tuple(n._replace(curve=_mapped(n.curve.reversed(), _flip)) for n in reversed(outline))


def on_side(outline: Outline, side: str) -> Outline:
    """The outline, all of it on one side of the wearer."""
    return tuple(n._replace(side=side) for n in outline)


def whole(plus: Outline, minus: Outline, facing: str) -> Outline:
    """Two halves as one outline; straight edges that go on over the middle become one.

    Args:
        plus: the half at x >= 0.
        minus: the half at x <= 0, drawn at x >= 0.
        facing: the side of the body that the panel lies on.
    """
    first = on_side(mirrored(minus), other(plus_side(facing)))
    second = on_side(plus, plus_side(facing))
    before, after = first[-1], second[0]
    if before.label == after.label and _one_line(before.curve, after.curve):
        joined = NamedCurve(before.label, Line(before.curve.start, after.curve.end))
        return (*first[:-1], joined, *second[1:])
    return (*first, *second)


def closed(half: Outline, middle: str) -> Outline:
    """A half as an outline of its own; the middle line gets the label `middle`."""
    return (*half, NamedCurve(middle, Line(half[-1].curve.end, half[0].curve.start)))


def scaled_curve(curve: Bezier, factor: float) -> Bezier:
    """The curve, larger about the origin."""
    points = [(factor * x, factor * y) for x, y in (curve.start, *curve.controls, curve.end)]
    return Bezier(points[0], tuple(points[1:-1]), points[-1])


def moved(outline: Outline, dx: float, dy: float) -> Outline:
    """The outline, shifted."""
    return tuple(
        n._replace(curve=_mapped(n.curve, lambda point: (point[0] + dx, point[1] + dy)))
        for n in outline
    )


def lerp(a: Point, b: Point, share: float) -> Point:
    """The point at a share of the way from a to b."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def distance(a: Point, b: Point) -> float:
    """Distance of two points [cm]."""
    return hypot(b[0] - a[0], b[1] - a[1])


def length(curves: Iterable[NamedCurve]) -> float:
    """Length of all the curves [cm]."""
    return sum(length_of(n.curve) for n in curves)


def _mapped(curve: Curve, place: Callable[[Point], Point]) -> Curve:
    """The line or Bezier curve with all its points moved."""
    if isinstance(curve, Line):
        return Line(place(curve.start), place(curve.end))
    assert isinstance(curve, Bezier)
    return Bezier(place(curve.start), tuple(map(place, curve.controls)), place(curve.end))


def _flip(point: Point) -> Point:
    return -point[0], point[1]


def _one_line(first: Curve, second: Curve) -> bool:
    if not (first.is_straight and second.is_straight):
        return False
    (ax, ay), (bx, by), (cx, cy) = first.start, first.end, second.end
    turn = (bx - ax) * (cy - by) - (by - ay) * (cx - bx)
    return abs(turn) <= _ONE_LINE * length_of(first) * length_of(second)
