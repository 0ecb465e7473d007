"""Walls inside panels: seams made whole or dropped, thin regions merged, the paper's cases.

- A **wall** is a grid edge between two inside cells that is not `NON_BOUNDARY`.
- A **tip** is a lattice point where a chain of walls ends inside a panel.
- A **region** is connected cells, as a panel is.
- An **interface** is all walls, found or merely likely, between the same two regions.

Costs are negative log probabilities [nats]. A rule that weighs them changes flags and types in
place, and the costs too, so that its decision lasts.
"""

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.geometry import connected_components
from garmentimage.raster.cells import label_panels
from garmentimage.raster.image import BOTTOM, LEFT, EdgeType, GarmentImage
from garmentimage.raster.repair.labelling import MAX_COST

LIKELY_WALL = 0.25
"""Probability from which a grid edge counts as a possible wall when regions are made."""

RARE_COST = 2.0
"""What a slit, the seam of a thin region, or a break in a seam must be worth to stay [nats]: 88 %
against nothing there.

It is minus the logarithm of how often garments have thin regions, 1.5 at N = 16 and 2.0 at 32
(`benchmarks/region_prior.py`, the mean share over drafts and three sources by others). Slits are as
frequent (1.4 at both). Breaks are rarer, but at their price, 4.6, what is 99 % sure would not stay.

Worth is the mean of the grid edges that would change: a network that wavers between two places of a
seam errs in all of them at once, so they are one witness, not many. What it is surer of is never
removed."""

SMALL_REGION, SMALL_GRID, BAND_LENGTH = 4, 16, 3
"""A region is thin if it has fewer cells than the first, on grids of at least so many cells a side
(on others half as many), or is one cell wide and at least so long."""

DART_OPENING = 0.03
"""Two legs whose vectors differ by this share of their length may belong to an open dart."""

SHARED_TOL = 0.12
"""Two cells that share an undivided grid edge give it the same vector, to this share of it."""

_NON_BOUNDARY, _NON_STITCH = int(EdgeType.NON_BOUNDARY), int(EdgeType.NON_STITCH)
_FRONT_TO_BACK, _SIDE_BY_SIDE = int(EdgeType.FRONT_TO_BACK), int(EdgeType.SIDE_BY_SIDE)
_WRAP, _CREASE = int(EdgeType.WRAP), int(EdgeType.CREASE)
_BETWEEN_LAYERS = (_FRONT_TO_BACK, _WRAP)
_CUTS = (_NON_STITCH, *_BETWEEN_LAYERS)

Flags = Bool[np.ndarray, "layer row col"]
Types = Int[np.ndarray, "layer 2 row col"]
Costs = Float[np.ndarray, "layer 2 type row col"]
Wall = tuple[int, int, int]
"""(h, row, col) of a grid edge of one layer: h = 0 the bottom, 1 the left edge of the cell."""


# Each rule weighs a local change. Its worth is the mean rise in cost of the grid edges it changes;
# it is made where that is less than `RARE_COST`, the price of what is rare in garments.
def unify_seams(inside: Flags, types: Types, cost: Costs) -> int:
    """Make each interface and each slit one type where that is cheaper than leaving it broken.

    Returns:
        How many interfaces and slits were changed.
    """
    changed = 0
    for layer in range(len(inside)):
        inner = _inner_edges(inside[layer]) & ~np.isin(types[layer], _BETWEEN_LAYERS)
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
                changed += _unify(chain, types[layer], cost[layer], divides=first != second)
    return changed


def _connected(walls: list[Wall]) -> list[list[Wall]]:
    """Walls grouped into connected chains."""
    at_point: dict[tuple[int, int], list[int]] = {}
    for k, wall in enumerate(walls):
        for point in _ends(wall):
            at_point.setdefault(point, []).append(k)
    joined = [pair for meeting in at_point.values() for pair in pairwise(meeting)]
    return [[walls[k] for k in chain] for chain in connected_components(len(walls), joined)]


def _unify(chain: list[Wall], types: np.ndarray, cost: np.ndarray, *, divides: bool) -> bool:
    """Give a chain one type if what stands against it is worth less than `RARE_COST`."""
    h, row, col = np.array(chain).T
    own = types[h, row, col]
    if divides and (own == own[0]).all():
        return False
    if not own.any():
        return False
    options = (_NON_BOUNDARY, _SIDE_BY_SIDE, _NON_STITCH) if divides else (_NON_BOUNDARY,)
    totals = [float(cost[h, t, row, col].sum()) for t in options]
    k = int(np.argmin(totals))
    changes = own != options[k]
    worth = (totals[k] - float(cost[h, own, row, col].sum())) / changes.sum()
    if worth >= RARE_COST:
        return False
    _fix_type(chain, options[k], types, cost)
    return True


