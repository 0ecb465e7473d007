"""Figures of published codes: worked out by hand, and the same for a pattern and itself."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.compare.matching import POSES
from garmentimage.compare.pairing import posed_panel
from garmentimage.draft.kind import draft_pattern
from garmentimage.errors import PatternError
from garmentimage.examples import example_path
from garmentimage.metrics.published import (
    Slots,
    published_figures,
    slots_of,
    tag_stitches,
    universal_translation,
)
from garmentimage.pattern.files.spec import load_pattern
from tests.compare.garments import renamed_panels, shifted_loops

MODES = ("neuraltailor", "sewformer", "aipparel")
SQUARE = [(10, 0, 0, 0), (0, 10, 0, 0), (-10, 0, 0, 0), (0, -10, 0, 0)]
TRIANGLE = [(10, 0, 0, 0), (-5, 10, 0, 0), (-5, -10, 0, 0)]


def slots(*panels, stitches=(), rotations=None, translations=None):
    edges = np.zeros((3, 6, 4))
    for k, rows in enumerate(panels):
        edges[k, : len(rows)] = np.reshape(rows, (-1, 4))
    return Slots(
        edges,
        np.zeros((3, 4)) if rotations is None else np.array(rotations, float),
        np.zeros((3, 3)) if translations is None else np.array(translations, float),
        frozenset(frozenset(pair) for pair in stitches),
    )


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", ["one-panel-dress", "top-pants", "shirt"])
def test_a_pattern_is_all_right_against_itself(mode, kind):
    pattern = draft_pattern(kind)
    found = slots_of(pattern, ["another", *(panel.name for panel in pattern.panels)], 20)
    told = published_figures([found], [found], mode)
    for name, value in told.items():
        wanted = 0.0 if name.endswith("l2") else 1.0
        assert value == pytest.approx(wanted, abs=1e-9), name


def test_the_panel_distance_is_over_vertices_and_control_points():
    # A side of the triangle 2 cm longer: its far corner and the control points beside it move.
    longer = [(12, 0, 0, 0), (-7, 10, 0, 0), (-5, -10, 0, 0)]
    told = published_figures([slots(TRIANGLE)], [slots(longer)], "neuraltailor")
    # A straight edge's control point is at its start: points are 0, 0, B, B, C, C, 0.
    moved = np.array([(0, 0), (0, 0), (2, 0), (2, 0), (0, 0), (0, 0), (0, 0)], float)
    wanted = np.linalg.norm(moved - moved.mean(0), axis=1).mean()
    assert told["panel_l2"] == pytest.approx(wanted)


def test_modes_pair_panels_by_slot_or_by_order():
    truth, moved = slots(SQUARE, TRIANGLE), slots([], SQUARE, TRIANGLE)
    by_slot = published_figures([truth], [moved], "sewformer")
    by_order = published_figures([truth], [moved], "aipparel")
    assert by_slot["panels"] == by_order["panels"] == 1
    assert by_slot["panel_l2"] > 3 and by_order["panel_l2"] == 0
    assert by_slot["edges"] == 0  # no slot has the right number of edges
    # By name: of the panels found, none is in a slot with the true number of edges.
    assert by_order["edges"] == 0 and by_order["accuracy"] == 0


def test_edges_are_shared_out_over_true_or_over_predicted_panels():
    truth, found = slots(SQUARE, TRIANGLE), slots(SQUARE)
    assert published_figures([truth], [found], "neuraltailor")["edges"] == 0.5
    assert published_figures([truth], [found], "aipparel")["edges"] == 1.0
    told = published_figures([truth, truth], [truth, found], "aipparel")
    assert told["panels"] == 0.5 and told["panel_l2"] == 0  # the other pattern does not count
    assert np.isnan(published_figures([truth], [found], "aipparel")["panel_l2"])


def test_a_loop_that_is_open_has_one_edge_more():
    open_square = slots(SQUARE[:3])
    told = published_figures([slots(SQUARE)], [open_square], "neuraltailor")
    assert told["panels"] == told["edges"] == 1
    short = slots([*SQUARE[:3], (0, -6.5, 0, 0)])  # misses by 3.5 cm: five edges
    assert published_figures([slots(SQUARE)], [short], "neuraltailor")["edges"] == 0


def test_sewformer_looks_at_the_ends_of_edges_only():
    truth = slots(SQUARE)
    bent = slots([*SQUARE, (0, 0, 0.5, 0.5)])
    assert published_figures([truth], [bent], "neuraltailor")["edges"] == 0
    assert published_figures([truth], [bent], "sewformer")["edges"] == 1
    scaled = published_figures([truth], [bent], "neuraltailor", scale=np.full(4, 10.0))
    assert scaled["edges"] == 1  # 0.05 units are padding


def test_rotations_count_all_slots_or_real_panels_either_way_round():
    one = [(0, 0, 0, 1), (0, 0, 0, 0), (0, 0, 0, 0)]
    minus = [(0, 0, 0, -1), (0, 0, 0, 0), (0, 0, 0, 0)]
    truth, found = slots(SQUARE, rotations=one), slots(SQUARE, rotations=minus)
    told = published_figures([truth], [found], "neuraltailor")
    assert told["rotation_l2"] == pytest.approx(2 / 3)
    assert published_figures([truth], [found], "aipparel")["rotation_l2"] == 0
    away = slots(SQUARE, rotations=one, translations=[(3, 4, 0), (0, 0, 0), (0, 0, 0)])
    assert published_figures([truth], [away], "sewformer")["translation_l2"] == pytest.approx(5 / 3)
    assert published_figures([truth], [away], "aipparel")["translation_l2"] == 5


def test_stitches_are_right_whichever_side_is_first():
    truth = slots(SQUARE, SQUARE, stitches=[((0, 1), (1, 3)), ((0, 0), (1, 0))])
    found = slots(SQUARE, SQUARE, stitches=[((1, 3), (0, 1)), ((0, 2), (1, 2)), ((0, 0), (0, 3))])
    told = published_figures([truth], [found], "sewformer")
    assert told["stitch_precision"] == pytest.approx(1 / 3) and told["stitch_recall"] == 0.5
    assert told["stitch_f1"] == pytest.approx(0.4)


def test_tags_pair_the_closest_edges_first():
    tags, free = np.zeros((2, 3, 3)), np.zeros((2, 3))
    tags[0, :, 0], tags[1, :, 0] = (0, 5, 9), (0.1, 5.4, 9)
    free[0, 2] = 0.9
    there = np.ones((2, 3), bool)
    found = tag_stitches(tags, free, there)
    assert found == {frozenset({(0, 0), (1, 0)}), frozenset({(0, 1), (1, 1)})}
    assert tag_stitches(tags, np.ones((2, 3)), there) == frozenset()


def test_the_universal_translation_is_the_highest_side():
    panel = draft_pattern("top-pants").by_name["front"]
    corners = np.array(panel.outline.vertices)
    world = universal_translation(panel)
    assert world[1] == pytest.approx(panel.to_world(corners)[:, 1].max(), abs=1e-6)


def test_what_slots_do_not_have_is_told():
    pattern = draft_pattern("top-pants")
    with pytest.raises(PatternError, match="is in none of the slots"):
        slots_of(pattern, ["front"])
    holed = load_pattern(example_path("cutout_top"))
    with pytest.raises(PatternError, match="has holes, or more than 14 edges"):
        slots_of(holed, [panel.name for panel in holed.panels])
    with pytest.raises(ValueError, match="there is no mode 'ours'"):
        published_figures([], [], "ours")


def test_batches_that_do_not_fit_are_refused():
    skirt = draft_pattern("skirt")
    names = [panel.name for panel in skirt.panels]
    one = slots_of(skirt, names)
    empty = slots_of(replace(skirt, panels=(), stitches=()), names)
    for mode in MODES:
        for truths, found, message in (
            ([], [], "0 true patterns"),
            ([one], [one, one], "1 true patterns and 2 found ones"),
            ([one], [slots_of(skirt, [*names, "more"])], "the same slots"),
            ([empty], [one], "a true pattern has no panels"),
        ):
            with pytest.raises(ValueError, match=message):
                published_figures(truths, found, mode)
        with pytest.raises(ValueError, match="none of them 0"):
            published_figures([one], [one], mode, scale=np.zeros(4))


def test_slots_and_tags_that_cannot_be_are_refused():
    skirt = draft_pattern("skirt")
    names = [panel.name for panel in skirt.panels]
    with pytest.raises(ValueError, match="names of their own"):
        slots_of(skirt, [*names, names[0]])
    with pytest.raises(PatternError, match="which does not exist"):
        slots_of(replace(skirt, panels=skirt.panels[1:]), names)
    with pytest.raises(ValueError, match="not finite"):
        tag_stitches(np.full((1, 4, 3), np.nan), np.zeros((1, 4)), np.ones((1, 4), bool))


@pytest.mark.parametrize("kind", ["skirt", "shirt", "top-pants"])
def test_a_garment_of_other_names_frames_and_first_edges_takes_the_slots_of_the_true_one(kind):
    truth = draft_pattern(kind)
    names = [panel.name for panel in truth.panels]
    poses = [POSES[k % len(POSES)] for k in range(len(names))]
    drawn = tuple(posed_panel(p, pose) for p, pose in zip(truth.panels, poses, strict=True))
    found = replace(truth, panels=drawn[::-1])
    found = renamed_panels(shifted_loops(found, 2), lambda name: f"decoded {name}")
    with pytest.raises(PatternError, match="give the true garment as like="):
        slots_of(found, names, 20)
    one, two = slots_of(truth, names, 20), slots_of(found, names, 20, like=truth)
    assert one.stitches == two.stitches
    np.testing.assert_allclose(one.edges, two.edges, atol=1e-6)
    np.testing.assert_allclose(one.translations, two.translations, atol=1e-6)
    for mode in MODES:
        told = published_figures([one], [two], mode)
        assert told["panels"] == told["edges"] == told["stitch_recall"] == 1
        assert told["panel_l2"] == pytest.approx(0, abs=1e-6)


def test_a_panel_too_many_takes_a_slot_that_is_left():
    truth, more = draft_pattern("skirt"), draft_pattern("hoodie")
    names = [panel.name for panel in truth.panels]
    spare = [f"spare {k}" for k in range(len(more.panels))]
    found = slots_of(more, [*names, *spare], 20, like=truth)
    assert sum(count > 0 for count in found.counts) == len(more.panels)
    with pytest.raises(PatternError, match="is in none of the slots"):
        slots_of(more, names, 20, like=truth)
