"""Seams are sewn edge to edge: both sides are cut wherever an edge of either ends."""

from itertools import pairwise

import pytest

from garmentimage.draft.assemble import Assembly
from garmentimage.draft.curves import chain_polygons, length_of, lengths_of
from garmentimage.draft.panel import FRONT, NamedCurve, lines, mirrored, placed, whole
from garmentimage.geometry.curves import Bezier, Line


def strip(name, widths, height, y):
    """A rectangle whose lower edge is cut at the given widths."""
    xs = [sum(widths[:k]) for k in range(len(widths) + 1)]
    right = xs[-1]
    outline = (
        *lines("lower", *((x, 0.0) for x in xs)),
        *lines("end", (right, 0.0), (right, height)),
        *lines("upper", (right, height), (0.0, height)),
        *lines("end", (0.0, height), (0.0, 0.0)),
    )
    return placed(name, outline, FRONT, (0.0, y, 10.0))


def sewn(above, below, fullness=1.0):
    garment = Assembly()
    garment.add(above, below)
    garment.sew(above.seam("lower"), below.seam("upper"), fullness=fullness)
    return garment.pattern("strips")


def test_an_edge_is_cut_where_its_partners_end():
    pattern = sewn(strip("above", (2.0, 3.0, 5.0), 4.0, 20.0), strip("below", (10.0,), 4.0, 0.0))
    pairs = [
        tuple(round(pattern.curve(side).length, 9) for side in s.sides) for s in pattern.stitches
    ]
    assert pairs == [(2, 2), (3, 3), (5, 5)]
    assert len(pattern.by_name["below"].edges) == 6


def test_the_start_of_one_seam_meets_the_end_of_the_other():
    pattern = sewn(strip("above", (2.0, 8.0), 4.0, 20.0), strip("below", (10.0,), 4.0, 0.0))
    first = pattern.stitches[0]
    a, b = (pattern.curve(side) for side in first.sides)
    assert (a.start[0], a.end[0]) == (0.0, 2.0)
    assert (b.end[0], b.start[0]) == pytest.approx((0.0, 2.0))


def test_ends_of_a_gathered_seam_keep_their_shares():
    pattern = sewn(strip("above", (4.0, 16.0), 4.0, 20.0), strip("below", (10.0,), 4.0, 0.0), 2.0)
    for stitch in pattern.stitches:
        a, b = (pattern.curve(side).length for side in stitch.sides)
        assert a == pytest.approx(2 * b)


def test_seams_of_different_lengths_are_our_own_mistake():
    with pytest.raises(AssertionError):
        sewn(strip("above", (9.0,), 4.0, 20.0), strip("below", (10.0,), 4.0, 0.0))


def test_labels_stay_on_all_parts_of_a_cut_edge():
    pattern = sewn(strip("above", (2.0, 8.0), 4.0, 20.0), strip("below", (10.0,), 4.0, 0.0))
    labels = [e.label for e in pattern.by_name["below"].edges]
    assert labels == ["lower", "end", "upper", "upper", "end"]


def test_a_curved_edge_is_cut_by_length():
    arch = Bezier((10.0, 4.0), ((8.0, 9.0), (3.0, 7.0)), (0.0, 4.0))
    outline = (
        *lines("lower", (0.0, 0.0), (10.0, 0.0), (10.0, 4.0)),
        NamedCurve("upper", arch),
        *lines("end", (0.0, 4.0), (0.0, 0.0)),
    )
    half = length_of(arch) / 2
    pattern = sewn(
        strip("above", (half, half), 4.0, 20.0), placed("below", outline, FRONT, (0.0, 0.0, 10.0))
    )
    for stitch in pattern.stitches:
        assert pattern.curve(stitch.b).length == pytest.approx(half, abs=1e-2)


def test_lengths_are_those_of_the_pattern():
    for curve in (
        Line((0.0, 0.0), (3.0, 4.0)),
        Bezier((0.0, 0.0), ((5.0, 9.0),), (10.0, 0.0)),
        Bezier((0.0, 0.0), ((0.0, 9.0), (10.0, 2.0)), (11.0, 15.0)),
    ):
        assert length_of(curve) == pytest.approx(curve.length, rel=5e-4)


def test_a_curve_is_as_long_alone_as_among_others():
    curves = [
        Line((0.0, 0.0), (3.0, 4.0)),
        *(Bezier((0.1, 0.2), ((5.3, 9.7 * k),), (10.9 - k, 0.4)) for k in range(5)),
        *(Bezier((0.3, 0.1), ((0.7, 9.3), (10.1 * k, 2.9)), (11.3, 15.7)) for k in range(5)),
    ]
    assert lengths_of(curves) == [length_of(curve) for curve in curves]


def test_two_halves_meet_in_one_straight_edge():
    half = (
        *lines("hem", (0.0, 0.0), (5.0, 0.0)),
        *lines("side", (5.0, 0.0), (4.0, 6.0)),
        *lines("top", (4.0, 6.0), (0.0, 5.0)),
    )
    outline = whole(half, half, FRONT)
    assert [(n.label, n.side) for n in outline] == [
        ("top", "right"),
        ("side", "right"),
        ("hem", ""),
        ("side", "left"),
        ("top", "left"),
    ]
    assert mirrored(mirrored(half)) == half


def test_a_polygon_begins_each_curve_at_its_start():
    chain = (
        Line((0.0, 0.0), (4.0, 0.0)),
        Bezier((4.0, 0.0), ((5.0, 3.0),), (0.0, 3.0)),
        Line((0.0, 3.0), (0.0, 0.0)),
    )
    triangle = tuple(Line(a, b) for a, b in pairwise([(9.0, 0.0), (9.0, 1.0), (8.0, 0.0)] * 2))[:3]
    first, second = chain_polygons([chain, triangle])
    assert all(list(curve.start) in first.tolist() for curve in chain)
    assert [tuple(point) for point in second.tolist()] == [curve.start for curve in triangle]
