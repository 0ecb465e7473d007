"""Lapels and collars lie folded over the garment, outside and right side out, or it is said."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.body import wearer
from garmentimage.draft import draft_pattern
from garmentimage.drape import drape_pattern, outfit
from garmentimage.drape.draping import check_drape
from garmentimage.drape.folded import FoldedPanels, folded_panels, on_panels
from garmentimage.drape.solver.distance_field import body_field, cloth_field
from garmentimage.drape.start import place_on_body
from garmentimage.drape.verdict.folds import fold_faults
from garmentimage.errors import DrapeError
from garmentimage.pattern import Side, lay_open
from garmentimage.pattern.checks import check_pattern
from tests.lapels import moebius, with_collar, with_lapels
from tests.pockets import with_peplum, with_pocket

FEW = 1200  # vertices


@pytest.fixture(scope="module")
def jacket():
    return draft_pattern("jacket")


@pytest.fixture(scope="module")
def lapels(jacket):
    return drape_pattern(with_lapels(jacket), vertices=FEW)


@pytest.fixture(scope="module")
def collar(jacket):
    return drape_pattern(with_collar(jacket), vertices=FEW)


@pytest.mark.parametrize("name", ["lapels", "collar"])
def test_lapels_lie_outside_and_right_side_out(name, request):
    worn = request.getfixturevalue(name)
    assert worn.report.faults == ()
    check_drape(worn)
    depth, area = depth_of_turned(worn)
    assert area[depth > 0.2].sum() < 0.02 * area.sum()


def depth_of_turned(worn):
    """How deep under the cloth beneath the triangles of lapels lie [cm], and their areas."""
    folded = folded_panels(worn.cloth.pattern)
    faces = worn.cloth.vertex_faces
    field = cloth_field(worn.points, faces[on_panels(worn.cloth, folded.bases)])
    corners = worn.points[faces[on_panels(worn.cloth, folded.turned)]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return -field.at(corners.mean(axis=1)), np.linalg.norm(across, axis=1)


def test_a_lapel_left_inside_or_with_its_wrong_side_out_is_a_fault(lapels):
    cloth, folded = lapels.cloth, folded_panels(lapels.cloth.pattern)
    own = np.unique(cloth.vertex_faces[on_panels(cloth, folded.turned)])
    beneath = np.unique(cloth.vertex_faces[~on_panels(cloth, folded.turned)])
    free = np.setdiff1d(own, beneath)
    inside = lapels.points.copy()
    _, outward = body_field(lapels.body).at_with_slope(inside[free])
    inside[free] -= 3.0 * outward
    faults = fold_faults(cloth, inside, folded, lapels.body)
    assert len(faults) == 2 and all("lies under the cloth" in fault for fault in faults)
    # Flipped up about the neckline, beyond which there is no cloth.
    flipped = lapels.points.copy()
    flipped[free, 1] = 2 * lapels.points[beneath, 1].max() - lapels.points[free, 1]
    faults = fold_faults(cloth, flipped, folded, lapels.body)
    assert len(faults) == 2 and all("wrong side is out" in fault for fault in faults)


def test_a_stand_is_put_on_with_its_lapels(jacket):
    found = folded_panels(with_collar(jacket))
    assert found.turned == {"left_lapel", "right_lapel"}
    assert found.stands == {"left_stand", "right_stand"}
    assert found.bases == {"left_front", "right_front", "back"}


def test_a_garment_without_such_seams_has_nothing_folded(jacket):
    assert folded_panels(jacket) == FoldedPanels(frozenset(), frozenset(), {})


def test_laid_open_lapels_are_not_folded(jacket):
    assert folded_panels(lay_open(with_lapels(jacket)).pattern).names == set()


def test_what_a_garment_would_fall_off_without_is_not_put_on_later(jacket):
    """The back counts as turned where all its seams are, but it holds the fronts together."""
    turned = replace(
        jacket,
        stitches=tuple(
            replace(s, same_direction=True) if "back" in (s.a.panel, s.b.panel) else s
            for s in jacket.stitches
        ),
    )
    assert folded_panels(turned).names == set()
    lapels = with_lapels(jacket)
    assert folded_panels(lapels, holding=frozenset({"left_lapel"})).names == set()


def test_a_garment_sewn_with_a_twist_is_refused():
    with pytest.raises(DrapeError, match=r"panels 'a' and 'b' are sewn with a twist.*right_wrong"):
        drape_pattern(moebius())


@pytest.fixture(scope="module")
def shirt():
    return with_pocket(draft_pattern("tee"), "front", (9.0, 4.0))


def test_a_pocket_lies_on_the_cloth_that_it_is_sewn_onto(shirt):
    worn = drape_pattern(shirt, vertices=FEW)
    assert worn.report.faults == () and worn.report.items == 1
    cloth = worn.cloth
    own = np.unique(cloth.vertex_faces[on_panels(cloth, frozenset({"pocket"}))])
    field = cloth_field(worn.points, cloth.vertex_faces[on_panels(cloth, frozenset({"front"}))])
    above = field.at(worn.points[own])
    assert above.min() > 0 and above.max() < 2.0
    assert np.ptp(worn.points[own, 0]) == pytest.approx(12, abs=1.5)


def test_a_pocket_leaves_the_garment_where_it_was_put(shirt):
    body = wearer("mean-female")
    alone = place_on_body(draft_pattern("tee"), body)[1][0]
    with_one = place_on_body(shirt, body)[1][0]
    assert alone.shift_up == with_one.shift_up and alone.site == with_one.site
    assert "pocket" in with_one.panels


def test_clothes_worn_together_keep_their_pockets(shirt):
    both = outfit([shirt, draft_pattern("skirt")])
    assert [sewn.panel for sewn in both.onto] == ["pocket"]
    assert not any("pocket" in str(finding) for finding in check_pattern(both))


def test_a_peplum_hangs_outside_from_the_line_along_which_it_is_sewn_on():
    worn = drape_pattern(with_peplum(draft_pattern("tee")), vertices=FEW)
    assert worn.report.faults == () and worn.report.items == 1
    cloth = worn.cloth
    beneath = cloth_field(worn.points, cloth.vertex_faces[on_panels(cloth, {"front", "back"})])
    own = np.unique(cloth.vertex_faces[on_panels(cloth, {"peplum_front", "peplum_back"})])
    assert np.percentile(beneath.at(worn.points[own]), 5) > 0
    line = worn.points[cloth.vertex[cloth.sides[Side("peplum_front", 3)]]]
    hem = worn.points[cloth.vertex[cloth.sides[Side("peplum_front", 1)]]]
    assert line[:, 1].mean() - hem[:, 1].mean() == pytest.approx(16, abs=2)


@pytest.mark.parametrize("kind", ["button-shirt", "turtleneck"])
def test_a_fall_lies_outside_over_a_stand_that_stands_up(kind):
    worn = drape_pattern(draft_pattern(kind, cuffs="turned-up"), vertices=2000)
    assert not worn.report.faults
    cloth = worn.cloth
    back = cloth.pattern.by_name["collar_back"]
    on = cloth.panel == cloth.pattern.panels.index(back)
    height, places = cloth.flat[on][:, 1], worn.points[cloth.vertex[on]]
    rise = places[height == height.max()].mean(axis=0) - places[height == 0].mean(axis=0)
    assert rise[1] > 0.6 * height.max()
