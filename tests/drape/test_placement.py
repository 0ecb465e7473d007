"""A garment is put where the body wears it, by its shape and not by its place in the file."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.body.body import load_body
from garmentimage.body.body_measurements import presets
from garmentimage.body.measure import measure
from garmentimage.draft.kind import draft_pattern, kinds
from garmentimage.drape.draping import drape_pattern
from garmentimage.drape.girths import chest_level, trunk_girth, waist_height
from garmentimage.drape.start.placement import BAND_ABOVE, CROTCH_ROOM, EASE, ON_HIPS, place_on_body
from garmentimage.drape.support import SupportSite
from garmentimage.errors import DraftError, DrapeError
from garmentimage.pattern.checks import check_pattern, symmetry_plane
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Pattern, euler_angles
from tests.corpus import corpus_sample
from tests.drape.garments import (
    circle_skirt,
    moved,
    sheared,
    strapless_dress,
    tube,
    unnamed,
    without,
    world,
)

DRAFT_TOL_CM = 1.0
"""How far a draft for a body may be lifted on that body."""
PLACE_TOL_CM = 1e-6


def placed_alike(pattern: Pattern, other: Pattern) -> bool:
    return np.allclose(world(pattern), world(other), atol=PLACE_TOL_CM)


@pytest.mark.parametrize("name", presets())
@pytest.mark.parametrize("kind", kinds())
def test_a_draft_for_the_body_keeps_its_height(kind, name):
    _, (report,) = place_on_body(draft_pattern(kind, name), load_body(name))
    assert abs(report.shift_up) < DRAFT_TOL_CM
    assert report.is_certain and report.scale == 1


@pytest.mark.parametrize("up", [-140.0, -30.0, -5.0, 5.0, 60.0])
@pytest.mark.parametrize("kind", kinds())
def test_the_origin_of_a_file_changes_nothing(kind, up):
    body, pattern = load_body("short-round-male"), draft_pattern(kind)
    placed, reports = place_on_body(pattern, body)
    again, moved_reports = place_on_body(moved(pattern, (0.0, up, 2 * up)), body)
    assert placed_alike(again, placed)
    assert [r.site for r in moved_reports] == [r.site for r in reports]


@given(
    st.floats(-200, 200),
    st.floats(-50, 50),
    st.sampled_from(["tee", "skirt", "pants", "one-panel-jumpsuit"]),
    st.sampled_from(sorted(presets())),
    st.sampled_from(sorted(presets())),
)
def test_no_origin_changes_where_a_garment_stands_on_any_body(up, forward, kind, made, worn):
    pattern, body = draft_pattern(kind, made), load_body(worn)
    placed, _ = place_on_body(pattern, body)
    again, _ = place_on_body(moved(pattern, (0.0, up, forward)), body)
    assert placed_alike(again, placed)


@pytest.mark.parametrize("left", [-60.0, -9.0, 35.0])
@pytest.mark.parametrize("kind", kinds())
def test_a_garment_beside_its_origin_is_worn_about_its_plane_of_symmetry(kind, left):
    body, pattern = load_body(), draft_pattern(kind)
    placed, (before, *_) = place_on_body(pattern, body)
    again, (report, *_) = place_on_body(moved(pattern, (left, 20.0, -15.0)), body)
    assert placed_alike(again, placed)
    assert before.shift_left == 0 and report.shift_left == pytest.approx(-left)


def test_a_garment_that_is_asymmetric_on_purpose_stays_where_it_is_drawn():
    tee = draft_pattern("tee")
    sleeveless = without(tee, "left_sleeve_front", "left_sleeve_back")
    assert symmetry_plane(sleeveless) in (0.0, None)
    _, reports = place_on_body(sleeveless, load_body())
    assert {r.shift_left for r in reports} == {0.0}


def test_a_garment_beside_its_wearer_without_a_plane_of_symmetry_is_refused():
    slanted = moved(sheared(draft_pattern("tee")), (60.0, 0.0, 0.0))
    assert [f.code for f in check_pattern(slanted)] == ["off-centre"]
    with pytest.raises(DrapeError, match=r"\d+ cm to the left of its wearer"):
        drape_pattern(slanted)


@pytest.mark.parametrize("kind", kinds())
def test_what_holds_a_draft_is_recognised_without_names(kind):
    body, pattern = load_body(), draft_pattern(kind)
    (named,), (without_names,) = (place_on_body(p, body)[1] for p in (pattern, unnamed(pattern)))
    assert without_names.site is named.site and without_names.is_certain


@pytest.mark.parametrize("angle", [-72.0, 60.0])
@pytest.mark.parametrize("kind", ["one-panel-dress", "tank", "top-skirt"])
def test_a_panel_that_stands_askew_does_not_change_what_holds_a_garment(kind, angle):
    """Once, a dress whose front lay nearly level in its file was worn at the waist."""
    sleeveless = {} if kind == "tank" else {"sleeves": "none"}
    body, pattern = load_body("mean-female"), draft_pattern(kind, **sleeveless)
    _, (straight,) = place_on_body(pattern, body)
    top = next(p for p in pattern.panels if not p.name.startswith("skirt") and p.translation[2] > 0)
    _, (askew,) = place_on_body(turned_about_x(pattern, top.name, angle), body)
    assert straight.site is askew.site is SupportSite.SHOULDERS
    assert askew.shift_up == pytest.approx(straight.shift_up, abs=DRAFT_TOL_CM)


def turned_about_x(pattern: Pattern, name: str, degrees: float) -> Pattern:
    """One panel turned about the level line through its middle."""
    angle = np.deg2rad(degrees)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    panels = []
    for panel in pattern.panels:
        if panel.name == name:
            middle = panel.to_world(panel.outline.polygon).mean(axis=0)
            x, y, z = (turn @ (np.array(panel.translation) - middle) + middle).tolist()
            rotation = euler_angles(turn @ panel.matrix)
            panel = replace(panel, rotation=rotation, translation=(x, y, z))
        panels.append(panel)
    return replace(pattern, panels=tuple(panels))


def test_every_garment_of_a_file_is_put_where_it_belongs_by_itself():
    body = load_body()
    tee, pants = draft_pattern("tee"), draft_pattern("pants")
    both = Pattern(
        (*tee.panels, *moved(pants, (0.0, 45.0, 0.0)).panels), (*tee.stitches, *pants.stitches)
    )
    placed, reports = place_on_body(both, body)
    assert {r.site for r in reports} == {SupportSite.SHOULDERS, SupportSite.WAIST}
    for pattern in (tee, pants):
        own = Pattern(tuple(placed.by_name[p.name] for p in pattern.panels))
        assert placed_alike(own, place_on_body(pattern, body)[0])


def test_standing_twice_is_standing_once():
    body = load_body("tall-slim-male")
    placed, _ = place_on_body(draft_pattern("top-skirt"), body)
    again, (report,) = place_on_body(placed, body)
    assert abs(report.shift_up) < 1e-9 and abs(report.shift_forward) < 1e-9
    assert placed_alike(again, placed)


@pytest.mark.parametrize("name", presets())
def test_a_top_comes_down_on_any_shoulders_from_above(name):
    body = load_body(name)
    placed, (report,) = place_on_body(draft_pattern("tee"), body)
    assert report.site is SupportSite.SHOULDERS
    assert 0.0 < world(placed)[:, 1].max() - body.landmarks["left_neck_point"][1] < 10.0


@pytest.mark.parametrize("name", presets())
def test_the_crotch_of_trousers_is_under_that_of_the_body(name):
    body = load_body(name)
    placed, (report,) = place_on_body(draft_pattern("pants"), body)
    assert report.site is SupportSite.WAIST
    front = placed.by_name["left_trouser_front"]
    points = front.to_world(front.outline.polygon)
    crotch = points[points[:, 0].argmin(), 1]
    assert crotch <= body.landmarks["crotch"][1] - CROTCH_ROOM + 1e-6


@pytest.mark.parametrize("length", [60.0, 74.0, 85.0, 95.0, 130.0, 200.0])
@pytest.mark.parametrize("name", presets())
def test_a_top_edge_holds_only_where_the_body_is_hardly_less_round(name, length):
    body = load_body(name)
    _, (report,) = place_on_body(tube(length), body)
    assert report.site is SupportSite.WAIST and report.length == pytest.approx(length)
    if report.is_supported:
        assert trunk_girth(body, report.level) >= length - EASE
    else:
        assert trunk_girth(body, body.landmarks["crotch"][1] + 1.0) < length - EASE + 2.0


def test_a_skirt_a_little_too_wide_for_the_waist_sits_on_the_hips():
    body = load_body()
    waist, crotch = waist_height(body), body.landmarks["crotch"][1]
    levels = [place_on_body(tube(length), body)[1][0].level for length in (74.0, 84.0, 90.0, 96.0)]
    assert levels[0] == pytest.approx(waist)
    assert levels == sorted(levels, reverse=True)
    assert levels[-2] > waist - ON_HIPS * (waist - crotch) - 3.0


@pytest.mark.parametrize("band", ["none", "band"])
def test_a_waistband_goes_up_from_the_waist(band):
    body = load_body()
    _, (report,) = place_on_body(draft_pattern("skirt", waistband=band), body)
    up = report.level - waist_height(body)
    assert 0 <= up <= BAND_ABOVE
    assert (up > 0) == (band == "band")


def test_an_edge_labelled_for_the_waist_is_drawn_together_as_by_an_elastic():
    body = load_body()
    gathered = draft_pattern("skirt", waistband="none", skirt_fullness=1.8)
    _, (report,) = place_on_body(gathered, body)
    assert report.is_supported and 0 < report.drawn_length < trunk_girth(body, waist_height(body))
    _, (plain,) = place_on_body(unnamed(gathered, labels=False), body)
    assert not plain.is_supported and plain.drawn_length == plain.length


@pytest.mark.parametrize("degrees", [60.0, 180.0, 270.0, 350.0])
def test_a_circle_skirt_belongs_to_the_waist_and_its_seams_are_no_shoulders(degrees):
    body = load_body()
    _, (report,) = place_on_body(circle_skirt(degrees, waist=76.0, length=55.0), body)
    assert report.site is SupportSite.WAIST and report.is_supported
    assert report.level == pytest.approx(waist_height(body))
    _, (short,) = place_on_body(circle_skirt(degrees, waist=76.0, length=18.0), body)
    assert short.site is SupportSite.WAIST


@pytest.mark.parametrize("name", presets())
@pytest.mark.parametrize("up", [-100.0, 0.0, 30.0])
def test_a_strapless_dress_is_held_over_the_bust_where_it_is_tight(name, up):
    body = load_body(name)
    body_girth = measure(body)
    dress = strapless_dress(body_girth.bust_girth + 2, body_girth.waist_girth + 4)
    _, (report,) = place_on_body(moved(dress, (0.0, up, 0.0)), body)
    assert report.site is SupportSite.CHEST and report.is_certain and report.is_supported
    assert report.level == pytest.approx(chest_level(body))
    wide = strapless_dress(2 * body_girth.bust_girth, 2 * body_girth.waist_girth)
    assert not place_on_body(wide, body)[1][0].is_supported


def test_an_uncertain_placement_is_reported_as_uncertain():
    body = load_body()
    _, (report,) = place_on_body(tube(95.0), body)
    assert not report.is_certain and "file" in report.reason


def test_front_and_back_get_the_body_between_them():
    body = load_body()
    for forward in (-20.0, 0.0, 20.0):
        placed, _ = place_on_body(moved(draft_pattern("tee"), (0.0, 0.0, forward)), body)
        front, back = (placed.by_name[name].translation[2] for name in ("front", "back"))
        trunk = body.vertices[np.abs(body.vertices[:, 0]) < 5]
        chest = trunk[(trunk[:, 1] > 110) & (trunk[:, 1] < 130), 2]
        assert back < chest.min() and chest.max() < front


def test_nothing_is_bent_and_nothing_moves_sideways():
    pattern = draft_pattern("hoodie")
    placed, (report,) = place_on_body(pattern, load_body("tall-slim-male"))
    for before, after in zip(pattern.panels, placed.panels, strict=True):
        assert after.outline == before.outline and after.rotation == before.rotation
        step = np.subtract(after.translation, before.translation)
        assert np.allclose(step, [0, report.shift_up, report.shift_forward])


def test_lengths_are_scaled_only_for_a_given_stature():
    body, pattern = load_body(), draft_pattern("tee")
    placed, (report,) = place_on_body(pattern, body, made_for=np.ptp(body.vertices[:, 1]) * 1.25)
    assert report.scale == pytest.approx(0.8)
    for before, after in zip(pattern.panels, placed.panels, strict=True):
        assert after.outline.area == pytest.approx(0.64 * before.outline.area)
        assert [c.length for c in after.curves] == pytest.approx(
            [0.8 * c.length for c in before.curves]
        )
    with pytest.raises(DraftError, match="stature"):
        place_on_body(pattern, body, made_for=17.0)


@pytest.mark.corpus
def test_patterns_by_others_are_held_where_they_are_worn():
    body = load_body()
    for path in corpus_sample(60):
        placed, (report, *_) = place_on_body(read_pattern(path)[0], body)
        low, high = world(placed)[:, 1].min(), world(placed)[:, 1].max()
        name = path.stem
        if "tee" in name or "jacket" in name or "jumpsuit" in name:
            assert report.site is not SupportSite.WAIST, name
        if name.startswith(("skirt", "pants", "wb_pants")):
            assert report.site is SupportSite.WAIST, name
            assert 90 < report.level < 111, name
        assert low < report.level + 1e-6 and high > 80, name
