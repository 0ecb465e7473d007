"""Flood fill, merged corners and boundary half-edges of cells, in compiled code."""

import numpy as np
from numba import njit

from garmentimage.geometry import find_root, union
from garmentimage.raster.image import EdgeType

OUTSIDE = -1  # label of cells that belong to no panel

_NON_BOUNDARY = int(EdgeType.NON_BOUNDARY)
_NON_STITCH = int(EdgeType.NON_STITCH)
_CREASE = int(EdgeType.CREASE)


@njit(cache=True)
def goes_on(kind):
    """Whether the cloth goes on across a grid edge between two inside cells."""
    return kind in (_NON_BOUNDARY, _CREASE)


@njit(cache=True)
def across_side(edge_type, row, col, side):
    """Type of the grid edge on one side of a cell of a layer, and row and column beyond it."""
    grid = edge_type.shape[1]
    # A cell stores its bottom and its left edge; the others are stored by the cells beyond them.
    if side == 0:
        return edge_type[0, row, col], row - 1, col
    if side == 3:
        return edge_type[1, row, col], row, col - 1
    if side == 1:
        return edge_type[1, row, col + 1] if col + 1 < grid else _NON_STITCH, row, col + 1
    return edge_type[0, row + 1, col] if row + 1 < grid else _NON_STITCH, row + 1, col


# Connected components of the cells, joined where the cloth goes on across a grid edge.
# Depth-first, with a stack of our own: each cell is pushed once, so it never overflows.
@njit(cache=True)
def flood_fill(inside, edge_type, labels):
    layers, grid, _ = inside.shape
    labels[:] = OUTSIDE
    stack = np.empty((grid * grid, 2), np.int64)
    count = 0
    for layer in range(layers):
        types = edge_type[layer]
        for row in range(grid):
            for col in range(grid):
                if not inside[layer, row, col] or labels[layer, row, col] != OUTSIDE:
                    continue
                labels[layer, row, col] = count
                stack[0] = row, col
                height = 1
                while height:
                    height -= 1
                    r, c = stack[height]
                    for side in range(4):
                        kind, near_r, near_c = across_side(types, r, c, side)
                        if not goes_on(kind) or near_r < 0 or near_c < 0:
                            continue
                        if inside[layer, near_r, near_c] and labels[layer, near_r, near_c] < 0:
                            labels[layer, near_r, near_c] = count
                            stack[height] = near_r, near_c
                            height += 1
                count += 1
    return count


# Vertices of the quad mesh are the classes of cells' corners that are the same point of the cloth:
# union-find over the four corners of every cell, where a shared grid edge merges two pairs of them.
@njit(cache=True)
def merge_corners(mask, edge_type, corners):
    grid = mask.shape[0]
    index = np.full((grid, grid), -1, np.int64)
    cells = np.empty((mask.sum(), 2), np.int64)
    count = 0
    for row in range(grid):
        for col in range(grid):
            if mask[row, col]:
                index[row, col] = count
                cells[count] = row, col
                count += 1
    parent = np.arange(4 * count)
    for i in range(count):
        row, col = cells[i]
        left = index[row, col - 1] if col > 0 else -1
        if left >= 0 and goes_on(edge_type[1, row, col]):
            union(parent, 4 * i, 4 * left + 1)
            union(parent, 4 * i + 3, 4 * left + 2)
        below = index[row - 1, col] if row > 0 else -1
        if below >= 0 and goes_on(edge_type[0, row, col]):
            union(parent, 4 * i, 4 * below + 3)
            union(parent, 4 * i + 1, 4 * below + 2)
    # A root is the smallest corner of its class, so vertices are numbered in raster order too.
    vertex = np.full(4 * count, -1, np.int64)
    corner_ids = np.empty((count, 4), np.int64)
    lattice = np.empty((4 * count, 2))
    vertex_count = 0
    for i in range(count):
        for c in range(4):
            corner = find_root(parent, 4 * i + c)
            if vertex[corner] < 0:
                vertex[corner] = vertex_count
                lattice[vertex_count, 0] = cells[i, 1] + corners[c, 0]
                lattice[vertex_count, 1] = cells[i, 0] + corners[c, 1]
                vertex_count += 1
            corner_ids[i, c] = vertex[corner]
    return cells, corner_ids, lattice[:vertex_count].copy()


# The boundary of a mesh: all sides of cells across which the cloth does not continue.
@njit(cache=True)
def find_half_edges(cells, corner_ids, vertex_count, edge_type):
    grid = edge_type.shape[1]
    inside = np.zeros((grid, grid), np.bool_)
    for i in range(len(cells)):
        inside[cells[i, 0], cells[i, 1]] = True
    size = 4 * len(cells)
    cell, side = np.empty(size, np.int64), np.empty(size, np.int64)
    start, end = np.empty(size, np.int64), np.empty(size, np.int64)
    kinds = np.empty(size, np.int64)
    leaving = np.full(vertex_count, -1, np.int64)
    count = 0
    for i in range(len(cells)):
        row, col = cells[i]
        for s in range(4):
            kind, near_r, near_c = across_side(edge_type, row, col, s)
            near = 0 <= near_r < grid and 0 <= near_c < grid and inside[near_r, near_c]
            if near and goes_on(kind):
                continue
            cell[count], side[count], kinds[count] = i, s, kind
            start[count], end[count] = corner_ids[i, s], corner_ids[i, (s + 1) % 4]
            leaving[start[count]] = count
            count += 1
    # Corners lie on one stretch of boundary at most, so one half-edge leaves each vertex.
    following = np.empty(count, np.int64)
    for k in range(count):
        following[k] = leaving[end[k]]
    return (
        cell[:count].copy(),
        side[:count].copy(),
        start[:count].copy(),
        end[:count].copy(),
        kinds[:count].copy(),
        following,
    )
