"""Pleats in the waist of a skirt: folded cloth, pressed from the waist down.

A pleat of depth d takes two edges of d out of the waist, which are sewn to each other.
"""

from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import PleatDesign
from garmentimage.draft.panel import Outline, PanelDraft, lines
from garmentimage.errors import DraftError
from garmentimage.pattern import PleatFold

MIN_BETWEEN = 1.0
"""Least length of waist between the folds of two pleats that lie on each other [cm]."""


def pleat_label(number: int) -> str:
    """The label of the two edges of a pleat; pleats are counted from positive x on."""
    return f"pleat_{number + 1}"


def folded_width(design: PleatDesign) -> float:
    """How much wider a panel is for the cloth that its pleats fold under [cm]."""
    return 2 * design.pleat_depth * 2 * design.pleats_a_side


def pleated_waist(waist: float, design: PleatDesign) -> Outline:
    """The upper edge of a panel at y = 0, from positive to negative x.

    Raises:
        DraftError: the pleats lie on each other.
    """
    count, depth = 2 * design.pleats_a_side, design.pleat_depth
    between = waist / (count + 1)
    if between < depth + MIN_BETWEEN:
        raise DraftError(
            f"{count} pleats of {depth:.1f} cm do not lie beside each other on a waist of "
            f"{waist:.1f} cm; make pleat_depth or pleats_a_side smaller"
        )
    x = (waist + folded_width(design)) / 2
    drawn: Outline = ()
    for k in range(count):
        points = [(x - step, 0.0) for step in (0.0, between, between + depth, between + 2 * depth)]
        drawn += lines("waist", *points[:2]) + lines(pleat_label(k), *points[1:])
        x = points[-1][0]
    return drawn + lines("waist", (x, 0.0), (x - between, 0.0))


def press_pleats(garment: Assembly, panel: PanelDraft, design: PleatDesign, drop: float) -> None:
    """Sew the pleats of a panel and press them; `drop` is the length of the skirt [cm]."""
    count = 2 * design.pleats_a_side
    for k in range(count):
        legs = panel.seam(pleat_label(k))
        garment.sew(legs[:1], legs[1:])
        garment.press(legs, _fold(design, at_plus=2 * k < count), design.pleat_pressed * drop)


def _fold(design: PleatDesign, *, at_plus: bool) -> PleatFold:
    """Knife pleats point away from the middle of the panel."""
    if design.pleats == "box":
        return "box"
    if design.pleats == "inverted":
        return "inverted"
    return "right" if at_plus else "left"
