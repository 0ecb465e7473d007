"""The cyclic order of arcs round each node: what a planar drawing is, apart from its shape.

A lattice vertex has four grid edges, so up to four arcs of a layer leave a node, each in its own
direction (0 right, 1 up, 2 left, 3 down). An arc of both layers leaves in one direction on both.
"""

import numpy as np
from jaxtyping import Int
from numba import njit

from garmentimage.raster.encode.lattice.drawing import Drawing

MOST_ENDS = 8
"""More arc ends than this round one node cannot be drawn: four on each layer."""


def departures(drawing: Drawing) -> Int[np.ndarray, "arc 2"]:
    """Direction in which each arc leaves its tail and its head; -1 where it may choose.

    The directions keep the cyclic order that the target curves have round the node, and turn
    the curves least. Nodes with at most two arcs a layer need no such care.
    """
    assert all(len(c) > 1 and np.isfinite(c).all() for c in drawing.curves)
    first = np.array([c[1] - c[0] for c in drawing.curves])
    last = np.array([c[-2] - c[-1] for c in drawing.curves])
    second = np.array([c[min(2, len(c) - 1)] - c[0] for c in drawing.curves])
    second_last = np.array([c[max(len(c) - 3, 0)] - c[-1] for c in drawing.curves])
    angles = np.stack([_angle(first, second), _angle(last, second_last)], axis=1)
    return _departures(
        drawing.tail,
        drawing.head,
        drawing.layers,
        drawing.on_axis,
        drawing.node_on_axis,
        angles,
        len(drawing.node_target),
        drawing.axis is not None,
    )


def _angle(near: np.ndarray, far: np.ndarray) -> np.ndarray:
    """Direction of the curve at its end; a little of what follows breaks ties."""
    vector = near / (np.hypot(*near.T)[:, None] + 1e-12)
    onward = far / (np.hypot(*far.T)[:, None] + 1e-12)
    vector = vector + 0.05 * onward
    return np.arctan2(vector[:, 1], vector[:, 0])


@njit(cache=True)
def _departures(tail, head, layers, on_axis, node_on_axis, angles, nodes, has_axis):  # type: ignore[no-untyped-def]
    arcs = len(tail)
    out = np.full((arcs, 2), -1, np.int64)
    ends = np.empty((MOST_ENDS, 2), np.int64)
    for node in range(nodes):
        count = 0
        degree = np.zeros(2, np.int64)
        fits = True
        for arc in range(arcs):
            for end in range(2):
                if (tail[arc] if end == 0 else head[arc]) == node:
                    if count == MOST_ENDS:
                        fits = False
                        continue
                    ends[count, 0], ends[count, 1] = arc, end
                    count += 1
                    for layer in range(2):
                        degree[layer] += layers[arc] >> layer & 1
        if has_axis and node_on_axis[node]:
            for k in range(count):
                arc, end = ends[k]
                if on_axis[arc]:
                    out[arc, end] = 1 if np.sin(angles[arc, end]) > 0 else 3
                else:
                    out[arc, end] = 0
            continue
        if not fits or degree.max() <= 2 or degree.max() > 4:
            continue
        best = 1e18
        pick = np.zeros(count, np.int64)
        for code in range(4**count):
            rest, cost = code, 0.0
            taken = np.zeros((2, 4), np.bool_)
            good = True
            for k in range(count):
                d = rest % 4
                rest //= 4
                pick[k] = d
                arc, end = ends[k]
                for layer in range(2):
                    if layers[arc] >> layer & 1:
                        good = good and not taken[layer, d]
                        taken[layer, d] = True
                if not good:
                    break
                turn = angles[arc, end] - d * np.pi / 2
                cost += 1.0 - np.cos(turn)
                if cost >= best:
                    good = False
                    break
            if not good:
                continue
            for layer in range(2):
                if not _keeps_order(ends, pick, count, angles, layers, layer):
                    good = False
            if good:
                best = cost
                for k in range(count):
                    out[ends[k, 0], ends[k, 1]] = pick[k]
    return out


@njit(cache=True)
def _keeps_order(ends, pick, count, angles, layers, layer):  # type: ignore[no-untyped-def]
    """Whether directions and angles of one layer's arcs have the same cyclic order."""
    by_direction = np.full(4, -1.0)
    n = 0
    for k in range(count):
        if layers[ends[k, 0]] >> layer & 1:
            by_direction[pick[k]] = angles[ends[k, 0], ends[k, 1]] + 10.0
            n += 1
    if n < 3:
        return True
    falls = 0
    order = by_direction[by_direction > 0]
    for k in range(n):
        if order[(k + 1) % n] < order[k]:
            falls += 1
    return falls == 1
