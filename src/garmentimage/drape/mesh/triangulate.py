"""A polygon with holes as good triangles, its boundary kept as given.

The outline is triangulated by GEOS (constrained Delaunay). Points put inside split the triangle
they fall into; edges are then flipped until Delaunay, the boundary excepted: see `_kernels`.

Why no mesh generator is used: `triangle` may not be used commercially, `meshpy` wraps it, and
`gmsh` is under the GPL, none of which this package could pass on under its own licence. GEOS (LGPL,
used through shapely) triangulates without points inside.

Words of this file: a **ring** is a closed polygon without its first point repeated; a **side** is
the straight line from one of its points to the next; `across[t, k]` is the triangle across the
side of triangle t from its corner k to its corner k + 1, or -1 at the boundary.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.mesh._kernels import fill, inward_widths, place_inner_points
from garmentimage.geometry import signed_area


def triangulate(
    rings: Sequence[Float[np.ndarray, "_ 2"]], spacing: float
) -> tuple[Float[np.ndarray, "point 2"], Int[np.ndarray, "face 3"]] | None:
    """Triangles of about one size that fill a polygon with holes.

    Args:
        rings: outline, then holes; each simple, apart from each other, and of either sense.
        spacing: distance of neighbouring points inside, in the unit of `rings`.

    Returns:
        Points, those of the rings first and in order, and triangles, counter-clockwise; None where
        the rings cross themselves or each other.
    """
    # The sides of the boundary are sides of triangles by construction (GEOS); flips spare them.
    assert spacing > 0 and all(len(ring) > 2 for ring in rings)
    boundary = np.concatenate(rings)
    faces = _outline_triangles(rings, boundary)
    if faces is None or not len(faces):
        return None
    inside = place_inner_points(
        boundary, _side_ends(rings), _inward(rings), cloth_widths(rings), float(spacing)
    )
    points = np.concatenate([boundary, inside])
    return points, fill(points, faces, len(boundary))


def cloth_widths(rings: Sequence[Float[np.ndarray, "_ 2"]]) -> Float[np.ndarray, " side"]:
    """How wide the polygon is at the middle of each side, straight inwards."""
    widths: np.ndarray = inward_widths(np.concatenate(rings), _side_ends(rings), _inward(rings))
    return widths


def split_sides(
    points: Float[np.ndarray, "point 2"],
    faces: Int[np.ndarray, "face 3"],
    sides: Sequence[tuple[int, int]],
) -> tuple[Float[np.ndarray, "more 2"], Int[np.ndarray, "faces 3"]]:
    """The same triangles with the given sides cut in their middles; the new points come last."""
    every = [tuple(f) for f in faces.tolist()]
    for i, j in sides:
        middle = len(points)
        points = np.concatenate([points, (points[i] + points[j])[None] / 2])
        cut = []
        for face in every:
            turned = [face[k:] + face[:k] for k in range(3)]
            hit = next((t for t in turned if {t[0], t[1]} == {i, j}), None)
            if hit is None:
                cut.append(face)
            else:
                cut += [(hit[0], middle, hit[2]), (middle, hit[1], hit[2])]
        every = cut
    return points, np.array(every, dtype=np.int64).reshape(-1, 3)


def _inward(rings: Sequence[np.ndarray]) -> float:
    """1 where the cloth lies on the left of the sides, -1 where on the right."""
    return 1.0 if signed_area(rings[0]) > 0 else -1.0


def _side_ends(rings: Sequence[np.ndarray]) -> Int[np.ndarray, " side"]:
    """For each point of the rings, the one after it."""
    firsts = np.cumsum([0, *map(len, rings)])
    return np.concatenate([a + np.roll(np.arange(b - a), -1) for a, b in pairwise(firsts)])


def _outline_triangles(
    rings: Sequence[np.ndarray], boundary: np.ndarray
) -> Int[np.ndarray, "face 3"] | None:
    """The polygon as counter-clockwise triangles between its own points."""
    import shapely

    polygon = shapely.Polygon(rings[0], rings[1:])
    if not polygon.is_valid:
        return None
    corners = shapely.get_coordinates(shapely.constrained_delaunay_triangles(polygon))
    triangles = corners.reshape(-1, 4, 2)[:, :3]
    number = {p: k for k, p in enumerate(map(tuple, boundary.tolist()))}
    faces = np.array([number[p] for p in map(tuple, triangles.reshape(-1, 2).tolist())])
    faces = faces.reshape(-1, 3)
    (ax, ay), (bx, by), (cx, cy) = (boundary[faces[:, k]].T for k in range(3))
    clockwise = (bx - ax) * (cy - ay) < (by - ay) * (cx - ax)
    return np.where(clockwise[:, None], faces[:, ::-1], faces)
