from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.geometry.curves import Arc, Bezier, Line
from garmentimage.raster.decode.curve_fit import cut_run, fit_curve

SHARES = st.floats(0.25, 0.75)
BENDS = st.floats(-0.4, 0.4)


def hausdorff(a, b):
    gaps = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))
    return max(gaps.min(axis=0).max(), gaps.min(axis=1).max())


@given(SHARES, BENDS, st.integers(3, 8))
def test_quadratic_edge_comes_back_from_a_few_of_its_points(along, bend, chords):
    edge = Bezier((0.0, 0.0), ((40 * along, 40 * bend),), (40.0, 0.0))
    fitted = fit_curve(edge.sample(chords))
    assert fitted is not None
    assert hausdorff(fitted.sample(60), edge.sample(60)) < 0.5
    assert fitted.length == pytest.approx(edge.length, rel=0.005)


@given(st.integers(3, 9), st.floats(18, 200))
def test_circular_arc_becomes_one_edge_as_long(chords, radius):
    edge = Arc((0.0, 0.0), (30.0, 0.0), radius, False, True)
    (part,) = cut_run((edge.sample(chords),))
    assert part.curves[0].length == pytest.approx(edge.length, rel=0.005)


@given(st.integers(4, 12), st.floats(16, 60), st.booleans(), st.booleans())
def test_points_of_an_arc_give_the_arc_back_even_the_long_way_round(chords, radius, large, right):
    edge = Arc((0.0, 0.0), (30.0, 0.0), radius, large, right)
    (part,) = cut_run((edge.sample(chords),))
    (fitted,) = part.curves
    if not fitted.is_straight:
        assert isinstance(fitted, Arc)
    assert hausdorff(fitted.sample(200), edge.sample(200)) < 0.5


@given(st.floats(0.2, 1.0), st.integers(4, 10))
def test_points_of_a_parabola_do_not_become_an_arc(bend, chords):
    edge = Bezier((0.0, 0.0), ((15.0, 40 * bend),), (40.0, 0.0))
    fitted = fit_curve(edge.sample(chords))
    assert isinstance(fitted, Bezier)


@pytest.mark.parametrize("ratio", [0.3, 0.6, 1.6, 3.0])
def test_a_line_that_runs_smoothly_into_a_curve_is_an_edge_of_its_own(ratio):
    """The front of trousers: the seam above, then the crotch, each with even grid points."""
    crotch = Bezier((0.0, 0.0), ((0.0, -12.0),), (14.0, -15.0)).sample(3)
    chord = float(np.hypot(*(crotch[1] - crotch[0])))
    line = Line((0.0, 2 * chord * ratio), (0.0, 0.0)).sample(2)
    first, second = cut_run((np.concatenate([line, crotch[1:]]),))
    assert (first.last, first.curves[0].is_straight, second.curves[0].is_straight) == (
        2,
        True,
        False,
    )


def test_three_sides_of_a_square_tab_keep_their_corners():
    """Its four points lie on a circle, too."""
    parts = cut_run((np.array([(0.0, 0.0), (0.0, 8.0), (8.0, 8.0), (8.0, 0.0)]),))
    assert [part.curves[0].is_straight for part in parts] == [True] * 3


@given(st.integers(1, 9), st.floats(-3, 3))
def test_points_on_a_line_become_a_line(chords, slope):
    edge = Line((0.0, 0.0), (20.0, 20.0 * slope))
    (part,) = cut_run((edge.sample(chords),))
    assert part.curves == (edge,)


@given(st.floats(75, 170), st.integers(1, 4), st.integers(1, 4))
def test_run_is_cut_at_a_true_corner(turn, before, after):
    angle = np.deg2rad(turn)
    far = (20 + 15 * np.cos(angle), 15 * np.sin(angle))
    first = Line((0.0, 0.0), (20.0, 0.0)).sample(before)
    second = Line((20.0, 0.0), far).sample(after)
    parts = cut_run((np.concatenate([first, second[1:]]),))
    assert [(p.first, p.last) for p in parts] == [(0, before), (before, before + after)]
    assert all(p.curves[0].is_straight for p in parts)


def test_deep_neckline_stays_one_curve_though_it_turns_sharply():
    edge = Bezier((-8.0, 0.0), ((0.0, -40.0),), (8.0, 0.0))
    (part,) = cut_run((edge.sample(6),))
    assert hausdorff(part.curves[0].sample(80), edge.sample(80)) < 0.3


def test_both_sides_of_a_seam_are_cut_at_the_same_points():
    straight = Line((0.0, 0.0), (40.0, 0.0)).sample(4)
    bent = np.array([[0.0, 0], [10, 0], [20, 0], [20, 10], [20, 20]])
    parts = cut_run((straight, bent))
    assert [(p.first, p.last) for p in parts] == [(0, 2), (2, 4)]
    assert all(len(p.curves) == 2 for p in parts)


@given(st.lists(st.tuples(st.floats(-30, 30), st.floats(-30, 30)), min_size=2, max_size=12))
def test_edges_pass_on_from_point_to_point_whatever_the_run(points):
    run = np.array(points) + np.arange(len(points))[:, None] * 1e-3
    parts = cut_run((run,))
    assert parts[0].first == 0 and parts[-1].last == len(run) - 1
    for part in parts:
        assert part.curves[0].start == pytest.approx(tuple(run[part.first]))
        assert part.curves[0].end == pytest.approx(tuple(run[part.last]))


def test_run_that_comes_and_goes_about_its_start_is_cut_too():
    run = np.array([[0.0, 0], [1, 0], [0, 0], [-1, 0], [0, 0]])
    assert cut_run((run,))[-1].last == len(run) - 1


def test_run_without_a_good_curve_is_never_worse_than_its_polyline():
    zigzag = np.array([[0.0, 0], [5, 6], [10, 0], [15, 6], [20, 0], [25, 6]])
    drawn = np.concatenate([p.curves[0].sample(20) for p in cut_run((zigzag,))])
    chords = np.concatenate([Line(tuple(a), tuple(b)).sample(20) for a, b in pairwise(zigzag)])
    assert hausdorff(drawn, chords) < 0.3
