"""Whether one pattern is the same as another: panels, stitch graph, seam lengths, faults.

The judge sees two patterns only, the one that should be and the one that is.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from garmentimage.compare.matching import (
    POSES,
    Matching,
    boundary_gap,
    iou_by_pose,
    match_panels,
    matching_from,
)
from garmentimage.compare.on_cloth import differences_on_cloth
from garmentimage.compare.stitch_graphs import (
    PoseTable,
    StitchGraph,
    match_graphs,
    same_stitch_graph,
    seam_agreement,
    stitch_graph,
)
from garmentimage.compare.turning import turned_freely
from garmentimage.compare.validation import stitch_faults, structure_faults
from garmentimage.pattern import Pattern

SUCCESS_IOU = 0.9  # every panel must reach this centroid-aligned IoU


@dataclass(frozen=True)
class RoundtripResult:
    """What the judge says of one pattern that came back."""

    success: bool
    reasons: tuple[str, ...]
    """Why it is not the same pattern; empty on success."""
    panels: tuple[int, int]
    """Number of panels that went in and came back."""
    iou: Mapping[str, float]
    """IoU of each original panel, 0 where it is missing."""
    boundary_distance: float
    """Mean over paired panels of the mean distance of their boundaries [cm]; 0 without pairs."""
    boundary_gap: float
    """Largest distance of a boundary from that of its paired panel [cm]; 0 without pairs."""
    seam_agreement: float
    """Share of the original seams that came back between the same panels and as long."""
    seam_length_deviation: float | None
    """Largest difference of a stitched length [cm]; None where the stitch graphs differ."""


def compare_patterns(
    original: Pattern, decoded: Pattern, *, any_pose: bool = False
) -> RoundtripResult:
    """Whether `decoded` is the pattern `original`, and how near it comes.

    Success: as many panels, each with IoU >= `SUCCESS_IOU`, the same stitch graph, and no fault
    in panels or stitches that the original has not. The likeliest assignment of panels is tried
    first (equal names, then shape and place); where it fails, any that fulfils all of this will do.
    What is sewn onto cloth must lie within `PLACE_TOL_CM` of its place on it.

    Args:
        original: the pattern that went in.
        decoded: the pattern that came back.
        any_pose: panels may lie mirrored or turned in their own coordinates, and names say nothing.
            Quarter turns are tried first, others where these do not do.
    """
    result = _compared(original, decoded, any_pose=any_pose)
    if result.success or not any_pose or stitch_faults(decoded):
        return result
    turned = turned_freely(original, decoded)
    return _compared(original, turned, any_pose=True) if turned != decoded else result


def _compared(original: Pattern, decoded: Pattern, *, any_pose: bool) -> RoundtripResult:
    """The comparison in quarter turns."""
    task = _Comparison(original, decoded, any_pose)
    faults = stitch_faults(decoded)
    if faults:
        matching = match_panels(original, decoded, any_pose=any_pose)
        return _result(task, matching, faults, sewable=False)
    faults = [] if structure_faults(original) else structure_faults(decoded)
    matching, reasons = task.likeliest()
    if reasons:
        found = task.search()
        if found is not None:
            matching, reasons = found, []
    return _result(task, matching, reasons + faults)


@dataclass(frozen=True)
class _Comparison:
    """Two patterns, and what is worked out of them once."""

    original: Pattern
    decoded: Pattern
    any_pose: bool

    @cached_property
    def graphs(self) -> tuple[StitchGraph, StitchGraph]:
        return stitch_graph(self.original), stitch_graph(self.decoded)

    @cached_property
    def iou(self) -> Float[np.ndarray, "pose original decoded"]:
        poses = range(len(POSES)) if self.any_pose else range(1)
        return iou_by_pose(self.original.panels, self.decoded.panels, poses)

    @cached_property
    def poses(self) -> PoseTable | None:
        """In any pose: those in which two panels are alike enough, or else the best one."""
        if not self.any_pose:
            return None
        return {
            (p.name, q.name): tuple(np.flatnonzero(iou >= min(SUCCESS_IOU, iou.max())).tolist())
            for p, row in zip(self.original.panels, self.iou.transpose(1, 2, 0), strict=True)
            for q, iou in zip(self.decoded.panels, row, strict=True)
        }

    def likeliest(self) -> tuple[Matching, list[str]]:
        """The assignment of panels by names or by shape that explains more, and its differences."""
        found: list[tuple[Matching, list[str]]] = []
        for by_name in (False,) if self.any_pose else (True, False):
            matching = match_panels(
                self.original, self.decoded, by_name=by_name, any_pose=self.any_pose
            )
            found.append((matching, self.differences(matching)))
            if not found[-1][1]:
                break
        return min(found, key=lambda candidate: len(candidate[1]))

    def differences(self, matching: Matching) -> list[str]:
        """Why the patterns differ under an assignment of panels."""
        reasons = []
        if len(self.original.panels) != len(self.decoded.panels):
            count, wanted = len(self.decoded.panels), len(self.original.panels)
            reasons.append(f"{count} panels instead of {wanted}")
        reasons += [
            f"panel {p.a!r} comes back with IoU {p.iou:.3f}"
            for p in matching.pairs
            if p.iou < SUCCESS_IOU
        ]
        reasons += same_stitch_graph(*self.graphs, matching.panel_map, poses=self.poses)
        return reasons + differences_on_cloth(
            self.original, self.decoded, matching.panel_map, any_pose=self.any_pose
        )

    def search(self) -> Matching | None:
        """Any assignment of panels under which the patterns are the same."""
        if len(self.original.panels) != len(self.decoded.panels):
            return None
        names = [p.name for p in self.decoded.panels]
        candidates = {
            p.name: [names[j] for j in np.argsort(-row, kind="stable") if row[j] >= SUCCESS_IOU]
            for p, row in zip(self.original.panels, self.iou.max(axis=0), strict=True)
        }
        match = match_graphs(*self.graphs, candidates, poses=self.poses)
        if match is None or differences_on_cloth(
            self.original, self.decoded, match.panels, any_pose=self.any_pose
        ):
            return None
        return matching_from(self.original, self.decoded, match.panels, any_pose=self.any_pose)

    def length_deviation(self, matching: Matching) -> float | None:
        """Largest difference of a stitched length [cm]; None where the stitch graphs differ.

        The strictest way to lay one graph on the other counts: a loose one may take the side seam
        between two panels for their shoulder seam.
        """
        pairs = {a: [b] for a, b in matching.panel_map.items()}
        for lengths, places in ((True, True), (False, True), (False, False)):
            match = match_graphs(
                *self.graphs, pairs, poses=self.poses, check_lengths=lengths, check_places=places
            )
            if match is not None:
                ours, theirs = (graph.sides for graph in self.graphs)
                gaps = [abs(ours[k].length - theirs[m].length) for k, m in match.sides.items()]
                return max(gaps, default=0.0)
        return None


def _result(
    task: _Comparison, matching: Matching, reasons: list[str], *, sewable: bool = True
) -> RoundtripResult:
    """The figures of a comparison; those of seams need a decoded pattern that can be sewn."""
    original, decoded = task.original, task.decoded
    distances = [p.boundary_distance for p in matching.pairs]
    gaps = [
        boundary_gap(original.by_name[p.a], decoded.by_name[p.b], any_pose=task.any_pose)
        for p in matching.pairs
    ]
    return RoundtripResult(
        success=not reasons,
        reasons=tuple(reasons),
        panels=(len(original.panels), len(decoded.panels)),
        iou={p.a: p.iou for p in matching.pairs} | dict.fromkeys(matching.missing, 0.0),
        boundary_distance=float(np.mean(distances)) if distances else 0.0,
        boundary_gap=max(gaps, default=0.0),
        seam_agreement=seam_agreement(*task.graphs, matching.panel_map) if sewable else 0.0,
        seam_length_deviation=task.length_deviation(matching) if sewable else None,
    )
