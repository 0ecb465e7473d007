"""Collars: a stand round the neck, with or without a fall folded down over it, and lapels.

A lapel is sewn to the front neckline right side to wrong side, so it lies on the front. Its short
edge at the shoulder is sewn to the end of the stand on the back neckline. A fall is sewn to the
upper edge of the stand in the same way: that of a shirt collar is open in front and ends in
points, that of a turtle neck goes all round.
"""

from dataclasses import replace
from math import atan2, cos, degrees, sin, sqrt

from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import CollarDesign
from garmentimage.draft.panel import (
    ALONG,
    BACK,
    FRONT,
    RIGHT,
    SIDES,
    NamedCurve,
    Outline,
    PanelDraft,
    Seam,
    closed,
    lines,
    mirrored,
    on_side,
    other,
    placed,
    plus_side,
    whole,
)
from garmentimage.draft.parts.bodice import BodiceBlock
from garmentimage.geometry import Bezier, Point

OVER = 1.0
"""Lapels and falls are placed this far outside of what they lie on [cm]."""
FALL_SPREAD = 0.4
"""How much longer a quarter of the outer edge of a fall is than its seam, by its height."""
STAND_SHARE, TURTLE_SPREAD = 0.42, 1.0
"""Of a turtle neck this share stands up, the rest is turned down; a quarter of its edge is so much
longer than its fold [cm]."""
POINT_LEAN = 0.25
"""How far the points of a fall lie from the middle, as a share of their length."""
NOTCH = ((0.48, 1.0), (0.4, 0.6), (0.26, 1.0))
"""Corners of a notched edge: shares of the neckline from the shoulder, and of the width of the
lapel at its point and in the notch, of the collar's height at its corner."""


def add_collar(
    garment: Assembly,
    block: BodiceBlock,
    panels: dict[str, tuple[PanelDraft, ...]],
    necks: dict[tuple[str, str], Seam],
    design: CollarDesign,
) -> None:
    """Sew a collar to the neckline.

    Args:
        garment: has the panels with the neckline.
        block: the bodice.
        panels: of front and back, by facing.
        necks: the neckline by facing and side of the wearer.
        design: the collar.
    """
    if design.collar == "none":
        return
    lengths = {key: garment.length(neck) for key, neck in necks.items()}
    height = stand_height(design)
    back = _stand(block, BACK, lengths[BACK, RIGHT], height, "collar_back")
    garment.add(*back)
    for side in SIDES:
        garment.sew(_seam(back, "collar_neck", side), necks[BACK, side])
    if design.collar == "lapels":
        for front in panels[FRONT]:
            side = front.outline[0].side
            lapel = _lapel(front, side, lengths[FRONT, side], block.depth, design)
            garment.add(lapel)
            garment.sew(lapel.seam("lapel_seam"), necks[FRONT, side], turned=True)
            ends = lapel.seam("gorge"), _seam(back, "collar_seam", side)
            garment.sew(*ends, turned=True)
        return
    opens = len(panels[FRONT]) == 2
    front_stand = _stand(block, FRONT, lengths[FRONT, RIGHT], height, "collar_front", split=opens)
    garment.add(*front_stand)
    for side in SIDES:
        garment.sew(_seam(front_stand, "collar_neck", side), necks[FRONT, side])
        garment.sew(_seam(front_stand, "collar_seam", side), _seam(back, "collar_seam", side))
    if design.collar in ("shirt", "turtle"):
        _add_fall(garment, {FRONT: front_stand, BACK: back}, lengths, design)


def stand_height(design: CollarDesign) -> float:
    """Height of the stand, over which the rest of a turtle neck is turned down [cm]."""
    if design.collar == "turtle":
        return STAND_SHARE * design.turtle_height
    return design.collar_height


def _seam(panels: tuple[PanelDraft, ...], label: str, side: str) -> Seam:
    return tuple(ref for panel in panels for ref in panel.seam(label, side))


def _stand(
    block: BodiceBlock, facing: str, length: float, height: float, name: str, *, split: bool = False
) -> tuple[PanelDraft, ...]:
    """A level strip over the neckline, in one piece or open in the middle."""
    half = (
        *lines("collar_neck", (0.0, 0.0), (length, 0.0)),
        *lines("collar_seam", (length, 0.0), (length, height)),
        *lines("collar_edge", (length, height), (0.0, height)),
    )
    origin = 0.0, block.body.waist_height + block.strap[1], block.depth
    if not split:
        outline = whole(half, half, facing)
        # A seam for each side of the neckline.
        return (placed(name, _halved(outline, facing), facing, origin, grain=ALONG),)
    middle = lines("collar_opening", (0.0, height), (0.0, 0.0))
    return tuple(
        placed(f"{side}_{name}", (*half, *middle), facing, origin, side=side, grain=ALONG)
        for side in SIDES
    )


