"""The seam graph: the garment as nodes, arcs and panels, whatever its shape.

- A **node** is what all vertices that are sewn together become.
- An **arc** joins two nodes: a stitched pair of edges is one arc, a free edge is one of its own.
- Panels are the faces between arcs, each on one layer.

Paper: the paper has no such graph; it reads seams off the deformed panels.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from garmentimage.errors import EncodeError
from garmentimage.geometry import find_root, polyline_length, union
from garmentimage.raster.encode.placement import GENERIC_SLOPE, Placed, PlacedSeam
from garmentimage.raster.encode.split import cut_polyline
from garmentimage.raster.image import EdgeType

Side = tuple[int, int]
"""(panel index, edge number)."""


@dataclass(frozen=True)
class Arc:
    """A curve that the raster draws once: a seam, or a free edge."""

    a: int
    """First end node."""
    b: int
    """Last end node, never the first."""
    layers: tuple[int, ...]
    """Layers that the arc lies on."""
    kind: EdgeType
    """NON_STITCH, FRONT_TO_BACK, SIDE_BY_SIDE, WRAP, SHEET, ONTO or CREASE."""
    sides: tuple[tuple[int, int, bool], ...]
    """One or two (panel index, edge number, the edge runs against the arc); three round a pocket,
    whose kind is that of the pocket's side."""
    slit: bool
    """Both sides belong to one panel: a dart."""
    length: float
    """Length of the longer side [cm]."""

    @property
    def is_inner(self) -> bool:
        """Whether it lies inside the cloth of a panel, beneath a side of a pocket."""
        return len(self.sides) == 3

    @property
    def joins_faces(self) -> bool:
        """Whether it joins the front to the back, and so lies on the silhouette."""
        return len({layer % 2 for layer in self.layers}) == 2


@dataclass(frozen=True)
class SeamGraph:
    """Arcs between nodes, with the placed panels that they bound."""

    placed: Placed
    """Panels and seams; edges that closed on themselves are split in two."""
    arcs: tuple[Arc, ...]
    node_count: int
    owner: Mapping[Side, tuple[int, bool]]
    """For every side its arc, and whether the edge runs against that arc."""

    def arc(self, panel: int, edge: int) -> Arc:
        """The arc that an edge is drawn as."""
        return self.arcs[self.owner[panel, edge][0]]

    def along(self, lines: Sequence[np.ndarray] | np.ndarray, panel: int, edge: int) -> np.ndarray:
        """Of lines along all arcs that of an edge, in the direction of the edge."""
        arc, back = self.owner[panel, edge]
        return lines[arc][::-1] if back else lines[arc]


def build_seam_graph(placed: Placed) -> SeamGraph:
    """Merge what is sewn together.

    Arcs and nodes are ordered by place, so that the order of panels and stitches cannot matter.

    Raises:
        EncodeError: a panel whose whole outline is sewn to itself.
    """
    placed = _open_rings(placed)
    corner = _merged_corners(placed)
    goes_on = {seam.a: EdgeType.WRAP for seam in placed.seams if seam.is_cut}
    goes_on |= {seam.a: EdgeType.CREASE for seam in placed.seams if seam.is_crease}
    arcs = [_arc(placed, corner, sides, goes_on.get(sides[0][0])) for sides in _sides(placed)]
    arcs = _renumbered(sorted(arcs, key=lambda arc: _arc_key(placed, arc)))
    owner = {(p, e): (i, back) for i, arc in enumerate(arcs) for p, e, back in arc.sides}
    nodes = 1 + max(max(arc.a, arc.b) for arc in arcs)
    graph = SeamGraph(placed, tuple(arcs), nodes, owner)
    for i, panel in enumerate(placed.panels):
        if all(graph.arc(i, edge).slit for edge in panel.loops[0]):
            raise EncodeError(
                f"panel {panel.source!r} is closed to a bag by sewing its outline to itself, "
                "which cannot lie flat; split it in a front and a back panel",
                remedy="pattern",
            )
    return graph


def _sides(placed: Placed) -> list[tuple[tuple[Side, bool], ...]]:
    """Per arc its sides, each with whether it runs against the first."""
    over = {each.side: (side, each.crossed) for side, each in placed.beneath.items()}
    sewn: list[tuple[tuple[Side, bool], ...]] = []
    for seam in placed.seams:
        pair = ((seam.a, False), (seam.b, seam.crossed))
        third = [(over[side][0], over[side][1] != back) for side, back in pair if side in over]
        sewn.append((*pair, *third))
    taken = {side for pair in sewn for side, _ in pair}
    sides = [(i, k) for i, panel in enumerate(placed.panels) for k in range(len(panel.curves))]
    return [*sewn, *(((side, False),) for side in sides if side not in taken)]


