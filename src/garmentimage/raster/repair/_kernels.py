"""The local search for the least-cost labelling, in compiled code."""

import numpy as np
from numba import njit

from garmentimage.raster.image import EdgeType

ODD_FOLD_COST = 2.0
"""A front-to-back seam normally has cloth on one and the same side of it in both layers; else it
costs this much more."""

_NON_BOUNDARY, _NON_STITCH = int(EdgeType.NON_BOUNDARY), int(EdgeType.NON_STITCH)
_FRONT_TO_BACK, _SIDE_BY_SIDE = int(EdgeType.FRONT_TO_BACK), int(EdgeType.SIDE_BY_SIDE)
_WRAP, _SHEET, _ONTO = int(EdgeType.WRAP), int(EdgeType.SHEET), int(EdgeType.ONTO)
_SWEEPS = 20

# The labels are the flag f of every cell and the type t of every grid edge. Minimised is
#
#     sum over cells C(f)  +  sum over grid edges C(t)  +  ODD_FOLD_COST for each odd fold
#
# subject to every t fitting the flags on both sides of its grid edge (see `labelling`). Given the
# flags, the best type of each grid edge is independent of all others and found by comparing five
# costs, so only flags are searched: iterated conditional modes (Besag 1986, "On the statistical
# analysis of dirty pictures"). A sweep visits each cell of both layers at once and takes the flags
# that make the cell and its four grid edges cheapest; the energy never rises, and sweeps end when
# none changed a cell.


@njit(cache=True)
def best_types(f0, f1, b0, b1, front, back, layers):
    """Cheapest consistent types of one grid edge on a pair of layers, given both flags on each."""
    best_f, cost_f = best_single(f0, f1, front)
    if layers == 1:
        return cost_f, best_f, 0
    best_b, cost_b = best_single(b0, b1, back)
    total = cost_f + cost_b
    if (f0 and b0) or (f1 and b1):
        odd = ODD_FOLD_COST if f0 == f1 or f0 != b0 or f1 != b1 else 0.0
        for kind in (_FRONT_TO_BACK, _WRAP):
            cost = front[kind] + back[kind] + odd
            if cost < total:
                total, best_f, best_b = cost, kind, kind
    return total, best_f, best_b


@njit(cache=True)
def best_single(a, b, cost):
    if not a and not b:
        return _NON_BOUNDARY, cost[_NON_BOUNDARY]
    if a != b:
        best = _NON_STITCH
        for kind in (_SHEET, _ONTO):
            if cost[kind] < cost[best]:
                best = kind
        return best, cost[best]
    best = _NON_BOUNDARY
    for kind in (_NON_STITCH, _SIDE_BY_SIDE, _SHEET):
        if cost[kind] < cost[best]:
            best = kind
    return best, cost[best]


@njit(cache=True)
def flag_at(inside, layer, row, col):
    if layer >= inside.shape[0] or row < 0 or col < 0:
        return False
    return inside[layer, row, col]


@njit(cache=True)
def best_of_edge(inside, type_cost, h, row, col):
    """`best_types` of the bottom (h = 0) or left (h = 1) grid edge of a cell."""
    other_row, other_col = (row - 1, col) if h == 0 else (row, col - 1)
    layers = len(inside)
    return best_types(
        flag_at(inside, 0, other_row, other_col),
        flag_at(inside, 0, row, col),
        flag_at(inside, 1, other_row, other_col),
        flag_at(inside, 1, row, col),
        type_cost[0, h, :, row, col],
        type_cost[layers - 1, h, :, row, col],
        layers,
    )


@njit(cache=True)
def energy_around(inside, flag_cost, type_cost, row, col, choice):
    """Give a cell the flags that the bits of `choice` are; the cost of all terms that hold it."""
    layers, grid, _ = inside.shape
    cost = 0.0
    for layer in range(layers):
        flag = (choice >> layer) & 1
        inside[layer, row, col] = flag == 1
        cost += flag_cost[flag, layer, row, col]
    cost += best_of_edge(inside, type_cost, 0, row, col)[0]
    cost += best_of_edge(inside, type_cost, 1, row, col)[0]
    if row + 1 < grid:
        cost += best_of_edge(inside, type_cost, 0, row + 1, col)[0]
    if col + 1 < grid:
        cost += best_of_edge(inside, type_cost, 1, row, col + 1)[0]
    return cost


@njit(cache=True)
def minimise_pair(inside, flag_cost, type_cost):
    """Search the best flags of a pair of layers, from those in `inside` on."""
    layers, grid, _ = inside.shape
    for _ in range(_SWEEPS):
        changed = False
        for row in range(grid):
            for col in range(grid):
                now = 0
                for layer in range(layers):
                    now += (1 << layer) * inside[layer, row, col]
                best, best_cost = now, np.inf
                # The present choice comes first, so that it wins ties.
                for turn in range(1 << layers):
                    choice = now ^ turn
                    cost = energy_around(inside, flag_cost, type_cost, row, col, choice)
                    # A margin, so that rounding does not make two equal choices take turns.
                    if cost < best_cost - 1e-9:
                        best, best_cost = choice, cost
                for layer in range(layers):
                    inside[layer, row, col] = (best >> layer) & 1 == 1
                changed = changed or best != now
        if not changed:
            return


@njit(cache=True)
def set_types(inside, type_cost, types):
    """The best types of all grid edges, given the flags."""
    layers, grid, _ = inside.shape
    for h in range(2):
        for row in range(grid):
            for col in range(grid):
                _, front, back = best_of_edge(inside, type_cost, h, row, col)
                types[0, h, row, col] = front
                if layers > 1:
                    types[1, h, row, col] = back
