"""The graph that is drawn on the lattice: nodes, arcs, and where they would like to be.

Words of this file: a **node** is a point where seams end, an **arc** a seam or free edge between
two nodes; both live on one or several layers (bit masks). **Lattice coordinates** count grid
lines. A **link** is a helper arc of one step in front of two free arcs, because a lattice vertex
has only four grid edges. With a mirror **axis** only the right half of a garment is drawn.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.errors import EncodeError
from garmentimage.geometry import polyline_length, signed_area
from garmentimage.raster.encode.lattice._kernels_chords import chord_loss_kernel
from garmentimage.raster.encode.layout import Layout, trunk_share
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType

CHORD_TOLERANCE = 0.5
"""A curve should be followed by its chords within this [cm] ..."""
CHORD_SHARE = 0.02
"""... or within this share of its length."""
MOST_CHORDS = 4.0
"""No arc asks for more grid edges than this."""
LENGTH_LOSS = (0.014, 0.35)
"""What a seam may lose of its length: a share, or so much [cm], whichever is more."""
AREA_LOSS = 0.03
"""What a panel may gain or lose of its area along one edge, as a share."""
MOST_NEEDED = (6, 3, 2, 1)
"""Grid edges that an arc may insist on, tried in turn until the grid has room."""
SHORT_ARC = 4.0
"""Arcs shorter than this [cm] ask for one grid edge."""
LATTICE_DEGREE = 4
LIMB_WEIGHT = 0.02
"""Weight of the wishes of sleeves and hoods, next to 1 for the trunk: where both want a grid line,
the sleeve makes way, and the trunk looks the same with it as without."""

Path = Int[np.ndarray, "n 2"]


@dataclass(frozen=True)
class Drawing:
    """A graph with its wishes; indices of arcs and nodes are those of the seam complex."""

    node_target: Float[np.ndarray, "node 2"]
    node_layers: Int[np.ndarray, " node"]
    """Bit mask of layers."""
    node_on_axis: Bool[np.ndarray, " node"]
    tail: Int[np.ndarray, " arc"]
    head: Int[np.ndarray, " arc"]
    layers: Int[np.ndarray, " arc"]
    """Bit mask of layers."""
    free: Bool[np.ndarray, " arc"]
    """The arc is sewn to nothing."""
    on_axis: Bool[np.ndarray, " arc"]
    """The whole arc lies on the mirror axis."""
    curves: tuple[Float[np.ndarray, "n 2"], ...]
    """Target of each arc, from tail to head, in lattice coordinates."""
    least: Int[np.ndarray, " arc"]
    """Fewest grid edges that the arc may have."""
    need: Int[np.ndarray, " arc"]
    """Grid edges below which the arc's length or its panel's area would be lost."""
    wish: Float[np.ndarray, " arc"]
    """Grid edges with which the arc's shape would survive."""
    weight: Float[np.ndarray, " arc"]
    """How much the arc's wishes count, next to 1 for the trunk."""
    grid: int
    axis: int | None = None
    """Lattice column of the mirror axis; nothing is drawn left of it."""
    links: tuple[tuple[int, int, bool], ...] = ()
    """(arc, link, at the arc's head): the arc's path is prolonged by the link's."""

    @property
    def node_weight(self) -> Float[np.ndarray, " node"]:
        """How much a node's wish counts: as its weightiest arc."""
        weight = np.zeros(len(self.node_target))
        np.maximum.at(weight, self.tail, self.weight)
        np.maximum.at(weight, self.head, self.weight)
        return weight

    @property
    def arc_count(self) -> int:
        """Number of arcs, links included."""
        return len(self.tail)


