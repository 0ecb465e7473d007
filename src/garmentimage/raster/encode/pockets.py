"""Pockets and peplums: a panel beneath others that are sewn onto it is cut where they are.

Their sewn edges are then lines of the panel beneath, so the two come to lie on each other on the
grid: each is drawn as the same arc as the two sides of the cut. Rasterizing makes the **base** and
the parts that were cut off it, which lie **hidden** beneath, one panel again.

A **pocket** lies on its base with all its outline: what is beneath it is cut out. Of anything else,
such as a **peplum**, the line along which it is sewn on goes across the base, from edge to edge.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from garmentimage.errors import EncodeError
from garmentimage.geometry import polyline_length, signed_area
from garmentimage.pattern import SewnOnto
from garmentimage.raster.encode.split import PanelPart, SplitPattern, vertex_at

if TYPE_CHECKING:
    import shapely

MARGIN_CM = 0.1  # a pocket keeps this distance from the edges of its base
END_CM = 1.5  # a line across a panel ends at most this far from the edge of the panel ...
HIDDEN = "/"  # in names of hidden parts, between those of the base and of what lies on it
SNAP_CM = 0.2  # ... and at a vertex that is so near


@dataclass(frozen=True, eq=False)
class SewnPart:
    """What is sewn onto a base, and what was cut off the base beneath it."""

    part: PanelPart
    base: PanelPart
    hidden: PanelPart
    matrix: Float[np.ndarray, "2 2"]
    offset: Float[np.ndarray, " 2"]
    """Place in the frame of the base = matrix @ place in that of the pocket + offset [cm]."""
    sides: tuple[tuple[int, int, bool, bool], ...]
    """(its edge, that of the hidden part, start lies on end, whether it is sewn on)."""


def cut_beneath(split: SplitPattern, onto: Sequence[SewnOnto]) -> list[SewnPart]:
    """Cut panels where others are sewn onto them; lines across come before pockets.

    Raises:
        EncodeError: what is sewn on lies neither on its base with all its outline, nor goes across
            it from edge to edge; or it wraps round the body, or its base does.
    """
    order = sorted(onto, key=lambda each: (_is_pocket(split, each), each.panel))
    return [_cut_beneath(split, each) for each in order]


def _cut_beneath(split: SplitPattern, onto: SewnOnto) -> SewnPart:
    if not _is_pocket(split, onto):
        return _cut_across(split, onto)
    pocket = _whole(split, onto.panel, onto)
    matrix, offset = np.array(onto.matrix, float), np.array(onto.offset, float)
    edges = pocket.loops[0]
    curves = _carried(split, onto, edges)
    base = _part_beneath(split, onto, curves)
    ring = np.concatenate([curve[:-1] for curve in curves])
    against = (signed_area(ring) > 0) != (signed_area(split.polygon(base)) > 0)
    hidden_edges, holes, sides = [], [], []
    for edge, curve in zip(edges, curves, strict=True):
        hidden, hole = next(split.numbers), next(split.numbers)
        split.curves[hidden] = curve[::-1] if against else curve
        split.curves[hole] = split.curves[hidden][::-1]
        split.sew(hidden, hole, crossed=True)
        hidden_edges.append(hidden)
        holes.append(hole)
        sides.append((edge, hidden, against, split.origin[edge] in onto.edges))
    # Edges follow each other along a loop, those of a hole the other way round.
    loop, hole_loop = (hidden_edges[::-1], holes) if against else (hidden_edges, holes[::-1])
    base.loops.append(hole_loop)
    part = _hidden_part(split, base, pocket, [loop])
    return SewnPart(pocket, base, part, matrix, offset, tuple(sides))


def _hidden_part(
    split: SplitPattern, base: PanelPart, over: PanelPart, loops: list[list[int]]
) -> PanelPart:
    """What was cut off a base, in its place."""
    name = f"{base.name}{HIDDEN}{over.name}"
    part = replace(base, name=name, loops=loops)
    split.parts.append(part)
    return part


def _cut_across(split: SplitPattern, onto: SewnOnto) -> SewnPart:
    """Cut a panel in two along a line that goes across it from edge to edge."""
    over = _whole(split, onto.panel, onto)
    matrix, offset = np.array(onto.matrix, float), np.array(onto.offset, float)
    chain = _chain([edge for edge in over.loops[0] if split.origin[edge] in onto.edges], over)
    curves = _carried(split, onto, chain) if chain else []
    candidates = [part for part in split.parts if part.source == onto.on]
    base = next((p for p in candidates if curves and _goes_across(split, p, curves)), None)
    if base is None:
        raise _misplaced(onto)
    if base.is_part:
        raise _wraps(onto.on, onto)
    first, last = (
        vertex_at(split, base, _place_on_outline(split, base, point))
        for point in (curves[0][0], curves[-1][-1])
    )
    start = base.loops[0].index(first)
    turned = base.loops[0][start:] + base.loops[0][:start]
    cut = turned.index(last)
    if not cut:
        raise _misplaced(onto)
    from_start, from_end = turned[:cut], turned[cut:]
    # The line ends exactly at the vertices.
    curves = [curve.copy() for curve in curves]
    curves[0][0] = split.curves[from_start[0]][0]
    curves[-1][-1] = split.curves[from_end[0]][0]
    along, against, sides = [], [], []
    for edge, curve in zip(chain, curves, strict=True):
        one, other = next(split.numbers), next(split.numbers)
        split.curves[one], split.curves[other] = curve, curve[::-1]
        split.sew(one, other, crossed=True)
        along.append(one)
        against.append(other)
        sides.append((edge, one, False, True))
    # Along the line, then back along the outline; and the other way round.
    holes = base.loops[1:]
    base.loops = [[*from_start, *against[::-1]]]
    hidden = _hidden_part(split, base, over, [[*along, *from_end]])
    for hole in holes:
        inside = _polygon(split, hidden).contains(_ring(split, hole))
        (hidden if inside else base).loops.append(hole)
    return SewnPart(over, base, hidden, matrix, offset, tuple(sides))


def _carried(
    split: SplitPattern, onto: SewnOnto, edges: Sequence[int]
) -> list[Float[np.ndarray, "_ 2"]]:
    """Edges of what is sewn on, in the frame of its base [cm]."""
    return [onto.carried(split.curves[edge]) for edge in edges]


def _chain(edges: list[int], part: PanelPart) -> list[int]:
    """Edges in the order in which they follow each other; none where they are not one chain."""
    loop = part.loops[0]
    after = dict(zip(loop, [*loop[1:], loop[0]], strict=True))
    starts = [edge for edge in edges if edge not in {after[other] for other in edges}]
    if len(starts) != 1:
        return []
    chain = [starts[0]]
    while after[chain[-1]] in edges:
        chain.append(after[chain[-1]])
    return chain


def _goes_across(
    split: SplitPattern, part: PanelPart, curves: list[Float[np.ndarray, "_ 2"]]
) -> bool:
    """Whether a line lies on a part, its ends at the edge."""
    import shapely

    line = shapely.LineString(np.concatenate([curves[0][:1], *(curve[1:] for curve in curves)]))
    polygon = _polygon(split, part)
    ends = [polygon.exterior.distance(shapely.Point(line.coords[k])) for k in (0, -1)]
    return bool(max(ends) <= END_CM and polygon.buffer(END_CM).covers(line)) and bool(
        polygon.buffer(-END_CM).intersects(line)
    )


def _place_on_outline(
    split: SplitPattern, part: PanelPart, point: Float[np.ndarray, " 2"]
) -> float:
    """The place along the outer loop that is nearest to a point, or a vertex beside it [cm]."""
    import shapely

    ring = split.polygon(part)
    closed = shapely.LinearRing(ring)
    place = float(closed.project(shapely.Point(point)))
    lengths = [polyline_length(split.curves[edge]) for edge in part.loops[0]]
    starts = np.cumsum([0.0, *lengths])
    nearest = int(np.abs(starts - place).argmin())
    if abs(starts[nearest] - place) <= SNAP_CM:
        return float(starts[nearest % len(lengths)])
    return place


def _polygon(split: SplitPattern, part: PanelPart) -> "shapely.Polygon":
    import shapely

    rings = [np.concatenate([split.curves[edge][:-1] for edge in loop]) for loop in part.loops]
    return shapely.Polygon(rings[0], rings[1:])


def _ring(split: SplitPattern, loop: Sequence[int]) -> "shapely.Polygon":
    import shapely

    return shapely.Polygon(np.concatenate([split.curves[edge][:-1] for edge in loop]))


def _is_pocket(split: SplitPattern, onto: SewnOnto) -> bool:
    """Whether it lies with all its outline on the panel that it is sewn onto."""
    part = _whole(split, onto.panel, onto)
    if any(edge in split.sewn for edge in part.loops[0]):
        return False
    outline = np.concatenate([c[:-1] for c in _carried(split, onto, part.loops[0])])
    import shapely

    bases = [each for each in split.parts if each.source == onto.on]
    cloth = shapely.union_all([_polygon(split, each) for each in bases])
    return bool(cloth.buffer(-MARGIN_CM).covers(shapely.Polygon(outline)))


def _whole(split: SplitPattern, name: str, onto: SewnOnto) -> PanelPart:
    """The one part of a panel that is sewn onto another."""
    parts = [part for part in split.parts if part.source == name]
    if len(parts) != 1:
        raise _wraps(name, onto)
    return parts[0]


def _wraps(name: str, onto: SewnOnto) -> EncodeError:
    return EncodeError(
        f"panel {onto.panel[:80]!r} is sewn onto panel {onto.on[:80]!r}, and panel "
        f"{name[:80]!r} wraps round the body; that cannot be drawn: cut it at the side",
        remedy="pattern",
    )


def _part_beneath(
    split: SplitPattern, onto: SewnOnto, curves: list[Float[np.ndarray, "_ 2"]]
) -> PanelPart:
    """The part of the base that a pocket lies on."""
    import shapely

    outline = shapely.Polygon(np.concatenate([curve[:-1] for curve in curves]))
    bases = [part for part in split.parts if part.source == onto.on]
    if any(part.is_part for part in bases):
        raise _wraps(onto.on, onto)
    for part in bases:
        if _polygon(split, part).buffer(-MARGIN_CM).covers(outline):
            return part
    raise _misplaced(onto)


def _misplaced(onto: SewnOnto) -> EncodeError:
    return EncodeError(
        f"panel {onto.panel[:80]!r} is sewn onto panel {onto.on[:80]!r}, but neither lies wholly "
        "on its cloth, off its edges and off other pockets, nor is sewn across it from edge to "
        "edge; move it, or sew it into the seam there",
        remedy="pattern",
    )
