"""Garments of panels that are sewn to themselves all round, for tests of tubes."""

from dataclasses import replace

import numpy as np

from garmentimage.draft import draft_pattern
from garmentimage.pattern import Panel, Pattern, Side, Stitch, loop_from_curves
from tests.lapels import polygon

BEHIND = (0.0, 180.0, 0.0)


def tube(width=96.0, height=55.0, flare=0.0, *, behind=False, name="skirt"):
    """A skirt of one panel whose two sides are sewn together, drawn in front or behind."""
    w, h = width / 2, height
    outline = polygon((-w - flare, 0), (w + flare, 0), (w, h), (-w, h))
    place = (0.0, 100.0 - height, -20.0 if behind else 20.0)
    panel = Panel(name, outline, (), place, BEHIND if behind else (0.0, 0.0, 0.0))
    return Pattern((panel,), (Stitch(Side(name, 1), Side(name, 3)),))


def with_band(skirt: Pattern, length: float = 74.0) -> Pattern:
    """The skirt with a waistband of one panel, whose ends are sewn together."""
    (panel,) = skirt.panels
    x, _, z = panel.translation
    w = length / 2
    outline = polygon((-w, 0), (w, 0), (w, 4), (-w, 4))
    band = Panel("waistband", outline, (), (x, 101.0, z), panel.rotation)
    sewn = Stitch(Side(panel.name, 2), Side("waistband", 0))
    ring = Stitch(Side("waistband", 1), Side("waistband", 3))
    return Pattern((panel, band), (*skirt.stitches, sewn, ring))


def under_a_top(height: float = 50.0) -> Pattern:
    """A tank top over a skirt of one panel, sewn on all round."""
    top = draft_pattern("tank")
    front, back = top.by_name["front"], top.by_name["back"]
    hems = [[k for k, e in enumerate(p.edges) if e.label == "hem"] for p in (front, back)]
    (own,), (behind,) = hems
    a, b = (p.curves[k].length / 2 for p, k in ((front, own), (back, behind)))
    outline = polygon(
        (-a - b, 0), (a + b, 0), (a + b, height), (a, height), (-a, height), (-a - b, height)
    )
    y = float(front.to_world(np.array([front.curves[own].start]))[0, 1])
    skirt = Panel("skirt", outline, (), (0.0, y - height - 0.5, front.translation[2]))
    # The hem of the back is cut in two over the skirt's seam.
    curves = list(back.curves)
    curves[behind : behind + 1] = curves[behind].split(0.5)
    cut = replace(back, outline=loop_from_curves(curves))
    middle = cut.to_world(np.array([cut.curves[behind].sample(2)[1]]))[0, 0]
    left, right = (behind, behind + 1) if middle > 0 else (behind + 1, behind)

    def moved(side: Side) -> Side:
        return replace(side, edge=side.edge + (side.panel == "back" and side.edge > behind))

    stitches = [Stitch(moved(s.a), moved(s.b)) for s in top.stitches]
    pairs = ((1, "skirt", 5), (3, "front", own), (2, "back", left), (4, "back", right))
    stitches += [Stitch(Side("skirt", k), Side(name, m)) for k, name, m in pairs]
    panels = [cut if panel is back else panel for panel in top.panels]
    return Pattern((*panels, skirt), tuple(stitches))
