"""The cyclic order of arcs round each node: what a planar drawing is, apart from its shape.

A lattice vertex has four grid edges, so up to four arcs of a layer leave a node, each in its own
direction (0 right, 1 up, 2 left, 3 down). An arc of both layers leaves in one direction on both.
"""

import numpy as np
from jaxtyping import Float, Int

from garmentimage.raster.encode.lattice._kernels_route import choose_departures
from garmentimage.raster.encode.lattice.drawing import Drawing

ONWARD = 0.05
"""Share of the direction farther on in the direction of a curve at its end."""


def departures(drawing: Drawing) -> Int[np.ndarray, "arc 2"]:
    """Direction in which each arc leaves its tail and its head; -1 where any will serve.

    The directions keep the cyclic order that the target curves have round the node, and differ
    least from those of the curves. Nodes with at most two arcs a layer need no such care.
    """
    nodes, arcs, curves = drawing.nodes, drawing.arcs, drawing.arcs.curves
    assert all(len(c) > 1 and np.isfinite(c).all() for c in curves)
    first = np.array([c[1] - c[0] for c in curves])
    last = np.array([c[-2] - c[-1] for c in curves])
    second = np.array([c[min(2, len(c) - 1)] - c[0] for c in curves])
    second_last = np.array([c[max(len(c) - 3, 0)] - c[-1] for c in curves])
    angles = np.stack([_angle(first, second), _angle(last, second_last)], axis=1)
    return np.asarray(
        choose_departures(
            arcs.tail,
            arcs.head,
            arcs.layers,
            arcs.on_axis,
            nodes.on_axis,
            angles,
            len(nodes),
            drawing.axis is not None,
        )
    )


def _angle(
    near: Float[np.ndarray, "arc 2"], far: Float[np.ndarray, "arc 2"]
) -> Float[np.ndarray, " arc"]:
    """Direction of the curve at its end; a little of what follows breaks ties."""
    vector = near / (np.hypot(*near.T)[:, None] + 1e-12)
    onward = far / (np.hypot(*far.T)[:, None] + 1e-12)
    vector = vector + ONWARD * onward
    return np.asarray(np.arctan2(vector[:, 1], vector[:, 0]))
