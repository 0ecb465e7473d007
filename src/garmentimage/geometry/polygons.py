"""Polygons as arrays of points, not closed."""

import numpy as np
from jaxtyping import Float


def signed_area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Area of the polygon; positive when it runs counter-clockwise."""
    # Seen from its first point, so that a far-off polygon keeps its area; the last term is then 0.
    x, y = (polygon - polygon[0]).T
    return 0.5 * float((x[:-1] * y[1:] - y[:-1] * x[1:]).sum())


def centroid(polygon: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " 2"]:
    """Centre of area; the mean of the points where the area vanishes."""
    x, y = polygon[:, 0], polygon[:, 1]
    next_x, next_y = np.concatenate([polygon[1:], polygon[:1]]).T
    cross = x * next_y - y * next_x
    area = cross.sum() / 2
    if abs(area) < 1e-9:
        return np.asarray(polygon.mean(axis=0))
    centre = np.array([((x + next_x) * cross).sum(), ((y + next_y) * cross).sum()])
    centre /= 6 * area
    return centre


def polyline_length(points: Float[np.ndarray, "n 2"]) -> float:
    """Length of an open polyline."""
    return float(np.hypot(*(points[1:] - points[:-1]).T).sum())


def lengths_along(points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
    """Length of an open polyline up to each of its points."""
    lengths = np.zeros(len(points))
    np.hypot(*(points[1:] - points[:-1]).T).cumsum(out=lengths[1:])
    return lengths


def resample(points: Float[np.ndarray, "n 2"], shares: Float[np.ndarray, " m"]) -> np.ndarray:
    """Points of an open polyline at the given shares (0..1) of its length; shape (m, 2)."""
    found = np.empty((len(shares), 2))
    if len(points) == 2:
        at = np.asarray(shares)[:, None]
        found[:] = (1 - at) * points[0] + at * points[1]
        return found
    lengths = lengths_along(points)
    s = np.asarray(shares) * lengths[-1]
    found[:, 0] = np.interp(s, lengths, points[:, 0])
    found[:, 1] = np.interp(s, lengths, points[:, 1])
    return found
