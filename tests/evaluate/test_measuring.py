"""Measuring: what figures mean, edits whose answer is known, and runs that go on."""

import json

import numpy as np
import pytest

from garmentimage.draft.kind import draft_pattern
from garmentimage.evaluate.codecs import PlainCodec
from garmentimage.evaluate.edit_triplets import EDITS, sample_triplets
from garmentimage.evaluate.garment import (
    measure_garment,
    outline_distance,
    panel_overlap,
    same_graph,
    silhouette_distance,
)
from garmentimage.evaluate.latent import summarise_latent
from garmentimage.evaluate.table import latent_table

DRESS, PANTS = draft_pattern("one-panel-dress"), draft_pattern("top-pants")


def test_a_garment_is_like_itself_and_unlike_another():
    assert panel_overlap(DRESS, DRESS) == pytest.approx(1)
    assert same_graph(DRESS, DRESS) and not same_graph(DRESS, PANTS)
    assert panel_overlap(DRESS, PANTS) < 0.4 and panel_overlap(DRESS, None) == 0
    assert outline_distance(DRESS, DRESS) == 0
    apart = outline_distance(DRESS, PANTS)
    assert apart > 3 and apart == pytest.approx(outline_distance(PANTS, DRESS))


def test_silhouettes_are_compared_by_what_they_share():
    a, b = np.zeros((2, 4, 4), bool)
    a[:2], b[1:3] = True, True
    assert silhouette_distance(a, a) == 0 and silhouette_distance(a, b) == pytest.approx(2 / 3)


@pytest.mark.slow
def test_a_garment_that_is_worn_well_is_valid_and_has_a_silhouette():
    found = measure_garment(DRESS)
    assert found.valid and found.topology and found.silhouette.mean() > 0.05
    assert measure_garment(None, "no image").fault == "no image"


@pytest.mark.parametrize(
    "edit", [e for edits in EDITS.values() for e in edits], ids=lambda e: e.name
)
def test_edits_change_the_topology_and_keep_all_else(edit):
    for each in sample_triplets(edit, 3):
        words = [
            measure_garment(p, worn=False).topology for p in (each.a, each.b, each.c, each.truth)
        ]
        assert words[0] != words[1] and words[2] != words[3]
    again = [each.truth for each in sample_triplets(edit, 3)]
    assert again[-1] == each.truth


def test_figures_have_intervals_that_hold_their_mean():
    rows = [{"overlap": k / 10, "graph": True, "valid": k > 2} for k in range(10)]
    told = summarise_latent("reconstruction", [*rows, {"lost": "took longer"}])
    assert (told["measured"], told["lost"]) == (10, 1)
    assert told["overlap"]["mean"] == 0.45 and told["overlap"]["n"] == 10
    assert told["overlap"]["low"] < 0.45 < told["overlap"]["high"]
    assert told["graph"] == {"mean": 1.0, "low": 1.0, "high": 1.0, "n": 10}
    table = latent_table({"ours": {"reconstruction": told}, "theirs": {"reconstruction": {}}})
    assert "| reconstruction: graph | 1.000 (1.000 to 1.000) | - |" in table


def test_edits_without_the_intended_topology_do_not_count_for_the_overlap():
    right = {"intended": True, "overlap": 0.9, "valid": True, "becomes": "intended"}
    wrong = {"intended": False, "overlap": None, "valid": True, "becomes": "as B"}
    rows = [
        {"edit": "legs", "settled": right, "plain": wrong},
        {"edit": "legs", "settled": wrong, "plain": wrong},
    ]
    told = summarise_latent("edits", json.loads(json.dumps(rows)))
    assert told["legs, settled: intended"]["mean"] == 0.5
    assert told["legs, plain: intended"]["mean"] == 0.0
    assert told["legs, settled: overlap"] == {"mean": 0.9, "low": 0.9, "high": 0.9, "n": 1}
    assert told["legs, settled: becomes"] == {"intended": 1, "as B": 1}
    table = latent_table({"ours": {"edits": told}})
    assert "| edits: legs, settled: becomes | intended 1, as B 1 |" in table


def test_without_a_network_an_edit_of_nothing_changes_nothing():
    codec, garment = PlainCodec(16), draft_pattern("top-skirt")
    a, b = codec.latents([draft_pattern("shirt"), garment])
    step = codec.decode(b + (a - a))
    assert not step.faults and panel_overlap(garment, step.pattern) > 0.97
    assert np.array_equal(codec.reproject(a, 3), a)
