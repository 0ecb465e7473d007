"""Evaluations resume where they were stopped, and refuse records of others."""

import json
from dataclasses import replace

import pytest

from garmentimage.dataset.building import BuildSettings, build_dataset
from garmentimage.dataset.recipe import load_recipe
from garmentimage.errors import LearnError
from garmentimage.evaluate.amounts import LatentAmounts
from garmentimage.evaluate.latent import Candidate, evaluate_latent

FEW = LatentAmounts(garments=2, pairs=1, triplets=1)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A small dataset of two types of `vae-topology`, two garments of each for test."""
    folder = tmp_path_factory.mktemp("data") / "topology"
    recipe = load_recipe("vae-topology")
    build_dataset(BuildSettings(replace(recipe, types=recipe.types[:2]), folder, 40), workers=1)
    return folder


@pytest.mark.slow
def test_a_stopped_evaluation_goes_on_and_another_is_refused(data, tmp_path):
    def measure(amounts=FEW, folder=tmp_path):
        plain = Candidate("no network", "", str(data), "full")
        return evaluate_latent([plain], "vae-topology", folder, amounts, workers=1)

    figures = measure()
    assert figures["no network"]["reconstruction"]["overlap"]["mean"] > 0.97
    file = tmp_path / "edits-no-network.jsonl"
    lines = file.read_text().splitlines(keepends=True)
    file.write_text("".join(lines[:1]) + lines[1][:20])  # as a kill may leave it
    assert measure() == figures
    assert sorted(file.read_text().splitlines(keepends=True)) == sorted(lines)
    with pytest.raises(LearnError, match="holds records of other networks, data or amounts"):
        measure(LatentAmounts(garments=2, pairs=1, triplets=2))
    file.write_text("[]\n")
    with pytest.raises(LearnError, match=r"edits-no-network\.jsonl: is damaged"):
        measure()
    (tmp_path / "file").write_text("mine")
    with pytest.raises(LearnError, match="file: cannot be used"):
        measure(folder=tmp_path / "file")
    with pytest.raises(
        LearnError, match=r"its test split has .* at least 300 of two types are needed"
    ):
        measure(LatentAmounts(), tmp_path / "more")
    assert json.loads((tmp_path / "run.json").read_text())["amounts"]["garments"] == 2
