"""The kinds of garments: which parts are put together, and what can be chosen about them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Any

from garmentimage.body import BodyMeasurements, measurements
from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.panel import BACK, FACINGS, FRONT, SIDES, PanelDraft, Seam
from garmentimage.draft.parameters import Parameter, Value, checked_values, parameters_of
from garmentimage.draft.parts import (
    BelowWaist,
    BodiceBlock,
    BodiceDesign,
    CuffDesign,
    CutoutDesign,
    DartDesign,
    HemDesign,
    HoodDesign,
    NeckDesign,
    SkirtDesign,
    SleeveDesign,
    TrousersDesign,
    WaistbandDesign,
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
from garmentimage.errors import DraftError, check_type, quoted
from garmentimage.pattern import Pattern
from garmentimage.system import did_you_mean

DEFAULT_BODY = "mean-female"
DART_LABELS = ("waist_dart_1", "waist_dart_2", "side_dart")
"""Edges of a panel that are legs of one dart."""


@dataclass(frozen=True)
class Design:
    """Everything that can be chosen about a garment, part by part."""

    bodice: BodiceDesign
    neck: NeckDesign
    hem: HemDesign
    darts: DartDesign
    cutout: CutoutDesign
    sleeve: SleeveDesign
    cuff: CuffDesign
    hood: HoodDesign
    skirt: SkirtDesign
    trousers: TrousersDesign
    waistband: WaistbandDesign


PARTS: Mapping[str, Any] = MappingProxyType({f.name: f.type for f in fields(Design)})
"""The design class of each part."""

FIELDS: Mapping[type, tuple[str, ...]] = MappingProxyType(
    {design: tuple(f.name for f in fields(design)) for design in PARTS.values()}
)
"""The names of a design's fields."""

Make = Callable[[Assembly, BodyMeasurements, Design], None]


@dataclass(frozen=True)
class Kind:
    """A kind of garment: how its parts are put together, and what can be chosen about them."""

    name: str
    doc: str
    parameters: Mapping[str, Parameter]
    make: Make
    """Draws and sews the parts."""
    settled: Mapping[str, Value]
    """Fields of the parts that this kind does not offer, where they differ from the default."""

    def draft(self, body: BodyMeasurements, given: Mapping[str, Any]) -> Pattern:
        """The garment for a body; `given` are parameters by name.

        Raises:
            DraftError: a parameter is unknown or out of range, or the garment cannot be worn.
        """
        values = {**self.settled, **checked_values(self.parameters, given, f"kind {self.name}")}
        design = Design(**{part: _part(design, values) for part, design in PARTS.items()})
        garment = Assembly()
        self.make(garment, body, design)
        rules.check_outlines(garment.panels)
        return garment.pattern(self.name)


def draft_pattern(
    kind: str, body: str | BodyMeasurements = DEFAULT_BODY, **parameters: Value
) -> Pattern:
    """Draft a garment.

    Args:
        kind: a name from `kinds()`.
        body: measurements, or the name of a shipped body.
        parameters: what differs from the defaults; `kinds()[kind].parameters` lists them.

    Returns:
        The pattern, placed round the body, its edges labelled as the trade calls them.

    Raises:
        DraftError: an unknown name, a value out of range, a body that cannot be, or a garment that
            cannot be worn.
    """
    if kind not in KINDS:
        raise DraftError(f"there is no kind {quoted(kind)}; {did_you_mean(kind, KINDS)}")
    if isinstance(body, str):
        body = measurements(body)
    else:
        check_type(body, BodyMeasurements, "load_measurements(path) reads one, a name picks one")
        body.check()
    return KINDS[kind].draft(body, parameters)


def kinds() -> Mapping[str, Kind]:
    """Every kind of garment that can be drafted, by name."""
    return KINDS


def _part(design: type, values: Mapping[str, Value]) -> Any:
    return design(**{name: values[name] for name in FIELDS[design] if name in values})


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
    for side in SIDES:
        for label in ("side_seam", "shoulder"):
            garment.sew(*(seam_of(panels[facing], label, side) for facing in FACINGS))
    if is_split:
        garment.sew(*(seam_of(panels[BACK], "cb", side) for side in SIDES))
        if front != "open":
            garment.sew(*(seam_of(panels[FRONT], "cf", side) for side in SIDES))
    for panel in (*panels[FRONT], *panels[BACK]):
        _sew_darts(garment, panel)
    if front != "open":
        opening = sum(garment.length(seam_of(panels[facing], "neck")) for facing in FACINGS)
        rules.check_neck(opening, block.body.head_girth)
    armholes = {
        (facing, side): seam_of(panels[facing], "armhole", side)
        for facing in FACINGS
        for side in SIDES
    }
    add_sleeves(garment, block, armholes, design.sleeve, design.cuff)
    return panels


def _sew_darts(garment: Assembly, panel: PanelDraft) -> None:
    for side in SIDES:
        for label in DART_LABELS:
            legs = panel.seam(label, side)
            if legs:
                garment.sew(legs[:1], legs[1:])


def seam_of(panels: tuple[PanelDraft, ...], label: str, side: str | None = None) -> Seam:
    """The edges with this label on all of the panels."""
    return tuple(ref for panel in panels for ref in panel.seam(label, side))


