"""Pressed pleats come back with their kind and how far they are pressed."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, reject, settings, strategies as st

from garmentimage import (
    EncodeError,
    ImageError,
    decode,
    draft_pattern,
    encode,
    load_image,
    load_pattern,
    save_image,
    save_pattern,
)
from garmentimage.compare import compare_patterns
from garmentimage.draft import sample
from garmentimage.pattern import Pattern, turned_round
from garmentimage.raster import EdgeType, mirrored_channels
from garmentimage.raster.repair import repair

KINDS = ("knife", "box", "inverted")
FROM_PLUS_X = {"knife": ["right", "left"], "box": ["box"] * 2, "inverted": ["inverted"] * 2}


def skirt(pleats: str, **parameters: float) -> Pattern:
    return draft_pattern("pleated-skirt", pleats=pleats, **parameters)


@pytest.fixture(scope="module", params=KINDS)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def pattern(kind):
    return skirt(kind)


@pytest.fixture(scope="module")
def image(pattern):
    return encode(pattern)


def assert_back(pattern, image):
    for found, any_pose in ((decode(image), False), (decode(image.to_channels()), True)):
        result = compare_patterns(pattern, found, any_pose=any_pose)
        assert result.success, result.reasons


def test_each_kind_comes_back(kind, pattern, image):
    assert_back(pattern, image)
    found = decode(image)
    assert len(found.pleats) == 4
    for panel in ("skirt_front", "skirt_back"):
        own = [pleat for pleat in found.pleats if pleat.panel == panel]
        own.sort(key=lambda pleat: -found.curve(pleat.sides[0]).end[0])
        assert [pleat.fold for pleat in own] == FROM_PLUS_X[kind]
    depth = pattern.pleats[0].pressed
    assert all(abs(pleat.pressed - depth) < 0.5 for pleat in found.pleats)


def test_the_cloth_goes_on_across_creases(pattern, image):
    assert (image.edge_type == EdgeType.CREASE).any()
    assert image.layers == 2
    plain = replace(
        image, edge_type=np.where(image.edge_type == EdgeType.CREASE, 0, image.edge_type)
    )
    assert len(decode(plain).panels) == len(pattern.panels)
    assert not decode(plain).pleats


def test_a_pleat_that_is_not_pressed_needs_no_second_contract(pattern):
    sewn = encode(replace(pattern, pleats=()))
    assert sewn.contract == 1
    assert len(decode(sewn).stitches) == len(pattern.stitches)


def test_a_mirrored_image_has_mirrored_pleats(kind, image):
    channels = image.to_channels()
    mirrored = decode(mirrored_channels(channels[None])[0])
    folds = sorted(pleat.fold for pleat in mirrored.pleats)
    assert folds == sorted(pleat.fold for pleat in decode(channels).pleats)


def test_one_knife_pleat_is_mirrored_to_the_other_side():
    pattern = skirt("knife")
    one = replace(pattern, pleats=pattern.pleats[:1])
    channels = encode(one).to_channels()
    (before,) = decode(channels).pleats
    (after,) = decode(mirrored_channels(channels[None])[0]).pleats
    assert {before.fold, after.fold} == {"left", "right"}
    assert after.pressed == pytest.approx(before.pressed, abs=0.1)


@pytest.mark.parametrize("other", [3.0, -3.0])
def test_a_pleat_that_is_pressed_farther_comes_back_so(kind, pattern, other):
    deeper = replace(
        pattern,
        pleats=tuple(replace(p, pressed=p.pressed + other) for p in pattern.pleats),
    )
    found = decode(encode(deeper).to_channels())
    assert all(abs(p.pressed - deeper.pleats[0].pressed) < 1.0 for p in found.pleats)
    result = compare_patterns(pattern, found, any_pose=True)
    assert not result.success and "pressed for" in result.reasons[0]


def test_another_fold_is_another_garment(pattern, image):
    found = decode(image)
    first = found.pleats[0]
    other = "box" if first.fold == "inverted" else "inverted"
    changed = replace(found, pleats=(replace(first, fold=other), *found.pleats[1:]))
    assert not compare_patterns(pattern, changed).success
    assert not compare_patterns(pattern, replace(found, pleats=found.pleats[1:])).success


def test_full_repair_leaves_creases_alone_and_drops_those_that_float(pattern):
    image = encode(pattern, 32)
    repaired, report = repair(image)
    assert repaired.same_channels(image) and not report.changed
    types = image.edge_type.copy()
    layer, row, col = np.argwhere(_deep_inside(image))[0]
    types[layer, 0, row, col] = EdgeType.CREASE
    repaired, report = repair(replace(image, edge_type=types))
    assert repaired.same_channels(image)
    assert report.counts == {"creases dropped": 1}


def _deep_inside(image):
    """Cells with no grid edge of any type but `NON_BOUNDARY` about them."""
    free = np.zeros_like(image.inside)
    walls = (image.edge_type != EdgeType.NON_BOUNDARY).any(axis=1) | ~image.inside
    for layer, row, col in np.argwhere(image.inside):
        around = walls[layer, max(row - 2, 0) : row + 3, max(col - 2, 0) : col + 3]
        free[layer, row, col] = not around.any()
    return free


def test_soft_shares_keep_creases(pattern, image):
    channels = image.to_channels()
    types = channels.reshape(2, 26, *channels.shape[1:])[:, 2:18]
    types *= 0.9
    types += 0.1 / 8
    assert_back_soft = decode(channels, kind="shares")
    assert compare_patterns(pattern, assert_back_soft, any_pose=True).success


def test_contract_1_has_no_creases(image):
    with pytest.raises(ImageError, match="creases; choose contract 2"):
        image.to_channels(1)


def test_files_keep_pleats(tmp_path, pattern, image):
    save_pattern(pattern, tmp_path / "skirt.json")
    assert load_pattern(tmp_path / "skirt.json").pleats == pattern.pleats
    save_image(image, tmp_path / "skirt.npz")
    assert load_image(tmp_path / "skirt.npz") == image


def test_a_panel_drawn_the_other_way_round_keeps_its_pleats(pattern):
    names = [panel.name for panel in pattern.panels]
    again = turned_round(turned_round(pattern, names), names)
    assert again.pleats == pattern.pleats


def test_a_pleat_pressed_beyond_its_cloth_is_refused_by_name(pattern):
    wrong = replace(pattern, pleats=(replace(pattern.pleats[0], pressed=300.0),))
    with pytest.raises(EncodeError, match=r"'skirt_front' is pressed for 300\.0 cm, beyond"):
        encode(wrong)


@settings(max_examples=8)
@given(seed=st.integers(0, 1000))
def test_random_pleated_skirts_come_back(seed):
    (made,) = sample("pleated-skirt", 1, seed)
    try:
        image = encode(made.pattern, 32)
    except EncodeError:
        reject()
    assert_back(made.pattern, image)
