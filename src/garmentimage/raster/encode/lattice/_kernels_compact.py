"""Compiled parts of compaction: its variables, its constraints, and its solver.

`compact` states the quadratic program. The solver works on its dual: every constraint c has a
multiplier, a force f_c >= 0 that pushes its two variables apart, and

    x_v = t_v + (sum of forces that push v up - sum of those that push it down) / w_v .

One force after the other is set to what its constraint needs with the others as they are (Hildreth,
A quadratic programming procedure, 1957), until no variable moves by more than TOLERANCE.
"""

import numpy as np
from numba import njit

from garmentimage.geometry import find_root, union

MAX_SWEEPS = 400
TOLERANCE = 1e-4
"""Largest movement in the last sweep [lattice steps]."""


@njit(cache=True)
def merge(count, pairs):
    """[number] the smallest number of those that [pair, 2] make one with it, out of `count`."""
    parent = np.arange(count)
    for k in range(len(pairs)):
        union(parent, pairs[k, 0], pairs[k, 1])
    for i in range(count):
        parent[i] = find_root(parent, i)
    return parent


@njit(cache=True)
def neighbours(flat, lens, mask, layer_count, variable, along, width, height):
    """(u, v, steps) for neighbours on a lattice line; False if one variable meets itself there.

    Neighbours joined by a step of their arc may collapse (0 steps), others keep 1.

    Args:
        flat: [vertex, 2] the paths, one after the other, from 0 on.
        lens: [arc] vertices of each.
        mask: [arc] layers, as bits.
        layer_count: how many layers there are.
        variable: [vertex] its variable.
        along: the axis that is moved; lattice lines run along it.
        width: larger than any x.
        height: larger than any y.
    """
    other = 1 - along
    cells = width * height
    pairs = np.empty((layer_count * len(flat), 3), np.int64)
    n = 0
    owner = np.empty(cells, np.int64)
    # `move` marks vertices from which a step of a path leads on along the line.
    move = np.empty(cells, np.bool_)
    length = width if along == 0 else height
    # Every layer is painted with its variables; then each line is read from low to high.
    for layer in range(layer_count):
        owner[:] = -1
        move[:] = False
        at = 0
        for i in range(len(lens)):
            if mask[i] >> layer & 1:
                for k in range(lens[i]):
                    v = at + k
                    line = flat[v, other] * length
                    owner[line + flat[v, along]] = variable[v]
                    if k and flat[v, other] == flat[v - 1, other]:
                        move[line + min(flat[v, along], flat[v - 1, along])] = True
            at += lens[i]
        for line in range(cells // length):
            last = -1
            for c in range(line * length, (line + 1) * length):
                if owner[c] < 0:
                    continue
                if last >= 0:
                    joined = c == last + 1 and move[last]
                    if owner[last] != owner[c]:
                        pairs[n, 0], pairs[n, 1] = owner[last], owner[c]
                        pairs[n, 2] = 0 if joined else 1
                        n += 1
                    # A variable twice on one line without a step between: two paths, or one twice,
                    # touch there and cannot be kept apart.
                    elif not joined:
                        return pairs[:0], False
                last = c
    return pairs[:n], True


@njit(cache=True)
def project(target, weight, rows, stiff, low, high):
    """Nearest point to `target` under x_v - x_u >= s and limits (dual coordinate ascent).

    Args:
        target: [variable] t.
        weight: [variable] w.
        rows: [row, 3] (u, v, s).
        stiff: [row] 0 for a hard row, else it is a spring of that stiffness that only pushes.
        low: [variable] lower limit.
        high: [variable] upper limit.
    """
    x = target.copy()
    inverse = 1.0 / weight
    m, n = len(rows), len(x)
    lower, upper = rows[:, 0].astype(np.int64), rows[:, 1].astype(np.int64)
    # The multipliers of rows, of lower limits and of upper limits.
    force = np.zeros(m)
    floor_force = np.zeros(n)
    roof_force = np.zeros(n)
    for _ in range(MAX_SWEEPS):
        worst = 0.0
        for c in range(m):
            u, v = lower[c], upper[c]
            need = rows[c, 2] - (x[v] - x[u])
            # Most rows neither push nor need to: nothing to divide.
            if need <= 0.0 and force[c] == 0.0:
                continue
            give = inverse[u] + inverse[v]
            if stiff[c] > 0:
                # A spring yields by force / stiffness, so it needs less force.
                need -= force[c] / stiff[c]
                give += 1.0 / stiff[c]
            # A force may fall, but not below 0: constraints only push.
            step = max(need / give, -force[c])
            # A force moves both ends, each by as much as it is light.
            if step != 0.0:
                force[c] += step
                x[v] += step * inverse[v]
                x[u] -= step * inverse[u]
                worst = max(worst, abs(step) * max(inverse[u], inverse[v]))
        # Limits are rows with one end; each variable has one of either kind.
        for v in range(n):
            step = max((low[v] - x[v]) * weight[v], -floor_force[v])
            if step != 0.0:
                floor_force[v] += step
                x[v] += step * inverse[v]
                worst = max(worst, abs(step) * inverse[v])
            step = max((x[v] - high[v]) * weight[v], -roof_force[v])
            if step != 0.0:
                roof_force[v] += step
                x[v] -= step * inverse[v]
                worst = max(worst, abs(step) * inverse[v])
        if worst < TOLERANCE:
            break
    return x


@njit(cache=True)
def pushed_up(x, rows):
    """Coordinates raised as far as [row, 3] (u, v, s) need, in one sweep in their order."""
    x = x.copy()
    for c in range(len(rows)):
        u, v = int(rows[c, 0]), int(rows[c, 1])
        x[v] = max(x[v], x[u] + rows[c, 2])
    return x


@njit(cache=True)
def pushed_down(x, rows):
    """Coordinates lowered as far as [row, 3] (u, v, s) need, in one sweep in their order."""
    x = x.copy()
    for c in range(len(rows)):
        u, v = int(rows[c, 0]), int(rows[c, 1])
        x[u] = min(x[u], x[v] - rows[c, 2])
    return x
