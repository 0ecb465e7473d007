"""A quick look at two patterns: whether one is surely the other, names and all."""

from collections.abc import Sequence

import numpy as np

from garmentimage.compare.judge import SUCCESS_IOU
from garmentimage.compare.stitch_graph import StitchGraph, match_graphs
from garmentimage.compare.validity import stitch_faults
from garmentimage.geometry.polygons import centroid
from garmentimage.pattern.model import Panel, Pattern

SURE_IOU = (1 + SUCCESS_IOU) / 2
"""An IoU this high of coarse outlines leaves no doubt that the true one reaches `SUCCESS_IOU`."""


def surely_same(original: Pattern, decoded: Pattern, graphs: tuple[StitchGraph, StitchGraph]) -> bool:
    """Whether `judge` would say that `decoded` is `original`, each panel under its own name.

    False says nothing: only `judge` knows then.

    Args:
        original: the pattern that should be.
        decoded: the pattern that is.
        graphs: stitch graphs of both.
    """
    names = [panel.name for panel in original.panels]
    if sorted(names) != sorted(panel.name for panel in decoded.panels) or stitch_faults(decoded):
        return False
    if match_graphs(*graphs, {name: (name,) for name in names}) is None:
        return False
    return _overlap(original.panels, [decoded.by_name[name] for name in names])


def _overlap(ours: Sequence[Panel], theirs: Sequence[Panel]) -> bool:
    """Whether panels without holes lie on each other, centres of area aligned."""
    import shapely

    if any(panel.holes for panel in (*ours, *theirs)):
        return False
    regions = []
    for panels in (ours, theirs):
        outlines = [panel.outline.fine_polygon for panel in panels]
        regions.append(np.array([shapely.Polygon(each - centroid(each)) for each in outlines]))
    if not shapely.is_valid(np.concatenate(regions)).all():
        return False
    shared = shapely.area(shapely.intersection(*regions))
    iou = shared / (shapely.area(regions[0]) + shapely.area(regions[1]) - shared)
    return bool((iou >= SURE_IOU).all())
