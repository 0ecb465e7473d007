"""Laws of drafted garments, over random designs of every kind on every shipped body."""

import hashlib
import json
from collections import Counter
from dataclasses import fields, replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings

from garmentimage.body.body_measurements import measurements, presets
from garmentimage.compare.comparison import compare_patterns
from garmentimage.compare.validation import pattern_faults
from garmentimage.draft.garments import MAKERS
from garmentimage.draft.kind import DEFAULT_BODY, KINDS, PARTS, draft_pattern
from garmentimage.draft.panel import FACINGS
from garmentimage.draft.parameters import parameters_of
from garmentimage.errors import DraftError
from garmentimage.pattern.checks.sewable import check_pattern
from garmentimage.pattern.files.spec import load_pattern, pattern_to_spec, save_pattern
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode
from tests.draft.designs import BODIES, EVEN, FLAT, designs, values_at

SEAM_TOL = 0.02
"""Sewn lengths agree within this [cm]."""
WEARABLE_SHARE = 0.95
DRAWS = 60

ROUNDED = 4
"""Decimals of a coordinate that are the same on every machine."""
GOLDEN = {
    "one-panel-dress": "cc41733b4ea871bc",
    "one-panel-jumpsuit": "251d7adbb68426f3",
    "top-skirt": "ed51e09680180580",
    "top-pants": "e2fca1e5bb257311",
    "shirt": "9b6d58bb402d9974",
    "skirt": "993717af42509240",
    "pants": "ab7429403dd475b2",
    "tee": "48fa0e055e696b24",
    "tank": "d907350c88571279",
    "jacket": "2da0241830bc37a9",
    "hoodie": "2d858336e84f661a",
    "blazer": "10240c12d58e6579",
    "coat": "33d444c7e92df828",
    "vest": "f9c65c51f0266370",
    "blouse": "ccef7417dd0f8632",
    "cargo-pants": "97bb7636c291f90b",
    "pocket-skirt": "0508583ea713d688",
    "peplum-top": "d6e16e61a31d55b3",
    "pleated-skirt": "ab26533f73100d52",
    "button-shirt": "35e87514c6c645c8",
    "polo-shirt": "556952712dcadf51",
    "turtleneck": "31640c46f51255f3",
}


def drafted(design):
    kind, body, values = design
    try:
        return draft_pattern(kind, body, **values)
    except DraftError:
        assume(False)


def polygon(panel):
    return shapely.Polygon(panel.to_world(panel.outline.polygon)[:, :2])


def gathers(values):
    return {1.0} | {values[name] for name in FLAT if name in values}


@given(designs())
@settings(max_examples=60)
def test_a_draft_can_be_cut_and_sewn(design):
    pattern = drafted(design)
    check_pattern(pattern)
    assert pattern_faults(pattern) == []


@given(designs())
@settings(max_examples=60)
def test_outlines_run_counter_clockwise_and_holes_clockwise(design):
    for panel in drafted(design).panels:
        assert panel.outline.area > 0
        assert all(hole.area < 0 for hole in panel.holes)


@given(designs(**FLAT))
@settings(max_examples=60)
def test_sewn_lengths_match_where_nothing_is_gathered(design):
    pattern = drafted(design)
    for stitch in pattern.stitches:
        a, b = (pattern.curve(side).length for side in stitch.sides)
        assert abs(a - b) < SEAM_TOL, (stitch, a, b)


@given(designs())
@settings(max_examples=60)
def test_only_caps_cuffs_and_waists_are_gathered_and_as_much_as_asked(design):
    pattern = drafted(design)
    for stitch in pattern.stitches:
        a, b = (pattern.curve(side).length for side in stitch.sides)
        near = min(abs(a - fullness * b) for fullness in gathers(design[2]))
        assert near < SEAM_TOL
        if abs(a - b) > SEAM_TOL:
            panel = pattern.by_name[stitch.a.panel]
            assert panel.edges[stitch.a.edge].label in ("cap", "wrist", "waist")


