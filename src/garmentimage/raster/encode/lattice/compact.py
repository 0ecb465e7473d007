"""Compaction: the fine drawing moves to the image's lattice, one axis at a time.

Along every lattice line the order of what lies on it is kept and different arcs stay at least one
step apart, so arcs stay vertex-disjoint; successive steps of one arc may collapse. The new
coordinates are those nearest to the wanted ones (least squares over difference constraints,
solved for its multipliers by coordinate ascent), rounded: rounding every number at the same
threshold keeps integer difference constraints true, and keeps a small change small.
"""

import numpy as np
from numba import njit

from garmentimage.geometry import merge, root_of
from garmentimage.raster.encode.lattice.drawing import Drawing, Path

NODE_WEIGHT = 4.0
"""Weight of a node's own wish against one cell of path."""
SHAPE_WEIGHT = 6.0
"""Stiffness with which an arc asks for the grid edges that its curve needs."""
SWEEPS = 400
TOLERANCE = 1e-4
BIG = 1 << 20
LEAST_CELLS = 1e-9
"""An arc without length still has a wish: without weight its vertices would have no place."""


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
        Paths and wishes after the move, each path of two vertices or more and, where the limits
        hold, between them; or None when there is no room.
    """
    lens = np.array([len(p) for p in paths])
    ends = np.cumsum(lens)
    starts = ends - lens
    flat = np.concatenate(paths)
    base = flat.min(axis=0)
    flat -= base
    variable = _variables(flat, lens, drawing.tail, drawing.head, len(drawing.node_target), along)
    _, variable = np.unique(variable, return_inverse=True)
    place = np.zeros(variable.max() + 1, np.int64)
    place[variable] = flat[:, along]
    inner = np.ones(len(flat), bool)
    inner[starts] = inner[ends - 1] = False
    target, weight = _wishes(
        drawing, np.concatenate(wanted)[:, along], lens, variable, inner, along
    )
    floor = np.full(len(place), float(low if bounded else -BIG))
    roof = np.full(len(place), float(high if bounded else BIG))
    if drawing.axis is not None and along == 0:
        floor[:] = np.maximum(floor, drawing.axis + 1.0)
        on_axis = np.concatenate(
            [
                variable[np.repeat(drawing.on_axis, lens)],
                variable[starts][drawing.node_on_axis[drawing.tail]],
                variable[ends - 1][drawing.node_on_axis[drawing.head]],
            ]
        )
        floor[on_axis] = roof[on_axis] = drawing.axis
    order = _order(flat, lens, drawing.layers, variable, along)
    if order is None:
        return None
    chords, springs = _chords(drawing, flat, starts, ends, variable, along)
    rows = np.concatenate([order, chords])
    stiff = np.concatenate([np.zeros(len(order)), springs])
    ahead = np.argsort(place[rows[:, 0].astype(np.int64)], kind="stable")
    back = np.argsort(-place[rows[:, 1].astype(np.int64)], kind="stable")
    new, sound = _solve(rows, stiff, ahead, back, target, weight, floor, roof)
    if not sound:
        return None
    stretched, wishes, owner = _stretched(
        flat + base, new[variable], np.concatenate(wanted), starts, lens, along
    )
    sizes = np.bincount(owner, minlength=len(lens))
    if sizes.min() < 2:  # An arc that shrank to its nodes, which are one point.
        return None
    cuts = np.cumsum(sizes)[:-1]
    return np.split(stretched, cuts), np.split(wishes, cuts)


def _stretched(
    flat: Path,
    new: np.ndarray,
    wanted: np.ndarray,
    starts: np.ndarray,
    lens: np.ndarray,
    along: int,
) -> tuple[Path, np.ndarray, np.ndarray]:
    """All paths with new coordinates, collapsed steps dropped, long steps filled; wishes; arcs."""
    before = np.arange(len(flat)) - 1
    before[starts] = starts
    step = new - new[before]
    turned = flat[:, 1 - along] != flat[before, 1 - along]
    count = np.where(turned, 1, np.abs(step))
    count[starts] = 1
    index = np.repeat(np.arange(len(flat)), count)
    number = np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count) + 1
    back = (count[index] - number) * np.sign(step[index])
    out = flat[index].copy()
    out[:, along] = new[index] - back
    share = (number / count[index])[:, None]
    wishes = wanted[before[index]] * (1 - share) + wanted[index] * share
    return out, wishes, np.repeat(np.arange(len(lens)), lens)[index]


def _wishes(
    drawing: Drawing,
    wanted: np.ndarray,
    lens: np.ndarray,
    variable: np.ndarray,
    inner: np.ndarray,
    along: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Mean wish and weight of each variable: a cell of path weighs 1, a node `NODE_WEIGHT`.

    Both count as much as their arcs do.
    """
    cells = np.array([np.hypot(*np.diff(c, axis=0).T).sum() for c in drawing.curves])
    cells = np.maximum(cells, LEAST_CELLS)
    load = np.where(inner, np.repeat(drawing.weight * cells / lens, lens), 0.0)
    count = variable.max() + 1
    weight = np.bincount(variable, load, count)
    target = np.bincount(variable, load * wanted, count)
    ends = np.cumsum(lens)
    nodes = np.concatenate([drawing.tail, drawing.head])
    at = np.concatenate([variable[ends - lens], variable[ends - 1]])
    nodes, first = np.unique(nodes, return_index=True)
    pull = NODE_WEIGHT * drawing.node_weight[nodes]
    np.add.at(weight, at[first], pull)
    np.add.at(target, at[first], pull * drawing.node_target[nodes, along])
    return target / weight, weight


