"""Edge and seam of each vertex of a cloth, and normals that are smooth across seams."""

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.mesh import vertex_normals

NONE = -1  # number of the edge or the seam of a corner that lies on none
UP = (0.0, 1.0, 0.0)  # normal where none is defined: readers of files expect unit vectors


def corner_edges(cloth: Cloth) -> Int[np.ndarray, " corner"]:
    """Number of the edge in its panel that each corner lies on, or `NONE`.

    A corner between two edges counts to the one that starts there.
    """
    edges = np.full(len(cloth.flat), NONE)
    for side, corners in cloth.sides.items():
        edges[corners[:-1]] = side.edge
    return edges


def corner_seams(cloth: Cloth) -> Int[np.ndarray, " corner"]:
    """Number of the first stitch of the pattern that joins each corner, or `NONE`."""
    seams = np.full(len(cloth.flat), NONE)
    for number, stitch in reversed(list(enumerate(cloth.pattern.stitches))):
        for side in stitch.sides:
            seams[cloth.sides[side]] = number
    return seams


def seam_vertices(cloth: Cloth) -> list[Int[np.ndarray, " _"]]:
    """For every stitch its vertices, from the start of its first side to the end."""
    return [cloth.vertex[cloth.sides[stitch.a]] for stitch in cloth.pattern.stitches]


def cloth_normals(
    cloth: Cloth, points: Float[np.ndarray, "vertex 3"]
) -> Float[np.ndarray, "vertex 3"]:
    """Unit normals of the outer face, smooth across seams; upwards where a fold cancels out."""
    return vertex_normals(points, cloth.vertex_faces, default=UP)
