"""The graph that is drawn on the lattice: nodes, arcs, and the grid edges that arcs need.

Words of this file: a **node** is a point where seams end, an **arc** a seam or free edge between
two nodes; both live on one or several layers (bit masks). **Lattice coordinates** count grid
lines. A **link** is a helper arc of one step in front of two free arcs, because a lattice vertex
has only four grid edges. With a mirror **axis** only the right half of a garment is drawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.errors import EncodeError
from garmentimage.geometry import polyline_length, signed_area
from garmentimage.raster.encode.lattice._kernels_chords import chord_loss_kernel
from garmentimage.raster.encode.layout import MAX_DEGREE, Layout, trunk_share, with_node_order
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType

CHORD_TOLERANCE = 0.5
"""A curve should be followed by its chords within this [cm] ..."""
CHORD_SHARE = 0.02
"""... or within this share of its length."""
MAX_DESIRED_EDGES = 4.0
"""No arc desires more grid edges than this."""
LENGTH_LOSS = (0.014, 0.35)
"""What a seam may lose of its length: a share, or so much [cm], whichever is more."""
AREA_LOSS = 0.03
"""What a panel may gain or lose of its area along one edge, as a share."""
MAX_REQUIRED_EDGES = (6, 3, 2, 1)
"""Grid edges that an arc may require, tried in turn until the grid has room."""
SHORT_ARC = 4.0
"""Arcs shorter than this [cm] desire one grid edge."""
LIMB_WEIGHT = 0.02
"""Weight of the targets of sleeves and hoods, next to 1 for the trunk: where both need a grid
line, the sleeve gives it up, and the trunk looks the same with it as without."""

Path = Int[np.ndarray, "_ 2"]
"""Vertices from tail to head, in lattice coordinates."""


class DrawnPaths(NamedTuple):
    """Lattice paths of the arcs, and the targets of their vertices."""

    paths: list[Path]
    wanted: list[Float[np.ndarray, "_ 2"]]
    """Per arc the target of each vertex, in the image's lattice coordinates."""


_Same = TypeVar("_Same", bound="_Records")


class _Records:
    """Parallel columns (arrays, or tuples of arrays), one row per record."""

    def _columns(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(cast(Any, self))}

    def __len__(self) -> int:
        return len(next(iter(self._columns().values())))

    def take(self: _Same, rows: Sequence[int] | Int[np.ndarray, " _"]) -> _Same:
        """The given rows, in the given order."""
        rows = np.asarray(rows, np.int64)
        return type(self)(
            **{
                name: tuple(column[i] for i in rows) if isinstance(column, tuple) else column[rows]
                for name, column in self._columns().items()
            }
        )

    def append(self: _Same, **row: Any) -> _Same:
        """The records and one more, given by its fields."""
        return type(self)(
            **{
                name: (*column, row[name])
                if isinstance(column, tuple)
                else np.concatenate([column, np.array([row[name]], column.dtype)])
                for name, column in self._columns().items()
            }
        )

    def with_row(self: _Same, index: int, **changes: Any) -> _Same:
        """The records, some fields of one of them changed."""
        columns = self._columns()
        for name, value in changes.items():
            column = columns[name]
            if isinstance(column, tuple):
                columns[name] = (*column[:index], value, *column[index + 1 :])
            else:
                columns[name] = column.copy()
                columns[name][index] = value
        return type(self)(**columns)


@dataclass(frozen=True)
class Nodes(_Records):
    """Where arcs end; indices are those of the seam graph, new nodes at the end."""

    target: Float[np.ndarray, "node 2"]
    """In lattice coordinates."""
    layers: Int[np.ndarray, " node"]
    """Bit mask of layers."""
    on_axis: Bool[np.ndarray, " node"]
    """The node lies on the mirror axis."""


