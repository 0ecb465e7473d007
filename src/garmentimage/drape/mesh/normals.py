"""Unit normals at the vertices of a triangle mesh."""

import numpy as np
from jaxtyping import Float, Int


def vertex_normals(
    points: Float[np.ndarray, "vertex 3"],
    faces: Int[np.ndarray, "face 3"],
    *,
    default: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Float[np.ndarray, "vertex 3"]:
    """Means of the normals of the faces round each vertex, weighted by area, as unit vectors.

    Faces run counter-clockwise seen from outside. `default` is the normal where the sum is zero: at
    a vertex without faces, or where those of a fold cancel out.
    """
    # The cross product of two sides is the normal times twice the area, so that a plain sum weighs.
    a, b, c = (points[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    total = sums_by(faces.ravel(), np.repeat(across, 3, axis=0), len(points))
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.where(length > 0, length, 1.0), default)


def sums_by(
    index: Int[np.ndarray, " item"], vectors: Float[np.ndarray, "item 3"], count: int
) -> Float[np.ndarray, "group 3"]:
    """Sums of the vectors that share an index, for `count` indices."""
    return np.stack([np.bincount(index, v, minlength=count) for v in vectors.T], axis=1)
