"""Compiled parts of polishing."""

import numpy as np
from numba import njit

from garmentimage.geometry import drop_first, push
from garmentimage.raster.encode.lattice._kernels_route import FAR, distance_field

NODE_PULL = 4.0
"""Energy of a node, per squared distance from its target [cells²]."""
STEP_COST = 0.05
"""Energy of one grid edge: between equals the shorter path wins."""
SHAPE_PULL = 0.8
"""Energy of missing grid edges, per missing edge squared."""
TOO_SHORT = 20.0
"""Energy of each grid edge that is missing to what the arc insists on."""
REACH = 3.0
"""How far a path may leave its target [cells], unless it already has."""
SWEEPS = 12
GAIN = 1e-6
MOST_STATES = 8
"""Path lengths that are told apart: 0 .. MOST_STATES - 1 grid edges or more."""


@njit(cache=True)
def _step(vertex, direction, width):
    if direction == 0:
        return vertex + 1
    if direction == 1:
        return vertex + width
    if direction == 2:
        return vertex - 1
    return vertex - width


@njit(cache=True)
def _direction(a, b, width):
    d = b - a
    if d == 1:
        return 0
    if d == width:
        return 1
    if d == -1:
        return 2
    return 3


@njit(cache=True)
def _energy(table, n, field, wish, pull, least):
    total = STEP_COST * (n - 1) + TOO_SHORT * max(least - (n - 1), 0)
    for k in range(1, n - 1):
        total += field[table[k]]
    missing = wish - (n - 1)
    if missing > 0:
        total += pull * missing * missing
    return total


@njit(cache=True)
def _allowed(vertex, width, low, high, axis, on_axis):
    x, y = vertex % width, vertex // width
    if x < low or x > high or y < low or y > high:
        return False
    if axis < 0:
        return True
    return x == axis if on_axis else x > axis


