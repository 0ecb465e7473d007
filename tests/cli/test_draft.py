"""The verbs that make patterns, as a user types them."""

import json

import pytest

from garmentimage.cli.app import main
from garmentimage.examples import example_path
from garmentimage.pattern.files.spec import load_pattern


def run(capsys, *words):
    code = main([str(w) for w in words])
    out, err = capsys.readouterr()
    return code, out, err


def test_kinds_lists_every_kind_with_ranges(capsys):
    code, out, _ = run(capsys, "kinds")
    assert code == 0
    assert "one-panel-dress: " in out
    assert "skirt_length" in out
    code, out, _ = run(capsys, "kinds", "skirt", "--json")
    (skirt,) = json.loads(out)["kinds"]
    gores = next(p for p in skirt["parameters"] if p["name"] == "gores")
    assert gores["options"] == [2, 4, 6, 8]


@pytest.mark.parametrize(
    "words",
    [
        ("--param", "gores=6", "skirt_flare=0.3"),
        ("--param", "gores", "6", "--param", "skirt_flare", "0.3"),
        ("--gores", "6", "--skirt-flare", "0.3"),
        ("--gores=6", "--skirt_flare=0.3"),
    ],
)
def test_parameters_can_be_told_in_every_usual_way(capsys, tmp_path, words):
    code, _, _ = run(capsys, "draft", "skirt", *words, "-o", tmp_path / "a.json")
    assert code == 0
    names = [p.name for p in load_pattern(tmp_path / "a.json").panels]
    assert sum("skirt" in name for name in names) == 6


def test_a_negative_value_is_a_value(capsys, tmp_path):
    for words in (("--skirt-slant", "-5"), ("--param", "skirt_slant", "-5")):
        assert run(capsys, "draft", "skirt", *words, "-o", tmp_path / "a.json")[0] == 0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("draft", "skrit"), "did you mean skirt"),
        (("draft", "skirt", "--gorse", "4"), "did you mean --gores"),
        (("draft", "skirt", "--gores", "5"), "choose 2, 4, 6 or 8"),
        (("draft", "skirt", "--skirt-length", "60"), "give 0.35 to 0.9"),
        (("draft", "skirt", "--skirt-length"), "--skirt-length has no value"),
        (("draft", "skirt", "gores", "4"), "'gores' is one argument too many"),
        (("draft", "skirt", "--body", "nobody"), "nobody"),
        (("sample", "skirt", "--count", "-3"), "count is -3"),
        (("sample", "none.json"), "no such file"),
        (("draft", "tee", "--body", str(example_path("dress"))), "is a pattern, not measurements"),
    ],
)
def test_a_wrong_call_is_one_sentence_and_no_file(capsys, tmp_path, words, sentence):
    code, _, err = run(capsys, *words, "-o", tmp_path / "a.json")
    assert code == 2
    assert sentence in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_verb_without_parameters_refuses_unknown_options(capsys, tmp_path):
    code, _, err = run(capsys, "sample", "skirt", "--gores", "4", "-o", tmp_path / "s")
    assert code == 2
    assert "there is no option '--gores'" in err


def test_sample_writes_patterns_and_their_records(capsys, tmp_path):
    folder = tmp_path / "made"
    words = ("sample", "pants", "--count", 3, "--seed", 9, "-o", folder, "--workers", 1)
    code, out, _ = run(capsys, *words, "--json")
    assert code == 0
    assert json.loads(out)["patterns"] == 3
    lines = [json.loads(line) for line in (folder / "samples.jsonl").read_text().splitlines()]
    assert [line["index"] for line in lines] == [0, 1, 2]
    for line in lines:
        assert load_pattern(folder / line["file"]).panels


def test_samples_join_those_of_their_folder_and_replace_their_equals(capsys, tmp_path):
    words = ("-o", tmp_path, "--workers", 1)
    for call in (
        ("sample", "skirt", "--count", 2),
        ("sample", "tee", "--count", 1),
        ("sample", "skirt", "--count", 2, "--first", 1, "--body", "mean-male"),
    ):
        assert run(capsys, *call, *words)[0] == 0
    lines = [json.loads(line) for line in (tmp_path / "samples.jsonl").read_text().splitlines()]
    assert sorted(line["file"] for line in lines) == sorted(p.name for p in tmp_path.glob("*.json"))
    skirts = {line["index"]: line["body"] for line in lines if line["source"] == "skirt"}
    assert skirts == {0: "mean-female", 1: "mean-male", 2: "mean-male"}
    assert len(lines) == 4


def test_records_of_another_kind_are_not_overwritten(capsys, tmp_path):
    (tmp_path / "samples.jsonl").write_text("notes of mine\n")
    code, _, err = run(capsys, "sample", "tee", "-o", tmp_path)
    assert code == 2
    assert "samples.jsonl" in err
    assert (tmp_path / "samples.jsonl").read_text() == "notes of mine\n"


def test_a_number_that_is_none_is_told_in_plain_words(capsys, tmp_path):
    for word in ("one", "1.5"):
        code, _, err = run(capsys, "sample", "tee", "--seed", word, "-o", tmp_path / "s")
        assert code == 2
        assert f"--seed is '{word}', not a whole number" in err


def test_gallery_draws_a_sheet(capsys, tmp_path):
    code, _, _ = run(capsys, "gallery", "skirt", "-o", tmp_path / "a.png")
    assert code == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_body_of_ones_own_is_written_changed_and_drafted_for(capsys, tmp_path):
    mine = tmp_path / "me.json"
    assert run(capsys, "bodies", "mean-female", "-o", mine)[0] == 0
    record = json.loads(mine.read_text())
    mine.write_text(json.dumps(record | {"waist_girth": record["waist_girth"] + 8}))
    for body, out in (("mean-female", "a.json"), (mine, "b.json")):
        words = ("draft", "pants", "--body", body, "-o", tmp_path / out)
        assert run(capsys, *words)[0] == 0
    bands = [
        sum(
            abs(p.outline.area)
            for p in load_pattern(tmp_path / name).panels
            if "waistband" in p.name
        )
        for name in ("a.json", "b.json")
    ]
    assert bands[1] > bands[0]
    words = ("sample", "pants", "--body", mine, "-o", tmp_path / "s", "--workers", 1)
    assert run(capsys, *words)[0] == 0
    mine.write_text(json.dumps(record | {"waist_girth": 5.0}))
    code, _, err = run(capsys, "draft", "pants", "--body", mine, "-o", tmp_path / "c.json")
    assert code == 2
    assert "waist_girth is 5 cm" in err


def test_bodies_lists_all_seven(capsys):
    code, out, _ = run(capsys, "bodies", "--json")
    assert code == 0
    assert len(json.loads(out)["bodies"]) == 7
    out = run(capsys, "bodies")[1]
    assert out.startswith("[cm]")
    assert "hip_girth" in out
