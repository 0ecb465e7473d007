"""Where closed polygons touch or cross themselves and each other."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int
from numba import njit

_PAIR_LIMIT = 256
_FOLD_TOL = 1e-9


def touching_sides(polygons: Sequence[Float[np.ndarray, "_ 2"]]) -> Int[np.ndarray, "pair 2"]:
    """Pairs of sides that have a point in common and are not neighbours in one polygon.

    Neighbours count where one folds back onto the other. At most 256 pairs are given.

    Args:
        polygons: points, not closed; side k of a polygon runs from point k to the next.

    Returns:
        Side numbers, counted through all polygons; the first of a pair is the smaller.
    """
    points = np.concatenate(list(polygons))
    onward = np.arange(1, len(points) + 1)
    ends = np.cumsum([len(p) for p in polygons])
    onward[ends - 1] = ends - [len(p) for p in polygons]
    return _touching(points, onward)


def contains(polygon: Float[np.ndarray, "n 2"], point: Float[np.ndarray, " 2"]) -> bool:
    """Whether the point lies inside the polygon (even-odd)."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((x > point[0]).sum() % 2)


@njit(cache=True)
def _touching(points, onward):  # type: ignore[no-untyped-def]
    pairs = np.empty((_PAIR_LIMIT, 2), np.int64)
    found = 0
    count = len(points)
    for i in range(count):
        ax, ay = points[i]
        bx, by = points[onward[i]]
        low_x, high_x = min(ax, bx), max(ax, bx)
        low_y, high_y = min(ay, by), max(ay, by)
        for j in range(i + 1, count):
            cx, cy = points[j]
            dx, dy = points[onward[j]]
            if max(cx, dx) < low_x or min(cx, dx) > high_x:
                continue
            if max(cy, dy) < low_y or min(cy, dy) > high_y:
                continue
            if onward[i] == j or onward[j] == i:
                ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
                along = ux * vx + uy * vy
                touching = along < 0 and abs(ux * vy - uy * vx) < -_FOLD_TOL * along
            else:
                s1 = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
                s2 = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
                s3 = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
                s4 = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
                touching = s1 * s2 <= 0 and s3 * s4 <= 0
            if touching:
                pairs[found] = i, j
                found += 1
                if found == _PAIR_LIMIT:
                    return pairs
    return pairs[:found].copy()
