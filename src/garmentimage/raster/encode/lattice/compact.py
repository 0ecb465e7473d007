"""Compaction: the fine drawing moves to the image's lattice, one axis at a time.

Along every lattice line the order of what lies on it is kept and different arcs are at least one
step apart, so arcs are vertex-disjoint afterwards, too; successive steps of one arc may collapse.

A run of vertices that share their coordinate is one variable x_v. With their mean targets t_v and
weights w_v, one axis is the quadratic program

    minimise    sum over v  w_v (x_v - t_v)²  +  sum over springs  k max(s - (x_v - x_u), 0)²
    subject to  x_v - x_u >= s  for neighbours (u, v) on a lattice line,  low_v <= x_v <= high_v,

solved for its multipliers by coordinate ascent (Hildreth 1957; see `_kernels_compact`) and rounded:
rounding every number at the same threshold keeps integer difference constraints true, and keeps a
small change small. Springs push for the grid edges that an arc desires.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from garmentimage.raster.encode.lattice._kernels_compact import (
    neighbours,
    number_variables,
    solve_integers,
)
from garmentimage.raster.encode.lattice.drawing import Drawing, Path

NODE_WEIGHT = 4.0
"""Weight of a node's target against one cell of path."""
SHAPE_WEIGHT = 6.0
"""Stiffness with which an arc pushes for the grid edges that it desires."""
MIN_SPRING_SHARE, SPRING_GROWTH = 0.25, 8
"""Share of an arc's extent along the axis from which on it pushes, and growth per share beyond."""
UNBOUNDED = 1 << 20
"""Farther than any coordinate: the limits where the grid's do not hold."""
MIN_CELLS = 1e-9
"""An arc without length still has a target: without weight its vertices would have no place."""


class _Stack(NamedTuple):
    """All paths, one after the other."""

    vertices: Path
    """Integer coordinates, from 0 on."""
    lens: Int[np.ndarray, " arc"]
    starts: Int[np.ndarray, " arc"]
    ends: Int[np.ndarray, " arc"]
    """One past the last vertex of each."""


class _Constraints(NamedTuple):
    """Lower bounds on differences: x[v] - x[u] >= s."""

    rows: Float[np.ndarray, "row 3"]
    """(u, v, s)."""
    stiffness: Float[np.ndarray, " row"]
    """Of a spring that pushes to keep it, or 0 for one that must be kept."""


