"""Splitting: panels that wrap round the body are cut in a front and a back part.

A `SplitPattern` is a pattern taken apart for cutting: every edge has a number of its own, which no
cut elsewhere changes.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from garmentimage.errors import EncodeError
from garmentimage.geometry import (
    CHORDS,
    centroid,
    lengths_along,
    polyline_length,
    resample,
    signed_area,
)
from garmentimage.pattern import Pattern, Side, side_loops
from garmentimage.raster.encode.joints import Joints

SEEN_FROM_SIDE = 0.6
"""Only panels with |R22| below this are ever split."""
CLEAR_CROSSING = 0.2
"""Share of a panel's depth beyond the middle plane at which it is split in any case."""
NEIGHBOUR_CROSSING = 0.03
"""The same, for a panel whose stitched neighbours lie on both layers."""
PARTNER_REACH = 0.3
"""Reach, in perimeters, to a vertex where the neighbours change from one layer to the other."""
VERTEX_REACH = 0.035
"""Reach, in perimeters, to any other vertex."""
MIN_PART_SHARE = 0.1
"""Share of a panel's area that either part must keep."""
SUFFIXES = ("front", "back")


@dataclass
class PanelPart:
    """A panel or a part of one: loops of edge numbers, outer loop first."""

    name: str
    source: str
    rotation: Float[np.ndarray, "3 3"]
    translation: Float[np.ndarray, " 3"]
    loops: list[list[int]]
    layer: int = 0
    is_part: bool = False
    """Part of a panel that was cut."""

    @property
    def edges(self) -> list[int]:
        """All edges, loop by loop."""
        return [edge for loop in self.loops for edge in loop]


