"""A fast sufficient test that two patterns are equal, names of panels included."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from garmentimage.compare.comparison import SUCCESS_IOU
from garmentimage.compare.stitch_graphs import StitchGraph, match_graphs
from garmentimage.compare.validation import stitch_faults
from garmentimage.geometry import centroid, signed_area
from garmentimage.pattern import Panel, Pattern

if TYPE_CHECKING:
    from shapely import Polygon

SURE_IOU = (1 + SUCCESS_IOU) / 2
"""An IoU this high of coarse outlines leaves no doubt that the true one reaches `SUCCESS_IOU`."""

COARSE = 2
"""Every so manyth point of a curve stands for it: a ruffle of 3 m loses 1 % of its area so."""


def surely_same(
    original: Pattern, decoded: Pattern, graphs: tuple[StitchGraph, StitchGraph]
) -> bool:
    """Whether `compare_patterns` would succeed, each panel paired under its own name.

    False is inconclusive: only `compare_patterns` decides then. `graphs` are those of both.
    """
    names = [panel.name for panel in original.panels]
    if sorted(names) != sorted(panel.name for panel in decoded.panels) or stitch_faults(decoded):
        return False
    if match_graphs(*graphs, {name: (name,) for name in names}) is None:
        return False
    return _overlap(original.panels, [decoded.by_name[name] for name in names])


def _overlap(ours: Sequence[Panel], theirs: Sequence[Panel]) -> bool:
    """Whether panels are simple and lie on each other, centres of area aligned."""
    import shapely

    regions = np.array([[_region(panel) for panel in panels] for panels in (ours, theirs)])
    if not shapely.is_valid(regions).all():
        return False
    area = shapely.area(regions)
    shared = shapely.area(shapely.intersection(*regions))
    return bool((shared >= SURE_IOU * (area.sum(axis=0) - shared)).all())


def _region(panel: Panel) -> "Polygon":
    """The cloth of a panel, its centre of area at the origin."""
    import shapely

    rings = [
        np.concatenate([curve.polyline[:-1:COARSE] for curve in loop.curves])
        for loop in panel.loops
    ]
    areas = np.abs([signed_area(ring) for ring in rings])
    areas[1:] *= -1
    centre = areas @ np.array([centroid(ring) for ring in rings]) / areas.sum()
    return shapely.Polygon(rings[0] - centre, [ring - centre for ring in rings[1:]])
