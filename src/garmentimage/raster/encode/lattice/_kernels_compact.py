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
def number_variables(flat, lens, tail, head, nodes, along):
    """A variable per run of vertices that share their coordinate; a node has one for all arcs.

    Args:
        flat: [vertex, 2] the paths, one after the other.
        lens: [arc] vertices of each.
        tail: [arc] node at the start.
        head: [arc] node at the end.
        nodes: how many there are.
        along: the axis that is moved.

    Returns:
        [vertex] numbers of variables, not consecutive.
    """
    other = 1 - along
    out = np.empty(len(flat), np.int64)
    # Numbers below `nodes` are those of nodes, the others those of vertices.
    parent = np.arange(nodes + len(flat))
    at = 0
    for i in range(len(lens)):
        out[at] = tail[i]
        for k in range(1, lens[i]):
            is_across = flat[at + k, other] != flat[at + k - 1, other]
            if k == lens[i] - 1:
                out[at + k] = head[i]
                # A last step across puts the vertex before the node on the line of the node.
                if is_across:
                    union(parent, head[i], out[at + k - 1])
            else:
                # A step across the axis keeps the coordinate, and with it the variable.
                out[at + k] = out[at + k - 1] if is_across else nodes + at + k
        at += lens[i]
    for v in range(len(flat)):
        out[v] = find_root(parent, out[v])
    return out


@njit(cache=True)
def neighbours(flat, lens, mask, variable, along, width, height):
    """(u, v, steps) for neighbours on a lattice line; False if one variable meets itself there.

    Neighbours joined by a step of their arc may collapse (0 steps), others keep 1.

    Args:
        flat: [vertex, 2] the paths, one after the other, from 0 on.
        lens: [arc] vertices of each.
        mask: [arc] layers, as bits.
        variable: [vertex] its variable.
        along: the axis that is moved; lattice lines run along it.
        width: larger than any x.
        height: larger than any y.
    """
    other = 1 - along
    cells = width * height
    pairs = np.empty((2 * len(flat), 3), np.int64)
    n = 0
    owner = np.empty(cells, np.int64)
    # `move` marks vertices from which a step of a path leads on along the line.
    move = np.empty(cells, np.bool_)
    length = width if along == 0 else height
    # Every layer is painted with its variables; then each line is read from low to high.
    for layer in range(2):
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
def _project(target, weight, cons, stiff, low, high):
    """Nearest point to `target` under X_v - X_u >= s and limits (dual coordinate ascent).

    Args:
        target: [variable] t.
        weight: [variable] w.
        cons: [row, 3] (u, v, s).
        stiff: [row] 0 for a hard row, else it is a spring of that stiffness that only pushes.
        low: [variable] lower limit.
        high: [variable] upper limit.
    """
    x = target.copy()
    inverse = 1.0 / weight
    m, n = len(cons), len(x)
    # The multipliers of rows, of lower limits and of upper limits.
    force = np.zeros(m)
    floor_force = np.zeros(n)
    roof_force = np.zeros(n)
    for _ in range(MAX_SWEEPS):
        worst = 0.0
        for c in range(m):
            u, v = int(cons[c, 0]), int(cons[c, 1])
            give = inverse[u] + inverse[v]
            need = cons[c, 2] - (x[v] - x[u])
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
def solve_integers(rows, stiff, ahead, back, target, weight, floor, roof):
    """Integers nearest to the target that keep every hard row, and whether they do.

    They are sound only if they keep every hard row and lie between floor and roof, so that what is
    drawn with them is inside the grid; for a target that is NaN they never are.

    Args:
        rows: [row, 3] (u, v, s).
        stiff: [row] 0 for a hard row, else the stiffness of a spring.
        ahead: [row] order of the rows by the place of u, rising.
        back: [row] order of the rows by the place of v, falling.
        target: [variable] wanted coordinates.
        weight: [variable] above 0.
        floor: [variable] lower limit.
        roof: [variable] upper limit.
    """
    # Tight limits first: without room there is nothing to solve.
    low, high = _tightened(rows, stiff, ahead, back, floor, roof)
    out = np.zeros(len(target), np.int64)
    if (low > high).any():
        return out, False
    x = _project(target, weight, rows[ahead], stiff[ahead], low, high)
    _round(x, rows, stiff, ahead, back, low, high)
    for v in range(len(target)):
        if not low[v] <= x[v] <= high[v]:
            return out, False
        out[v] = int(x[v])
    return out, _keeps_all(out, rows, stiff)


@njit(cache=True)
def _tightened(rows, stiff, ahead, back, floor, roof):
    """Limits of all variables: the longest paths through hard rows, from below and from above."""
    low, high = floor.copy(), roof.copy()
    for c in ahead:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            low[v] = max(low[v], low[u] + rows[c, 2])
    for c in back:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            high[u] = min(high[u], high[v] - rows[c, 2])
    return low, high


@njit(cache=True)
def _round(x, rows, stiff, ahead, back, low, high):
    """Round coordinates, in place, to integers that keep the hard rows."""
    for v in range(len(x)):
        x[v] = min(max(np.floor(x[v] + 0.5), low[v]), high[v])
    # Coordinate ascent stops a hair early; these passes make the integers exact.
    for c in ahead:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            x[v] = max(x[v], x[u] + rows[c, 2])
    for c in back:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            x[u] = min(x[u], x[v] - rows[c, 2])


@njit(cache=True)
def _keeps_all(x, rows, stiff):
    """Whether integers keep every hard row."""
    for c in range(len(rows)):
        if stiff[c] == 0 and x[int(rows[c, 1])] - x[int(rows[c, 0])] < rows[c, 2]:
            return False
    return True
