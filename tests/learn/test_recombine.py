"""Garments that are joined from halves of two others, and colours shown anew."""

import numpy as np
import pytest
import torch

from garmentimage.explore.space import step_of
from garmentimage.learn.cascade import sure_maps
from garmentimage.learn.garment_vae import to_channels
from garmentimage.learn.pictured import Pictured, read_album
from garmentimage.learn.recombine import WAIST, recoloured, recombined, repainted


@pytest.fixture(scope="module")
def joined(pictured):
    """All training garments, and the same with halves of others where some fit."""
    torch.manual_seed(0)
    batch = read_album(pictured, "train").garments
    return batch, *recombined(batch, 1.0)


@pytest.mark.slow
def test_a_new_garment_has_one_half_of_its_own_and_one_of_another(joined):
    batch, found, new = joined
    assert new.float().mean() > 0.5
    lower = {}
    for row in range(16):
        lower[row] = (found.inside[:, :, row] == batch.inside[:, :, row]).flatten(1).all(1)
    whole = torch.stack([lower[row] for row in range(16)], 1)
    kept_upper, kept_lower = whole[:, 9:].all(1), whole[:, :8].all(1)
    assert (kept_upper | kept_lower).all()
    line = round(WAIST * 128)
    same = (found.pictures == batch.pictures).all(1)
    above, below = same[:, line:].flatten(1).all(1), same[:, :line].flatten(1).all(1)
    assert (above | below).all() and not (above & below)[new].all()


@pytest.mark.slow
def test_others_stay_as_they_are(joined):
    batch, found, new = joined
    torch.manual_seed(0)
    none, chosen = recombined(batch, 0.0)
    assert not chosen.any()
    for name in ("pictures", "inside", "types", "vectors"):
        assert torch.equal(getattr(none, name), getattr(batch, name))
        assert torch.equal(getattr(found, name)[~new], getattr(batch, name)[~new])


@pytest.mark.slow
def test_new_garments_are_sewn_at_the_waist_and_decode_as_they_are(joined):
    _, found, new = joined
    channels = to_channels(sure_maps(found.rasters)).numpy()
    steps = [step_of(np.zeros(0), channels[k], "full") for k in torch.where(new)[0][:24].tolist()]
    for step in steps:
        names = {panel.name for panel in step.pattern.panels}
        assert "bodice_front" in names and len(names) >= 4, names
    assert all(not step.faults and not step.repairs.changed for step in steps)


def test_a_garment_without_a_seam_at_the_waist_gives_nothing():
    inside = torch.zeros(4, 2, 16, 16, dtype=torch.int8)
    inside[:, :, 4:12, 6:10] = 1
    types = torch.zeros(4, 4, 16, 16, dtype=torch.int8)
    batch = Pictured(
        torch.zeros(4, 3, 128, 128, dtype=torch.uint8),
        inside,
        types,
        torch.zeros(4, 16, 16, 16, dtype=torch.float16),
    )
    assert not recombined(batch, 1.0)[1].any()
    types[0, ::2, 8, 6:10] = 3
    found, new = recombined(batch, 1.0)
    assert new.tolist() == [False, True, True, True]
    assert torch.equal(found.types[1:], types[:1].expand(3, -1, -1, -1))


def test_recoloured_pictures_keep_black_and_white_and_shapes():
    torch.manual_seed(0)
    seen = torch.ones(40, 3, 8, 8)
    seen[:, :, 2:6, 2:6] = torch.tensor([0.5, 0.3, 0.2])[:, None, None]
    seen[:, :, 0] = 0
    which = torch.arange(40) < 20
    found = recoloured(seen, which)
    assert torch.equal(found[20:], seen[20:])
    assert (found[:, :, 6:] == 1).all() and found[:, :, 0].max() < 0.03
    cloth = found[:20, :, 2:6, 2:6].flatten(2)
    assert torch.equal(cloth.amin(2), cloth.amax(2))
    assert (cloth[:, 0, 0] < cloth[:, 2, 0]).any() and cloth.std(0).min() > 0.05


def test_repainted_pictures_have_other_colours_on_each_side_of_the_waist():
    torch.manual_seed(0)
    seen = torch.rand(40, 3, 128, 128)
    new = torch.arange(40) < 30
    found = repainted(seen, new)
    assert torch.equal(found[~new], seen[~new])
    line = round(WAIST * 128)
    same = torch.isclose(found, seen).all(1)
    above, below = same[:, line:].flatten(1).all(1), same[:, :line].flatten(1).all(1)
    assert {(bool(a), bool(b)) for a, b in zip(above[new], below[new])} == {
        (True, True),
        (True, False),
        (False, True),
        (False, False),
    }