@dataclass
class SplitPattern:
    """A pattern taken apart: panels and parts of panels, edges, and which edge is sewn to which."""

    parts: list[PanelPart] = field(default_factory=list)
    curves: dict[int, Float[np.ndarray, "_ 2"]] = field(default_factory=dict)
    """Dense polyline of every edge, in the frame of its panel [cm]."""
    sewn: dict[int, tuple[int, bool]] = field(default_factory=dict)
    """For every sewn edge its partner, and whether the start of one meets the end of the other."""
    origin: dict[int, int] = field(default_factory=dict)
    """For every edge that is not a cut, the number of the edge of its pattern's panel that it is,
    is a part of, or begins with."""
    cuts: set[int] = field(default_factory=set)
    """The edges that were made by cutting panels in two."""
    creases: set[int] = field(default_factory=set)
    """The edges that were made by slitting panels along creases."""
    pleats: list[tuple[int, ...]] = field(default_factory=list)
    """For each pressed pleat its edges in the order of the loop, its creases among them."""
    _own_centres: dict[tuple[int, ...], np.ndarray] = field(default_factory=dict)
    """Centres of area already found, by outer loop."""
    numbers: Iterator[int] = field(default_factory=itertools.count)

    @classmethod
    def of(cls, pattern: Pattern, joints: Joints, lift: float) -> "SplitPattern":
        """`pattern`, its edges joined at the open `joints`, lifted by `lift` [cm]."""
        split = cls()
        edges: dict[Side, int] = {}
        loops: dict[str, list[list[int]]] = {panel.name: [] for panel in pattern.panels}
        for _, ring in side_loops(pattern):
            loops[ring[0].panel].append([])
            for joined in _joined(ring, joints):
                number = next(split.numbers)
                loops[ring[0].panel][-1].append(number)
                curves = [pattern.curve(side) for side in joined]
                lines = [c.sample(1 if c.is_straight else CHORDS) for c in curves]
                split.curves[number] = np.concatenate([lines[0], *(line[1:] for line in lines[1:])])
                edges.update(dict.fromkeys(joined, number))
                split.origin[number] = joined[0].edge
        for panel in pattern.panels:
            where = np.array(panel.translation) + np.array([0.0, lift, 0.0])
            part = PanelPart(panel.name, panel.name, panel.matrix, where, loops[panel.name])
            split.parts.append(part)
        for stitch in pattern.stitches:
            if stitch.a not in joints.stubs:
                a, b = (edges[side] for side in stitch.sides)
                split.sew(a, b, crossed=not stitch.same_direction)
        return split

    def sew(self, a: int, b: int, *, crossed: bool) -> None:
        """Sew edge `a` to edge `b`."""
        self.sewn[a], self.sewn[b] = (b, crossed), (a, crossed)

    def polygon(self, part: PanelPart) -> Float[np.ndarray, "n 2"]:
        """The outer loop in the panel's own frame, not closed."""
        return np.concatenate([self.curves[e][:-1] for e in part.loops[0]])

    def world(self, part: PanelPart, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
        """Panel points placed round the body, feet on the floor [cm]."""
        return np.asarray(points @ part.rotation[:, :2].T + part.translation)

    def own_centre(self, part: PanelPart) -> Float[np.ndarray, " 2"]:
        """Centre of area in the panel's own frame."""
        key = tuple(part.loops[0])
        if key not in self._own_centres:
            self._own_centres[key] = centroid(self.polygon(part))
        return self._own_centres[key]

    def centre(self, part: PanelPart) -> Float[np.ndarray, " 3"]:
        """World position of the centre of area."""
        return np.asarray(self.world(part, self.own_centre(part)[None])[0])

    def owner(self, edge: int) -> tuple[PanelPart, list[int]]:
        """The panel or part, and the loop, that an edge belongs to."""
        return next((p, loop) for p in self.parts for loop in p.loops if edge in loop)

    def split_edge(self, edge: int, share: float) -> int:
        """Split an edge, and its partner with it, at a share of its length.

        Returns:
            Number of the second part, whose start is the new vertex; the first part, whose start
            is an old one, keeps the number of the edge.
        """
        second = self._cut_curve(edge, share)
        if edge in self.sewn:
            other, crossed = self.sewn[edge]
            theirs = other, self._cut_curve(other, 1 - share if crossed else share)
            pairs = zip((edge, second), theirs[::-1] if crossed else theirs, strict=True)
            for mine, facing in pairs:
                self.sew(mine, facing, crossed=crossed)
        return second

    def _cut_curve(self, edge: int, share: float) -> int:
        _, loop = self.owner(edge)
        second = next(self.numbers)
        self.curves[edge], self.curves[second] = cut_polyline(self.curves[edge], share)
        self.origin[second] = self.origin[edge]
        loop.insert(loop.index(edge) + 1, second)
        return second


def _joined(ring: Sequence[Side], joints: Joints) -> Iterator[list[Side]]:
    """The edges of a loop in parts that are one edge each."""
    turn = next((k for k, side in enumerate(ring) if side not in joints.open), 0)
    joined: list[Side] = []
    for side in (*ring[turn:], *ring[:turn]):
        if joined and side not in joints.open:
            yield joined
            joined = []
        joined.append(side)
    yield joined


def cut_polyline(
    points: Float[np.ndarray, "n 2"], share: float
) -> tuple[Float[np.ndarray, "k 2"], Float[np.ndarray, "m 2"]]:
    """The parts of an open polyline before and after a share (0..1) of its length."""
    lengths = lengths_along(points)
    shares = lengths / lengths[-1]
    middle = resample(points, np.array([share]))
    before, after = points[shares < share - 1e-9], points[shares > share + 1e-9]
    return np.concatenate([before, middle]), np.concatenate([middle, after])


def split_wrapping(split: SplitPattern, middle: float) -> None:
    """Cut every wrapping panel along the plane z = `middle`, in place.

    The parts keep a seam where they were cut. Larger panels are cut first: a panel that is
    stitched to one that was cut finds its vertex already there.

    Raises:
        EncodeError: a cut would run through a hole.
    """
    wrapping = [p for p in split.parts if _wraps(split, p, middle)]
    wrapping.sort(key=lambda p: (-abs(signed_area(split.polygon(p))), p.translation[0]))
    undecided = list(wrapping)
    for part in wrapping:
        points = _crossings(split, part, middle)
        vertices = _choose_vertices(split, part, points, {e for p in undecided for e in p.edges})
        undecided.remove(part)
        _cut(split, part, vertices)


def _wraps(split: SplitPattern, part: PanelPart, middle: float) -> bool:
    if abs(part.rotation[2, 2]) >= SEEN_FROM_SIDE:
        return False
    depths = split.world(part, split.polygon(part))[:, 2] - middle
    extent = float(np.ptp(depths))
    beyond = min(depths.max(), -depths.min()) / extent if extent > 0 else 0.0
    if beyond > CLEAR_CROSSING:
        return True
    partners = [split.sewn[e][0] for e in part.loops[0] if e in split.sewn]
    owners = [split.owner(e)[0] for e in partners]
    layers = {p.layer for p in owners if abs(p.rotation[2, 2]) >= SEEN_FROM_SIDE}
    return bool(beyond > NEIGHBOUR_CROSSING) and len(layers) == 2


def _crossings(split: SplitPattern, part: PanelPart, middle: float) -> list[float]:
    """The two places, in lengths along the outer loop, where it passes the middle plane.

    Of more than two the pair farthest apart along the loop.
    """
    closed = np.concatenate([split.polygon(part), split.curves[part.loops[0][0]][:1]])
    along = lengths_along(closed)
    depth = split.world(part, closed)[:, 2] - middle
    (i,) = np.nonzero((depth[:-1] <= 0) != (depth[1:] <= 0))
    places = along[i] + depth[i] / (depth[i] - depth[i + 1]) * (along[i + 1] - along[i])
    pairs = itertools.combinations(places.tolist(), 2)
    first, second = max(pairs, key=lambda p: _round_trip(p[0], p[1], along[-1]))
    return [first, second]


def _round_trip(a: float, b: float, perimeter: float) -> float:
    """Distance of two places along a closed loop."""
    return min(abs(a - b), perimeter - abs(a - b))


def _choose_vertices(
    split: SplitPattern, part: PanelPart, places: list[float], undecided: set[int]
) -> list[int]:
    """The two edges before which to cut; a place far from any good one gets a new vertex.

    The best places are where the neighbours change from one layer to the other, halfway along the
    free boundary between them if there is some; then any vertex nearby. Of those the first pair
    that leaves two parts large enough is taken.
    """
    starts = edge_starts(split, part)
    changes = _layer_changes(split, part, undecided)
    ranked: list[list[float]] = []
    for place in places:

        def reach(at: float, place: float = place) -> float:
            return _round_trip(at, place, float(starts[-1])) / float(starts[-1])

        good = sorted((at for at in changes if reach(at) < PARTNER_REACH), key=reach)
        near = sorted((at for at in starts[:-1] if reach(at) < VERTEX_REACH), key=reach)
        ranked.append([*good, *near, place])
    first, second = ranked
    ranks = itertools.product(range(len(first)), range(len(second)))
    pairs = [(first[m], second[n]) for m, n in sorted(ranks, key=sum)]
    chosen = next((p for p in pairs if _balance(split, part, *p) > MIN_PART_SHARE), pairs[-1])
    return [vertex_at(split, part, place) for place in chosen]


def _layer_changes(split: SplitPattern, part: PanelPart, undecided: set[int]) -> list[float]:
    """Places on the outer loop where the stitched neighbours change from layer to layer.

    Halfway along the free edges between such neighbours; edges sewn to panels that are not yet
    cut separate nothing.
    """
    loop, starts = part.loops[0], edge_starts(split, part)
    count, perimeter = len(loop), starts[-1]
    layers = [partner_layer(split, e, undecided) for e in loop]
    changes = []
    for k in range(count):
        if layers[k] is None:
            continue
        run = 1
        while run < count and loop[(k + run) % count] not in split.sewn:
            run += 1
        if {layers[k], layers[(k + run) % count]} == {0, 1}:
            first = starts[k + 1]
            last = starts[(k + run) % count] + (perimeter if k + run >= count else 0.0)
            changes.append(float((first + last) / 2 % perimeter))
    return changes


def edge_starts(split: SplitPattern, part: PanelPart) -> Float[np.ndarray, " _"]:
    """Length along the outer loop at which each edge starts, and the whole length."""
    return np.cumsum([0.0, *(polyline_length(split.curves[e]) for e in part.loops[0])])


def _balance(split: SplitPattern, part: PanelPart, a: float, b: float) -> float:
    """Share of the area on the smaller side of the line between two places on the outer loop."""
    polygon = split.polygon(part)
    closed = np.concatenate([polygon, polygon[:1]])
    along = lengths_along(closed)
    a, b = sorted((a, b))
    ends = resample(closed, np.array([a, b]) / along[-1])
    between = polygon[(along[:-1] > a) & (along[:-1] < b)]
    share = signed_area(np.concatenate([ends[:1], between, ends[1:]])) / signed_area(polygon)
    return min(share, 1 - share)


def vertex_at(split: SplitPattern, part: PanelPart, place: float) -> int:
    """The edge that starts at a place on the outer loop, split off there if need be."""
    starts = edge_starts(split, part)
    here = np.abs(starts[:-1] - place) < 1e-6
    if here.any():
        return part.loops[0][int(here.argmax())]
    k = int(np.searchsorted(starts, place, side="right")) - 1
    share = (place - starts[k]) / (starts[k + 1] - starts[k])
    return split.split_edge(part.loops[0][k], share)


def partner_layer(split: SplitPattern, edge: int, undecided: set[int]) -> int | None:
    """The layer of what an edge is sewn to; None where that is nothing, or an undecided edge."""
    if edge not in split.sewn or split.sewn[edge][0] in undecided:
        return None
    return split.owner(split.sewn[edge][0])[0].layer


def _cut(split: SplitPattern, part: PanelPart, vertices: list[int]) -> None:
    """Replace a panel by the two parts between the starts of two of its edges."""
    loop = part.loops[0]
    i, j = sorted(loop.index(e) for e in vertices)
    runs = [loop[i:j], loop[j:] + loop[:i]]
    cut = next(split.numbers), next(split.numbers)
    both = []
    for number, run in zip(cut, runs, strict=True):
        ends = split.curves[run[-1]][-1], split.curves[run[0]][0]
        split.curves[number] = np.stack(ends)
        both.append(replace(part, loops=[[*run, number]], is_part=True))
    split.sew(*cut, crossed=True)
    split.cuts.update(cut)
    for hole in part.loops[1:]:
        part_with_hole(split, part, both, hole).loops.append(hole)
    both.sort(key=lambda p: -split.centre(p)[2])
    for layer, one in enumerate(both):
        one.layer = layer
    put_parts(split, part, both)


def put_parts(split: SplitPattern, part: PanelPart, cut: list[PanelPart]) -> None:
    """Put the parts of a panel in its place, named by their layers."""
    at = next(k for k, p in enumerate(split.parts) if p is part)
    taken = {p.name for p in split.parts}
    for one in cut:
        one.name = f"{part.name}:{SUFFIXES[one.layer]}"
        while one.name in taken:
            one.name += "'"
        taken.add(one.name)
    split.parts[at : at + 1] = cut


def part_with_hole(
    split: SplitPattern, part: PanelPart, cut: list[PanelPart], hole: list[int]
) -> PanelPart:
    """The one of the parts of a panel that a hole lies in."""
    import shapely

    inner = shapely.Polygon(np.concatenate([split.curves[e][:-1] for e in hole]))
    for one in cut:
        if shapely.Polygon(split.polygon(one)).contains(inner):
            return one
    raise EncodeError(
        f"panel {part.name!r} wraps round the body and a hole lies across the line where it "
        "must be split in a front and a back part; cut it there, through the hole, and sew its "
        "parts together",
        remedy="pattern",
    )
