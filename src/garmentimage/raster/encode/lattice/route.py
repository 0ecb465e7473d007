"""Fine drawing: every arc as a lattice path, vertex-disjoint inside each layer.

The lattice is `fine` times finer than the image's. Paths are shortest paths in a corridor round
their target; where paths meet, the vertices become dearer round by round until every path has
found its own (negotiated congestion, as circuits are routed).
"""

from dataclasses import dataclass

import numpy as np

from garmentimage.errors import EncodeError
from garmentimage.raster.encode.lattice._kernels_route import (
    ROUNDS,
    nearest_points,
    route_all,
    snap_nodes,
)
from garmentimage.raster.encode.lattice.drawing import Drawing, Path
from garmentimage.raster.encode.lattice.rotation import departures

MARGIN = 12
"""Free fine vertices round the drawing."""
MOST_VERTICES = 1_000_000
"""A drawing that spreads over more fine vertices than this is refused."""
MOST_FIELDS = 100_000_000
"""... or one with more vertices in the corridors of all its arcs, 4 bytes each."""
FARTHEST = 1e9
"""Targets lie nearer than this to the grid's corner [fine steps]."""


@dataclass(frozen=True)
class FinePaths:
    """Lattice paths on the fine lattice, and where their vertices would like to be."""

    paths: list[Path]
    """Per arc [n, 2], from tail to head, in fine lattice coordinates."""
    wanted: list[np.ndarray]
    """Per arc [n, 2]: target of each vertex, in (coarse) lattice coordinates."""


def route(drawing: Drawing, fine: int, radius: float, in_order: bool = True) -> FinePaths:
    """Draw every arc on the lattice that is `fine` times finer than the image.

    Args:
        drawing: what to draw.
        fine: fine steps per cell.
        radius: how far a path may leave its target [fine steps].
        in_order: arcs leave a node in the cyclic order of their targets; else as they find room.

    Raises:
        EncodeError: arcs cannot be kept apart; a finer lattice or another layout may help.
    """
    targets = np.concatenate(drawing.curves) * fine
    if not (np.isfinite(targets).all() and np.abs(targets).max() < FARTHEST):
        raise EncodeError("the garment has no place on the grid; check the placement of its panels")
    assert min(map(len, drawing.curves)) > 1
    low = np.floor(targets.min(axis=0)).astype(np.int64) - MARGIN
    high = np.ceil(targets.max(axis=0)).astype(np.int64) + MARGIN
    axis = -1
    if drawing.axis is not None:
        axis = drawing.axis * fine - low[0]
    width, height = (high - low + 1).tolist()
    if width * height > MOST_VERTICES or width * height * drawing.arc_count > MOST_FIELDS:
        raise EncodeError(
            f"the garment spreads over {width // fine} x {height // fine} cells; "
            "check the units and the placement of its panels",
            remedy="pattern",
        )
    starts = np.concatenate([[0], np.cumsum([len(c) for c in drawing.curves])])
    wished = drawing.node_target * fine - low
    # Axis nodes have the least freedom, then nodes of both layers; place breaks ties.
    first = np.lexsort(
        (
            wished[:, 0].round(),
            wished[:, 1].round(),
            drawing.node_layers != 3,
            ~drawing.node_on_axis,
        )
    )
    node_xy = snap_nodes(wished, drawing.node_layers, drawing.node_on_axis, axis, first)
    # Short arcs first: they have the least room. Rounding keeps the order under small changes.
    lengths = np.array([np.hypot(*np.diff(c * fine, axis=0).T).sum() for c in drawing.curves])
    middles = np.array([c[len(c) // 2] for c in drawing.curves]).round(1)
    order = np.lexsort((middles[:, 0], middles[:, 1], np.round(np.log2(np.maximum(lengths, 0.5)))))
    done, flat, lens = route_all(
        order,
        drawing.tail,
        drawing.head,
        drawing.layers,
        drawing.on_axis,
        departures(drawing) if in_order else np.full((drawing.arc_count, 2), -1),
        node_xy,
        drawing.node_layers,
        targets - low,
        starts,
        float(radius),
        width,
        height,
        axis,
        ROUNDS,
    )
    if done != 1:
        raise EncodeError("its seams cross or crowd each other on the grid")
    ends = np.cumsum(lens)
    paths = [flat[e - n : e] for e, n in zip(ends, lens)]
    wanted = []
    for i, path in enumerate(paths):
        near = nearest_points(path.astype(np.float64), targets[starts[i] : starts[i + 1]] - low)
        near[0] = drawing.node_target[drawing.tail[i]] * fine - low
        near[-1] = drawing.node_target[drawing.head[i]] * fine - low
        wanted.append((near + low) / fine)
    return FinePaths([p + low for p in paths], wanted)
