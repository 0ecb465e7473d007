"""Editing by text from the command line and from Python, with networks trained for a moment."""

import dataclasses
import json
import shutil

import numpy as np
import pytest
import torch
from PIL import Image

import garmentimage as gi
from garmentimage.cli.app import main
from garmentimage.draft.kind import draft_pattern
from garmentimage.errors import LearnError
from garmentimage.latent.space import SYMMETRY_TOLERANCE_CM
from garmentimage.raster.image import mirrored_channels
from garmentimage.text_edit.editor import TextEditor, denoiser_guidance, normalised_text
from garmentimage.text_edit.guidance import ScoreDistillation

pytestmark = pytest.mark.slow


def names(trained) -> list[str]:
    return [
        "--space", str(trained / "vae" / "model"),
        "--image-decoder", str(trained / "pictures" / "model"),
    ]  # fmt: skip


@pytest.fixture(scope="module")
def dress(tmp_path_factory):
    path = tmp_path_factory.mktemp("dress") / "dress.json"
    gi.save_pattern(draft_pattern("one-panel-dress"), path)
    return path


def edit(trained, dress, *words) -> int:
    return main(["edit", str(dress), *map(str, words), *names(trained)])


def test_an_edit_writes_a_garment_and_the_way_to_it(trained, dress, tmp_path, capsys):
    denoiser = trained / "denoiser" / "model"
    words = ["long sleeves", "-o", tmp_path / "out", "--steps", 6, "--model", denoiser]
    assert edit(trained, dress, *words) == 0
    told = capsys.readouterr().out
    assert "the steps from one to the other" in told and "by the shape of its panels" in told
    strip = np.asarray(Image.open(tmp_path / "out" / "strip.png"))
    assert strip.shape[1] > 8 * 200 and (tmp_path / "out" / "before.glb").exists()
    assert (tmp_path / "out" / "edited.npz").exists()


def test_the_same_seed_edits_the_same_and_strength_goes_further(trained, dress):
    editor = TextEditor.load(trained / "vae" / "model", trained / "pictures" / "model")
    pattern = gi.load_pattern(dress)

    def moved(seed: int, strength: float) -> np.ndarray:
        guidance, _ = denoiser_guidance(trained / "denoiser" / "model", "pants", seed=seed)
        found = editor.edit(pattern, "pants", guidance, strength=strength, steps=8)
        assert [frame.number for frame in found.frames] == [0, 2, 3, 5, 6, 8]
        return found.frames[-1].step.z - found.source.z

    one, again, other, further = moved(1, 1.0), moved(1, 1.0), moved(2, 1.0), moved(1, 20.0)
    assert np.array_equal(one, again) and not np.array_equal(one, other)
    assert np.linalg.norm(further) >= np.linalg.norm(one) > 0


def test_a_dress_that_is_asked_to_be_long_keeps_a_level_hem():
    """With the networks of the package: most dresses that they know have a slanted hem."""
    guidance, _ = denoiser_guidance(None, "long")
    found = TextEditor.load().edit(
        draft_pattern("one-panel-dress"), "long", guidance, max_attempts=1
    )
    assert found.achieved
    for step in (found.result, *(frame.step for frame in found.frames)):
        channels = step.image.to_channels()[None]
        assert np.abs(channels - mirrored_channels(channels)).max() < SYMMETRY_TOLERANCE_CM


def test_stable_diffusion_drives_the_same_command(trained, dress, tiny, tmp_path, capsys):
    words = ["pants", "-o", tmp_path / "out", "--steps", 2, "--guidance", "sd", "--model", tiny]
    assert edit(trained, dress, *words, "--json") == 0
    assert json.loads(capsys.readouterr().out)["out"] == str(tmp_path / "out")


@pytest.mark.parametrize(
    "text", ["quarterly tax report", "with pockets", "a hood", "add buttons", "ein Kleid", "長袖"]
)
def test_what_the_networks_do_not_know_is_not_made_something_else(
    text, trained, dress, tmp_path, capsys
):
    words = ["-o", tmp_path / "out", "--model", trained / "denoiser" / "model"]
    assert edit(trained, dress, text, *words) == 2
    assert "the networks do not know" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_what_is_known_is_done_and_what_is_not_is_said(trained, dress, tmp_path, capsys):
    words = ["-o", tmp_path / "out", "--steps", 1, "--model", trained / "denoiser" / "model"]
    assert edit(trained, dress, "pants with pockets", *words) == 0
    assert "the networks do not know 'pockets'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([""], "says nothing; say what the garment should be"),
        (["  ... "], "says nothing"),
        (["long " * 2000], "the text has 9,999 characters; give 500 or fewer"),
        (["pants", "--strength", "0"], "the strength is 0; give 0.05 to 20"),
        (["pants", "--strength", "nan"], "the strength is nan"),
        (["pants", "--steps", "0"], "the number of steps is 0; give 1 to 5000"),
        (["pants", "--guidance", "dalle"], "--guidance is 'dalle'"),
        (["pants", "--prompt-template", "a photo"], "needs one {} where the text goes"),
        (["pants", "--scale", "-1"], "the guidance scale is -1"),
        (["pants", "--scale", "1e39"], "the guidance scale is 1e+39; give more than 0, up to 1000"),
        (["pants", "--seed", str(2**64)], "the seed is 18446744073709551616; give 0 to"),
        (["pants", "--seed", "-1"], "the seed is -1"),
        (["long \udcff"], "is not valid UTF-8"),
        (["pants", "--negative", "a" * 600], "the text has 600 characters"),
        (["pants", "--prompt-template", "a" * 600 + "{}"], "the text has 605 characters"),
        (["pants", "--model", "nowhere"], "nowhere"),
        (["pants", "--guidance", "sd", "--model", "nowhere"], "nowhere: there is no such folder"),
        (["pants", "--guidance", "sd", "--model", "."], "holds no Stable Diffusion model"),
    ],
)
def test_a_wrong_call_is_told_in_a_sentence(words, message, trained, dress, tmp_path, capsys,
                                            monkeypatch):  # fmt: skip
    monkeypatch.chdir(tmp_path)
    if "--model" not in words:
        words = [*words, "--model", str(trained / "denoiser" / "model")]
    assert edit(trained, dress, *words, "-o", "out") == 2
    assert message in capsys.readouterr().err


