"""Picture to pattern, measured: small networks on a small dataset."""

import json
import shutil
from functools import partial

import numpy as np
import pytest
from PIL import Image

from garmentimage.cli.app import main
from garmentimage.dataset.read import read_header, shard_files
from garmentimage.errors import DatasetError
from garmentimage.evaluate.amounts import ImageAmounts
from garmentimage.evaluate.image import (
    ImageItem,
    evaluate_images,
    summarise_images,
    with_baselines,
)
from garmentimage.evaluate.predictors import Predictor, load_predictor, predictors_from_names
from garmentimage.evaluate.splits import check_splits, group_by_held_out
from garmentimage.evaluate.table import held_out_table
from garmentimage.learn.models.cascade import CascadeConfig

pytestmark = pytest.mark.slow
SMALL = ["--seen", "3", "--unseen", "4", "--parts", "2", "--draped", "1", "--workers", "1"]


@pytest.fixture(scope="module")
def runs(pictured, tmp_path_factory):
    """A small cascade under two names, as if of two seeds, and a baseline, trained for an epoch."""
    folder = tmp_path_factory.mktemp("runs")
    with pytest.MonkeyPatch.context() as patch:
        small = partial(CascadeConfig, channels=(16, 16, 16))
        patch.setattr("garmentimage.learn.models.CascadeConfig", small)
        for network, name in {"cascade": "cascade-0", "panel-pool": "panel-pool"}.items():
            words = [network, "--data", pictured, "--epochs", 1, "-o", folder / name]
            assert main(["train", *map(str, words)]) == 0
    shutil.copytree(folder / "cascade-0", folder / "cascade-1")
    return folder