@given(designs(**EVEN))
@settings(max_examples=60)
def test_left_and_right_are_mirror_images(design):
    swapped = {"left": "right", "right": "left"}
    panels = {p.name: p for p in drafted(design).panels}
    for name, panel in panels.items():
        twin = panels["_".join(swapped.get(word, word) for word in name.split("_"))]
        own, other = (p.to_world(np.array(p.outline.vertices)) for p in (panel, twin))
        mirrored = other * [-1, 1, 1]
        gap = np.abs(own[:, None] - mirrored[None]).max(axis=2).min(axis=1)
        assert gap.max() < 1e-6


@given(designs())
@settings(max_examples=60)
def test_panels_of_a_layer_do_not_lie_on_each_other(design):
    panels = [p for p in drafted(design).panels if "hood" not in p.name]
    for a, b in combinations(panels, 2):
        if a.cloth_layer == b.cloth_layer and (a.translation[2] > 0) == (b.translation[2] > 0):
            assert polygon(a).intersection(polygon(b)).area < 1e-6, (a.name, b.name)


@given(designs())
@settings(max_examples=30)
def test_every_edge_has_a_name_and_every_panel_a_grain_line(design):
    for panel in drafted(design).panels:
        assert all(edge.label for edge in panel.outline.edges)
        assert panel.grain is not None
        assert panel.label in ("body", "arm", "leg")


@given(designs())
@settings(max_examples=30)
def test_legs_of_a_dart_are_equally_long(design):
    pattern = drafted(design)
    darts = [s for s in pattern.stitches if s.a.panel == s.b.panel]
    for dart in darts:
        a, b = (pattern.curve(side).length for side in dart.sides)
        assert abs(a - b) < 1e-9


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_low_middle_and_high_designs_can_be_drafted(kind, share):
    pattern = draft_pattern(kind, **values_at(KINDS[kind].parameters, share))
    assert pattern.stitches and all(panel.outline.area > 1 for panel in pattern.panels)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("body", BODIES)
def test_defaults_fit_every_shipped_body(kind, body):
    assert draft_pattern(kind, body).panels


@pytest.mark.parametrize("kind", KINDS)
def test_nearly_all_random_designs_can_be_worn(kind):
    random = np.random.default_rng(5)
    refused = 0
    for _ in range(DRAWS):
        values = {
            name: p.options[random.integers(len(p.options))]
            if p.options
            else random.uniform(p.low, p.high)
            for name, p in KINDS[kind].parameters.items()
        }
        try:
            draft_pattern(kind, **values)
        except DraftError:
            refused += 1
    assert refused <= (1 - WEARABLE_SHARE) * DRAWS


@pytest.mark.parametrize("kind", KINDS)
def test_larger_measurements_give_larger_panels(kind):
    body = measurements(DEFAULT_BODY)
    larger = replace(body, **{f.name: 1.05 * getattr(body, f.name) for f in fields(body)})
    small, large = draft_pattern(kind, body), draft_pattern(kind, larger)
    assert [p.name for p in small.panels] == [p.name for p in large.panels]
    for a, b in zip(small.panels, large.panels, strict=True):
        assert b.outline.area > a.outline.area or "pocket" in a.name


def test_every_kind_has_what_draws_it():
    assert MAKERS.keys() == KINDS.keys()


def test_each_girth_widens_what_covers_it():
    body = measurements(DEFAULT_BODY)

    def width(kind, panel, **changes):
        pattern = (
            draft_pattern(kind, replace(body, **changes), hip_ease=6.0)
            if kind == "pants"
            else (draft_pattern(kind, replace(body, **changes)))
        )
        return np.ptp(pattern.by_name[panel].outline.polygon[:, 0])

    assert width("tee", "front", bust_girth=100.0) > width("tee", "front")
    assert width("skirt", "skirt_front", hip_girth=110.0) > width("skirt", "skirt_front")
    assert width("pants", "waistband_front", waist_girth=80.0) > width("pants", "waistband_front")


def test_longer_parameters_give_longer_panels():
    def height(kind, panel, **values):
        return np.ptp(draft_pattern(kind, **values).by_name[panel].outline.polygon[:, 1])

    assert height("skirt", "skirt_front", skirt_length=0.8) > height("skirt", "skirt_front")
    assert height("pants", "left_trouser_front", leg_length=0.3) < 0.6 * height(
        "pants", "left_trouser_front"
    )
    assert height("tee", "front", body_length=28) > height("tee", "front", body_length=5) + 20


