"""Which panel of a found garment is which of the true one, whatever their names and frames.

The frame of a panel, its own coordinates, says nothing of the garment: a back may be drawn as seen
from behind or through the body, a sleeve upright or lying, as long as its place turns it back. So
panels are compared in every pose that keeps their outer face outside, and where shapes do not tell
two panels apart, places and seams do.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from garmentimage.compare.matching import (
    MIRRORED,
    PLACEMENT_WEIGHT,
    POSES,
    TURNED,
    Matching,
    iou_by_pose,
    matching_from,
    nearness,
)
from garmentimage.compare.stitch_graphs import StitchGraph, match_graphs, stitch_graph
from garmentimage.pattern import Loop, Panel, Pattern, euler_angles, mirrored_curvature

ALIKE = 0.02
"""Poses whose IoU is less by no more than this fit as well: how the panels stand decides."""

RIVAL = 0.1  # panels that score less by no more than this may be the counterpart: seams decide


@dataclass(frozen=True)
class Pairing:
    """Two garments, panel by panel."""

    found: Pattern
    """The found garment, its panels drawn in frames that lie as those of their counterparts."""
    matching: Matching  # of the true garment and `found`
    graphs: tuple[StitchGraph, StitchGraph]
    """Of the true garment and of the found one as it was found."""
    same_topology: bool  # the same panels sewn together in the same order; lengths may differ


def pair_garments(truth: Pattern, found: Pattern) -> Pairing:
    """Pair the panels of a found garment with those of the true one, by shape, place and seams.

    Args:
        truth: what it should be.
        found: with panels that can be drawn, and stitches that name edges, each at most once.
    """
    from scipy.optimize import linear_sum_assignment

    graphs = stitch_graph(truth), stitch_graph(found)
    iou = iou_by_pose(truth.panels, found.panels, range(len(POSES)))
    iou = np.where(_allowed(truth, found), iou, 0.0)
    score = iou.max(axis=0) + PLACEMENT_WEIGHT * nearness(truth.panels, found.panels)
    rows, columns = linear_sum_assignment(score, maximize=True)
    names = [panel.name for panel in found.panels]
    paired = {truth.panels[i].name: names[j] for i, j in zip(rows, columns, strict=True)}
    candidates: dict[str, list[str]] = {name: [other] for name, other in paired.items()}
    same = None
    if len(truth.panels) == len(found.panels):
        same = _laid(graphs, candidates)
        if same is None:
            for panel, row in zip(truth.panels, score, strict=True):
                near = np.argsort(-row, kind="stable")
                candidates[panel.name] = [names[j] for j in near if row[j] >= row.max() - RIVAL]
            same = _laid(graphs, candidates)
    paired = dict(same) if same is not None else paired
    poses = _poses(truth, found, paired, iou)
    seen = posed(found, {name: POSES[pose] for name, pose in poses.items() if pose})
    return Pairing(seen, matching_from(truth, seen, paired), graphs, same is not None)


def posed(pattern: Pattern, poses: Mapping[str, Float[np.ndarray, "2 2"]]) -> Pattern:
    """The same garment, own coordinates of some panels mirrored or turned; see `posed_panel`."""
    onto = []
    for sewn in pattern.onto:
        own, base = (poses.get(name, np.eye(2)) for name in (sewn.panel, sewn.on))
        (a, b), (c, d) = (base @ np.array(sewn.matrix) @ own.T).tolist()
        x, y = (base @ np.array(sewn.offset)).tolist()
        onto.append(replace(sewn, matrix=((a, b), (c, d)), offset=(x, y)))
    panels = (posed_panel(p, poses[p.name]) if p.name in poses else p for p in pattern.panels)
    return replace(pattern, panels=tuple(panels), onto=tuple(onto))


def posed_panel(panel: Panel, pose: Float[np.ndarray, "2 2"]) -> Panel:
    """The same panel at the same place, its own coordinates mirrored or turned.

    Args:
        panel: grain lines are left as they are.
        pose: the new coordinates are `pose` @ the old ones; orthogonal.
    """
    mirrored = bool(np.linalg.det(pose) < 0)
    outline, *holes = (_posed_loop(loop, pose, mirrored=mirrored) for loop in panel.loops)
    axes = panel.matrix[:, :2] @ pose.T
    matrix = np.column_stack([axes, np.cross(axes[:, 0], axes[:, 1])])
    return replace(panel, outline=outline, holes=tuple(holes), rotation=euler_angles(matrix))


def _posed_loop(loop: Loop, pose: np.ndarray, *, mirrored: bool) -> Loop:
    points = (np.array(loop.vertices) @ pose.T).tolist()
    edges = loop.edges
    if mirrored:
        edges = tuple(replace(edge, curvature=mirrored_curvature(edge.curvature)) for edge in edges)
    return Loop(tuple((x, y) for x, y in points), edges)


def _allowed(truth: Pattern, found: Pattern) -> Bool[np.ndarray, "pose truth found"]:
    """As panels are, and in the poses that keep the outer face outside."""
    runs = [np.array([p.outline.area < 0 for p in pattern.panels]) for pattern in (truth, found)]
    same = runs[0][:, None] == runs[1][None]
    allowed = np.zeros((len(POSES), *same.shape), bool)
    allowed[list(TURNED)], allowed[list(MIRRORED)] = same, ~same
    allowed[0] = True
    return allowed


def _laid(
    graphs: tuple[StitchGraph, StitchGraph], candidates: Mapping[str, list[str]]
) -> Mapping[str, str] | None:
    match = match_graphs(*graphs, candidates, check_lengths=False, check_places=False)
    return None if match is None else match.panels


def _poses(
    truth: Pattern, found: Pattern, paired: Mapping[str, str], iou: np.ndarray
) -> dict[str, int]:
    """For each paired panel of `found` the pose that fits best; of several the one that stands
    most as its counterpart does.
    """
    number = {panel.name: j for j, panel in enumerate(found.panels)}
    poses = {}
    for i, panel in enumerate(truth.panels):
        if panel.name not in paired:
            continue
        j = number[paired[panel.name]]
        fits = np.flatnonzero(iou[:, i, j] >= iou[:, i, j].max() - ALIKE)
        axes = panel.matrix[:, :2], found.panels[j].matrix[:, :2]
        standing = [float((axes[0] * (axes[1] @ POSES[k].T)).sum()) for k in fits]
        poses[found.panels[j].name] = int(fits[int(np.argmax(np.round(standing, 6)))])
    return poses