@dataclass(frozen=True)
class Arcs(_Records):
    """What is drawn; indices are those of the seam graph, links at the end."""

    tail: Int[np.ndarray, " arc"]
    head: Int[np.ndarray, " arc"]
    layers: Int[np.ndarray, " arc"]
    """Bit mask of layers."""
    is_free: Bool[np.ndarray, " arc"]
    """The arc is sewn to nothing."""
    on_axis: Bool[np.ndarray, " arc"]
    """The whole arc lies on the mirror axis."""
    curves: tuple[Float[np.ndarray, "_ 2"], ...]
    """Target of each arc, from tail to head, in lattice coordinates."""
    min_edges: Int[np.ndarray, " arc"]
    """Fewest grid edges that the arc may have."""
    required_edges: Int[np.ndarray, " arc"]
    """Grid edges below which the arc's length or its panel's area would be lost."""
    desired_edges: Float[np.ndarray, " arc"]
    """Grid edges with which the arc's shape would be kept."""
    weight: Float[np.ndarray, " arc"]
    """How much the arc's targets count, next to 1 for the trunk."""

    @cached_property
    def cells(self) -> Float[np.ndarray, " arc"]:
        """How long the target of each arc is [cells]."""
        return np.array([polyline_length(curve) for curve in self.curves])

    def on_layer(self, layer: int) -> Bool[np.ndarray, " arc"]:
        """Which arcs lie on a layer."""
        return np.asarray((self.layers >> layer & 1).astype(bool))

    def ends(self, layer: int) -> list[tuple[int, int, bool]]:
        """(node, arc, at its head) for both ends of every arc on a layer."""
        return [
            (int(node), arc, at_head)
            for arc in np.flatnonzero(self.on_layer(layer)).tolist()
            for node, at_head in ((self.tail[arc], False), (self.head[arc], True))
        ]

    def away(self, arc: int, at_head: bool) -> Float[np.ndarray, "_ 2"]:
        """The target of an arc, from one of its ends to the other."""
        return self.curves[arc][::-1] if at_head else self.curves[arc]

    def with_reversed(self, is_reversed: Sequence[bool]) -> "Arcs":
        """The arcs, those marked run from head to tail."""
        return replace(
            self,
            tail=np.where(is_reversed, self.head, self.tail),
            head=np.where(is_reversed, self.tail, self.head),
            curves=tuple(
                c[::-1] if back else c for c, back in zip(self.curves, is_reversed, strict=True)
            ),
        )

    def with_end(
        self, arc: int, at_head: bool, node: int, point: Float[np.ndarray, " 2"]
    ) -> "Arcs":
        """The arcs, one end of one of them moved to another node."""
        curve = self.curves[arc].copy()
        curve[-1 if at_head else 0] = point
        return self.with_row(arc, curves=curve, **{"head" if at_head else "tail": node})


class Link(NamedTuple):
    """An arc whose path is prolonged by that of a link."""

    arc: int
    link: int
    """Number of the link among the arcs."""
    at_head: bool
    """The link joins the arc at its head, not at its tail."""


@dataclass(frozen=True)
class Drawing:
    """A graph and what its drawing should be like."""

    nodes: Nodes
    arcs: Arcs
    grid: int
    layer_count: int
    axis: int | None = None
    """Lattice column of the mirror axis; nothing is drawn left of it."""
    links: tuple[Link, ...] = ()

    @property
    def degree(self) -> Int[np.ndarray, "layer node"]:
        """How many arcs of each layer end at each node."""
        degree = np.zeros((self.layer_count, len(self.nodes)), int)
        for layer in range(self.layer_count):
            on = self.arcs.on_layer(layer)
            np.add.at(degree[layer], np.concatenate([self.arcs.tail[on], self.arcs.head[on]]), 1)
        return degree

    @cached_property
    def node_weight(self) -> Float[np.ndarray, " node"]:
        """How much a node's target counts: as its weightiest arc."""
        weight = np.zeros(len(self.nodes))
        np.maximum.at(weight, self.arcs.tail, self.arcs.weight)
        np.maximum.at(weight, self.arcs.head, self.arcs.weight)
        return weight


