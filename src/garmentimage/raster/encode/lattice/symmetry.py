"""Left-right symmetry: one half is drawn, the other is its mirror image, so both agree exactly.

A garment counts as symmetric when every arc has a mirror partner within a few centimetres: small
differences between the halves are kept in the deformation, where they belong.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.geometry import resample
from garmentimage.raster.encode.lattice.drawing import (
    Arcs,
    Drawing,
    Nodes,
    Path,
    layers_used,
    with_link,
)
from garmentimage.raster.encode.layout import Layout

SYMMETRY_TOLERANCE = 3.0
"""Mirrored arcs lie within this of each other [cm]."""
AXIS_REACH = 4.0
"""The garment's own axis lies within this of the body's axis [cm]."""
SAMPLES = 9
"""Points at which two arcs are compared."""


@dataclass(frozen=True)
class Mirror:
    """What the mirror image of each arc and of each node is."""

    partner: Int[np.ndarray, " arc"]
    reverse: Bool[np.ndarray, " arc"]
    """The partner runs against the arc."""
    node: Int[np.ndarray, " node"]


@dataclass(frozen=True)
class MirrorHalf:
    """The right half of a symmetric drawing, and how to unfold its paths."""

    drawing: Drawing
    mirror: Mirror
    kept: Int[np.ndarray, " kept"]
    """Arc of the whole drawing for each arc of the half."""
    crossing: list[int]
    """0 for a whole arc; +1 / -1 for the half of an arc that crosses the axis and ends there at
    its head / its tail."""

    def unfold(self, paths: list[Path]) -> list[Path]:
        """Paths of the whole drawing from those of the half."""
        assert self.drawing.axis is not None
        whole: list[Path] = [np.zeros((0, 2), np.int64)] * len(self.mirror.partner)
        for arc, crossing, path in zip(self.kept, self.crossing, paths, strict=True):
            image = path * [-1, 1] + [2 * self.drawing.axis, 0]
            if crossing:
                full = np.concatenate([image[::-1], path[1:]])
                whole[arc] = full if crossing > 0 else full[::-1]
                continue
            whole[arc] = path
            partner = self.mirror.partner[arc]
            if partner != arc:
                whole[partner] = image[::-1] if self.mirror.reverse[arc] else image
        return whole


def find_mirror(layout: Layout) -> Mirror | None:
    """The pairing of arcs under left-right mirroring, or None for an asymmetric garment."""
    arcs = layout.graph.arcs
    points = np.concatenate(layout.curves)
    centre = (points[:, 0].min() + points[:, 0].max()) / 2
    if abs(centre) > AXIS_REACH:
        return None
    shares = np.linspace(0, 1, SAMPLES)
    curves = np.stack([resample(c, shares) for c in layout.curves]) - [centre, 0]
    mirrored = curves * [-1, 1]
    ahead = np.abs(mirrored[:, None] - curves[None]).max(axis=(2, 3))
    back = np.abs(mirrored[:, None] - curves[None, :, ::-1]).max(axis=(2, 3))
    kinds = [(arc.layers, arc.kind, arc.slit) for arc in arcs]
    unlike = np.array([[a != b for b in kinds] for a in kinds])
    gap = np.where(unlike, np.inf, np.minimum(ahead, back))
    partner = gap.argmin(axis=1)
    here = np.arange(len(arcs))
    if gap[here, partner].max() > SYMMETRY_TOLERANCE or (partner[partner] != here).any():
        return None
    reverse = back[here, partner] < ahead[here, partner]
    # Partners meet in partners: else the halves are not joined alike.
    ends = np.array([(arc.a, arc.b) for arc in arcs])
    images = np.where(reverse[:, None], ends[partner, ::-1], ends[partner])
    node = np.arange(layout.graph.node_count)
    node[ends] = images
    return Mirror(partner, reverse, node) if (node[ends] == images).all() else None


def right_half(drawing: Drawing, mirror: Mirror) -> MirrorHalf | None:
    """The right half of a drawing, made exactly symmetric; None if the axis has no room for it.

    The axis is moved to the middle column of the grid. Every arc and node becomes the mean of
    itself and its mirrored partner. Of a pair the arc on the right is kept; an arc that is its own
    partner lies on the axis, or crosses it and is cut there at a new node.
    """
    axis = drawing.grid // 2
    nodes = _symmetric_nodes(drawing, mirror, axis)
    arcs = _symmetric_arcs(drawing, mirror, axis)
    here, partner = np.arange(len(arcs)), mirror.partner
    middle = np.array([curve[:, 0].mean() for curve in arcs.curves])
    is_left = (middle < axis) | ((middle == axis) & (here > partner))
    is_crossing = (partner == here) & mirror.reverse
    kept = np.flatnonzero((partner == here) | ~is_left)
    arcs = arcs.take(kept)
    crossing = [
        (1 if curve[-1, 0] > axis else -1) if crosses else 0
        for curve, crosses in zip(arcs.curves, is_crossing[kept], strict=True)
    ]
    for k in np.flatnonzero(crossing).tolist():
        nodes, arcs = _cut_at_axis(nodes, arcs, k, crossing[k], axis)
    used = layers_used(len(nodes), arcs.tail, arcs.head, arcs.layers)
    half = replace(drawing, nodes=replace(nodes, layers=used), arcs=arcs, axis=axis)
    half = _with_axis_links(half)
    # An axis node has room for one arc a layer that leaves the axis.
    leaving = [[node for node, _, _ in _leaving(half, layer)] for layer in (0, 1)]
    if any(len(set(nodes)) < len(nodes) for nodes in leaving):
        return None
    return MirrorHalf(half, mirror, kept, crossing)


def _symmetric_nodes(drawing: Drawing, mirror: Mirror, axis: int) -> Nodes:
    """Nodes halfway between themselves and their mirrored partners."""
    target = drawing.nodes.target - [_centre(drawing), 0]
    target = (target + target[mirror.node] * [-1.0, 1.0]) / 2 + [axis, 0]
    on_axis = mirror.node == np.arange(len(target))
    target[on_axis, 0] = axis
    return replace(drawing.nodes, target=target, on_axis=on_axis)


def _symmetric_arcs(drawing: Drawing, mirror: Mirror, axis: int) -> Arcs:
    """Arcs halfway between themselves and their mirrored partners, all still there."""
    arcs, centre = drawing.arcs, _centre(drawing)
    pair = arcs.take(mirror.partner)
    on_axis = (mirror.partner == np.arange(len(arcs))) & ~mirror.reverse
    curves = []
    columns = zip(arcs.curves, pair.curves, mirror.reverse, on_axis, strict=True)
    for own, other, back, is_vertical in columns:
        curve = _with_middle(own) - [centre, 0]
        image = (_with_middle(other) - [centre, 0]) * [-1.0, 1.0]
        curve = (curve + (image[::-1] if back else image)) / 2 + [axis, 0]
        if is_vertical:
            curve[:, 0] = axis
        curves.append(curve)
    return replace(
        arcs,
        on_axis=on_axis,
        curves=tuple(curves),
        min_edges=np.maximum(arcs.min_edges, pair.min_edges),
        required_edges=np.maximum(arcs.required_edges, pair.required_edges),
        desired_edges=np.maximum(np.maximum(arcs.desired_edges, pair.desired_edges), 1.0),
        weight=(arcs.weight + pair.weight) / 2,
    )


def _cut_at_axis(nodes: Nodes, arcs: Arcs, arc: int, side: int, axis: int) -> tuple[Nodes, Arcs]:
    """The right half of an arc that crosses the axis, from a new node on the axis.

    `side` is 1 where its head lies on the right, -1 where its tail does.
    """
    curve = arcs.curves[arc][::side][len(arcs.curves[arc]) // 2 :].copy()
    curve[0, 0] = axis
    nodes = nodes.append(target=curve[0], layers=arcs.layers[arc], on_axis=True)
    return nodes, arcs.with_row(
        arc,
        tail=len(nodes) - 1,
        head=(arcs.head if side > 0 else arcs.tail)[arc],
        curves=curve,
        min_edges=1,
        required_edges=(arcs.required_edges[arc] + 1) // 2,
        desired_edges=max(0.5 * arcs.desired_edges[arc], 1.0),
    )


def _centre(drawing: Drawing) -> float:
    """Middle of the drawing from left to right."""
    points = np.concatenate(drawing.arcs.curves)
    return float(points[:, 0].min() + points[:, 0].max()) / 2


def _with_middle(curve: Float[np.ndarray, "_ 2"]) -> Float[np.ndarray, "_ 2"]:
    """The curve with an odd number of points, so that it has a middle one."""
    return curve if len(curve) % 2 else resample(curve, np.linspace(0, 1, len(curve) + 1))


def _with_axis_links(half: Drawing) -> Drawing:
    """Free arcs that open a gap on the axis (a hood, a slit) first share a step along it."""
    for node in np.flatnonzero(half.nodes.on_axis).tolist():
        for layer in range(half.layer_count):
            leaving = [end for end in _leaving(half, layer) if end[0] == node]
            if len(leaving) != 2:
                continue
            # The gap lies where a free arc is steepest: between it and its mirror image.
            away = [half.arcs.away(arc, at_head) for _, arc, at_head in leaving]
            slope = [(c[1] - c[0])[1] / (np.hypot(*(c[1] - c[0])) + 1e-12) for c in away]
            steep = int(np.argmax(np.abs(slope)))
            _, arc, at_head = leaving[steep]
            up = bool(slope[steep] > 0)
            if half.arcs.is_free[arc] and not _axis_taken(half, node, layer, up):
                place = np.array([half.axis, away[steep][1, 1]], float)
                half = with_link(half, node, [(arc, at_head)], place, on_axis=True)
    return half


def _leaving(half: Drawing, layer: int) -> list[tuple[int, int, bool]]:
    """(axis node, arc, at its head) for every arc of a layer that leaves the axis."""
    on_axis = half.nodes.on_axis
    return [
        end for end in half.arcs.ends(layer) if on_axis[end[0]] and not half.arcs.on_axis[end[1]]
    ]


def _axis_taken(half: Drawing, node: int, layer: int, up: bool) -> bool:
    """Whether an arc of this layer already leaves the node along the axis, upwards or down."""
    along = [
        half.arcs.away(arc, at_head)[[0, -1], 1]
        for end, arc, at_head in half.arcs.ends(layer)
        if end == node and half.arcs.on_axis[arc]
    ]
    return any((last > first) == up for first, last in along)
