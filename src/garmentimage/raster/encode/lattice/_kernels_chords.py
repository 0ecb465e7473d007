"""Compiled: what evenly spread chords lose of a curve's length, and of the area beside it."""

import numpy as np
from numba import njit


@njit(cache=True)
def chord_loss_kernel(curve, count):
    """`chord_loss` of a curve of three points or more, one chord or more.

    The area between curve and chords is the difference of two sums of cross products about the
    curve's first point (the shoelace formula).
    """
    # Length along the curve, up to every point.
    last = len(curve) - 1
    along = np.zeros(last + 1)
    for k in range(last):
        step = np.hypot(curve[k + 1, 0] - curve[k, 0], curve[k + 1, 1] - curve[k, 1])
        along[k + 1] = along[k] + step
    # Twice the area that the curve sweeps about its first point ...
    x0, y0 = curve[0, 0], curve[0, 1]
    area = 0.0
    for k in range(last):
        ax, ay = curve[k, 0] - x0, curve[k, 1] - y0
        bx, by = curve[k + 1, 0] - x0, curve[k + 1, 1] - y0
        area += ax * by - ay * bx
    # ... less what the chords sweep, whose ends lie at even shares of the length.
    kept, k = 0.0, 0
    px, py = 0.0, 0.0
    for j in range(1, count + 1):
        target = along[last] * j / count
        while k < last - 1 and along[k + 1] < target:
            k += 1
        step = along[k + 1] - along[k]
        share = min((target - along[k]) / step, 1.0) if step > 0.0 else 1.0
        qx = curve[k, 0] + share * (curve[k + 1, 0] - curve[k, 0]) - x0
        qy = curve[k, 1] + share * (curve[k + 1, 1] - curve[k, 1]) - y0
        kept += np.hypot(qx - px, qy - py)
        area -= px * qy - py * qx
        px, py = qx, qy
    return along[last] - kept, abs(area) / 2
