"""The commands that explore: what they write, and what they say of a user's mistakes."""

import json

import pytest

from garmentimage import load_image, load_pattern
from garmentimage.cli.app import main
from garmentimage.examples import example_path


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("patterns")
    for kind in ("one-panel-dress", "top-pants", "one-panel-jumpsuit", "hoodie"):
        assert main(["draft", kind, "-o", str(folder / f"{kind}.json")]) == 0
    return {path.stem: str(path) for path in folder.iterdir()}


@pytest.mark.slow
def test_interpolate_writes_every_step_a_strip_and_a_film(files, tmp_path, capsys):
    out = tmp_path / "new" / "way"
    words = ["interpolate", files["one-panel-dress"], files["top-pants"], "--steps", "3"]
    assert main([*words, "-o", str(out)]) == 0
    assert "step-0: 0/2, 2 panels" in capsys.readouterr().out
    for number in range(3):
        assert load_image(out / f"step-{number}.npz").grid == 16
        assert load_pattern(out / f"step-{number}.json").panels
        assert (out / f"step-{number}.glb").read_bytes().startswith(b"glTF")
    assert (out / "strip.png").read_bytes().startswith(b"\x89PNG")
    assert (out / "film.gif").read_bytes().startswith(b"GIF89a")


@pytest.mark.slow
def test_transfer_generate_and_nearest_write_what_they_say(files, tmp_path, capsys):
    before, after, garment = (
        files[kind] for kind in ("one-panel-jumpsuit", "top-pants", "one-panel-dress")
    )
    assert main(["transfer", before, after, garment, "-o", str(tmp_path / "edit"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [(each["name"], each["title"]) for each in told["garments"]] == [
        ("edited", "C + (B - A)")
    ]
    assert len(load_pattern(tmp_path / "edit" / "edited.json").panels) == 4
    words = ["generate", "--count", "2", "--type", "top + skirt", "-o", str(tmp_path / "new")]
    assert main(words) == 0
    assert load_pattern(tmp_path / "new" / "garment-1.json").panels
    assert main(["nearest", garment, "--count", "2", "-o", str(tmp_path / "near")]) == 0
    assert (tmp_path / "near" / "nearest.png").exists()
    assert len(list((tmp_path / "near").glob("vae-variety-*.json"))) == 2


@pytest.mark.slow
def test_what_an_earlier_run_left_does_not_stay_among_the_new(files, tmp_path):
    words = ["interpolate", files["one-panel-dress"], files["top-pants"], "-o", str(tmp_path)]
    assert main([*words, "--steps", "3"]) == 0
    (tmp_path / "step-2.txt").write_text("mine")
    assert main([*words, "--steps", "2"]) == 0
    assert {path.stem for path in tmp_path.glob("step-*.json")} == {"step-0", "step-1"}
    assert (tmp_path / "step-2.txt").exists()


def test_a_garment_that_comes_back_with_other_seams_is_warned_of(tmp_path, capsys):
    dress = str(example_path("dress"))
    assert main(["nearest", dress, "--count", "1", "-o", str(tmp_path / "near")]) == 0
    assert "it comes back with other seams, as" in capsys.readouterr().err


def test_a_garment_of_another_kind_is_warned_of(files, tmp_path, capsys):
    words = ["nearest", files["hoodie"], "--count", "1", "-o", str(tmp_path / "near")]
    assert main(words) == 0
    assert "is unlike the garments that vae-variety was trained on" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["generate", "--space", "nowhere"], "there is no latent space 'nowhere'"),
        (["generate", "--count", "0"], "0 garments of seed 0; give 1"),
        (["generate", "--count", "201"], "201 garments of seed 0; give 1 to 200"),
        (["generate", "--space", "x" * 5000], "there is no latent space"),
        (["train", "vae", "--data", "x", "--seed", str(2**40)], f"seed is {2**40}; give 0 to"),
        (["train", "vae", "--data", "x", "--beta", "-1"], "--beta is -1; give 0 to 1000"),
        (["train", "vae", "--data", "x", "--beta", "nan"], "--beta is nan; give 0 to 1000"),
        (["train", "vae", "--data", "x", "--ablate", "all"], "there is no option '--ablate'"),
        (
            ["train", "vae", "--data", "x", "--accelerator", "abacus"],
            "--accelerator is 'abacus'",
        ),
        (["train", "vae", "--data", "x", "--devices", "9999"], "devices is 9999; this machine"),
        (["generate", "--type", "hat"], "the network knows no type 'hat'"),
        (["nearest", "nowhere.json"], "nowhere.json: there is no such file"),
        (["evaluate", "words", "--data", "x"], "there is no subject 'words'"),
        (["evaluate", "latent", "--data", "x"], "holds no finished dataset"),
        (["train", "gan", "--data", "x"], "there is no network 'gan'"),
        (["train", "vae", "--data", "x"], "has no shards|holds no|has no split"),
        (["train", "vae", "--data", "x", "--rate", "7"], "rate is 7.0; give more than 0"),
        (["train", "vae", "--data", "x", "--epochs", "0"], "epochs is 0; give 1 or more"),
    ],
)
def test_mistakes_are_told_in_a_sentence(tmp_path, monkeypatch, capsys, words, sentence):
    import re

    monkeypatch.chdir(tmp_path)
    assert main([*words, "-o", "out"]) == 2
    said = capsys.readouterr().err
    assert re.search(sentence, said) and said.count("\n") == 1
    assert not list(tmp_path.rglob("*.json"))


def test_a_file_where_the_folder_should_be_is_told(files, tmp_path, capsys):
    (tmp_path / "out").write_text("")
    assert main(["nearest", files["hoodie"], "-o", str(tmp_path / "out")]) == 2
    assert "is a file; name a folder" in capsys.readouterr().err