def fingerprint(kind):
    """A hash of what is drafted, coordinates rounded."""

    def rounded(value):
        if isinstance(value, float):
            return round(value, ROUNDED) + 0.0
        if isinstance(value, dict):
            return {k: rounded(v) for k, v in value.items()}
        return [rounded(v) for v in value] if isinstance(value, (list, tuple)) else value

    text = json.dumps(rounded(pattern_to_spec(draft_pattern(kind))), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_design_is_the_same_pattern_for_ever(kind):
    assert fingerprint(kind) == GOLDEN[kind]


@given(designs())
@settings(max_examples=20)
def test_drafting_twice_gives_the_same_pattern(design):
    assert drafted(design) == drafted(design)


def test_a_draft_survives_its_file(tmp_path):
    pattern = draft_pattern("tank", cutout="front")
    save_pattern(pattern, tmp_path / "tank.json")
    again = load_pattern(tmp_path / "tank.json")
    assert [p.name for p in again.panels] == [p.name for p in pattern.panels]
    assert again.panels[0].edges == pattern.panels[0].edges
    assert len(again.by_name["front"].holes) == 1


@pytest.mark.parametrize("kind", KINDS)
def test_defaults_come_back_from_the_raster(kind):
    pattern = draft_pattern(kind)
    result = compare_patterns(pattern, decode(encode(pattern, grid=16)))
    assert result.success, result.reasons
    # Small panels over others have few cells of their own.
    outer = {panel.name for panel in pattern.panels if panel.cloth_layer}
    assert all(iou > (0.94 if name in outer else 0.97) for name, iou in result.iou.items())


@pytest.mark.slow
@given(designs(bodies=(DEFAULT_BODY,)))
@settings(max_examples=40)
def test_random_designs_come_back_from_the_raster(design):
    pattern = drafted(design)
    result = compare_patterns(pattern, decode(encode(pattern, grid=32)))
    assert result.success, result.reasons


def test_parameters_have_one_meaning_each():
    """Names are unique over all parts, since a garment has one list of parameters."""
    names = [name for part in PARTS.values() for name in parameters_of(part)]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("kind", KINDS)
def test_parameters_are_documented_and_defaults_are_allowed(kind):
    assert KINDS[kind].doc
    for parameter in KINDS[kind].parameters.values():
        assert parameter.doc
        assert parameter.checked(parameter.default) == parameter.default
        assert parameter.options or parameter.low < parameter.high


@pytest.mark.parametrize("gores", [2, 4, 6, 8])
def test_a_skirt_has_as_many_gores_as_asked(gores):
    pattern = draft_pattern("skirt", gores=gores, waistband="none")
    assert len(pattern.panels) == gores


def test_a_waistband_gathers_a_full_skirt():
    pattern = draft_pattern("skirt", skirt_fullness=1.8)
    top = sum(p.curves[k].length for p, k in sides_labelled(pattern, "waist"))
    band = sum(p.curves[k].length for p, k in sides_labelled(pattern, "band_lower"))
    assert top == pytest.approx(1.8 * band)


def sides_labelled(pattern, label):
    return [(p, k) for p in pattern.panels for k, e in enumerate(p.edges) if e.label == label]


def test_sleeves_and_cuffs_are_panels_of_their_own():
    bare = {p.name for p in draft_pattern("shirt", sleeves="none").panels}
    cuffed = {p.name for p in draft_pattern("shirt", cuffs="band").panels}
    assert cuffed - bare == {
        f"{side}_{what}_{facing}"
        for side in ("left", "right")
        for what in ("sleeve", "cuff")
        for facing in ("front", "back")
    }


def folded_edges(pattern):
    """Labels of the edges that are sewn right side to wrong side, with how often each occurs."""
    sides = [s for stitch in pattern.stitches if stitch.same_direction for s in stitch.sides]
    return Counter(pattern.by_name[side.panel].edges[side.edge].label for side in sides)


@pytest.mark.parametrize(("kind", "falls"), [("button-shirt", 3), ("turtleneck", 2)])
def test_a_fall_is_folded_over_its_stand_and_longer_at_its_edge(kind, falls):
    pattern = draft_pattern(kind, cuffs="none")
    assert folded_edges(pattern) == {"fall_seam": 4, "collar_edge": 4}
    found = [panel for panel in pattern.panels if "fall" in panel.name]
    assert len(found) == falls and all(panel.cloth_layer == 1 for panel in found)

    def length(label):
        own = zip(back.edges, back.curves, strict=True)
        return sum(curve.length for edge, curve in own if edge.label == label)

    back = pattern.by_name["fall_back"]
    assert length("collar_edge") > length("fall_seam") + 1.0


@given(designs(("button-shirt", "polo-shirt", "turtleneck"), cuffs="turned-up"))
@settings(max_examples=30)
def test_a_turned_up_cuff_is_wider_than_the_sleeve_beneath_it(design):
    pattern = drafted(design)
    cuff, sleeve = (pattern.by_name[f"left_{what}_front"] for what in ("cuff", "sleeve"))
    assert folded_edges(pattern)["cuff_fold"] == folded_edges(pattern)["wrist"] == 4
    ring, cloth = polygon(cuff), polygon(sleeve)
    assert cuff.cloth_layer == 1 and ring.area > ring.intersection(cloth).area
    inside = sleeve.to_world(sleeve.outline.polygon)[:, 0].max() - design[2]["cuff_depth"] + 0.1
    at = shapely.LineString([(inside, 0.0), (inside, 300.0)])
    assert ring.intersection(at).length >= cloth.intersection(at).length


def test_a_cuff_is_not_turned_up_into_the_armhole():
    short = {"sleeve_length": 0.4, "cap_height": 0.42, "armhole_ease": 4.0, "cuff_depth": 7.0}
    assert draft_pattern("turtleneck", "short-round-female", **short).panels
    with pytest.raises(
        DraftError, match=r"turned up by 7.0 cm, but the sleeve is [78][.][0-9] cm long"
    ):
        draft_pattern("turtleneck", "short-round-female", cuffs="turned-up", **short)


@pytest.mark.parametrize(
    ("darts", "count"),
    [("none", 0), ("waist", 1), ("side", 1), ("waist-and-side", 2), ("two-waist", 2)],
)
def test_a_shirt_has_as_many_darts_as_asked(darts, count):
    pattern = draft_pattern("shirt", front_darts=darts)
    assert sum(s.a.panel == s.b.panel for s in pattern.stitches) == 2 * count


def test_a_side_dart_makes_the_front_longer_by_its_width():
    plain, darted = (
        draft_pattern("shirt", front_darts=darts, side_dart_width=3.0).by_name["front"]
        for darts in ("none", "side")
    )
    low = [p.outline.polygon[:, 1].min() for p in (plain, darted)]
    assert low[0] - low[1] == pytest.approx(3.0)


def test_two_panels_a_side_meet_in_a_centre_seam():
    pattern = draft_pattern("shirt", panels_a_side=2, sleeves="none", front_darts="none")
    assert {p.name for p in pattern.panels} == {
        "left_front",
        "right_front",
        "left_back",
        "right_back",
    }
    labels = [pattern.by_name[s.a.panel].edges[s.a.edge].label for s in pattern.stitches]
    assert labels.count("cf") == 1
    assert labels.count("cb") == 1


def test_a_jacket_is_open_in_front():
    pattern = draft_pattern("jacket")
    sewn = {side for s in pattern.stitches for side in s.sides}
    for name in ("left_front", "right_front"):
        panel = pattern.by_name[name]
        (cf,) = [k for k, e in enumerate(panel.edges) if e.label == "cf"]
        assert not any(side.panel == name and side.edge == cf for side in sewn)


def test_the_back_of_trousers_reaches_farther_between_the_legs():
    pattern = draft_pattern("pants")
    reach = {f: -pattern.by_name[f"left_trouser_{f}"].outline.polygon[:, 0].min() for f in FACINGS}
    reach["back"] = pattern.by_name["left_trouser_back"].outline.polygon[:, 0].max()
    assert reach["back"] == pytest.approx(2 * reach["front"])


def test_every_preset_can_be_named():
    for name in presets():
        assert draft_pattern("tank", name) == draft_pattern("tank", measurements(name))
