"""Unary costs of flags and edge types, and the least-cost labelling in which all agrees.

Costs are negative log probabilities [nats]. A labelling agrees when every grid edge fits the cells
on both sides of it, on both layers: a boundary between inside and outside, `NON_BOUNDARY` outside,
`SIDE_BY_SIDE` between two inside cells, `FRONT_TO_BACK` and `WRAP` on both layers or on neither,
`SHEET` where it has a partner on the other sheet, `ONTO` round cloth over other cloth.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from garmentimage.raster.channel_kind import ChannelKind
from garmentimage.raster.channels import check_channels, one_hot, split_channels
from garmentimage.raster.image import BOTTOM, LEFT, EdgeType, GarmentImage
from garmentimage.raster.repair._kernels import minimise_pair, set_types

MAX_COST = 14.0  # cost of a probability of 0, and the largest of all [nats]

IMPOSSIBLE_COST = 1e6  # cost of what the channel contract has no channel for [nats]

NEIGHBOUR_GAIN = 0.2  # what a type gains from each grid edge of the same type that it touches

_NON_BOUNDARY = int(EdgeType.NON_BOUNDARY)
_SHEET, _ONTO = int(EdgeType.SHEET), int(EdgeType.ONTO)


@dataclass(frozen=True)
class UnaryCosts:
    """Costs of every value of flags and edge types [nats], and the deformation."""

    inside: Float[np.ndarray, "2 layer row col"]  # cost of outside, and of inside
    types: Float[np.ndarray, "layer 2 type row col"]
    """Cost of each `EdgeType` of the bottom and left grid edge."""
    deformation: Float[np.ndarray, "layer 4 2 row col"]
    turned: Float[np.ndarray, "2 layer row col"]  # cost of not turned, and of turned


def unary_costs(array: np.ndarray, kind: ChannelKind) -> UnaryCosts:
    """Costs from what a network gives.

    Args:
        array: [17 L or 26 L, N, N], as `GarmentImage.to_channels` orders them.
        kind: what its flags and types are. Channels are decided, and their costs 0 or `MAX_COST`.

    Raises:
        ImageError: a wrong shape, or values that are not finite.
    """
    flags, types, vectors, turned = split_channels(check_channels(array))
    if kind == "channels":
        decided = one_hot_costs(GarmentImage.from_channels(array, kind=kind))
        found = UnaryCosts(decided.inside, decided.types, vectors, decided.turned)
        return replace(found, types=_with_all_types(found.types[:, :, : types.shape[2]]))
    # What contract 1 has no channel for does not occur.
    never = np.stack([np.zeros_like(flags), np.full_like(flags, IMPOSSIBLE_COST)])
    if kind == "logits":
        # -log softmax(t) = log(sum of all exp(t)) - t.
        each = np.logaddexp.reduce(types, axis=2, keepdims=True) - types
        is_turned = never if turned is None else _flag_cost_of_logits(turned)
        each = _with_all_types(np.minimum(each, MAX_COST))
        return UnaryCosts(_flag_cost_of_logits(flags), each, vectors, is_turned)
    shares = types.clip(0, 1)
    total = shares.sum(axis=2, keepdims=True)
    # Zeros alone say nothing, so that all types are as likely.
    even = np.full_like(shares, 1 / types.shape[2])
    shares = np.divide(shares, total, out=even, where=total > 0)
    is_turned = never if turned is None else _flag_cost(turned)
    return UnaryCosts(_flag_cost(flags), _with_all_types(_cost(shares)), vectors, is_turned)


def _with_all_types(
    costs: Float[np.ndarray, "layer 2 type row col"],
) -> Float[np.ndarray, "layer 2 all row col"]:
    """Costs of all edge types; those that a contract lacks are impossible."""
    layers, sides, count, rows, cols = costs.shape
    lacking = np.full((layers, sides, len(EdgeType) - count, rows, cols), IMPOSSIBLE_COST)
    return np.concatenate([costs, lacking], axis=2)


def _flag_cost(shares: Float[np.ndarray, "layer row col"]) -> Float[np.ndarray, "2 layer row col"]:
    inside = shares.clip(0, 1)
    return _cost(np.stack([1 - inside, inside]))


def _flag_cost_of_logits(
    flags: Float[np.ndarray, "layer row col"],
) -> Float[np.ndarray, "2 layer row col"]:
    # -log sigmoid(±f)
    return np.asarray(np.minimum(np.logaddexp(0, np.stack([flags, -flags])), MAX_COST))


def _cost(probability: np.ndarray) -> np.ndarray:
    return np.asarray(-np.log(np.maximum(probability, np.exp(-MAX_COST))))


def one_hot_costs(image: GarmentImage) -> UnaryCosts:
    """Costs with which any change of `image` costs `MAX_COST`."""
    inside, turned = (
        np.where(np.stack([flags, ~flags]), MAX_COST, 0.0) for flags in (image.inside, image.turned)
    )
    types = np.where(one_hot(image.edge_type, len(EdgeType)), 0.0, MAX_COST)
    return UnaryCosts(inside, types, image.deformation, turned)


def with_neighbour_gain(
    costs: Float[np.ndarray, "layer 2 type row col"], types: np.ndarray
) -> Float[np.ndarray, "layer 2 type row col"]:
    """Costs less what each type gains from the touching grid edges that have it."""
    layers, _, grid, _ = types.shape
    type_count = costs.shape[2]
    # A Potts term between grid edges that touch, at the types as they are: what continues a wall is
    # cheaper. Counted are the grid edges of each type at every lattice point.
    at_point = np.zeros((layers, type_count, grid + 1, grid + 1))
    is_type = one_hot(types, type_count).astype(float)
    bottom, left = is_type[:, BOTTOM], is_type[:, LEFT]
    at_point[:, :, :-1, :-1] += bottom + left
    at_point[:, :, :-1, 1:] += bottom
    at_point[:, :, 1:, :-1] += left
    near = np.empty_like(costs)
    near[:, BOTTOM] = at_point[:, :, :-1, :-1] + at_point[:, :, :-1, 1:] - 2 * bottom
    near[:, LEFT] = at_point[:, :, :-1, :-1] + at_point[:, :, 1:, :-1] - 2 * left
    near[:, :, _NON_BOUNDARY] = 0
    return np.ascontiguousarray(costs - NEIGHBOUR_GAIN * near)


def minimise_energy(
    inside: Bool[np.ndarray, "layer row col"],
    flag_cost: Float[np.ndarray, "2 layer row col"],
    type_cost: Float[np.ndarray, "layer 2 type row col"],
) -> tuple[Bool[np.ndarray, "layer row col"], np.ndarray]:
    """Flags and types of least cost that agree, by local search from `inside`; see `UnaryCosts`."""
    inside, type_cost = inside.copy(), type_cost.copy()
    types = np.empty((len(inside), 2, *inside.shape[1:]), np.int8)
    type_cost[:2, :, _ONTO] = IMPOSSIBLE_COST
    if len(inside) <= 2:
        type_cost[:, :, _SHEET] = IMPOSSIBLE_COST
    pairs = [slice(first, first + 2) for first in range(0, len(inside), 2)]
    for pair in pairs:
        minimise_pair(inside[pair], flag_cost[:, pair], type_cost[pair])
    while True:
        for pair in pairs:
            set_types(inside[pair], type_cost[pair], types[pair])
        # What is sewn to nothing on the other sheet takes its next best type.
        between_sheets = np.isin(types, (_SHEET, _ONTO))
        lonely = np.argwhere(between_sheets & ~_has_sheet_partner(inside, types))
        if not len(lonely):
            return inside, types
        layer, side, row, col = lonely.T
        type_cost[layer, side, types[layer, side, row, col], row, col] = IMPOSSIBLE_COST


def _has_sheet_partner(
    inside: Bool[np.ndarray, "layer row col"], types: np.ndarray
) -> Bool[np.ndarray, "layer 2 row col"]:
    """Where a grid edge of type `SHEET` or `ONTO` has cloth to be sewn to, as `decode` finds it."""
    found = np.zeros(types.shape, bool)
    is_sheet, is_onto = types == _SHEET, types == _ONTO
    if not (is_sheet | is_onto).any():
        return found
    # The cells before (below, left of) each grid edge, and those that store it.
    before = np.zeros_like(types, bool)
    before[:, BOTTOM, 1:], before[:, LEFT, :, 1:] = inside[:, :-1], inside[:, :, :-1]
    after = np.repeat(inside[:, None], 2, axis=1)
    for layer in range(len(inside)):
        for other in {layer ^ 2, layer ^ 3} & set(range(len(inside))):
            if other == layer ^ 2:
                sewn = (before[layer] & after[other]) | (after[layer] & before[other])
            else:
                sewn = (before[layer] & before[other]) | (after[layer] & after[other])
            found[layer] |= sewn & is_sheet[other] & is_sheet[layer]
        if layer >= 2:
            # One panel lies beneath both sides of what is sewn onto it.
            goes_on = before[layer - 2] & after[layer - 2] & (types[layer - 2] == _NON_BOUNDARY)
            found[layer] |= is_onto[layer] & goes_on
    return found
