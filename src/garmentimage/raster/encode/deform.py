"""The deformation of cells: a quad mesh pulled onto the boundary of its panel (paper, Eq. 1)."""

import numpy as np
import scipy.linalg
from jaxtyping import Float, Int

from garmentimage.errors import EncodeError


def deform_quad_mesh(
    rest: Float[np.ndarray, "vertex 2"],
    edges: Int[np.ndarray, "edge 2"],
    pinned: Int[np.ndarray, " pin"],
    target: Float[np.ndarray, "pin 2"],
) -> Float[np.ndarray, "vertex 2"]:
    """Move a quad mesh onto a panel boundary while changing its edges least.

    Paper: Eq. 1, argmin over v of the sum over edges (i, j) of |(v_j - v_i) - (rest_j - rest_i)|²,
    subject to C v = c, the boundary vertices on the panel's boundary. The paper solves it with
    Lagrange multipliers; fixing the pinned vertices and solving for the free ones is the same. With
    L the Laplacian of the mesh, f free and p pinned vertices, that is one positive definite system
    for both axes, L_ff v_f = (L rest)_f - L_fp c.

    Args:
        rest: grid vertices before deformation [cm].
        edges: directed pairs (i, j) into `rest`, every two vertices once.
        pinned: boundary vertices, each once.
        target: where the pinned vertices must lie [cm].

    Returns:
        Vertices in the order of `rest` [cm]; pinned rows equal `target`.

    Raises:
        EncodeError: a part of the mesh has no pinned vertex.

    Example:
        >>> rest, ends = np.array([[0., 0], [1, 0], [2, 0]]), np.array([[0., 0], [4, 0]])
        >>> found = deform_quad_mesh(rest, np.array([[0, 1], [1, 2]]), np.array([0, 2]), ends)
        >>> found[1].round(6).tolist()
        [2.0, 0.0]
    """
    count = len(rest)
    out = np.array(rest, float)
    # The boundary is given; only what is inside is solved for.
    out[pinned] = target
    is_free = np.ones(count, bool)
    is_free[pinned] = False
    free = np.flatnonzero(is_free)
    if not len(free):
        return out
    # A mesh has some hundred vertices: a dense Cholesky factor is quicker than a sparse one.
    laplace = np.zeros((count, count))
    i, j = edges[:, 0], edges[:, 1]
    laplace[i, j] = laplace[j, i] = -1.0
    np.fill_diagonal(laplace, -laplace.sum(axis=1))
    right = laplace[free] @ rest - laplace[np.ix_(free, pinned)] @ target
    try:
        factor = scipy.linalg.cho_factor(laplace[np.ix_(free, free)], check_finite=False)
    except np.linalg.LinAlgError:
        raise EncodeError("a part of the quad mesh touches no boundary") from None
    out[free] = scipy.linalg.cho_solve(factor, right, check_finite=False)
    return out
