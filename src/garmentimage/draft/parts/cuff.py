"""Cuffs at the ends of sleeves: a band that is sewn on, and one that is turned up over the sleeve.

Coordinates as those of sleeves: the arm is stretched along +x, the cloth lies below y = 0.
"""

from dataclasses import replace

from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import CuffDesign
from garmentimage.draft.panel import (
    ALONG,
    BACK,
    FRONT,
    GAP,
    LEFT,
    Outline,
    PanelDraft,
    lines,
    placed,
)

OVER = 1.0
"""A cuff that is turned up is placed this far outside of its sleeve [cm]."""
TURN_UP_EASE = 1.0
"""How much wider than the sleeve beneath it each half of it ends [cm]."""


def add_band(
    garment: Assembly, panels: dict[str, PanelDraft], design: CuffDesign, side: str
) -> None:
    """Sew a cuff to the end of a sleeve; `panels` are its halves."""
    cuffs = {}
    for facing, sleeve in panels.items():
        wrist = sleeve.seam("wrist")
        width = garment.length(wrist) / design.cuff_fullness
        depth = design.cuff_depth
        outline: Outline = (
            *lines("cuff_under", (0.0, -width), (depth, -width)),
            *lines("cuff_end", (depth, -width), (depth, 0.0)),
            *lines("cuff_upper", (depth, 0.0), (0.0, 0.0)),
            *lines("cuff_top", (0.0, 0.0), (0.0, -width)),
        )
        reach = max(abs(p[0]) for n in sleeve.outline for p in (n.curve.start, n.curve.end))
        x, y, z = sleeve.translation
        drop = (garment.length(wrist) - width) / 2
        away = 1 if side == LEFT else -1
        origin = (x + away * (reach + GAP), y - drop, abs(z))
        name = f"{side}_cuff_{facing}"
        cuffs[facing] = placed(name, outline, facing, origin, side=side, label="arm", grain=ALONG)
        garment.add(cuffs[facing])
        garment.sew(wrist, cuffs[facing].seam("cuff_top"), fullness=design.cuff_fullness)
    for seam in ("cuff_upper", "cuff_under"):
        garment.sew(cuffs[FRONT].seam(seam), cuffs[BACK].seam(seam))


def add_turn_up(
    garment: Assembly, panels: dict[str, PanelDraft], design: CuffDesign, side: str
) -> None:
    """Sew a cuff to the end of a sleeve, folded up over it; `panels` are its halves.

    Raises:
        DraftError: it would reach into the armhole.
    """
    depth, cuffs = design.cuff_depth, {}
    for facing, sleeve in panels.items():
        under = next(n.curve for n in sleeve.outline if n.label == "underarm_seam")
        (inner, top), (end, low) = sorted((abs(x), y) for x, y in (under.start, under.end))
        rules.check_turn_up(depth, end - inner)
        # As wide as the sleeve that it lies on, and at least as its end.
        spread = max(depth * (low - top) / (end - inner), 0.0) + TURN_UP_EASE / 2
        inside, rise = end - depth, TURN_UP_EASE / 2
        outline: Outline = (
            *lines("cuff_under", (inside, low - spread), (end, low)),
            *lines("cuff_fold", (end, low), (end, 0.0)),
            *lines("cuff_upper", (end, 0.0), (inside, rise)),
            *lines("cuff_end", (inside, rise), (inside, low - spread)),
        )
        x, y, z = sleeve.translation
        name = f"{side}_cuff_{facing}"
        drawn = placed(
            name, outline, facing, (x, y, abs(z) + OVER), side=side, label="arm", grain=ALONG
        )
        cuffs[facing] = replace(drawn, cloth_layer=1)
        garment.add(cuffs[facing])
        garment.sew(cuffs[facing].seam("cuff_fold"), sleeve.seam("wrist"), turned=True)
    for seam in ("cuff_upper", "cuff_under"):
        garment.sew(cuffs[FRONT].seam(seam), cuffs[BACK].seam(seam))