def drawing_of(layout: Layout, frame: BodyFrame) -> Drawing:
    """The drawing that a layout asks for in a body frame."""
    arcs = layout.complex.arcs
    count = layout.complex.node_count
    tail = np.array([arc.a for arc in arcs])
    head = np.array([arc.b for arc in arcs])
    layers = np.array([sum(1 << layer for layer in arc.layers) for arc in arcs])
    curves = tuple(frame.to_lattice(curve) for curve in layout.curves)
    node_layers = np.zeros(count, np.int64)
    np.bitwise_or.at(node_layers, tail, layers)
    np.bitwise_or.at(node_layers, head, layers)
    node_target = np.zeros((count, 2))
    for i in range(len(arcs)):
        node_target[tail[i]], node_target[head[i]] = curves[i][0], curves[i][-1]
    return Drawing(
        node_target=node_target,
        node_layers=node_layers,
        node_on_axis=np.zeros(count, bool),
        tail=tail,
        head=head,
        layers=layers,
        free=np.array([arc.kind == EdgeType.NON_STITCH for arc in arcs]),
        on_axis=np.zeros(len(arcs), bool),
        curves=curves,
        least=_least(tail, head, layers),
        need=np.array([_need(layout, i) for i in range(len(arcs))]),
        wish=np.array([_wish(layout, i) for i in range(len(arcs))]),
        weight=_weight(layout),
        grid=frame.grid,
    )


def with_bends(drawing: Drawing, most: int) -> Drawing:
    """Bent arcs insist on the grid edges that they need, up to `most`."""
    return replace(drawing, least=np.maximum(drawing.least, np.minimum(drawing.need, most)))


def with_links(drawing: Drawing) -> Drawing:
    """Where more than four arcs of a layer meet, two free arcs of one outer gap share a link.

    Raises:
        EncodeError: five sewn seams meet in one point.
    """
    degree = np.zeros((2, len(drawing.node_target)), int)
    for layer in (0, 1):
        on = (drawing.layers >> layer & 1).astype(bool)
        np.add.at(degree[layer], drawing.tail[on], 1)
        np.add.at(degree[layer], drawing.head[on], 1)
    for layer, node in zip(*np.nonzero(degree > LATTICE_DEGREE)):
        drawing = _with_link(drawing, int(layer), int(node))
    return drawing


def _with_link(drawing: Drawing, layer: int, node: int) -> Drawing:
    star = []
    for arc in range(drawing.arc_count):
        for at_head, end in ((False, drawing.tail[arc]), (True, drawing.head[arc])):
            if end == node and drawing.layers[arc] >> layer & 1:
                curve = drawing.curves[arc][::-1] if at_head else drawing.curves[arc]
                away = curve[min(2, len(curve) - 1)] - curve[0]
                star.append((float(np.arctan2(away[1], away[0])), arc, at_head))
    star.sort()
    best = None
    for first, second in zip(star, star[1:] + star[:1]):
        gap = (second[0] - first[0]) % (2 * np.pi)
        single = all(drawing.layers[x[1]] == 1 << layer for x in (first, second))
        if (
            single
            and drawing.free[[first[1], second[1]]].all()
            and first[1] != second[1]
            and (best is None or gap < best[0])
        ):
            best = (gap, first, second)
    if best is None:
        raise EncodeError(
            f"{len(star)} seams meet in one point; a lattice point has room for four",
            remedy="either",
        )
    _, first, second = best
    new = len(drawing.node_target)
    link = drawing.arc_count
    target = drawing.node_target[node]
    tail, head, curves = drawing.tail.copy(), drawing.head.copy(), list(drawing.curves)
    starts = []
    for _, arc, at_head in (first, second):
        starts.append(curves[arc][-2 if at_head else 1])
    middle = np.mean(starts, axis=0)
    for _, arc, at_head in (first, second):
        curve = curves[arc].copy()
        curve[-1 if at_head else 0] = middle
        curves[arc] = curve
        (head if at_head else tail)[arc] = new
    return replace(
        drawing,
        node_target=np.vstack([drawing.node_target, middle]),
        node_layers=np.append(drawing.node_layers, 1 << layer),
        node_on_axis=np.append(drawing.node_on_axis, False),
        tail=np.append(tail, node),
        head=np.append(head, new),
        layers=np.append(drawing.layers, 1 << layer),
        free=np.append(drawing.free, True),
        on_axis=np.append(drawing.on_axis, False),
        curves=(*curves, np.stack([target, middle])),
        least=np.append(drawing.least, 1),
        need=np.append(drawing.need, 1),
        wish=np.append(drawing.wish, 1.0),
        weight=np.append(drawing.weight, drawing.weight[[first[1], second[1]]].max()),
        links=(
            *drawing.links,
            (first[1], link, first[2]),
            (second[1], link, second[2]),
        ),
    )