def _halved(outline: Outline, facing: str) -> Outline:
    """The outline, its lower edge in two parts that meet in the middle."""
    found: list[NamedCurve] = []
    for named in outline:
        (x0, y0), (x1, y1) = named.curve.start, named.curve.end
        if named.label == "collar_neck" and x0 < 0 < x1:
            plus = plus_side(facing)
            found += on_side(lines("collar_neck", (x0, y0), (0.0, y0)), other(plus))
            found += on_side(lines("collar_neck", (0.0, y1), (x1, y1)), plus)
        else:
            found.append(named)
    return tuple(found)


def _add_fall(
    garment: Assembly,
    stands: dict[str, tuple[PanelDraft, ...]],
    lengths: dict[tuple[str, str], float],
    design: CollarDesign,
) -> None:
    """Fold a fall down over a stand; `lengths` are those of the neckline [cm]."""
    height = stand_height(design)
    falls: dict[str, tuple[PanelDraft, ...]] = {}
    for facing, stand in stands.items():
        half, is_open = _fall_half(facing, lengths[facing, RIGHT], design)
        x, y, depth = stand[0].translation
        origin = (x, y + height, abs(depth) + OVER)
        if is_open:
            outline = closed(half, "fall_opening")
            drawn = [
                placed(f"{side}_fall_{facing}", outline, facing, origin, side=side, grain=ALONG)
                for side in SIDES
            ]
        else:
            outline = whole(half, half, facing)
            drawn = [placed(f"fall_{facing}", outline, facing, origin, grain=ALONG)]
        falls[facing] = tuple(replace(panel, cloth_layer=1) for panel in drawn)
        garment.add(*falls[facing])
        for side in SIDES:
            seams = _seam(falls[facing], "fall_seam", side), _seam(stand, "collar_edge", side)
            garment.sew(*seams, turned=True)
    for side in SIDES:
        garment.sew(*(_seam(falls[facing], "collar_seam", side) for facing in stands))


def _fall_half(facing: str, width: float, design: CollarDesign) -> tuple[Outline, bool]:
    """The half of a fall that hangs down from its seam at y = 0; whether it is open in front."""
    if design.collar == "turtle":
        high, spread = design.turtle_height * (1 - STAND_SHARE), TURTLE_SPREAD
        middle: Point = (0.0, -high)
    else:
        high = design.collar_height + design.fall_reach
        spread, lean = FALL_SPREAD * high, POINT_LEAN * design.collar_point
        middle = (0.0, -high)
        if facing == FRONT:
            middle = (lean, -sqrt(design.collar_point**2 - lean**2))
    half = (
        *lines("collar_edge", middle, (width + spread, -high)),
        *lines("collar_seam", (width + spread, -high), (width, 0.0)),
        *lines("fall_seam", (width, 0.0), (0.0, 0.0)),
    )
    return half, middle[0] > 0


def _lapel(
    front: PanelDraft, side: str, length: float, depth: float, design: CollarDesign
) -> PanelDraft:
    """A lapel folded onto its front: its seam runs as the neckline does."""
    outline = lapel_outline(length, design)
    if side == RIGHT:
        outline = mirrored(outline)
    seam = next(named.curve for named in outline if named.label == "lapel_seam")
    neck = [named.curve for named in front.outline if named.label == "neck"]
    start, end = neck[0].start, neck[-1].end
    angle = atan2(end[1] - start[1], end[0] - start[0])
    turned = (
        cos(angle) * seam.start[0] - sin(angle) * seam.start[1],
        sin(angle) * seam.start[0] + cos(angle) * seam.start[1],
    )
    x, y, _ = front.translation
    return PanelDraft(
        f"{side}_lapel",
        on_side(outline, side),
        (x + start[0] - turned[0], y + start[1] - turned[1], depth + OVER),
        (0.0, 0.0, degrees(angle)),
        cloth_layer=1,
    )


def lapel_outline(length: float, design: CollarDesign) -> Outline:
    """The left lapel, its seam along x from the shoulder on, its cloth at y > 0."""
    height, width = design.collar_height, design.lapel_width
    end: Point = (length, 0.0)
    corner: Point = (0.0, height)
    if design.lapel_shape == "shawl":
        # The middle of the curve is a quarter of its ends and half of its control.
        control = (0.5 * length, 2 * width - height / 2)
        edge: Outline = (NamedCurve("lapel_edge", Bezier(end, (control,), corner)),)
    else:
        (at, out), (notch, inner), (upper, top) = NOTCH
        points = (
            (at * length, out * width),
            (notch * length, inner * min(width, height)),
            (upper * length, top * height),
        )
        edge = lines("lapel_edge", end, *points, corner)
    return (
        *lines("lapel_seam", (0.0, 0.0), end),
        *edge,
        *lines("gorge", corner, (0.0, 0.0)),
    )
