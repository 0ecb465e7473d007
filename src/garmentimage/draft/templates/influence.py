"""What the parameters of a pattern template do to its panels.

Words of this file:

- A **run** is one edge of a panel, or several in order; its vertices are the start of the first
  edge and the end of each edge.
- A run changes its length along a **line**: a given direction, or the one from its first vertex to
  its last. All its vertices move along that line, away from a fixed place.
- A **bend** is a curved edge whose control point moves.

The rules are those of the pattern templates of Korosteleva and Lee, "Generating Datasets of 3D
Garments with Sewing Patterns" (2021), and of the program that samples them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from math import copysign, hypot

from garmentimage.errors import PatternError
from garmentimage.geometry import Point
from garmentimage.pattern import Loop, Quadratic
from garmentimage.pattern.checks import MIN_EDGE_LENGTH, edge_place

Outlines = Mapping[str, Loop]
"""Outer loops of the panels, by the panels' names."""


class Moving(Enum):
    """Which end of a run moves when its length changes."""

    START = "start"
    END = "end"
    BOTH = "both"


@dataclass(frozen=True)
class Run:
    """Edges of one panel that change their length together."""

    panel: str
    edges: tuple[int, ...]
    moving: Moving
    along: Point | None = None
    """Direction of the line, of any length; None: from the run's first vertex to its last."""

    @property
    def place(self) -> str:
        """How messages call the run."""
        return edge_place(self.panel, self.edges[0])

    def vertices(self, loop: Loop) -> list[int]:
        """Numbers of the run's vertices, in order."""
        first = loop.edges[self.edges[0]].start
        return [first, *(loop.edges[k].end for k in self.edges)]

    def line(self, loop: Loop) -> Point:
        """Unit direction in which the run's length is measured and changed."""
        x, y = self.along or self._chord(loop)
        length = hypot(x, y)
        if length < MIN_EDGE_LENGTH:
            raise PatternError(
                f"{self.place}: its run of edges begins and ends at the same place, so no "
                "parameter can stretch it; give it an 'along' direction"
            )
        return x / length, y / length

    def extent(self, loop: Loop) -> float:
        """How far the run's last vertex lies from its first along the line, with its sign [cm]."""
        (ux, uy), (x, y) = self.line(loop), self._chord(loop)
        return ux * x + uy * y

    def fixed(self, loop: Loop) -> Point:
        """The fixed place."""
        numbers = self.vertices(loop)
        (x0, y0), (x1, y1) = loop.vertices[numbers[0]], loop.vertices[numbers[-1]]
        match self.moving:
            case Moving.END:
                return x0, y0
            case Moving.START:
                return x1, y1
            case Moving.BOTH:
                return (x0 + x1) / 2, (y0 + y1) / 2

    def _chord(self, loop: Loop) -> Point:
        numbers = self.vertices(loop)
        (x0, y0), (x1, y1) = loop.vertices[numbers[0]], loop.vertices[numbers[-1]]
        return x1 - x0, y1 - y0


@dataclass(frozen=True)
class Bend:
    """A quadratic edge that changes its curvature."""

    panel: str
    edge: int


def scaled(outlines: Outlines, run: Run, factor: float) -> dict[str, Loop]:
    """The outlines with a run `factor` times as long along its line."""
    return _moved(outlines, run, lambda distance: (factor - 1) * distance)


def lengthened(outlines: Outlines, run: Run, length: float) -> dict[str, Loop]:
    """The outlines with each vertex of a run `length` [cm] further from the fixed place.

    Vertices level with that place do not move either. Where both ends move, the run gains twice
    `length`.
    """

    def step(distance: float) -> float:
        return length * copysign(1, distance) if abs(distance) > MIN_EDGE_LENGTH else 0.0

    return _moved(outlines, run, step)


def bent(outlines: Outlines, bend: Bend, along: float, across: float) -> dict[str, Loop]:
    """The outlines with the two coordinates of a bend's control point scaled."""
    loop = outlines[bend.panel]
    edge = loop.edges[bend.edge]
    assert isinstance(edge.curvature, Quadratic)
    x, y = edge.curvature.control
    changed = replace(edge, curvature=Quadratic((along * x, across * y)))
    edges = (*loop.edges[: bend.edge], changed, *loop.edges[bend.edge + 1 :])
    return {**outlines, bend.panel: Loop(loop.vertices, edges)}


def equalising_factors(outlines: Outlines, runs: Sequence[Run]) -> list[float]:
    """By how much to scale each run for all of them to have their present mean extent."""
    extents = [run.extent(outlines[run.panel]) for run in runs]
    for run, extent in zip(runs, extents, strict=True):
        if abs(extent) < MIN_EDGE_LENGTH:
            raise PatternError(
                f"{run.place}: has no extent along its direction, so no constraint can make it "
                "as long as others; change its 'along' direction"
            )
    mean = sum(extents) / len(extents)
    return [mean / extent for extent in extents]


def _moved(outlines: Outlines, run: Run, step: Callable[[float], float]) -> dict[str, Loop]:
    """Move a run's vertices along its line, each by `step` of its distance from the fixed place."""
    loop = outlines[run.panel]
    (ux, uy), (fx, fy) = run.line(loop), run.fixed(loop)
    vertices = list(loop.vertices)
    for number in run.vertices(loop):
        x, y = loop.vertices[number]
        way = step((x - fx) * ux + (y - fy) * uy)
        vertices[number] = (x + way * ux, y + way * uy)
    return {**outlines, run.panel: Loop(tuple(vertices), loop.edges)}
