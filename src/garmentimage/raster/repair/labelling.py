"""What a network believes of an image, and the least-cost labelling in which all agrees.

Costs are negative log probabilities [nats]. A labelling agrees when every grid edge fits the cells
on both sides of it, on both layers: a boundary between inside and outside, `NON_BOUNDARY` outside,
`SIDE_BY_SIDE` between two inside cells, `FRONT_TO_BACK` on both layers or on neither.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from numba import njit

from garmentimage.raster.channel_kind import ChannelKind
from garmentimage.raster.image import (
    BOTTOM,
    EDGE_TYPE_COUNT,
    LEFT,
    EdgeType,
    GarmentImage,
    split_channels,
)

CERTAIN_COST = 14.0
"""Cost of what a network gave no probability at all."""

ODD_FOLD_COST = 2.0
"""A front-to-back seam normally has cloth on one and the same side of it in both layers; else it
costs this much more."""

NEIGHBOUR_GAIN = 0.2
"""What a type gains from each grid edge of the same type that it touches."""

_NON_BOUNDARY, _NON_STITCH = int(EdgeType.NON_BOUNDARY), int(EdgeType.NON_STITCH)
_FRONT_TO_BACK, _SIDE_BY_SIDE = int(EdgeType.FRONT_TO_BACK), int(EdgeType.SIDE_BY_SIDE)
_SWEEPS = 20


@dataclass(frozen=True)
class Beliefs:
    """What a network thinks: costs of every choice [nats], and deformation."""

    inside: Float[np.ndarray, "2 layer row col"]
    """Cost of outside, and of inside."""
    types: Float[np.ndarray, "layer 2 4 row col"]
    """Cost of each type of the bottom and left grid edge."""
    deformation: Float[np.ndarray, "layer 4 2 row col"]


def read_beliefs(array: np.ndarray, kind: ChannelKind) -> Beliefs:
    """Costs from what a network gives.

    Args:
        array: [17 L, N, N], as `GarmentImage.to_channels` orders them.
        kind: what its flags and types are. Channels are decided, and certain then.

    Raises:
        ImageError: a wrong shape, or values that are not finite.
    """
    flags, types, vectors = split_channels(array)
    if kind == "channels":
        decided = certain(GarmentImage.from_channels(array, kind=kind))
        return Beliefs(decided.inside, decided.types, vectors)
    if kind == "logits":
        both = np.logaddexp(0, np.stack([flags, -flags]))
        each = np.logaddexp.reduce(types, axis=2, keepdims=True) - types
        return Beliefs(np.minimum(both, CERTAIN_COST), np.minimum(each, CERTAIN_COST), vectors)
    inside, shares = flags.clip(0, 1), types.clip(0, 1)
    total = shares.sum(axis=2, keepdims=True)
    # Four zeros say nothing, so that all four are as likely.
    shares = np.divide(shares, total, out=np.full_like(shares, 0.25), where=total > 0)
    return Beliefs(_cost(np.stack([1 - inside, inside])), _cost(shares), vectors)


def _cost(probability: np.ndarray) -> np.ndarray:
    return -np.log(np.maximum(probability, np.exp(-CERTAIN_COST)))


def certain(image: GarmentImage) -> Beliefs:
    """The beliefs of someone who believes every channel of `image`."""
    inside = np.where(np.stack([image.inside, ~image.inside]), CERTAIN_COST, 0.0)
    one_hot = image.edge_type[:, :, None] == np.arange(EDGE_TYPE_COUNT)[:, None, None]
    return Beliefs(inside, np.where(one_hot, 0.0, CERTAIN_COST), image.deformation)


def with_neighbours(
    costs: Float[np.ndarray, "layer 2 4 row col"], types: np.ndarray
) -> Float[np.ndarray, "layer 2 4 row col"]:
    """Costs less what each type gains from the touching grid edges that have it."""
    layers, _, grid, _ = types.shape
    # Number of grid edges of each type at every lattice point.
    at_point = np.zeros((layers, EDGE_TYPE_COUNT, grid + 1, grid + 1))
    one_hot = (types[:, :, None] == np.arange(EDGE_TYPE_COUNT)[:, None, None]).astype(float)
    bottom, left = one_hot[:, BOTTOM], one_hot[:, LEFT]
    at_point[:, :, :-1, :-1] += bottom + left
    at_point[:, :, :-1, 1:] += bottom
    at_point[:, :, 1:, :-1] += left
    near = np.empty_like(costs)
    near[:, BOTTOM] = at_point[:, :, :-1, :-1] + at_point[:, :, :-1, 1:] - 2 * bottom
    near[:, LEFT] = at_point[:, :, :-1, :-1] + at_point[:, :, 1:, :-1] - 2 * left
    near[:, :, _NON_BOUNDARY] = 0
    return np.ascontiguousarray(costs - NEIGHBOUR_GAIN * near)


def relabel(
    inside: Bool[np.ndarray, "layer row col"], flag_cost: np.ndarray, type_cost: np.ndarray
) -> tuple[Bool[np.ndarray, "layer row col"], np.ndarray]:
    """Flags and types of least cost that agree, by local search from `inside`.

    Args:
        inside: where the search starts.
        flag_cost: [2, layer, row, col], as `Beliefs.inside`.
        type_cost: [layer, 2, 4, row, col], as `Beliefs.types`.
    """
    layers, grid, _ = inside.shape
    assert flag_cost.shape == (2, layers, grid, grid)
    assert type_cost.shape == (layers, 2, EDGE_TYPE_COUNT, grid, grid)
    inside = inside.copy()
    types = np.empty((len(inside), 2, *inside.shape[1:]), np.int8)
    for first in range(0, len(inside), 2):
        pair = slice(first, first + 2)
        _search(inside[pair], flag_cost[:, pair], type_cost[pair], types[pair])
    return inside, types


@njit(cache=True)
def _best_types(f0, f1, b0, b1, front, back, layers):  # type: ignore[no-untyped-def]
    """Cheapest consistent types of one grid edge on a pair of layers, given both flags on each."""
    best_f, cost_f = _best_single(f0, f1, front)
    if layers == 1:
        return cost_f, best_f, 0
    best_b, cost_b = _best_single(b0, b1, back)
    total = cost_f + cost_b
    if (f0 and b0) or (f1 and b1):
        sewn = front[_FRONT_TO_BACK] + back[_FRONT_TO_BACK]
        if f0 == f1 or f0 != b0 or f1 != b1:
            sewn += ODD_FOLD_COST
        if sewn < total:
            return sewn, _FRONT_TO_BACK, _FRONT_TO_BACK
    return total, best_f, best_b


@njit(cache=True)
def _best_single(a, b, cost):  # type: ignore[no-untyped-def]
    if not a and not b:
        return _NON_BOUNDARY, cost[_NON_BOUNDARY]
    if a != b:
        return _NON_STITCH, cost[_NON_STITCH]
    best = _NON_BOUNDARY
    if cost[_NON_STITCH] < cost[best]:
        best = _NON_STITCH
    if cost[_SIDE_BY_SIDE] < cost[best]:
        best = _SIDE_BY_SIDE
    return best, cost[best]


@njit(cache=True)
def _flag(inside, layer, row, col):  # type: ignore[no-untyped-def]
    if layer >= inside.shape[0] or row < 0 or col < 0:
        return False
    return inside[layer, row, col]


@njit(cache=True)
def _edge(inside, type_cost, h, row, col):  # type: ignore[no-untyped-def]
    """`_best_types` of the bottom (h = 0) or left (h = 1) grid edge of a cell."""
    other_row, other_col = (row - 1, col) if h == 0 else (row, col - 1)
    layers = len(inside)
    return _best_types(
        _flag(inside, 0, other_row, other_col),
        _flag(inside, 0, row, col),
        _flag(inside, 1, other_row, other_col),
        _flag(inside, 1, row, col),
        type_cost[0, h, :, row, col],
        type_cost[layers - 1, h, :, row, col],
        layers,
    )


@njit(cache=True)
def _search(inside, flag_cost, type_cost, types):  # type: ignore[no-untyped-def]
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
                    cost = 0.0
                    for layer in range(layers):
                        flag = (choice >> layer) & 1
                        inside[layer, row, col] = flag == 1
                        cost += flag_cost[flag, layer, row, col]
                    cost += _edge(inside, type_cost, 0, row, col)[0]
                    cost += _edge(inside, type_cost, 1, row, col)[0]
                    if row + 1 < grid:
                        cost += _edge(inside, type_cost, 0, row + 1, col)[0]
                    if col + 1 < grid:
                        cost += _edge(inside, type_cost, 1, row, col + 1)[0]
                    if cost < best_cost - 1e-9:
                        best, best_cost = choice, cost
                for layer in range(layers):
                    inside[layer, row, col] = (best >> layer) & 1 == 1
                changed = changed or best != now
        if not changed:
            break
    for h in range(2):
        for row in range(grid):
            for col in range(grid):
                _, front, back = _edge(inside, type_cost, h, row, col)
                types[0, h, row, col] = front
                if layers > 1:
                    types[1, h, row, col] = back
