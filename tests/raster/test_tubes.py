"""Panels sewn to themselves all round are drawn on both layers, and come back whole."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import EncodeError, decode, draft_pattern, encode
from garmentimage.compare import compare_patterns
from garmentimage.pattern import Pattern, tube_sides
from garmentimage.raster import EdgeType
from tests.raster.mirror import mirrored_pattern
from tests.raster.panels import rectangle, ring, stitch
from tests.tubes import tube, under_a_top, with_band, with_whole_sleeves

slowly = settings(max_examples=4)


def assert_back(pattern, grid="auto"):
    image = encode(pattern, grid)
    assert compare_patterns(pattern, decode(image)).success
    bare = decode(image.to_channels())
    result = compare_patterns(pattern, bare, any_pose=True)
    assert result.success, result.reasons
    return image


@slowly
@given(st.floats(60, 140), st.floats(12, 90), st.floats(-4, 20), st.booleans())
def test_a_tube_of_any_size_comes_back_whole(width, height, flare, behind):
    pattern = tube(width, height, flare, behind=behind)
    image = assert_back(pattern)
    assert (image.edge_type == EdgeType.WRAP).any()
    # Its seam lies on the other side of the body: its cloth is one piece there where it is drawn.
    pieces = [sum(mark.layer == layer for mark in image.marks) for layer in (0, 1)]
    assert pieces == ([2, 1] if behind else [1, 2])


@pytest.mark.parametrize("grid", [16, 32])
@pytest.mark.parametrize("make", [lambda: with_band(tube()), under_a_top])
def test_tubes_come_back_with_what_they_are_sewn_to(make, grid):
    assert_back(make(), grid)


def test_sleeves_of_one_panel_come_back_whole():
    assert_back(with_whole_sleeves(draft_pattern("tee")))


def test_the_image_of_a_mirrored_tube_is_its_mirror():
    pattern = under_a_top()
    image, mirrored = (encode(p, 16).inside for p in (pattern, mirrored_pattern(pattern)))
    assert np.array_equal(image[:, :, ::-1], mirrored)


def test_a_slit_ring_is_not_a_tube():
    for degrees in (300.0, 355.0):
        pattern = ring(degrees, True)
        assert all(tube_sides(pattern, panel) is None for panel in pattern.panels)


def test_a_tube_that_is_seen_from_its_side_has_its_seam_on_the_other_side():
    panel = rectangle("tube", 90.0, 60.0, (15.0, 70.0, 0.0), (0.0, 90.0, 0.0))
    assert_back(Pattern((panel,), (stitch("tube", 1, "tube", 3),)))


def test_a_poncho_of_one_panel_is_told_to_be_cut_through_its_hole():
    hole = rectangle("", 20.0, 18.0, (0.0, 0.0, 0.0)).outline
    panel = rectangle("poncho", 120.0, 120.0, (0.0, 142.0, 0.0), (-90.0, 0.0, 0.0), (hole,))
    with pytest.raises(
        EncodeError, match=r"'poncho' wraps .* cut it there, through the hole"
    ) as told:
        encode(Pattern((panel,), ()))
    assert told.value.remedy == "pattern"
