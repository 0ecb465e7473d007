"""Where closed polygons touch or cross themselves and each other."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from garmentimage.geometry._kernels_crossings import find_touching_sides


def touching_sides(polygons: Sequence[Float[np.ndarray, "_ 2"]]) -> Int[np.ndarray, "pair 2"]:
    """Pairs of sides that have a point in common and are not neighbours in one polygon.

    Neighbours count where one folds back onto the other. At most 256 pairs are given.

    Args:
        polygons: points, not closed; side k of a polygon runs from point k to the next.

    Returns:
        Side numbers, counted through all polygons; the first of a pair is the smaller.
    """
    assert all(p.ndim == 2 and p.shape[1] == 2 for p in polygons)
    sizes = np.array([len(p) for p in polygons])
    return np.asarray(find_touching_sides(np.concatenate(list(polygons)), sizes))


def contains(polygon: Float[np.ndarray, "n 2"], point: Float[np.ndarray, " 2"]) -> bool:
    """Whether the point lies inside the polygon (even-odd)."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((x > point[0]).sum() % 2)
