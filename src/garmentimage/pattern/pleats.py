"""Pressed pleats as the lines along which cloth is folded, and back.

The two edges of a pleat, A to M and M to B, are sewn to each other, so A comes to lie on B. Seen
from outside with these edges at the top, A is at the right of B:

- a knife pleat to the left is folded at A, where it is seen, and at M beneath; one to the right at
  B and at M;
- an inverted pleat is folded at A and at B, where it is seen, and beneath midway between A and M
  and midway between M and B;
- a box pleat is folded at the same places; those midway are seen.

Folds are straight lines into the cloth, square to the line from A to B. A **crease** is a fold that
is seen from outside.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import dist, hypot
from types import MappingProxyType

from garmentimage.geometry import Point
from garmentimage.pattern.model import Pattern, Pleat, PleatFold

OUTER_SHARE = 0.1
"""An image has a crease at A or B start this share of the edge away, so that it has a start of its
own."""
MIDDLE_SHARE = 0.5
BETWEEN_SHARES = 0.3  # creases that start from this share on are those of a box pleat
EDGE_TOL_CM = 0.1  # folds may leave the cloth by so much

FOLDED_AT: Mapping[PleatFold, tuple[tuple[int, float, bool], ...]] = MappingProxyType(
    {
        "left": ((0, 0.0, True), (0, 1.0, False)),
        "right": ((0, 1.0, False), (1, 1.0, True)),
        "inverted": ((0, 0.0, True), (0, 0.5, False), (1, 0.5, False), (1, 1.0, True)),
        "box": ((0, 0.0, False), (0, 0.5, True), (1, 0.5, True), (1, 1.0, False)),
    }
)
"""The folds in the order of the outline: on the first edge (0) or the second (1), at which share of
it, and whether it is seen."""


@dataclass(frozen=True)
class PleatFoldLine:
    """A line along which the cloth of a pleat is folded, in the frame of its panel [cm]."""

    side: int
    """0 where it starts on the first edge of the pleat, 1 on the second."""
    share: float
    """Where on that edge, as a share of its length from its start."""
    is_seen: bool
    start: Point
    end: Point
    """Where pressing ends."""


def fold_lines(pattern: Pattern, pleat: Pleat) -> tuple[PleatFoldLine, ...]:
    """All folds of a pleat, in the order of the outline."""
    curves = [pattern.curve(side) for side in pleat.sides]
    (ax, ay), (bx, by) = curves[0].start, curves[1].end
    # Cloth lies to the left of an outline that runs counter-clockwise.
    left = 1 if pattern.by_name[pleat.panel].outline.area > 0 else -1
    scale = left * pleat.pressed / hypot(bx - ax, by - ay)
    found = []
    for side, share, is_seen in FOLDED_AT[pleat.fold]:
        (x0, y0), (x1, y1) = curves[side].start, curves[side].end
        x, y = x0 + share * (x1 - x0), y0 + share * (y1 - y0)
        end = x - (by - ay) * scale, y + (bx - ax) * scale
        found.append(PleatFoldLine(side, share, is_seen, (x, y), end))
    return tuple(found)


def is_on_cloth(pattern: Pattern, pleat: Pleat) -> bool:
    """Whether a pleat is pressed on cloth of its panel only."""
    import shapely

    outline, *holes = (loop.polygon for loop in pattern.by_name[pleat.panel].loops)
    cloth = shapely.Polygon(outline, holes).buffer(EDGE_TOL_CM)
    lines = [shapely.LineString([f.start, f.end]) for f in fold_lines(pattern, pleat)]
    return all(cloth.covers(line) for line in lines)


@dataclass(frozen=True)
class Crease:
    """A fold of a pleat that is seen, as an image has it."""

    side: int
    """0 on the first edge of the pleat, 1 on the second."""
    share: float
    """Where it starts: how far from A or B, as a share of the edge."""
    end: Point
    """Where pressing ends, in the frame of the panel [cm]."""


def creases(pattern: Pattern, pleat: Pleat) -> tuple[Crease, ...]:
    """The folds of a pleat that are seen, in the order of the outline."""
    share = MIDDLE_SHARE if pleat.fold == "box" else OUTER_SHARE
    seen = [fold for fold in fold_lines(pattern, pleat) if fold.is_seen]
    return tuple(Crease(fold.side, share, fold.end) for fold in seen)


def pleat_of(
    pattern: Pattern, panel: str, edges: tuple[int, int], found: Sequence[Crease]
) -> Pleat | None:
    """The pleat whose creases are seen; None where no pleat has them.

    Args:
        pattern: the garment.
        panel: name of the panel.
        edges: two edges of its outline that are sewn to each other.
        found: the creases that start on them.
    """
    are_middle = {crease.share >= BETWEEN_SHARES for crease in found}
    sides = sorted({crease.side for crease in found})
    if len(are_middle) != 1 or len(sides) != len(found):
        return None
    fold: PleatFold
    if len(sides) == 2:
        fold = "box" if are_middle == {True} else "inverted"
    elif are_middle == {True}:
        return None
    else:
        fold = "left" if sides == [0] else "right"
    lines = fold_lines(pattern, Pleat(panel, edges, fold, 0.0))
    start = {line.side: line.start for line in lines if line.is_seen}
    depths = [dist(start[crease.side], crease.end) for crease in found]
    return Pleat(panel, edges, fold, sum(depths) / len(depths))
