"""Cells as a mesh: panels found by flood fill, quads with merged corners, boundary loops.

Encoder and decoder share this file, so both read a raster in the same way.

- A **cluster** is a set of cells connected through `NON_BOUNDARY` grid edges: one panel.
- Each cell brings four corners (bottom left, bottom right, top right, top left) and four sides
  (bottom, right, top, left); side s runs counter-clockwise from corner s to corner s + 1.
- Two cells share corners only through a `NON_BOUNDARY` grid edge. So the two legs of a slit keep
  corners of their own, and every corner lies on at most one stretch of boundary.
- A **half-edge** is a side of a cell on the boundary of its cluster, cloth on its left.

The lines x = N and y = N have no stored type: cells there have a free boundary.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, Integer
from numba import njit

from garmentimage.geometry import merge, root_of
from garmentimage.raster.image import EdgeType

CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""(dx, dy) of the corners bottom left, bottom right, top right, top left."""

NEIGHBOURS = ((-1, 0), (0, 1), (1, 0), (0, -1))
"""(row, column) step through the bottom, right, top and left side."""

OUTSIDE = -1
"""Label of cells that belong to no panel."""

_CORNERS = np.array(CORNERS)
_NON_BOUNDARY = int(EdgeType.NON_BOUNDARY)
_NON_STITCH = int(EdgeType.NON_STITCH)


@dataclass(frozen=True)
class CellMesh:
    """The quads of one cluster, or of a whole layer, with their corners merged."""

    cells: Int[np.ndarray, "cell 2"]
    """(row, column) of each cell, in raster order."""
    corner_ids: Int[np.ndarray, "cell 4"]
    """Vertex of the bottom left, bottom right, top right and top left corner."""
    vertex_count: int
    lattice: Float[np.ndarray, "vertex 2"]
    """Lattice point (x, y) of each vertex."""


@dataclass(frozen=True)
class HalfEdges:
    """The boundary of a `CellMesh`."""

    cell: Int[np.ndarray, " half"]
    """Row of `CellMesh.cells`."""
    side: Int[np.ndarray, " half"]
    """0 bottom, 1 right, 2 top, 3 left."""
    start: Int[np.ndarray, " half"]
    end: Int[np.ndarray, " half"]
    """Vertices, counter-clockwise round the cell."""
    edge_type: Int[np.ndarray, " half"]
    following: Int[np.ndarray, " half"]
    """The half-edge that starts where this one ends, along the same loop."""

    @property
    def loops(self) -> list[Int[np.ndarray, " n"]]:
        """Closed chains of half-edges, cloth on their left; each starts at its first half-edge."""
        seen = np.zeros(len(self.cell), bool)
        following = self.following.tolist()
        loops = []
        for first in range(len(seen)):
            if seen[first]:
                continue
            chain, k = [first], following[first]
            while k != first:
                chain.append(k)
                k = following[k]
            seen[chain] = True
            loops.append(np.array(chain))
        return loops


def label_panels(
    inside: Bool[np.ndarray, "layer row col"], edge_type: Integer[np.ndarray, "layer 2 row col"]
) -> tuple[Int[np.ndarray, "layer row col"], int]:
    """Flood fill every layer over `NON_BOUNDARY` grid edges.

    Returns:
        The panel number of each cell (`OUTSIDE` where there is none), numbered in raster order,
        front layer first; and the number of panels.
    """
    layers, grid, _ = inside.shape
    assert inside.shape == (layers, grid, grid) and edge_type.shape == (layers, 2, grid, grid)
    labels = np.empty(inside.shape, np.int64)
    count = _label(np.ascontiguousarray(inside), np.ascontiguousarray(edge_type, np.int8), labels)
    return labels, int(count)


def cell_mesh(
    mask: Bool[np.ndarray, "row col"], edge_type: Integer[np.ndarray, "2 row col"]
) -> CellMesh:
    """The quad mesh of the cells in `mask`, corners merged through `NON_BOUNDARY` grid edges.

    Args:
        mask: cells of one cluster (or of several: clusters share no vertex).
        edge_type: types of the bottom and left grid edges of that layer.
    """
    assert edge_type.shape == (2, len(mask), len(mask)) == (2, *mask.shape)
    cells, corner_ids, lattice = _mesh(
        np.ascontiguousarray(mask), np.ascontiguousarray(edge_type, np.int8), _CORNERS
    )
    return CellMesh(cells, corner_ids, len(lattice), lattice)


