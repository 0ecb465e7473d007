"""Measurements of one garment, and of one against another."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from garmentimage.compare import (
    loop_polygon,
    match_graphs,
    match_panels,
    pattern_faults,
    stitch_graph,
    structure_faults,
    topology_hash,
)
from garmentimage.drape import drape_pattern
from garmentimage.errors import GarmentImageError
from garmentimage.geometry import polyline_length, resample
from garmentimage.pattern import Pattern
from garmentimage.render.worn import photograph

SILHOUETTE = 128
"""Rows and columns of a silhouette [pixel]."""
OUTLINE_STEP_CM = 2.0
"""Spacing of the points by which outlines are compared."""


@dataclass(frozen=True)
class MeasuredGarment:
    """A garment with its measurements."""

    pattern: Pattern | None
    fault: str
    """Why it cannot be cut, sewn or worn; empty if it can."""
    topology: str
    """See `topology_hash`; empty where its panels or stitches are at fault."""
    silhouette: Bool[np.ndarray, "row col"] | None
    """Of the worn garment, from the front; None if it cannot be worn."""

    @property
    def valid(self) -> bool:
        """Whether it can be cut, sewn and worn."""
        return not self.fault


def measure_garment(
    pattern: Pattern | None, fault: str = "", *, worn: bool = True
) -> MeasuredGarment:
    """Check a garment and drape it on the default body."""
    if pattern is None:
        return MeasuredGarment(None, fault or "no garment", "", None)
    faults = structure_faults(pattern)
    topology = "" if faults else topology_hash(stitch_graph(pattern))
    faults = faults or pattern_faults(pattern)
    if faults or not worn:
        return MeasuredGarment(pattern, faults[0] if faults else "", topology, None)
    try:
        garment = drape_pattern(pattern)
    except GarmentImageError as error:
        return MeasuredGarment(pattern, f"drape: {error}", topology, None)
    if garment.report.faults:
        return MeasuredGarment(pattern, f"drape: {garment.report.faults[0]}", topology, None)
    cloth = photograph(garment, size=SILHOUETTE).silhouette
    return MeasuredGarment(pattern, "", topology, cloth > 0.5)


def panel_overlap(truth: Pattern, found: Pattern | None) -> float:
    """Mean IoU of panels; missing and extra ones count 0."""
    if found is None or structure_faults(found):
        return 0.0
    return match_panels(truth, found).mean_iou


def same_graph(truth: Pattern, found: Pattern | None) -> bool:
    """Whether the same panels are sewn together, in the same order; lengths may differ."""
    if found is None or structure_faults(found):
        return False
    matching = match_panels(truth, found)
    if matching.missing or matching.extra:
        return False
    pairs = {pair.a: (pair.b,) for pair in matching.pairs}
    graphs = stitch_graph(truth), stitch_graph(found)
    return match_graphs(*graphs, pairs, check_lengths=False, check_places=False) is not None


def outline_distance(a: Pattern, b: Pattern) -> float:
    """Mean distance of the outlines of two garments placed at the body [cm].

    From every point of either to the nearest one of the other on the same side of the body.
    """
    from scipy.spatial import cKDTree

    total = []
    for one, two in zip(_outlines(a), _outlines(b), strict=True):
        if len(one) and len(two):
            total += [cKDTree(two).query(one)[0], cKDTree(one).query(two)[0]]
    return float(np.concatenate(total).mean()) if total else float("inf")


def silhouette_distance(a: Bool[np.ndarray, "row col"], b: Bool[np.ndarray, "row col"]) -> float:
    """1 - IoU of two silhouettes."""
    return 1 - float((a & b).sum() / max((a | b).sum(), 1))


def _outlines(pattern: Pattern) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "m 2"]]:
    """Points of all outlines in the plane of the body, those in front of it and those behind."""
    sides: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    for panel in pattern.panels:
        for loop in panel.loops:
            polygon = loop_polygon(loop)
            closed = np.concatenate([polygon, polygon[:1]])
            count = max(round(polyline_length(closed) / OUTLINE_STEP_CM), 3)
            points = resample(closed, np.linspace(0, 1, count, endpoint=False))
            world = panel.to_world(points)
            sides[int(world[:, 2].mean() < 0)].append(world[:, :2])
    empty = np.zeros((0, 2))
    front, back = (np.concatenate(side) if side else empty for side in sides)
    return front, back