def drawing_of(layout: Layout, frame: BodyFrame) -> Drawing:
    """The drawing that a layout calls for in a body frame."""
    graph = layout.graph
    tail = np.array([arc.a for arc in graph.arcs])
    head = np.array([arc.b for arc in graph.arcs])
    layers = np.array([sum(1 << layer for layer in arc.layers) for arc in graph.arcs])
    curves = with_node_order(graph, tuple(frame.to_lattice(curve) for curve in layout.curves))
    target = np.zeros((graph.node_count, 2))
    for curve, a, b in zip(curves, tail, head, strict=True):
        target[a], target[b] = curve[0], curve[-1]
    nodes = Nodes(
        target=target,
        layers=layers_used(graph.node_count, tail, head, layers),
        on_axis=np.zeros(graph.node_count, bool),
    )
    arcs = Arcs(
        tail=tail,
        head=head,
        layers=layers,
        is_free=np.array(
            [arc.kind == EdgeType.NON_STITCH and not arc.is_inner for arc in graph.arcs]
        ),
        on_axis=np.zeros(len(graph.arcs), bool),
        curves=curves,
        min_edges=_min_edges(tail, head, layers),
        required_edges=np.array([_required_edges(layout, i) for i in range(len(graph.arcs))]),
        desired_edges=np.array([_desired_edges(layout, i) for i in range(len(graph.arcs))]),
        weight=_weight(layout),
    )
    return Drawing(nodes, arcs, frame.grid, graph.placed.layer_count)


def layers_used(
    count: int,
    tail: Int[np.ndarray, " arc"],
    head: Int[np.ndarray, " arc"],
    layers: Int[np.ndarray, " arc"],
) -> Int[np.ndarray, " node"]:
    """The layers of each of `count` nodes: those of its arcs."""
    used = np.zeros(count, np.int64)
    np.bitwise_or.at(used, tail, layers)
    np.bitwise_or.at(used, head, layers)
    return used


def with_required_edges(drawing: Drawing, limit: int) -> Drawing:
    """The drawing, where no arc may have fewer grid edges than it requires, up to a limit."""
    arcs = drawing.arcs
    least = np.maximum(arcs.min_edges, np.minimum(arcs.required_edges, limit))
    return replace(drawing, arcs=replace(arcs, min_edges=least))


def with_links(drawing: Drawing) -> Drawing:
    """Where more than four arcs of a layer meet, two free arcs of one outer gap share a link.

    Raises:
        EncodeError: five sewn seams meet in one point.
    """
    for layer, node in np.argwhere(drawing.degree > MAX_DEGREE).tolist():
        ends = _linkable_ends(drawing, layer, node)
        middle = np.mean([drawing.arcs.away(*end)[1] for end in ends], axis=0)
        drawing = with_link(drawing, node, ends, middle)
    return drawing


def with_link(
    drawing: Drawing,
    node: int,
    ends: list[tuple[int, bool]],
    place: Float[np.ndarray, " 2"],
    *,
    on_axis: bool = False,
) -> Drawing:
    """Arc ends (arc, at its head) at a node get a new one at `place`, to which a link leads."""
    nodes, arcs = drawing.nodes, drawing.arcs
    new, link = len(nodes), len(arcs)
    for arc, at_head in ends:
        arcs = arcs.with_end(arc, at_head, new, place)
    first, _ = ends[0]
    return replace(
        drawing,
        nodes=nodes.append(target=place, layers=arcs.layers[first], on_axis=on_axis),
        arcs=arcs.append(
            tail=node,
            head=new,
            layers=arcs.layers[first],
            is_free=True,
            on_axis=on_axis,
            curves=np.stack([nodes.target[node], place]),
            min_edges=1,
            required_edges=1,
            desired_edges=1.0,
            weight=arcs.weight[[arc for arc, _ in ends]].max(),
        ),
        links=(*drawing.links, *(Link(arc, link, at_head) for arc, at_head in ends)),
    )


