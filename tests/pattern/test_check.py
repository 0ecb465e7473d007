import math
from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from garmentimage.errors import PatternError, StitchError
from garmentimage.pattern.checks.sewable import check_pattern, components
from garmentimage.pattern.files.spec import pattern_from_spec, read_spec
from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Edge,
    Loop,
    Notch,
    Panel,
    Pattern,
    Quadratic,
    Side,
    Stitch,
)
from tests.garments import garments
from tests.pattern.specs import panel, spec, stitch


def chain(*points, **curvatures):
    """A loop through the points, edge k with curvature `ek`."""
    count = len(points)
    return Loop(
        tuple((float(x), float(y)) for x, y in points),
        tuple(Edge(k, (k + 1) % count, curvatures.get(f"e{k}")) for k in range(count)),
    )


SQUARE = chain((0, 0), (30, 0), (30, 40), (0, 40))


def alone(outline, **fields):
    return Pattern((Panel("front", outline, **fields),))


def messages(pattern):
    return [str(f) for f in check_pattern(pattern)]


@given(garments())
def test_garments_of_ours_pass_without_a_word(garment):
    assert check_pattern(garment) == ()
    assert len(components(garment)) == 1


@given(st.sets(st.integers(0, 35), min_size=4, max_size=12), st.integers(0, 11))
def test_neighbours_exchanged_make_a_convex_panel_cross_itself(angles, k):
    points = [(50 * math.cos(a * math.pi / 18), 50 * math.sin(a * math.pi / 18)) for a in angles]
    points = sorted(points, key=lambda p: math.atan2(p[1], p[0]))
    assert check_pattern(alone(chain(*points))) == ()
    k %= len(points)
    points[k - 1], points[k] = points[k], points[k - 1]
    with pytest.raises(PatternError, match=r"panel 'front', edges \d+ and \d+: cross"):
        check_pattern(alone(chain(*points)))


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e13])
def test_numbers_that_are_no_places_are_named(bad):
    outline = chain((0, 0), (30, 0), (bad, 40), (0, 40))
    with pytest.raises(PatternError, match="panel 'front', vertex 2"):
        check_pattern(alone(outline))
    with pytest.raises(PatternError, match="panel 'front': its translation"):
        check_pattern(alone(SQUARE, translation=(0.0, bad, 0.0)))
    with pytest.raises(PatternError, match="panel 'front', edge 1: its curvature"):
        check_pattern(alone(chain(*SQUARE.vertices, e1=Quadratic((0.5, bad)))))


def test_an_edge_without_length_is_named():
    with pytest.raises(PatternError, match="panel 'front', edge 1: has no length"):
        check_pattern(alone(chain((0, 0), (30, 0), (30, 1e-9), (0, 40))))


def test_a_panel_without_area_is_named():
    for outline in (chain((0, 0), (30, 0)), chain((0, 0), (15, 15), (30, 30))):
        with pytest.raises(PatternError, match="panel 'front': has no area"):
            check_pattern(alone(outline))


def test_a_lens_of_two_arcs_is_a_panel():
    arc = Circle(20.0, False, True)
    assert check_pattern(alone(chain((0, 0), (30, 0), e0=arc, e1=arc))) == ()


def test_crossing_edges_are_both_named_with_the_place():
    with pytest.raises(PatternError, match=r"edges 0 and 2: .* near \(15.0, 20.0\) cm"):
        check_pattern(alone(chain((0, 0), (30, 40), (30, 0), (0, 40))))


def test_a_curve_that_crosses_an_edge_is_named_with_it():
    with pytest.raises(PatternError, match="edges 0 and 2"):
        check_pattern(alone(chain(*SQUARE.vertices, e0=Quadratic((0.5, 3.0)))))


def test_a_curve_that_crosses_itself_is_named():
    with pytest.raises(PatternError, match="edge 0: crosses itself"):
        check_pattern(alone(chain(*SQUARE.vertices, e0=Cubic((1.5, -0.9), (-0.5, -0.9)))))


def test_a_spike_that_runs_back_on_itself_is_refused():
    with pytest.raises(PatternError, match="edges 1 and 2"):
        check_pattern(alone(chain((0, 0), (30, 0), (30, 50), (30, 20), (0, 40))))


def test_a_loop_that_touches_itself_is_refused():
    bow = Loop(
        ((0.0, 0.0), (10.0, 10.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)),
        tuple(Edge(a, b) for a, b in ((0, 1), (1, 2), (2, 3), (3, 1), (1, 4), (4, 0))),
    )
    with pytest.raises(PatternError, match="passes vertex 1 a second time"):
        check_pattern(alone(bow))


def test_a_chain_that_is_not_closed_is_refused():
    broken = Loop(SQUARE.vertices, SQUARE.edges[:3])
    with pytest.raises(PatternError, match="edge 2: ends at vertex 3, but the next edge starts"):
        check_pattern(alone(broken))


def test_marks_must_lie_on_the_panel():
    for fields, message in (
        ({"notches": (Notch(4, 0.5),)}, "notch"),
        ({"notches": (Notch(0, 1.5),)}, "notch"),
        ({"grain": (0.0, 0.5)}, "grain"),
        ({"cloth_layer": -1}, "cloth layer"),
    ):
        with pytest.raises(PatternError, match=message):
            check_pattern(alone(SQUARE, **fields))


