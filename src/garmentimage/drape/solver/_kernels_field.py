"""Compiled loops of the distance field: exact distances, swept distances, winding numbers."""

# mypy: allow-untyped-defs, allow-untyped-decorators

import numpy as np
from numba import njit


# A chamfer distance (Borgefors 1986, "Distance transformations in digital images"): d(p) = min over
# the 26 neighbours q of d(q) + |p - q|, in one pass forwards and one backwards, each over the 13
# neighbours that come before.
@njit(cache=True)
def sweep(values, far, cell):
    """Carry distances from each place's thirteen neighbours that come before it."""
    nx, ny, nz = values.shape
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                # Distances near the surface are exact and are kept.
                if not far[i, j, k]:
                    continue
                best = values[i, j, k]
                for a in range(max(i - 1, 0), i + 1):
                    for b in range(max(j - 1, 0), min(j + 2, ny) if a < i else j + 1):
                        before = a < i or b < j
                        for c in range(max(k - 1, 0), min(k + 2, nz) if before else k):
                            step = cell * np.sqrt(float((i - a) ** 2 + (j - b) ** 2 + (k - c) ** 2))
                            value = values[a, b, c]
                            # The sign is kept: it is that of the side of the surface.
                            if abs(value) + step < abs(best):
                                best = value + step if value > 0.0 else value - step
                values[i, j, k] = best


# The winding number along each line of nodes in z is the sum of the signed crossings of the surface
# below (Jacobson et al. 2013). A line is met by the triangles whose projection to x-y holds it.
@njit(cache=True)
def count_crossings(turns, points, faces):
    """At the first node behind each crossing: 1 where it leads in, -1 where it leads out."""
    nx, ny, nz = turns.shape
    for f in range(len(faces)):
        a, b, c = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        # Lines of nodes over the bounding box of the triangle's projection.
        for i in range(_from(a[0], b[0], c[0], 0.0), _to(a[0], b[0], c[0], 0.0, nx)):
            for j in range(_from(a[1], b[1], c[1], 0.0), _to(a[1], b[1], c[1], 0.0, ny)):
                at_c = (b[0] - a[0]) * (j - a[1]) - (b[1] - a[1]) * (i - a[0])
                at_a = (c[0] - b[0]) * (j - b[1]) - (c[1] - b[1]) * (i - b[0])
                at_b = (a[0] - c[0]) * (j - c[1]) - (a[1] - c[1]) * (i - c[0])
                # Twice the areas opposite the corners: of one sign where the line goes through.
                if at_a > 0.0 and at_b > 0.0 and at_c > 0.0:
                    turn = -1
                elif at_a < 0.0 and at_b < 0.0 and at_c < 0.0:
                    turn = 1
                else:
                    continue
                height = (at_a * a[2] + at_b * b[2] + at_c * c[2]) / (at_a + at_b + at_c)
                turns[i, j, min(max(int(np.ceil(height)), 0), nz - 1)] += turn


@njit(cache=True)
def _from(a, b, c, band):
    """The first node within the extent of three coordinates, or so near to it."""
    return max(int(np.ceil(min(a, b, c) - band)), 0)


@njit(cache=True)
def _to(a, b, c, band, count):
    """The node after the last such one."""
    return min(int(np.floor(max(a, b, c) + band)) + 1, count)


# Trilinear interpolation between the eight nodes round a place, and its exact gradient.
@njit(cache=True)
def sample_field(values, origin, per_cell, x, y, z):
    """Distance at a place, interpolated linearly along each axis, and its slope (4 numbers)."""
    nx, ny, nz = values.shape
    u = min(max((x - origin[0]) * per_cell, 0.0), nx - 1.0)
    v = min(max((y - origin[1]) * per_cell, 0.0), ny - 1.0)
    w = min(max((z - origin[2]) * per_cell, 0.0), nz - 1.0)
    # NaN is taken to lie at the corner of the grid: its index must not leave the array.
    i, j, k = max(min(int(u), nx - 2), 0), max(min(int(v), ny - 2), 0), max(min(int(w), nz - 2), 0)
    u, v, w = u - i, v - j, w - k
    # Linear along x first, then along y, then along z.
    low00, low01 = values[i, j, k], values[i, j, k + 1]
    low10, low11 = values[i, j + 1, k], values[i, j + 1, k + 1]
    rise00, rise01 = values[i + 1, j, k] - low00, values[i + 1, j, k + 1] - low01
    rise10, rise11 = values[i + 1, j + 1, k] - low10, values[i + 1, j + 1, k + 1] - low11
    at00, at01 = low00 + rise00 * u, low01 + rise01 * u
    at10, at11 = low10 + rise10 * u, low11 + rise11 * u
    at0, at1 = at00 + (at10 - at00) * v, at01 + (at11 - at01) * v
    slope_x = (rise00 * (1 - v) + rise10 * v) * (1 - w) + (rise01 * (1 - v) + rise11 * v) * w
    slope_y = (at10 - at00) * (1 - w) + (at11 - at01) * w
    slope_z = at1 - at0
    return at0 + slope_z * w, slope_x * per_cell, slope_y * per_cell, slope_z * per_cell


@njit(cache=True)
def sample_all(values, origin, per_cell, points, distance, slope):
    """`sample_field` for many places, into `distance` and `slope`."""
    for n in range(len(points)):
        x, y, z = points[n]
        distance[n], slope[n, 0], slope[n, 1], slope[n, 2] = sample_field(
            values, origin, per_cell, x, y, z
        )


# Each triangle writes its exact distance at the nodes within a band, where no other is nearer. The
# sign is that of the pseudonormal of the nearest feature: face, edge or corner (Baerentzen and
# Aanaes 2005).
@njit(cache=True)
def stamp(values, points, faces, face_normal, edge_normal, vertex_normal, band):
    """Write each triangle's signed distance at the nodes round it, where it is the nearest yet."""
    nx, ny, nz = values.shape
    for f in range(len(faces)):
        a, b, c = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        # Plane and bounding sphere of the triangle.
        n = face_normal[f]
        mx, my, mz = (a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3
        radius = max(_apart(a, mx, my, mz), _apart(b, mx, my, mz), _apart(c, mx, my, mz))
        for i in range(_from(a[0], b[0], c[0], band), _to(a[0], b[0], c[0], band, nx)):
            for j in range(_from(a[1], b[1], c[1], band), _to(a[1], b[1], c[1], band, ny)):
                for k in range(_from(a[2], b[2], c[2], band), _to(a[2], b[2], c[2], band, nz)):
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
                    # Feature 0 is the face, 1 to 3 are its edges, 4 to 6 its corners.
                    if feature == 0:
                        m = n
                    elif feature < 4:
                        m = edge_normal[f, feature - 1]
                    else:
                        m = vertex_normal[faces[f, feature - 4]]
                    inside = dx * m[0] + dy * m[1] + dz * m[2] < 0.0
                    values[i, j, k] = -d if inside else d


@njit(cache=True)
def _apart(point, x, y, z):
    """Distance of two points."""
    return np.sqrt((point[0] - x) ** 2 + (point[1] - y) ** 2 + (point[2] - z) ** 2)


@njit(cache=True)
def _nearest_on_triangle(x, y, z, a, b, c):
    """Nearest point of a triangle and where: 0 inside, 1 to 3 on ab, bc, ca, 4 to 6 at a, b, c."""
    # Ericson 2005, "Real-Time Collision Detection", 5.1.5: each test is for the Voronoi region of
    # one corner or edge, by dot products with two sides.
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    px, py, pz = x - a[0], y - a[1], z - a[2]
    # Beyond corner a, along neither side.
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
