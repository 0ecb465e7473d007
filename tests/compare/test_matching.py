from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.compare.matching import (
    boundary_distance,
    boundary_gap,
    iou_matrix,
    match_panels,
    panel_iou,
)
from garmentimage.geometry.curves import Arc
from garmentimage.pattern.model import Panel, Pattern, loop_from_curves
from tests.compare.garments import (
    GARMENTS,
    patched_cloth,
    polygon_loop,
    renamed_panels,
    reordered,
    shifted_loops,
    six_gores,
    sleeve_with_cuff,
    transformed_panel,
)

garments = st.sampled_from(GARMENTS).map(lambda draw: draw())


def rectangle(width, height, *, x=0.0, y=0.0, name="panel"):
    return Panel(
        name, polygon_loop((x, y), (x + width, y), (x + width, y + height), (x, y + height))
    )


def test_gap_is_the_farthest_that_a_boundary_lies_from_the_other():
    assert boundary_gap(rectangle(10, 20), rectangle(10, 20, x=500)) == pytest.approx(0)
    assert boundary_gap(rectangle(10, 20), rectangle(16, 28)) == pytest.approx(5)
    assert boundary_gap(rectangle(10, 20), rectangle(20, 10)) == pytest.approx(5)
    assert boundary_gap(rectangle(10, 20), rectangle(20, 10), any_pose=True) == pytest.approx(0)


def test_a_hole_that_is_missing_is_a_gap():
    frame = replace(
        rectangle(40, 40), holes=(polygon_loop((10, 10), (10, 30), (30, 30), (30, 10)),)
    )
    assert boundary_gap(frame, rectangle(40, 40)) == pytest.approx(10)


def test_iou_aligns_centroids():
    assert panel_iou(rectangle(10, 20), rectangle(10, 20, x=500, y=-40)) == pytest.approx(1)
    assert panel_iou(rectangle(10, 20), rectangle(10, 10)) == pytest.approx(0.5)


def test_a_turned_panel_agrees_in_any_pose_only():
    assert panel_iou(rectangle(10, 40), rectangle(40, 10)) == pytest.approx(1 / 7)
    assert panel_iou(rectangle(10, 40), rectangle(40, 10), any_pose=True) == pytest.approx(1)


def test_a_mirrored_panel_agrees_in_any_pose_only():
    triangle = Panel("panel", polygon_loop((0, 0), (30, 0), (0, 10)))
    mirrored = Panel("panel", polygon_loop((0, 0), (0, 10), (-30, 0)))
    assert panel_iou(triangle, mirrored) < 0.7
    assert panel_iou(triangle, mirrored, any_pose=True) == pytest.approx(1)


def test_holes_count():
    cloth = patched_cloth().panels[0]
    assert panel_iou(cloth, replace(cloth, holes=())) == pytest.approx(3200 / 3600)


def test_a_circle_has_the_area_of_a_circle():
    arcs = [Arc((x, 0.0), (-x, 0.0), 5.0, False, True) for x in (-5.0, 5.0)]
    disk = Panel("disk", loop_from_curves(arcs))
    square = rectangle(20, 20)
    assert panel_iou(disk, square) == pytest.approx(25 * np.pi / 400, rel=0.003)


def test_a_boundary_that_crosses_itself_still_has_an_iou():
    bow = Panel("bow", polygon_loop((0, 0), (10, 10), (10, 0), (0, 10)))
    assert panel_iou(bow, bow) == pytest.approx(1)
    assert 0 < panel_iou(bow, rectangle(10, 10)) < 1


def test_pairs_that_cannot_match_are_not_compared():
    panels = [rectangle(10, 10), rectangle(1, 1)]
    assert iou_matrix(panels, panels).tolist() == [[1, 0], [0, 1]]


@given(garments, st.integers(0, 2**32 - 1), st.integers(0, 5))
def test_every_garment_matches_itself_written_anew(garment, seed, shift):
    again = shifted_loops(reordered(garment, np.random.default_rng(seed)), shift)
    matching = match_panels(garment, again)
    assert matching.panel_map == {p.name: p.name for p in garment.panels}
    assert matching.mean_iou == pytest.approx(1)
    assert all(p.boundary_distance < 0.2 for p in matching.pairs)


def test_missing_and_extra_panels_count_as_nothing():
    sleeve = sleeve_with_cuff()
    two = Pattern(sleeve.panels[:2])
    assert match_panels(sleeve, two).missing == ("cuff",)
    assert match_panels(two, sleeve).extra == ("cuff",)
    assert match_panels(sleeve, two).mean_iou == pytest.approx(2 / 3)
    assert match_panels(two, Pattern(())).ious == (0.0, 0.0)


def test_placement_tells_equal_panels_apart():
    garment = six_gores()
    again = renamed_panels(Pattern(garment.panels[::-1]), lambda name: name + "_again")
    assert match_panels(garment, again).panel_map == {
        p.name: p.name + "_again" for p in garment.panels
    }


def test_names_win_over_shape_and_place_when_asked():
    garment = Pattern(sleeve_with_cuff().panels)
    other = {"sleeve_front": "cuff", "cuff": "sleeve_front", "sleeve_back": "sleeve_back"}
    renamed = renamed_panels(garment, other.get)
    assert match_panels(garment, renamed).panel_map == other
    assert match_panels(garment, renamed, by_name=True).panel_map == {n: n for n in other}


@given(st.floats(0.5, 0.95))
def test_a_shrunk_panel_loses_the_square_in_iou(scale):
    garment = sleeve_with_cuff()
    shrunk = transformed_panel(garment, "cuff", np.eye(2) * scale)
    ious = {p.a: p.iou for p in match_panels(garment, shrunk, by_name=True).pairs}
    assert ious["cuff"] == pytest.approx(scale**2)
    assert ious["sleeve_back"] == pytest.approx(1)


def test_boundaries_are_as_far_apart_as_they_are_moved():
    wide, wider = rectangle(40, 40), rectangle(42, 42)
    assert boundary_distance(wide, wide) == pytest.approx(0, abs=1e-9)
    # Sides lie 1 cm apart, corners 1.4 cm.
    assert 1.0 < boundary_distance(wide, wider) < np.sqrt(2)


def test_boundary_distance_knows_neither_start_nor_direction():
    corners = [(0, 0), (32, 0), (32, 16), (16, 32), (0, 32)]
    panel = Panel("panel", polygon_loop(*corners))
    later = Panel("panel", polygon_loop(*corners[2:], *corners[:2]))
    backwards = Panel("panel", polygon_loop(*corners[::-1]))
    assert boundary_distance(panel, later) < 0.1
    assert boundary_distance(panel, backwards) < 0.1
