"""Garments of panels that are sewn to themselves all round, for tests of tubes."""

from dataclasses import replace

import numpy as np

from garmentimage.draft import draft_pattern
from garmentimage.geometry.curves import Curve
from garmentimage.pattern import (
    Panel,
    Pattern,
    Side,
    Stitch,
    loop_from_curves,
    mirrored_curvature,
)
from garmentimage.pattern.model import curvature_of, edge_curve
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


def with_whole_sleeves(tee: Pattern) -> Pattern:
    """A drafted tee each of whose sleeves is one panel, which lies over the arm.

    Its front half is the drafted one, its back half the mirror image of that.
    """
    panels = [panel for panel in tee.panels if "sleeve" not in panel.name]
    stitches = [s for s in tee.stitches if not any("sleeve" in side.panel for side in s.sides)]
    for side in ("left", "right"):
        half, name = tee.by_name[f"{side}_sleeve_front"], f"{side}_sleeve"
        labels = [edge.label for edge in half.edges]
        upper = labels.index("upper_seam")
        around = [(upper + k) % 4 for k in (1, 2, 3)]
        curves = [half.curves[k] for k in around]
        outline = loop_from_curves([*curves, *(over_the_fold(c) for c in reversed(curves))])
        own = {labels[k]: n for n, k in enumerate(around)}
        x, y, _ = half.translation
        panels.append(Panel(name, outline, (), (x, y, 0.0), (-90.0, 0.0, 0.0)))
        under = own["underarm_seam"]
        stitches.append(Stitch(Side(name, under), Side(name, 5 - under)))
        for stitch in tee.stitches:
            for mine, other in (stitch.sides, stitch.sides[::-1]):
                if "sleeve" in other.panel or not mine.panel.startswith(name):
                    continue
                cap = own["cap"] if mine.panel.endswith("front") else 5 - own["cap"]
                stitches.append(Stitch(Side(name, cap), other))
    return Pattern(tuple(panels), tuple(stitches))


def over_the_fold(curve: Curve) -> Curve:
    """The mirror image of a curve about y = 0, run the other way."""
    start, end = ((x, -y) for x, y in (curve.end, curve.start))
    return edge_curve(start, end, mirrored_curvature(curvature_of(curve.reversed())))
