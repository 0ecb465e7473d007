"""Collars: a stand round the neck, and lapels that are folded over and go on into one behind.

A lapel is sewn to the front neckline right side to wrong side, so it lies on the front. Its short
edge at the shoulder is sewn to the end of the stand on the back neckline.
"""

from math import atan2, cos, degrees, sin

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

OVER_FRONT = 1.0
"""A lapel is placed this far outside of the front [cm]."""
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
    back = _stand(block, BACK, lengths[BACK, RIGHT], design.collar_height, "collar_back")
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
    front_stand = _stand(
        block, FRONT, lengths[FRONT, RIGHT], design.collar_height, "collar_front", split=opens
    )
    garment.add(*front_stand)
    for side in SIDES:
        garment.sew(_seam(front_stand, "collar_neck", side), necks[FRONT, side])
        garment.sew(_seam(front_stand, "collar_seam", side), _seam(back, "collar_seam", side))


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
        (x + start[0] - turned[0], y + start[1] - turned[1], depth + OVER_FRONT),
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
