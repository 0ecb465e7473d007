"""Whether a pattern can be cut and sewn as it stands."""

from collections import Counter
from typing import Any

import numpy as np

from garmentimage.compare.matching import loop_polygon
from garmentimage.compare.stitch_graphs import StitchGraph, stitch_graph
from garmentimage.pattern import Panel, Pattern, Side

MAX_SEAM_RATIO = 4.0
"""The most that one side of a seam may be longer than the other; real gathers reach 3.99."""


def pattern_faults(pattern: Pattern) -> list[str]:
    """Why a pattern cannot be cut and sewn; empty where it can.

    Loops are closed and do not cross themselves, holes lie inside their panel and apart, stitches
    name edges that exist, no edge is sewn twice, and no seam gathers more than `MAX_SEAM_RATIO`
    (looked at where all else is well).
    """
    return structure_faults(pattern) or ratio_faults(stitch_graph(pattern))


def structure_faults(pattern: Pattern) -> list[str]:
    """The reasons of `pattern_faults` that do not depend on lengths."""
    panels = [reason for panel in pattern.panels for reason in panel_faults(panel)]
    return panels + stitch_faults(pattern)


def panel_faults(panel: Panel) -> list[str]:
    """Why a panel cannot be cut from cloth."""
    import shapely

    if faults := drawing_faults(panel):
        return faults
    where = f"panel {panel.name!r}"
    for number, loop in enumerate(panel.loops):
        what = _called(number)
        ring: Any = shapely.Polygon(loop_polygon(loop))
        if not ring.is_valid:
            return [f"{where}: {what} crosses itself ({shapely.is_valid_reason(ring)})"]
        if ring.area <= 0:
            return [f"{where}: {what} has no area"]
    if panel.holes:
        cloth = shapely.Polygon(
            loop_polygon(panel.outline), [loop_polygon(hole) for hole in panel.holes]
        )
        if not cloth.is_valid:
            return [f"{where}: holes leave the panel or meet ({shapely.is_valid_reason(cloth)})"]
    return []


def drawing_faults(panel: Panel) -> list[str]:
    """Why a panel cannot even be drawn: loops of too few edges, open ones, no numbers."""
    where = f"panel {panel.name!r}"
    if not np.isfinite([*panel.rotation, *panel.translation]).all():
        return [f"{where}: has a place that is not finite"]
    for number, loop in enumerate(panel.loops):
        what = _called(number)
        if len(loop.edges) < 2:
            return [f"{where}: {what} has {len(loop.edges)} edges"]
        if any(
            e.end != f.start
            for e, f in zip(loop.edges, loop.edges[1:] + loop.edges[:1], strict=True)
        ):
            return [f"{where}: {what} is not closed"]
        if not np.isfinite(loop_polygon(loop)).all():
            return [f"{where}: {what} has coordinates that are not finite"]
    return []


def _called(loop: int) -> str:
    return "the outline" if loop == 0 else f"hole {loop}"


def stitch_faults(pattern: Pattern) -> list[str]:
    """Stitches that name nothing, and edges that are sewn twice."""
    existing = set(pattern.sides())
    reasons = [
        f"stitch {number} names edge {side.edge} of panel {side.panel!r}, which does not exist"
        for number, stitch in enumerate(pattern.stitches)
        for side in stitch.sides
        if side not in existing
    ]
    uses: Counter[Side] = Counter(side for s in pattern.stitches for side in s.sides)
    reasons += [
        f"edge {side.edge} of panel {side.panel!r} is sewn {count} times"
        for side, count in uses.items()
        if count > 1
    ]
    names = Counter(panel.name for panel in pattern.panels)
    return reasons + [f"{n} panels are called {name!r}" for name, n in names.items() if n > 1]


def ratio_faults(graph: StitchGraph) -> list[str]:
    """Seams with one side much longer than the other."""
    reasons = []
    for seam in graph.seams:
        short, long = sorted((graph.sides[k] for k in seam), key=lambda s: s.length)
        if long.length > MAX_SEAM_RATIO * short.length:
            reasons.append(
                f"seam of panel {long.panel!r}, edges {list(long.edges)}, is {long.length:.1f} cm "
                f"long, its other side on {short.panel!r} {short.length:.1f} cm"
            )
    return reasons
