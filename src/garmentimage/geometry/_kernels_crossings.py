"""Pairs of polygon sides that touch, in compiled code."""

import numpy as np
from numba import njit

MAX_PAIRS = 256
_FOLD_TOL = 1e-9


# All pairs of sides are compared, n² of them, but for nearly all the boxes round them decide. Two
# sides (a, b) and (c, d) share a point where the signed areas of abc and abd, and those of cda and
# cdb, have not the same sign (O'Rourke 1998, Computational Geometry in C, Section 1.5).
@njit(cache=True)
def find_touching_sides(points, sizes):
    count = len(points)
    onward = np.arange(1, count + 1)
    end = 0
    for size in sizes:
        end += size
        onward[end - 1] = end - size
    low, high = np.empty((count, 2)), np.empty((count, 2))
    for i in range(count):
        for axis in range(2):
            low[i, axis] = min(points[i, axis], points[onward[i], axis])
            high[i, axis] = max(points[i, axis], points[onward[i], axis])
    pairs = np.empty((MAX_PAIRS, 2), np.int64)
    found = 0
    for i in range(count):
        ax, ay = points[i]
        bx, by = points[onward[i]]
        for j in range(i + 1, count):
            if low[j, 0] > high[i, 0] or high[j, 0] < low[i, 0]:
                continue
            if low[j, 1] > high[i, 1] or high[j, 1] < low[i, 1]:
                continue
            cx, cy = points[j]
            dx, dy = points[onward[j]]
            if onward[i] == j or onward[j] == i:
                # Neighbours share a point; they fold back where antiparallel (cross against dot).
                ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
                along = ux * vx + uy * vy
                touching = along < 0 and abs(ux * vy - uy * vx) < -_FOLD_TOL * along
            else:
                # Each side has both ends of the other on different sides of it, or on itself.
                s1 = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
                s2 = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
                s3 = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
                s4 = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
                touching = s1 * s2 <= 0 and s3 * s4 <= 0
            if touching:
                pairs[found] = i, j
                found += 1
                if found == MAX_PAIRS:
                    return pairs
    return pairs[:found].copy()
