"""How far every place is from a body: the obstacle that cloth comes to rest on.

Near the skin the distance is exact; farther off it is too great by up to an eighth.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil

import numpy as np
from jaxtyping import Float, Float32, Int

from garmentimage.body import Body
from garmentimage.drape.mesh import sums_by
from garmentimage.drape.solver._kernels_field import count_crossings, sample_all, stamp, sweep

CELL = 1.0  # side of a grid cell [cm]
PAD = 5.0
"""The grid goes this far beyond the body [cm]; nothing farther off can touch it."""
BAND = 2.0  # distances are exact up to this far from a body's skin [cm]
BESIDE = np.array([1.2e-5, 2.3e-5, 0.0])  # how far beside a node its line of crossings runs [cell]
CLOTH_BAND = 2.2  # what lies up to this far behind settled cloth counts as inside [cm]


@dataclass(frozen=True, eq=False)
class DistanceField:
    """Signed distance to a surface at the nodes of a grid, negative inside."""

    values: Float32[np.ndarray, "x y z"]  # [cm]
    origin: Float[np.ndarray, " 3"]  # place of the first node [cm]
    cell: float  # distance between nodes [cm]

    def at(self, points: Float[np.ndarray, "point 3"]) -> Float[np.ndarray, " point"]:
        """Signed distances, interpolated between nodes; beyond the grid as at its rim [cm]."""
        return self.at_with_slope(points)[0]

    def at_with_slope(
        self, points: Float[np.ndarray, "point 3"]
    ) -> tuple[Float[np.ndarray, " point"], Float[np.ndarray, "point 3"]]:
        """Signed distances [cm] and the directions in which they grow (about unit vectors)."""
        distance, slope = np.empty(len(points)), np.empty((len(points), 3))
        sample_all(self.values, self.origin, 1.0 / self.cell, points, distance, slope)
        return distance, slope

    def with_cloth(
        self,
        points: Float[np.ndarray, "vertex 3"],
        faces: Int[np.ndarray, "face 3"],
        *,
        thickness: float,
    ) -> "DistanceField":
        """The same obstacle wearing settled cloth, for a layer that goes over it.

        What lies up to `CLOTH_BAND` behind the cloth counts as inside, so that an outer layer is
        pushed out and not kept in the gap. Rims of the cloth have no inside. Faces run
        counter-clockwise seen from outside; the obstacle lies `thickness` [cm] outside `points`.
        """
        cloth = _near(self.values.shape, self.origin, self.cell, points, faces, CLOTH_BAND)
        values = np.minimum(self.values, cloth - np.float32(thickness))
        values.setflags(write=False)
        return replace(self, values=values)


@lru_cache(maxsize=4)
def body_field(body: Body) -> DistanceField:
    """The field round a body; made once and kept (some 6 MB), its values are read-only."""
    return surface_distance(body.vertices, body.faces)


def cloth_field(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> DistanceField:
    """Signed distance to cloth, exact up to `CLOTH_BAND` from it; farther off all is outside.

    Negative behind it: faces run counter-clockwise seen from outside. Rims have no inside.
    """
    low, high = points[faces].min(axis=(0, 1)), points[faces].max(axis=(0, 1))
    origin = low - PAD
    shape = tuple(ceil(s / CELL) + 1 for s in high + PAD - origin)
    values = _near(shape, origin, CELL, points, faces, CLOTH_BAND)
    values[np.isinf(values)] = CLOTH_BAND
    return DistanceField(values, origin, CELL)


def empty_field() -> DistanceField:
    """A field without any obstacle."""
    return DistanceField(np.full((2, 2, 2), 1e6, np.float32), np.zeros(3), CELL)


# Near the skin the distance is exact. Farther off it is carried on from node to node along the grid
# and its diagonals (a chamfer distance, Borgefors 1986). Inside of a body is where its surface goes
# round by the winding number, so that lips that touch and folds do no harm.
def surface_distance(
    points: Float[np.ndarray, "vertex 3"],
    faces: Int[np.ndarray, "face 3"],
    *,
    cell: float = CELL,
) -> DistanceField:
    """The signed distance to a closed surface, which may touch itself and pass through itself.

    Faces run counter-clockwise seen from outside; nodes lie `cell` [cm] apart.
    """
    # Nodes lie at odd halves of a cell, so that a mirrored surface has the mirrored field.
    origin = (np.floor((points.min(axis=0) - PAD) / cell - 0.5) + 0.5) * cell
    size = points.max(axis=0) + PAD - origin
    shape = tuple(ceil(s / cell) + 1 for s in size)
    values = _near(shape, origin, cell, points, faces, BAND)
    far, back = np.isinf(values), np.s_[::-1, ::-1, ::-1]
    sweep(values, far, cell)
    sweep(values[back], far[back], cell)
    # How often the surface goes round each node: along a line of nodes the number changes where
    # the surface is crossed. Lines lie a hair beside the nodes, off its edges and corners.
    turns = np.zeros(shape, np.int32)
    scaled = np.ascontiguousarray((points - origin) / cell)
    count_crossings(turns, scaled - BESIDE, faces.astype(np.int64))
    inside = np.cumsum(turns, axis=2, dtype=np.int32) > 0
    values = np.where(inside, -np.abs(values), np.abs(values))
    values.setflags(write=False)
    return DistanceField(values, origin, cell)


# Cloth has no inside: the sign of its distance is that of angle-weighted pseudonormals (Baerentzen
# and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal").
def _near(
    shape: tuple[int, ...],
    origin: Float[np.ndarray, " 3"],
    cell: float,
    points: Float[np.ndarray, "vertex 3"],
    faces: Int[np.ndarray, "face 3"],
    band: float,
) -> Float32[np.ndarray, "x y z"]:
    """Signed distances where the surface is nearer than `band`, infinite elsewhere [cm]."""
    values = np.full(shape, np.inf, np.float32)
    scaled = np.ascontiguousarray((points - origin) / cell)
    normals = _pseudonormals(scaled, faces)
    stamp(values, scaled, faces.astype(np.int64), *normals, band / cell)
    values *= np.float32(cell)
    return values


def _pseudonormals(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> tuple[
    Float[np.ndarray, "face 3"], Float[np.ndarray, "face 3 3"], Float[np.ndarray, "vertex 3"]
]:
    """Normals of faces, of each face's edges (k, k+1) and of vertices; zero along open rims."""
    # Baerentzen and Aanaes 2005: an edge has the sum of the normals of its two faces, a vertex the
    # sum of those round it, weighted by the angles there.
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)

    following = np.roll(faces, -1, axis=1)
    key = np.minimum(faces, following).astype(np.int64) * len(points) + np.maximum(faces, following)
    _, edge, count = np.unique(key.ravel(), return_inverse=True, return_counts=True)
    whole = count == 2
    edge_normal = sums_by(edge, np.repeat(normal, 3, axis=0), len(count)) * whole[:, None]

    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    angle = np.arctan2(
        np.linalg.norm(np.cross(ahead, behind), axis=2), (ahead * behind).sum(axis=2)
    )
    weighted = (angle[:, :, None] * normal[:, None]).reshape(-1, 3)
    vertex_normal = sums_by(faces.ravel(), weighted, len(points))
    rim = ~whole[edge].reshape(faces.shape)
    vertex_normal[np.concatenate([faces[rim], following[rim]])] = 0.0
    return normal, edge_normal[edge].reshape(*faces.shape, 3), vertex_normal
