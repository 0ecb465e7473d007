"""Garments with panels sewn right side to wrong side, for tests of turned panels."""

from dataclasses import replace

import numpy as np

from garmentimage.geometry import Line
from garmentimage.pattern import (
    Loop,
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


def with_collar(jacket: Pattern, height: float = 5.0) -> Pattern:
    """The default drafted jacket with lapels that go on into a collar which stands up behind.

    A lapel is a triangle folded onto its front. Its short edge at the shoulder is sewn to the end
    of a stand on the back's neck edge, of this height [cm].
    """
    panels, stitches = list(jacket.panels), list(jacket.stitches)
    # Side of the body, neck edges of its front and of the back, corner of the lapel over its seam,
    # short edge of the lapel, end of the stand at the shoulder.
    for side, neck, behind, at_end, short, end in (
        ("left", 5, 0, False, 2, 3),
        ("right", 1, 10, True, 1, 1),
    ):
        front, back = jacket.by_name[f"{side}_front"], jacket.by_name["back"]
        own, base = front.curves[neck], back.curves[behind]
        angle = np.degrees(np.arctan2(*np.subtract(own.end, own.start)[::-1]))
        x, y, z = front.to_world(np.array([own.start]))[0].tolist()
        outline = polygon((0, 0), (own.length, 0), (own.length * at_end, height))
        lapel = Panel(f"{side}_lapel", outline, (), (x, y, z + 1.0), (0.0, 0.0, float(angle)))
        x, y, z = back.to_world(np.array([base.end]))[0].tolist()
        outline = polygon((0, 0), (base.length, 0), (base.length, height), (0, height))
        stand = Panel(f"{side}_stand", outline, (), (x, y, z), (0.0, 180.0, 0.0))
        panels += [lapel, stand]
        stitches += [
            Stitch(Side(lapel.name, 0), Side(front.name, neck), same_direction=True),
            Stitch(Side(stand.name, 0), Side("back", behind)),
            Stitch(Side(lapel.name, short), Side(stand.name, end), same_direction=True),
        ]
    stitches.append(Stitch(Side("left_stand", 1), Side("right_stand", 3)))
    return replace(jacket, panels=tuple(panels), stitches=tuple(stitches))


def polygon(*corners: tuple[float, float]) -> Loop:
    """An outline with straight edges."""
    points = [(float(x), float(y)) for x, y in corners]
    return loop_from_curves(
        [Line(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    )
