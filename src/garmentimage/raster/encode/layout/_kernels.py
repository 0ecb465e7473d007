"""Compiled parts of relaxation: the energy of all panels, and the load of rotated rest shapes.

With rest positions u, a pair (i, j) of samples of one panel, whose stiffness is k, costs

    k w_ij |(x_i - x_j) - (u_i - u_j)|²,
    w_ij = SPREAD s_i s_j / (|u_i - u_j|² + NEAR²)  +  1 / h  for neighbours a step h apart,

where s is the boundary length of a sample; a sample alone costs ANCHOR s_i |x_i - u_i|². Samples
round all panels are rows, one after the other; `ids` gives the unknown that each stands for, which
rows of sewn panels share. Sums run in the order of rows, so that results have the same bits.
"""

import numpy as np
from numba import njit

SPREAD = 0.2
"""Strength of pairs across a panel against that of neighbours."""
NEAR = 1.0
"""Pairs nearer than about this are no stiffer [cm]."""
MIN_STEP = 0.2
"""Neighbours closer together than this [cm] are no stiffer than at it."""


@njit(cache=True)
def _sample_lengths(following, rest):
    """Step to the next sample, and the boundary length that each sample stands for."""
    size = len(following)
    step, length = np.empty(size), np.zeros(size)
    for i in range(size):
        j = following[i]
        # Never 0, so that every sample has a weight.
        step[i] = np.hypot(rest[j, 0] - rest[i, 0], rest[j, 1] - rest[i, 1]) + 1e-6
        length[i] += step[i] / 2
        length[j] += step[i] / 2
    return step, length


@njit(cache=True)
def _pair_weight(i, j, following, rest, step, length):
    """w_ij of the file's head, before the stiffness of the panel."""
    dx, dy = rest[i, 0] - rest[j, 0], rest[i, 1] - rest[j, 1]
    weight = SPREAD * length[i] * length[j] / (dx * dx + dy * dy + NEAR * NEAR)
    # Neighbours are also joined by the boundary between them, which stretches like a spring.
    if following[i] == j:
        weight += 1 / max(step[i], MIN_STEP)
    if following[j] == i:
        weight += 1 / max(step[j], MIN_STEP)
    return weight


@njit(cache=True)
def assemble_energy(
    matrix, load, anchor_load, ids, following, start, rest, stiffness, anchor, soft
):
    """Add every panel's energy x·A x - 2 b·x to A and b.

    Args:
        matrix: [sample, sample] A, added to.
        load: [sample, 2] the part of b that keeps shapes, added to.
        anchor_load: [sample, 2] the part of b that keeps places, added to.
        ids: [row] its sample.
        following: [row] the next row of its loop.
        start: [panel + 1] where the rows of each panel begin, and the end.
        rest: [row, 2] rest positions [cm].
        stiffness: [panel] factor of its pairs.
        anchor: [panel] factor of its samples alone.
        soft: [panel] a membrane: pairs are drawn together, whatever their distance at rest.
    """
    step, length = _sample_lengths(following, rest)
    for p in range(len(start) - 1):
        for i in range(start[p], start[p + 1]):
            # The sample alone, tied to its place ...
            a = ids[i]
            pull = anchor[p] * length[i]
            matrix[a, a] += pull
            anchor_load[a, 0] += pull * rest[i, 0]
            anchor_load[a, 1] += pull * rest[i, 1]
            # ... and every pair once.
            for j in range(start[p], i):
                c = ids[j]
                if a == c:  # Both legs of a dart meet in its tip.
                    continue
                w = stiffness[p] * _pair_weight(i, j, following, rest, step, length)
                matrix[a, a] += w
                matrix[c, c] += w
                matrix[a, c] -= w
                matrix[c, a] -= w
                # A membrane has no shape to keep: its pairs are drawn together.
                if not soft[p]:
                    for axis in range(2):
                        pull_apart = w * (rest[i, axis] - rest[j, axis])
                        load[a, axis] += pull_apart
                        load[c, axis] -= pull_apart


@njit(cache=True)
def rotated_load(points, ids, following, start, rest, stiffness):
    """Load of an as-rigid-as-possible step: rest shapes rotated as the points are now.

    Source: Sorkine and Alexa, As-Rigid-As-Possible Surface Modeling, 2007 (Eqs. 6 and 9); here the
    neighbourhood of a sample is its whole panel, with the weights of the energy. In the plane the
    rotation R_i that minimises the sum over j of w_ij |(x_i - x_j) - R (u_i - u_j)|² has the
    direction (sum w x·u, sum w x×u), so that no singular value decomposition is needed.

    Returns the [sample, 2] load in place of that of `assemble_energy`, for `points` [sample, 2],
    where the samples are now [cm]; the other arguments are as there.
    """
    step, length = _sample_lengths(following, rest)
    load = np.zeros_like(points)
    size = len(ids)
    cos, sin = np.ones(size), np.zeros(size)
    for p in range(len(start) - 1):
        # The rotation of each sample ...
        for i in range(start[p], start[p + 1]):
            along, across = 0.0, 0.0
            for j in range(start[p], start[p + 1]):
                if i == j:
                    continue
                w = _pair_weight(i, j, following, rest, step, length)
                ux, uy = rest[i, 0] - rest[j, 0], rest[i, 1] - rest[j, 1]
                x = points[ids[i], 0] - points[ids[j], 0]
                y = points[ids[i], 1] - points[ids[j], 1]
                along += w * (x * ux + y * uy)
                across += w * (y * ux - x * uy)
            norm = np.hypot(along, across)
            # Points that coincide have no direction: they are not rotated.
            if norm > 0:
                cos[i], sin[i] = along / norm, across / norm
        # ... and the mean of two of them turns what lies between them at rest.
        for i in range(start[p], start[p + 1]):
            for j in range(start[p], i):
                if ids[i] == ids[j]:
                    continue
                w = stiffness[p] * _pair_weight(i, j, following, rest, step, length)
                c, s = (cos[i] + cos[j]) / 2, (sin[i] + sin[j]) / 2
                ux, uy = rest[i, 0] - rest[j, 0], rest[i, 1] - rest[j, 1]
                load[ids[i], 0] += w * (c * ux - s * uy)
                load[ids[i], 1] += w * (s * ux + c * uy)
                load[ids[j], 0] -= w * (c * ux - s * uy)
                load[ids[j], 1] -= w * (s * ux + c * uy)
    return load