@njit(cache=True)
def _draw(
    start, goal, mask, on_axis, field, wish, pull, least, busy, width, low, high, axis, limit,
    work, out,
):  # fmt: skip
    """Cheapest free path from start to goal below `limit`; number of vertices, or 0.

    A state is a vertex and the path's length so far, so that a path may be long on purpose.
    """
    cost, previous, keys, items = work
    cost[:] = FAR
    size = 1
    keys[0], items[0] = 0.0, start * MOST_STATES
    cost[items[0]] = 0.0
    previous[items[0]] = -1
    best, best_state = limit, -1
    cap = MOST_STATES - 1
    while size > 0:
        key, state = keys[0], items[0]
        size = drop_first(keys, items, size)
        if key > cost[state] or key >= best:
            continue
        vertex, length = state // MOST_STATES, state % MOST_STATES
        for direction in range(4):
            other = _step(vertex, direction, width)
            longer = min(length + 1, cap)
            if other == goal:
                missing = wish - longer
                total = key + STEP_COST + (pull * missing * missing if missing > 0 else 0.0)
                total += TOO_SHORT * max(least - longer, 0)
                if total < best - GAIN:
                    best = total
                    best_state = state
                continue
            if not _allowed(other, width, low, high, axis, on_axis) or field[other] >= FAR:
                continue
            if (mask & 1 and busy[0, other]) or (mask & 2 and busy[1, other]) or other == start:
                continue
            total = key + STEP_COST + field[other]
            index = other * MOST_STATES + longer
            if total < cost[index] - 1e-12 and size < len(keys):
                cost[index] = total
                previous[index] = state
                size = push(keys, items, size, total, index)
    if best_state < 0:
        return 0, limit
    count, state = 1, best_state
    out[0] = goal
    while state >= 0:
        out[count] = state // MOST_STATES
        count += 1
        state = previous[state]
        if count >= len(out):
            return 0, limit
    for k in range(count // 2):
        out[k], out[count - 1 - k] = out[count - 1 - k], out[k]
    for k in range(count):
        for j in range(k):
            if out[j] == out[k]:
                return 0, limit
    return count, best


@njit(cache=True)
def _mark(table, n, mask, busy, value):
    for k in range(1, n - 1):
        if mask & 1:
            busy[0, table[k]] = value
        if mask & 2:
            busy[1, table[k]] = value


@njit(cache=True)
def _rotation(node, at, star, star_n, table, lens, tail, mask, width, out):
    """Arc ends round a node by direction: out[layer, direction] = arc * 2 + end, or -1."""
    out[:] = -1
    for q in range(star_n[node]):
        arc = star[node, q]
        first = tail[arc] == node
        other = table[arc, 1] if first else table[arc, lens[arc] - 2]
        d = _direction(at, other, width)
        for layer in range(2):
            if mask[arc] >> layer & 1:
                out[layer, d] = arc * 2 + (0 if first else 1)


@njit(cache=True)
def _same_cycle(a, b):
    for layer in range(2):
        n = 0
        first = np.empty(4, np.int64)
        second = np.empty(4, np.int64)
        m = 0
        for d in range(4):
            if a[layer, d] >= 0:
                first[n] = a[layer, d]
                n += 1
            if b[layer, d] >= 0:
                second[m] = b[layer, d]
                m += 1
        if n != m:
            return False
        if n == 0:
            continue
        shift = -1
        for k in range(n):
            if second[k] == first[0]:
                shift = k
        if shift < 0:
            return False
        for k in range(n):
            if second[(shift + k) % n] != first[k]:
                return False
    return True


@njit(cache=True)
def settle(
    table, lens, tail, head, mask, arc_on_axis, node_target, node_layers, node_on_axis, targets,
    starts, least, wish, weight, node_weight, width, low, high, axis,
):  # fmt: skip
    arcs, nodes, size = len(lens), len(node_target), width * width
    pull, node_pull = SHAPE_PULL * weight, NODE_PULL * node_weight
    fields = np.empty((arcs, size))
    grid = np.empty((width, width))
    for i in range(arcs):
        distance_field(targets[starts[i] : starts[i + 1]], 3.0 * width, grid)
        worst = REACH * REACH
        flat = grid.reshape(size)
        for k in range(lens[i]):
            worst = max(worst, flat[table[i, k]] + 1e-9)
        for v in range(size):
            fields[i, v] = weight[i] * flat[v] if flat[v] <= worst else FAR
    busy = np.zeros((2, size), np.bool_)
    where = np.full(nodes, -1, np.int64)
    degree = np.zeros(nodes, np.int64)
    for i in range(arcs):
        where[tail[i]], where[head[i]] = table[i, 0], table[i, lens[i] - 1]
        degree[tail[i]] += 1
        degree[head[i]] += 1
        _mark(table[i], lens[i], mask[i], busy, True)
    star = np.zeros((nodes, max(degree.max(), 1)), np.int64)
    star_n = np.zeros(nodes, np.int64)
    for i in range(arcs):
        for n in (tail[i], head[i]):
            star[n, star_n[n]] = i
            star_n[n] += 1
    for n in range(nodes):
        if where[n] >= 0:
            for layer in range(2):
                if node_layers[n] >> layer & 1:
                    busy[layer, where[n]] = True
    energy = np.empty(arcs)
    for i in range(arcs):
        energy[i] = _energy(table[i], lens[i], fields[i], wish[i], pull[i], least[i])
    work = (
        np.empty(size * MOST_STATES),
        np.empty(size * MOST_STATES, np.int64),
        np.empty(4 * size * MOST_STATES),
        np.empty(4 * size * MOST_STATES, np.int64),
    )
    room = table.shape[1]
    out = np.empty(room, np.int64)
    old = np.empty((star.shape[1], room), np.int64)
    old_n = np.empty(star.shape[1], np.int64)
    before = np.empty((2, 4), np.int64)
    after = np.empty((2, 4), np.int64)
    far_before = np.empty((star.shape[1], 2, 4), np.int64)
    for _ in range(SWEEPS):
        moved = False
        for i in range(arcs):
            _mark(table[i], lens[i], mask[i], busy, False)
            count, _ = _draw(
                table[i, 0], table[i, lens[i] - 1], mask[i], arc_on_axis[i], fields[i], wish[i],
                pull[i], least[i], busy, width, low, high, axis, energy[i] - GAIN, work, out,
            )  # fmt: skip
            if count:
                old[0, : lens[i]] = table[i, : lens[i]]
                keep_n = lens[i]
                good = True
                for n in (tail[i], head[i]):
                    _rotation(n, where[n], star, star_n, table, lens, tail, mask, width, before)
                    for k in range(count):
                        table[i, k] = out[k]
                    lens[i] = count
                    _rotation(n, where[n], star, star_n, table, lens, tail, mask, width, after)
                    good = good and _same_cycle(before, after)
                    for k in range(keep_n):
                        table[i, k] = old[0, k]
                    lens[i] = keep_n
                if good:
                    for k in range(count):
                        table[i, k] = out[k]
                    lens[i] = count
                    energy[i] = _energy(table[i], lens[i], fields[i], wish[i], pull[i], least[i])
                    moved = True
            _mark(table[i], lens[i], mask[i], busy, True)
        for n in range(nodes):
            if where[n] < 0:
                continue
            for direction in range(4):
                goal = _step(where[n], direction, width)
                if not _allowed(goal, width, low, high, axis, node_on_axis[n]):
                    continue
                gx, gy = goal % width, goal // width
                hx, hy = where[n] % width, where[n] // width
                tx, ty = node_target[n, 0], node_target[n, 1]
                delta = node_pull[n] * (
                    (gx - tx) ** 2 + (gy - ty) ** 2 - (hx - tx) ** 2 - (hy - ty) ** 2
                )
                total = 0.0
                for q in range(star_n[n]):
                    total += energy[star[n, q]]
                if delta >= total:
                    continue
                # Take the star out.
                here = where[n]
                _rotation(n, here, star, star_n, table, lens, tail, mask, width, before)
                for q in range(star_n[n]):
                    i = star[n, q]
                    far = head[i] if tail[i] == n else tail[i]
                    _rotation(
                        far, where[far], star, star_n, table, lens, tail, mask, width, far_before[q]
                    )
                for q in range(star_n[n]):
                    i = star[n, q]
                    old_n[q] = lens[i]
                    old[q, : lens[i]] = table[i, : lens[i]]
                    _mark(table[i], lens[i], mask[i], busy, False)
                for layer in range(2):
                    if node_layers[n] >> layer & 1:
                        busy[layer, here] = False
                free = not (
                    (node_layers[n] & 1 and busy[0, goal]) or (node_layers[n] & 2 and busy[1, goal])
                )
                good, spent = free, delta
                if free:
                    for layer in range(2):
                        if node_layers[n] >> layer & 1:
                            busy[layer, goal] = True
                    where[n] = goal
                done = 0
                if free:
                    for q in range(star_n[n]):
                        i = star[n, q]
                        a, b = where[tail[i]], where[head[i]]
                        count, _ = _draw(
                            a, b, mask[i], arc_on_axis[i], fields[i], wish[i], pull[i], least[i],
                            busy, width, low, high, axis, total - spent, work, out,
                        )  # fmt: skip
                        if count == 0:
                            good = False
                            break
                        for k in range(count):
                            table[i, k] = out[k]
                        lens[i] = count
                        _mark(table[i], lens[i], mask[i], busy, True)
                        done = q + 1
                        spent += _energy(table[i], lens[i], fields[i], wish[i], pull[i], least[i])
                        if spent >= total - GAIN:
                            good = False
                            break
                if good:
                    _rotation(n, goal, star, star_n, table, lens, tail, mask, width, after)
                    good = _same_cycle(before, after)
                    for q in range(star_n[n]):
                        if not good:
                            break
                        i = star[n, q]
                        far = head[i] if tail[i] == n else tail[i]
                        _rotation(
                            far, where[far], star, star_n, table, lens, tail, mask, width, after
                        )
                        good = _same_cycle(far_before[q], after)
                if good:
                    for q in range(star_n[n]):
                        i = star[n, q]
                        energy[i] = _energy(
                            table[i], lens[i], fields[i], wish[i], pull[i], least[i]
                        )
                    moved = True
                    continue
                # Put everything back.
                for q in range(done):
                    i = star[n, q]
                    _mark(table[i], lens[i], mask[i], busy, False)
                if free:
                    for layer in range(2):
                        if node_layers[n] >> layer & 1:
                            busy[layer, goal] = False
                where[n] = here
                for layer in range(2):
                    if node_layers[n] >> layer & 1:
                        busy[layer, here] = True
                for q in range(star_n[n]):
                    i = star[n, q]
                    table[i, : old_n[q]] = old[q, : old_n[q]]
                    lens[i] = old_n[q]
                for q in range(star_n[n]):
                    i = star[n, q]
                    _mark(table[i], lens[i], mask[i], busy, True)
        if not moved:
            break
