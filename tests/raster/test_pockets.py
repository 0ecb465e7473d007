"""Pockets: panels that are sewn onto the cloth of others come back at their places."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, reject, settings, strategies as st

from garmentimage import EncodeError, Pattern, decode, draft_pattern, encode, load_image, save_image
from garmentimage.compare import compare_patterns
from garmentimage.raster import EdgeType, mirrored_channels
from garmentimage.raster.repair import repair
from tests.lapels import polygon
from tests.pockets import with_peplum, with_pocket

slowly = settings(max_examples=8)


@pytest.fixture(scope="module")
def tee():
    return draft_pattern("tee")


@pytest.fixture(scope="module")
def shirt(tee):
    return with_pocket(with_pocket(tee, "front", (9, 6)), "front", (-9, 6), name="other")


@pytest.fixture(scope="module")
def image(shirt):
    return encode(shirt)


def middle(pattern: Pattern, name: str) -> np.ndarray:
    """The middle of a pocket on the panel beneath [cm]."""
    (sewn,) = (sewn for sewn in pattern.onto if sewn.panel == name)
    return sewn.carried(pattern.by_name[name].outline.fine_polygon).mean(axis=0)


def assert_back(pattern, image):
    for found, any_pose in ((decode(image), False), (decode(image.to_channels()), True)):
        result = compare_patterns(pattern, found, any_pose=any_pose)
        assert result.success, result.reasons
        assert len(found.onto) == len(pattern.onto)


def test_two_pockets_come_back_sewn_on_with_three_edges_each(shirt, image):
    assert image.grid == 16 and image.layers == 4
    assert_back(shirt, image)
    assert all(len(sewn.edges) == 3 for sewn in decode(image).onto)
    assert (image.edge_type[2] == EdgeType.ONTO).any()
    assert not (image.edge_type[:2] == EdgeType.ONTO).any()


def test_the_cloth_beneath_goes_on(tee, shirt, image):
    assert len(decode(image).panels) == len(tee.panels) + 2
    front = next(panel for panel in decode(image).panels if panel.name == "front")
    assert not front.holes


@slowly
@given(st.floats(-12, 12), st.floats(-8, 12), st.floats(-20, 20))
def test_a_pocket_comes_back_where_it_was_however_it_is_turned(x, y, angle):
    shirt = with_pocket(draft_pattern("tee"), "front", (x, y), (9.0, 10.0), angle=angle)
    try:
        found = encode(shirt)
    except EncodeError:
        reject()
    assert_back(shirt, found)
    assert middle(decode(found), "pocket") == pytest.approx([x, y], abs=0.5)


@pytest.mark.parametrize("step", [(3.0, 0.0), (0.0, 3.0)])
def test_a_pocket_moved_by_3_cm_comes_back_moved_by_3_cm(tee, step):
    places = [
        middle(decode(encode(with_pocket(tee, "front", centre))), "pocket")
        for centre in ((8.0, 6.0), (8.0 + step[0], 6.0 + step[1]))
    ]
    assert places[1] - places[0] == pytest.approx(step, abs=0.5)


def test_a_pocket_behind_lies_on_the_back_layer(tee):
    shirt = with_pocket(tee, "back", (8, 2))
    found = encode(shirt)
    assert found.inside[3].any() and not found.inside[2].any()
    assert_back(shirt, found)


def test_the_image_of_symmetric_pockets_is_symmetric(image):
    assert np.array_equal(image.inside, image.inside[..., ::-1])
    channels = image.to_channels()[None]
    np.testing.assert_allclose(channels, mirrored_channels(channels), atol=0.05)


def test_files_keep_what_is_sewn_on(image, tmp_path):
    save_image(image, tmp_path / "shirt.npz")
    assert load_image(tmp_path / "shirt.npz") == image


def test_a_correct_image_is_not_repaired(image):
    same, report = repair(image)
    assert same is image and not report.changed


def test_what_is_sewn_onto_nothing_is_not_sewn(image):
    """A network that forgets the cloth beneath one pocket."""
    inside, types = image.inside.copy(), image.edge_type.copy()
    inside[0] = False
    types[0] = EdgeType.NON_BOUNDARY
    found, _ = repair(replace(image, inside=inside, edge_type=types, marks=()))
    assert not (found.edge_type == EdgeType.ONTO).any()
    assert decode(found).onto == ()


@pytest.mark.parametrize(
    "on, centre, sentence",
    [
        ("front", (24.0, 6.0), "neither lies wholly on its cloth"),
        ("pocket", (6.0, 7.0), "lies on other cloth itself"),
    ],
)
def test_pockets_that_cannot_be_drawn_are_refused_by_name(tee, on, centre, sentence):
    shirt = with_pocket(tee, "front", (0.0, 4.0), (16.0, 18.0))
    with pytest.raises(EncodeError, match=rf"panel 'second' is sewn onto panel '{on}'.*{sentence}"):
        encode(with_pocket(shirt, on, centre, (6.0, 6.0), "second"))


def test_a_pocket_on_a_panel_that_wraps_round_the_body_is_refused():
    hoodie = draft_pattern("hoodie")
    hood = next(p.name for p in hoodie.panels if "hood" in p.name)
    centre = hoodie.by_name[hood].outline.fine_polygon.mean(axis=0)
    with pytest.raises(EncodeError, match="wraps round the body"):
        encode(with_pocket(hoodie, hood, tuple(centre.tolist()), (5.0, 5.0)))


def test_a_comparison_sees_a_pocket_that_moved_or_is_gone(tee, shirt):
    moved = with_pocket(with_pocket(tee, "front", (9, 8)), "front", (-9, 6), name="other")
    result = compare_patterns(shirt, moved)
    assert result.reasons == ("panel 'pocket' is sewn onto panel 'front' 2.0 cm from its place",)
    gone = replace(shirt, onto=shirt.onto[:1])
    assert compare_patterns(shirt, gone).reasons == (
        "panel 'other' is not sewn onto panel 'front'",
    )
    assert not compare_patterns(gone, shirt).success


@slowly
@given(st.floats(-12, 6), st.floats(8, 24), st.floats(0, 15))
def test_a_peplum_comes_back_sewn_across_front_and_back(height, length, flare):
    top = with_peplum(draft_pattern("tee"), height, length, flare)
    assert_back(top, encode(top))


def test_a_pocket_and_a_peplum_may_be_on_one_panel(tee):
    top = with_pocket(with_peplum(tee), "front", (8, 10), (9, 10))
    found = encode(top)
    assert_back(top, found)
    front = next(panel for panel in decode(found).panels if panel.name == "front")
    assert front.translation == pytest.approx(tee.by_name["front"].translation)


def test_a_peplum_that_ends_inside_a_panel_is_refused(tee):
    top = with_peplum(tee)
    narrow = replace(
        top.by_name["peplum_front"],
        outline=polygon((-12, -6), (-12, -20), (12, -20), (12, -6)),
    )
    panels = tuple(narrow if p.name == narrow.name else p for p in top.panels)
    with pytest.raises(EncodeError, match="'peplum_front' is sewn onto panel 'front', but neither"):
        encode(replace(top, panels=panels, stitches=tee.stitches))
