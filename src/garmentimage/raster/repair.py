"""Repair of images that networks give: the least-cost consistent labelling, then whole seams.

Costs are negative log probabilities [nats]. A correct, certain image has cost 0 and every change
of it would cost more than any rule below may spend, so it is never changed.

- A **wall** is a grid edge between two inside cells that is not `NON_BOUNDARY`.
- A **tip** is a lattice point where a chain of walls ends inside a panel.
- An **interface** is all walls, found or merely likely, between the same two regions.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int
from numba import njit

from garmentimage.errors import ImageError
from garmentimage.raster.cells import label_panels
from garmentimage.raster.image import (
    BOTTOM,
    CHANNELS_PER_LAYER,
    EDGE_TYPE_COUNT,
    LEFT,
    EdgeType,
    GarmentImage,
    check_channels,
)

RepairLevel = Literal["full", "paper", "none"]
LEVELS: tuple[RepairLevel, ...] = ("full", "paper", "none")

CERTAIN_COST = 14.0
"""Cost of what a network gave no probability at all."""

ODD_FOLD_COST = 2.0
"""A front-to-back seam normally has cloth on one and the same side of it in both layers; else it
costs this much more."""

NEIGHBOUR_GAIN = 0.2
"""What a type gains from each grid edge of the same type that it touches."""

LIKELY_WALL = 0.25
"""Probability from which a grid edge counts as a possible wall when regions are made."""

BROKEN_COST = 2.5
"""What a seam that divides only in part, or a slit, must be worth to stay as it is."""

SMALL_REGION, SMALL_COST = 3, 4.0
"""A region of fewer cells must be worth this much to stay on its own."""

BAND_LENGTH, BAND_SURENESS = 3, 1.5
"""A band one cell wide and at least this long stays one only if the probabilities of the seams on
its two sides sum to more than this: near 1 it is one seam whose place is uncertain."""

DART_OPENING = 0.03
"""Two legs whose vectors differ by this share of their length may belong to an open dart."""

SHARED_TOL = 0.12
"""Two cells that share an undivided grid edge give it the same vector, to this share of it."""

PROBABILITY_SLACK = 0.25
"""Values this far beyond 0..1 still count as probabilities that a network missed a little."""

CELL_SIZE_LIMITS = (0.2, 5.0)
"""A cell that was not meant to be inside keeps its own vectors if they are this many times the
grid's own cell, else it takes those of its neighbours."""

_NON_BOUNDARY, _NON_STITCH = int(EdgeType.NON_BOUNDARY), int(EdgeType.NON_STITCH)
_FRONT_TO_BACK, _SIDE_BY_SIDE = int(EdgeType.FRONT_TO_BACK), int(EdgeType.SIDE_BY_SIDE)
_SWEEPS = 20


@dataclass(frozen=True)
class RepairReport:
    """What a repair changed."""

    level: RepairLevel
    counts: Mapping[str, int] = field(default_factory=dict)
    """By rule: how many cells, grid edges, seams or regions it changed, if any."""

    @property
    def changed(self) -> bool:
        """Whether anything was."""
        return any(self.counts.values())


@dataclass(frozen=True)
class Beliefs:
    """What a network thinks: costs of every choice [nats], and deformation."""

    inside: Float[np.ndarray, "2 layer row col"]
    """Cost of outside, and of inside."""
    types: Float[np.ndarray, "layer 2 4 row col"]
    """Cost of each type of the bottom and left grid edge."""
    deformation: Float[np.ndarray, "layer 4 2 row col"]


