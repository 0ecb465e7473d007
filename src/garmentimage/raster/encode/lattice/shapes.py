"""Lost shapes: whether a drawing has grid edges enough for the bends of its panels.

A boundary is decoded as the chords between its grid edges, or smooth where it has several, so a
bent edge with too few grid edges loses length and area.
"""

import numpy as np

from garmentimage.geometry import polyline_length, resample, signed_area
from garmentimage.raster.encode.lattice.drawing import Path, chord_loss
from garmentimage.raster.encode.layout import SeamGraph
from garmentimage.raster.encode.placement import PlacedPanel
from garmentimage.raster.image import EdgeType

LOST_LENGTH = (0.03, 0.75)
"""A seam's chords may not lose more of its length: a share, or so much [cm], whichever is more."""
LOST_AREA = 0.06
"""A panel may not gain or lose more of its area along one edge, as a share."""
COMPARED_FROM = 0.03
"""Panels that gain and lose more than this all round, as a share, are compared as a whole."""
MIN_IOU = 0.92
"""Overlap that such a panel must keep, centroids aligned."""


def lost_shape(graph: SeamGraph, paths: list[Path]) -> str:
    """The panel whose edges have too few grid edges for their bends, in words; "" if none has."""
    for index, panel in enumerate(graph.placed.panels):
        edges = range(len(panel.curves))
        counts = [len(graph.along(paths, index, edge)) - 1 for edge in edges]
        is_sewn = [graph.arc(index, edge).kind != EdgeType.NON_STITCH for edge in edges]
        if reason := _lost_by(panel, counts, is_sewn):
            return reason
    return ""


def _lost_by(panel: PlacedPanel, counts: list[int], is_sewn: list[bool]) -> str:
    """What a panel would lose, in words, with so many grid edges for each edge; "" if nothing."""
    area = abs(signed_area(panel.outline))
    all_round = 0.0
    for curve, count, sewn in zip(panel.curves, counts, is_sewn, strict=True):
        if len(curve) < 3:
            continue
        lost, sliver = chord_loss(curve, _chords(count))
        length = polyline_length(curve)
        too_short = lost > max(LOST_LENGTH[0] * length, LOST_LENGTH[1])
        if (too_short and sewn) or sliver > LOST_AREA * area:
            return (
                f"panel {panel.source!r} has a bent edge of {length:.1f} cm for which the "
                f"grid has only {count} grid edges left"
            )
        all_round += sliver
    if all_round > COMPARED_FROM * area:
        kept = _iou(panel, counts)
        if kept < MIN_IOU:
            return (
                f"panel {panel.source!r} would keep {kept:.0%} of its shape: the grid has too "
                "few grid edges left for its bends"
            )
    return ""


def _chords(count: int) -> int:
    """Decoding fits smooth curves: with three grid edges or more, as good as twice the chords."""
    return count if count < 3 else 2 * count


def _iou(panel: PlacedPanel, counts: list[int]) -> float:
    """Overlap of a panel with its chords, centroids aligned."""
    import shapely
    from shapely.affinity import translate

    spread = [np.linspace(0, 1, _chords(count) + 1) for count in counts]
    drawn = [resample(c, at) for c, at in zip(panel.curves, spread, strict=True)]
    shapes = []
    for curves in (panel.curves, drawn):
        rings = [np.concatenate([curves[k][:-1] for k in loop]) for loop in panel.loops]
        shape = shapely.make_valid(shapely.Polygon(rings[0], rings[1:]))
        shapes.append(translate(shape, -shape.centroid.x, -shape.centroid.y))
    a, b = shapes
    return float(a.intersection(b).area / a.union(b).area)
