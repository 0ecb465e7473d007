"""How far every place is from a body: the obstacle that cloth comes to rest on.

Near the skin the distance is exact. Farther off it is carried on from node to node along the grid
and its diagonals (a chamfer distance, Borgefors 1986), which makes it too great by up to an eighth.
Inside of a body is where its surface goes round by the winding number, so that lips that touch and
folds do no harm. Cloth has no inside: the sign of its distance is that of angle-weighted
pseudonormals (Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted
pseudonormal").
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil

import numpy as np
from jaxtyping import Float, Float32, Int
from numba import njit

from garmentimage.body import Body

CELL = 1.0
"""Side of a grid cell [cm]."""
PAD = 5.0
"""The grid goes this far beyond the body [cm]; nothing farther off can touch it."""
BAND = 2.0
"""Distances are exact up to this far from a body's skin [cm]."""
BESIDE = np.array([1.2e-5, 2.3e-5, 0.0])
"""How far beside a node its line of crossings runs [cells]."""
CLOTH_BAND = 2.2
"""What lies up to this far behind settled cloth counts as inside [cm]."""
FIELDS_KEPT = 4
"""Bodies whose fields are kept; each takes some 6 MB."""


@dataclass(frozen=True, eq=False)
class DistanceField:
    """Signed distance to a surface at the nodes of a grid, negative inside."""

    values: Float32[np.ndarray, "x y z"]
    """[cm]"""
    origin: Float[np.ndarray, " 3"]
    """Place of the first node [cm]."""
    cell: float
    """Distance between nodes [cm]."""

    def at(self, points: Float[np.ndarray, "point 3"]) -> Float[np.ndarray, " point"]:
        """Signed distances, interpolated between nodes; beyond the grid as at its rim [cm]."""
        return self.at_with_slope(points)[0]

    def at_with_slope(
        self, points: Float[np.ndarray, "point 3"]
    ) -> tuple[Float[np.ndarray, " point"], Float[np.ndarray, "point 3"]]:
        """Signed distances [cm] and the directions in which they grow (about unit vectors)."""
        distance, slope = np.empty(len(points)), np.empty((len(points), 3))
        _sample_all(self.values, self.origin, 1.0 / self.cell, points, distance, slope)
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
        pushed out and not kept in the gap. Rims of the cloth have no inside.

        Args:
            points: the cloth at rest [cm].
            faces: its triangles, counter-clockwise seen from outside the body.
            thickness: of the cloth [cm]; the obstacle's surface lies this far outside `points`.
        """
        cloth = _near(self.values.shape, self.origin, self.cell, points, faces, CLOTH_BAND)
        values = np.minimum(self.values, cloth - np.float32(thickness))
        values.setflags(write=False)
        return replace(self, values=values)


@lru_cache(maxsize=FIELDS_KEPT)
def body_field(body: Body) -> DistanceField:
    """The field round a body; made once, its values are read-only."""
    return distance_field(body.vertices, body.faces)


def empty_field() -> DistanceField:
    """A field without any obstacle."""
    return DistanceField(np.full((2, 2, 2), 1e6, np.float32), np.zeros(3), CELL)


def distance_field(
    points: Float[np.ndarray, "vertex 3"],
    faces: Int[np.ndarray, "face 3"],
    *,
    cell: float = CELL,
    pad: float = PAD,
) -> DistanceField:
    """The signed distance to a closed surface, which may touch itself and pass through itself.

    Args:
        points: vertices of the surface [cm].
        faces: triangles, counter-clockwise seen from outside.
        cell: distance between grid nodes [cm].
        pad: how far the grid goes beyond the surface [cm].
    """
    # Nodes lie at odd halves of a cell, so that a mirrored surface has the mirrored field.
    origin = (np.floor((points.min(axis=0) - pad) / cell - 0.5) + 0.5) * cell
    size = points.max(axis=0) + pad - origin
    shape = tuple(ceil(s / cell) + 1 for s in size)
    values = _near(shape, origin, cell, points, faces, BAND)
    _carry_on(values, cell)
    inside = _winding(shape, np.ascontiguousarray((points - origin) / cell), faces) > 0
    values = np.where(inside, -np.abs(values), np.abs(values))
    values.setflags(write=False)
    return DistanceField(values, origin, cell)


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
    _stamp(values, scaled, faces.astype(np.int64), *normals, band / cell)
    values *= np.float32(cell)
    return values


def _pseudonormals(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> tuple[
    Float[np.ndarray, "face 3"], Float[np.ndarray, "face 3 3"], Float[np.ndarray, "vertex 3"]
]:
    """Normals of faces, of each face's edges (k, k+1) and of vertices; zero along open rims."""
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)

    following = np.roll(faces, -1, axis=1)
    key = np.minimum(faces, following).astype(np.int64) * len(points) + np.maximum(faces, following)
    _, edge, count = np.unique(key.ravel(), return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    whole = count == 2
    edge_normal = _sums(edge, np.repeat(normal, 3, axis=0), len(count)) * whole[:, None]

    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    angle = np.arctan2(
        np.linalg.norm(np.cross(ahead, behind), axis=2), (ahead * behind).sum(axis=2)
    )
    vertex_normal = _sums(
        faces.ravel(), (angle[:, :, None] * normal[:, None]).reshape(-1, 3), len(points)
    )
    rim = ~whole[edge].reshape(faces.shape)
    vertex_normal[np.concatenate([faces[rim], following[rim]])] = 0.0
    return normal, edge_normal[edge].reshape(*faces.shape, 3), vertex_normal


def _sums(
    index: Int[np.ndarray, " item"], vectors: Float[np.ndarray, "item 3"], count: int
) -> Float[np.ndarray, "group 3"]:
    """Sums of the vectors that share an index."""
    return np.stack([np.bincount(index, v, minlength=count) for v in vectors.T], axis=1)


def _carry_on(values: Float32[np.ndarray, "x y z"], cell: float) -> None:
    """Fill the infinite places from the near ones, in place: once through the grid and back."""
    far = np.isinf(values)
    back = np.s_[::-1, ::-1, ::-1]
    _sweep(values, far, cell)
    _sweep(values[back], far[back], cell)


@njit(cache=True)
def _sweep(values, far, cell):
    """Carry distances from each place's thirteen neighbours that come before it."""
    nx, ny, nz = values.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                if not far[i, j, k]:
                    continue
                best = values[i, j, k]
                for a in range(max(i - 1, 0), i + 1):
                    for b in range(max(j - 1, 0), min(j + 2, ny) if a < i else j + 1):
                        before = a < i or b < j
                        for c in range(max(k - 1, 0), min(k + 2, nz) if before else k):
                            step = cell * np.sqrt(float((i - a) ** 2 + (j - b) ** 2 + (k - c) ** 2))
                            value = values[a, b, c]
                            if abs(value) + step < abs(best):
                                best = value + step if value > 0.0 else value - step
                values[i, j, k] = best


def _winding(
    shape: tuple[int, ...],
    points: Float[np.ndarray, "vertex 3"],
    faces: Int[np.ndarray, "face 3"],
) -> Int[np.ndarray, "x y z"]:
    """How often a closed surface goes round each node; `points` in cells from the first node.

    Along each line of nodes, the number changes where the surface is crossed. The lines lie a hair
    beside the nodes, so that they do not run through its edges and corners.
    """
    turns = np.zeros(shape, np.int32)
    _count_crossings(turns, points - BESIDE, faces.astype(np.int64))
    return np.cumsum(turns, axis=2, dtype=np.int32)


@njit(cache=True)
def _count_crossings(turns, points, faces):
    """At the first node behind each crossing: 1 where it leads in, -1 where it leads out."""
    nx, ny, nz = turns.shape
    for f in range(len(faces)):
        a, b, c = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        for i in range(_from(a[0], b[0], c[0]), _to(a[0], b[0], c[0], nx)):
            for j in range(_from(a[1], b[1], c[1]), _to(a[1], b[1], c[1], ny)):
                at_c = (b[0] - a[0]) * (j - a[1]) - (b[1] - a[1]) * (i - a[0])
                at_a = (c[0] - b[0]) * (j - b[1]) - (c[1] - b[1]) * (i - b[0])
                at_b = (a[0] - c[0]) * (j - c[1]) - (a[1] - c[1]) * (i - c[0])
                if at_a > 0.0 and at_b > 0.0 and at_c > 0.0:
                    way = -1
                elif at_a < 0.0 and at_b < 0.0 and at_c < 0.0:
                    way = 1
                else:
                    continue
                height = (at_a * a[2] + at_b * b[2] + at_c * c[2]) / (at_a + at_b + at_c)
                turns[i, j, min(max(int(np.ceil(height)), 0), nz - 1)] += way


@njit(cache=True)
def _from(a, b, c):
    return max(int(np.ceil(min(a, b, c))), 0)


@njit(cache=True)
def _to(a, b, c, count):
    return min(int(np.floor(max(a, b, c))) + 1, count)


@njit(cache=True)
def sample(values, origin, per_cell, x, y, z):
    """Distance at a place, interpolated linearly along each axis, and its slope (4 numbers)."""
    nx, ny, nz = values.shape
    u = min(max((x - origin[0]) * per_cell, 0.0), nx - 1.0)
    v = min(max((y - origin[1]) * per_cell, 0.0), ny - 1.0)
    w = min(max((z - origin[2]) * per_cell, 0.0), nz - 1.0)
    # What is no number is taken to lie at the grid's corner: its index must not leave the array.
    i, j, k = max(min(int(u), nx - 2), 0), max(min(int(v), ny - 2), 0), max(min(int(w), nz - 2), 0)
    u, v, w = u - i, v - j, w - k
    low00, low01 = values[i, j, k], values[i, j, k + 1]
    low10, low11 = values[i, j + 1, k], values[i, j + 1, k + 1]
    rise00, rise01 = values[i + 1, j, k] - low00, values[i + 1, j, k + 1] - low01
    rise10, rise11 = values[i + 1, j + 1, k] - low10, values[i + 1, j + 1, k + 1] - low11
    at00, at01 = low00 + rise00 * u, low01 + rise01 * u
    at10, at11 = low10 + rise10 * u, low11 + rise11 * u
    at0, at1 = at00 + (at10 - at00) * v, at01 + (at11 - at01) * v
    slope_x = (rise00 * (1 - v) + rise10 * v) * (1 - w) + (rise01 * (1 - v) + rise11 * v) * w
    slope_y = (at10 - at00) * (1 - w) + (at11 - at01) * w
    return (
        at0 + (at1 - at0) * w,
        slope_x * per_cell,
        slope_y * per_cell,
        (at1 - at0) * per_cell,
    )


@njit(cache=True)
def _sample_all(values, origin, per_cell, points, distance, slope):
    for n in range(len(points)):
        d, x, y, z = sample(values, origin, per_cell, points[n, 0], points[n, 1], points[n, 2])
        distance[n] = d
        slope[n, 0], slope[n, 1], slope[n, 2] = x, y, z


@njit(cache=True)
def _stamp(values, points, faces, face_normal, edge_normal, vertex_normal, band):
    """Write each triangle's signed distance at the nodes round it, where it is the nearest yet."""
    nx, ny, nz = values.shape
    for f in range(len(faces)):
        a, b, c = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        x0 = max(0, int(np.ceil(min(a[0], b[0], c[0]) - band)))
        x1 = min(nx - 1, int(np.floor(max(a[0], b[0], c[0]) + band)))
        y0 = max(0, int(np.ceil(min(a[1], b[1], c[1]) - band)))
        y1 = min(ny - 1, int(np.floor(max(a[1], b[1], c[1]) + band)))
        z0 = max(0, int(np.ceil(min(a[2], b[2], c[2]) - band)))
        z1 = min(nz - 1, int(np.floor(max(a[2], b[2], c[2]) + band)))
        n = face_normal[f]
        mx, my, mz = (a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3
        radius = max(_apart(a, mx, my, mz), _apart(b, mx, my, mz), _apart(c, mx, my, mz))
        for i in range(x0, x1 + 1):
            for j in range(y0, y1 + 1):
                for k in range(z0, z1 + 1):
                    # Most nodes are ruled out by the distance to the triangle's plane or middle.
                    height = (i - a[0]) * n[0] + (j - a[1]) * n[1] + (k - a[2]) * n[2]
                    limit = min(abs(values[i, j, k]), band)
                    if abs(height) >= limit:
                        continue
                    if (i - mx) ** 2 + (j - my) ** 2 + (k - mz) ** 2 >= (radius + limit) ** 2:
                        continue
                    qx, qy, qz, feature = _nearest_on_triangle(i, j, k, a, b, c)
                    dx, dy, dz = i - qx, j - qy, k - qz
                    d = np.sqrt(dx * dx + dy * dy + dz * dz)
                    if d >= limit:
                        continue
                    if feature == 0:
                        m = n
                    elif feature < 4:
                        m = edge_normal[f, feature - 1]
                    else:
                        m = vertex_normal[faces[f, feature - 4]]
                    inside = dx * m[0] + dy * m[1] + dz * m[2] < 0.0
                    values[i, j, k] = -d if inside else d


@njit(cache=True)
def _apart(point, x, y, z):  # type: ignore[no-untyped-def]
    return np.sqrt((point[0] - x) ** 2 + (point[1] - y) ** 2 + (point[2] - z) ** 2)


@njit(cache=True)
def _nearest_on_triangle(x, y, z, a, b, c):
    """Nearest point of a triangle and where it lies.

    0 is the inside, 1 to 3 the edges ab, bc, ca, and 4 to 6 the corners a, b, c. After Ericson,
    "Real-Time Collision Detection" (2005), 5.1.5.
    """
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    px, py, pz = x - a[0], y - a[1], z - a[2]
    d1, d2 = ux * px + uy * py + uz * pz, vx * px + vy * py + vz * pz
    if d1 <= 0.0 and d2 <= 0.0:
        return a[0], a[1], a[2], 4
    px, py, pz = x - b[0], y - b[1], z - b[2]
    d3, d4 = ux * px + uy * py + uz * pz, vx * px + vy * py + vz * pz
    if d3 >= 0.0 and d4 <= d3:
        return b[0], b[1], b[2], 5
    over_ab = d1 * d4 - d3 * d2
    if over_ab <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        t = d1 / (d1 - d3) if d1 > d3 else 0.0
        return a[0] + t * ux, a[1] + t * uy, a[2] + t * uz, 1
    px, py, pz = x - c[0], y - c[1], z - c[2]
    d5, d6 = ux * px + uy * py + uz * pz, vx * px + vy * py + vz * pz
    if d6 >= 0.0 and d5 <= d6:
        return c[0], c[1], c[2], 6
    over_ca = d5 * d2 - d1 * d6
    if over_ca <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        t = d2 / (d2 - d6) if d2 > d6 else 0.0
        return a[0] + t * vx, a[1] + t * vy, a[2] + t * vz, 3
    over_bc = d3 * d6 - d5 * d4
    if over_bc <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        whole = (d4 - d3) + (d5 - d6)
        t = (d4 - d3) / whole if whole > 0.0 else 0.0
        return b[0] + t * (c[0] - b[0]), b[1] + t * (c[1] - b[1]), b[2] + t * (c[2] - b[2]), 2
    total = over_ab + over_bc + over_ca
    if total <= 0.0:  # A triangle that rounding has made a line; its neighbours are as near.
        return a[0], a[1], a[2], 4
    scale = 1.0 / total
    s, t = over_ca * scale, over_ab * scale
    return a[0] + s * ux + t * vx, a[1] + s * uy + t * vy, a[2] + s * uz + t * vz, 0
