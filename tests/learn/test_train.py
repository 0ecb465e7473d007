"""Training: the same for a seed, resumed after a stop, with errors that name what went wrong."""

import json
import pickle
from dataclasses import replace

import pytest
import torch

from garmentimage.errors import LearnError
from garmentimage.learn.data.pattern_vectors import build_vocabulary, read_patterns, to_vectors
from garmentimage.learn.data.rasters import read_rasters
from garmentimage.learn.models.garment_vae import GarmentVAE, GarmentVAEConfig, vae_config
from garmentimage.learn.models.vector_vae import VectorVAE, VectorVAEConfig
from garmentimage.learn.settings import TrainingSettings
from garmentimage.learn.training import fitting_precision, train

TINY = GarmentVAEConfig(channels=(16, 16, 16), latent=8)
SHORT = TrainingSettings(epochs=3, batch=16)


class Stopped(Exception):
    pass


def run(data, folder, settings=SHORT, progress=lambda line: None):
    torch.manual_seed(settings.seed)
    train_set, held_out = (read_rasters(data, split).rasters for split in ("train", "validation"))
    model = GarmentVAE(TINY)
    return train(
        model,
        train_set,
        held_out,
        folder=folder,
        settings=settings,
        facts={"network": "tiny"},
        progress=progress,
    )


def weights(trained) -> torch.Tensor:
    return torch.cat([value.flatten() for value in trained.model.parameters()])


@pytest.mark.slow
def test_a_stopped_run_goes_on_to_the_same_weights(data, tmp_path):
    whole = run(data, tmp_path / "whole")

    def stop(line):
        if line["epoch"] == 2:
            raise Stopped

    with pytest.raises(Stopped):
        run(data, tmp_path / "cut", progress=stop)
    again = run(data, tmp_path / "cut")
    assert torch.equal(weights(whole), weights(again))
    assert [line["epoch"] for line in again.log] == [1, 2, 3]
    assert whole.log[-1]["loss"] < whole.log[0]["loss"]
    lines = (tmp_path / "cut" / "log.jsonl").read_text().splitlines()
    assert json.loads(lines[1])["loss"] == whole.log[1]["loss"]
    assert (tmp_path / "cut" / "curves.png").read_bytes().startswith(b"\x89PNG")
    assert list((tmp_path / "cut" / "tensorboard").iterdir())


@pytest.mark.slow
def test_a_network_learns_at_lower_precision(data, tmp_path):
    told = run(data, tmp_path, replace(SHORT, precision="bf16-mixed")).log
    assert told[-1]["held-out loss"] < told[0]["held-out loss"]


def test_precision_is_mixed_only_where_the_hardware_computes_it(monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    for able, precision in (({"avx512_bf16": True}, "bf16-mixed"), ({"avx2": True}, "32-true")):
        monkeypatch.setattr(torch.cpu, "get_capabilities", lambda able=able: able)
        assert fitting_precision("cpu") == fitting_precision("auto") == precision
    assert fitting_precision("mps") == "32-true"


@pytest.mark.slow
def test_another_run_in_the_same_folder_is_refused(data, tmp_path):
    run(data, tmp_path, replace(SHORT, epochs=1))
    with pytest.raises(LearnError, match="holds a run with other settings"):
        run(data, tmp_path, replace(SHORT, epochs=1, seed=1))
    (tmp_path / "run.json").write_text("[")
    with pytest.raises(LearnError, match=r"run\.json: is damaged"):
        run(data, tmp_path, replace(SHORT, epochs=1))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "damage", "sentence"),
    [
        ("checkpoint.ckpt", b"PK", r"checkpoint\.ckpt: is damaged"),
        ("checkpoint.ckpt", pickle.dumps([1]), r"checkpoint\.ckpt: is damaged"),
        ("log.jsonl", b"{", r"log\.jsonl: is damaged"),
        ("log.jsonl", b"{}\n", r"log\.jsonl: is damaged"),
        ("run.json", None, "holds a checkpoint of an unknown run"),
        ("run.json", b'{"run": {}}', r"run\.json: is damaged"),
    ],
)
def test_damaged_runs_are_told_by_file(data, tmp_path, name, damage, sentence):
    run(data, tmp_path, replace(SHORT, epochs=1))
    if damage is None:
        (tmp_path / name).unlink()
    else:
        (tmp_path / name).write_bytes(damage)
    with pytest.raises(LearnError, match=sentence) as told:
        run(data, tmp_path, replace(SHORT, epochs=1))
    assert "weights_only" not in str(told.value)


@pytest.mark.slow
def test_an_accelerator_that_is_not_there_leaves_no_run(data, tmp_path):
    folder = tmp_path / "run"
    if not torch.cuda.is_available():
        with pytest.raises(LearnError, match="cannot train on this machine"):
            run(data, folder, replace(SHORT, accelerator="cuda"))
        assert not folder.exists()
    (folder / "model").parent.mkdir()
    (folder / "model").write_text("mine")
    with pytest.raises(LearnError, match="model: already exists and is not ours"):
        run(data, folder, SHORT)


@pytest.mark.slow
def test_a_loss_that_is_no_number_is_told(data, tmp_path):
    known = read_rasters(data, "train").rasters
    known.vectors[:, 0, 8, 8] = float("nan")
    known.inside[:, 0, 8, 8] = 1
    with pytest.raises(LearnError, match="the loss is NaN or infinite in epoch 1"):
        train(GarmentVAE(TINY), known, known, folder=tmp_path, settings=SHORT, facts={})


@pytest.mark.slow
def test_a_network_learns_a_few_garments_by_heart(data):
    torch.manual_seed(0)
    few = read_rasters(data, "train").rasters.batch(torch.arange(6))
    model = GarmentVAE(GarmentVAEConfig(channels=(32, 32, 32), beta=0.0))
    optimizer = torch.optim.AdamW(model.parameters(), 3e-3)
    first = float(model(few)["loss"].detach())
    for _ in range(150):
        optimizer.zero_grad()
        model(few)["loss"].backward()
        optimizer.step()
    last = {name: float(value.detach()) for name, value in model(few).items()}
    assert last["loss"] < 0.1 * first
    assert last["flags"] < 0.02 and last["types"] < 0.1


def test_networks_take_the_grids_that_they_are_for():
    for grid in (16, 32):
        model = GarmentVAE(vae_config(grid))
        mean, log_variance = model.encode(torch.zeros(2, 34, grid, grid))
        assert mean.shape == log_variance.shape == (2, 32)
        assert model.decode(mean).shape == (2, 34, grid, grid)
    with pytest.raises(LearnError, match="networks are for N = 16 or 32"):
        vae_config(24)


def test_a_vector_vae_tells_every_vertex_of_every_panel(data):
    patterns = read_patterns(data, "validation")
    words = build_vocabulary(patterns)
    batch = to_vectors(patterns, words)
    torch.manual_seed(0)
    model = VectorVAE(VectorVAEConfig(len(words.panels), words.vertices, width=32, layers=1))
    assert all(torch.isfinite(value) for value in model(batch).values())
    numbers, there = model.decode(model.encode(batch)[0])
    assert numbers.shape == batch.numbers.shape and there.shape == batch.is_present.shape