def repair(
    image: GarmentImage | np.ndarray, level: RepairLevel = "full"
) -> tuple[GarmentImage, RepairReport]:
    """Make an image consistent.

    Channels may hold probabilities or logits, block by block: a flag channel within 0..1 (give or
    take `PROBABILITY_SLACK`) holds probabilities, else logits; so do the four values of a grid
    edge's type, if they also sum to more than 0 everywhere.

    Levels:
        none: the likeliest value of everything, consistent or not.
        paper: then the paper's two cases: a `NON_STITCH` grid edge between two `FRONT_TO_BACK` ones
            becomes `FRONT_TO_BACK` (where the other layer says so: read literally, the rule
            changes correct images); a `NON_BOUNDARY` one between two tips of `SIDE_BY_SIDE` walls
            becomes `SIDE_BY_SIDE` (unless they are the tips of two darts).
        full: the least-cost labelling in which every grid edge agrees with its cells (a boundary
            between inside and outside; `NON_BOUNDARY` outside; `SIDE_BY_SIDE` between two inside
            cells; `FRONT_TO_BACK` on both layers or neither), found by local search; then seams
            are made whole or dropped, small regions merged, uncertain bands made one seam, and
            the paper's cases mended.

    A correct image comes back unchanged.

    Raises:
        ImageError: the array has a wrong shape, or values that are not finite; no such level.
    """
    if level not in LEVELS:
        raise ImageError(f"no repair level {level!r}; there are {', '.join(LEVELS)}")
    if isinstance(image, GarmentImage):
        given, beliefs = image, None
    else:
        beliefs = read_beliefs(image)
        given = _likeliest(beliefs)
    if level == "none":
        return given, RepairReport(level)
    if level == "paper":
        types, count = _mend_paper_cases(given)
        mended = replace(given, edge_type=types) if any(count.values()) else given
        return mended, RepairReport(level, _positive(count))
    return _repair_fully(given, beliefs)


def read_beliefs(array: np.ndarray) -> Beliefs:
    """Costs from channels that hold probabilities or logits.

    Args:
        array: [17 L, N, N], as `GarmentImage.to_channels` orders them.

    Raises:
        ImageError: a wrong shape, or values that are not finite.
    """
    array = check_channels(array)
    grid, layers = array.shape[-1], len(array) // CHANNELS_PER_LAYER
    block = array.reshape(layers, CHANNELS_PER_LAYER, grid, grid)
    flags = np.stack([_flag_costs(block[k, 0]) for k in range(layers)], axis=1)
    one_hot = block[:, 1:9].reshape(layers, 2, EDGE_TYPE_COUNT, grid, grid)
    types = np.stack([[_type_costs(one_hot[k, h]) for h in (0, 1)] for k in range(layers)])
    return Beliefs(flags, types, block[:, 9:].reshape(layers, 4, 2, grid, grid))


def _is_probability(values: np.ndarray) -> bool:
    return bool(values.min() >= -PROBABILITY_SLACK and values.max() <= 1 + PROBABILITY_SLACK)


def _cost(probability: np.ndarray) -> np.ndarray:
    return -np.log(np.maximum(probability, np.exp(-CERTAIN_COST)))


def _flag_costs(values: np.ndarray) -> Float[np.ndarray, "2 row col"]:
    if _is_probability(values):
        p = np.clip(values, 0, 1)
        return np.stack([_cost(1 - p), _cost(p)])
    return np.minimum(np.logaddexp(0, np.stack([values, -values])), CERTAIN_COST)


def _type_costs(values: np.ndarray) -> Float[np.ndarray, "4 row col"]:
    clipped = np.clip(values, 0, 1)
    total = clipped.sum(axis=0)
    if _is_probability(values) and total.min() > 0:
        return _cost(clipped / total)
    shifted = values - values.max(axis=0)
    return np.minimum(np.log(np.exp(shifted).sum(axis=0)) - shifted, CERTAIN_COST)


def _likeliest(beliefs: Beliefs) -> GarmentImage:
    """Every flag and type at its likeliest, consistent or not."""
    inside = beliefs.inside[1] < beliefs.inside[0]
    one_hot = np.exp(-beliefs.types)
    channels = [
        np.concatenate(
            [
                inside[k][None],
                one_hot[k].reshape(-1, *inside[k].shape),
                beliefs.deformation[k].reshape(8, *inside[k].shape),
            ]
        )
        for k in range(len(inside))
    ]
    return GarmentImage.from_channels(np.concatenate(channels))


