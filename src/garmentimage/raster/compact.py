"""Compaction: the fine drawing moves to the image's lattice, one axis at a time.

Along every lattice line the order of what lies on it is kept and different arcs stay at least one
step apart, so arcs stay vertex-disjoint; successive steps of one arc may collapse. The new
coordinates are those nearest to the wanted ones (least squares over difference constraints,
solved for its multipliers by coordinate ascent), rounded: rounding every number at the same
threshold keeps integer difference constraints true, and keeps a small change small.
"""

import numpy as np
from numba import njit

from garmentimage.raster.drawing import Drawing, Path

NODE_WEIGHT = 4.0
"""Weight of a node's own wish against one cell of path."""
SHAPE_WEIGHT = 6.0
"""Stiffness with which an arc asks for the grid edges that its curve needs."""
SWEEPS = 4000
TOLERANCE = 1e-4
BIG = 1 << 20


def compact(
    drawing: Drawing,
    paths: list[Path],
    wanted: list[np.ndarray],
    along: int,
    low: int,
    high: int,
    *,
    bounded: bool = True,
) -> tuple[list[Path], list[np.ndarray]] | None:
    """New integer coordinates along one axis for every vertex of every path.

    Args:
        drawing: the graph.
        paths: vertex-disjoint lattice paths (fine or coarse along either axis).
        wanted: target of each path vertex, in coarse lattice coordinates.
        along: 0 to move x, 1 to move y.
        low: smallest coordinate allowed.
        high: largest coordinate allowed.
        bounded: whether the limits hold.

    Returns:
        Paths and wishes after the move, or None when there is no room between the limits.
    """
    lens = np.array([len(p) for p in paths])
    flat = np.concatenate(paths)
    base = flat.min(axis=0)
    size = flat.max(axis=0) - base + 1
    axis = -1 if drawing.axis is None or along == 1 else drawing.axis
    status, new = _compact(
        flat - base,
        np.concatenate(wanted)[:, along],
        lens,
        drawing.tail,
        drawing.head,
        drawing.layers,
        drawing.node_on_axis,
        drawing.on_axis,
        drawing.least,
        drawing.wish,
        np.array([np.hypot(*np.diff(c, axis=0).T).sum() for c in drawing.curves]) / lens,
        drawing.node_target[:, along],
        along,
        int(size[0]),
        int(size[1]),
        low if bounded else -BIG,
        high if bounded else BIG,
        axis,
    )
    if not status:
        return None
    out_paths, out_wanted = [], []
    at = 0
    for path, wish in zip(paths, wanted):
        moved, count, w = _stretch(path, new[at : at + len(path)], wish, along)
        out_paths.append(moved[:count])
        out_wanted.append(w[:count])
        at += len(path)
    return out_paths, out_wanted


@njit(cache=True)
def _stretch(path, new, wish, along):  # type: ignore[no-untyped-def]
    """The path with new coordinates: collapsed steps dropped, long steps filled."""
    total = 1
    for k in range(1, len(path)):
        total += max(abs(new[k] - new[k - 1]), 1)
    out = np.empty((total, 2), np.int64)
    w = np.empty((total, 2))
    other = 1 - along
    out[0, along], out[0, other] = new[0], path[0, other]
    w[0] = wish[0]
    count = 1
    for k in range(1, len(path)):
        if path[k, other] != path[k - 1, other]:
            out[count, along], out[count, other] = new[k], path[k, other]
            w[count] = wish[k]
            count += 1
            continue
        steps = abs(new[k] - new[k - 1])
        sign = 1 if new[k] > new[k - 1] else -1
        for s in range(1, steps + 1):
            out[count, along], out[count, other] = new[k - 1] + sign * s, path[k, other]
            w[count] = wish[k - 1] + (wish[k] - wish[k - 1]) * (s / steps)
            count += 1
        if steps == 0 and k == len(path) - 1:
            w[count - 1] = wish[k]
    return out, count, w


