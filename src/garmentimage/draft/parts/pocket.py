"""Patch pockets, sewn onto a panel with all edges but the upper one."""

from collections.abc import Mapping

from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import PocketDesign
from garmentimage.draft.panel import LEFT, SIDES, Outline, PanelDraft, lines, on_side
from garmentimage.geometry import Point

OVER = 1.0
"""A pocket is placed this far outside of the panel beneath [cm]."""
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
            would be on it at its highest [cm].
        design: the pockets.
        room: how much lower they may lie [cm].

    Raises:
        DraftError: a pocket does not lie on its panel.
    """
    sides = {"none": (), "left": (LEFT,), "both": SIDES}[design.pockets]
    for side in sides:
        base, (x, y) = bases[side]
        low = y - design.pocket_place * room - design.pocket_height
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
