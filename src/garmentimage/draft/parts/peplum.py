"""A peplum: a short skirt that is sewn across front and back at the waist and lies over them."""

from dataclasses import replace

from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import PeplumDesign
from garmentimage.draft.panel import FACINGS, PanelDraft, lines, placed, whole
from garmentimage.draft.parts.bodice import BodiceBlock

OVER = 1.0
"""It is placed this far outside of front and back [cm]."""


def add_peplum(
    garment: Assembly, block: BodiceBlock, bases: dict[str, PanelDraft], design: PeplumDesign
) -> None:
    """Sew a peplum onto front and back.

    Args:
        garment: has the panels beneath.
        block: the bodice.
        bases: front and back, each in one piece that goes on below the waist.
        design: the peplum.
    """
    width, length = block.waist[0], design.peplum_length
    hem = width + design.peplum_flare * length
    half = (
        *lines("hem", (0.0, -length), (hem, -length)),
        *lines("side_seam", (hem, -length), (width, 0.0)),
        *lines("peplum_seam", (width, 0.0), (0.0, 0.0)),
    )
    panels = []
    for facing in FACINGS:
        origin = (0.0, block.body.waist_height, block.depth + OVER)
        drawn = placed(f"peplum_{facing}", whole(half, half, facing), facing, origin)
        panels.append(replace(drawn, cloth_layer=1))
    garment.add(*panels)
    front, back = panels
    garment.sew_pairs(front, back, "side_seam")
    for facing, panel in zip(FACINGS, panels, strict=True):
        garment.sew_onto(panel.name, ["peplum_seam"], bases[facing].name, (0.0, 0.0))