def _order(
    flat: Path, lens: np.ndarray, layers: np.ndarray, variable: np.ndarray, along: int
) -> np.ndarray | None:
    """Rows (u, v, s) for X_v - X_u >= s, the strongest of equals; None if paths touch."""
    width, height = (flat.max(axis=0) + 1).tolist()
    pairs, sound = _neighbours(flat, lens, layers, variable, along, width, height)
    if not sound:
        return None
    key = (pairs[:, 0] * (len(flat) + 1) + pairs[:, 1]) * 2 + (1 - pairs[:, 2])
    key = np.unique(key)
    pair, weak = key // 2, key % 2
    first = np.concatenate([[True], pair[1:] != pair[:-1]]) if len(pair) else np.zeros(0, bool)
    pair, weak = pair[first], weak[first]
    return np.stack([pair // (len(flat) + 1), pair % (len(flat) + 1), 1 - weak], axis=1).astype(
        float
    )


def _chords(
    drawing: Drawing,
    flat: Path,
    starts: np.ndarray,
    ends: np.ndarray,
    variable: np.ndarray,
    along: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Rows that keep grid edges for arcs along their main direction, and their stiffness.

    One edge is kept, or as many as the arc insists on (stiffness 0: hard); for its shape it would
    like more (a spring), half of them where it runs diagonally.
    """
    first, last = flat[starts], flat[ends - 1]
    mine = np.abs(last - first)[:, along]
    others = np.abs(last - first)[:, 1 - along]
    up = first[:, along] <= last[:, along]
    u = np.where(up, variable[starts], variable[ends - 1])
    v = np.where(up, variable[ends - 1], variable[starts])
    real = (u != v) & (mine > 0)
    part = mine / np.maximum(mine + others, 1)
    hard = real & (mine >= others)
    soft = real & (drawing.wish > 1.0) & (part > 0.25)
    rows = np.concatenate(
        [
            np.stack([u, v, np.minimum(np.ceil(drawing.least * part), mine)], axis=1)[hard],
            np.stack([u, v, np.minimum(drawing.wish * part, mine)], axis=1)[soft],
        ]
    ).astype(float)
    springs = SHAPE_WEIGHT * (drawing.weight * np.minimum(1.0, (part - 0.25) * 8))[soft]
    return rows, np.concatenate([np.zeros(int(hard.sum())), springs])


@njit(cache=True)
def _variables(flat, lens, tail, head, nodes, along):  # type: ignore[no-untyped-def]
    """A variable per run of vertices that share their coordinate; a node has one for all arcs."""
    other = 1 - along
    out = np.empty(len(flat), np.int64)
    parent = np.arange(nodes + len(flat))
    at = 0
    for i in range(len(lens)):
        out[at] = tail[i]
        for k in range(1, lens[i]):
            turned = flat[at + k, other] != flat[at + k - 1, other]
            if k == lens[i] - 1:
                out[at + k] = head[i]
                if turned:
                    merge(parent, head[i], out[at + k - 1])
            else:
                out[at + k] = out[at + k - 1] if turned else nodes + at + k
        at += lens[i]
    for v in range(len(flat)):
        out[v] = root_of(parent, out[v])
    return out


@njit(cache=True)
def _neighbours(flat, lens, mask, variable, along, width, height):  # type: ignore[no-untyped-def]
    """(u, v, steps) for neighbours on a lattice line; False if one variable meets itself there."""
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
                    elif not joined:
                        return pairs[:0], False
                last = c
    return pairs[:n], True


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
    for _ in range(sweeps):
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
def _solve(rows, stiff, ahead, back, target, weight, floor, roof):  # type: ignore[no-untyped-def]
    """Integers nearest to the target; `ahead` and `back` order the rows by place, both ways.

    Sound only if they keep every hard row and lie between floor and roof, which a target that is
    no number cannot: what is drawn with them stays inside the grid.
    """
    low, high = floor.copy(), roof.copy()
    for c in ahead:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            low[v] = max(low[v], low[u] + rows[c, 2])
    for c in back:
        if stiff[c] == 0:
            u, v = int(rows[c, 0]), int(rows[c, 1])
            high[u] = min(high[u], high[v] - rows[c, 2])
    out = np.zeros(len(target), np.int64)
    for v in range(len(target)):
        if low[v] > high[v]:
            return out, False
    x = _project(target, weight, rows[ahead], stiff[ahead], low, high, SWEEPS, TOLERANCE)
    for v in range(len(target)):
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
    for v in range(len(target)):
        if not low[v] <= x[v] <= high[v]:
            return out, False
        out[v] = int(x[v])
    for c in range(len(rows)):
        if stiff[c] == 0 and out[int(rows[c, 1])] - out[int(rows[c, 0])] < rows[c, 2]:
            return out, False
    return out, True