def compact(
    drawing: Drawing,
    paths: list[Path],
    wanted: list[Float[np.ndarray, "_ 2"]],
    along: int,
    low: int,
    high: int,
    *,
    bounded: bool = True,
) -> tuple[list[Path], list[Float[np.ndarray, "_ 2"]]] | None:
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
        Paths and targets after the move, each path of two vertices or more and, where the limits
        hold, between them; or None when there is no room.
    """
    lens = np.array([len(p) for p in paths])
    # Coordinates from 0 on, so that they can index arrays.
    ends = np.cumsum(lens)
    flat = np.concatenate(paths)
    base = flat.min(axis=0)
    stack = _Stack(flat - base, lens, ends - lens, ends)
    variable = number_variables(
        stack.vertices, lens, drawing.arcs.tail, drawing.arcs.head, len(drawing.nodes), along
    )
    # Variables numbered without gaps; order and limits refer to these numbers.
    _, variable = np.unique(variable, return_inverse=True)
    # What lies on a line keeps its order. That alone may have no room, or be unsound.
    order = _order(stack, drawing.arcs.layers, variable, along)
    if order is None:
        return None
    # What is wanted: near the targets, with the grid edges that arcs require and desire.
    target, weight = _targets(drawing, np.concatenate(wanted)[:, along], stack, variable, along)
    limits = (low, high) if bounded else (-UNBOUNDED, UNBOUNDED)
    floor, roof = _limits(drawing, stack, variable, along, *limits)
    chords, springs = _chords(drawing, stack, variable, along)
    constraints = _Constraints(
        np.concatenate([order, chords]), np.concatenate([np.zeros(len(order)), springs])
    )
    place = np.zeros(variable.max() + 1, np.int64)
    place[variable] = stack.vertices[:, along]
    new = _solve_axis(constraints, place, target, weight, floor, roof)
    if new is None:
        return None
    moved = stack._replace(vertices=stack.vertices + base)
    stretched, targets, owner = _stretched(moved, new[variable], np.concatenate(wanted), along)
    sizes = np.bincount(owner, minlength=len(lens))
    if sizes.min() < 2:  # An arc that shrank to its nodes, which are one point.
        return None
    cuts = np.cumsum(sizes)[:-1]
    return np.split(stretched, cuts), np.split(targets, cuts)


def _solve_axis(
    constraints: _Constraints,
    place: Int[np.ndarray, " variable"],
    target: Float[np.ndarray, " variable"],
    weight: Float[np.ndarray, " variable"],
    floor: Float[np.ndarray, " variable"],
    roof: Float[np.ndarray, " variable"],
) -> Int[np.ndarray, " variable"] | None:
    """Solve the quadratic program of the file's head in integers; None when there is no room.

    Constraints only point from lower to higher places, so that two sweeps in the order of places,
    up and down, carry limits through all of them.
    """
    rows, stiffness = constraints
    # Rows by the place of their lower variable, rising, and of their upper one, falling.
    ahead = np.argsort(place[rows[:, 0].astype(np.int64)], kind="stable")
    back = np.argsort(-place[rows[:, 1].astype(np.int64)], kind="stable")
    new, is_sound = solve_integers(rows, stiffness, ahead, back, target, weight, floor, roof)
    return np.asarray(new) if is_sound else None


def _limits(
    drawing: Drawing,
    stack: _Stack,
    variable: Int[np.ndarray, " vertex"],
    along: int,
    low: int,
    high: int,
) -> tuple[Float[np.ndarray, " variable"], Float[np.ndarray, " variable"]]:
    """Lower and upper limit of each variable: those of the grid, and of the mirror axis."""
    count = variable.max() + 1
    floor, roof = np.full(count, float(low)), np.full(count, float(high))
    if drawing.axis is not None and along == 0:
        nodes, arcs = drawing.nodes, drawing.arcs
        # What is not on the axis lies right of it; what is on it cannot move.
        floor[:] = np.maximum(floor, drawing.axis + 1.0)
        on_axis = np.concatenate(
            [
                variable[np.repeat(arcs.on_axis, stack.lens)],
                variable[stack.starts][nodes.on_axis[arcs.tail]],
                variable[stack.ends - 1][nodes.on_axis[arcs.head]],
            ]
        )
        floor[on_axis] = roof[on_axis] = drawing.axis
    return floor, roof


def _stretched(
    stack: _Stack,
    new: Int[np.ndarray, " vertex"],
    wanted: Float[np.ndarray, "vertex 2"],
    along: int,
) -> tuple[Path, Float[np.ndarray, "after 2"], Int[np.ndarray, " after"]]:
    """All paths with new coordinates, collapsed steps dropped, long steps filled; targets; arcs."""
    flat, lens, starts, _ = stack
    # A step along the axis becomes as many vertices as it is long now, perhaps none; a step
    # across it is always one.
    before = np.arange(len(flat)) - 1
    before[starts] = starts
    step = new - new[before]
    is_across = flat[:, 1 - along] != flat[before, 1 - along]
    count = np.where(is_across, 1, np.abs(step))
    count[starts] = 1
    index = np.repeat(np.arange(len(flat)), count)
    number = np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count) + 1
    back = (count[index] - number) * np.sign(step[index])
    out = flat[index].copy()
    out[:, along] = new[index] - back
    # Targets of new vertices lie between those of their step.
    share = (number / count[index])[:, None]
    targets = wanted[before[index]] * (1 - share) + wanted[index] * share
    return out, targets, np.repeat(np.arange(len(lens)), lens)[index]


def _targets(
    drawing: Drawing,
    wanted: Float[np.ndarray, " vertex"],
    stack: _Stack,
    variable: Int[np.ndarray, " vertex"],
    along: int,
) -> tuple[Float[np.ndarray, " variable"], Float[np.ndarray, " variable"]]:
    """Mean target and weight of each variable: a cell of path weighs 1, a node `NODE_WEIGHT`.

    Both count as much as their arcs do.
    """
    nodes, arcs, lens = drawing.nodes, drawing.arcs, stack.lens
    is_inner = np.ones(len(stack.vertices), bool)
    is_inner[stack.starts] = is_inner[stack.ends - 1] = False
    cells = np.array([np.hypot(*np.diff(c, axis=0).T).sum() for c in arcs.curves])
    cells = np.maximum(cells, MIN_CELLS)
    # Fine paths have more vertices than coarse ones: a path weighs as its curve is long.
    load = np.where(is_inner, np.repeat(arcs.weight * cells / lens, lens), 0.0)
    count = variable.max() + 1
    weight = np.bincount(variable, load, count)
    target = np.bincount(variable, load * wanted, count)
    ends = np.concatenate([arcs.tail, arcs.head])
    at = np.concatenate([variable[stack.starts], variable[stack.ends - 1]])
    numbers, first = np.unique(ends, return_index=True)
    pull = NODE_WEIGHT * drawing.node_weight[numbers]
    np.add.at(weight, at[first], pull)
    np.add.at(target, at[first], pull * nodes.target[numbers, along])
    return target / weight, weight


def _order(
    stack: _Stack, layers: Int[np.ndarray, " arc"], variable: Int[np.ndarray, " vertex"], along: int
) -> Float[np.ndarray, "row 3"] | None:
    """Rows (u, v, s) for neighbours on a line, the strongest of equals; None if paths touch."""
    flat = stack.vertices
    width, height = (flat.max(axis=0) + 1).tolist()
    pairs, is_sound = neighbours(flat, stack.lens, layers, variable, along, width, height)
    if not is_sound:
        return None
    # One number per row, which sorts rows of the same pair by strength.
    base = len(flat) + 1
    key = np.unique((pairs[:, 0] * base + pairs[:, 1]) * 2 + (1 - pairs[:, 2]))
    pair, is_weak = key // 2, key % 2
    is_first = np.concatenate([[True], pair[1:] != pair[:-1]]) if len(pair) else np.zeros(0, bool)
    pair, is_weak = pair[is_first], is_weak[is_first]
    return np.stack([pair // base, pair % base, 1 - is_weak], axis=1).astype(float)


def _chords(
    drawing: Drawing, stack: _Stack, variable: Int[np.ndarray, " vertex"], along: int
) -> tuple[Float[np.ndarray, "row 3"], Float[np.ndarray, " row"]]:
    """Rows that keep grid edges for arcs along their main direction, and their stiffness.

    The fewest edges that an arc may have are kept (stiffness 0: hard); for its shape it desires
    more (a spring), half of them where it runs diagonally.
    """
    arcs = drawing.arcs
    tail, head = variable[stack.starts], variable[stack.ends - 1]
    first, last = stack.vertices[stack.starts], stack.vertices[stack.ends - 1]
    mine = np.abs(last - first)[:, along]
    others = np.abs(last - first)[:, 1 - along]
    is_up = first[:, along] <= last[:, along]
    u, v = np.where(is_up, tail, head), np.where(is_up, head, tail)
    is_real = (u != v) & (mine > 0)
    # A diagonal arc has its grid edges along both axes, so each axis keeps its part of them.
    part = mine / np.maximum(mine + others, 1)
    hard = is_real & (mine >= others)
    soft = is_real & (arcs.desired_edges > 1.0) & (part > MIN_SPRING_SHARE)
    rows = np.concatenate(
        [
            np.stack([u, v, np.minimum(np.ceil(arcs.min_edges * part), mine)], axis=1)[hard],
            np.stack([u, v, np.minimum(arcs.desired_edges * part, mine)], axis=1)[soft],
        ]
    ).astype(float)
    grown = np.minimum(1.0, (part - MIN_SPRING_SHARE) * SPRING_GROWTH)
    springs = SHAPE_WEIGHT * (arcs.weight * grown)[soft]
    return rows, np.concatenate([np.zeros(int(hard.sum())), springs])
