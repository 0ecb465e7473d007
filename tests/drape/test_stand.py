"""Patterns are put where the wearer stands, in either world, by the least that does it."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.body.body import load_body
from garmentimage.body.measurements import presets
from garmentimage.draft.kinds import draft, kinds
from garmentimage.drape.stand import CROTCH_ROOM, DRAWN_ABOVE, TOUCH, Held, standing
from garmentimage.errors import DraftError
from garmentimage.pattern.spec import load_pattern
from garmentimage.raster.place import PELVIS_HEIGHT
from tests.corpus import corpus_sample

DRAFT_TOL_CM = 0.5
"""How far a draft for a body may be lifted on that body."""
PLACE_TOL_CM = 3.0


def moved(pattern, up=0.0, forward=0.0):
    return replace(
        pattern,
        panels=tuple(
            replace(
                p, translation=(p.translation[0], p.translation[1] + up, p.translation[2] + forward)
            )
            for p in pattern.panels
        ),
    )


def world(pattern):
    return np.concatenate([p.to_world(p.outline.polygon) for p in pattern.panels])


@pytest.mark.parametrize("name", presets())
@pytest.mark.parametrize("kind", kinds())
def test_a_draft_for_the_body_keeps_its_height(kind, name):
    _, report = standing(draft(kind, name), load_body(name))
    assert abs(report.lifted) < DRAFT_TOL_CM
    assert not report.around_pelvis and report.scale == 1


@pytest.mark.parametrize("kind", ["tee", "skirt", "pants", "hoodie"])
def test_both_worlds_give_the_same_place(kind):
    body, pattern = load_body(), draft(kind)
    placed, _ = standing(pattern, body)
    again, report = standing(moved(pattern, up=-PELVIS_HEIGHT), body)
    assert report.around_pelvis
    assert np.allclose(world(again), world(placed))


def test_standing_twice_is_standing_once():
    body = load_body("tall-slim-male")
    placed, _ = standing(draft("dress" if "dress" in kinds() else "tee"), body)
    again, report = standing(placed, body)
    assert abs(report.lifted) < 1e-9 and abs(report.forward) < 1e-9
    assert np.allclose(world(again), world(placed))


@pytest.mark.parametrize("name", presets())
def test_a_top_comes_down_on_any_shoulders_from_above(name):
    body = load_body(name)
    placed, report = standing(draft("tee"), body)
    assert report.held is Held.SHOULDERS
    neck = body.landmarks["left_neck_point"][1]
    assert TOUCH - PLACE_TOL_CM < world(placed)[:, 1].max() - neck < DRAWN_ABOVE + PLACE_TOL_CM


@pytest.mark.parametrize("name", presets())
def test_the_crotch_of_trousers_is_under_that_of_the_body(name):
    body = load_body(name)
    placed, report = standing(draft("pants"), body)
    assert report.held is Held.WAIST
    front = placed.by_name["left_trouser_front"]
    points = front.to_world(front.outline.polygon)
    crotch = points[points[:, 0].argmin(), 1]
    assert crotch <= body.landmarks["crotch"][1] - CROTCH_ROOM + 1e-6


def test_a_skirt_that_is_too_wide_for_the_waist_goes_down_to_where_it_holds():
    slim = load_body("tall-slim-female")
    _, fitting = standing(draft("skirt", "tall-slim-female"), slim)
    _, wide = standing(draft("skirt", "mean-female"), slim)
    assert wide.opening > fitting.opening
    assert wide.level < fitting.level


def test_front_and_back_get_the_body_between_them():
    body = load_body()
    for forward in (-20.0, 0.0, 20.0):
        placed, _ = standing(moved(draft("tee"), forward=forward), body)
        front, back = (placed.by_name[name].translation[2] for name in ("front", "back"))
        trunk = body.vertices[np.abs(body.vertices[:, 0]) < 5]
        chest = trunk[(trunk[:, 1] > 110) & (trunk[:, 1] < 130), 2]
        assert back < chest.min() and chest.max() < front


def test_nothing_is_bent_and_nothing_moves_sideways():
    pattern = draft("hoodie")
    placed, report = standing(pattern, load_body("tall-slim-male"))
    for before, after in zip(pattern.panels, placed.panels):
        assert after.outline == before.outline and after.rotation == before.rotation
        step = np.subtract(after.translation, before.translation)
        assert np.allclose(step, [0, report.lifted, report.forward])


def test_scaling_is_about_the_floor_and_only_when_asked():
    body, pattern = load_body(), draft("tee")
    placed, report = standing(pattern, body, made_for=2 * np.ptp(body.vertices[:, 1]) / 2 * 1.25)
    assert report.scale == pytest.approx(0.8)
    for before, after in zip(pattern.panels, placed.panels):
        assert after.outline.area == pytest.approx(0.64 * before.outline.area)
        assert [c.length for c in after.curves] == pytest.approx(
            [0.8 * c.length for c in before.curves]
        )
    with pytest.raises(DraftError, match="stature"):
        standing(pattern, body, made_for=17.0)


@pytest.mark.corpus
def test_patterns_by_others_are_held_where_they_are_worn():
    body = load_body()
    for path in corpus_sample(60):
        placed, report = standing(load_pattern(path), body)
        low, high = world(placed)[:, 1].min(), world(placed)[:, 1].max()
        name = path.stem
        if "tee" in name or "jacket" in name or "jumpsuit" in name:
            assert report.held is not Held.WAIST, name
        if name.startswith(("skirt", "pants", "wb_pants")):
            assert report.held is Held.WAIST, name
            assert 95 < report.level < 110, name
        assert low < report.level + 1e-6 and high > 80, name
