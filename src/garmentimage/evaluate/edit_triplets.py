"""Edits with known results: triplets of garments, and the garment that the edit should give.

A and B are one design drafted without some part and with it, C is another design without it, and
the truth is C's design with that part: the part's own parameters are those of B, all others those
of C. So an edit C + (B - A) is right where it has the truth's topology, and its panels tell how
well the rest was kept.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from garmentimage.body import BodyMeasurements, measurements
from garmentimage.draft import KINDS, Value, sample
from garmentimage.errors import DraftError, PatternError
from garmentimage.pattern import Pattern

BODY = "mean-female"
SEED = 7_400_000
"""Of the designs; no dataset uses it."""


@dataclass(frozen=True)
class PartialDesign:
    """A kind of garment with some parameters fixed."""

    kind: str
    fixed: Mapping[str, Value]


@dataclass(frozen=True)
class Edit:
    """An edit C + (B - A), by the designs of its garments."""

    name: str
    before: PartialDesign
    after: PartialDesign
    on: PartialDesign
    truth: PartialDesign
    brought: tuple[str, ...] = ()
    """Parameters of the added part, which the truth takes from B."""
    unseen: bool = False
    """No garment in training has the topology of the truth."""


@dataclass(frozen=True)
class Triplet:
    """The garments of one edit."""

    edit: Edit
    number: int
    a: Pattern
    b: Pattern
    c: Pattern
    truth: Pattern


def _design(kind: str, sleeves: str | None = "none", **fixed: Value) -> PartialDesign:
    return PartialDesign(kind, ({} if sleeves is None else {"sleeves": sleeves}) | fixed)


DRESS, JUMPSUIT = _design("one-panel-dress", cutout="none"), _design("one-panel-jumpsuit")
TOP_PANTS, TOP_SKIRT = _design("top-pants"), _design("top-skirt")
SLEEVED_DRESS = _design("one-panel-dress", "set-in", cutout="none")
SLEEVED_PANTS, SLEEVED_SKIRT = _design("top-pants", "set-in"), _design("top-skirt", "set-in")


def _shirt(panels: int, darts: str) -> PartialDesign:
    return _design(
        "shirt", None, panels_a_side=panels, front_darts=darts, back_darts=darts, cuffs="none"
    )


SLEEVE = ("sleeve_length", "cap_height", "cap_fullness", "sleeve_taper")
DART = ("dart_place", "dart_width", "dart_reach")

EDITS: Mapping[str, tuple[Edit, ...]] = {
    "vae-topology": (
        Edit("legs", DRESS, JUMPSUIT, DRESS, JUMPSUIT),
        Edit("waist seam on jumpsuits", JUMPSUIT, TOP_PANTS, JUMPSUIT, TOP_PANTS),
        Edit("waist seam on dresses", JUMPSUIT, TOP_PANTS, DRESS, TOP_SKIRT, unseen=True),
    ),
    "vae-variety": (
        Edit("sleeves on dresses", TOP_PANTS, SLEEVED_PANTS, DRESS, SLEEVED_DRESS, SLEEVE),
        Edit("sleeves on tops + skirts", DRESS, SLEEVED_DRESS, TOP_SKIRT, SLEEVED_SKIRT, SLEEVE),
        Edit("waist seam on dresses", JUMPSUIT, TOP_PANTS, DRESS, TOP_SKIRT),
        Edit("skirt to trousers", TOP_SKIRT, TOP_PANTS, SLEEVED_SKIRT, SLEEVED_PANTS),
    ),
    "vae-darts": (
        Edit("darts on two panels", _shirt(2, "none"), _shirt(2, "waist"), _shirt(2, "none"),
             _shirt(2, "waist"), DART),
        Edit("two panels of one", _shirt(1, "none"), _shirt(2, "none"), _shirt(1, "none"),
             _shirt(2, "none")),
        Edit("darts on one panel", _shirt(2, "none"), _shirt(2, "waist"), _shirt(1, "none"),
             _shirt(1, "waist"), DART, unseen=True),
    ),
}  # fmt: skip
"""By recipe."""


def sample_triplets(edit: Edit, count: int, seed: int = SEED) -> Iterator[Triplet]:
    """Triplets of random designs, held out of every dataset by their seed.

    Designs that cannot be drafted as one of the kinds are skipped, so numbers may have gaps.
    """
    body = measurements(BODY)
    found, number = 0, 0
    while found < count:
        one = _sample_parameters(edit.before, seed, number)
        two = _sample_parameters(edit.on, seed + 1, number)
        number += 1
        brought = {name: one[name] for name in edit.brought}
        try:
            made = [
                draft_as(one, edit.before, edit.before, body),
                draft_as(one, edit.before, edit.after, body),
                draft_as(two, edit.on, edit.on, body),
                draft_as(two | brought, edit.on, edit.truth, body),
            ]
        except (DraftError, PatternError):
            continue
        found += 1
        yield Triplet(edit, number - 1, *made)


def draft_as(
    design: Mapping[str, Any], of: PartialDesign, to: PartialDesign, body: BodyMeasurements
) -> Pattern:
    """Draft a design of one kind as another: common parameters are clipped to range."""
    known = dict(design) | _below_waist(design, of.kind, to.kind, body)
    values = {
        name: known[name] if p.options else float(np.clip(known[name], p.low, p.high))
        for name, p in KINDS[to.kind].parameters.items()
        if name in known
    }
    return KINDS[to.kind].draft(body, values | dict(to.fixed))


def _below_waist(
    design: Mapping[str, Any], of: str, to: str, body: BodyMeasurements
) -> dict[str, Any]:
    """Parameters of a skirt or of legs that are as long as a dress or skirt is below the waist."""
    if of == to:
        return {}
    if of == "one-panel-dress":
        drop = design["body_length"]
        skirt = {"skirt_flare": design["flare"], "skirt_slant": design["hem_slant"]}
    elif of == "top-skirt":
        drop, skirt = design["skirt_length"] * body.waist_height, {}
    else:
        return {}
    if to == "top-skirt":
        return {"skirt_length": drop / body.waist_height, "skirt_fullness": 1.0} | skirt
    inside = drop - (body.waist_height - body.crotch_height)
    return {"leg_length": inside / (body.crotch_height - body.ankle_height)}


def _sample_parameters(made: PartialDesign, seed: int, number: int) -> dict[str, Any]:
    drawn = sample(made.kind, 1, seed, body=BODY, fixed=made.fixed, first=number)
    return dict(next(drawn).parameters)
