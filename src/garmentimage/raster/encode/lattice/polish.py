"""Polishing: the coarse drawing settles where its energy is least, whatever way it came there.

Two moves, both keeping the drawing what it is: an arc is taken out and drawn again by the
cheapest free path; a node steps to a neighbouring lattice point and its arcs are drawn again.
A move counts only if paths stay vertex-disjoint and the cyclic order of arcs round every node
touched stays the same, which for connected drawings means the same faces.
"""

import numpy as np

from garmentimage.raster.encode.lattice._kernels_polish import settle
from garmentimage.raster.encode.lattice.drawing import Drawing, Path


def polish(drawing: Drawing, paths: list[Path], low: int, high: int) -> list[Path]:
    """Move paths and nodes of a valid coarse drawing to where its energy is least.

    Args:
        drawing: the graph and its wishes.
        paths: vertex-disjoint lattice paths of unit steps, at least one, between `low` and `high`.
        low: smallest lattice coordinate allowed, both axes; at least 1.
        high: largest lattice coordinate allowed, both axes; at most N - 1.
    """
    assert 1 <= low <= high < drawing.grid and len(paths) == drawing.arc_count
    for path in paths:
        assert len(path) > 1 and low <= path.min() and path.max() <= high, "a path leaves the grid"
    room = 8 * (drawing.grid + 1)
    table = np.zeros((len(paths), room), np.int64)
    lens = np.array([len(p) for p in paths])
    if lens.max() > room:
        return paths
    width = drawing.grid + 1
    for i, path in enumerate(paths):
        table[i, : len(path)] = path[:, 1] * width + path[:, 0]
    targets = np.concatenate(drawing.curves)
    starts = np.concatenate([[0], np.cumsum([len(c) for c in drawing.curves])])
    axis = -1 if drawing.axis is None else drawing.axis
    settle(
        table, lens, drawing.tail, drawing.head, drawing.layers, drawing.on_axis,
        drawing.node_target, drawing.node_layers, drawing.node_on_axis, targets, starts,
        drawing.least, drawing.wish, drawing.weight, drawing.node_weight, width, low, high, axis,
    )  # fmt: skip
    return [
        np.stack([table[i, :n] % width, table[i, :n] // width], axis=1) for i, n in enumerate(lens)
    ]