@njit(cache=True)
def _root(parent, i):  # type: ignore[no-untyped-def]
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True)
def _variables(flat, lens, tail, head, nodes, along):  # type: ignore[no-untyped-def]
    """A variable per run of vertices that share their coordinate; a node has one for all arcs."""
    other = 1 - along
    var = np.empty(len(flat), np.int64)
    parent = np.arange(nodes + len(flat))
    at = 0
    for i in range(len(lens)):
        var[at] = tail[i]
        for k in range(1, lens[i]):
            if k == lens[i] - 1:
                var[at + k] = head[i]
                if flat[at + k, other] != flat[at + k - 1, other]:
                    a, b = _root(parent, head[i]), _root(parent, var[at + k - 1])
                    parent[max(a, b)] = min(a, b)
            elif flat[at + k, other] != flat[at + k - 1, other]:
                var[at + k] = var[at + k - 1]
            else:
                var[at + k] = nodes + at + k
        at += lens[i]
    number = np.full(len(parent), -1, np.int64)
    count = 0
    for v in range(len(flat)):
        r = _root(parent, var[v])
        if number[r] < 0:
            number[r] = count
            count += 1
        var[v] = number[r]
    node_var = np.full(nodes, -1, np.int64)
    at = 0
    for i in range(len(lens)):
        node_var[tail[i]] = var[at]
        node_var[head[i]] = var[at + lens[i] - 1]
        at += lens[i]
    return var, node_var, count


