"""Patterns in slots, and the baselines that predict them from pictures."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial.distance import cdist

from garmentimage.compare import pattern_faults
from garmentimage.draft.kind import draft_pattern
from garmentimage.errors import DecodeError
from garmentimage.evaluate.garment import panel_overlap, same_graph
from garmentimage.learn.data.slot_outputs import SlotOutputs, pattern_from
from garmentimage.learn.data.slot_vectors import (
    ImagedSlots,
    SlotConfig,
    slot_vocabulary,
    to_slots,
)
from garmentimage.learn.models.slot_heads import SLOTS_PER_STEP, sample_slots, slot_losses
from garmentimage.learn.models.slot_networks import SLOT_NETWORKS

GARMENTS = [
    draft_pattern(kind, sleeves=sleeves)
    for kind in ("one-panel-dress", "top-pants")
    for sleeves in ("none", "set-in")
]
WORDS = slot_vocabulary(GARMENTS)


def said(truth) -> SlotOutputs:
    free = torch.where(truth.sewn, -9.0, 9.0)
    return SlotOutputs(truth.edges, truth.rotations, truth.translations, truth.tags, free)


def test_what_is_said_without_error_is_the_garment():
    truth = to_slots(GARMENTS, WORDS)
    assert slot_losses(said(truth), truth)["loss"].item() < 1e-3
    for number, garment in enumerate(GARMENTS):
        again = pattern_from(said(truth), number, WORDS)
        assert panel_overlap(garment, again) > 0.99 and same_graph(garment, again)
        assert not pattern_faults(again)
        for panel in garment.panels:
            other = again.by_name[panel.name]
            corners = [np.array(each.outline.vertices) for each in (panel, other)]
            placed = [each.to_world(c) for each, c in zip((panel, other), corners, strict=True)]
            assert np.allclose(placed[0], placed[1], atol=0.01)


def test_slots_keep_the_outline_of_a_panel_with_a_hole():
    whole, holed = (draft_pattern("one-panel-dress", cutout=place) for place in ("none", "front"))
    assert holed.by_name["front"].holes
    words = slot_vocabulary([whole])
    one, other = to_slots([whole], words), to_slots([holed], words)
    for name, value in vars(one).items():
        assert torch.equal(value, getattr(other, name)), name


def test_a_panel_that_stands_across_is_told_without_a_warning(recwarn):
    first, *others = GARMENTS[0].panels
    across = replace(GARMENTS[0], panels=(replace(first, rotation=(30.0, 90.0, 0.0)), *others))
    again = pattern_from(said(to_slots([across], WORDS)), 0, WORDS).by_name[first.name]
    one, two = (
        each.to_world(np.array(each.outline.vertices)) for each in (across.panels[0], again)
    )
    assert cdist(one, two).min(axis=1).max() < 0.01
    assert not recwarn.list


def test_slots_without_a_panel_are_no_garment():
    truth = to_slots(GARMENTS[:1], WORDS)
    nothing = replace(said(truth), edges=torch.zeros_like(truth.edges))
    with pytest.raises(DecodeError, match="the slots hold no panel"):
        pattern_from(nothing, 0, WORDS)


def test_slots_asked_for_weigh_like_all_of_them_in_the_mean():
    torch.manual_seed(0)
    panels = torch.zeros(64, 40, dtype=torch.bool)
    panels[:, ::8] = True
    draws = torch.stack([sample_slots(panels) for _ in range(100)])
    assert (draws[:, panels] == 1).all()
    assert abs((draws > 0).float().sum(2).mean() - SLOTS_PER_STEP) < 0.1
    assert abs((draws**2).mean() - 1) < 0.02


def test_all_slots_are_asked_for_where_there_are_few():
    panels = torch.zeros(4, SLOTS_PER_STEP, dtype=torch.bool)
    panels[:, 0] = True
    assert (sample_slots(panels) == 1).all()


@pytest.mark.parametrize("name", ["panel-transformer", "panel-recurrent"])
def test_edges_of_slots_that_are_asked_for_are_those_of_the_whole_pattern(name):
    torch.manual_seed(0)
    kind = SLOT_NETWORKS[name]
    network = kind.network(SlotConfig(name, WORDS.names, WORDS.edges, 32, 1)).eval()
    for weights in network.edge_head.parameters():
        torch.nn.init.normal_(weights)
    seen = torch.rand(2, 3, 128, 128)
    which = torch.rand(2, len(WORDS.names)) < 0.5
    some, whole = network.predict(seen, which), network.predict(seen)
    assert torch.allclose(some.edges[which], whole.edges[which], atol=1e-5)
    assert (some.edges[~which] == 0).all() and (whole.edges[~which] != 0).any()


@pytest.mark.slow
@pytest.mark.parametrize("name", SLOT_NETWORKS)
def test_a_baseline_learns_a_few_garments_by_heart(name):
    torch.manual_seed(0)
    config = SlotConfig(name, WORDS.names, WORDS.edges, 64, 1, picture=32)
    made = SLOT_NETWORKS[name].network(config)
    pictures = torch.randint(0, 256, (len(GARMENTS), 3, 32, 32), dtype=torch.uint8)
    batch = ImagedSlots(pictures, to_slots(GARMENTS, WORDS))
    made.output_prior.set_to_mean(batch.patterns)
    optimizer = torch.optim.AdamW(made.parameters(), 5e-3)
    first = made(batch)["loss"].item()
    for _ in range(100):
        losses = made(batch)
        optimizer.zero_grad()
        losses["loss"].backward()
        torch.nn.utils.clip_grad_norm_(made.parameters(), 1.0)
        optimizer.step()
    assert losses["loss"].item() < 0.5 * first
    assert losses["rotations"].item() < 0.05 and losses["translations"].item() < 0.05


@pytest.mark.parametrize("name", SLOT_NETWORKS)
def test_a_baseline_starts_from_the_mean_garment(name):
    made = SLOT_NETWORKS[name].network(SlotConfig(name, WORDS.names, WORDS.edges, 32, 1))
    truth = to_slots(GARMENTS, WORDS)
    made.output_prior.set_to_mean(truth)
    with torch.no_grad():
        found = made.predict(torch.rand(2, 3, 128, 128))
    seen = found.edges[1].any(2).any(1)  # a pool leaves out what it does not see
    assert torch.allclose(found.edges[1, seen], truth.edges.mean(0)[seen], atol=1e-5)
    assert seen.all() or name == "panel-pool"
    assert torch.allclose(found.translations[0], truth.translations.mean(0), atol=1e-5)
    assert torch.equal(found.free[0] < 0, truth.sewn.float().mean(0) > 0.5)


def test_a_pool_leaves_out_the_panels_that_it_does_not_see():
    pool = SLOT_NETWORKS["panel-pool"].network(
        SlotConfig("panel-pool", WORDS.names, WORDS.edges, 32, 1)
    )
    with torch.no_grad():
        pool.output_prior.edges.fill_(1)
        pool.presence_head.weight.zero_()
        pool.presence_head.bias[:] = torch.arange(len(WORDS.names)) - 1.5
        found = pool.predict(torch.rand(3, 3, 128, 128))
    assert not found.edges[:, :2].any() and found.edges[:, 2:].any((2, 3)).all()
