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
from garmentimage.draft.panel import BACK, FACINGS, FRONT, RIGHT, SIDES, PanelDraft, Seam
from garmentimage.draft.parts import (
    BelowWaist,
    BodiceBlock,
    add_collar,
    add_hood,
    add_peplum,
    add_pockets,
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

HIP_POCKET_ACROSS, HIP_POCKET_TOP, HIP_POCKET_ROOM = 0.55, -2.0, 5.0
"""Pockets of jackets: their middle as a share of the half waist, their top over the waist, and what
is free below it and over the hem [cm]."""
CHEST_POCKET_TOP, CHEST_POCKET_ROOM = 6.0, 6.0
"""Pockets on the chest: their top over the bust points, and how much lower they may lie [cm]."""
CARGO_POCKET_ACROSS, CARGO_POCKET_TOP, CARGO_POCKET_SHARE = 0.5, 6.0, 0.45
"""Pockets on the thighs: their middle as a share of the leg's width, their top below the crotch
[cm], and the share of the leg that they have room in."""
SKIRT_POCKET_ACROSS, SKIRT_POCKET_TOP = 0.5, 8.0
"""Pockets of skirts: their middle as a share of the half width, their top below the waist [cm]."""
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


def make_collared(
    garment: Assembly,
    body: BodyMeasurements,
    design: Design,
    *,
    front: str = "open",
    pockets: str = "hip",
) -> None:
    """A jacket, a shirt or a blouse with a collar and patch pockets: at the hip or on the chest."""
    block, panels = make_top(garment, body, design, front=front)
    necks = {(f, side): seam_of(panels[f], "neck", side) for f in FACINGS for side in SIDES}
    add_collar(garment, block, panels, necks, design.collar)
    if pockets == "hip":
        across, top = HIP_POCKET_ACROSS * block.width(0.0, 0.0), HIP_POCKET_TOP
        room = design.bodice.body_length - HIP_POCKET_ROOM - design.pocket.pocket_height
    else:
        across, top = block.bust[0], block.bust[1] + CHEST_POCKET_TOP
        room = CHEST_POCKET_ROOM
    bases = {}
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        base = panels[FRONT][-1 if side == RIGHT else 0]
        bases[side] = base, (sign * across, top)
    add_pockets(garment, bases, design.pocket, room=max(room, 0.0))


def make_cargo_pants(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """Trousers with patch pockets on the thighs."""
    tops = add_trousers(garment, body, design.trousers)
    add_waistband(garment, body, design.waistband, tops)
    drop = body.waist_height - body.crotch_height + CARGO_POCKET_TOP
    by_name = {panel.name: panel for panel in garment.panels}
    bases = {}
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        base = by_name[f"{side}_trouser_front"]
        xs = [n.curve.end[0] for n in base.outline]
        bases[side] = base, (sign * CARGO_POCKET_ACROSS * max(map(abs, xs)), -drop)
    leg = design.trousers.leg_length * body.crotch_height
    room = CARGO_POCKET_SHARE * leg - design.pocket.pocket_height
    add_pockets(garment, bases, design.pocket, room=max(room, 0.0))


def make_pocket_skirt(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A skirt of two panels with patch pockets in front."""
    tops = add_skirt(garment, body, design.skirt)
    add_waistband(garment, body, design.waistband, tops, design.skirt.skirt_fullness)
    base = next(panel for panel in garment.panels if panel.name == tops[FRONT][0].panel)
    across = SKIRT_POCKET_ACROSS * max(abs(n.curve.end[0]) for n in base.outline)
    bases = {
        side: (base, (sign * across, -SKIRT_POCKET_TOP))
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True)
    }
    drop = design.skirt.skirt_length * body.waist_height
    room = drop / 2 - SKIRT_POCKET_TOP
    add_pockets(garment, bases, design.pocket, room=max(room, 0.0))


def make_pleated_skirt(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A skirt of two panels with pleats pressed into the waist."""
    tops = add_skirt(garment, body, design.skirt, pleats=design.pleat)
    add_waistband(garment, body, design.waistband, tops)


def make_peplum_top(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A top with a short skirt over it from the waist on."""
    block, panels = make_top(garment, body, design)
    add_peplum(garment, block, {f: panels[f][0] for f in FACINGS}, design.peplum)


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
        "blazer": make_collared,
        "coat": make_collared,
        "vest": make_collared,
        "blouse": partial(make_collared, front="closed", pockets="chest"),
        "cargo-pants": make_cargo_pants,
        "pocket-skirt": make_pocket_skirt,
        "peplum-top": make_peplum_top,
        "pleated-skirt": make_pleated_skirt,
        "button-shirt": partial(make_collared, pockets="chest"),
        "polo-shirt": partial(make_collared, front="closed", pockets="chest"),
        "turtleneck": partial(make_collared, front="closed", pockets="chest"),
    }
)
"""By kind, what draws its panels and sews them."""
