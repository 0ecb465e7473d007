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
    merge,
    neighbours,
    project,
    pushed_down,
    pushed_up,
)
from garmentimage.raster.encode.lattice.drawing import Drawing, DrawnPaths, Path

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

Rows = Float[np.ndarray, "_ 3"]
"""(u, v, s): lower bounds on differences, x[v] - x[u] >= s."""


class _Axis(NamedTuple):
    """All paths, one after the other, and their variables along one axis."""

    drawing: Drawing
    along: int
    vertices: Path
    """Integer coordinates, from 0 on, so that they can index arrays."""
    lens: Int[np.ndarray, " arc"]
    first: Int[np.ndarray, " arc"]
    last: Int[np.ndarray, " arc"]
    """First and last vertex of each."""
    variable: Int[np.ndarray, " vertex"]


def compact(
    drawing: Drawing, drawn: DrawnPaths, along: int, *, first: int | None = 1
) -> DrawnPaths | None:
    """New integer coordinates along one axis for every vertex of every path.

    Args:
        drawing: the graph.
        drawn: vertex-disjoint lattice paths (fine or coarse along either axis), and their targets.
        along: 0 to move x, 1 to move y.
        first: the first grid line that may be used, the last is N - 1; None where coordinates may
            lie anywhere.

    Returns:
        Paths and targets after the move, each path of two vertices or more; None when there is no
        room.
    """
    flat, wanted = np.concatenate(drawn.paths), np.concatenate(drawn.wanted)
    axis = _axis(drawing, flat, np.array([len(path) for path in drawn.paths]), along)
    # What lies on a line keeps its order. That alone may have no room, or be unsound.
    order = _order(axis)
    if order is None:
        return None
    # What is wanted: near the targets, with the grid edges that arcs require and desire.
    required, desired, stiffness = _chords(axis)
    springs = np.concatenate([np.zeros(len(order) + len(required)), stiffness])
    rows = np.concatenate([order, required, desired])
    new = _solve(axis, rows, springs, *_targets(axis, wanted[:, along]), first)
    if new is None:
        return None
    stretched, targets, owner = _stretched(axis, flat, new[axis.variable], wanted)
    sizes = np.bincount(owner, minlength=len(axis.lens))
    if sizes.min() < 2:  # An arc that shrank to its nodes, which are one point.
        return None
    cuts = np.cumsum(sizes)[:-1]
    return DrawnPaths(np.split(stretched, cuts), np.split(targets, cuts))


def _axis(drawing: Drawing, flat: Path, lens: Int[np.ndarray, " arc"], along: int) -> _Axis:
    """Number the variables: a node has one for all arcs."""
    arcs, nodes = drawing.arcs, len(drawing.nodes)
    last = np.cumsum(lens) - 1
    first = last - lens + 1
    # A step across the axis keeps the coordinate, and with it the variable.
    is_across = flat[1:, 1 - along] != flat[:-1, 1 - along]
    is_across[last[:-1]] = False
    (k,) = np.nonzero(is_across)
    # Numbers below `nodes` are those of nodes, the others those of vertices.
    steps = [nodes + k, nodes + k + 1]
    ends = [arcs.tail, nodes + first], [arcs.head, nodes + last]
    classes = merge(nodes + len(flat), np.concatenate([steps, *ends], axis=1).T)[nodes:]
    # Numbers without gaps; order and limits refer to them.
    _, variable = np.unique(classes, return_inverse=True)
    return _Axis(drawing, along, flat - flat.min(axis=0), lens, first, last, variable)


def _solve(
    axis: _Axis,
    rows: Rows,
    springs: Float[np.ndarray, " row"],
    target: Float[np.ndarray, " variable"],
    weight: Float[np.ndarray, " variable"],
    first: int | None,
) -> Int[np.ndarray, " variable"] | None:
    """Solve the quadratic program of the file's head in integers; None when there is no room.

    `springs` is 0 for a row that must be kept, else the stiffness with which it pushes. Rows only
    point from lower to higher places, so that two sweeps in the order of places, up and down, carry
    limits through all of them.
    """
    place = np.zeros(len(target), np.int64)
    place[axis.variable] = axis.vertices[:, axis.along]
    u, v = rows[:, :2].T.astype(np.int64)
    ahead, back = (np.argsort(by, kind="stable") for by in (place[u], -place[v]))
    up, down = (rows[order][springs[order] == 0] for order in (ahead, back))
    # Tight limits first: without room there is nothing to solve.
    floor, roof = _limits(axis, len(target), first)
    low, high = pushed_up(floor, up), pushed_down(roof, down)
    if (low > high).any():
        return None
    x = project(target, weight, rows[ahead], springs[ahead], low, high)
    # Coordinate ascent stops a hair early; these sweeps make the integers exact.
    x = pushed_down(pushed_up(np.clip(np.floor(x + 0.5), low, high), up), down)
    # What is drawn with them must be inside the grid, and a target that is NaN never is.
    is_kept = (x[v] - x[u] >= rows[:, 2]) | (springs > 0)
    is_sound = is_kept.all() and (low <= x).all() and (x <= high).all()
    return x.astype(np.int64) if is_sound else None


