"""How cloth resists bending: a linear force, as long as the cloth hardly stretches.

Flat cloth has no bending energy, whatever its mesh. Sewn edges bend like others: a seam wants to
lie flat.
"""

from typing import Any

import numpy as np
from jaxtyping import Float, Int


# Bergou et al. 2006, "A quadratic bending model for inextensible surfaces": each hinge, a pair of
# triangles that share an edge, has the energy E = 3 / (2 A) |K x|^2. A is the area of both, and
# K holds sums of cotangents that add up to zero. We take a third of that, so Q = sum of K^T K / A:
# equilateral triangles rolled up in any direction then have the energy of a plate, half the bending
# stiffness times the squared curvature. The paper's sum of squares counts a bend once for each
# direction of the mesh.
def bending_matrix(
    faces: Int[np.ndarray, "face 3"],
    flat: Float[np.ndarray, "face 3 2"],
    vertex_count: int,
    folds: Int[np.ndarray, "fold 2"] | None = None,
) -> Any:
    """The matrix Q of the bending energy x Q x / 2, for a bending stiffness of 1.

    A symmetric scipy CSR array, vertex by vertex [1/cm2].

    Args:
        faces: vertices of each triangle.
        flat: the rest places of each triangle's corners in its own panel [cm].
        vertex_count: number of vertices.
        folds: ends of sides at which cloth is pressed to a fold, and does not resist bending.
    """
    from scipy.sparse import coo_array

    hinge, cotangent, area = _hinges(faces, flat)
    if folds is not None and len(folds):
        keys = np.sort(folds, axis=1) @ [vertex_count, 1]
        bends = ~np.isin(np.sort(hinge[:, :2], axis=1) @ [vertex_count, 1], keys)
        hinge, cotangent, area = hinge[bends], cotangent[bends], area[bends]
    # Corners of a hinge: its edge's two ends, then the two vertices across it.
    start0, end0, start1, end1 = cotangent.T
    reach = np.stack([end0 + end1, start0 + start1, -start0 - end0, -start1 - end1], axis=1)
    block = (1.0 / area)[:, None, None] * reach[:, :, None] * reach[:, None, :]
    rows = np.repeat(hinge, 4, axis=1).ravel()
    columns = np.tile(hinge, (1, 4)).ravel()
    matrix = coo_array((block.ravel(), (rows, columns)), shape=(vertex_count, vertex_count)).tocsr()
    matrix.sum_duplicates()
    return matrix


def _hinges(
    faces: Int[np.ndarray, "face 3"], flat: Float[np.ndarray, "face 3 2"]
) -> tuple[Int[np.ndarray, "hinge 4"], Float[np.ndarray, "hinge 4"], Float[np.ndarray, " hinge"]]:
    """Pairs of triangles that share an edge of exactly two triangles.

    Their four vertices (ends of the edge, those across it); the cotangents of the angles at the
    edge's two ends in the first triangle and in the second; the area of both [cm2].
    """
    cotangents, areas = _cotangents(flat)
    start, end = faces, np.roll(faces, -1, axis=1)
    # Sides of one edge have the same key; two in a run are the two triangles of a hinge.
    key = (np.minimum(start, end).astype(np.int64) << 32) | np.maximum(start, end)
    order = np.argsort(key.ravel(), kind="stable")
    keys = key.ravel()[order]
    first_of_run = np.flatnonzero(np.r_[True, keys[1:] != keys[:-1]])
    pairs = first_of_run[np.diff(np.r_[first_of_run, len(keys)]) == 2]
    sides = [order[pairs], order[pairs + 1]]

    across = [np.roll(faces, 1, axis=1).ravel()[s] for s in sides]
    a, b = start.ravel()[sides[0]], end.ravel()[sides[0]]
    at_start = [cotangents.ravel()[s] for s in sides]
    at_end = [np.roll(cotangents, -1, axis=1).ravel()[s] for s in sides]
    turned = start.ravel()[sides[1]] != a
    second = np.where(turned, at_end[1], at_start[1]), np.where(turned, at_start[1], at_end[1])
    hinge = np.stack([a, b, *across], axis=1)
    area = sum(areas[s // 3] for s in sides)
    # Two triangles on the same three vertices are not a hinge.
    keep = across[0] != across[1]
    return hinge[keep], np.stack([at_start[0], at_end[0], *second], axis=1)[keep], area[keep]


def _cotangents(
    flat: Float[np.ndarray, "face 3 2"],
) -> tuple[Float[np.ndarray, "face 3"], Float[np.ndarray, " face"]]:
    """Cotangent of the angle at each corner, and each triangle's area [cm2]."""
    ahead = np.roll(flat, -1, axis=1) - flat
    behind = np.roll(flat, 1, axis=1) - flat
    doubled = np.abs(ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0])
    doubled = np.maximum(doubled, 1e-9)
    return (ahead * behind).sum(axis=2) / doubled, doubled[:, 0] / 2
