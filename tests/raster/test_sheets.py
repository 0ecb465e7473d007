"""Cloth that lies on cloth: panels of an outer cloth layer are drawn on a second sheet."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings, strategies as st

from garmentimage import (
    EncodeError,
    GarmentImageError,
    ImageError,
    decode,
    draft_pattern,
    encode,
    load_image,
    save_image,
)
from garmentimage.compare import compare_patterns
from garmentimage.compare.validation import structure_faults
from garmentimage.draft import KINDS
from garmentimage.raster import EdgeType, GarmentImage, mirrored_channels, with_contract
from garmentimage.raster.repair import repair
from tests.overlaps import overlapping
from tests.raster.mirror import mirrored_pattern

slowly = settings(max_examples=8)


def on_sheets(pattern, outer):
    """The pattern, the panels of these names on cloth layer 1."""
    panels = tuple(replace(p, cloth_layer=int(p.name in outer)) for p in pattern.panels)
    return replace(pattern, panels=panels)


@pytest.fixture(scope="module")
def jacket():
    return overlapping(draft_pattern("jacket"))


@pytest.fixture(scope="module")
def image(jacket):
    return encode(jacket)


def assert_back(pattern, image):
    """The same from marks and from the channels alone, cloth layers too where there are marks."""
    found = decode(image)
    result = compare_patterns(pattern, found)
    assert result.success, result.reasons
    layers = {panel.name: panel.cloth_layer for panel in found.panels}
    assert layers == {panel.name: panel.cloth_layer for panel in pattern.panels}
    bare = decode(image.to_channels())
    result = compare_patterns(pattern, bare, any_pose=True)
    assert result.success, result.reasons
    assert sorted(p.cloth_layer for p in bare.panels) == sorted(layers.values())


def test_overlapping_fronts_come_back_each_on_its_cloth_layer(jacket, image):
    assert image.layer_names == ("front", "back", "front-2", "back-2")
    assert image.grid == 16
    both = image.inside[0] & image.inside[2]
    assert both.any()  # one lies on the other
    assert_back(jacket, image)


@slowly
@given(st.sampled_from(sorted(KINDS)), st.data())
def test_any_panels_of_a_garment_may_lie_on_the_outer_sheet(kind, data):
    pattern = draft_pattern(kind)
    assume(not any(panel.cloth_layer for panel in pattern.panels))
    names = [panel.name for panel in pattern.panels]
    outer = data.draw(st.sets(st.sampled_from(names), max_size=len(names) - 1))
    garment = on_sheets(pattern, outer)
    try:
        found = encode(garment)
    except EncodeError:  # two seams between sheets would share a grid edge
        reject()
    assert_back(garment, found)
    assert len(found.inside) == (4 if outer else 2)


def test_a_mirrored_garment_has_the_mirrored_image_on_every_layer(jacket, image):
    mirrored = encode(mirrored_pattern(jacket)).to_channels()[None]
    np.testing.assert_allclose(mirrored, mirrored_channels(image.to_channels()[None]), atol=1e-4)


@pytest.mark.parametrize("kind", ["tee", "top-pants"])
def test_a_symmetric_garment_has_a_symmetric_image_on_every_layer(kind):
    pattern = draft_pattern(kind)
    outer = {p.name for p in pattern.panels if "sleeve" in p.name or p.name.startswith("back")}
    inside = encode(on_sheets(pattern, outer)).inside
    assert outer and inside[2:].any()
    assert np.array_equal(inside, inside[..., ::-1])


def test_only_distinct_cloth_layers_count(jacket, image):
    """A coat all of cloth layer 3 is a coat; what is beneath may have no cloth layer 0."""
    raised = replace(
        jacket,
        panels=tuple(replace(p, cloth_layer=2 + 3 * p.cloth_layer) for p in jacket.panels),
    )
    assert encode(raised).same_channels(image)


def test_a_third_cloth_layer_is_refused_by_the_name_of_its_panel(jacket):
    back = replace(jacket.by_name["back"], cloth_layer=2)
    panels = tuple(back if p.name == "back" else p for p in jacket.panels)
    with pytest.raises(EncodeError, match="leave out panel 'back' of cloth layer 2"):
        encode(replace(jacket, panels=panels))


def test_files_keep_the_second_sheet(image, tmp_path):
    save_image(image, tmp_path / "jacket.npz")
    assert load_image(tmp_path / "jacket.npz") == image


def test_contract_1_refuses_seams_between_sheets(image):
    with pytest.raises(ImageError, match="seams between sheets"):
        image.to_channels(1)
    with pytest.raises(ImageError, match="seams between sheets"):
        with_contract(image.to_channels(), 1)


def test_a_correct_image_is_not_repaired(image):
    same, report = repair(image)
    assert same is image and not report.changed
    from_array, report = repair(image.to_channels())
    assert from_array.same_channels(image) and not report.changed


def test_a_sheet_seam_without_its_other_side_is_left_open(image):
    """What is sewn to nothing is not sewn; the rest of the garment stays as it is."""
    types = image.edge_type.copy()
    types[2:][types[2:] == EdgeType.SHEET] = EdgeType.NON_STITCH
    found, report = repair(replace(image, edge_type=types))
    assert report.counts["inconsistent edge types"] > 0
    assert not (found.edge_type == EdgeType.SHEET).any()
    changed = found.edge_type != types
    assert (types[changed] == EdgeType.SHEET).all()
    assert (found.edge_type[changed] == EdgeType.NON_STITCH).all()
    assert np.array_equal(found.inside, image.inside)


@settings(max_examples=15)
@given(st.integers(0, 10**6))
def test_random_numbers_on_four_layers_give_a_valid_garment_or_an_error(seed):
    random = np.random.default_rng(seed)
    channels = random.normal(0, 3, (104, 8, 8))
    channels[:, :1] = channels[:, -1:] = -5
    try:
        pattern = decode(channels)
    except GarmentImageError:
        return
    assert structure_faults(pattern) == []


def test_an_image_of_four_layers_is_shown_with_its_seams_between_sheets(image):
    from matplotlib.figure import Figure

    from garmentimage.render.flat.garment_image import draw_image

    axes = Figure().subplots()
    draw_image(image, axes)
    assert "other sheet" in {text.get_text() for text in axes.texts}


def test_an_image_from_channels_names_its_layers(image):
    assert GarmentImage.from_channels(image.to_channels()).layer_names == image.layer_names
