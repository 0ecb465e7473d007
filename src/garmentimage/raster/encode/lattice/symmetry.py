"""Left-right symmetry: one half is drawn, the other is its mirror image, so both agree exactly.

A garment counts as symmetric when every arc has a mirror partner within a few centimetres: small
differences between the halves stay in the deformation, where they belong.
"""

from dataclasses import dataclass, replace

import numpy as np

from garmentimage.geometry import resample
from garmentimage.raster.encode.lattice.drawing import Drawing, Path
from garmentimage.raster.encode.layout import Layout

SYMMETRY_TOLERANCE = 3.0
"""Mirrored arcs lie within this of each other [cm]."""
AXIS_REACH = 4.0
"""The garment's own axis lies within this of the body's axis [cm]."""
SAMPLES = 9


@dataclass(frozen=True)
class Mirror:
    """For each arc its partner, and whether the partner runs the other way."""

    partner: tuple[int, ...]
    reverse: tuple[bool, ...]


@dataclass(frozen=True)
class Half:
    """The right half of a symmetric drawing, and how to unfold its paths."""

    drawing: Drawing
    mirror: Mirror
    kept: tuple[int, ...]
    """Arc of the whole drawing for each arc of the half."""
    crossing: tuple[int, ...]
    """0 for a whole arc; +1 / -1 for the half of an arc that crosses the axis and ends there at
    its head / its tail."""

    def unfold(self, paths: list[Path]) -> list[Path]:
        """Paths of the whole drawing from those of the half."""
        assert self.drawing.axis is not None
        whole: list[Path] = [np.zeros((0, 2), np.int64)] * len(self.mirror.partner)
        for arc, crossing, path in zip(self.kept, self.crossing, paths):
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
    arcs = layout.complex.arcs
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
    ends: dict[int, int] = {}
    for i, arc in enumerate(arcs):
        other = arcs[partner[i]]
        images = (other.b, other.a) if reverse[i] else (other.a, other.b)
        for node, image in zip((arc.a, arc.b), images):
            if ends.setdefault(node, image) != image:
                return None
    return Mirror(tuple(partner.tolist()), tuple(reverse.tolist()))


