"""The kinds of garments: what can be chosen about each, and from which measurements.

What draws them is loaded only when a garment is drafted, so that lists of parameters are quick.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from garmentimage.body import BodyMeasurements, measurements
from garmentimage.draft.designs import (
    BodiceDesign,
    CollarDesign,
    CuffDesign,
    CutoutDesign,
    DartDesign,
    Design,
    HemDesign,
    HoodDesign,
    NeckDesign,
    PeplumDesign,
    PleatDesign,
    PocketDesign,
    SkirtDesign,
    SleeveDesign,
    TrousersDesign,
    WaistbandDesign,
)
from garmentimage.draft.parameters import Parameter, Value, checked_values, parameters_of
from garmentimage.errors import DraftError, check_type, quoted
from garmentimage.system import did_you_mean

if TYPE_CHECKING:
    from garmentimage.pattern import Pattern

DEFAULT_BODY = "mean-female"
PARTS: Mapping[str, Any] = MappingProxyType({f.name: f.type for f in fields(Design)})
"""The design class of each part."""


@dataclass(frozen=True)
class Kind:
    """A kind of garment: what can be chosen about it."""

    name: str
    doc: str
    parameters: Mapping[str, Parameter]
    settled: Mapping[str, Value]
    """Fields of the parts that this kind does not offer, where they differ from the default."""

    def draft(self, body: BodyMeasurements, given: Mapping[str, Any]) -> "Pattern":
        """The garment for a body; `given` are parameters by name.

        Raises:
            DraftError: a parameter is unknown or out of range, or the garment cannot be worn.
        """
        from garmentimage.draft.garments import draw_garment

        values = {**self.settled, **checked_values(self.parameters, given, f"kind {self.name}")}
        design = Design(
            **{
                part: design(**{f.name: values[f.name] for f in fields(design) if f.name in values})
                for part, design in PARTS.items()
            }
        )
        return draw_garment(self.name, body, design)


def draft_pattern(
    kind: str, body: str | BodyMeasurements = DEFAULT_BODY, **parameters: Value
) -> "Pattern":
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
    found = find_kind(kind)
    if isinstance(body, str):
        body = measurements(body)
    else:
        check_type(body, BodyMeasurements, "load_measurements(path) reads one, a name picks one")
        body.check()
    return found.draft(body, parameters)


def kinds() -> Mapping[str, Kind]:
    """Every kind of garment that can be drafted, by name."""
    return KINDS


def find_kind(name: str) -> Kind:
    """The kind of a name.

    Raises:
        DraftError: there is none.
    """
    if name not in KINDS:
        raise DraftError(f"there is no kind {quoted(name)}; {did_you_mean(name, KINDS)}")
    return KINDS[name]


def _kind(
    name: str,
    doc: str,
    parts: tuple[type, ...],
    *,
    settled: Mapping[str, Value] = MappingProxyType({}),
    **changes: Any,
) -> Kind:
    """A kind that offers all fields of `parts` but the settled ones.

    `changes` give a parameter another default (one value), another default, low and high, or of a
    choice some of its options, the default first.
    """
    offered = {
        parameter_name: parameter
        for part in parts
        for parameter_name, parameter in parameters_of(part).items()
        if parameter_name not in settled
    }
    for parameter_name, change in changes.items():
        values = change if isinstance(change, tuple) else (change,)
        before = offered[parameter_name]
        changed: dict[str, Any] = dict(zip(("default", "low", "high"), values, strict=False))
        if before.options and len(values) > 1:
            changed = {
                "default": values[0],
                "options": tuple(each for each in before.options if each in values),
            }
        offered[parameter_name] = replace(before, **changed)
    return Kind(name, doc, MappingProxyType(offered), MappingProxyType(dict(settled)))


_ONE_PANEL: Mapping[str, Value] = {"panels_a_side": 1}
_JOINED: Mapping[str, Value] = {"panels_a_side": 1, "body_length": 0.0}
_PLAIN_HEM: Mapping[str, Value] = {"flare": 0.0, "hem_slant": 0.0}
_BANDS = ("none", "band")
_NO_FALL: Mapping[str, Value] = {"fall_reach": 2.0, "collar_point": 7.5, "turtle_height": 9.0}
_ROUND_COLLAR: Mapping[str, Value] = {
    "panels_a_side": 1,
    "sleeves": "set-in",
    "neckline": "round",
    "lapel_width": 7.0,
    "lapel_shape": "notched",
}
_LAPELS: Mapping[str, Value] = {**_NO_FALL, "neckline": "v", "collar": "lapels"}

KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        kind.name: kind
        for kind in (
            _kind(
                "one-panel-dress",
                "a dress whose front and back are one panel each",
                (BodiceDesign, NeckDesign, HemDesign, SleeveDesign, CutoutDesign),
                settled=_ONE_PANEL,
                body_length=(50.0, 32.0, 80.0),
                sleeves="none",
            ),
            _kind(
                "one-panel-jumpsuit",
                "a jumpsuit whose front and back are one panel each, trousers and all",
                (BodiceDesign, NeckDesign, TrousersDesign, SleeveDesign),
                settled=_JOINED,
                sleeves="none",
            ),
            _kind(
                "top-skirt",
                "a top sewn to a skirt at the waist",
                (BodiceDesign, NeckDesign, SkirtDesign, SleeveDesign),
                settled={**_JOINED, "gores": 2},
                waist_shaping=(0.8, 0.3, 1.0),
                skirt_fullness=(1.0, 1.0, 1.5),
                sleeves="none",
            ),
            _kind(
                "top-pants",
                "a top sewn to trousers at the waist",
                (BodiceDesign, NeckDesign, TrousersDesign, SleeveDesign),
                settled=_JOINED,
                waist_shaping=(0.8, 0.3, 1.0),
                sleeves="none",
            ),
            _kind(
                "shirt",
                "a shirt of one or two panels a side, with up to two darts in each half",
                (BodiceDesign, NeckDesign, DartDesign, SleeveDesign, CuffDesign),
                settled=_PLAIN_HEM,
                body_length=(10.0, 0.0, 22.0),
                waist_shaping=(0.3, 0.0, 1.0),
                cuffs=_BANDS,
            ),
            _kind(
                "skirt",
                "a skirt of two, four, six or eight gores, flared or gathered",
                (SkirtDesign, WaistbandDesign),
            ),
            _kind(
                "pants",
                "trousers, straight or flared, from shorts to full length",
                (TrousersDesign, WaistbandDesign),
            ),
            _kind(
                "tee",
                "a T-shirt",
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
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign),
                settled={**_PLAIN_HEM, "sleeves": "set-in"},
                bust_ease=(14.0, 8.0, 28.0),
                body_length=(22.0, 6.0, 45.0),
                armhole_ease=(3.0, 1.0, 6.0),
                cuffs=_BANDS,
            ),
            _kind(
                "hoodie",
                "a top with a hood",
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign, HoodDesign),
                settled={**_PLAIN_HEM, **_ONE_PANEL, "sleeves": "set-in", "neckline": "round"},
                bust_ease=(18.0, 10.0, 30.0),
                waist_shaping=(0.1, 0.0, 0.4),
                armhole_ease=(3.0, 1.0, 6.0),
                neck_width=(2.0, 1.0, 3.5),
                neck_depth=(10.0, 9.0, 13.0),
                back_neck_depth=(2.5, 2.0, 4.0),
                cuffs=_BANDS,
            ),
            _kind(
                "blazer",
                "a jacket with lapels and patch pockets",
                (BodiceDesign, NeckDesign, SleeveDesign, CollarDesign, PocketDesign),
                settled={**_PLAIN_HEM, **_LAPELS, "sleeves": "set-in"},
                bust_ease=(14.0, 8.0, 24.0),
                body_length=(26.0, 20.0, 36.0),
                armhole_ease=(3.0, 1.0, 6.0),
                neck_depth=(28.0, 22.0, 34.0),
            ),
            _kind(
                "coat",
                "a long open coat with lapels and patch pockets",
                (BodiceDesign, NeckDesign, HemDesign, SleeveDesign, CollarDesign, PocketDesign),
                settled={**_LAPELS, "sleeves": "set-in", "hem_slant": 0.0},
                bust_ease=(18.0, 12.0, 28.0),
                body_length=(55.0, 40.0, 72.0),
                flare=(0.08, 0.0, 0.2),
                waist_shaping=(0.2, 0.0, 0.6),
                armhole_ease=(4.0, 2.0, 6.0),
                neck_depth=(26.0, 20.0, 34.0),
            ),
            _kind(
                "vest",
                "a sleeveless jacket with lapels or without, and patch pockets",
                (BodiceDesign, NeckDesign, CollarDesign, PocketDesign),
                settled={
                    **_PLAIN_HEM,
                    **_NO_FALL,
                    "sleeves": "none",
                    "neckline": "v",
                    "collar_height": 4.0,
                    "lapel_shape": "shawl",
                },
                collar=("lapels", "none", "stand"),
                bust_ease=(12.0, 8.0, 20.0),
                body_length=(22.0, 18.0, 30.0),
                shoulder_reach=(0.95, 0.9, 1.0),
                neck_depth=(26.0, 20.0, 32.0),
                pocket_height=(12.0, 10.0, 13.0),
            ),
            _kind(
                "blouse",
                "a blouse with a stand-up collar and pockets on the chest",
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign, CollarDesign, PocketDesign),
                settled={**_PLAIN_HEM, **_NO_FALL, **_ROUND_COLLAR, "collar": "stand"},
                bust_ease=(12.0, 6.0, 20.0),
                body_length=(12.0, 2.0, 22.0),
                neck_width=(2.5, 1.5, 3.5),
                neck_depth=(10.0, 9.0, 12.0),
                back_neck_depth=(2.5, 2.0, 3.0),
                collar_height=(3.0, 2.5, 4.0),
                cuffs=_BANDS,
                pocket_width=(10.0, 8.0, 11.0),
                pocket_height=(11.0, 9.0, 12.0),
            ),
            _kind(
                "cargo-pants",
                "trousers with patch pockets on the thighs",
                (TrousersDesign, WaistbandDesign, PocketDesign),
                leg_length=(1.0, 0.5, 1.05),
                hip_ease=(8.0, 5.0, 16.0),
                knee_ease=(12.0, 8.0, 18.0),
                pocket_width=(11.0, 9.0, 12.0),
                pocket_height=(15.0, 12.0, 18.0),
            ),
            _kind(
                "pocket-skirt",
                "a skirt with patch pockets in front",
                (SkirtDesign, WaistbandDesign, PocketDesign),
                settled={"gores": 2, "skirt_fullness": 1.0},
            ),
            _kind(
                "peplum-top",
                "a top with a short skirt sewn over it at the waist",
                (BodiceDesign, NeckDesign, SleeveDesign, PeplumDesign),
                settled={**_PLAIN_HEM, **_ONE_PANEL},
                body_length=(10.0, 6.0, 18.0),
                waist_shaping=(0.5, 0.0, 0.9),
            ),
            _kind(
                "pleated-skirt",
                "a skirt with knife, box or inverted pleats pressed from the waist down",
                (SkirtDesign, WaistbandDesign, PleatDesign),
                settled={"gores": 2, "skirt_fullness": 1.0, "skirt_slant": 0.0},
                skirt_flare=(0.05, 0.0, 0.2),
            ),
            _kind(
                "button-shirt",
                "an open shirt with a stand or a shirt collar, and pockets on the chest",
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign, CollarDesign, PocketDesign),
                settled={**_PLAIN_HEM, **_ROUND_COLLAR, "turtle_height": 9.0},
                bust_ease=(14.0, 8.0, 22.0),
                waist_shaping=(0.2, 0.0, 0.7),
                body_length=(22.0, 12.0, 28.0),
                shoulder_reach=(0.92, 0.85, 0.97),
                neck_width=(0.8, 0.5, 1.2),
                neck_depth=(8.0, 7.0, 9.5),
                back_neck_depth=(2.0, 1.5, 3.0),
                cap_fullness=(1.0, 1.0, 1.1),
                sleeve_length=(0.85, 0.4, 0.95),
                sleeve_taper=(0.85, 0.75, 1.0),
                cap_height=(0.36, 0.3, 0.42),
                cuff_depth=(6.0, 4.0, 7.0),
                collar=("shirt", "stand"),
                collar_height=(3.0, 2.5, 3.5),
                fall_reach=(2.0, 1.5, 3.0),
                cuffs="band",
                pocket_width=(10.5, 9.0, 11.5),
                pocket_height=(12.0, 10.0, 13.0),
            ),
            _kind(
                "polo-shirt",
                "a closed shirt with a shirt collar",
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign, CollarDesign, PocketDesign),
                settled={
                    **_PLAIN_HEM,
                    **_ROUND_COLLAR,
                    "collar": "shirt",
                    "turtle_height": 9.0,
                },
                bust_ease=(12.0, 8.0, 20.0),
                shoulder_reach=(0.9, 0.85, 0.95),
                waist_shaping=(0.1, 0.0, 0.6),
                body_length=(18.0, 8.0, 26.0),
                neck_width=(2.0, 1.5, 2.6),
                neck_depth=(9.5, 9.0, 10.5),
                back_neck_depth=(1.8, 1.5, 2.0),
                sleeve_length=(0.45, 0.4, 0.7),
                sleeve_taper=(0.2, 0.0, 0.8),
                cap_height=(0.36, 0.3, 0.42),
                cap_fullness=(1.0, 1.0, 1.1),
                collar_height=(2.6, 2.5, 2.8),
                cuff_depth=(4.0, 3.0, 5.0),
                pockets="left",
                pocket_width=(10.0, 8.0, 11.0),
                pocket_height=(11.0, 9.0, 12.0),
            ),
            _kind(
                "turtleneck",
                "a top with a turtle neck",
                (BodiceDesign, NeckDesign, SleeveDesign, CuffDesign, CollarDesign),
                settled={
                    **_PLAIN_HEM,
                    **_ROUND_COLLAR,
                    "collar": "turtle",
                    "collar_height": 4.0,
                    "fall_reach": 2.0,
                    "collar_point": 7.5,
                    "pockets": "none",
                },
                bust_ease=(14.0, 10.0, 20.0),
                shoulder_reach=(0.9, 0.85, 0.95),
                armhole_ease=(2.0, 1.0, 4.0),
                waist_shaping=(0.2, 0.0, 0.8),
                body_length=(16.0, 4.0, 26.0),
                neck_width=(1.9, 1.5, 2.2),
                neck_depth=(10.0, 9.5, 10.5),
                back_neck_depth=(1.8, 1.5, 2.0),
                cap_fullness=(1.0, 1.0, 1.1),
                cap_height=(0.36, 0.3, 0.42),
                turtle_height=(6.5, 6.0, 7.0),
                sleeve_length=(0.85, 0.4, 0.95),
                sleeve_taper=(0.85, 0.75, 1.0),
                cuff_depth=(6.0, 4.0, 7.0),
            ),
        )
    }
)
