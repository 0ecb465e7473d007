"""The cyclic order of arcs round each node: what a planar drawing is, apart from its shape.

A lattice vertex has four grid edges, so up to four arcs of a layer leave a node, each in its own
direction (0 right, 1 up, 2 left, 3 down). An arc of both layers leaves in one direction on both.
"""

import numpy as np
from jaxtyping import Int

from garmentimage.raster.encode.lattice._kernels_route import choose_directions
from garmentimage.raster.encode.lattice.drawing import Drawing
from garmentimage.raster.encode.layout import MAX_DEGREE

ONWARD = 0.05
"""Share of the direction farther on in the direction of a curve at its end."""


def departures(drawing: Drawing) -> Int[np.ndarray, "arc 2"]:
    """Direction in which each arc leaves its tail and its head; -1 where any will serve.

    The directions keep the cyclic order that the target curves have round the node, and differ
    least from those of the curves. Nodes with at most two arcs a layer need no such care.
    """
    nodes, arcs, curves = drawing.nodes, drawing.arcs, drawing.arcs.curves
    assert all(len(c) > 1 and np.isfinite(c).all() for c in curves)
    away = [c for curve in curves for c in (curve, curve[::-1])]
    near = np.array([c[1] - c[0] for c in away])
    onward = np.array([c[min(2, len(c) - 1)] - c[0] for c in away])
    near, onward = (v / (np.hypot(*v.T)[:, None] + 1e-12) for v in (near, onward))
    # A little of what follows breaks ties.
    x, y = (near + ONWARD * onward).T
    angles = np.arctan2(y, x).reshape(-1, 2)
    ends = np.stack([arcs.tail, arcs.head], axis=1)
    out = np.full(ends.shape, -1)
    # From a node on the axis, arcs on it go up or down and all others to the right.
    at_axis = nodes.on_axis[ends]
    up_or_down = np.where(np.sin(angles) > 0, 1, 3)
    out[at_axis] = np.where(arcs.on_axis[:, None], up_or_down, 0)[at_axis]
    # Two arcs have one cyclic order only, and for five there is no room.
    degree = drawing.degree.max(axis=0)
    for node in np.flatnonzero(~nodes.on_axis & (degree > 2) & (degree <= MAX_DEGREE)):
        arc, end = np.nonzero(ends == node)
        out[arc, end] = choose_directions(arcs.layers[arc], angles[arc, end], drawing.layer_count)
    return out