def _fix_type(walls: list[Wall], kind: int, types: np.ndarray, cost: np.ndarray) -> None:
    """Give grid edges of one layer a type for good."""
    h, row, col = np.array(walls).T
    types[h, row, col] = kind
    inner = np.array([_NON_BOUNDARY, _NON_STITCH, _SIDE_BY_SIDE])
    for other in inner[inner != kind]:
        cost[h, other, row, col] = np.maximum(cost[h, other, row, col], MAX_COST)
    cost[h, kind, row, col] = 0.0


def merge_thin_regions(inside: Flags, types: Types, unary: Costs, cost: Costs) -> int:
    """Merge thin regions across their weakest seam, where that is worth less than `RARE_COST`.

    What it is worth is judged by `unary`, the costs of the types as the network gave them; what is
    decided is written to `cost`, what the types cost now.

    Returns:
        How many regions were merged.
    """
    merged = 0
    for layer in range(len(inside)):
        extra = unary[layer, :, _NON_BOUNDARY] - unary[layer, :, _SIDE_BY_SIDE]
        while weak := _weak_seams(inside[layer], types[layer], extra):
            for walls in weak:
                _fix_type(walls, _NON_BOUNDARY, types[layer], cost[layer])
            merged += len(weak)
    return merged


def _weak_seams(
    inside: np.ndarray, types: np.ndarray, extra: Float[np.ndarray, "2 row col"]
) -> list[list[Wall]]:
    """The weakest seams of thin regions of a layer, each region in one of them at most."""
    labels, count = label_panels(inside[None], types[None])
    regions = labels[0]
    near = _interfaces(regions, types)
    found = []
    for k in np.flatnonzero(_are_thin(regions, count)).tolist():
        for other, walls in near.get(k, {}).items():
            h, row, col = np.array(walls).T
            believed = [each for each in extra[h, row, col].tolist() if each > 0]
            worth = sum(believed) / max(len(believed), 1)
            if worth < RARE_COST:
                found.append((worth, k, other))
    # Greedy: the weakest first, then those between regions that have not been merged.
    weak: list[list[Wall]] = []
    touched: set[int] = set()
    for _, k, other in sorted(found):
        if not touched & {k, other}:
            touched |= {k, other}
            weak.append(near[k][other])
    return weak


def _are_thin(regions: Int[np.ndarray, "row col"], count: int) -> Bool[np.ndarray, " region"]:
    """Which regions are small, or bands of one cell's width."""
    rows, cols = np.nonzero(regions >= 0)
    label = regions[rows, cols]
    widths = []
    for at in (rows, cols):
        low, high = np.full(count, len(regions)), np.full(count, -1)
        np.minimum.at(low, label, at)
        np.maximum.at(high, label, at)
        widths.append(high - low)
    is_band = (np.minimum(*widths) == 0) & (np.maximum(*widths) + 1 >= BAND_LENGTH)
    return np.asarray(is_band | _are_small(regions, count))


def drop_isolated_regions(
    inside: Flags, types: Types, flag_cost: Float[np.ndarray, "2 layer row col"]
) -> int:
    """Drop small regions that are sewn to nothing beside them, where their flags are uncertain.

    They are worth what their flags are in the mean.

    Returns:
        How many regions were dropped.
    """
    dropped = 0
    for layer in range(len(inside)):
        labels, count = label_panels(inside[layer : layer + 1], types[layer : layer + 1])
        regions = labels[0]
        near = _interfaces(regions, types[layer])
        worth = flag_cost[0, layer] - flag_cost[1, layer]
        for k in np.flatnonzero(_are_small(regions, count)).tolist():
            cells = regions == k
            if k not in near and worth[cells].mean() < RARE_COST:
                flag_cost[1, layer][cells] = 2 * MAX_COST
                inside[layer][cells] = False
                dropped += 1
    return dropped


def _are_small(regions: Int[np.ndarray, "row col"], count: int) -> Bool[np.ndarray, " region"]:
    """Which regions have few cells."""
    limit = SMALL_REGION if len(regions) >= SMALL_GRID else SMALL_REGION // 2
    return np.asarray(np.bincount(regions[regions >= 0], minlength=count) < limit)


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


def unify_wraps(inside: Flags, types: Types, cost: Costs) -> int:
    """Make each chain between the same two regions of both layers a seam or a wrap as a whole.

    Cloth goes on round the body, or it is sewn there; which of the two is one decision.

    Returns:
        How many chains were changed.
    """
    changed = 0
    for first in range(0, len(inside) - 1, 2):
        both = np.isin(types[first], _BETWEEN_LAYERS)
        if not (types[first][both] == _WRAP).any():
            continue
        regions, _ = label_panels(inside[first : first + 2], types[first : first + 2])
        groups: dict[tuple[tuple[int, int], ...], list[Wall]] = {}
        for h, row, col in np.argwhere(both).tolist():
            pairs = _facing_regions(regions, (h, row, col))
            groups.setdefault(pairs, []).append((h, row, col))
        for _, group in sorted(groups.items()):
            for chain in _connected(group):
                changed += _unify_wrap(chain, types[first : first + 2], cost[first : first + 2])
    return changed


