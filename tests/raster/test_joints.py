"""Joints: traced outlines and doubled corners are the garments that they were drawn from."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import decode, encode, load_pattern
from garmentimage.compare.comparison import compare_patterns
from garmentimage.draft.kind import draft_pattern, kinds
from garmentimage.examples import example_names, example_path
from garmentimage.geometry.curves import Bezier, Line
from garmentimage.pattern.model import Panel, Pattern, Side, Stitch, loop_from_curves
from garmentimage.pattern.seam_runs import STUB_CM
from garmentimage.raster.encode.joints import Joints, find_joints
from tests.strangers import doubled, moved, recut, traced

slowly = settings(max_examples=8)
SPLIT = ("hoodie", "jacket")
"""Kinds whose panels are cut to be drawn, which only marks can join again."""


def drafts():
    """Drafts whose panels all lie flat, on no other cloth."""
    drawn = [draft_pattern(kind) for kind in kinds() if kind not in SPLIT]
    return st.sampled_from([p for p in drawn if not any(q.cloth_layer for q in p.panels)])


def sides(pattern):
    return st.sampled_from(list(pattern.sides()))


@slowly
@given(drafts(), st.data())
def test_a_doubled_corner_is_no_corner(garment, data):
    size = 10 ** data.draw(st.floats(-4, np.log10(0.99 * STUB_CM)))
    changed = doubled(garment, data.draw(sides(garment)), size)
    image = encode(changed)
    for decoded in (decode(image), decode(image.without_marks())):
        assert compare_patterns(changed, decoded).reasons == ()
        assert compare_patterns(garment, decoded).reasons == ()


@slowly
@given(drafts(), st.floats(0.3, 5.0))
def test_a_traced_garment_is_the_garment(garment, step):
    changed = traced(garment, step)
    image = encode(changed)
    assert compare_patterns(changed, decode(image)).reasons == ()
    assert compare_patterns(garment, decode(image.without_marks())).reasons == ()


def test_a_traced_garment_comes_back_with_its_own_vertices():
    changed = traced(draft_pattern("tee"), 0.3)
    decoded = decode(encode(changed))
    assert len(decoded.stitches) == len(changed.stitches)
    for panel in changed.panels:
        again = decoded.by_name[panel.name]
        assert len(again.edges) == len(panel.edges)
        there = np.array(again.outline.vertices)
        for vertex in panel.outline.vertices:
            assert np.hypot(*(there - vertex).T).min() < 0.5


def test_without_marks_a_traced_garment_has_few_edges():
    decoded = decode(encode(traced(draft_pattern("tee"), 0.5)).without_marks())
    assert max(len(panel.edges) for panel in decoded.panels) < 16


def test_divisions_of_a_traced_garment_with_other_marks_are_left_out():
    """Marks may come from another image (`from_channels(like=...)`): they divide what is there."""
    image = encode(traced(draft_pattern("tee"), 1.0))
    other = replace(encode(draft_pattern("skirt")), marks=image.marks)
    assert compare_patterns(draft_pattern("skirt"), decode(other.without_marks())).reasons == ()
    assert len(decode(other).panels) == 4


@pytest.mark.parametrize("name", [*kinds(), *example_names()])
def test_an_ordinary_pattern_has_no_joint_to_open(name):
    pattern = load_pattern(example_path(name)) if name in example_names() else draft_pattern(name)
    assert find_joints(pattern) == Joints(frozenset(), frozenset(), ())


def test_corners_seam_ends_and_the_tips_of_darts_stay():
    shirt = load_pattern(example_path("darted_shirt"))
    changed = traced(shirt, 0.5)
    joints = find_joints(changed)
    corners = {
        (panel.name, *curve.start)
        for panel in shirt.panels
        for loop in panel.loops
        for before, curve in zip(loop.curves[-1:] + loop.curves, loop.curves, strict=False)
        if turn(before, curve) > np.deg2rad(20)
    }
    darts = {(panel.name, *apex) for panel in shirt.panels for apex in apexes(shirt, panel)}
    assert len(darts) == 6
    opened = {(side.panel, *changed.curve(side).start) for side in joints.open}
    assert not opened & (corners | darts)
    assert len(opened) > 1000


def turn(before, after):
    ends = before.at(np.array([0.99, 1.0])), after.at(np.array([0.0, 0.01]))
    (ux, uy), (vx, vy) = (b - a for a, b in ends)
    return abs(np.arctan2(ux * vy - uy * vx, ux * vx + uy * vy))


def apexes(pattern, panel):
    """Where two edges meet that are sewn to each other."""
    for k, edge in enumerate(panel.edges):
        partner = pattern.partners.get(Side(panel.name, k))
        if partner is None or partner.panel != panel.name:
            continue
        if panel.edges[partner.edge].start == edge.end:
            yield panel.curves[k].end


def test_outlines_that_zigzag_keep_their_corners():
    rng = np.random.default_rng(0)
    rough = moved(
        traced(draft_pattern("skirt"), 3.0), lambda p: p + rng.uniform(-0.8, 0.8, p.shape)
    )
    opened = find_joints(rough).open
    assert len(opened) < 0.5 * sum(len(panel.edges) for panel in rough.panels)


def test_where_a_seam_is_divided_unevenly_its_joints_stay():
    """A front gathered in its middle only: edges of 2 cm sewn to 2, 4 and 2 cm."""
    lengths = {"front": [2.0] * 18, "back": [2.0] * 6 + [4.0] * 6 + [2.0] * 6}
    panels = []
    for name, steps in lengths.items():
        x = np.concatenate([[0.0], np.cumsum(steps)]) - sum(steps) / 2
        points = [(float(v), 0.0) for v in x] + [(float(x[-1]), 30.0), (float(x[0]), 30.0)]
        curves = [Line(a, b) for a, b in pairwise([*points, points[0]])]
        panels.append(Panel(name, loop_from_curves(curves), (), (0.0, 60.0, 0.0)))
    sewn = [Stitch(Side("front", k), Side("back", k), same_direction=True) for k in range(18)]
    joints = find_joints(Pattern(tuple(panels), tuple(sewn)))
    kept = set(range(1, 18)) - {side.edge for side in joints.open if side.panel == "front"}
    assert {6, 12} <= kept and len(kept) < 9
    assert {s.edge for s in joints.open if s.panel == "back"} == {
        s.edge for s in joints.open if s.panel == "front"
    }


def circle(radius, count, *, begin=0):
    angles = 2 * np.pi * (np.arange(count) + begin) / count
    points = [(float(radius * np.cos(a)), float(radius * np.sin(a))) for a in angles]
    return loop_from_curves(
        [Line(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    )


def test_a_traced_circle_keeps_two_vertices_wherever_it_begins():
    kept = []
    for begin in (0, 7, 33):
        loop = circle(20.0, 60, begin=begin)
        opened = find_joints(Pattern((Panel("round", loop),))).open
        ends = [loop.vertices[k] for k in range(60) if Side("round", k) not in opened]
        kept.append({(round(x, 6), round(y, 6)) for x, y in ends})
    assert kept[0] == kept[1] == kept[2] and len(kept[0]) == 2


def test_smooth_bezier_parts_are_joined_like_chords():
    def cut(side, curve):
        parts = []
        for left in range(6, 1, -1):
            part, curve = curve.split(curve.parameter(1 / left))
            parts.append((part, True))
        return [*parts, (curve, True)]

    skirt = draft_pattern("skirt")
    changed = recut(skirt, cut)
    assert any(isinstance(c, Bezier) for p in changed.panels for c in p.curves)
    assert compare_patterns(changed, decode(encode(changed))).reasons == ()
