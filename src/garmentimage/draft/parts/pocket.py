"""Patch pockets, sewn onto a panel with all edges but the upper one."""

from collections.abc import Mapping

import numpy as np

from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.curves import chain_polygons
from garmentimage.draft.designs import PocketDesign
from garmentimage.draft.panel import LEFT, SIDES, Outline, PanelDraft, lines, on_side
from garmentimage.geometry import Point

OVER = 1.0
"""A pocket is placed this far outside of the panel beneath [cm]."""
SPARE = 0.2
"""What a pocket keeps from the side of its panel beyond what is required [cm]."""
TIP = 0.12
"""A pocket ends in a point that is so much of its height."""


def add_pockets(
    garment: Assembly,
    bases: Mapping[str, tuple[PanelDraft, Point]],
    design: PocketDesign,
    *,
    room: float = 0.0,
) -> None:
    """Sew pockets onto panels.

    Args:
        garment: has the panels.
        bases: by side of the wearer the panel, and where the middle of the upper edge of a pocket
            would be on it at its highest [cm]; nearer to the middle where the panel is narrow.
        design: the pockets.
        room: how much lower they may lie [cm].

    Raises:
        DraftError: a pocket does not lie on its panel.
    """
    sides = {"none": (), "left": (LEFT,), "both": SIDES}[design.pockets]
    for side in sides:
        base, (x, y) = bases[side]
        low = y - design.pocket_place * room - design.pocket_height
        half = min(half_width(base, low + k * design.pocket_height / 4) for k in range(5))
        farthest = half - design.pocket_width / 2 - rules.POCKET_MARGIN - SPARE
        x = min(max(x, -farthest), farthest)
        outline = on_side(pocket_outline(design.pocket_width, design.pocket_height), side)
        rules.check_pocket(outline, base, (x, low))
        across, up, depth = base.translation
        outward = 1.0 if depth > 0 else -1.0
        name = f"{side}_pocket"
        garment.add(
            PanelDraft(
                name,
                outline,
                (across + outward * x, up + low, depth + outward * OVER),
                base.rotation,
                base.label,
                cloth_layer=1,
            )
        )
        garment.sew_onto(name, ["pocket_edge"], base.name, (x, low))


def half_width(base: PanelDraft, level: float) -> float:
    """How far a panel reaches from the line x = 0 at a level; 0 beyond its ends [cm]."""
    (polygon,) = chain_polygons([[named.curve for named in base.outline]])
    after = np.roll(polygon, -1, axis=0)
    spans = (polygon[:, 1] > level) != (after[:, 1] > level)
    (x0, y0), (x1, y1) = polygon[spans].T, after[spans].T
    return float(np.abs(x0 + (level - y0) / (y1 - y0) * (x1 - x0)).max(initial=0.0))


def pocket_outline(width: float, height: float) -> Outline:
    """A pocket with a point below; x = 0 is its middle, y = 0 the point."""
    left, right, shoulder = -width / 2, width / 2, TIP * height
    return (
        *lines(
            "pocket_edge",
            (left, height), (left, shoulder), (0.0, 0.0), (right, shoulder), (right, height),
        ),
        *lines("pocket_opening", (right, height), (left, height)),
    )  # fmt: skip