def joined_links(drawing: Drawing, paths: list[Path]) -> list[Path]:
    """Paths of the arcs alone: links are put in front of the arcs that they were taken from."""
    paths = list(paths)
    for arc, link, at_head in drawing.links:
        prefix = paths[link]
        if at_head:
            paths[arc] = np.concatenate([paths[arc], prefix[::-1][1:]])
        else:
            paths[arc] = np.concatenate([prefix[:-1], paths[arc]])
    if drawing.links:
        first = min(link for _, link, _ in drawing.links)
        paths = paths[:first]
    return paths


def _least(tail: np.ndarray, head: np.ndarray, layers: np.ndarray) -> np.ndarray:
    """Two arcs of a layer between the same nodes need two grid edges each to stay apart."""
    ends = np.sort(np.stack([tail, head], axis=1), axis=1)
    same = (ends[:, None] == ends[None]).all(axis=2) & ((layers[:, None] & layers[None]) > 0)
    np.fill_diagonal(same, False)
    return np.where(same.any(axis=1), 2, 1)


def _weight(layout: Layout) -> Float[np.ndarray, " arc"]:
    """1 for arcs of the trunk, `LIMB_WEIGHT` for those of sleeves and hoods alone."""
    share = trunk_share(layout.complex.placed)
    most = [max(share[panel] for panel, _, _ in arc.sides) for arc in layout.complex.arcs]
    return LIMB_WEIGHT + (1.0 - LIMB_WEIGHT) * np.array(most)


def _wish(layout: Layout, arc_index: int) -> float:
    """Chords that follow the arc's curve closely enough: the error of m chords falls as 1/m²."""
    wish = 1.0
    for panel, edge, _ in layout.complex.arcs[arc_index].sides:
        curve = layout.complex.placed.panels[panel].curves[edge]
        length = polyline_length(curve)
        if length < SHORT_ARC or len(curve) < 3:
            continue
        chord = curve[-1] - curve[0]
        size = max(float(np.hypot(*chord)), 1e-9)
        away = (curve[:, 0] - curve[0, 0]) * chord[1] - (curve[:, 1] - curve[0, 1]) * chord[0]
        bulge = float(np.abs(away).max()) / size
        wish = max(wish, np.sqrt(bulge / max(CHORD_TOLERANCE, CHORD_SHARE * length)))
    return float(min(wish, MOST_CHORDS))


def _need(layout: Layout, arc_index: int) -> int:
    """Fewest chords that keep the length of each side and the area of its panel."""
    need = 1
    for panel, edge, _ in layout.complex.arcs[arc_index].sides:
        placed = layout.complex.placed.panels[panel]
        curve = placed.curves[edge]
        if len(curve) < 3:
            continue
        length = polyline_length(curve)
        room = abs(signed_area(placed.outline)) * AREA_LOSS
        while need < MOST_NEEDED[0]:
            lost, sliver = chord_loss(curve, need)
            if lost <= max(LENGTH_LOSS[0] * length, LENGTH_LOSS[1]) and sliver <= room:
                break
            need += 1
    return need


def chord_loss(curve: Float[np.ndarray, "n 2"], count: int) -> tuple[float, float]:
    """What `count` even chords lose of a curve: length [cm], and area on its side [cm²]."""
    if len(curve) < 3 or count < 1:
        return 0.0, 0.0
    lost, sliver = chord_loss_kernel(np.ascontiguousarray(curve), count)
    return float(lost), float(sliver)