def _merged_corners(placed: Placed) -> dict[Side, tuple[int, int]]:
    """For every side its first and last node, numbered in no special order."""
    ends: dict[Side, tuple[Side, Side]] = {}
    for i, panel in enumerate(placed.panels):
        for loop in panel.loops:
            for k, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                ends[i, k] = (i, k), (i, following)
    number = {corner: n for n, corner in enumerate(ends)}
    parent = np.arange(len(number))
    together = [(seam.a, seam.b, seam.crossed) for seam in placed.seams]
    together += [(side, each.side, each.crossed) for side, each in placed.beneath.items()]
    for one, other, crossed in together:
        first, second = ends[one], ends[other]
        for mine, theirs in zip(first, second[::-1] if crossed else second, strict=True):
            union(parent, number[mine], number[theirs])
    return {
        side: (find_root(parent, number[first]), find_root(parent, number[last]))
        for side, (first, last) in ends.items()
    }


def _open_rings(placed: Placed) -> Placed:
    """Split every edge whose two ends are one node, and its partner with it."""
    corner = _merged_corners(placed)
    rings = {side for side, (a, b) in corner.items() if a == b}
    if not rings:
        return placed
    parts: dict[Side, tuple[Side, ...]] = {}
    panels = []
    for i, panel in enumerate(placed.panels):
        curves: list[np.ndarray] = []
        loops = []
        origin: list[int | None] = []
        for loop in panel.loops:
            first = len(curves)
            for k in loop:
                curve = panel.curves[k]
                sections = cut_polyline(curve, 0.5) if (i, k) in rings else (curve,)
                parts[i, k] = tuple((i, len(curves) + n) for n in range(len(sections)))
                curves += sections
                origin += [panel.origin[k]] * len(sections)
            loops.append(tuple(range(first, len(curves))))
        panels.append(
            replace(panel, curves=tuple(curves), loops=tuple(loops), origin=tuple(origin))
        )
    seams: list[PlacedSeam] = []
    for seam in placed.seams:
        facing = parts[seam.b][::-1] if seam.crossed else parts[seam.b]
        pairs = zip(parts[seam.a], facing, strict=True)
        seams += [replace(seam, a=a, b=b) for a, b in pairs]
    return replace(placed, panels=tuple(panels), seams=tuple(seams))


def _arc(
    placed: Placed,
    corner: dict[Side, tuple[int, int]],
    sides: tuple[tuple[Side, bool], ...],
    goes_on: EdgeType | None,
) -> Arc:
    """The arc of one side or of two, its sides ordered and its direction chosen by place.

    `goes_on` is its type where the cloth goes on beyond it.
    """
    panels = [placed.panels[i] for (i, _), _ in sides]
    curves = [p.curves[k] for p, ((_, k), _) in zip(panels, sides, strict=True)]
    order = sorted(range(len(sides)), key=lambda n: (sides[n][0][0], _height(curves[n])))
    first = order[0]
    leaning = _lean(curves[first][-1]) < _lean(curves[first][0])
    a, b = corner[sides[first][0]]
    layers = tuple(sorted({p.layer for p in panels}))
    if len(sides) == 3:
        is_sewn = placed.beneath[sides[2][0]].is_sewn
        sewn = EdgeType.ONTO if is_sewn else EdgeType.NON_STITCH
    elif len({layer // 2 for layer in layers}) == 2:
        sewn = EdgeType.SHEET
    elif len(layers) == 2:
        sewn = goes_on or EdgeType.FRONT_TO_BACK
    else:
        sewn = goes_on or EdgeType.SIDE_BY_SIDE
    against_first = [back != sides[first][1] for _, back in sides]
    return Arc(
        a=b if leaning else a,
        b=a if leaning else b,
        layers=layers,
        kind=sewn if len(sides) > 1 else EdgeType.NON_STITCH,
        sides=tuple((*sides[n][0], against_first[n] != leaning) for n in order),
        slit=len(sides) == 2 and panels[0] is panels[1],
        length=max(map(polyline_length, curves)),
    )


def _lean(point: np.ndarray) -> float:
    return float(point[1] + GENERIC_SLOPE * point[0])


def _height(curve: np.ndarray) -> float:
    return _lean(curve.mean(axis=0))


def _arc_key(placed: Placed, arc: Arc) -> tuple[tuple[int, ...], float]:
    heights = [_height(placed.panels[i].curves[k]) for i, k, _ in arc.sides]
    return arc.layers, sum(heights) / len(heights)


def _renumbered(arcs: list[Arc]) -> list[Arc]:
    """The same arcs with nodes numbered in the order in which the arcs meet them."""
    number: dict[int, int] = {}
    for arc in arcs:
        for node in (arc.a, arc.b):
            number.setdefault(node, len(number))
    return [replace(arc, a=number[arc.a], b=number[arc.b]) for arc in arcs]
