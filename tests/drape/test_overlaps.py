"""Fronts that overlap lie on each other by their cloth layers, or it is said."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.draft import draft_pattern
from garmentimage.drape import drape_pattern
from garmentimage.drape.folded import folded_panels, on_panels, overlapping_panels
from garmentimage.drape.solver.distance_field import body_field, cloth_field
from garmentimage.drape.verdict.folds import overlap_faults
from tests.lapels import with_lapels
from tests.overlaps import overlapping, wrapped
from tests.pockets import with_peplum, with_pocket

FEW = 1200  # vertices


def left_on_right(pattern):
    """The pattern with its left front on cloth layer 1, the right one beneath."""
    layers = {"left_front": 1, "right_front": 0}
    panels = [replace(p, cloth_layer=layers.get(p.name, p.cloth_layer)) for p in pattern.panels]
    return replace(pattern, panels=tuple(panels))


@pytest.fixture(scope="module")
def dress():
    return wrapped(draft_pattern("one-panel-dress"))


@pytest.fixture(scope="module")
def jacket():
    return overlapping(draft_pattern("jacket"), by=12.0)


@pytest.fixture(scope="module")
def worn(dress):
    return drape_pattern(dress, vertices=FEW)


def height_over(worn, upper, lower):
    """How far the triangles of a panel lie outside of another one they lie on [cm]."""
    faces = worn.cloth.vertex_faces
    field = cloth_field(worn.points, faces[on_panels(worn.cloth, {lower})])
    height = field.at(worn.points[faces[on_panels(worn.cloth, {upper})]].mean(axis=1))
    return height[np.abs(height) < 2.0]


@pytest.mark.parametrize("name", ["dress", "jacket"])
@pytest.mark.parametrize("upper", ["left_front", "right_front"])
def test_the_front_on_the_outer_cloth_layer_lies_outside(name, upper, request):
    pattern = request.getfixturevalue(name)
    pattern = pattern if upper == "right_front" else left_on_right(pattern)
    lower = {"right_front": "left_front", "left_front": "right_front"}[upper]
    worn = drape_pattern(pattern, vertices=FEW)
    assert worn.report.faults == ()
    height = height_over(worn, upper, lower)
    assert len(height) > 10 and height.min() > 0


def test_an_overlapping_front_that_lies_inside_is_a_fault(worn):
    cloth, folded = worn.cloth, folded_panels(worn.cloth.pattern)
    inside = worn.points.copy()
    own = np.unique(cloth.vertex_faces[on_panels(cloth, {"right_front"})])
    _, outward = body_field(worn.body).at_with_slope(inside[own])
    inside[own] -= 3.0 * outward
    (fault,) = overlap_faults(cloth, inside, folded)
    assert "where panel 'right_front' of cloth layer 1 overlaps others" in fault
    assert overlap_faults(cloth, worn.points, folded) == []


def test_the_layer_beneath_is_draped_as_if_nothing_lay_on_it(dress, worn):
    alone = drape_pattern(replace(dress, panels=tuple(on_one_layer(dress))), vertices=FEW)
    beneath = np.unique(worn.cloth.vertex_faces[~on_panels(worn.cloth, {"right_front"})])
    assert np.array_equal(alone.points[beneath], worn.points[beneath])
    assert not np.array_equal(alone.points, worn.points)


def on_one_layer(pattern):
    return [replace(panel, cloth_layer=0) for panel in pattern.panels]


def test_lapels_and_what_is_sewn_onto_cloth_are_laid_on_it_otherwise():
    tee = draft_pattern("tee")
    lapels = overlapping(with_lapels(draft_pattern("jacket")), by=0.0)
    for pattern in (tee, with_pocket(tee, "front", (9.0, 4.0)), with_peplum(tee), lapels):
        assert overlapping_panels(pattern, folded_panels(pattern)) == {}


def test_a_front_lies_on_the_other_front_only(dress, jacket):
    for pattern in (dress, jacket):
        found = overlapping_panels(pattern, folded_panels(pattern))
        assert found == {"right_front": {"left_front"}}