def halve(drawing: Drawing, mirror: Mirror) -> Half | None:
    """The right half of a drawing, made exactly symmetric; None if the axis has no room for it."""
    axis = drawing.grid // 2
    node_image = np.arange(len(drawing.node_target))
    for i, (j, back) in enumerate(zip(mirror.partner, mirror.reverse)):
        ends = (drawing.head[j], drawing.tail[j]) if back else (drawing.tail[j], drawing.head[j])
        node_image[drawing.tail[i]], node_image[drawing.head[i]] = ends
    flip = np.array([-1.0, 1.0])
    middle = _centre(drawing)
    targets = drawing.node_target - [middle, 0]
    targets = (targets + targets[node_image] * flip) / 2 + [axis, 0]
    on_axis = node_image == np.arange(len(node_image))
    targets[on_axis, 0] = axis
    tail, head, layers, free, arc_axis = [], [], [], [], []
    curves, least, need, wish, weight, kept, crossing = [], [], [], [], [], [], []
    node_targets, node_layers, node_axis = list(targets), list(drawing.node_layers), list(on_axis)
    for i, (j, back) in enumerate(zip(mirror.partner, mirror.reverse)):
        curve = _even(drawing.curves[i]) - [middle, 0]
        other = (_even(drawing.curves[j]) - [middle, 0]) * flip
        curve = (curve + (other[::-1] if back else other)) / 2 + [axis, 0]
        a, b = int(drawing.tail[i]), int(drawing.head[i])
        side = 0
        if i != j:
            x = curve[:, 0].mean()
            if x < axis or (x == axis and i > j):
                continue
        elif back:
            side = 1 if curve[-1, 0] > axis else -1
            curve = curve[::side][len(curve) // 2 :]
            curve[0, 0] = axis
            node_targets.append(curve[0])
            node_layers.append(drawing.layers[i])
            node_axis.append(True)
            a, b = len(node_targets) - 1, (b if side > 0 else a)
        else:
            curve[:, 0] = axis
        tail.append(a)
        head.append(b)
        layers.append(int(drawing.layers[i]))
        free.append(bool(drawing.free[i]))
        arc_axis.append(i == j and not back)
        curves.append(curve)
        share = 0.5 if side else 1.0
        least.append(1 if side else max(int(drawing.least[i]), int(drawing.least[j])))
        needed = max(int(drawing.need[i]), int(drawing.need[j]))
        need.append((needed + 1) // 2 if side else needed)
        wish.append(max(share * max(drawing.wish[i], drawing.wish[j]), 1.0))
        weight.append((drawing.weight[i] + drawing.weight[j]) / 2)
        kept.append(i)
        crossing.append(side)
    half = replace(
        drawing,
        node_target=np.array(node_targets),
        node_layers=_layers_used(len(node_targets), tail, head, layers),
        node_on_axis=np.array(node_axis),
        tail=np.array(tail),
        head=np.array(head),
        layers=np.array(layers),
        free=np.array(free),
        on_axis=np.array(arc_axis),
        curves=tuple(curves),
        least=np.array(least),
        need=np.array(need),
        wish=np.array(wish),
        weight=np.array(weight),
        axis=axis,
    )
    half = _with_axis_links(half)
    return Half(half, mirror, tuple(kept), tuple(crossing)) if _fits_axis(half) else None


def _centre(drawing: Drawing) -> float:
    points = np.concatenate(drawing.curves)
    return float(points[:, 0].min() + points[:, 0].max()) / 2


def _even(curve: np.ndarray) -> np.ndarray:
    """The curve with an odd number of points, so that it has a middle one."""
    return curve if len(curve) % 2 else resample(curve, np.linspace(0, 1, len(curve) + 1))


def _layers_used(count: int, tail: list[int], head: list[int], layers: list[int]) -> np.ndarray:
    used = np.zeros(count, np.int64)
    np.bitwise_or.at(used, tail, layers)
    np.bitwise_or.at(used, head, layers)
    return used


def _with_axis_links(half: Drawing) -> Drawing:
    """Free arcs that open a gap on the axis (a hood, a slit) first share a step along it."""
    for node in np.flatnonzero(half.node_on_axis):
        for layer in (0, 1):
            leaving = [x for x in _leaving(half, layer) if x[0] == node]
            if len(leaving) != 2:
                continue
            # The gap lies where a free arc is steepest: between it and its mirror image.
            away = [
                half.curves[arc][::-1] if at_head else half.curves[arc]
                for _, arc, at_head in leaving
            ]
            slope = [(c[1] - c[0])[1] / (np.hypot(*(c[1] - c[0])) + 1e-12) for c in away]
            steep = int(np.argmax(np.abs(slope)))
            _, arc, at_head = leaving[steep]
            up = bool(slope[steep] > 0)
            if half.free[arc] and not _axis_taken(half, int(node), layer, up):
                half = _with_axis_link(half, int(node), arc, at_head)
    return half


def _leaving(half: Drawing, layer: int) -> list[tuple[int, int, bool]]:
    """(axis node, arc, at its head) for every arc of a layer that leaves the axis."""
    return [
        (int(node), int(arc), at_head)
        for arc in np.flatnonzero((half.layers >> layer & 1).astype(bool) & ~half.on_axis)
        for at_head, node in ((False, half.tail[arc]), (True, half.head[arc]))
        if half.node_on_axis[node]
    ]


def _axis_taken(half: Drawing, node: int, layer: int, up: bool) -> bool:
    """Whether an arc of this layer already leaves the node along the axis, upwards or down."""
    for arc in np.flatnonzero((half.layers >> layer & 1).astype(bool) & half.on_axis):
        for first, curve in (
            (half.tail[arc], half.curves[arc]),
            (half.head[arc], half.curves[arc][::-1]),
        ):
            if first == node and (curve[-1, 1] > curve[0, 1]) == up:
                return True
    return False


def _with_axis_link(half: Drawing, node: int, arc: int, at_head: bool) -> Drawing:
    """The free arc leaves from a new axis node; a link along the axis leads there."""
    curve = half.curves[arc][::-1] if at_head else half.curves[arc]
    place = np.array([half.axis, curve[1, 1]], float)
    moved = np.concatenate([place[None], curve[1:]])
    curves = list(half.curves)
    curves[arc] = moved[::-1] if at_head else moved
    new, link = len(half.node_target), half.arc_count
    tail, head = half.tail.copy(), half.head.copy()
    (head if at_head else tail)[arc] = new
    layers = half.layers[arc]
    return replace(
        half,
        node_target=np.vstack([half.node_target, place]),
        node_layers=np.append(half.node_layers, layers),
        node_on_axis=np.append(half.node_on_axis, True),
        tail=np.append(tail, node),
        head=np.append(head, new),
        layers=np.append(half.layers, layers),
        free=np.append(half.free, True),
        on_axis=np.append(half.on_axis, True),
        curves=(*curves, np.stack([half.node_target[node], place])),
        least=np.append(half.least, 1),
        need=np.append(half.need, 1),
        wish=np.append(half.wish, 1.0),
        weight=np.append(half.weight, half.weight[arc]),
        links=(*half.links, (arc, link, at_head)),
    )


def _fits_axis(half: Drawing) -> bool:
    """Whether every axis node has at most one arc a layer that leaves the axis."""
    for layer in (0, 1):
        nodes = [node for node, _, _ in _leaving(half, layer)]
        if len(set(nodes)) < len(nodes):
            return False
    return True
