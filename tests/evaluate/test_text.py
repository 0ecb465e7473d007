"""Editing by text, measured: prompts candidate by geometry, with networks trained for a moment."""

import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from garmentimage.cli.app import main
from garmentimage.draft.kind import draft_pattern
from garmentimage.evaluate.prompts import ALREADY_TRUE, PROMPTS, is_applicable
from garmentimage.metrics.preserved import preserved_iou
from garmentimage.metrics.shape_attributes import measure_shape

DRESS, TROUSERS = draft_pattern("one-panel-dress"), draft_pattern("top-pants")
BY_TEXT = {prompt.text: prompt for prompt in PROMPTS}


@pytest.mark.parametrize(
    ("text", "start", "end"),
    [
        ("pants", DRESS, TROUSERS),
        ("skirt", TROUSERS, DRESS),
        ("dress", TROUSERS, DRESS),
        ("two pieces", DRESS, TROUSERS),
        (
            "long sleeves",
            DRESS,
            draft_pattern("one-panel-dress", sleeves="set-in", sleeve_length=1.0),
        ),
        (
            "short sleeves",
            DRESS,
            draft_pattern("one-panel-dress", sleeves="set-in", sleeve_length=0.5),
        ),
        ("sleeveless", draft_pattern("one-panel-dress", sleeves="set-in"), DRESS),
        ("long", DRESS, draft_pattern("one-panel-dress", body_length=70)),
        ("short", DRESS, draft_pattern("one-panel-dress", body_length=38)),
        ("wide", DRESS, draft_pattern("one-panel-dress", flare=0.4)),
        ("flared", TROUSERS, draft_pattern("top-pants", leg_flare=16)),
        ("narrow", DRESS, draft_pattern("one-panel-dress", flare=0.0)),
    ],
)
def test_a_prompt_holds_of_what_it_asks_for_and_is_asked_only_of_others(text, start, end):
    prompt, before, after = BY_TEXT[text], measure_shape(start), measure_shape(end)
    assert is_applicable(prompt, before) and prompt.is_achieved(before, after)
    assert not prompt.is_achieved(before, before)
    if prompt.group != "geometry":
        assert not is_applicable(prompt, after)


def test_there_are_twelve_prompts_in_three_groups():
    groups = [prompt.group for prompt in PROMPTS]
    assert [groups.count(name) for name in ("topology", "parts", "geometry")] == [4, 3, 5]
    assert set(ALREADY_TRUE) == {p.text for p in PROMPTS if p.group == "geometry"}


def test_what_a_text_does_not_speak_of_is_measured_and_the_rest_is_not():
    longer = draft_pattern("one-panel-dress", body_length=70)
    sleeved = draft_pattern("one-panel-dress", sleeves="set-in", sleeve_length=1.0)
    assert preserved_iou(BY_TEXT["long"].region, DRESS, longer) > 0.99
    assert preserved_iou(BY_TEXT["long sleeves"].region, DRESS, longer) < 0.9
    assert preserved_iou(BY_TEXT["long sleeves"].region, DRESS, sleeved) > 0.97
    assert preserved_iou(BY_TEXT["long"].region, DRESS, sleeved) < 0.9
    assert preserved_iou(BY_TEXT["pants"].region, DRESS, None) == 0
    assert preserved_iou(BY_TEXT["pants"].region, DRESS, DRESS) == pytest.approx(1)


@pytest.mark.slow
def test_a_table_has_everyone_who_edits(trained, tmp_path, monkeypatch, capsys):
    folder = trained
    words = [
        "evaluate", "text", "--data", folder / "data", "--space", folder / "vae" / "model",
        "--image-decoder", folder / "pictures" / "model",
        "--denoiser", folder / "denoiser" / "model",
        "--vectors", folder / "vector-vae" / "model",
        "--vector-image-decoder", folder / "vector-pictures" / "model",
        "--steps", 2, "--attempts", 2, "--garments", 1, "--workers", 1, "-o", tmp_path / "out",
    ]  # fmt: skip
    assert main(list(map(str, words))) == 0
    told = json.loads((tmp_path / "out" / "result.json").read_text())
    editors = {"small guidance", "vectors, small guidance", "no guidance", "nearest caption"}
    assert set(told["figures"]) == editors and told["split"] == "test"
    counts = {figures["measured"] for figures in told["figures"].values()}
    assert len(counts) == 1 and counts.pop() > 5
    assert told["figures"]["nearest caption"]["all"]["valid"]["mean"] == 1
    assert (tmp_path / "out" / "table.md").read_text().count("\n") > 12
    assert np.asarray(Image.open(tmp_path / "out" / "edits.png")).shape[0] > 1500
    before = {f.name: f.read_bytes() for f in (tmp_path / "out").glob("*.jsonl")}
    assert told["editors"][0]["space"] == str(folder / "vae" / "model")
    monkeypatch.setattr("garmentimage.networks.WEIGHTS_FOLDER", folder / "vae")
    monkeypatch.setattr("garmentimage.evaluate.draw_text_edits", lambda *_: None)
    assert main(list(map(str, words))) == 0  # nothing is left to do
    assert {f.name: f.read_bytes() for f in (tmp_path / "out").glob("*.jsonl")} == before
    told = json.loads((tmp_path / "out" / "result.json").read_text())
    assert told["editors"][0]["space"] == "model"  # a network that is shipped, by its name


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "--data is missing"),
        (["--data", "x", "--vectors", "y"], "give --vectors and --vector-image-decoder together"),
        (["--data", "x", "--vae", "y"], "there is no option '--vae'"),
        (["--data", "x", "--seen", "3"], "there is no option '--seen'"),
    ],
)
def test_a_wrong_call_is_told_in_a_sentence(words, message, tmp_path, capsys):
    assert main(["evaluate", "text", *words, "-o", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "folder", "message"),
    [
        ("--vectors", "pictures", "pictures/model/words.json: is missing or damaged"),
        ("--image-decoder", "vector-pictures", "was trained with another latent space than"),
        ("--denoiser", "pictures", "pictures/model: holds no Denoiser that can be read"),
        ("--vector-image-decoder", "pictures", "was trained with another latent space than"),
    ],
)
def test_networks_that_will_not_do_are_told_before_the_work(
    name, folder, message, trained, tmp_path, capsys
):
    chosen = {
        "--space": "vae", "--image-decoder": "pictures", "--denoiser": "denoiser",
        "--vectors": "vector-vae", "--vector-image-decoder": "vector-pictures", name: folder,
    }  # fmt: skip
    words = ["--data", trained / "data", "--steps", 1, "--garments", 1, "-o", tmp_path / "out"]
    for option, network in chosen.items():
        words += [option, trained / network / "model"]
    assert main(["evaluate", "text", *map(str, words)]) == 2
    assert message in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_a_garment_that_is_wide_already_is_not_asked_to_be_wide():
    wide = measure_shape(draft_pattern("one-panel-dress", flare=0.5))
    assert not is_applicable(BY_TEXT["wide"], wide) and is_applicable(BY_TEXT["narrow"], wide)
    assert is_applicable(BY_TEXT["wide"], replace(wide, width=50.0))
