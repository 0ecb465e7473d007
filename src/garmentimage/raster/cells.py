"""Cells as a mesh: panels found by flood fill, quads with merged corners, boundary loops.

Encoder and decoder share this file, so both read a raster in the same way.

- The cloth **goes on** across grid edges of type `NON_BOUNDARY` and `CREASE` between two cells.
- A **cluster** is a set of cells across whose grid edges it goes on: one panel.
- Each cell brings four corners (bottom left, bottom right, top right, top left) and four sides
  (bottom, right, top, left); side s runs counter-clockwise from corner s to corner s + 1.
- Two cells share corners only through a grid edge across which cloth goes on. So the two legs of
  a slit keep corners of their own, and every corner lies on at most one stretch of boundary.
- A **half-edge** is a side of a cell on the boundary of its cluster, cloth on its left.

The lines x = N and y = N have no stored type: cells there have a free boundary.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, Integer

from garmentimage.raster._kernels import find_half_edges, flood_fill, merge_corners

CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""(dx, dy) of the corners bottom left, bottom right, top right, top left."""

NEIGHBOURS = ((-1, 0), (0, 1), (1, 0), (0, -1))
"""(row, column) step through the bottom, right, top and left side."""


@dataclass(frozen=True)
class CellMesh:
    """The quads of one cluster, or of a whole layer, with their corners merged."""

    cells: Int[np.ndarray, "cell 2"]  # (row, column) of each cell, in raster order
    corner_ids: Int[np.ndarray, "cell 4"]
    """Vertex of the bottom left, bottom right, top right and top left corner."""
    vertex_count: int
    lattice: Float[np.ndarray, "vertex 2"]  # lattice point (x, y) of each vertex


@dataclass(frozen=True)
class HalfEdges:
    """The boundary of a `CellMesh`."""

    cell: Int[np.ndarray, " half"]  # row of `CellMesh.cells`
    side: Int[np.ndarray, " half"]  # 0 bottom, 1 right, 2 top, 3 left
    start: Int[np.ndarray, " half"]
    end: Int[np.ndarray, " half"]
    """Vertices, counter-clockwise round the cell."""
    edge_type: Int[np.ndarray, " half"]
    following: Int[np.ndarray, " half"]
    """The half-edge that starts where this one ends, along the same loop."""


def label_panels(
    inside: Bool[np.ndarray, "layer row col"], edge_type: Integer[np.ndarray, "layer 2 row col"]
) -> tuple[Int[np.ndarray, "layer row col"], int]:
    """Flood fill every layer over the grid edges across which cloth goes on.

    Returns:
        The panel number of each cell (`OUTSIDE` where there is none), numbered in raster order,
        front layer first; and the number of panels.
    """
    layers, grid, _ = inside.shape
    assert inside.shape == (layers, grid, grid) and edge_type.shape == (layers, 2, grid, grid)
    labels = np.empty(inside.shape, np.int64)
    count = flood_fill(
        np.ascontiguousarray(inside), np.ascontiguousarray(edge_type, np.int8), labels
    )
    return labels, int(count)


def cell_mesh(
    mask: Bool[np.ndarray, "row col"], edge_type: Integer[np.ndarray, "2 row col"]
) -> CellMesh:
    """The quad mesh of the cells in `mask`, corners merged where cloth goes on.

    The cells may be those of one cluster or of several: clusters share no vertex.
    """
    assert edge_type.shape == (2, len(mask), len(mask)) == (2, *mask.shape)
    cells, corner_ids, lattice = merge_corners(
        np.ascontiguousarray(mask), np.ascontiguousarray(edge_type, np.int8), np.array(CORNERS)
    )
    return CellMesh(cells, corner_ids, len(lattice), lattice)


def half_edges(mesh: CellMesh, edge_type: Integer[np.ndarray, "2 row col"]) -> HalfEdges:
    """The boundary half-edges of a mesh, ordered by cell and side.

    A half-edge towards a cell outside the mesh whose stored type is `NON_BOUNDARY` keeps that
    type; along x = N and y = N the type is `NON_STITCH`.
    """
    assert not len(mesh.cells) or 0 <= mesh.cells.min() <= mesh.cells.max() < edge_type.shape[1]
    columns = find_half_edges(
        mesh.cells, mesh.corner_ids, mesh.vertex_count, np.ascontiguousarray(edge_type, np.int8)
    )
    return HalfEdges(*columns)
