"""Repair of images that networks give: the least-cost consistent labelling, then whole seams.

Costs are negative log probabilities [nats]. A correct, certain image has cost 0 and every change
of it would cost more than any rule may spend, so it is never changed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from garmentimage.errors import ImageError
from garmentimage.raster.channel_kind import ChannelKind, is_binary, resolve_channel_kind
from garmentimage.raster.channels import check_channels, split_channels
from garmentimage.raster.image import BOTTOM, LEFT, EdgeType, GarmentImage
from garmentimage.raster.repair.creases import (
    with_creases,
    with_creases_inner,
    without_creases,
)
from garmentimage.raster.repair.labelling import (
    UnaryCosts,
    minimise_energy,
    one_hot_costs,
    unary_costs,
    with_neighbour_gain,
)
from garmentimage.raster.repair.walls import (
    drop_isolated_regions,
    merge_thin_regions,
    repair_paper_cases,
    unify_seams,
    unify_turned,
    unify_wraps,
)

RepairLevel = Literal["full", "paper", "none"]
LEVELS: tuple[RepairLevel, ...] = ("full", "paper", "none")

CELL_SIZE_RANGE = (0.2, 5.0)
"""A cell that was not meant to be inside keeps its own vectors if they are this many times the
grid's own cell, else it takes those of its neighbours."""

_NON_BOUNDARY, _CREASE = int(EdgeType.NON_BOUNDARY), int(EdgeType.CREASE)


@dataclass(frozen=True)
class RepairReport:
    """What a repair changed."""

    level: RepairLevel
    counts: Mapping[str, int] = field(default_factory=dict)
    """By rule: how many cells, grid edges, seams or regions it changed, if any."""
    kind: ChannelKind | None = None
    """What the numbers of an array were read as; None of a GarmentImage."""
    is_guess: bool = False
    """Whether the kind was guessed: nobody said it, and the numbers are not all 0 or 1."""

    @property
    def changed(self) -> bool:
        """Whether anything was."""
        return any(self.counts.values())


def repair(
    image: GarmentImage | np.ndarray,
    level: RepairLevel = "full",
    *,
    kind: ChannelKind | None = None,
) -> tuple[GarmentImage, RepairReport]:
    """Make an image consistent.

    Args:
        image: a GarmentImage, or channels [17 L, N, N] as a network gives them, or [26 L, N, N].
        level: what is repaired.
        kind: what the numbers of the channels are: `shares` (probabilities); `logits`; `channels`,
            decided at .5 and by the largest of four, and sure then, as those of a GarmentImage.
            Default: judged by all numbers of flags and types together; the report says so. Of a
            GarmentImage it says nothing.

    Levels:
        none: the likeliest value of everything, consistent or not.
        paper: then the paper's two cases: a `NON_STITCH` grid edge between two `FRONT_TO_BACK` ones
            becomes `FRONT_TO_BACK` (where the other layer says so: read literally, the rule
            changes correct images), and `WRAP` likewise; a `NON_BOUNDARY` one between two tips of
            `SIDE_BY_SIDE` walls becomes `SIDE_BY_SIDE` (unless they are the tips of two darts).
        full: the least-cost labelling in which every grid edge agrees with its cells, found by
            local search (see `labelling`); then seams are made whole or dropped, small regions
            merged, uncertain bands made one seam, and the paper's cases repaired. Cloth goes on
            round the body along a whole seam or not at all, and a panel is turned as a whole.

    A correct image comes back unchanged.

    Raises:
        ImageError: a wrong shape, values that are not finite, or no such level or kind.
    """
    if level not in LEVELS:
        raise ImageError(f"no repair level {level!r}; there are {', '.join(LEVELS)}")
    if isinstance(image, GarmentImage):
        report = RepairReport(level)
        repaired, counts = _repaired(image, level, None)
    else:
        parts = split_channels(check_channels(image))
        known = resolve_channel_kind(parts, kind)
        report = RepairReport(level, {}, known, kind is None and not is_binary(parts))
        given = GarmentImage.from_channels(image, kind=known)
        repaired, counts = _repaired(given, level, unary_costs(image, known))
    return repaired, replace(report, counts={rule: n for rule, n in counts.items() if n})


def _repaired(
    given: GarmentImage, level: RepairLevel, costs: UnaryCosts | None
) -> tuple[GarmentImage, dict[str, int]]:
    """The image, and how much each rule changed; without costs every change of `given` is dear."""
    if level == "none":
        return given, {}
    if level == "full":
        return _repaired_fully(given, costs or one_hot_costs(given))
    is_crease = given.edge_type == _CREASE
    types, counts = repair_paper_cases(replace(given, edge_type=without_creases(given.edge_type)))
    types = np.where(is_crease & (types == _NON_BOUNDARY), _CREASE, types)
    return (replace(given, edge_type=types) if any(counts.values()) else given), counts


def _repaired_fully(given: GarmentImage, costs: UnaryCosts) -> tuple[GarmentImage, dict[str, int]]:
    flag_cost = np.ascontiguousarray(costs.inside, float)
    # Creases bound nothing: they count as inner grid edges until all walls stand.
    type_costs, given_types = with_creases_inner(costs.types), without_creases(given.edge_type)
    type_cost = with_neighbour_gain(type_costs, given_types)
    inside, types = minimise_energy(given.inside, flag_cost, type_cost)
    counts = {
        "inconsistent flags": int((inside != given.inside).sum()),
        "inconsistent edge types": int((types != given_types).sum()),
    }
    counts["seams and slits made whole or dropped"] = unify_seams(inside, types, type_cost)
    counts["thin regions merged"] = merge_thin_regions(inside, types, type_costs, type_cost)
    counts["lone cells dropped"] = drop_isolated_regions(inside, types, flag_cost)
    # What was merged may leave a slit behind.
    counts["seams and slits made whole or dropped"] += unify_seams(inside, types, type_cost)
    counts["wraps made whole or dropped"] = unify_wraps(inside, types, type_cost)
    inside, types = minimise_energy(inside, flag_cost, type_cost)
    turned = unify_turned(inside, types, costs.turned)
    counts["turned flags"] = int((turned != given.turned)[inside & given.inside].sum())
    repaired = replace(given, inside=inside, edge_type=types, turned=turned)
    types, paper = repair_paper_cases(repaired)
    types = with_creases(types, inside, costs.types)
    counts |= paper
    counts["creases dropped"] = int(((given.edge_type == _CREASE) & (types != _CREASE)).sum())
    deformation, filled = _fill_deformation(given, costs.deformation, inside, types)
    counts["deformations filled in"] = filled
    if not any(counts.values()):
        return given, counts
    return replace(repaired, edge_type=types, deformation=deformation), counts


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
    low, high = CELL_SIZE_RANGE
    new = inside & ~given.inside & ((size < low) | (size > high))
    missing = new | (inside & (size == 0))
    count = int(missing.sum())
    while missing.any():
        known = inside & ~missing
        total, number = np.zeros_like(vectors), np.zeros(inside.shape)
        for axis, h in ((1, BOTTOM), (2, LEFT)):
            joined = np.isin(types[:, h], (_NON_BOUNDARY, _CREASE))
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