def _certain(image: GarmentImage) -> Beliefs:
    """The beliefs of someone who believes every channel of `image`."""
    inside = np.where(np.stack([image.inside, ~image.inside]), CERTAIN_COST, 0.0)
    one_hot = image.edge_type[:, :, None] == np.arange(EDGE_TYPE_COUNT)[:, None, None]
    return Beliefs(inside, np.where(one_hot, 0.0, CERTAIN_COST), image.deformation)


def _positive(counts: Mapping[str, int]) -> dict[str, int]:
    return {rule: n for rule, n in counts.items() if n}


def _repair_fully(
    given: GarmentImage, beliefs: Beliefs | None
) -> tuple[GarmentImage, RepairReport]:
    """Repair at the full level; without beliefs every channel of `given` is believed, and the
    rules that weigh evidence have nothing to weigh.
    """
    costs = beliefs if beliefs is not None else _certain(given)
    flag_cost = np.ascontiguousarray(costs.inside, float)
    type_cost = _with_neighbours(costs.types, given.edge_type)
    inside, types = _relabel(given.inside, flag_cost, type_cost)
    counts = {
        "inconsistent flags": int((inside != given.inside).sum()),
        "inconsistent edge types": int((types != given.edge_type).sum()),
    }
    if beliefs is not None:
        counts["seams and slits made whole or dropped"] = _whole_seams(inside, types, type_cost)
        counts["small regions merged"] = _merge_small(inside, types, flag_cost, type_cost)
        counts["uncertain bands made one seam"] = _merge_bands(
            inside, types, beliefs.types, type_cost
        )
        inside, types = _relabel(inside, flag_cost, type_cost)
    mended = replace(given, inside=inside, edge_type=types)
    types, paper = _mend_paper_cases(mended)
    counts |= paper
    deformation, filled = _fill_deformation(given, costs.deformation, inside, types)
    counts["deformations filled in"] = filled
    counts = _positive(counts)
    if not counts:
        return given, RepairReport("full")
    image = replace(given, inside=inside, edge_type=types, deformation=deformation)
    return image, RepairReport("full", counts)


