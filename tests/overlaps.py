"""Garments with fronts that overlap, the right one over the left, for tests of cloth layers."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from garmentimage.geometry import Line
from garmentimage.pattern import Panel, Pattern, Side, Stitch, loop_from_curves


def overlapping(jacket: Pattern, by: float = 10.0) -> Pattern:
    """A drafted jacket whose fronts reach beyond the middle, the right one over the left."""
    panels = []
    for panel in jacket.panels:
        shift = {"left_front": -by, "right_front": by}.get(panel.name)
        if shift is not None:
            moved = tuple((x + shift * (abs(x) < 1e-6), y) for x, y in panel.outline.vertices)
            outline = replace(panel.outline, vertices=moved)
            panel = replace(panel, outline=outline, cloth_layer=int(panel.name == "right_front"))
        panels.append(panel)
    return replace(jacket, panels=tuple(panels))


def wrapped(dress: Pattern, reach: float = 14.0) -> Pattern:
    """A drafted one-panel dress whose front is two that cross, the right one over the left.

    Each goes from its shoulder straight down to the other side of the wearer at the waist, and so
    on to the hem, `reach` [cm] beyond the middle.
    """
    front = dress.by_name["front"]
    middle = min(k for k, edge in enumerate(front.edges) if edge.label == "hem")
    low = front.curves[middle].end[1]
    panels = [panel for panel in dress.panels if panel is not front]
    moved = {}
    for side, sign in (("right", -1), ("left", 1)):
        # The edges of its half, without those at the neck.
        own = [
            k
            for k, (edge, curve) in enumerate(zip(front.edges, front.curves, strict=True))
            if edge.label != "neck" and sign * np.mean([curve.start[0], curve.end[0]]) > 0
        ]
        curves = [front.curves[k] for k in own]
        far = -sign * reach
        if side == "right":
            end = [(0.0, low), (far, low), (far, 0.0), curves[0].start]
        else:
            end = [curves[-1].end, (far, 0.0), (far, low), (0.0, low)]
        added = [Line(a, b) for a, b in pairwise(end)]
        outline = loop_from_curves([*curves, *added])
        name, layer = f"{side}_front", int(side == "right")
        place = front.translation, front.rotation
        panels.append(Panel(name, outline, (), *place, cloth_layer=layer))
        moved |= {Side("front", k): Side(name, n) for n, k in enumerate(own)}
    stitches = tuple(Stitch(moved.get(s.a, s.a), moved.get(s.b, s.b)) for s in dress.stitches)
    return replace(dress, panels=tuple(panels), stitches=stitches)
