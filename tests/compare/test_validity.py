from dataclasses import replace

import pytest

from garmentimage.compare.validation import MAX_SEAM_RATIO, pattern_faults
from garmentimage.pattern.model import Edge, Loop, Panel, Pattern, Side, Stitch
from tests.compare.garments import (
    GARMENTS,
    patched_cloth,
    polygon_loop,
    sewn,
    sleeve_with_cuff,
)


@pytest.mark.parametrize("draw", GARMENTS)
def test_garments_can_be_sewn(draw):
    assert pattern_faults(draw()) == []


def test_a_loop_must_close():
    points = ((0.0, 0.0), (10.0, 0.0), (0.0, 10.0))
    panel = Panel("open", Loop(points, (Edge(0, 1), Edge(1, 2))))
    assert pattern_faults(Pattern((panel,))) == ["panel 'open': the outline is not closed"]


def test_an_outline_must_not_cross_itself():
    panel = Panel("bow", polygon_loop((0, 0), (10, 10), (10, 0), (0, 10)))
    (reason,) = pattern_faults(Pattern((panel,)))
    assert "crosses itself" in reason


def test_coordinates_must_be_finite():
    panel = Panel("far", polygon_loop((0, 0), (float("inf"), 0), (0, 10)))
    (reason,) = pattern_faults(Pattern((panel,)))
    assert "not finite" in reason


@pytest.mark.parametrize("shift", [50, 100])
def test_holes_lie_inside_their_panel(shift):
    cloth = patched_cloth().panels[0]
    hole = polygon_loop(*((x + shift, y) for x, y in cloth.holes[0].vertices))
    (reason,) = pattern_faults(Pattern((replace(cloth, holes=(hole,)),)))
    assert "holes leave the panel" in reason


def test_stitches_must_name_edges_that_exist():
    cloth = patched_cloth().panels[0]
    stitch = Stitch(Side("cloth", 0), Side("cloth", 8))
    assert pattern_faults(Pattern((cloth,), (stitch,))) == [
        "stitch 0 names edge 8 of panel 'cloth', which does not exist"
    ]


def test_no_edge_is_sewn_twice():
    sleeve = sleeve_with_cuff()
    twice = replace(sleeve, stitches=(*sleeve.stitches, *sewn((("cuff", 2), ("cuff", 0)))))
    assert pattern_faults(twice) == ["edge 2 of panel 'cuff' is sewn 2 times"]


def test_two_panels_of_one_name_are_a_fault():
    cloth = patched_cloth().panels[0]
    assert pattern_faults(Pattern((cloth, cloth))) == ["2 panels are called 'cloth'"]


def test_a_seam_gathers_no_more_than_the_limit():
    long = 10 * MAX_SEAM_RATIO
    for width, count in ((long, 0), (long + 1, 1)):
        wide = Panel("wide", polygon_loop((0, 0), (width, 0), (width, 9), (0, 9)))
        band = Panel("band", polygon_loop((0, 0), (10, 0), (10, 9), (0, 9)))
        gathered = Pattern((wide, band), sewn((("wide", 2), ("band", 0))))
        assert len(pattern_faults(gathered)) == count
