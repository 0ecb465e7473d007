"""The hood: a left and a right half, sewn to the neckline.

Coordinates of the right half, seen from outside: the face is at +x, (0, 0) lies above the shoulder.
"""

from garmentimage.draft.assemble import Assembly
from garmentimage.draft.curves import length_of
from garmentimage.draft.designs import HoodDesign
from garmentimage.draft.panel import (
    BACK,
    FRONT,
    GAP,
    LEFT,
    RIGHT,
    SIDES,
    NamedCurve,
    Outline,
    PanelDraft,
    Seam,
    lines,
    mirrored,
    on_side,
    scaled_curve,
)
from garmentimage.draft.parts.bodice import BodiceBlock
from garmentimage.geometry import Bezier

BACK_NECK_CURVE = Bezier((-1.0, 0.1), ((-0.5, 0.0),), (0.0, 0.0))
"""The neck edge behind the shoulder, before it is scaled to its length."""
FRONT_NECK_CURVE = Bezier((0.0, 0.0), ((0.5, 0.0),), (1.0, -0.3))
"""The neck edge before the shoulder, before it is scaled to its length."""
FACE_LEAN = 1.0
"""How far the face opening leans back at the top [cm]."""
SIDE_TURN = 90.0
"""Rotation about the upright axis of a panel beside the head [degrees]."""


def add_hood(
    garment: Assembly, block: BodiceBlock, necks: dict[tuple[str, str], Seam], design: HoodDesign
) -> None:
    """Sew a hood to the neckline.

    Args:
        garment: has the panels with the neckline.
        block: the bodice.
        necks: the neckline by facing and side of the wearer.
        design: the hood.
    """
    outline = hood_outline(
        garment.length(necks[BACK, RIGHT]),
        garment.length(necks[FRONT, RIGHT]),
        design.hood_height * block.body.head_girth,
        design.hood_room,
    )
    x = block.strap[0] + GAP
    y = block.body.waist_height + block.strap[1] + GAP
    panels = {
        RIGHT: _beside("right_hood", on_side(outline, RIGHT), (-x, y, 0.0), -SIDE_TURN),
        LEFT: _beside("left_hood", on_side(mirrored(outline), LEFT), (x, y, 0.0), SIDE_TURN),
    }
    garment.add(*panels.values())
    for side in SIDES:
        garment.sew(panels[side].seam("hood_neck_back"), necks[BACK, side])
        garment.sew(panels[side].seam("hood_neck_front"), necks[FRONT, side])
    garment.sew(panels[LEFT].seam("hood_seam"), panels[RIGHT].seam("hood_seam"))


def hood_outline(back_neck: float, front_neck: float, height: float, room: float) -> Outline:
    """The right half of a hood whose neck edge has the given lengths [cm]."""
    back = scaled_curve(BACK_NECK_CURVE, back_neck / length_of(BACK_NECK_CURVE))
    front = scaled_curve(FRONT_NECK_CURVE, front_neck / length_of(FRONT_NECK_CURVE))
    (bx, by), (fx, fy) = back.start, front.end
    top, rear = (fx - FACE_LEAN, height), bx - room
    depth = fx - rear
    crest = (rear, 0.55 * height)
    return (
        NamedCurve("hood_neck_back", back),
        NamedCurve("hood_neck_front", front),
        *lines("hood_edge", (fx, fy), top),
        NamedCurve(
            "hood_seam",
            Bezier(top, ((top[0] - 0.6 * depth, height + 1.0), (rear, 0.85 * height)), crest),
        ),
        NamedCurve(
            "hood_seam",
            Bezier(crest, ((rear, 0.3 * height), (bx - 0.5, by + 0.15 * height)), (bx, by)),
        ),
    )


def _beside(
    name: str, outline: Outline, translation: tuple[float, float, float], turn: float
) -> PanelDraft:
    return PanelDraft(name, outline, translation, (0.0, turn, 0.0))
