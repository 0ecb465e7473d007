"""Panels that wrap round the body: one panel on both layers, whole from the channels alone."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import GarmentImageError, ImageError, Pattern, decode, draft_pattern, encode
from garmentimage.compare import compare_patterns
from garmentimage.compare.validation import structure_faults
from garmentimage.raster import (
    BodyFrame,
    EdgeType,
    GarmentImage,
    load_image,
    save_image,
    with_contract,
)
from garmentimage.raster.repair import repair
from tests.raster.mirror import mirrored_pattern, mirrored_types

slowly = settings(max_examples=5)


@pytest.fixture(scope="module")
def hoodie():
    return draft_pattern("hoodie")


@pytest.fixture(scope="module")
def image(hoodie):
    return encode(hoodie)


def test_a_hood_comes_back_whole_from_the_channels_alone(hoodie, image):
    assert image.contract == 2
    found = decode(image.to_channels())
    result = compare_patterns(hoodie, found, any_pose=True)
    assert result.success, result.reasons


@slowly
@given(st.floats(0.56, 0.72), st.floats(1.0, 7.0))
def test_hoods_of_all_sizes_come_back_whole(height, room):
    hoodie = draft_pattern("hoodie", hood_height=height, hood_room=room)
    found = decode(encode(hoodie).to_channels())
    assert compare_patterns(hoodie, found, any_pose=True).success


def test_what_was_decoded_from_channels_alone_wraps_when_it_is_encoded_again(hoodie, image):
    again = encode(decode(image.to_channels()))
    assert (again.edge_type == EdgeType.WRAP).any()
    assert compare_patterns(hoodie, decode(again), any_pose=True).success


def test_a_whole_hood_stands_at_the_side_of_the_head(image):
    found = decode(image.to_channels())
    hoods = [panel for panel in found.panels if "hood" in panel.name]
    assert len(hoods) == 2
    for panel in hoods:
        normal = panel.matrix[:, 2] * np.sign(panel.outline.area)
        assert abs(normal[2]) < 1e-6  # edge-on, neither in front nor behind
        assert normal[0] * panel.translation[0] > 0  # its right side out


def test_cut_at_wraps_the_image_is_as_in_contract_1(hoodie, image):
    cut = image.cut_at_wraps()
    assert cut.contract == 1
    wraps = image.edge_type == EdgeType.WRAP
    assert wraps.any()
    assert (cut.edge_type[wraps] == EdgeType.FRONT_TO_BACK).all()
    assert np.array_equal(cut.edge_type[~wraps], image.edge_type[~wraps])
    assert len(decode(cut.without_marks()).panels) == len(hoodie.panels) + 2
    assert compare_patterns(hoodie, decode(cut)).success  # marks join them
    assert np.array_equal(with_contract(image.to_channels(), 1), cut.to_channels(1))


def test_contract_1_refuses_wraps_and_says_how_to_cut_them(image):
    with pytest.raises(ImageError, match=r"image\.cut_at_wraps\(\)"):
        image.to_channels(1)


def test_a_mirrored_hoodie_gives_the_mirrored_image(hoodie, image):
    inside, bottom, left = mirrored_types(image)
    again = encode(mirrored_pattern(hoodie))
    assert np.array_equal(again.inside, inside)
    assert np.array_equal(again.edge_type[:, 0], bottom)
    assert np.array_equal(again.edge_type[:, 1], left)


def test_plain_garments_are_files_of_version_1_and_wraps_of_version_2(image, tmp_path):
    for name, each in (("tee", encode(draft_pattern("tee"))), ("hoodie", image)):
        save_image(each, tmp_path / f"{name}.npz")
        with np.load(tmp_path / f"{name}.npz") as archive:
            assert ("turned" in archive) == (name == "hoodie")
        assert load_image(tmp_path / f"{name}.npz") == each


def soft(image: GarmentImage, share: float) -> np.ndarray:
    """Channels of an image as shares, the right value of each with this share."""
    channels = image.to_channels(2).reshape(image.layers, 26, image.grid, image.grid).astype(float)
    types = channels[:, 2:18].reshape(image.layers, 2, 8, image.grid, image.grid)
    types[...] = types * share + (1 - types) * (1 - share) / 7
    channels[:, :2] = channels[:, :2] * share + (1 - channels[:, :2]) * (1 - share)
    return channels.reshape(-1, image.grid, image.grid)


def wrap_cells(image: GarmentImage) -> list[tuple[int, ...]]:
    """(side, row, column) of the grid edges where cloth goes on."""
    return [tuple(place) for place in np.argwhere(image.edge_type[0] == EdgeType.WRAP).tolist()]


def test_a_hole_in_a_wrap_is_closed(image):
    shares = soft(image, 0.9)
    side, row, col = wrap_cells(image)[0]
    for layer in (0, 1):
        first = 26 * layer + 2 + 8 * side
        shares[[first + EdgeType.FRONT_TO_BACK, first + EdgeType.WRAP], row, col] = 0.7, 0.28
    repaired, report = repair(shares, kind="shares")
    assert np.array_equal(repaired.edge_type, image.edge_type)
    assert report.counts["wraps made whole or dropped"] == 1


def test_a_wrap_that_the_network_is_sure_of_in_part_only_stays_a_part(image):
    given = image.edge_type.copy()
    side, row, col = wrap_cells(image)[0]
    given[:, side, row, col] = EdgeType.FRONT_TO_BACK
    certain = soft(GarmentImage(image.inside, given, image.deformation, image.frame), 0.999)
    repaired, _ = repair(certain, kind="shares")
    assert np.array_equal(repaired.edge_type, given)


def test_two_wraps_between_the_same_parts_leave_a_panel_and_not_a_tube():
    """A square in front and one behind, cloth going on at both sides: one of them is a seam."""
    inside = np.zeros((2, 8, 8), bool)
    inside[:, 2:6, 2:6] = True
    types = np.zeros((2, 2, 8, 8), np.int8)
    types[:, 0, [2, 6], 2:6] = EdgeType.NON_STITCH
    types[:, 1, 2:6, 2] = EdgeType.WRAP
    types[:, 1, 2:5, 6] = EdgeType.WRAP
    types[:, 1, 5, 6] = EdgeType.NON_STITCH
    deformation = np.zeros((2, 4, 2, 8, 8), np.float32)
    deformation[:, [0, 2], 0] = deformation[:, [1, 3], 1] = 10 * inside[:, None]
    image = GarmentImage(inside, types, deformation, BodyFrame.standard(8))
    found = decode(image.to_channels())
    (panel,) = found.panels
    assert panel.outline.area == pytest.approx(3200, rel=1e-3)
    assert [stitch.a.panel for stitch in found.stitches] == [panel.name]
    assert len(found.stitches) == 1


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["shares", "logits", "channels"]))
def test_random_channels_of_contract_2_give_a_garment_or_an_error_in_words(seed, kind):
    rng = np.random.default_rng(seed)
    channels = rng.normal(0.5, 0.5, (52, 8, 8))
    try:
        found = decode(channels, kind=kind)
    except GarmentImageError:
        return
    assert isinstance(found, Pattern)
    assert not structure_faults(found)


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_what_contract_1_says_is_read_alike_in_contract_2(seed):
    rng = np.random.default_rng(seed)
    shares = rng.dirichlet(np.ones(4), (2, 2, 8, 8)).transpose(0, 1, 4, 2, 3)
    flags, vectors = rng.random((2, 8, 8)), rng.normal(0, 10, (2, 8, 8, 8))
    old = np.concatenate([flags[:, None], shares.reshape(2, 8, 8, 8), vectors], 1)
    old = old.reshape(34, 8, 8)
    for level in ("none", "full"):
        plain, _ = repair(old, level=level, kind="shares")
        upgraded, _ = repair(with_contract(old, 2), level=level, kind="shares")
        assert plain == upgraded