def _facing_regions(
    regions: Int[np.ndarray, "2 row col"], wall: Wall
) -> tuple[tuple[int, int], ...]:
    """The regions in front and behind a grid edge, for each side of it that has both."""
    beside = [cell for cell in _sides(wall) if min(cell) >= 0]
    pairs = [(int(regions[0][cell]), int(regions[1][cell])) for cell in beside]
    return tuple(pair for pair in pairs if min(pair) >= 0)


def _unify_wrap(chain: list[Wall], types: Int[np.ndarray, "2 2 row col"], cost: np.ndarray) -> bool:
    """Give a chain one type on both layers if what stands against it is worth less than
    `RARE_COST`.
    """
    h, row, col = np.array(chain).T
    own = types[0, h, row, col]
    if (own == own[0]).all():
        return False
    both = np.stack([cost[:, h, kind, row, col].sum(axis=0) for kind in _BETWEEN_LAYERS])
    k = int(np.argmin(both.sum(axis=1)))
    changes = own != _BETWEEN_LAYERS[k]
    worth = (both[k] - both[1 - k])[changes].mean()
    if worth >= RARE_COST:
        return False
    types[:, h, row, col] = _BETWEEN_LAYERS[k]
    cost[:, h, _BETWEEN_LAYERS[k], row, col] = 0.0
    cost[:, h, _BETWEEN_LAYERS[1 - k], row, col] += MAX_COST
    return True


def unify_turned(inside: Flags, types: Types, cost: Float[np.ndarray, "2 layer row col"]) -> Flags:
    """Which cells are turned: each region as a whole, whichever costs less."""
    regions, count = label_panels(inside, types)
    totals = [np.bincount(regions[inside], weights=each[inside], minlength=count) for each in cost]
    turned = np.zeros_like(inside)
    turned[inside] = (totals[1] < totals[0])[regions[inside]]
    return turned


def remove_dangling_cuts(image: GarmentImage) -> tuple[GarmentImage, int]:
    """The image without cuts that end inside a panel and are not sewn to their own other side.

    Such a cut is `NON_STITCH`, `FRONT_TO_BACK` or `WRAP`; it goes from its tip as far as another
    wall.

    Returns:
        The image, and how many grid edges were changed; one between layers goes on both.
    """
    types, count = image.edge_type.copy(), 0
    inner = np.stack([_inner_edges(inside) for inside in image.inside])
    while True:
        flaps = [
            (layer, wall)
            for layer in range(image.layers)
            for h, row, col in np.argwhere(inner[layer] & np.isin(types[layer], _CUTS)).tolist()
            if _has_tip(types[layer], wall := (h, row, col))
        ]
        if not flaps:
            return replace(image, edge_type=types), count
        for layer, wall in flaps:
            other = layer ^ 1
            if types[layer][wall] in _BETWEEN_LAYERS and other < image.layers:
                types[other][wall] = _NON_BOUNDARY if inner[other][wall] else _NON_STITCH
            types[layer][wall] = _NON_BOUNDARY
            count += 1


def _has_tip(types: np.ndarray, wall: Wall) -> bool:
    """Whether nothing else that bounds cloth meets one end of a grid edge."""
    meeting = (
        [w for w in _around(types, end) if types[w] not in (_NON_BOUNDARY, _CREASE)]
        for end in _ends(wall)
    )
    return any(len(walls) == 1 for walls in meeting)


# Rules on types alone, without costs: they only fill what both ends of a gap in a seam agree on.
def repair_paper_cases(image: GarmentImage) -> tuple[Types, dict[str, int]]:
    """The two invalid cases that the paper repairs (Section 5).

    Returns:
        The repaired types, and how many grid edges were changed by rule; the image stays as it is.
    """
    types = image.edge_type.copy()
    sewn = 0
    for layer, kind in product(range(image.layers), _BETWEEN_LAYERS):
        if layer ^ 1 >= image.layers:
            continue
        gaps = (types[layer] == _NON_STITCH) & (types[layer ^ 1] == kind)
        for h, row, col in np.argwhere(gaps).tolist():
            if all(_touching(types[layer], (h, row, col), p, kind) for p in (0, 1)):
                types[layer, h, row, col] = kind
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
    both = np.zeros((2, grid, grid), bool)
    both[BOTTOM] = at_point[:-1, :-1] & at_point[:-1, 1:]
    both[LEFT] = at_point[:-1, :-1] & at_point[1:, :-1]
    return both


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


def _around(types: np.ndarray, point: tuple[int, int]) -> list[Wall]:
    """The stored grid edges at a lattice point."""
    row, col = point
    grid = types.shape[-1]
    edges = ((BOTTOM, row, col), (BOTTOM, row, col - 1), (LEFT, row, col), (LEFT, row - 1, col))
    return [e for e in edges if 0 <= e[1] < grid and 0 <= e[2] < grid]


def _touching(types: np.ndarray, wall: Wall, end: int, kind: int) -> list[Wall]:
    """Other grid edges of type `kind` at one end of a grid edge."""
    return [w for w in _around(types, _ends(wall)[end]) if w != wall and types[w] == kind]