@pytest.fixture(scope="module")
def measured(pictured, runs, tmp_path_factory):
    out = tmp_path_factory.mktemp("measured")
    words = ["evaluate", "image", "--data", pictured, "-o", out, *SMALL]
    for name, run in (("ours", "cascade-0"), ("ours", "cascade-1"), ("pool", "panel-pool")):
        words += ["--network", f"{name}={runs / run}"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("garmentimage.evaluate.figure.MAX_SHOWN", 1)
        assert main([*map(str, words)]) == 0
    return out, list(map(str, words))


def test_a_table_has_all_guessers_and_both_kinds_of_garments(measured):
    out, _ = measured
    figures = json.loads((out / "result.json").read_text())["figures"]
    assert set(figures) == {
        "ours", "ours, paper", "ours, none", "pool", "nearest picture", "another of its type",
        "true flags", "true flags and edge types", "true image",
    }  # fmt: skip
    for name, counts in {"ours": (3, 4), "pool": (3, 4), "true image": (2, 2)}.items():
        found = figures[name]
        assert (found["seen"]["panel_iou"]["n"], found["unseen"]["panel_iou"]["n"]) == counts
    assert figures["true image"]["unseen"]["panel_iou"]["mean"] > 0.95
    assert figures["true image"]["seen"]["topology"]["mean"] == 1
    assert len(figures["ours"]["seen"]["panel_iou by seed"]) == 2
    assert figures["another of its type"]["unseen"]["topology"]["mean"] == 1
    table = (out / "table.md").read_text()
    assert table.startswith("| | panel IoU, seen | panel IoU, unseen |")
    for name in ("seen.png", "unseen.png"):
        assert np.asarray(Image.open(out / name)).shape[1] > 1000


def test_the_log_tells_when_the_test_splits_were_opened(measured, monkeypatch):
    out, words = measured
    lines = (out / "opened.jsonl").read_text().splitlines()
    told = json.loads(lines[0])
    assert len(lines) == 1 and told["garments"]["unseen"] > 0 and told["when"].startswith("20")
    records = {f.name: f.read_bytes() for f in out.glob("*.jsonl")}
    monkeypatch.setattr("garmentimage.evaluate.draw_prediction_figures", lambda *_: None)
    assert main(words) == 0  # everything is there: nothing is opened again
    assert {f.name: f.read_bytes() for f in out.glob("*.jsonl")} == records


def count_again(folder):
    """Tell the right number of rows, as someone would who mixes splits by accident."""
    file = folder / "summary.json"
    told = json.loads(file.read_text())
    told["rows"] = sum(read_header(shard).rows for shard in shard_files(folder))
    file.write_text(json.dumps(told))


def test_splits_are_proven_to_have_nothing_in_common(pictured, tmp_path):
    told = check_splits(pictured)
    assert told["rows learnt from"] == 39 and told["unseen types"] == ["top with sleeves + pants"]
    assert told["id of split test in training"] == told["type of split unseen in training"] == 0
    mixed = tmp_path / "mixed"
    shutil.copytree(pictured, mixed)
    (test,) = shard_files(mixed, "test")
    (train,) = shard_files(mixed, "train")
    test.write_bytes(train.read_bytes())
    count_again(mixed)
    with pytest.raises(DatasetError, match="of split 'test' have the same id as garments in"):
        check_splits(mixed)
    (unseen,) = shard_files(mixed, "unseen")
    shutil.copy(shard_files(pictured, "test")[0], test)
    unseen.write_bytes(test.read_bytes())
    count_again(mixed)
    with pytest.raises(DatasetError, match="of split 'unseen' have the same type as garments in"):
        check_splits(mixed)


def test_a_network_is_not_measured_on_what_it_may_have_learnt_from(
    pictured, runs, tmp_path, capsys
):
    copied = tmp_path / "cascade"
    shutil.copytree(runs / "cascade-0", copied)
    told = json.loads((copied / "run.json").read_text())
    told["run"]["data_sha256"] = "0" * 64
    (copied / "run.json").write_text(json.dumps(told))
    words = ["evaluate", "image", "--data", str(pictured), "-o", str(tmp_path / "out"), *SMALL]
    assert main([*words, "--network", str(copied)]) == 2
    assert "was not trained on the dataset of this evaluation" in capsys.readouterr().err


def test_a_type_held_out_is_measured_as_unseen_and_must_have_been_left_out(
    pictured, runs, tmp_path
):
    amounts = ImageAmounts(seen=2, unseen=1, parts=0, draped=0)
    anchors = [Predictor("another", "random")]
    told = evaluate_images(
        anchors, pictured, tmp_path / "one", amounts, held_out="top + pants", workers=1
    )
    assert told["splits"]["unseen types"] == ["top + pants"]
    assert "top + pants" not in told["splits"]["types learnt from"]
    remembers = load_predictor(Predictor("nearest", "nearest"), str(pictured), "top + pants")
    assert len(remembers.patterns) == 24 and not any("trouser" in p for p in remembers.patterns)
    wrong = predictors_from_names([str(runs / "cascade-0")])
    with pytest.raises(Exception, match="was trained on type 'top \\+ pants', too; train it with"):
        evaluate_images(
            wrong, pictured, tmp_path / "two", amounts, held_out="top + pants", workers=1
        )


def test_networks_of_all_types_are_measured_on_seen_garments_where_none_are_unseen(
    pictured, tmp_path
):
    data = tmp_path / "data"
    shutil.copytree(pictured, data)
    summary = json.loads((data / "summary.json").read_text())
    for file in (data / "data").glob("unseen-*"):
        summary["rows"] -= read_header(file).rows
        file.unlink()
    (data / "summary.json").write_text(json.dumps(summary))
    amounts = ImageAmounts(seen=2, unseen=1, parts=0, draped=0)
    told = evaluate_images(
        [Predictor("another", "random")], data, tmp_path / "out", amounts, workers=1
    )
    assert set(told["figures"]["another"]) == {"seen"}


def test_choices_are_made_on_the_validation_split_and_open_no_test(pictured, tmp_path):
    amounts = ImageAmounts(seen=2, unseen=1, parts=0, draped=0)
    evaluate_images(
        [Predictor("another", "random")], pictured, tmp_path, amounts, validation=True, workers=1
    )
    assert sorted(f.name for f in tmp_path.iterdir()) == [
        "run.json",
        "validation-seen-another.jsonl",
    ]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "name a dataset with --data, or a recipe with --recipe"),
        (["--recipe", "d1", "--data", "DATA"], "is of recipe d2, not 'd1'"),
        (["--data", "DATA"], "there are no networks runs/d2-*/model"),
        (
            ["--data", "DATA", "--network", "x=nowhere"],
            "nowhere: holds no network from pictures to patterns",
        ),
        (["--data", "DATA", "--network", "RUN", "--seen", "99"], "has 3 seen garments for test; "),
        (["--data", "DATA", "--network", "RUN", "--vae", "x"], "there is no option '--vae'"),
        (
            ["--data", "DATA", "--network", "RUN", "--workers", "0"],
            "--workers is 0; give 1",
        ),
    ],
)
def test_a_wrong_call_is_told_in_a_sentence(words, message, pictured, runs, tmp_path, monkeypatch,
                                            capsys):  # fmt: skip
    monkeypatch.chdir(tmp_path)
    places = {"DATA": str(pictured), "RUN": str(runs / "cascade-0")}
    words = [places.get(word, word) for word in words]
    assert main(["evaluate", "image", *words, "-o", "out"]) == 2
    assert message in capsys.readouterr().err