def _limits(
    axis: _Axis, count: int, first: int | None
) -> tuple[Float[np.ndarray, " variable"], Float[np.ndarray, " variable"]]:
    """Lower and upper limit of each variable: those of the grid, and of the mirror axis."""
    nodes, arcs, column = axis.drawing.nodes, axis.drawing.arcs, axis.drawing.axis
    low, high = (-UNBOUNDED, UNBOUNDED) if first is None else (first, axis.drawing.grid - 1)
    floor, roof = np.full(count, float(low)), np.full(count, float(high))
    if column is not None and axis.along == 0:
        # What is not on the axis lies right of it; what is on it cannot move.
        floor = np.maximum(floor, column + 1.0)
        is_fixed = np.repeat(arcs.on_axis, axis.lens)
        is_fixed[axis.first] |= nodes.on_axis[arcs.tail]
        is_fixed[axis.last] |= nodes.on_axis[arcs.head]
        fixed = axis.variable[is_fixed]
        floor[fixed] = roof[fixed] = column
    return floor, roof


def _stretched(
    axis: _Axis, flat: Path, new: Int[np.ndarray, " vertex"], wanted: Float[np.ndarray, "vertex 2"]
) -> tuple[Path, Float[np.ndarray, "after 2"], Int[np.ndarray, " after"]]:
    """All paths with new coordinates, collapsed steps dropped, long steps filled; targets; arcs."""
    # A step along the axis becomes as many vertices as it is long now, perhaps none; a step
    # across it is always one.
    before = np.arange(len(flat)) - 1
    before[axis.first] = axis.first
    step = new - new[before]
    is_across = flat[:, 1 - axis.along] != flat[before, 1 - axis.along]
    count = np.where(is_across, 1, np.abs(step))
    count[axis.first] = 1
    index = np.repeat(np.arange(len(flat)), count)
    number = np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count) + 1
    out = flat[index]
    out[:, axis.along] = new[index] - (count[index] - number) * np.sign(step[index])
    # Targets of new vertices lie between those of their step.
    share = (number / count[index])[:, None]
    targets = wanted[before[index]] * (1 - share) + wanted[index] * share
    return out, targets, np.repeat(np.arange(len(axis.lens)), axis.lens)[index]


def _targets(
    axis: _Axis, wanted: Float[np.ndarray, " vertex"]
) -> tuple[Float[np.ndarray, " variable"], Float[np.ndarray, " variable"]]:
    """Mean target and weight of each variable: a cell of path weighs 1, a node `NODE_WEIGHT`.

    Both count as much as their arcs do.
    """
    nodes, arcs, lens = axis.drawing.nodes, axis.drawing.arcs, axis.lens
    # Fine paths have more vertices than coarse ones: a path weighs as its curve is long.
    load = np.repeat(arcs.weight * np.maximum(arcs.cells, MIN_CELLS) / lens, lens)
    load[axis.first] = load[axis.last] = 0.0
    weight = np.bincount(axis.variable, load)
    target = np.bincount(axis.variable, load * wanted)
    ends = np.concatenate([arcs.tail, arcs.head])
    numbers, first = np.unique(ends, return_index=True)
    at = axis.variable[np.concatenate([axis.first, axis.last])[first]]
    pull = NODE_WEIGHT * axis.drawing.node_weight[numbers]
    np.add.at(weight, at, pull)
    np.add.at(target, at, pull * nodes.target[numbers, axis.along])
    return target / weight, weight


def _order(axis: _Axis) -> Rows | None:
    """Rows for neighbours on a line, the strongest of equals; None if paths touch."""
    flat, layers = axis.vertices, axis.drawing.arcs.layers
    width, height = (flat.max(axis=0) + 1).tolist()
    count = axis.drawing.layer_count
    pairs, is_sound = neighbours(
        flat, axis.lens, layers, count, axis.variable, axis.along, width, height
    )
    if not is_sound:
        return None
    # One number per row, which sorts rows of the same pair by strength.
    base = len(flat) + 1
    key = np.unique((pairs[:, 0] * base + pairs[:, 1]) * 2 + (1 - pairs[:, 2]))
    key = key[np.diff(key // 2, prepend=-1) > 0]
    return np.stack([key // 2 // base, key // 2 % base, 1 - key % 2], axis=1).astype(float)


def _chords(axis: _Axis) -> tuple[Rows, Rows, Float[np.ndarray, " _"]]:
    """Rows that keep grid edges for arcs along their main direction.

    The fewest edges that an arc may have must be kept; for its shape it desires more, half of them
    where it runs diagonally: springs, whose stiffness comes third.
    """
    arcs, along = axis.drawing.arcs, axis.along
    first, last = axis.vertices[axis.first], axis.vertices[axis.last]
    mine, others = np.abs(last - first)[:, [along, 1 - along]].T
    is_up = first[:, along] <= last[:, along]
    tail, head = axis.variable[axis.first], axis.variable[axis.last]
    u, v = np.where(is_up, [tail, head], [head, tail])
    is_real = (u != v) & (mine > 0)
    # A diagonal arc has its grid edges along both axes, so each axis keeps its part of them.
    part = mine / np.maximum(mine + others, 1)
    hard = is_real & (mine >= others)
    soft = is_real & (arcs.desired_edges > 1.0) & (part > MIN_SPRING_SHARE)
    required = np.stack([u, v, np.minimum(np.ceil(arcs.min_edges * part), mine)], axis=1)[hard]
    desired = np.stack([u, v, np.minimum(arcs.desired_edges * part, mine)], axis=1)[soft]
    grown = np.minimum(1.0, (part - MIN_SPRING_SHARE) * SPRING_GROWTH)
    return required, desired, SHAPE_WEIGHT * (arcs.weight * grown)[soft]
