"""Sleeves in a front and a back half.

Coordinates of a half: the arm is stretched along +x, (0, 0) is the crown of the cap, where the
sleeve meets the shoulder; y = 0 is the upper seam and the cloth lies below it.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from garmentimage.body import BodyMeasurements
from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.curves import curve_points, length_of
from garmentimage.draft.designs import CuffDesign, SleeveDesign
from garmentimage.draft.panel import (
    ALONG,
    BACK,
    FACINGS,
    FRONT,
    GAP,
    LEFT,
    SIDES,
    NamedCurve,
    Outline,
    PanelDraft,
    Seam,
    lines,
    placed,
)
from garmentimage.draft.parts.bodice import BodiceBlock, armhole
from garmentimage.draft.parts.cuff import add_band, add_turn_up
from garmentimage.errors import DraftError
from garmentimage.geometry import Bezier

CROWN_HANDLE = 0.55
"""How far the cap runs level from its crown, as a share of its width."""
UNDERARM_HANDLE = {FRONT: 0.5, BACK: 0.42}
"""How far it runs level into the underarm; the front is hollowed out more."""
MIN_UNDERARM = 3.0
"""Least length of the underarm seam [cm]."""
CUFF_EASE = 4.0
"""How much wider a cuff is than the arm [cm]."""
CLOSE_EASE = 4.0
"""How much wider than the arm a sleeve with full taper is [cm]."""
SLEEVE_LIFT = 4.0
"""How far the upper seam lies over the shoulder point, so that the arm is inside [cm]."""
CAP_TOL = 1e-6
"""How exactly the cap is as long as the armhole [cm]."""
STEPS = 50
"""Most steps to find the width of a cap."""


@dataclass(frozen=True)
class SleeveHalf:
    """Measures of one half of a sleeve [cm]."""

    cap: Bezier
    length: float
    end: float
    """Half the width at the end."""


def add_sleeves(
    garment: Assembly,
    block: BodiceBlock,
    armholes: dict[tuple[str, str], Seam],
    design: SleeveDesign,
    cuffs: CuffDesign | None = None,
) -> None:
    """Sew sleeves into the armholes.

    Args:
        garment: has the panels with the armholes.
        block: the bodice.
        armholes: by facing and side of the wearer.
        design: the sleeves.
        cuffs: their cuffs; default: none.

    Raises:
        DraftError: the arm does not pass, or the sleeve ends above the armpit.
    """
    if design.sleeves == "none":
        return
    bands = cuffs if cuffs is not None and cuffs.cuffs == "band" else None
    lengths = {facing: garment.length(armholes[facing, LEFT]) for facing in FACINGS}
    halves = sleeve_halves(block.body, design, lengths, bands)
    rules.check_sleeve(-sum(h.cap.end[1] for h in halves.values()), block.body.upper_arm_girth)
    distances = {f: beside(block, halves[f].cap, f) + GAP for f in FACINGS}
    for side in SIDES:
        panels = {f: sleeve_panel(block, halves[f], f, side, distances[f]) for f in FACINGS}
        garment.add(*panels.values())
        for seam in ("upper_seam", "underarm_seam"):
            garment.sew(panels[FRONT].seam(seam), panels[BACK].seam(seam))
        for facing, panel in panels.items():
            garment.sew(panel.seam("cap"), armholes[facing, side], fullness=design.cap_fullness)
        if bands is not None:
            add_band(garment, panels, bands, side)
        elif cuffs is not None and cuffs.cuffs == "turned-up":
            add_turn_up(garment, panels, cuffs, side)


def sleeve_halves(
    body: BodyMeasurements,
    design: SleeveDesign,
    armholes: dict[str, float],
    bands: CuffDesign | None,
) -> dict[str, SleeveHalf]:
    """Front and back half of a sleeve for armholes of the given lengths, wide enough for bands."""
    height = design.cap_height * sum(armholes.values()) / 2
    caps = {f: cap_curve(height, design.cap_fullness * armholes[f], f) for f in FACINGS}
    length = design.sleeve_length * body.arm_length
    if length < height + MIN_UNDERARM:
        raise DraftError(
            f"the sleeve is {length:.1f} cm long and its cap {height:.1f} cm high; make "
            "sleeve_length larger or cap_height smaller"
        )
    # Both halves narrow by the same amount, so that their underarm seams are equally long.
    width = -sum(c.end[1] for c in caps.values()) / 2
    arm = arm_girth(body, design.sleeve_length) / 2
    end = width + design.sleeve_taper * (min(arm + CLOSE_EASE / 2, width) - width)
    if design.sleeve_taper < 0:
        end = width * (1 - design.sleeve_taper)
    if bands is not None:
        end = max(end, (arm + CUFF_EASE / 2) * bands.cuff_fullness)
    narrowing = width - end
    return {f: SleeveHalf(c, length, -c.end[1] - narrowing) for f, c in caps.items()}


def cap_curve(height: float, length: float, facing: str) -> Bezier:
    """The cap of a half, `length` long: level at the crown and at the underarm."""
    # Length and width follow each other nearly as in a right triangle of the cap's height.
    width = sqrt(max(length * length - height * height, 0.0))
    for _ in range(STEPS):
        cap = _cap(height, width, facing)
        own = length_of(cap)
        if abs(own - length) <= CAP_TOL:
            return cap
        width = sqrt(max(width * width + length * length - own * own, 0.0))
    raise DraftError(
        f"the cap is {height:.1f} cm high, too much for an armhole half of {length:.1f} cm; make "
        "cap_height smaller"
    )


def _cap(height: float, width: float, facing: str) -> Bezier:
    return Bezier(
        (0.0, 0.0),
        ((0.0, -CROWN_HANDLE * width), (height, -(1 - UNDERARM_HANDLE[facing]) * width)),
        (height, -width),
    )


def arm_girth(body: BodyMeasurements, share: float) -> float:
    """Girth of the arm at a share of its length [cm]."""
    return body.upper_arm_girth + min(share, 1.0) * (body.wrist_girth - body.upper_arm_girth)


def sleeve_panel(
    block: BodiceBlock, half: SleeveHalf, facing: str, side: str, x: float
) -> PanelDraft:
    """One half of a sleeve beside its armhole, its crown `x` from the body's middle [cm]."""
    under = half.cap.end
    outline: Outline = (
        *lines("underarm_seam", under, (half.length, -half.end)),
        *lines("wrist", (half.length, -half.end), (half.length, 0.0)),
        *lines("upper_seam", (half.length, 0.0), (0.0, 0.0)),
        NamedCurve("cap", half.cap),
    )
    height = block.body.waist_height + block.shoulder[1] + SLEEVE_LIFT
    origin = (x if side == LEFT else -x, height, block.depth)
    name = f"{side}_sleeve_{facing}"
    return placed(name, outline, facing, origin, side=side, label="arm", grain=ALONG)


def beside(block: BodiceBlock, cap: Bezier, facing: str) -> float:
    """The x of the crown at which the cap just touches the bodice [cm]."""
    arm_x, arm_y = curve_points(armhole(block, facing)).T
    cap_x, cap_y = curve_points(cap)[::-1].T
    cap_y = cap_y + block.shoulder[1] + SLEEVE_LIFT
    side = max(block.armpit[0], block.waist[0], block.hip[0])
    heights = np.concatenate([arm_y, cap_y])
    bodice = np.interp(heights, arm_y, arm_x, left=side)
    return float((bodice - np.interp(heights, cap_y, cap_x)).max())