def make_top(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice that ends at a hem."""
    block = BodiceBlock(body, design.bodice, design.neck)
    _sew_trunk(garment, block, design, below_waist(block, design.hem, design.bodice.body_length))


def make_shirt(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice with darts."""
    block = BodiceBlock(body, design.bodice, design.neck, design.darts.intake)
    _sew_trunk(garment, block, design, below_waist(block, design.hem, design.bodice.body_length))


def make_jacket(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A bodice that is open in front."""
    block = BodiceBlock(body, design.bodice, design.neck)
    below = below_waist(block, design.hem, design.bodice.body_length)
    _sew_trunk(garment, block, design, below, front="open")


def make_hoodie(garment: Assembly, body: BodyMeasurements, design: Design) -> None:
    """A top with a hood."""
    block = BodiceBlock(body, design.bodice, design.neck)
    below = below_waist(block, design.hem, design.bodice.body_length)
    panels = _sew_trunk(garment, block, design, below)
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


def _kind(
    name: str,
    doc: str,
    make: Make,
    parts: tuple[type, ...],
    *,
    settled: Mapping[str, Value] = MappingProxyType({}),
    **changes: Any,
) -> Kind:
    """A kind that offers all fields of `parts` but the settled ones.

    `changes` give a parameter another default (one value) or another default, low and high.
    """
    offered: dict[str, Parameter] = {}
    for part in parts:
        offered |= parameters_of(part)
    for parameter_name, change in changes.items():
        old = offered[parameter_name]
        if isinstance(change, tuple):
            default, low, high = change
            offered[parameter_name] = replace(old, default=default, low=low, high=high)
        else:
            offered[parameter_name] = replace(old, default=change)
    for parameter_name in settled:
        offered.pop(parameter_name, None)
    return Kind(name, doc, MappingProxyType(offered), make, MappingProxyType(dict(settled)))


_ONE_PANEL: Mapping[str, Value] = {"panels_a_side": 1}
_JOINED: Mapping[str, Value] = {"panels_a_side": 1, "body_length": 0.0}
_PLAIN_HEM: Mapping[str, Value] = {"flare": 0.0, "hem_slant": 0.0}

KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        kind.name: kind
        for kind in (
            _kind(
                "one-panel-dress",
                "a dress whose front and back are one panel each",
                make_top,
                (BodiceDesign, NeckDesign, HemDesign, SleeveDesign, CutoutDesign),
                settled=_ONE_PANEL,
                body_length=(50.0, 32.0, 80.0),
                sleeves="none",
            ),
            _kind(
                "one-panel-jumpsuit",
                "a jumpsuit whose front and back are one panel each, trousers and all",
                make_jumpsuit,
                (BodiceDesign, NeckDesign, TrousersDesign, SleeveDesign),
                settled=_JOINED,
                sleeves="none",
            ),
            _kind(
                "top-skirt",
                "a top sewn to a skirt at the waist",
                make_top_skirt,
                (BodiceDesign, NeckDesign, SkirtDesign, SleeveDesign),
                settled={**_JOINED, "gores": 2},
                waist_shaping=(0.8, 0.3, 1.0),
                skirt_fullness=(1.0, 1.0, 1.5),
                sleeves="none",
            ),
            _kind(
                "top-pants",
                "a top sewn to trousers at the waist",
                make_top_pants,
                (BodiceDesign, NeckDesign, TrousersDesign, SleeveDesign),
                settled=_JOINED,
                waist_shaping=(0.8, 0.3, 1.0),
                sleeves="none",
            ),
            _kind(
                "shirt",
                "a shirt of one or two panels a side, with up to two darts in each half",
                make_shirt,
                (BodiceDesign, NeckDesign, DartDesign, SleeveDesign, CuffDesign),
                settled=_PLAIN_HEM,
                body_length=(10.0, 0.0, 22.0),
                waist_shaping=(0.3, 0.0, 1.0),
            ),
            _kind(
                "skirt",
                "a skirt of two, four, six or eight gores, flared or gathered",
                make_skirt,
                (SkirtDesign, WaistbandDesign),
            ),
            _kind(
                "pants",
                "trousers, straight or flared, from shorts to full length",
                make_pants,
                (TrousersDesign, WaistbandDesign),
            ),
            _kind(
                "tee",
                "a T-shirt",
                make_top,
                (BodiceDesign, NeckDesign, HemDesign, SleeveDesign),
                settled={**_ONE_PANEL, "sleeves": "set-in", "flare": 0.0},
                bust_ease=(12.0, 6.0, 28.0),
                waist_shaping=(0.1, 0.0, 0.6),
                sleeve_length=(0.42, 0.35, 0.7),
                sleeve_taper=(0.2, -0.2, 0.8),
                cap_height=(0.4, 0.25, 0.5),
                hem_slant=(0.0, -6.0, 6.0),
            ),
            _kind(
                "tank",
                "a sleeveless top with straps",
                make_top,
                (BodiceDesign, NeckDesign, HemDesign, CutoutDesign),
                settled={**_ONE_PANEL, "sleeves": "none"},
                shoulder_reach=(0.75, 0.65, 0.9),
                neck_width=(2.0, 1.0, 3.5),
                body_length=(16.0, 2.0, 26.0),
                flare=(0.0, 0.0, 0.3),
                hem_slant=(0.0, -6.0, 6.0),
            ),
            _kind(
                "jacket",
                "a jacket that is open in front",
                make_jacket,
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign),
                settled={**_PLAIN_HEM, "sleeves": "set-in"},
                bust_ease=(14.0, 8.0, 28.0),
                body_length=(22.0, 6.0, 45.0),
                armhole_ease=(3.0, 1.0, 6.0),
            ),
            _kind(
                "hoodie",
                "a top with a hood",
                make_hoodie,
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign, HoodDesign),
                settled={**_PLAIN_HEM, **_ONE_PANEL, "sleeves": "set-in", "neckline": "round"},
                bust_ease=(18.0, 10.0, 30.0),
                waist_shaping=(0.1, 0.0, 0.4),
                armhole_ease=(3.0, 1.0, 6.0),
                neck_width=(2.0, 1.0, 3.5),
                neck_depth=(10.0, 9.0, 13.0),
                back_neck_depth=(2.5, 2.0, 4.0),
            ),
        )
    }
)