def _linkable_ends(drawing: Drawing, layer: int, node: int) -> list[tuple[int, bool]]:
    """The two free arc ends (arc, at its head) beside the narrowest gap round a node."""
    arcs = drawing.arcs
    star = []
    for end, arc, at_head in arcs.ends(layer):
        if end == node:
            curve = arcs.away(arc, at_head)
            x, y = curve[min(2, len(curve) - 1)] - curve[0]
            star.append((float(np.arctan2(y, x)), arc, at_head))
    star.sort()
    gaps = []
    for first, second in zip(star, star[1:] + star[:1], strict=True):
        pair = [first[1], second[1]]
        alone = (arcs.layers[pair] == 1 << layer).all()
        if alone and arcs.is_free[pair].all() and pair[0] != pair[1]:
            gaps.append(((second[0] - first[0]) % (2 * np.pi), [first[1:], second[1:]]))
    if not gaps:
        raise EncodeError(
            f"{len(star)} seams meet in one point; a lattice point has room for four",
            remedy="either",
        )
    return min(gaps, key=lambda gap: gap[0])[1]


def joined_links(drawing: Drawing, paths: list[Path]) -> list[Path]:
    """Paths of the arcs alone: links are put in front of the arcs that they were taken from."""
    paths = list(paths)
    for arc, link, at_head in drawing.links:
        first, second = (arc, link) if at_head else (link, arc)
        onward = paths[second][::-1] if at_head else paths[second]
        paths[arc] = np.concatenate([paths[first][:-1], onward])
    return paths[: len(paths) - len({link for _, link, _ in drawing.links})]


def _min_edges(tail: np.ndarray, head: np.ndarray, layers: np.ndarray) -> np.ndarray:
    """Two arcs of a layer between the same nodes need two grid edges each to be apart."""
    ends = np.sort(np.stack([tail, head], axis=1), axis=1)
    same = (ends[:, None] == ends[None]).all(axis=2) & ((layers[:, None] & layers[None]) > 0)
    np.fill_diagonal(same, False)
    return np.where(same.any(axis=1), 2, 1)


def _weight(layout: Layout) -> Float[np.ndarray, " arc"]:
    """1 for arcs of the trunk, `LIMB_WEIGHT` for those of sleeves and hoods alone."""
    share = trunk_share(layout.graph.placed)
    most = [max(share[panel] for panel, _, _ in arc.sides) for arc in layout.graph.arcs]
    return LIMB_WEIGHT + (1.0 - LIMB_WEIGHT) * np.array(most)


def _desired_edges(layout: Layout, arc: int) -> float:
    """Chords that follow the arc's curve closely enough: the error of m chords falls as 1/m²."""
    desired = 1.0
    for panel, edge, _ in layout.graph.arcs[arc].sides:
        curve = layout.graph.placed.panels[panel].curves[edge]
        length = polyline_length(curve)
        if length < SHORT_ARC or len(curve) < 3:
            continue
        chord = curve[-1] - curve[0]
        size = max(float(np.hypot(*chord)), 1e-9)
        away = (curve[:, 0] - curve[0, 0]) * chord[1] - (curve[:, 1] - curve[0, 1]) * chord[0]
        bulge = float(np.abs(away).max()) / size
        desired = max(desired, np.sqrt(bulge / max(CHORD_TOLERANCE, CHORD_SHARE * length)))
    return float(min(desired, MAX_DESIRED_EDGES))


def _required_edges(layout: Layout, arc: int) -> int:
    """Fewest chords that keep the length of each side and the area of its panel."""
    required = 1
    for panel, edge, _ in layout.graph.arcs[arc].sides:
        placed = layout.graph.placed.panels[panel]
        curve = placed.curves[edge]
        if len(curve) < 3:
            continue
        length = polyline_length(curve)
        room = abs(signed_area(placed.outline)) * AREA_LOSS
        while required < MAX_REQUIRED_EDGES[0]:
            lost, sliver = chord_loss(curve, required)
            if lost <= max(LENGTH_LOSS[0] * length, LENGTH_LOSS[1]) and sliver <= room:
                break
            required += 1
    return required


def chord_loss(curve: Float[np.ndarray, "n 2"], count: int) -> tuple[float, float]:
    """What `count` even chords lose of a curve: length [cm], and area on its side [cm²]."""
    if len(curve) < 3 or count < 1:
        return 0.0, 0.0
    lost, sliver = chord_loss_kernel(np.ascontiguousarray(curve), count)
    return float(lost), float(sliver)
