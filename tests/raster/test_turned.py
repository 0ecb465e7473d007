"""Collars and lapels: panels sewn right side to wrong side are laid open, and folded over again."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import ImageError, Pattern, PatternError, decode, draft_pattern, encode
from garmentimage.compare import compare_patterns
from garmentimage.pattern import fold_over, lay_open
from garmentimage.raster import load_image, save_image
from garmentimage.raster.repair import repair
from tests.lapels import moebius, with_lapels
from tests.raster.mirror import mirrored_pattern, mirrored_types

LAPELS = {"left_lapel", "right_lapel"}
depths = st.floats(4.0, 12.0)
slowly = settings(max_examples=5)


def folded(pattern: Pattern) -> set[tuple[str, str]]:
    """Turned panels, and what each is folded onto."""
    layer = {panel.name: panel.cloth_layer for panel in pattern.panels}
    pairs = [{s.a.panel, s.b.panel} for s in pattern.stitches if s.same_direction]
    return {(max(pair, key=layer.get), min(pair, key=layer.get)) for pair in pairs}


@pytest.fixture(scope="module")
def jacket():
    return with_lapels(draft_pattern("jacket"))


@slowly
@given(depths)
def test_a_jacket_with_lapels_comes_back_with_marks_and_from_channels_alone(depth):
    garment = with_lapels(draft_pattern("jacket"), depth)
    image = encode(garment)
    assert image.contract == 2
    for found, any_pose in ((decode(image), False), (decode(image.to_channels()), True)):
        result = compare_patterns(garment, found, any_pose=any_pose)
        assert result.success, result.reasons
        assert folded(found) == {("left_lapel", "left_front"), ("right_lapel", "right_front")} or (
            any_pose and len(folded(found)) == 2
        )
        assert sum(panel.cloth_layer for panel in found.panels) == 2


def test_only_lapels_are_turned(jacket):
    image = encode(jacket)
    names = {mark.name for mark in image.marks if image.turned[mark.layer, *mark.cell]}
    assert names == LAPELS
    assert not image.turned[1].any()
    assert not (image.turned & ~image.inside).any()


def test_decoded_again_and_again_a_lapel_stays_folded_outside(jacket):
    found = decode(encode(jacket).to_channels())
    assert encode(found).contract == 2
    lapels = [panel for panel in found.panels if panel.cloth_layer]
    for panel in lapels:
        front = next(
            found.by_name[b.panel]
            for s in found.stitches
            for a, b in (s.sides, s.sides[::-1])
            if a.panel == panel.name
        )
        assert panel.translation[2] > front.translation[2]
        faces = [each.matrix[2, 2] * np.sign(each.outline.area) for each in (panel, front)]
        assert faces[0] > 0.9 and faces[1] > 0.9  # both right side out


def test_a_mirrored_jacket_gives_the_mirrored_image(jacket):
    image = encode(jacket)
    again = encode(mirrored_pattern(jacket))
    inside, bottom, left = mirrored_types(image)
    assert np.array_equal(again.inside, inside)
    assert np.array_equal(again.turned, image.turned[..., ::-1])
    assert np.array_equal(again.edge_type[:, 0], bottom)
    assert np.array_equal(again.edge_type[:, 1], left)


@slowly
@given(depths)
def test_laid_open_and_folded_over_a_garment_is_as_before(depth):
    garment = with_lapels(draft_pattern("jacket"), depth)
    opened = lay_open(garment)
    assert opened.turned == LAPELS
    assert not any(stitch.same_direction for stitch in opened.pattern.stitches)
    again = fold_over(opened.pattern, opened.turned, opened.turned, lift=0.0)
    assert again.stitches == garment.stitches
    for before, after in zip(garment.panels, again.panels, strict=True):
        ours, theirs = (p.to_world(np.array(p.outline.vertices)) for p in (before, after))
        assert {tuple(v) for v in ours.round(6)} == {tuple(v) for v in theirs.round(6)}


def test_plain_garments_are_laid_open_already():
    tee = draft_pattern("tee")
    assert lay_open(tee).pattern is tee


def test_a_twist_that_no_cloth_can_have_is_refused_by_the_names_of_its_panels():
    with pytest.raises(PatternError, match="'a' and 'b' are sewn with a twist"):
        encode(moebius())


def test_files_of_turned_garments_come_back_and_older_formats_refuse_them(jacket, tmp_path):
    image = encode(jacket)
    save_image(image, tmp_path / "jacket.npz")
    assert load_image(tmp_path / "jacket.npz") == image
    with pytest.raises(ImageError, match="no place for panels that wrap round or are turned"):
        save_image(image, tmp_path / "jacket.npy")
    with pytest.raises(ImageError, match="contract 1 has no channels for panels that are turned"):
        image.to_channels(1)


def test_a_panel_is_turned_as_a_whole_by_what_most_of_its_cells_say(jacket):
    image = encode(jacket)
    shares = image.to_channels().reshape(2, 26, 16, 16).clip(0.01, 0.99)
    shares[:, 18:] = image.deformation.reshape(2, 8, 16, 16)
    row, col = np.argwhere(image.turned[0])[0]
    shares[0, 1, row, col] = 0.4
    repaired, report = repair(shares.reshape(52, 16, 16), kind="shares")
    assert np.array_equal(repaired.turned, image.turned)
    assert report.counts == {"turned flags": 1}
    for level in ("none", "paper"):
        found = decode(shares.reshape(52, 16, 16), repair=level, kind="shares")
        assert len(folded(found)) == 2
