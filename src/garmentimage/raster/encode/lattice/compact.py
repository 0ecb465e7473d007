"""Compaction: the fine drawing moves to the image's lattice, one axis at a time.

Along every lattice line the order of what lies on it is kept and different arcs stay at least one
step apart, so arcs stay vertex-disjoint; successive steps of one arc may collapse. The new
coordinates are those nearest to the wanted ones (least squares over difference constraints,
solved for its multipliers by coordinate ascent), rounded: rounding every number at the same
threshold keeps integer difference constraints true, and keeps a small change small.
"""

import numpy as np

from garmentimage.raster.encode.lattice._kernels_compact import (
    neighbours,
    number_variables,
    solve_integers,
)
from garmentimage.raster.encode.lattice.drawing import Drawing, Path

NODE_WEIGHT = 4.0
"""Weight of a node's own wish against one cell of path."""
SHAPE_WEIGHT = 6.0
"""Stiffness with which an arc asks for the grid edges that its curve needs."""
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
    variable = number_variables(
        flat, lens, drawing.tail, drawing.head, len(drawing.node_target), along
    )
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
    new, sound = solve_integers(rows, stiff, ahead, back, target, weight, floor, roof)
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
    pairs, sound = neighbours(flat, lens, layers, variable, along, width, height)
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
