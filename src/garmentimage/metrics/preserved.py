"""How much of a garment an edit preserved."""

from typing import TYPE_CHECKING, Literal

import numpy as np

from garmentimage.body import measurements
from garmentimage.compare import drawing_faults
from garmentimage.metrics.shape_attributes import panels_at_body
from garmentimage.pattern import Pattern

if TYPE_CHECKING:
    from shapely import Geometry

MIN_AREA_CM2 = 100.0
"""Parts of a panel above the waist that are smaller are ignored [cm2]."""

EditedRegion = Literal["sleeves", "below the waist"]


def preserved_iou(region: EditedRegion, start: Pattern, end: Pattern | None) -> float:
    """Mean IoU of the panels outside the edited region, before and after an edit.

    If sleeves may change, all other panels are compared, else the parts of panels above the waist.
    Centroids are aligned, as in `panel_iou`, panels in front and behind are paired separately
    (Hungarian method), and unpaired ones count 0.

    Args:
        region: where the garment may change.
        start: the garment before the edit.
        end: after it; None, or a pattern that cannot be drawn, gives 0.

    Returns:
        From 0 to 1; 1 if there is nothing to compare.
    """
    import shapely
    from scipy.optimize import linear_sum_assignment

    if end is None or any(drawing_faults(panel) for panel in end.panels):
        return 0.0
    ious: list[float] = []
    for is_front in (True, False):
        one, two = (_frozen_region(pattern, region, is_front) for pattern in (start, end))
        shared = np.array(
            [[shapely.intersection(a, b).area / shapely.union(a, b).area for b in two] for a in one]
        ).reshape(len(one), len(two))
        pairs = linear_sum_assignment(shared, maximize=True)
        ious += [*shared[pairs], *[0.0] * abs(len(one) - len(two))]
    return float(np.mean(ious)) if ious else 1.0


def _frozen_region(pattern: Pattern, region: EditedRegion, is_front: bool) -> "list[Geometry]":
    """The parts of panels to preserve, centred at the origin, in front of the body or behind it."""
    import shapely
    import shapely.affinity

    above = shapely.box(-400, measurements("mean-female").waist_height, 400, 400)
    found = []
    for placed in panels_at_body(pattern):
        if placed.is_front != is_front or (region == "sleeves" and placed.is_sleeve):
            continue
        cloth = shapely.make_valid(shapely.Polygon(placed.outline))
        if region != "sleeves":
            cloth = shapely.intersection(cloth, above)
        if cloth.area > MIN_AREA_CM2:
            x, y = cloth.centroid.x, cloth.centroid.y
            found.append(shapely.affinity.translate(cloth, -x, -y))
    return found
