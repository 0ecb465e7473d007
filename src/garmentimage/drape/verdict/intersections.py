"""Where cloth passes through cloth."""

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.verdict._kernels import count_crossed

MAX_BINS = 128  # bins along the longest extent of the cloth


def crossing_count(points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]) -> int:
    """How many triangles pass through another that has no vertex in common with them."""
    assert np.isfinite(points).all() and 0 <= faces.min() <= faces.max() < len(points)
    low, high = points.min(axis=0), points.max(axis=0)
    longest = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2).max()
    size = max(float(longest), float((high - low).max()) / MAX_BINS, 1e-6)
    shape = np.floor((high - low) / size).astype(np.int64) + 1
    bins = np.floor((points[faces].mean(axis=1) - low) / size).astype(np.int64)
    key = (bins[:, 0] * shape[1] + bins[:, 1]) * shape[2] + bins[:, 2]
    order = np.argsort(key, kind="stable")
    first = np.searchsorted(key[order], np.arange(int(shape.prod()) + 1))
    return int(count_crossed(points, faces.astype(np.int64), bins, order, first, shape))
