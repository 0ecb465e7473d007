"""Every network from one command: trained, resumed, kept with its card."""

import json
from dataclasses import replace

import pytest
import torch

from garmentimage.cli.app import main
from garmentimage.cli.train import ABLATIONS, BASELINES
from garmentimage.learn.models.cascade import PAPER_CONFIG, Cascade, CascadeConfig
from garmentimage.learn.models.slot_networks import SLOT_NETWORKS
from garmentimage.learn.tasks import TaskOptions, task_for
from garmentimage.learn.weights import load_weights


def train(*words) -> int:
    return main(["train", *map(str, words), "--batch", "16"])


@pytest.mark.slow
@pytest.mark.parametrize("name", SLOT_NETWORKS)
def test_a_baseline_is_trained_and_read_again(name, pictured, tmp_path, capsys):
    run = tmp_path / "run"
    words = [name, "--data", pictured, "--without", "top + pants", "--epochs", 2, "-o", run]
    assert train(*words) == 0 and "trained, " in capsys.readouterr().out
    told = json.loads((run / "run.json").read_text())["run"]
    assert told["without"] == ["top + pants"]
    assert not any("pants" in panel for panel in told["config"]["names"])
    model = load_weights(SLOT_NETWORKS[name].network, run / "model")
    found = model.predict(torch.rand(2, 3, 128, 128))
    assert found.edges.shape == (2, len(model.config.names), model.config.edges, 6)
    card = (run / "model" / "README.md").read_text()
    assert "--without 'top + pants'" in card and "small image encoder" in card
    assert train(*words) == 0  # nothing is left to do


@pytest.mark.slow
def test_a_cascade_as_in_the_paper_leaves_out_what_is_ours(pictured, tmp_path):
    told = {
        part: task_for("cascade", TaskOptions(data=pictured, ablate=(part,))).config
        for part in ABLATIONS
    }
    ours = CascadeConfig()
    assert told["losses"].squared_losses and told["losses"].label_noise == ours.label_noise
    assert told["noise"].label_noise == 0 and not told["noise"].squared_losses
    assert told["weights"].boundary_weight == 1 and told["weights"].label_noise == ours.label_noise
    assert not told["mirror"].mirror and told["mirror"].dropout == ours.dropout
    assert told["dropout"].dropout == 0 and told["dropout"].mirror
    assert told["recombine"].waist_mix == 0 and told["recombine"].recolour
    assert not told["recolour"].recolour and told["recolour"].waist_mix
    words = ["cascade", "--data", pictured, "--epochs", 1, "--ablate", "all"]
    assert train(*words, "-o", tmp_path) == 0
    trained = load_weights(Cascade, tmp_path / "model").config
    assert replace(trained, grid=PAPER_CONFIG.grid) == PAPER_CONFIG


@pytest.mark.slow
def test_a_resnet_from_disk_looks_at_the_pictures(pictured, tmp_path):
    from transformers import ResNetConfig, ResNetModel

    torch.manual_seed(1)
    small = ResNetModel(
        ResNetConfig(embedding_size=8, hidden_sizes=[8, 8, 16, 24], depths=[1, 1, 1, 1])
    )
    small.save_pretrained(tmp_path / "resnet")
    run = tmp_path / "run"
    words = ["panel-pool", "--data", pictured, "--epochs", 1, "--resnet", tmp_path / "resnet"]
    assert train(*words, "--rate", 1e-9, "-o", run) == 0
    model = load_weights(SLOT_NETWORKS["panel-pool"].network, run / "model")
    kept, given = model.image_encoder.resnet.state_dict(), small.state_dict()
    assert all(torch.allclose(kept[n], given[n], atol=1e-4) for n in given if "conv" in n)
    assert "ResNet that was given" in (run / "model" / "README.md").read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["vae", "--without", "shirt"], "there is no option '--without'"),
        (["panel-pool", "--ablate", "all"], "there is no option '--ablate'"),
        (["cascade", "--ablate", "noises"], "--ablate is 'noises'; did you mean noise"),
        (["cascade", "--beta", "1"], "there is no option '--beta'"),
        (["cascade", "--resnet", "x"], "there is no option '--resnet'"),
        (["unet"], "there is no network 'unet'"),
    ],
)
def test_options_that_a_network_does_not_have_are_refused(words, message, tmp_path, capsys):
    assert main(["train", *words, "--data", str(tmp_path), "-o", str(tmp_path / "run")]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_a_folder_that_holds_no_resnet_is_refused(pictured, tmp_path, capsys):
    words = ["panel-pool", "--data", pictured, "-o", tmp_path / "run", "--resnet", tmp_path]
    assert train(*words) == 2 and "holds no ResNet; give a folder" in capsys.readouterr().err


def test_the_command_knows_all_baselines():
    assert set(BASELINES) == set(SLOT_NETWORKS)