def _with_neighbours(
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


def _relabel(
    inside: Bool[np.ndarray, "layer row col"], flag_cost: np.ndarray, type_cost: np.ndarray
) -> tuple[Bool[np.ndarray, "layer row col"], np.ndarray]:
    """Flags and types of least cost that agree, by local search from `inside`."""
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


Wall = tuple[int, int, int]
"""(h, row, col) of a grid edge of one layer: h = 0 the bottom, 1 the left edge of the cell."""


def _sides(wall: Wall) -> tuple[tuple[int, int], tuple[int, int]]:
    """The cell before (below or left of) a grid edge, and the cell that stores it."""
    h, row, col = wall
    return ((row - 1, col) if h == BOTTOM else (row, col - 1)), (row, col)


def _ends(wall: Wall) -> tuple[tuple[int, int], tuple[int, int]]:
    """Lattice points (row, col) at both ends of a grid edge."""
    h, row, col = wall
    return (row, col), ((row, col + 1) if h == BOTTOM else (row + 1, col))


def _inner_edges(inside: Bool[np.ndarray, "row col"]) -> Bool[np.ndarray, "2 row col"]:
    """Grid edges between two inside cells."""
    inner = np.zeros((2, *inside.shape), bool)
    inner[BOTTOM, 1:] = inside[1:] & inside[:-1]
    inner[LEFT, :, 1:] = inside[:, 1:] & inside[:, :-1]
    return inner


def _whole_seams(inside: np.ndarray, types: np.ndarray, cost: np.ndarray) -> int:
    """Make each interface and each slit one type where that is cheaper than leaving it broken.

    Changes `types`, and `cost` so that the decision lasts.

    Returns:
        How many interfaces and slits were changed.
    """
    changed = 0
    for layer in range(len(inside)):
        inner = _inner_edges(inside[layer]) & (types[layer] != _FRONT_TO_BACK)
        extra = cost[layer, :, _SIDE_BY_SIDE] - cost[layer, :, _NON_BOUNDARY]
        likely = inner & (extra < np.log(1 / LIKELY_WALL - 1))
        walls = np.where(likely | (inner & (types[layer] > 0)), _SIDE_BY_SIDE, types[layer])
        regions, _ = label_panels(inside[layer : layer + 1], walls[None].astype(np.int8))
        groups: dict[tuple[int, int], list[Wall]] = {}
        for h, row, col in np.argwhere(inner & (walls > 0)).tolist():
            first, second = (int(regions[0][cell]) for cell in _sides((h, row, col)))
            groups.setdefault((min(first, second), max(first, second)), []).append((h, row, col))
        for (first, second), group in sorted(groups.items()):
            chains = _connected(group) if first == second else [group]
            for chain in chains:
                changed += _settle(chain, types[layer], cost[layer], divides=first != second)
    return changed


def _connected(walls: list[Wall]) -> list[list[Wall]]:
    """Walls grouped into chains that hang together."""
    at: dict[tuple[int, int], list[Wall]] = {}
    for wall in walls:
        for point in _ends(wall):
            at.setdefault(point, []).append(wall)
    seen: set[Wall] = set()
    chains = []
    for wall in walls:
        if wall in seen:
            continue
        seen.add(wall)
        chain, queue = [], [wall]
        while queue:
            chain.append(queue.pop())
            for near in (w for point in _ends(chain[-1]) for w in at[point]):
                if near not in seen:
                    seen.add(near)
                    queue.append(near)
        chains.append(chain)
    return chains


def _settle(chain: list[Wall], types: np.ndarray, cost: np.ndarray, *, divides: bool) -> bool:
    """Give a chain one type if that costs less than its present types and being broken."""
    h, row, col = np.array(chain).T
    own = types[h, row, col]
    if divides and (own == own[0]).all():
        return False
    if not own.any():
        return False
    options = (_NON_BOUNDARY, _SIDE_BY_SIDE, _NON_STITCH) if divides else (_NON_BOUNDARY,)
    totals = [float(cost[h, t, row, col].sum()) for t in options]
    k = int(np.argmin(totals))
    if totals[k] >= float(cost[h, own, row, col].sum()) + BROKEN_COST:
        return False
    _decide(chain, options[k], types, cost)
    return True


def _decide(walls: list[Wall], kind: int, types: np.ndarray, cost: np.ndarray) -> None:
    """Give grid edges of one layer a type for good."""
    h, row, col = np.array(walls).T
    types[h, row, col] = kind
    inner = np.array([_NON_BOUNDARY, _NON_STITCH, _SIDE_BY_SIDE])
    for other in inner[inner != kind]:
        cost[h, other, row, col] = np.maximum(cost[h, other, row, col], CERTAIN_COST)
    cost[h, kind, row, col] = 0.0


def _interfaces(
    regions: Int[np.ndarray, "row col"], types: Int[np.ndarray, "2 row col"]
) -> dict[int, dict[int, list[Wall]]]:
    """For each region its side-by-side neighbours and the walls between them."""
    found: dict[int, dict[int, list[Wall]]] = {}
    for h, row, col in np.argwhere(types == _SIDE_BY_SIDE).tolist():
        (a, b) = (int(regions[cell]) for cell in _sides((h, row, col)))
        if a != b:
            found.setdefault(a, {}).setdefault(b, []).append((h, row, col))
            found.setdefault(b, {}).setdefault(a, []).append((h, row, col))
    return found


def _merge_small(
    inside: np.ndarray, types: np.ndarray, flag_cost: np.ndarray, cost: np.ndarray
) -> int:
    """Merge small uncertain regions into their likeliest neighbour; drop those without one."""
    merged = 0
    for layer in range(len(inside)):
        regions, count = label_panels(inside[layer : layer + 1], types[layer : layer + 1])
        near = _interfaces(regions[0], types[layer])
        sizes = np.bincount(regions[regions >= 0], minlength=count)
        for k in np.flatnonzero(sizes < SMALL_REGION).tolist():
            prices = sorted(
                (float(sum(cost[layer, h, _NON_BOUNDARY, r, c] - cost[layer, h, t, r, c])), other)
                for other, walls in near.get(k, {}).items()
                for t, (h, r, c) in [(_SIDE_BY_SIDE, np.array(walls).T)]
            )
            if prices and prices[0][0] < SMALL_COST:
                _decide(near[k][prices[0][1]], _NON_BOUNDARY, types[layer], cost[layer])
                merged += 1
            elif not prices:
                cells = regions[0] == k
                price = (flag_cost[0, layer] - flag_cost[1, layer])[cells].sum()
                if price < SMALL_COST:
                    flag_cost[1, layer][cells] = 2 * CERTAIN_COST
                    inside[layer][cells] = False
                    merged += 1
    return merged


def _merge_bands(
    inside: np.ndarray, types: np.ndarray, belief: np.ndarray, cost: np.ndarray
) -> int:
    """Merge a band one cell wide into a neighbour where its two seams are one uncertain seam."""
    merged = 0
    for layer in range(len(inside)):
        regions, count = label_panels(inside[layer : layer + 1], types[layer : layer + 1])
        near = _interfaces(regions[0], types[layer])
        for k in range(count):
            rows, cols = np.nonzero(regions[0] == k)
            if len(rows) < BAND_LENGTH or min(np.ptp(rows), np.ptp(cols)) > 0:
                continue
            across = BOTTOM if np.ptp(rows) == 0 else LEFT
            sides: list[tuple[float, list[Wall]]] = []
            for walls in near.get(k, {}).values():
                along = [w for w in walls if w[0] == across]
                if 2 * len(along) >= len(rows):
                    h, r, c = np.array(along).T
                    sides.append(
                        (float(np.exp(-belief[layer, h, _SIDE_BY_SIDE, r, c]).mean()), walls)
                    )
            if len(sides) == 2 and sides[0][0] + sides[1][0] < BAND_SURENESS:
                _decide(min(sides)[1], _NON_BOUNDARY, types[layer], cost[layer])
                merged += 1
    return merged


def _mend_paper_cases(
    image: GarmentImage,
) -> tuple[Int[np.ndarray, "layer 2 row col"], dict[str, int]]:
    """The two invalid patterns that the paper mends."""
    types = image.edge_type.copy()
    sewn = 0
    for layer in range(image.layers):
        if layer ^ 1 >= image.layers:
            continue
        gaps = (types[layer] == _NON_STITCH) & (types[layer ^ 1] == _FRONT_TO_BACK)
        for h, row, col in np.argwhere(gaps).tolist():
            if all(_touching(types[layer], (h, row, col), p, _FRONT_TO_BACK) for p in (0, 1)):
                types[layer, h, row, col] = _FRONT_TO_BACK
                sewn += 1
    closed = 0
    for layer in range(image.layers):
        inner = _inner_edges(image.inside[layer]) & (types[layer] == _NON_BOUNDARY)
        # A wall can only be missing where walls end: most images have no such place.
        for h, row, col in np.argwhere(inner & _between_walls(types[layer])).tolist():
            if _is_missing_wall(image, types[layer], layer, (h, row, col)):
                types[layer, h, row, col] = _SIDE_BY_SIDE
                closed += 1
    return types, {"gaps in front-to-back seams": sewn, "gaps in side-by-side seams": closed}


def _between_walls(types: Int[np.ndarray, "2 row col"]) -> Bool[np.ndarray, "2 row col"]:
    """Grid edges with a side-by-side grid edge at both ends."""
    grid = types.shape[-1]
    at_point = np.zeros((grid + 1, grid + 1), bool)
    bottom, left = types == _SIDE_BY_SIDE
    at_point[:-1, :-1] |= bottom | left
    at_point[:-1, 1:] |= bottom
    at_point[1:, :-1] |= left
    both = np.zeros(types.shape, bool)
    both[BOTTOM] = at_point[:-1, :-1] & at_point[:-1, 1:]
    both[LEFT] = at_point[:-1, :-1] & at_point[1:, :-1]
    return both


def _around(types: np.ndarray, point: tuple[int, int]) -> list[Wall]:
    """The stored grid edges at a lattice point."""
    row, col = point
    grid = types.shape[-1]
    edges = ((BOTTOM, row, col), (BOTTOM, row, col - 1), (LEFT, row, col), (LEFT, row - 1, col))
    return [e for e in edges if 0 <= e[1] < grid and 0 <= e[2] < grid]


def _touching(types: np.ndarray, wall: Wall, end: int, kind: int) -> list[Wall]:
    """Other grid edges of type `kind` at one end of a grid edge."""
    return [w for w in _around(types, _ends(wall)[end]) if w != wall and types[w] == kind]


def _is_missing_wall(image: GarmentImage, types: np.ndarray, layer: int, wall: Wall) -> bool:
    """Whether the grid edge lies between two tips of one seam, which it would complete."""
    slits = []
    for end in (0, 1):
        walls = [w for w in _around(types, _ends(wall)[end]) if w != wall and types[w]]
        if len(walls) != 1 or types[walls[0]] != _SIDE_BY_SIDE:
            return False
        slits.append(walls[0])
    filled = types.copy()
    filled[wall] = _SIDE_BY_SIDE
    regions, _ = label_panels(image.inside[layer : layer + 1], filled[None])
    before, after = _sides(wall)
    if regions[0][before] == regions[0][after]:
        return False
    # The tips of two darts may face each other too, across cloth that is whole.
    is_cloth = _disagreement(image, layer, wall) < SHARED_TOL
    return not (is_cloth and all(_disagreement(image, layer, s) > DART_OPENING for s in slits))


def _disagreement(image: GarmentImage, layer: int, wall: Wall) -> float:
    """How far the two cells beside a grid edge differ about its vector, as a share of it."""
    before, after = _sides(wall)
    far, near = (2, 0) if wall[0] == BOTTOM else (1, 3)
    a = image.deformation[layer, far, :, before[0], before[1]].astype(float)
    b = image.deformation[layer, near, :, after[0], after[1]].astype(float)
    return float(np.hypot(*(a - b)) / max(np.hypot(*a), np.hypot(*b), 1e-9))


def _fill_deformation(
    given: GarmentImage, deformation: np.ndarray, inside: np.ndarray, types: np.ndarray
) -> tuple[np.ndarray, int]:
    """Vectors for cells that have none, from their neighbours, else from the grid; none outside.

    Returns:
        float32 [layer, 4, 2, row, col], and how many cells were filled in.
    """
    vectors = np.where(inside[:, None, None], deformation, 0.0)
    columns, rows = np.diff(given.frame.columns), np.diff(given.frame.rows)
    rest = np.zeros(vectors.shape[1:])
    rest[[0, 2], 0], rest[[1, 3], 1] = columns[None, :], rows[:, None]
    size = np.abs(vectors).sum(axis=(1, 2)) / np.abs(rest).sum(axis=(0, 1))
    low, high = CELL_SIZE_LIMITS
    new = inside & ~given.inside & ((size < low) | (size > high))
    missing = new | (inside & (size == 0))
    count = int(missing.sum())
    while missing.any():
        known = inside & ~missing
        total, number = np.zeros_like(vectors), np.zeros(inside.shape)
        for axis, h in ((1, BOTTOM), (2, LEFT)):
            joined = types[:, h] == _NON_BOUNDARY
            for step in (1, -1):
                source = np.roll(known, step, axis) & (
                    joined if step == 1 else np.roll(joined, -1, axis)
                )
                edge: list[slice | int] = [slice(None)] * 3
                edge[axis] = 0 if step == 1 else -1
                source[tuple(edge)] = False
                number += source
                total += source[:, None, None] * np.roll(vectors, step, axis + 2)
        ready = missing & (number > 0)
        if not ready.any():
            vectors = np.where(missing[:, None, None], rest, vectors)
            break
        mean = total / np.maximum(number, 1)[:, None, None]
        vectors = np.where(ready[:, None, None], mean, vectors)
        missing &= ~ready
    return vectors.astype(np.float32), count
