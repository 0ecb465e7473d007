"""Garments that are joined from halves of two others, and colours shown anew."""

import numpy as np
import pytest
import torch

from garmentimage.learn.data.images import ImagedGarments, load_split, waist_rows
from garmentimage.learn.data.waist_mix import mix_at_waist, recolour_cloth
from garmentimage.learn.models.cascade import ground_truth_logits
from garmentimage.learn.models.garment_vae import output_channels
from garmentimage.networks.decoded import decoded_garment


@pytest.fixture(scope="module")
def joined(pictured):
    """All training garments, and the same with halves of others where some fit."""
    torch.manual_seed(0)
    batch = load_split(pictured, "train").garments
    return batch, *mix_at_waist(batch, 1.0)


@pytest.mark.slow
def test_a_new_garment_has_one_half_of_its_own_and_one_of_another(joined):
    batch, found, new = joined
    assert new.float().mean() > 0.5
    kept = (found.inside == batch.inside).all(3).all(1)  # by row of the grid
    kept_upper, kept_lower = kept[:, 9:].all(1), kept[:, :8].all(1)
    assert (kept_upper | kept_lower).all()
    same = (found.pictures == batch.pictures).all(1) & (found.cloth == batch.cloth)
    is_above = torch.arange(128)[:, None] >= found.waist[:, None]
    above, below = ((same | ~half).flatten(1).all(1) for half in (is_above, ~is_above))
    assert (above | below).all() and not (above & below)[new].all()


@pytest.mark.slow
def test_others_stay_as_they_are(joined):
    batch, found, new = joined
    torch.manual_seed(0)
    none, chosen = mix_at_waist(batch, 0.0)
    assert not chosen.any()
    for name in ("pictures", "cloth", "waist", "inside", "types", "vectors"):
        assert torch.equal(getattr(none, name), getattr(batch, name))
        assert torch.equal(getattr(found, name)[~new], getattr(batch, name)[~new])


@pytest.mark.slow
def test_new_garments_are_sewn_at_the_waist_and_decode_as_they_are(joined):
    _, found, new = joined
    channels = output_channels(ground_truth_logits(found.rasters)).numpy()
    steps = [
        decoded_garment(np.zeros(0, np.float32), channels[k], "full")
        for k in torch.where(new)[0][:24].tolist()
    ]
    for step in steps:
        names = {panel.name for panel in step.pattern.panels}
        assert "bodice_front" in names and len(names) >= 4, names
    assert all(not step.faults and not step.repairs.changed for step in steps)


def test_a_garment_without_a_seam_at_the_waist_gives_nothing():
    inside = torch.zeros(4, 2, 16, 16, dtype=torch.int8)
    inside[:, :, 4:12, 6:10] = 1
    types = torch.zeros(4, 4, 16, 16, dtype=torch.int8)
    batch = ImagedGarments(
        torch.zeros(4, 3, 128, 128, dtype=torch.uint8),
        torch.zeros(4, 128, 128, dtype=torch.bool),
        torch.full((4, 128), 78, dtype=torch.int16),
        inside,
        types,
        torch.zeros(4, 16, 16, 16, dtype=torch.float16),
    )
    assert not mix_at_waist(batch, 1.0)[1].any()
    types[0, ::2, 8, 6:10] = 3
    found, new = mix_at_waist(batch, 1.0)
    assert new.tolist() == [False, True, True, True]
    assert torch.equal(found.types[1:], types[:1].expand(3, -1, -1, -1))


def test_the_seam_is_found_in_the_map_of_panels_and_pictures_are_cut_along_it():
    panels = np.zeros((128, 128), np.uint8)
    panels[100:, 60:68] = 1  # the body
    panels[20:77, 40:90], panels[77:100, 40:90] = 2, 3
    panels[79, 50:60] = 2  # the lower panel reaches up
    panels[20:77, 65:] = np.where(panels[20:77, 65:] == 2, 4, 0)  # legs
    panels[77:79, 50:60] = 2
    rows = waist_rows(panels)
    assert rows.dtype == np.int16 and rows.shape == (128,)
    assert (rows[50:60] == 80).all() and (np.delete(rows, range(50, 60)) == 77).all()
    panels[panels > 1] = 2
    assert (waist_rows(panels) == 78).all()  # no seam
    assert (waist_rows(np.zeros((64, 64), np.uint8)) == 39).all()


def without_rasters(pictures, cloth, waist) -> ImagedGarments:
    inside, types = (torch.zeros(len(cloth), k, 16, 16, dtype=torch.int8) for k in (2, 4))
    vectors = torch.zeros(len(cloth), 16, 16, 16)
    return ImagedGarments(pictures, cloth, waist, inside, types, vectors)


def test_repainted_cloth_keeps_its_folds():
    torch.manual_seed(0)
    grey = (255 * torch.rand(20, 1, 16, 16)).to(torch.uint8).expand(-1, 3, -1, -1)
    cloth = torch.ones(20, 16, 16, dtype=torch.bool)
    waist = torch.full((20, 16), 9, dtype=torch.int16)
    batch = without_rasters(grey, cloth, waist)
    found = recolour_cloth(batch, torch.zeros(20, dtype=torch.bool), 1.0)
    assert found.min() >= 0 and found.max() <= 1
    order = grey.flatten(2).argsort(2)
    assert (found.flatten(2).gather(2, order).diff(dim=2) >= 0).all()  # lighter stays lighter
    shades = found[:, :, 0, 0]
    assert (shades.amax(1) - shades.amin(1)).max() > 0.1


def test_new_garments_have_cloth_of_two_colours_and_others_of_one():
    torch.manual_seed(0)
    grey = torch.full((40, 3, 128, 128), 150, dtype=torch.uint8)
    cloth = torch.zeros(40, 128, 128, dtype=torch.bool)
    cloth[:, 20:110, 40:90] = True
    line = 77
    waist = torch.full((40, 128), line, dtype=torch.int16)
    batch = without_rasters(grey, cloth, waist)
    new = torch.arange(40) < 20
    found = recolour_cloth(batch, new, 1.0)
    assert torch.equal(found[:, :, :20], batch.images()[:, :, :20])  # skin and page stay
    below, above = found[:, :, line - 1, 60], found[:, :, line, 60]
    assert (below != above).any(1)[new].all() and torch.equal(below[~new], above[~new])
    assert len(torch.unique(above, dim=0)) == 40
    same = torch.isclose(recolour_cloth(batch, new, 0.5), batch.images()).flatten(1).all(1)
    assert not same[new].any() and 2 <= same[~new].sum() <= 18
