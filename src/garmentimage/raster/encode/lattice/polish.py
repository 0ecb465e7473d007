"""Polishing: a coarse drawing is changed step by step until no step lowers its energy.

The energy (see `_kernels_polish`) sums squared distances from targets, the number of grid edges,
and what is missing of the grid edges that arcs desire. Every step keeps the faces of the drawing.
"""

import numpy as np

from garmentimage.raster.encode.lattice._kernels_polish import (
    MAX_LENGTH,
    Graph,
    State,
    minimise_energy,
)
from garmentimage.raster.encode.lattice.drawing import Drawing, Path
from garmentimage.raster.encode.lattice.route import new_search

ROOM = 8
"""Vertices of the longest path that is polished, per grid line."""


def polish(drawing: Drawing, paths: list[Path]) -> list[Path]:
    """Move paths and nodes of a valid coarse drawing until their energy is lowest nearby.

    Args:
        drawing: the graph and its targets.
        paths: vertex-disjoint lattice paths of unit steps, at least one, on grid lines 1 to N - 1.
    """
    nodes, arcs, width = drawing.nodes, drawing.arcs, drawing.grid + 1
    lens, flat = np.array([len(path) for path in paths]), np.concatenate(paths)
    assert len(paths) == len(arcs) and lens.min() > 1
    assert flat.min() >= 1 and flat.max() < drawing.grid
    # A path that winds so far cannot be drawn in the table below: it stays as it is.
    if lens.max() > ROOM * width:
        return paths
    # Paths as numbers of vertices, in rows of one table that leaves room to grow.
    table, column = np.zeros((len(paths), ROOM * width), np.int64), np.arange(ROOM * width)
    table[column < lens[:, None]] = flat[:, 1] * width + flat[:, 0]
    # Compiled code takes arrays: what belongs together one after the other, and where each starts.
    ends = np.stack([arcs.tail, arcs.head], axis=1).ravel()
    by_node = np.argsort(ends, kind="stable")
    graph = Graph(
        tail=arcs.tail,
        head=arcs.head,
        layers=arcs.layers,
        on_axis=arcs.on_axis,
        min_edges=arcs.min_edges,
        desired_edges=arcs.desired_edges,
        weight=arcs.weight,
        ends=by_node,
        arcs=by_node // 2,
        first=np.searchsorted(ends[by_node], np.arange(len(nodes) + 1)),
        node_target=nodes.target,
        node_layers=nodes.layers,
        node_on_axis=nodes.on_axis,
        node_weight=drawing.node_weight,
        targets=np.concatenate(arcs.curves),
        starts=np.cumsum([0, *map(len, arcs.curves)]),
        width=width,
        axis=-1 if drawing.axis is None else drawing.axis,
    )
    # A node lies where its arcs end.
    where = np.full(len(nodes), -1)
    where[arcs.tail], where[arcs.head] = table[:, 0], table[np.arange(len(lens)), lens - 1]
    state = State(
        table=table,
        lens=lens,
        where=where,
        busy=np.zeros((drawing.layer_count, width * width), bool),
        energy=np.empty(len(lens)),
        rotation=np.empty((len(nodes), drawing.layer_count, 4), np.int64),
        search=new_search(width * width * MAX_LENGTH),
        found=np.empty(ROOM * width, np.int64),
    )
    minimise_energy(graph, state)
    vertices = table[column < lens[:, None]]
    points = np.stack([vertices % width, vertices // width], axis=1)
    return np.split(points, np.cumsum(lens)[:-1])