@njit(cache=True)
def _constraints(flat, lens, mask, var, along, width, height):  # type: ignore[no-untyped-def]
    """Order along every line: rows (u, v, s) for X_v - X_u >= s, sorted, the strongest of equals."""
    other = 1 - along
    cells = width * height
    pairs = np.empty((2 * len(flat), 3), np.int64)
    n = 0
    owner = np.empty(cells, np.int64)
    move = np.empty(cells, np.bool_)
    length = width if along == 0 else height
    for layer in range(2):
        owner[:] = -1
        move[:] = False
        at = 0
        for i in range(len(lens)):
            if mask[i] >> layer & 1:
                for k in range(lens[i]):
                    v = at + k
                    cell = flat[v, other] * length + flat[v, along]
                    owner[cell] = var[v]
                    if k and flat[v, other] == flat[v - 1, other]:
                        move[flat[v, other] * length + min(flat[v, along], flat[v - 1, along])] = (
                            True
                        )
            at += lens[i]
        for line in range(cells // length):
            last = -1
            for c in range(line * length, (line + 1) * length):
                if owner[c] < 0:
                    continue
                if last >= 0 and owner[last] != owner[c]:
                    step = 0 if c == last + 1 and move[last] else 1
                    pairs[n, 0], pairs[n, 1], pairs[n, 2] = owner[last], owner[c], step
                    n += 1
                elif last >= 0 and not (c == last + 1 and move[last]):
                    return pairs[:0], False
                last = c
    if n == 0:
        return pairs[:0], True
    key = (pairs[:n, 0] * (len(flat) + 1) + pairs[:n, 1]) * 2 + (1 - pairs[:n, 2])
    order = np.argsort(key)
    keep = np.empty((n, 3), np.int64)
    m = 0
    for q in order:
        if m and keep[m - 1, 0] == pairs[q, 0] and keep[m - 1, 1] == pairs[q, 1]:
            continue
        keep[m] = pairs[q]
        m += 1
    return keep[:m], True


@njit(cache=True)
def _project(target, weight, cons, stiff, low, high, sweeps, tolerance):  # type: ignore[no-untyped-def]
    """Nearest point to `target` under X_v - X_u >= s and limits (dual coordinate ascent).

    `stiff` 0 marks a hard row; else the row is a spring of that stiffness that only pushes.
    """
    x = target.copy()
    inverse = 1.0 / weight
    m, n = len(cons), len(x)
    force = np.zeros(m)
    floor_force = np.zeros(n)
    roof_force = np.zeros(n)
    for sweep in range(sweeps):
        worst = 0.0
        for c in range(m):
            u, v = int(cons[c, 0]), int(cons[c, 1])
            give = inverse[u] + inverse[v]
            need = cons[c, 2] - (x[v] - x[u])
            if stiff[c] > 0:
                need -= force[c] / stiff[c]
                give += 1.0 / stiff[c]
            step = max(need / give, -force[c])
            if step != 0.0:
                force[c] += step
                x[v] += step * inverse[v]
                x[u] -= step * inverse[u]
                worst = max(worst, abs(step) * max(inverse[u], inverse[v]))
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
        if worst < tolerance:
            break
    return x


@njit(cache=True)
def _compact(  # type: ignore[no-untyped-def]
    flat, wanted, lens, tail, head, mask, node_on_axis, arc_on_axis, least, wish, load, node_target,
    along, width, height, low, high, axis,
):  # fmt: skip
    nodes = len(node_on_axis)
    var, node_var, count = _variables(flat, lens, tail, head, nodes, along)
    new = np.zeros(len(flat), np.int64)
    hard, sound = _constraints(flat, lens, mask, var, along, width, height)
    if not sound:
        return False, new
    arcs = len(lens)
    place = np.zeros(count, np.int64)
    target = np.zeros(count)
    weight = np.zeros(count)
    at = 0
    for i in range(arcs):
        for k in range(lens[i]):
            place[var[at + k]] = flat[at + k, along]
            if 0 < k < lens[i] - 1:
                target[var[at + k]] += load[i] * wanted[at + k]
                weight[var[at + k]] += load[i]
        at += lens[i]
    for n in range(nodes):
        if node_var[n] >= 0:
            target[node_var[n]] += NODE_WEIGHT * node_target[n]
            weight[node_var[n]] += NODE_WEIGHT
    floor = np.full(count, float(low))
    roof = np.full(count, float(high))
    if axis >= 0:
        floor[:] = max(float(low), axis + 1.0)
        at = 0
        for i in range(arcs):
            for k in range(lens[i]):
                if (
                    arc_on_axis[i]
                    or (k == 0 and node_on_axis[tail[i]])
                    or (k == lens[i] - 1 and node_on_axis[head[i]])
                ):
                    floor[var[at + k]] = roof[var[at + k]] = axis
            at += lens[i]
    for v in range(count):
        if weight[v] > 0:
            target[v] /= weight[v]
        else:
            weight[v] = 1e-3
            target[v] = place[v]
    # Arcs keep grid edges along their main direction: one, or two where a parallel arc must stay
    # apart; for the shape they would like more (a spring).
    rows = np.empty((len(hard) + 2 * arcs, 3))
    stiff = np.zeros(len(hard) + 2 * arcs)
    m = len(hard)
    rows[:m] = hard
    at = 0
    for i in range(arcs):
        dx = abs(flat[at + lens[i] - 1, 0] - flat[at, 0])
        dy = abs(flat[at + lens[i] - 1, 1] - flat[at, 1])
        mine, others = (dx, dy) if along == 0 else (dy, dx)
        u, v = var[at], var[at + lens[i] - 1]
        if flat[at, along] > flat[at + lens[i] - 1, along]:
            u, v = v, u
        if u != v and mine > 0:
            straight = mine >= others
            if straight:
                rows[m, 0], rows[m, 1], rows[m, 2] = u, v, min(least[i], mine)
                m += 1
            # Fades where the arc runs diagonally: half of its edges then lie on each axis.
            part = mine / (mine + others)
            if wish[i] > 1.0 and part > 0.25:
                rows[m, 0], rows[m, 1], rows[m, 2] = u, v, min(wish[i] * part, float(mine))
                stiff[m] = SHAPE_WEIGHT * min(1.0, (part - 0.25) * 8)
                m += 1
        at += lens[i]
    order = np.argsort(place[rows[:m, 0].astype(np.int64)], kind="mergesort")
    cons, springs = rows[:m][order], stiff[:m][order]
    # Room: the lowest and highest coordinates that the hard rows leave.
    least_x, most_x = floor.copy(), roof.copy()
    for c in range(m):
        if springs[c] == 0:
            u, v = int(cons[c, 0]), int(cons[c, 1])
            least_x[v] = max(least_x[v], least_x[u] + cons[c, 2])
    back = np.argsort(-place[rows[:m, 1].astype(np.int64)], kind="mergesort")
    for c in back:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            most_x[u] = min(most_x[u], most_x[v] - rows[c, 2])
    for v in range(count):
        if least_x[v] > most_x[v]:
            return False, new
    x = _project(target, weight, cons, springs, least_x, most_x, SWEEPS, TOLERANCE)
    whole = np.floor(x + 0.5)
    for v in range(count):
        whole[v] = min(max(whole[v], least_x[v]), most_x[v])
    # Coordinate ascent stops a hair early; these passes make the integers exact.
    for c in range(m):
        if springs[c] == 0:
            u, v = int(cons[c, 0]), int(cons[c, 1])
            whole[v] = max(whole[v], whole[u] + cons[c, 2])
    for c in back:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            whole[u] = min(whole[u], whole[v] - rows[c, 2])
    for k in range(len(flat)):
        new[k] = int(whole[var[k]])
    return True, new
