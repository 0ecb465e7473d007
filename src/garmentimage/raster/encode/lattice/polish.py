"""Polishing: a coarse drawing is changed step by step until no step lowers its energy.

The energy (see `_kernels_polish`) sums squared distances from targets, the number of grid edges,
and what is missing of the grid edges that arcs desire. Two moves, both keeping the faces of the
drawing: an arc is taken out and drawn again by the cheapest free path; a node steps to a
neighbouring lattice point and its arcs are drawn again. A move counts only if paths share no vertex
and the cyclic order of arcs round every node touched is the same as before, which for connected
drawings means the same faces.
"""

import numpy as np

from garmentimage.raster.encode.lattice._kernels_polish import Graph, Lattice, minimise_energy
from garmentimage.raster.encode.lattice.drawing import Drawing, Path

ROOM = 8
"""Vertices of the longest path that is polished, per grid line."""


def polish(drawing: Drawing, paths: list[Path], low: int, high: int) -> list[Path]:
    """Move paths and nodes of a valid coarse drawing until their energy is lowest nearby.

    Args:
        drawing: the graph and its targets.
        paths: vertex-disjoint lattice paths of unit steps, at least one, between `low` and `high`.
        low: smallest lattice coordinate allowed, both axes; at least 1.
        high: largest lattice coordinate allowed, both axes; at most N - 1.
    """
    nodes, arcs, width = drawing.nodes, drawing.arcs, drawing.grid + 1
    assert 1 <= low <= high < drawing.grid and len(paths) == len(arcs)
    for path in paths:
        assert len(path) > 1 and low <= path.min() and path.max() <= high, "a path leaves the grid"
    lens = np.array([len(p) for p in paths])
    if lens.max() > ROOM * width:
        return paths
    # Paths as numbers of vertices, in rows of one table that leaves room to grow.
    table = np.zeros((len(paths), ROOM * width), np.int64)
    for i, path in enumerate(paths):
        table[i, : len(path)] = path[:, 1] * width + path[:, 0]
    # Compiled code takes arrays: curves one after the other, and where each starts.
    graph = Graph(
        tail=arcs.tail,
        head=arcs.head,
        layers=arcs.layers,
        on_axis=arcs.on_axis,
        min_edges=arcs.min_edges,
        desired_edges=arcs.desired_edges,
        weight=arcs.weight,
        node_target=nodes.target,
        node_layers=nodes.layers,
        node_on_axis=nodes.on_axis,
        node_weight=drawing.node_weight,
        targets=np.concatenate(arcs.curves),
        starts=np.concatenate([[0], np.cumsum([len(c) for c in arcs.curves])]),
    )
    axis = -1 if drawing.axis is None else drawing.axis
    minimise_energy(graph, Lattice(width, low, high, axis), table, lens)
    return [
        np.stack([table[i, :n] % width, table[i, :n] // width], axis=1) for i, n in enumerate(lens)
    ]