def test_stitches_name_edges_that_exist_each_once():
    two = pattern_from_spec(spec()).panels
    good = Stitch(Side("front", 1), Side("back", 3))
    for stitches, message in (
        ((good, Stitch(Side("front", 4), Side("back", 0))), "stitch 1: names edge 4"),
        ((Stitch(Side("front", -1), Side("back", 0)),), "stitch 0: names edge -1"),
        ((Stitch(Side("nobody", 0), Side("back", 0)),), "stitch 0: names panel 'nobody'"),
        ((good, Stitch(Side("back", 0), Side("back", 0))), "stitch 1: sews edge 0 .* to itself"),
        ((good, Stitch(Side("front", 1), Side("back", 0))), "stitches 0 and 1: both sew edge 1"),
    ):
        with pytest.raises(StitchError, match=message):
            check_pattern(Pattern(two, stitches))


def test_loose_panels_and_separate_garments_are_told_once():
    names = "abcdef"
    panels = {n: {**panel(z=20 + k), "translation": [0, 0, k + 1]} for k, n in enumerate(names)}
    sewn = [stitch(("a", 1), ("b", 3)), stitch(("c", 1), ("d", 3))]
    _, found = read_spec(spec(panels, sewn))
    assert [f.place for f in found] == ["pattern.stitches", "pattern.stitches"]
    assert "'e', 'f' are sewn to no other panel" in found[0].message
    assert "2 garments" in found[1].message


def test_panels_that_all_lie_at_one_place_are_told():
    data = spec()
    for given_panel in data["pattern"]["panels"].values():
        given_panel["translation"], given_panel["rotation"] = [0, 0, 0], [0, 0, 0]
    assert [f.place for f in read_spec(data)[1]] == ["placement"]


def test_a_panel_inside_out_is_told():
    pattern = pattern_from_spec(spec())
    back = pattern.panels[1]
    turned = replace(back, rotation=(0.0, 0.0, 0.0))
    told = messages(replace(pattern, panels=(pattern.panels[0], turned)))
    assert len(told) == 1
    assert told[0].startswith("panel 'back'")


def test_a_garment_of_an_odd_size_is_told():
    tiny = alone(chain((0, 0), (0.3, 0), (0.3, 0.4), (0, 0.4)))
    vast = alone(chain((0, 0), (3000, 0), (3000, 40), (0, 40)))
    for pattern in (tiny, vast):
        assert messages(pattern)[0].startswith("whole garment: its largest panel is")
    with pytest.raises(PatternError, match="panel 'front': is 300 m in size"):
        check_pattern(alone(chain((0, 0), (30000, 0), (30000, 40), (0, 40))))


def test_a_far_off_panel_is_told_and_keeps_its_area():
    far = alone(chain(*((x + 1e9, y - 1e9) for x, y in SQUARE.vertices)))
    assert far.panels[0].outline.area == pytest.approx(1200.0)
    assert messages(far)[0].startswith("panel 'front': lies 1e+09 cm from")


def test_dense_gathers_are_told_and_common_ones_are_not():
    pattern = pattern_from_spec(spec())
    for shrink, count in ((2.0, 0), (5.0, 1)):
        small = Panel(
            "back",
            chain(*((x, y / shrink) for x, y in SQUARE.vertices)),
            translation=(0.0, 100.0, -20.0),
            rotation=(0.0, 180.0, 0.0),
        )
        gathered = Pattern((pattern.panels[0], small), pattern.stitches[:1])
        assert len(messages(gathered)) == count


@pytest.mark.slow
def test_a_scribble_of_thousands_of_crossings_is_answered():
    points = [(100 * math.cos(2.5 * k), 100 * math.sin(2.5 * k)) for k in range(3000)]
    with pytest.raises(PatternError, match="edges 0 and"):
        check_pattern(alone(chain(*points)))


def test_strange_names_are_escaped_and_shortened():
    for name, part in (("a\nb", r"'a\\nb'"), ("x" * 1000, "x" * 39 + "…")):
        with pytest.raises(PatternError, match=part) as caught:
            check_pattern(Pattern((Panel(name, chain((0, 0), (1, 1))),)))
        assert "\n" not in str(caught.value)
        assert len(str(caught.value)) < 200


def test_a_seam_of_which_half_was_forgotten_is_told():
    """The back has a vertex midway; the whole side of the front is sewn to its lower half."""
    halved = [[0, 0], [30, 0], [30, 40], [0, 40], [0, 20]]
    ends = ((0, 1), (1, 2), (2, 3), (3, 4), (4, 0))
    panels = {"front": panel(), "back": panel(halved, ends, z=-20)}
    whole_side = stitch(("front", 3), ("back", 1))
    _, found = read_spec(spec(panels, [whole_side, stitch(("front", 1), ("back", 4))]))
    assert [(f.place, f.code) for f in found] == [("stitch 1", "half-sewn")]
    assert "edge 3 of panel 'back'" in found[0].message
    # Where the other half is sewn elsewhere, it was not forgotten.
    third = {"third": panel(z=-10)}
    elsewhere = [stitch(("front", 1), ("back", 4)), stitch(("third", 1), ("back", 3)), whole_side]
    assert "half-sewn" not in [f.code for f in read_spec(spec(panels | third, elsewhere))[1]]