def test_braces_round_the_place_of_the_text_are_only_braces(trained, dress, tmp_path):
    words = ["pants", "-o", tmp_path / "out", "--steps", 1, "--prompt-template", "{0} {x} { {}"]
    assert edit(trained, dress, *words, "--model", trained / "denoiser" / "model") == 0


def test_a_wrong_call_leaves_no_folder(trained, dress, tmp_path):
    assert edit(trained, dress, "pants", "--steps", 0, "-o", tmp_path / "out") == 2
    assert edit(trained, dress, "pants", "--model", "none", "-o", tmp_path / "out") == 2
    assert not (tmp_path / "out").exists()


def test_an_edit_does_not_write_over_the_garment_that_it_edits(trained, dress, tmp_path, capsys):
    words = ["pants", "-o", tmp_path, "--steps", 1, "--model", trained / "denoiser" / "model"]
    again = tmp_path / "edited.json"
    again.write_bytes(dress.read_bytes())
    assert edit(trained, again, *words) == 2
    assert "edited.json: is an input" in capsys.readouterr().err
    assert again.read_bytes() == dress.read_bytes()


def test_nothing_of_an_earlier_edit_stays_beside_a_later_one(trained, dress, tmp_path, monkeypatch):
    from garmentimage.text_edit import editor as room

    words = ["-o", tmp_path, "--steps", 1, "--model", trained / "denoiser" / "model"]
    for name in ("edited.json", "edited.glb", "notes.txt"):
        (tmp_path / name).write_text("older")
    whole = room.TextEditor.edit

    def no_pattern(self, *given, **told):
        found = whole(self, *given, **told)
        bad = dataclasses.replace(found.result, pattern=None, faults=("it is none",))
        return dataclasses.replace(found, result=bad)

    monkeypatch.setattr(room.TextEditor, "edit", no_pattern)
    assert edit(trained, dress, "pants", *words) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        "before.glb", "edited.npz", "notes.txt", "strip.png",
    ]  # fmt: skip


def test_networks_that_were_not_trained_together_are_refused(trained, dress, tmp_path, capsys):
    words = ["pants", *("-o", tmp_path / "out"), *("--model", trained / "denoiser" / "model")]
    other = tmp_path / "vae"
    shutil.copytree(trained / "vae" / "model", other)
    (other / "model.safetensors").write_bytes(b"other")
    pictures = trained / "pictures" / "model"
    told = [*words, "--space", other, "--image-decoder", pictures]
    assert main(["edit", str(dress), *map(str, told)]) == 2
    assert f"was trained with another latent space than {other}" in capsys.readouterr().err


def test_networks_of_other_sizes_do_not_go_together(trained):
    from garmentimage.latent.space import LatentSpace
    from garmentimage.learn.models.image_decoder import ImageDecoder, ImageDecoderConfig

    space = LatentSpace(trained / "vae" / "model")
    other = ImageDecoder(ImageDecoderConfig(latent=8, channels=(16, 16, 16, 16, 16)))
    with pytest.raises(LearnError, match="of 32 numbers, the picture network takes 8"):
        TextEditor(space, other)


def test_texts_are_taken_in_one_line():
    assert normalised_text("  long\n sleeves ") == "long sleeves"


def test_any_guidance_will_do(trained, dress):
    """The protocol is all that an editor asks for."""

    class Brighter:
        def start(self, pictures, source_prompt, boost):
            assert pictures.shape == (1, 3, 64, 64) and source_prompt == "" and boost == 1

        def gradient(self, pictures, text, progress):
            return -torch.ones_like(pictures)

    editor = TextEditor.load(trained / "vae" / "model", trained / "pictures" / "model")
    found = editor.edit(gi.load_pattern(dress), "a sunny day", Brighter(), steps=20, strength=20)
    first, last = (frame.picture.mean() for frame in (found.frames[0], found.frames[-1]))
    assert last > first and not isinstance(Brighter(), ScoreDistillation)
