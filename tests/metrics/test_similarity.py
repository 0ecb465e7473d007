"""How near a predicted pattern comes to the true one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import garmentimage as gi
from garmentimage.compare import pattern_faults
from garmentimage.compare.matching import POSES
from garmentimage.compare.pairing import posed_panel
from garmentimage.draft.sampling import sample
from garmentimage.metrics import interval, likeness, likeness_summary
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Side, Stitch
from tests.compare.garments import (
    renamed_panels,
    reordered,
    shifted_loops,
    split_edges,
    transformed_panel,
    without_stitch,
)
from tests.corpus import unpacked

KINDS = ("one-panel-dress", "top-pants", "shirt", "tee", "skirt")


def drawn(kind: str, seed: int):
    return next(iter(sample(kind, 1, seed))).pattern


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(KINDS), st.integers(0, 50), st.integers(0, 3))
def test_a_garment_is_like_itself_however_it_is_written(kind, seed, shift):
    truth = drawn(kind, seed)
    found = reordered(
        renamed_panels(shifted_loops(truth, shift), lambda name: f"x-{name}"),
        np.random.default_rng(seed),
    )
    told = likeness(truth, found)
    assert told.panel_iou == pytest.approx(1) and told.panel_l2 == pytest.approx(0, abs=0.1)
    assert told.panels and told.edges == 1 and told.topology and told.valid
    assert told.rotation == pytest.approx(0, abs=0.5)
    assert told.translation == pytest.approx(0, abs=0.1)
    assert told.by_edge.f1 == told.by_length.f1 == 1


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(KINDS), st.integers(0, 50), st.lists(st.integers(0, 7), min_size=1))
def test_the_frames_of_panels_say_nothing_of_the_garment(kind, seed, poses):
    """Mirrored frames, too: the loop then runs the other way in them, as it should."""
    truth = drawn(kind, seed)
    panels = [
        posed_panel(panel, POSES[poses[k % len(poses)]]) for k, panel in enumerate(truth.panels)
    ]
    told = likeness(truth, replace(truth, panels=tuple(panels)))
    assert told.panel_iou == pytest.approx(1) and told.topology and told.valid
    assert told.by_edge.f1 == told.by_length.f1 == 1
    assert told.rotation == pytest.approx(0, abs=0.5)
    assert told.translation == pytest.approx(0, abs=0.1)


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(KINDS), st.integers(0, 50), st.integers(0, 7))
def test_a_panel_in_another_frame_is_the_same_panel_at_the_same_place(kind, seed, pose):
    panel = drawn(kind, seed).panels[0]
    posed = posed_panel(panel, POSES[pose])
    for before, after in zip(panel.curves, posed.curves, strict=True):
        np.testing.assert_allclose(
            posed.to_world(after.sample(8)), panel.to_world(before.sample(8)), atol=1e-6
        )


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(KINDS), st.integers(0, 50))
def test_what_channels_alone_bring_back_is_like_the_garment(kind, seed):
    truth = drawn(kind, seed)
    told = likeness(truth, gi.decode(gi.encode(truth).without_marks()))
    assert told.topology and told.panels and told.valid
    assert told.panel_iou > 0.95 and told.by_length.f1 == 1


@pytest.mark.corpus
@pytest.mark.slow
def test_back_panels_with_the_rotation_of_the_front_are_not_paired_crosswise(tmp_path):
    files = sorted(unpacked("faults/faults.tar.xz", tmp_path).rglob("public-likeness/*.json"))
    assert files
    for path in files:
        truth = read_pattern(path)[0]
        told = likeness(truth, gi.decode(gi.encode(truth).without_marks()))
        assert told.topology and told.panel_iou > 0.9 and told.by_length.f1 > 0.95


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 50), st.floats(0.3, 0.7))
def test_cutting_an_edge_counts_by_edge_and_not_by_length(seed, share):
    truth = drawn("top-pants", seed)
    side = truth.stitches[0].a
    told = likeness(truth, split_edges(truth, {side: share}))
    assert told.by_length.f1 == 1 and told.topology
    assert told.edges < 1 and told.by_edge.f1 < 1


def test_a_lost_stitch_costs_recall_and_a_needless_one_precision():
    truth = drawn("shirt", 3)
    less = without_stitch(truth, 0)
    count = len(truth.stitches)
    lost, added = likeness(truth, less), likeness(less, truth)
    for told in (lost.by_edge, lost.by_length):
        assert (told.precision, told.recall) == (1, (count - 1) / count)
    for told in (added.by_edge, added.by_length):
        assert (told.precision, told.recall) == ((count - 1) / count, 1)
    assert lost.panel_iou == pytest.approx(1)


def test_a_seam_left_open_is_another_topology():
    truth = drawn("skirt", 1)
    assert not likeness(truth, without_stitch(truth, 0)).topology


def test_missing_and_extra_panels_count_nothing():
    trousers = drawn("top-pants", 1)
    one = trousers.panels[0].name
    left = tuple(s for s in trousers.stitches if one not in (s.a.panel, s.b.panel))
    fewer = replace(trousers, panels=trousers.panels[1:], stitches=left)
    share = 1 - 1 / len(trousers.panels)
    for told in (likeness(trousers, fewer), likeness(fewer, trousers)):
        assert told.panel_iou == pytest.approx(share, abs=1e-6) and not told.panels


@pytest.mark.parametrize("angle", [10.0, 40.0])
def test_panels_turned_and_moved_at_the_body_are_measured_in_degrees_and_centimetres(angle):
    truth = drawn("skirt", 2)
    panel = truth.panels[0]
    assert panel.rotation == (0, 0, 0)
    turned = replace(truth, panels=(replace(panel, rotation=(0, angle, 0)), *truth.panels[1:]))
    assert likeness(truth, turned).rotation == pytest.approx(angle / len(truth.panels), abs=0.01)
    x, y, z = panel.translation
    moved = replace(truth, panels=(replace(panel, translation=(x, y, z + 8)), *truth.panels[1:]))
    told = likeness(truth, moved)
    assert told.translation == pytest.approx(8 / len(truth.panels), abs=0.01)
    assert told.rotation == pytest.approx(0, abs=0.01)


def test_a_wider_panel_loses_overlap_as_much_as_it_is_wider():
    truth = drawn("skirt", 2)
    wider = transformed_panel(truth, truth.panels[0].name, [[1.25, 0], [0, 1]])
    told = likeness(truth, wider)
    assert told.panel_iou == pytest.approx(1 - 0.2 / len(truth.panels), abs=0.02)
    assert told.by_edge.f1 == told.by_length.f1 == 1


def test_nothing_found_is_all_wrong_and_no_error():
    truth = drawn("tee", 0)
    unknown = replace(truth, stitches=(Stitch(Side("x", 0), Side("x", 1)),))
    for found in (None, replace(truth, panels=(), stitches=()), unknown):
        told = likeness(truth, found)
        assert (told.panel_iou, told.panel_l2, told.by_length.f1) == (0, None, 0)
        assert not told.valid and not told.topology
        assert told.by_edge.precision == told.by_edge.recall == 0
    loose = replace(truth, stitches=())
    assert likeness(loose, None).by_edge.f1 == 0 and likeness(loose, loose).by_edge.f1 == 1


def test_a_panel_that_stands_nowhere_is_nothing_found():
    truth = drawn("tee", 0)
    lost = replace(truth.panels[0], translation=(np.nan, 0.0, 0.0))
    found = replace(truth, panels=(lost, *truth.panels[1:]))
    assert likeness(truth, found).panel_iou == 0 and "not finite" in pattern_faults(found)[0]


@pytest.mark.wrong_types
def test_a_truth_that_is_none_is_refused():
    truth = drawn("tee", 0)
    with pytest.raises(gi.PatternError, match="true pattern without panels"):
        likeness(replace(truth, panels=(), stitches=()), truth)
    with pytest.raises(TypeError, match="wanted a Pattern"):
        likeness(truth, "tee.json")


def test_sums_of_nothing_are_refused():
    one = likeness(drawn("tee", 0), None)
    for found, draped in (([], None), ([one, one], [True])):
        with pytest.raises(ValueError, match="give one or more, and a value for each"):
            likeness_summary(found, draped=draped)
    with pytest.raises(ValueError, match="no values"):
        interval([])


def test_a_garment_decoded_from_its_image_has_all_stitches_by_length():
    truth = drawn("top-pants", 4)
    told = likeness(truth, gi.decode(gi.encode(truth)))
    assert told.panel_iou > 0.97 and told.topology and told.by_length.f1 == 1
    assert told.rotation < 3 and told.translation < 3


def test_sums_have_intervals_and_micro_counts_stitches_not_garments():
    large, small = drawn("shirt", 1), drawn("skirt", 1)
    found = [likeness(large, large), likeness(small, without_stitch(small, 0))]
    told = likeness_summary(found, draped=[True, False])
    count = len(small.stitches) + len(large.stitches)
    recall = (count - 1) / count
    assert told["stitch_f1_by_edge_micro"] == pytest.approx(2 * recall / (1 + recall))
    assert told["topology"].mean == told["draped"].mean == 0.5 and told["topology"].n == 2
    assert told["topology"].low == 0 and told["topology"].high == 1
    assert told == likeness_summary(found, draped=[True, False])


def test_an_interval_narrows_with_the_root_of_the_number():
    values = np.random.default_rng(0).normal(5, 2, 6400)
    few, many = interval(values[:400]), interval(values)
    assert (few.high - few.low) / (many.high - many.low) == pytest.approx(4, rel=0.15)
    assert few.high - few.low == pytest.approx(2 * 1.96 * 2 / 20, rel=0.15)


def test_a_panel_that_crosses_itself_is_not_valid_and_costs_no_other_panel():
    truth = drawn("skirt", 2)
    panel = truth.panels[0]
    vertices = list(panel.outline.vertices)
    vertices[0], vertices[1] = vertices[1], vertices[0]
    crossed = replace(panel, outline=replace(panel.outline, vertices=tuple(vertices)))
    told = likeness(truth, replace(truth, panels=(crossed, *truth.panels[1:])))
    assert not told.valid
    assert 1 - 1 / len(truth.panels) <= told.panel_iou < 1


def test_a_panel_without_size_costs_that_panel_only():
    truth = drawn("skirt", 2)
    for matrix in ([[1e-9, 0], [0, 1e-9]], [[1e-9, 0], [0, 1]]):
        flat = transformed_panel(truth, truth.panels[0].name, matrix)
        told = likeness(truth, flat)
        assert told.panel_iou == pytest.approx(1 - 1 / len(truth.panels))
