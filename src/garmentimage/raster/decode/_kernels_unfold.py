"""Normal equations of unfolding, in compiled code."""

import numpy as np
from numba import njit


# Where the gradient of Eq. 2 (see `unfold`) is zero, (L + weight I) v = weight p + b. L is the
# graph Laplacian of the sides, b_i the sum of the vectors d that end in i less those that begin.
@njit(cache=True)
def normal_equations(start, end, wanted, positions, weight):
    """Lower band of the normal matrix of Eq. 2, and its right-hand side."""
    # Bandwidth: the farthest that two joined vertices are apart in the numbering.
    width = 0
    for k in range(len(start)):
        width = max(width, abs(start[k] - end[k]))
    count = len(positions)
    band = np.zeros((width + 1, count))
    rhs = weight * positions
    band[0] += weight
    for k in range(len(start)):
        i, j = start[k], end[k]
        # Each side adds (v_j - v_i - d)²: the Laplacian on the left, -+d on the right.
        band[0, i] += 1
        band[0, j] += 1
        band[abs(i - j), min(i, j)] -= 1
        for axis in range(2):
            rhs[i, axis] -= wanted[k, axis]
            rhs[j, axis] += wanted[k, axis]
    return band, rhs
