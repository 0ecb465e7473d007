"""Pictures to images: the three networks of the cascade, and what they learn from."""

from dataclasses import replace

import pytest
import torch

from garmentimage.errors import DatasetError
from garmentimage.learn.data.images import load_split
from garmentimage.learn.models.cascade import (
    PAPER_CONFIG,
    Cascade,
    CascadeConfig,
    adjust_logits,
    flag_noise,
    type_noise,
)
from garmentimage.learn.weights import load_weights

SMALL = CascadeConfig(channels=(16, 16, 16))


@pytest.mark.slow
def test_pictures_stand_as_rasters_do(pictured):
    garments = load_split(pictured, "train").garments
    coloured = (garments.images().amin(1) < 0.97).float()
    rows = torch.arange(128.0)[:, None]
    middle = (coloured * rows).sum((1, 2)) / coloured.sum((1, 2))
    cells = garments.inside[:, 0].float()
    cloth = (cells * torch.arange(16.0)[:, None]).sum((1, 2)) / cells.sum((1, 2))
    assert (middle > 50).all() and (cloth > 5).all()  # neither stands on its head


@pytest.mark.slow
def test_types_are_left_out_of_an_album(pictured):
    all_types = set(load_split(pictured, "train").types)
    assert all_types == {"one-panel dress", "one-panel dress with sleeves", "top + pants"}
    kept = load_split(pictured, "train", without=["top + pants"])
    assert set(kept.types) == all_types - {"top + pants"} and len(kept.garments) == len(kept.ids)
    with pytest.raises(DatasetError, match="its split 'train' has no rows"):
        load_split(pictured, "train", without=all_types)


@pytest.mark.slow
@pytest.mark.parametrize("config", [SMALL, PAPER_CONFIG])
def test_a_cascade_learns_a_few_garments_by_heart(pictured, config):
    torch.manual_seed(0)
    batch = load_split(pictured, "train").garments.batch(torch.arange(6))
    model = Cascade(
        CascadeConfig(
            channels=(24, 24, 24),
            squared_losses=config.squared_losses,
            label_noise=0.0,
            waist_mix=0.0,
            recolour=0.0,
        )
    )
    optimizer = torch.optim.AdamW(model.parameters(), 4e-3)
    first = model(batch)["loss"].item()
    for _ in range(60):
        loss = model(batch)["loss"]
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    assert loss.item() < 0.15 * first
    found = model.eval().predict(batch.images()).unflatten(1, (2, 17))
    right = (found[:, :, 0] > 0.5) == batch.inside.bool()
    assert right.float().mean() > 0.98


def test_a_cascade_gives_channels_and_comes_back_from_disk(tmp_path):
    torch.manual_seed(0)
    model = Cascade(SMALL).eval()
    model.save_pretrained(tmp_path)
    seen = torch.rand(2, 3, 128, 128)
    with torch.no_grad():
        found, again = model.predict(seen), load_weights(Cascade, tmp_path).predict(seen)
    assert found.shape == (2, 34, 16, 16) and torch.equal(found, again)
    shares = found.unflatten(1, (2, 17))[:, :, 1:5].sum(2)
    assert torch.allclose(shares, torch.ones_like(shares), atol=1e-5)


def test_evened_shares_are_those_of_a_network_that_was_taught_without_the_weight():
    shares = torch.tensor([0.7, 0.1, 0.0, 0.2])
    weights = torch.tensor([1.0, 3.0, 3.0, 3.0])
    taught = weights * shares / (weights * shares).sum()  # where weighted cross-entropy is least
    logits = taught.log().clamp(min=-50)[:, None, None].expand(4, 16, 16).repeat(4, 1, 1)[None]
    found = adjust_logits(logits, 3.0).unflatten(1, (4, 4)).softmax(2)
    assert torch.allclose(found, shares[:, None, None].expand_as(found), atol=1e-6)


def test_a_cascade_in_use_gives_freed_shares():
    torch.manual_seed(0)
    plain = Cascade(replace(SMALL, adjust_logits=False)).eval()
    freed = Cascade(SMALL).eval()
    freed.load_state_dict(plain.state_dict())
    seen = torch.rand(1, 3, 128, 128)
    with torch.no_grad():
        before, after = (
            each.predict(seen).unflatten(1, (2, 17))[:, :, 1:5] for each in (plain, freed)
        )
    odds = (before[:, :, 1:] / before[:, :, :1]) / (after[:, :, 1:] / after[:, :, :1])
    assert torch.allclose(odds, torch.full_like(odds, SMALL.boundary_weight), rtol=1e-3)


def test_noise_changes_a_share_of_boundaries_and_nothing_else():
    torch.manual_seed(0)
    flags = torch.zeros(50, 2, 16, 16)
    flags[:, :, 4:12, 4:12] = 1
    changed = flag_noise(flags, 0.1) != flags
    assert not changed[:, :, 6:10, 6:10].any() and not changed[:, :, :3].any()
    assert 0.05 < changed[:, :, 4, 4:12].float().mean() < 0.15
    types = torch.zeros(50, 4, 4, 16, 16)
    types[:, :, 0] = 1
    types[:, :, 0, 5], types[:, :, 2, 5] = 0, 1
    found = type_noise(types.flatten(1, 2), 0.2).unflatten(1, (4, 4))
    assert torch.equal(found.sum(2), torch.ones(50, 4, 16, 16))
    wrong = (found != types).any(2)
    assert not wrong[:, :, :5].any() and 0.1 < wrong[:, :, 5].float().mean() < 0.2
