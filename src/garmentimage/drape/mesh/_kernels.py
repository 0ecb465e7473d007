"""Compiled loops of the triangulator: points inside, Delaunay flips, smoothing.

Words of this file: see `triangulate`.
"""

# mypy: allow-untyped-defs, allow-untyped-decorators

import numpy as np
from numba import njit

ROUNDS = 4  # rounds of smoothing
FLIP_TOL = 1e-9
"""A flip must improve sin(a + b) by this, or rounding could flip back and forth endlessly."""
KEEP_SHARE = 0.2  # smoothing may shrink a triangle to this share of its area in a round
CLEARANCE = 0.6
"""Least distance of points inside from the boundary, in lengths of a side of the lattice."""
APART = 0.65  # least distance between the middle row and the lattice, in the same lengths
NARROW = 2.1
"""Where the cloth is narrower than this, in the same lengths, its middle gets points of its own; a
row of the lattice could miss it (twice CLEARANCE and the distance of two rows)."""
MIDDLE_CLEARANCE = 0.4
"""Least distance of the middle row from the boundary, in widths of the cloth there."""
THREAD = 0.15  # where cloth is narrower than this, it is left one row of triangles wide
FAR = 1e30  # larger than any distance or area


@njit(cache=True)
def inward_widths(points, ends, inward):
    """For each side, the distance from its middle straight inwards to the next side."""
    count = len(points)
    widths = np.full(count, FAR)
    for k in range(count):
        ax, ay = points[k, 0], points[k, 1]
        bx, by = points[ends[k], 0], points[ends[k], 1]
        length = np.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        if length == 0.0:
            continue
        nx, ny = -inward * (by - ay) / length, inward * (bx - ax) / length
        mx, my = (ax + bx) / 2, (ay + by) / 2
        for j in range(count):
            cx, cy = points[j, 0], points[j, 1]
            ex, ey = points[ends[j], 0] - cx, points[ends[j], 1] - cy
            turn = nx * ey - ny * ex
            if j == k or turn == 0.0:
                continue
            # The ray from the middle along the inner normal meets the line of side j after `along`,
            # at this share of that side.
            along = ((cx - mx) * ey - (cy - my) * ex) / turn
            share = ((cx - mx) * ny - (cy - my) * nx) / turn
            if along > 0 and 0 <= share <= 1:
                widths[k] = min(widths[k], along)
    return widths


@njit(cache=True)
def _boundary_distance(x, y, points, ends):
    """Squared distance of a place to the nearest side, and whether it lies inside."""
    nearest, inside = FAR, False
    for k in range(len(points)):
        ax, ay = points[k, 0], points[k, 1]
        bx, by = points[ends[k], 0], points[ends[k], 1]
        dx, dy = bx - ax, by - ay
        size, share = dx * dx + dy * dy, 0.0
        if size > 0.0:  # Else its ends are one point.
            share = min(max(((x - ax) * dx + (y - ay) * dy) / size, 0.0), 1.0)
        ox, oy = ax + share * dx - x, ay + share * dy - y
        nearest = min(nearest, ox * ox + oy * oy)
        # A ray to the right crosses the boundary an odd number of times from inside.
        if (ay > y) != (by > y) and x < ax + (y - ay) / dy * dx:
            inside = not inside
    return nearest, inside


@njit(cache=True)
def _clear(x, y, points, count, apart):
    """Whether none of the first points is nearer than `apart`."""
    for k in range(count):
        dx, dy = points[k, 0] - x, points[k, 1] - y
        if dx * dx + dy * dy < apart * apart:
            return False
    return True


