"""Compiled loops that find triangles which pass through each other."""

# mypy: allow-untyped-defs, allow-untyped-decorators

import numpy as np
from numba import njit


# Pairs are found on a uniform grid of bins (Ericson 2005, "Real-Time Collision Detection", 7.1) and
# by their bounding boxes.
@njit(cache=True)
def count_crossed(points, faces, bins, order, first, shape):
    """How many triangles pass through another without a common vertex.

    Bins are as wide as the longest side, so two triangles can only meet where their centres lie in
    the same bin or in neighbours. `order` lists triangles by bin, and `first` where each bin
    begins in it; three neighbours in a row are consecutive.
    """
    crossed = np.zeros(len(faces), np.bool_)
    # Bounding boxes.
    low, high = np.empty((len(faces), 3)), np.empty((len(faces), 3))
    for f in range(len(faces)):
        for k in range(3):
            a, b, c = points[faces[f, 0], k], points[faces[f, 1], k], points[faces[f, 2], k]
            low[f, k], high[f, k] = min(a, b, c), max(a, b, c)
    for f in range(len(faces)):
        for i in range(max(bins[f, 0] - 1, 0), min(bins[f, 0] + 2, shape[0])):
            for j in range(max(bins[f, 1] - 1, 0), min(bins[f, 1] + 2, shape[1])):
                row = (i * shape[1] + j) * shape[2]
                start = first[row + max(bins[f, 2] - 1, 0)]
                stop = first[row + min(bins[f, 2] + 1, shape[2] - 1) + 1]
                for other in order[start:stop]:
                    if other <= f or not _boxes_meet(low, high, f, other):
                        continue
                    # Only the number of triangles counts, not that of pairs.
                    if crossed[f] and crossed[other]:
                        continue
                    if _cross(points, faces[f], faces[other]):
                        crossed[f] = crossed[other] = True
    return crossed.sum()


@njit(cache=True)
def _boxes_meet(low, high, a, b):
    """Whether the bounding boxes of two triangles overlap."""
    apart = False
    for k in range(3):
        apart |= high[a, k] < low[b, k] or high[b, k] < low[a, k]
    return not apart


@njit(cache=True)
def _cross(points, a, b):
    """Whether two triangles without a common vertex pass through each other."""
    # Neighbours touch along their common side or corner, which is not an intersection.
    for i in range(3):
        for j in range(3):
            if a[i] == b[j]:
                return False
    for i in range(3):
        if _pierces(points, a[i], a[(i + 1) % 3], b) or _pierces(points, b[i], b[(i + 1) % 3], a):
            return True
    return False


# Two triangles intersect where a side of one pierces the other: its ends lie on two sides of the
# plane, and the line through them runs round the three edges in one direction. Both are signs of
# volumes of tetrahedra, so no division is needed.
@njit(cache=True)
def _pierces(points, start, end, face):
    """Whether the segment from `start` to `end` goes through the triangle `face`."""
    p, q = points[start], points[end]
    a, b, c = points[face[0]], points[face[1]], points[face[2]]
    # Both ends on the same side of the plane.
    if (_volume(a, b, c, p) > 0) == (_volume(a, b, c, q) > 0):
        return False
    # The line p-q passes all three edges on the same side where it runs through the triangle.
    side = _volume(p, q, a, b) > 0
    return (_volume(p, q, b, c) > 0) == side and (_volume(p, q, c, a) > 0) == side


@njit(cache=True)
def _volume(a, b, c, d):
    """Six times the signed volume of a tetrahedron."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx)
