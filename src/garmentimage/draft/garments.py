"""How the parts of each kind of garment are drawn and sewn together."""

from collections.abc import Callable, Mapping
from functools import partial
from itertools import product
from types import MappingProxyType
from typing import Any

from garmentimage.body import BodyMeasurements
from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import Design
from garmentimage.draft.panel import BACK, FACINGS, FRONT, SIDES, PanelDraft, Seam
from garmentimage.draft.parts import (
    BelowWaist,
    BodiceBlock,
    add_hood,
    add_skirt,
    add_sleeves,
    add_trousers,
    add_waistband,
    below_waist,
    legs_below_waist,
    to_waist,
    trunk,
)
from garmentimage.pattern import Pattern

DART_LABELS = ("waist_dart_1", "waist_dart_2", "side_dart")
"""Edges of a panel that are legs of one dart."""


def draw_garment(kind: str, body: BodyMeasurements, design: Design) -> Pattern:
    """The garment of a kind for a body."""
    garment = Assembly()
    MAKERS[kind](garment, body, design)
    rules.check_outlines(garment.panels)
    return garment.pattern(kind)


def _sew_trunk(
    garment: Assembly,
    block: BodiceBlock,
    design: Design,
    below: BelowWaist,
    *,
    front: str = "closed",
) -> dict[str, tuple[PanelDraft, ...]]:
    """Front and back with their sleeves; `front` is closed, open or under a hood."""
    inner, outer = block.shoulder_ends
    rules.check_strap(outer - inner)
    is_split = design.bodice.panels_a_side == 2
    panels = {
        facing: trunk(
            block,
            below,
            facing,
            split=is_split or (front == "open" and facing == FRONT),
            darts=design.darts if block.intake or design.darts.has_side_dart else None,
            cutout=design.cutout,
        )
        for facing in FACINGS
    }
    garment.add(*panels[FRONT], *panels[BACK])
    for side, label in product(SIDES, ("side_seam", "shoulder")):
        garment.sew(*(seam_of(panels[facing], label, side) for facing in FACINGS))
    if is_split:
        garment.sew(*(seam_of(panels[BACK], "cb", side) for side in SIDES))
        if front != "open":
            garment.sew(*(seam_of(panels[FRONT], "cf", side) for side in SIDES))
    for panel, side, label in product((*panels[FRONT], *panels[BACK]), SIDES, DART_LABELS):
        if legs := panel.seam(label, side):
            garment.sew(legs[:1], legs[1:])
    if front != "open":
        opening = sum(garment.length(seam_of(panels[facing], "neck")) for facing in FACINGS)
        rules.check_neck(opening, block.body.head_girth)
    armholes = {(f, side): seam_of(panels[f], "armhole", side) for f in FACINGS for side in SIDES}
    add_sleeves(garment, block, armholes, design.sleeve, design.cuff)
    return panels


def seam_of(panels: tuple[PanelDraft, ...], label: str, side: str | None = None) -> Seam:
    """The edges with this label on all of the panels."""
    return tuple(ref for panel in panels for ref in panel.seam(label, side))


def make_top(
    garment: Assembly,
    body: BodyMeasurements,
    design: Design,
    *,
    has_darts: bool = False,
    front: str = "closed",
) -> tuple[BodiceBlock, dict[str, tuple[PanelDraft, ...]]]:
    """A bodice that ends at a hem; its block and panels."""
    block = BodiceBlock(body, design.bodice, design.neck, design.darts.intake if has_darts else 0.0)
    below = below_waist(block, design.hem, design.bodice.body_length)
    return block, _sew_trunk(garment, block, design, below, front=front)


def make_hoodie(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice with a hood."""
    block, panels = make_top(garment, body, design, front="hood")
    necks = {(f, side): seam_of(panels[f], "neck", side) for f in FACINGS for side in SIDES}
    add_hood(garment, block, necks, design.hood)


def make_jumpsuit(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice that continues into both legs."""
    block = BodiceBlock(body, design.bodice, design.neck)
    panels = _sew_trunk(garment, block, design, legs_below_waist(block, design.trousers))
    for side in SIDES:
        garment.sew(*(seam_of(panels[facing], "inseam", side) for facing in FACINGS))


def make_top_skirt(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice sewn to a skirt."""
    block = BodiceBlock(body, design.bodice, design.neck)
    panels = _sew_trunk(garment, block, design, to_waist(block))
    waists = {facing: seam_of(panels[facing], "waist") for facing in FACINGS}
    lengths = {facing: garment.length(waist) for facing, waist in waists.items()}
    tops = add_skirt(garment, body, design.skirt, lengths)
    for facing in FACINGS:
        garment.sew(tops[facing], waists[facing], fullness=design.skirt.skirt_fullness)


def make_top_pants(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice sewn to trousers."""
    block = BodiceBlock(body, design.bodice, design.neck)
    panels = _sew_trunk(garment, block, design, to_waist(block))
    waists = {facing: seam_of(panels[facing], "waist") for facing in FACINGS}
    tops = add_trousers(garment, body, design.trousers, garment.length(waists[FRONT]))
    for facing in FACINGS:
        garment.sew(tops[facing], waists[facing])


def make_skirt(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A skirt, with a waistband or without."""
    tops = add_skirt(garment, body, design.skirt)
    add_waistband(garment, body, design.waistband, tops, design.skirt.skirt_fullness)


def make_pants(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """Trousers, with a waistband or without."""
    tops = add_trousers(garment, body, design.trousers)
    add_waistband(garment, body, design.waistband, tops)


MAKERS: Mapping[str, Callable[[Assembly, BodyMeasurements, Design], Any]] = MappingProxyType(
    {
        "one-panel-dress": make_top,
        "one-panel-jumpsuit": make_jumpsuit,
        "top-skirt": make_top_skirt,
        "top-pants": make_top_pants,
        "shirt": partial(make_top, has_darts=True),
        "skirt": make_skirt,
        "pants": make_pants,
        "tee": make_top,
        "tank": make_top,
        "jacket": partial(make_top, front="open"),
        "hoodie": make_hoodie,
    }
)
"""By kind, what draws its panels and sews them."""
