"""Creases in repair: inner grid edges while walls are decided, then those that start at a wall."""

import numpy as np
from jaxtyping import Bool, Float, Int8

from garmentimage.raster.image import BOTTOM, LEFT, EdgeType

_NON_BOUNDARY, _CREASE = int(EdgeType.NON_BOUNDARY), int(EdgeType.CREASE)

Types = Int8[np.ndarray, "layer 2 row col"]
Costs = Float[np.ndarray, "layer 2 type row col"]


def without_creases(types: Types) -> Types:
    """Edge types, creases as `NON_BOUNDARY`."""
    return np.where(types == _CREASE, _NON_BOUNDARY, types).astype(np.int8)


def with_creases_inner(cost: Costs) -> Costs:
    """Costs of edge types in which `NON_BOUNDARY` costs no more than a crease."""
    cost = cost.copy()
    cost[:, :, _NON_BOUNDARY] = cost[:, :, [_NON_BOUNDARY, _CREASE]].min(axis=2)
    return cost


def with_creases(types: Types, inside: Bool[np.ndarray, "layer row col"], cost: Costs) -> Types:
    """Edge types with creases, where they cost less than `NON_BOUNDARY`.

    A crease lies between two inside cells and starts at a wall or a boundary, as the folds of
    pleats do, itself or through others: what floats in the cloth is left out.
    """
    inner = np.zeros(types.shape, bool)
    inner[:, BOTTOM, 1:] = inside[:, 1:] & inside[:, :-1]
    inner[:, LEFT, :, 1:] = inside[:, :, 1:] & inside[:, :, :-1]
    wanted = inner & (types == _NON_BOUNDARY)
    wanted &= cost[:, :, _CREASE] < cost[:, :, _NON_BOUNDARY]
    found = types.copy()
    while True:
        reached = _points(found != _NON_BOUNDARY)
        added = wanted & (found == _NON_BOUNDARY)
        added[:, BOTTOM] &= reached[:, :-1, :-1] | reached[:, :-1, 1:]
        added[:, LEFT] &= reached[:, :-1, :-1] | reached[:, 1:, :-1]
        if not added.any():
            return found
        found[added] = _CREASE


def _points(edges: Bool[np.ndarray, "layer 2 row col"]) -> Bool[np.ndarray, "layer y x"]:
    """The lattice points at the ends of grid edges."""
    layers, _, rows, cols = edges.shape
    points = np.zeros((layers, rows + 1, cols + 1), bool)
    points[:, :-1, :-1] |= edges[:, BOTTOM] | edges[:, LEFT]
    points[:, :-1, 1:] |= edges[:, BOTTOM]
    points[:, 1:, :-1] |= edges[:, LEFT]
    return points
