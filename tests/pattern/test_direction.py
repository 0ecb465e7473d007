"""Panels of files without a rule for their direction are turned round where they stand."""

from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from garmentimage import draft_pattern
from garmentimage.compare.comparison import compare_patterns
from garmentimage.pattern.direction import outward, turned_round
from garmentimage.pattern.files.spec_reader import read_spec
from garmentimage.pattern.files.spec_writer import pattern_to_spec

KINDS = ("tee", "skirt", "pants", "one-panel-dress")


@given(kind=st.sampled_from(KINDS), data=st.data())
def test_any_panels_that_run_clockwise_give_the_same_garment(kind, data):
    pattern = draft_pattern(kind)
    names = data.draw(st.sets(st.sampled_from([p.name for p in pattern.panels]), min_size=1))
    clockwise = turned_round(pattern, frozenset(names))
    mended, found = outward(clockwise)
    assert compare_patterns(pattern, mended).success
    assert [f.code for f in found] == ["clockwise"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_good_pattern_stays_as_it_is(kind):
    pattern = draft_pattern(kind)
    assert outward(pattern) == (pattern, ())


def test_a_file_is_read_so_and_says_so():
    pattern = draft_pattern("tee")
    read, found = read_spec(pattern_to_spec(turned_round(pattern, frozenset(["back"]))))
    assert compare_patterns(pattern, read).success
    assert any("'back': ran clockwise" in str(f) for f in found)


def test_a_panel_that_is_inside_out_and_sewn_so_is_only_told():
    """Its seams would twist if it ran the other way."""
    pattern = draft_pattern("skirt")
    back = next(p for p in pattern.panels if p.name == "skirt_back")
    turned = replace(back, rotation=(0.0, 0.0, 180.0))
    inside_out = replace(pattern, panels=tuple(turned if p is back else p for p in pattern.panels))
    read, found = outward(inside_out)
    assert (read, found) == (inside_out, ())