def test_networks_left_without_each_type_in_turn_have_one_name_and_one_table(pictured, tmp_path):
    data = tmp_path / "data"  # without a split that tells what is unseen
    shutil.copytree(pictured, data)
    for file in (data / "data").glob("unseen-*"):
        file.unlink()
    predictors = []
    for held_out in ("shirt", "top skirt"):
        folder = tmp_path / held_out / "model"
        folder.mkdir(parents=True)
        (folder.parent / "run.json").write_text(json.dumps({"run": {"without": [held_out]}}))
        predictors.append(Predictor(f"cascade-{held_out}", "cascade", str(folder)))
    found = group_by_held_out(predictors, data)
    assert {k: [g.name for g in v] for k, v in found.items()} == {
        "shirt": ["cascade"], "top skirt": ["cascade"]
    }  # fmt: skip
    value = {"mean": 0.5, "low": 0.25, "high": 0.75}
    figures = {"seen": {"panel_iou": value}, "unseen": {"panel_iou": value, "topology": value}}
    table = held_out_table(
        {
            "shirt": {"ours": figures, "ours, paper": figures, "true flags": figures},
            "top skirt": {"pool": figures, "true image": figures},
        }
    )
    heads, _, shirt, skirt = table.splitlines()
    assert heads.count("|") == 11 and "paper" not in heads and "flags" not in heads
    assert shirt.count("0.500 (0.250 to 0.750)") == 3
    assert skirt.count("0.500 (0.250 to 0.750)") == 6
    assert shirt.endswith("| - | - | - | - | - | - |")


def test_seeds_of_one_name_count_as_one_garment_each():
    two = [Predictor("ours", "cascade", f"runs/c-{n}/model") for n in (0, 1)]
    items = [ImageItem(g, "d", "", "test", n, False) for g in two for n in range(3)]
    record = {"type": "t", "draped": None, "fault": "", "repairs": {}, "panels found": 2}
    records = {
        item: record | {"panel_iou": 0.5 + 0.1 * item.number + 0.2 * (item.predictor is two[1])}
        for item in items
    }
    told = summarise_images(items, records)["ours"]["seen"]
    assert told["panel_iou"]["n"] == 3 and told["panel_iou"]["mean"] == pytest.approx(0.7)
    assert told["panel_iou by seed"] == {"ours c-0": 0.6, "ours c-1": 0.8}


def test_figures_are_told_of_each_type_where_there_are_several():
    predictor = Predictor("ours", "cascade", "runs/c-0/model")
    items = [ImageItem(predictor, "d", "", "test", n, False) for n in range(4)]
    record = {"draped": None, "fault": "", "repairs": {}, "panels found": 2, "topology": 1.0}
    records = {
        item: record | {"panel_iou": 0.25 * item.number, "type": "skirt" if item.number else "tee"}
        for item in items
    }
    told = summarise_images(items, records)["ours"]["seen"]["by type"]
    assert list(told) == ["skirt", "tee"] and told["tee"]["panel_iou"]["mean"] == 0
    assert told["skirt"]["panel_iou"]["n"] == 3
    assert told["skirt"]["panel_iou"]["mean"] == pytest.approx(0.5)


def test_parts_are_those_of_the_first_cascade(tmp_path):
    assert [g.name for g in with_baselines([Predictor("pool", "slots", "x")])] == [
        "pool", "nearest picture", "another of its type",
    ]  # fmt: skip
