"""Garments with panels sewn right side to wrong side, for tests of turned panels."""

from dataclasses import replace

import numpy as np

from garmentimage.geometry import Line
from garmentimage.pattern import (
    Panel,
    Pattern,
    Side,
    Stitch,
    loop_from_curves,
    mirrored_curvature,
)
from garmentimage.pattern.model import curvature_of, edge_curve


def with_lapels(jacket: Pattern, depth: float = 7.0) -> Pattern:
    """A drafted jacket with a lapel on either front, folded outward at the neckline.

    A lapel lies on the front, right side out; its seam is the mirror image of the neckline, about
    whose chord it is folded.

    Args:
        jacket: with panels `left_front` and `right_front` whose neck edges have the label `neck`.
        depth: how far the point of the lapel lies from its seam [cm].
    """
    panels, stitches = list(jacket.panels), list(jacket.stitches)
    for side in ("left", "right"):
        front = jacket.by_name[f"{side}_front"]
        (neck,) = (k for k, edge in enumerate(front.edges) if edge.label == "neck")
        curve = front.curves[neck]
        start, end = np.array(curve.start), np.array(curve.end)
        along = (end - start) / np.hypot(*(end - start))
        inward = np.array([-along[1], along[0]])  # the outline runs counter-clockwise
        x, y = ((start + end) / 2 + depth * inward).tolist()
        folded = edge_curve(curve.start, curve.end, mirrored_curvature(curvature_of(curve)))
        outline = loop_from_curves([folded, Line(curve.end, (x, y)), Line((x, y), curve.start)])
        left, up, ahead = front.translation
        panels.append(Panel(f"{side}_lapel", outline, (), (left, up, ahead + 1.0), front.rotation))
        stitches.append(
            Stitch(Side(f"{side}_lapel", 0), Side(front.name, neck), same_direction=True)
        )
    return replace(jacket, panels=tuple(panels), stitches=tuple(stitches))


def moebius() -> Pattern:
    """A strip of two panels whose ends are sewn with a twist."""
    shape = loop_from_curves(
        [
            Line((0.0, 0.0), (10.0, 0.0)),
            Line((10.0, 0.0), (10.0, 30.0)),
            Line((10.0, 30.0), (0.0, 30.0)),
            Line((0.0, 30.0), (0.0, 0.0)),
        ]
    )
    panels = (
        Panel("a", shape, (), (0.0, 100.0, 20.0)),
        Panel("b", shape, (), (0.0, 100.0, -20.0), (0.0, 180.0, 0.0)),
    )
    plain = Stitch(Side("a", 1), Side("b", 3))
    return Pattern(panels, (plain, Stitch(Side("a", 3), Side("b", 1), same_direction=True)))