# A row along the middle of narrow cloth; elsewhere a hexagonal lattice, whose triangles are
# equilateral, as far as it keeps off the boundary.
@njit(cache=True)
def place_inner_points(points, ends, inward, widths, spacing):
    """Points of the middle rows, then of the lattice, as a new array."""
    low_x, high_x = points[:, 0].min(), points[:, 0].max()
    low_y, high_y = points[:, 1].min(), points[:, 1].max()
    rise = spacing * np.sqrt(3.0) / 2
    rows, columns = int((high_y - low_y) / rise) + 1, int((high_x - low_x) / spacing) + 2
    found = np.empty((rows * columns + len(points), 2))
    count = 0
    for k in range(len(points)):
        # A point at the middle of the cloth, straight inwards from the middle of the side.
        width = widths[k]
        if not THREAD * spacing < width < NARROW * spacing:
            continue
        ax, ay = points[k, 0], points[k, 1]
        bx, by = points[ends[k], 0], points[ends[k], 1]
        dx, dy = bx - ax, by - ay
        length = np.sqrt(dx * dx + dy * dy)
        x = (ax + bx) / 2 - inward * dy / length * width / 2
        y = (ay + by) / 2 + inward * dx / length * width / 2
        nearest, inside = _boundary_distance(x, y, points, ends)
        if not inside or nearest < (MIDDLE_CLEARANCE * width) ** 2:
            continue
        if _clear(x, y, found, count, APART * min(spacing, max(length, width / 2))):
            found[count, 0], found[count, 1] = x, y
            count += 1
    # Rows and columns are centred, so that a mirrored panel gets the mirrored lattice.
    middles = count
    middle_y, middle_x = (low_y + high_y) / 2, (low_x + high_x) / 2
    for row in range(rows):
        y = middle_y + (row - rows // 2) * rise
        for column in range(columns):
            x = middle_x + (column - columns // 2 + 0.5 * (row % 2)) * spacing
            nearest, inside = _boundary_distance(x, y, points, ends)
            if not inside or nearest < (CLEARANCE * spacing) ** 2:
                continue
            if _clear(x, y, found, middles, APART * spacing):
                found[count, 0], found[count, 1] = x, y
                count += 1
    return found[:count].copy()


# Each point splits the triangle it falls into, found by walking from triangle to triangle towards
# it; then sides are flipped until Delaunay (Lawson 1977, "Software for C1 surface interpolation").
# The boundary is never flipped, so the result is the constrained Delaunay triangulation.
@njit(cache=True)
def fill(points, outline, fixed):
    """Triangles of the outline with the points inside put in and smoothed in place."""
    start = len(outline)
    faces = np.empty((start + 2 * (len(points) - fixed), 3), np.int64)
    across = np.full(faces.shape, -1, np.int64)
    faces[:start] = outline
    # GEOS gives some constrained triangulation; flips make it Delaunay.
    _join(faces[:start], across[:start], len(points))
    _flip_all(points, faces[:start], across[:start])
    # Sides that may need a flip. A full stack only leaves some for the next round.
    stack = np.empty(16 * len(faces) + 64, np.int64)
    count, at = start, 0
    for p in range(fixed, len(points)):
        at = _triangle_of(points, faces, across, count, p, at)
        count = _put(points, faces, across, count, at, p, stack)
    for _ in range(ROUNDS):
        _smooth(points, faces, fixed)
        _flip_all(points, faces, across)
    return faces


@njit(cache=True)
def _join(faces, across, count):
    """Fill in which triangle lies across each side."""
    # Sorting the sides by their ends brings the two uses of each side together.
    keys = np.empty(3 * len(faces), np.int64)
    for t in range(len(faces)):
        for k in range(3):
            i, j = faces[t, k], faces[t, (k + 1) % 3]
            keys[3 * t + k] = min(i, j) * count + max(i, j)
    order = np.argsort(keys)
    for n in range(len(order) - 1):
        a, b = order[n], order[n + 1]
        if keys[a] == keys[b]:
            across[a // 3, a % 3] = b // 3
            across[b // 3, b % 3] = a // 3


@njit(cache=True)
def _doubled_area(points, i, j, k):
    """Twice the signed area of a triangle."""
    return (points[j, 0] - points[i, 0]) * (points[k, 1] - points[i, 1]) - (
        points[j, 1] - points[i, 1]
    ) * (points[k, 0] - points[i, 0])


@njit(cache=True)
def _triangle_of(points, faces, across, count, p, at):
    """The triangle that a point inside lies in: a walk, and a search where the walk is lost."""
    for _ in range(count):
        out = -1
        for k in range(3):
            if _doubled_area(points, faces[at, k], faces[at, (k + 1) % 3], p) < 0:
                out = k
                break
        if out < 0:
            return at
        if across[at, out] < 0:
            break
        at = across[at, out]
    # Lost at the boundary or going round in circles: the triangle that comes nearest to holding it.
    best, depth = 0, -FAR
    for t in range(count):
        least = FAR
        for k in range(3):
            least = min(least, _doubled_area(points, faces[t, k], faces[t, (k + 1) % 3], p))
        if least > depth:
            best, depth = t, least
    return best


@njit(cache=True)
def _set(rows, t, x, y, z):
    rows[t, 0], rows[t, 1], rows[t, 2] = x, y, z


@njit(cache=True)
def _replace_neighbour(across, t, old, new):
    """Replace the neighbour `old` of triangle `t`, if there is one, by `new`."""
    if t >= 0:
        for k in range(3):
            if across[t, k] == old:
                across[t, k] = new
                return


@njit(cache=True)
def _put(points, faces, across, count, at, p, stack):
    """Split triangle `at` into three at the point `p` and flip until Delaunay."""
    # (a, b, c) becomes (a, b, p), (b, c, p) and (c, a, p); side 0 of each is an old side.
    a, b, c = faces[at, 0], faces[at, 1], faces[at, 2]
    over_bc, over_ca = across[at, 1], across[at, 2]
    second, third = count, count + 1
    faces[at, 2] = p
    _set(faces, second, b, c, p)
    _set(faces, third, c, a, p)
    _set(across, second, over_bc, third, at)
    _set(across, third, over_ca, at, second)
    across[at, 1], across[at, 2] = second, third
    _replace_neighbour(across, over_bc, at, second)
    _replace_neighbour(across, over_ca, at, third)
    stack[0], stack[1], stack[2] = 3 * at, 3 * second, 3 * third
    _settle(points, faces, across, stack, 3)
    return count + 2


@njit(cache=True)
def _flip_all(points, faces, across):
    """Flip sides until the triangles are Delaunay as far as the boundary lets them be."""
    stack = np.empty(16 * len(faces) + 64, np.int64)
    for t in range(len(faces)):
        for k in range(3):
            if across[t, k] > t:
                stack[0] = 3 * t + k
                _settle(points, faces, across, stack, 1)


@njit(cache=True)
def _settle(points, faces, across, stack, count):
    """Flip the sides on the stack where that is better, and then those round about."""
    while count > 0:
        count -= 1
        t, k = stack[count] // 3, stack[count] % 3
        # The four outer sides of the two triangles may have become worse by the flip.
        if _flip(points, faces, across, t, k) and count + 4 <= len(stack):
            other = across[t, 2]
            stack[count], stack[count + 1] = 3 * t, 3 * t + 1
            stack[count + 2], stack[count + 3] = 3 * other, 3 * other + 1
            count += 4


@njit(cache=True)
def _flip(points, faces, across, t, k):
    """Turn the side k of triangle t into the other diagonal, where that is more Delaunay.

    Afterwards the new diagonal is side 2 of both triangles.
    """
    u = across[t, k]
    if u < 0:
        return False
    # Side m of the neighbour u is the same side, run along in the opposite direction.
    m = 0
    while across[u, m] != t or faces[u, m] != faces[t, (k + 1) % 3]:
        m += 1
        if m == 3:
            return False
    i, j = faces[t, k], faces[t, (k + 1) % 3]
    a, b = faces[t, (k + 2) % 3], faces[u, (m + 2) % 3]
    if not _flips(points, i, j, a, b):
        return False
    # The diagonal a-b replaces i-j; neighbours of the two outer sides that change hands follow.
    over_ja, over_ai = across[t, (k + 1) % 3], across[t, (k + 2) % 3]
    over_ib, over_bj = across[u, (m + 1) % 3], across[u, (m + 2) % 3]
    _set(faces, t, a, i, b)
    _set(faces, u, b, j, a)
    _set(across, t, over_ai, over_ib, u)
    _set(across, u, over_bj, over_ja, t)
    _replace_neighbour(across, over_ib, u, t)
    _replace_neighbour(across, over_ja, t, u)
    return True


# The side i-j between the triangles (a, i, j) and (b, j, i) is Delaunay where the angles at a and b
# add up to at most half a turn, that is where sin(a + b) >= 0. With cross and dot products in place
# of sines and cosines no square root is needed.
@njit(cache=True)
def _flips(points, i, j, a, b):
    """Whether the diagonal a-b is better than i-j: the angles at a and b exceed half a turn."""
    # Angles of at most a right one each cannot add up to more than half a turn.
    cosine_a, cosine_b = _dot_at(points, a, i, j), _dot_at(points, b, j, i)
    if cosine_a >= 0 and cosine_b >= 0:
        return False
    # Both new triangles must have area: the four corners must be a convex quadrilateral.
    if _doubled_area(points, a, i, b) <= 0 or _doubled_area(points, b, j, a) <= 0:
        return False
    sine_a, sine_b = _doubled_area(points, a, i, j), _doubled_area(points, b, j, i)
    size = (abs(sine_a) + abs(cosine_a)) * (abs(sine_b) + abs(cosine_b))
    return sine_a * cosine_b + cosine_a * sine_b < -FLIP_TOL * size


@njit(cache=True)
def _dot_at(points, a, i, j):
    """Cosine of the angle at a between i and j, times the two lengths."""
    return (points[i, 0] - points[a, 0]) * (points[j, 0] - points[a, 0]) + (
        points[i, 1] - points[a, 1]
    ) * (points[j, 1] - points[a, 1])


# Each point inside moves to the centroid of the triangles round it, weighted by area, and sides are
# flipped again: Laplacian smoothing on areas instead of neighbours, whose mean would pull a point
# to the boundary wherever that is cut finer. A triangle that would shrink too far keeps its
# corners.
@njit(cache=True)
def _smooth(points, faces, fixed):
    """Move each point inside to the centre of area of its triangles, where none suffers by it."""
    count = len(points)
    sum_x, sum_y, total = np.zeros(count), np.zeros(count), np.zeros(count)
    for t in range(len(faces)):
        i, j, k = faces[t, 0], faces[t, 1], faces[t, 2]
        area = _doubled_area(points, i, j, k)
        x = (points[i, 0] + points[j, 0] + points[k, 0]) / 3
        y = (points[i, 1] + points[j, 1] + points[k, 1]) / 3
        for p in (i, j, k):
            sum_x[p] += area * x
            sum_y[p] += area * y
            total[p] += area
    # Move all points at once; the order of triangles does not matter.
    before = points.copy()
    held = np.zeros(count, np.bool_)
    held[:fixed] = True
    for p in range(fixed, count):
        if total[p] > 0.0:
            points[p, 0], points[p, 1] = sum_x[p] / total[p], sum_y[p] / total[p]
    # Put back the corners of triangles that shrank too far; that may shrink others, so repeat.
    worse = True
    while worse:
        worse = False
        for t in range(len(faces)):
            i, j, k = faces[t, 0], faces[t, 1], faces[t, 2]
            if _doubled_area(points, i, j, k) >= KEEP_SHARE * _doubled_area(before, i, j, k):
                continue
            for n in range(3):
                p = faces[t, n]
                if not held[p]:
                    held[p], worse = True, True
                    points[p, 0], points[p, 1] = before[p, 0], before[p, 1]
