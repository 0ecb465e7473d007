import pytest
from hypothesis import given, strategies as st

from garmentimage.draft.templates.influence import (
    Bend,
    Moving,
    Run,
    bent,
    equalising_factors,
    lengthened,
    scaled,
)
from garmentimage.errors import PatternError
from garmentimage.pattern.model import Edge, Loop, Quadratic

CORNERS = ((0.0, 0.0), (30.0, 0.0), (33.0, 40.0), (0.0, 44.0))
LOOP = Loop(CORNERS, (Edge(0, 1), Edge(1, 2, Quadratic((0.4, 0.2))), Edge(2, 3), Edge(3, 0)))
OUTLINES = {"front": LOOP}

factors = st.floats(0.1, 5)
lengths = st.floats(0.1, 50)
runs = st.tuples(
    st.sampled_from([(0,), (1,), (2, 3), (0, 1, 2), (3, 1)]),
    st.sampled_from(Moving),
    st.sampled_from([None, (1.0, 2.0), (-3.0, 0.5)]),
)
"""Edges, what moves, and along which line."""


def vertices(outlines):
    return outlines["front"].vertices


def near(points):
    return [pytest.approx(p, abs=1e-9) for p in points]


@given(runs, factors)
def test_scaling_multiplies_the_extent_of_a_run(how, factor):
    run = Run("front", *how)
    longer = scaled(OUTLINES, run, factor)
    before, after = run.extent(LOOP), run.extent(longer["front"])
    assert after == pytest.approx(factor * before)


@given(runs, factors)
def test_the_fixed_place_of_a_run_stays(how, factor):
    run = Run("front", *how)
    assert run.fixed(scaled(OUTLINES, run, factor)["front"]) == pytest.approx(run.fixed(LOOP))


@given(runs, factors)
def test_scaling_back_undoes_scaling(how, factor):
    run = Run("front", *how)
    again = scaled(scaled(OUTLINES, run, factor), run, 1 / factor)
    assert list(vertices(again)) == near(CORNERS)


@given(runs, lengths)
def test_shortening_undoes_lengthening(how, length):
    run = Run("front", *how)
    again = lengthened(lengthened(OUTLINES, run, length), run, -length)
    assert list(vertices(again)) == near(CORNERS)


@pytest.mark.parametrize(
    ("moving", "corners"),
    [
        (Moving.END, {1: (35.0, 0.0)}),
        (Moving.START, {0: (-5.0, 0.0)}),
        (Moving.BOTH, {0: (-5.0, 0.0), 1: (35.0, 0.0)}),
    ],
)
def test_lengthening_moves_each_free_end_by_the_length(moving, corners):
    moved = lengthened(OUTLINES, Run("front", (0,), moving), 5.0)
    expected = [corners.get(k, point) for k, point in enumerate(CORNERS)]
    assert list(vertices(moved)) == near(expected)


def test_every_vertex_of_a_run_moves_along_the_line_by_its_own_distance():
    moved = scaled(OUTLINES, Run("front", (0, 1), Moving.END, along=(0.0, 7.0)), 2.0)
    assert list(vertices(moved)) == near([(0, 0), (30, 0), (33, 80), (0, 44)])


def test_bending_scales_the_control_point_of_one_edge():
    edge = bent(OUTLINES, Bend("front", 1), 0.5, -3.0)["front"].edges[1]
    assert edge.curvature.control == pytest.approx((0.2, -0.6))


def test_equalised_runs_have_their_mean_extent():
    pair = [Run("front", (0,), Moving.END), Run("front", (3,), Moving.START)]
    assert equalising_factors(OUTLINES, pair) == pytest.approx([37 / 30, 37 / 44])


def test_a_run_that_returns_to_its_start_needs_a_direction():
    with pytest.raises(PatternError, match=r"edge 0: its run .* same place.*'along'"):
        scaled(OUTLINES, Run("front", (0, 1, 2, 3), Moving.END), 2.0)


def test_a_run_without_extent_cannot_be_equalised():
    level = Run("front", (0,), Moving.END, along=(0.0, 1.0))
    with pytest.raises(PatternError, match="no extent along its direction"):
        equalising_factors(OUTLINES, [level, Run("front", (3,), Moving.END)])
