"""Placements and units that are not of this format are named as what they are."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage import draft_pattern
from garmentimage.errors import GarmentImageError
from garmentimage.pattern.checks.placement import UNKNOWN_PLACE, placement_findings, unknown_place
from garmentimage.pattern.checks.sewable import check_pattern
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import (
    Circle,
    Edge,
    Loop,
    Panel,
    Pattern,
    Side,
    Stitch,
    euler_angles,
)
from tests.corpus import corpus_files, corpus_sample

KINDS = ("tee", "skirt", "pants", "one-panel-dress", "top-pants")
Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Takes a world with y up to one with z up and the front at -y."""


def in_world(pattern, matrix, shift=(0.0, 0.0, 0.0)):
    """The same garment in a world that is turned and moved."""
    return replace(
        pattern,
        panels=tuple(
            replace(
                p,
                translation=tuple((matrix @ np.array(p.translation) + shift).tolist()),
                rotation=euler_angles(matrix @ p.matrix),
            )
            for p in pattern.panels
        ),
    )


def scaled(pattern, factor):
    """The same garment with all lengths times `factor`."""

    def loop(given):
        edges = tuple(
            replace(e, curvature=replace(e.curvature, radius=e.curvature.radius * factor))
            if isinstance(e.curvature, Circle)
            else e
            for e in given.edges
        )
        return Loop(tuple((x * factor, y * factor) for x, y in given.vertices), edges)

    return replace(
        pattern,
        panels=tuple(
            replace(
                p,
                outline=loop(p.outline),
                holes=tuple(loop(hole) for hole in p.holes),
                translation=tuple(t * factor for t in p.translation),
            )
            for p in pattern.panels
        ),
    )


def laid_out(pattern, gap=3.0):
    """The panels side by side as on paper."""
    panels, x = [], 0.0
    for p in pattern.panels:
        left, width = p.outline.polygon[:, 0].min(), np.ptp(p.outline.polygon[:, 0])
        panels.append(replace(p, rotation=(0.0, 0.0, 0.0), translation=(x - left, 5.0, 2.0)))
        x += width + gap
    return replace(pattern, panels=tuple(panels))


def at_origin(pattern):
    """The panels without places of their own."""
    zero = (0.0, 0.0, 0.0)
    return replace(
        pattern, panels=tuple(replace(p, rotation=zero, translation=zero) for p in pattern.panels)
    )


def in_radians(pattern):
    """The same rotations, as radians."""
    return replace(
        pattern,
        panels=tuple(
            replace(p, rotation=tuple(np.deg2rad(p.rotation).tolist())) for p in pattern.panels
        ),
    )


MISTAKES = {
    "unplaced": at_origin,
    "flat-layout": laid_out,
    "z-up": lambda p: in_world(p, Z_UP),
    "radians": in_radians,
    "too-small": lambda p: scaled(p, 0.01),
    "too-large": lambda p: scaled(p, 10.0),
}


def codes(pattern):
    return [finding.code for finding in placement_findings(pattern)]


@pytest.fixture(scope="module", params=KINDS)
def garment(request) -> Pattern:
    return draft_pattern(request.param)


@pytest.mark.parametrize("code", MISTAKES)
def test_each_mistake_is_named_as_what_it_is(garment, code):
    wrong = MISTAKES[code](garment)
    assert code in codes(wrong)
    assert code in [finding.code for finding in check_pattern(wrong)]
    assert unknown_place(wrong) is not None
    assert all(found in UNKNOWN_PLACE for found in codes(wrong))


@given(
    x=st.floats(-300, 300), y=st.floats(-300, 300), z=st.floats(-300, 300), turn=st.floats(0, 360)
)
def test_a_garment_that_is_moved_or_turned_about_the_upright_is_not_mistaken(x, y, z, turn):
    c, s = np.cos(np.deg2rad(turn)), np.sin(np.deg2rad(turn))
    upright = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    assert set(codes(in_world(draft_pattern("skirt"), upright, (x, y, z)))) <= {"off-centre"}


def test_a_child_is_no_doubt_and_inches_are_one(garment):
    assert codes(scaled(garment, 0.7)) == []
    assert codes(scaled(draft_pattern("skirt"), 1 / 2.54)) == ["perhaps-inches"]
    assert unknown_place(scaled(draft_pattern("skirt"), 1 / 2.54)) is None


def test_a_panel_in_the_plane_of_the_axis_does_not_run_clockwise(garment):
    """Its outwardness is 0 but for rounding."""
    first, *others = garment.panels
    across = replace(first, translation=(0.0, 100.0, 0.0), rotation=(0.0, 90.0, 0.0))
    assert "inside-out" not in codes(replace(garment, panels=(across, *others)))


def test_a_level_circle_round_the_waist_is_placed():
    """Half rings that lie in one plane, but meet at their seams."""
    vertices = ((-60.0, 0.0), (60.0, 0.0), (12.0, 0.0), (-12.0, 0.0))
    half = Loop(
        vertices,
        (
            Edge(0, 1, Circle(60.0, large=False, right=True)),
            Edge(1, 2),
            Edge(2, 3, Circle(12.0, large=False, right=False)),
            Edge(3, 0),
        ),
    )
    front = Panel("front", half, translation=(0.0, 104.0, 0.0), rotation=(-90.0, 0.0, 0.0))
    back = replace(front, name="back", rotation=(-90.0, 180.0, 0.0))
    seams = (Stitch(Side("front", 1), Side("back", 3)), Stitch(Side("front", 3), Side("back", 1)))
    assert codes(Pattern((front, back), seams)) == []
    apart = replace(back, translation=(0.0, 104.0, -300.0))
    assert codes(Pattern((front, apart), seams)) == ["flat-layout"]


@pytest.mark.corpus
def test_no_file_by_others_is_mistaken():
    for path in corpus_files():
        try:
            _, found = read_pattern(path)
        except GarmentImageError:
            continue
        assert [f.code for f in found if f.code] == [], path


@pytest.mark.corpus
@pytest.mark.parametrize("code", [code for code in MISTAKES if code != "radians"])
def test_mistakes_in_files_by_others_are_named(code):
    """Rotations of less than a radian are no evidence, so these are left out."""
    for path in corpus_sample(60):
        try:
            pattern, _ = read_pattern(path)
        except GarmentImageError:
            continue
        assert code in codes(MISTAKES[code](pattern)), path