def half_edges(mesh: CellMesh, edge_type: Integer[np.ndarray, "2 row col"]) -> HalfEdges:
    """The boundary half-edges of a mesh, ordered by cell and side.

    A half-edge towards a cell outside the mesh whose stored type is `NON_BOUNDARY` keeps that
    type; along x = N and y = N the type is `NON_STITCH`.
    """
    assert not len(mesh.cells) or 0 <= mesh.cells.min() <= mesh.cells.max() < edge_type.shape[1]
    columns = _half_edges(
        mesh.cells, mesh.corner_ids, mesh.vertex_count, np.ascontiguousarray(edge_type, np.int8)
    )
    return HalfEdges(*columns)


@njit(cache=True)
def _label(inside, edge_type, labels):  # type: ignore[no-untyped-def]
    layers, grid, _ = inside.shape
    labels[:] = OUTSIDE
    stack = np.empty((grid * grid, 2), np.int64)
    count = 0
    for layer in range(layers):
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
                        near_r, near_c = r, c
                        if side == 0:
                            kind, near_r = edge_type[layer, 0, r, c], r - 1
                        elif side == 3:
                            kind, near_c = edge_type[layer, 1, r, c], c - 1
                        elif side == 1:
                            near_c = c + 1
                            kind = edge_type[layer, 1, r, near_c] if near_c < grid else _NON_STITCH
                        else:
                            near_r = r + 1
                            kind = edge_type[layer, 0, near_r, c] if near_r < grid else _NON_STITCH
                        if kind != _NON_BOUNDARY or near_r < 0 or near_c < 0:
                            continue
                        if inside[layer, near_r, near_c] and labels[layer, near_r, near_c] < 0:
                            labels[layer, near_r, near_c] = count
                            stack[height] = near_r, near_c
                            height += 1
                count += 1
    return count


@njit(cache=True)
def _mesh(mask, edge_type, corners):  # type: ignore[no-untyped-def]
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
        if left >= 0 and edge_type[1, row, col] == _NON_BOUNDARY:
            merge(parent, 4 * i, 4 * left + 1)
            merge(parent, 4 * i + 3, 4 * left + 2)
        below = index[row - 1, col] if row > 0 else -1
        if below >= 0 and edge_type[0, row, col] == _NON_BOUNDARY:
            merge(parent, 4 * i, 4 * below + 3)
            merge(parent, 4 * i + 1, 4 * below + 2)
    # A root is the smallest corner of its class, so vertices are numbered in raster order too.
    vertex = np.full(4 * count, -1, np.int64)
    corner_ids = np.empty((count, 4), np.int64)
    lattice = np.empty((4 * count, 2))
    vertex_count = 0
    for i in range(count):
        for c in range(4):
            corner = root_of(parent, 4 * i + c)
            if vertex[corner] < 0:
                vertex[corner] = vertex_count
                lattice[vertex_count, 0] = cells[i, 1] + corners[c, 0]
                lattice[vertex_count, 1] = cells[i, 0] + corners[c, 1]
                vertex_count += 1
            corner_ids[i, c] = vertex[corner]
    return cells, corner_ids, lattice[:vertex_count].copy()


@njit(cache=True)
def _half_edges(cells, corner_ids, vertex_count, edge_type):  # type: ignore[no-untyped-def]
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
            if s == 0:
                kind, near = edge_type[0, row, col], row > 0 and inside[row - 1, col]
            elif s == 3:
                kind, near = edge_type[1, row, col], col > 0 and inside[row, col - 1]
            elif s == 1:
                stored = col + 1 < grid
                kind = edge_type[1, row, col + 1] if stored else _NON_STITCH
                near = stored and inside[row, col + 1]
            else:
                stored = row + 1 < grid
                kind = edge_type[0, row + 1, col] if stored else _NON_STITCH
                near = stored and inside[row + 1, col]
            if near and kind == _NON_BOUNDARY:
                continue
            cell[count], side[count], kinds[count] = i, s, kind
            start[count], end[count] = corner_ids[i, s], corner_ids[i, (s + 1) % 4]
            leaving[start[count]] = count
            count += 1
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
