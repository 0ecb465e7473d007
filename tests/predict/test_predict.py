"""From a picture to a pattern with a network in a folder, without torch."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import torch
from PIL import Image

from garmentimage import load_pattern
from garmentimage.cli.app import main
from garmentimage.errors import LearnError
from garmentimage.learn.data.images import ImageSplit, load_split
from garmentimage.learn.export import export_cascade
from garmentimage.learn.models.cascade import PAPER_CONFIG, Cascade
from garmentimage.predict.photo import Photo, read_photo
from garmentimage.predict.predictor import PatternPredictor, certainty, uncertainty_of

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def made(pictured, tmp_path_factory):
    """A cascade that knows a few garments by heart, in a folder, and what it learnt from."""
    folder = tmp_path_factory.mktemp("cascade")
    album = first_of(load_split(pictured, "train"), 6)
    torch.manual_seed(0)
    model = Cascade(replace(PAPER_CONFIG, channels=(24, 24, 24), squared_losses=False))
    optimizer = torch.optim.AdamW(model.parameters(), 4e-3)
    for _ in range(100):
        optimizer.zero_grad()
        model(album.garments)["loss"].backward()
        optimizer.step()
    facts = {"recipe": "d2", "seed": 0}
    export_cascade(model, album, album, facts=facts, card="#", folder=folder / "model")
    return folder / "model", album


def first_of(album: ImageSplit, count: int) -> ImageSplit:
    return ImageSplit(
        album.garments.batch(torch.arange(count)),
        album.ids[:count],
        album.types[:count],
        album.patterns[:count],
    )


def picture(album, number) -> np.ndarray:
    upward = album.garments.pictures[number].numpy()
    return np.ascontiguousarray(upward.transpose(1, 2, 0)[::-1])


def test_a_picture_of_nothing_is_an_error_and_gives_no_files(made, tmp_path, capsys):
    folder, _ = made
    with pytest.raises(LearnError, match="the picture shows nothing in front of its background"):
        PatternPredictor.load(folder).predict(np.full((128, 128, 3), 255, np.uint8))
    page, out = tmp_path / "page.png", tmp_path / "out"
    Image.new("RGB", (128, 128), "white").save(page)
    assert main(["predict", str(page), "-o", str(out), "--network", str(folder)]) == 2
    assert "page.png: shows nothing in front of its background" in capsys.readouterr().err
    assert not out.exists() or not list(out.iterdir())


def test_a_picture_of_few_pixels_is_told_to_be(made):
    folder, album = made
    network = PatternPredictor.load(folder)
    small = Image.fromarray(picture(album, 0)).resize((40, 40))
    (note,) = network.predict(small).photo.notes
    assert "pixels high" in note
    assert not network.predict(picture(album, 0)).photo.notes


def test_a_picture_that_it_knows_becomes_its_garment(made, tmp_path):
    folder, album = made
    network = PatternPredictor.load(folder)
    pixels = picture(album, 0)
    found = network.predict(Photo(pixels, ()))
    truth = album.garments.inside[0].bool().numpy()
    assert (found.garment.image.inside == truth).mean() > 0.97
    assert found.confidence > 0.5
    # The same from a file, twice as large and on a wider sheet.
    wide = np.full((256, 400, 3), 255, np.uint8)
    wide[:, 72:328] = pixels.repeat(2, 0).repeat(2, 1)
    Image.fromarray(wide).save(tmp_path / "wide.png")
    again = network.predict(read_photo(tmp_path / "wide.png"))
    assert (again.garment.image.inside == truth).mean() > 0.95


def test_pictures_of_something_else_have_a_low_confidence(made):
    folder, album = made
    network = PatternPredictor.load(folder)
    known = network.predict(Photo(picture(album, 0), ())).confidence
    random = np.random.default_rng(0)
    noise = random.integers(0, 256, (128, 128, 3)).astype(np.uint8)
    blot = np.full((128, 128, 3), 255, np.uint8)
    blot[30:100, 10:50] = (30, 160, 60)
    for other in (noise, blot):
        found = network.predict(Photo(other, ()))
        assert found.confidence < 0.5 * known and not found.is_sure


def test_predict_writes_all_of_a_garment(made, tmp_path, capsys):
    folder, album = made
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        Image.fromarray(picture(album, 0)).save(tmp_path / name / "photo.png")
    paths = [str(tmp_path / name / "photo.png") for name in ("one", "two")]
    out = tmp_path / "out"
    words = ["predict", *paths, "-o", str(out), "--network", str(folder)]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["garments"]
    assert [each["name"] for each in told] == ["photo", "photo-2"]
    assert len(load_pattern(out / "photo.json").panels) == told[0]["panels"] > 0
    for suffix, start in ((".npz", b"PK"), (".png", b"\x89PNG")):
        assert (out / f"photo-2{suffix}").read_bytes().startswith(start)
    assert main(words) == 0
    assert "confidence" in capsys.readouterr().out


def test_a_bad_picture_does_not_stop_the_others(made, tmp_path, capsys):
    folder, album = made
    for name in ("one", "two"):
        Image.fromarray(picture(album, 0)).save(tmp_path / f"{name}.png")
    (tmp_path / "bad.png").write_text("no picture")
    paths = [str(tmp_path / f"{name}.png") for name in ("one", "bad", "two")]
    words = ["predict", *paths, "-o", str(tmp_path / "out"), "--network", str(folder)]
    assert main([*words, "--json"]) == 2
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert [each["name"] for each in told["garments"]] == ["one", "two"]
    assert told["errors"][0]["image"] == paths[1] and "bad.png: is not a picture" in said.err


def test_a_picture_is_never_written_over(made, tmp_path, capsys):
    folder, album = made
    Image.fromarray(picture(album, 0)).save(tmp_path / "photo.png")
    before = (tmp_path / "photo.png").read_bytes()
    words = ["predict", str(tmp_path / "photo.png"), "--network", str(folder)]
    assert main([*words, "-o", str(tmp_path)]) == 2
    assert "photo.png: is an input" in capsys.readouterr().err
    assert (tmp_path / "photo.png").read_bytes() == before and len(list(tmp_path.iterdir())) == 1


def test_names_that_begin_alike_are_numbered(made, tmp_path, capsys):
    folder, album = made
    paths = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        paths.append(tmp_path / name / f"{'a' * 120}.png")
        Image.fromarray(picture(album, 0)).save(paths[-1])
    words = ["predict", *map(str, paths), "-o", str(tmp_path / "out"), "--network", str(folder)]
    assert main([*words, "--json"]) == 0
    names = [each["name"] for each in json.loads(capsys.readouterr().out)["garments"]]
    assert len(set(names)) == 2 and names[1].endswith("-2")


def test_nothing_of_an_earlier_picture_of_the_same_name_stays(made, tmp_path):
    folder, _ = made
    out = tmp_path / "out"
    out.mkdir()
    for suffix in (".json", ".glb"):
        (out / f"photo{suffix}").write_text("of an earlier picture")
    wearer = np.full((128, 128, 3), 255, np.uint8)
    wearer[20:110, 50:80] = 90
    Image.fromarray(wearer).save(tmp_path / "photo.png")
    words = ["predict", str(tmp_path / "photo.png"), "-o", str(out), "--network", str(folder)]
    assert main(words) == 0
    for suffix in (".json", ".glb"):
        left = out / f"photo{suffix}"
        assert not left.exists() or left.read_bytes() != b"of an earlier picture"


def test_networks_that_cannot_be_are_told(made, tmp_path):
    folder, album = made
    with pytest.raises(LearnError, match="there is no network 'nowhere'"):
        PatternPredictor.load("nowhere")
    broken = tmp_path / "model"
    shutil.copytree(folder, broken)
    config = json.loads((folder / "config.json").read_text())
    (broken / "config.json").write_text(json.dumps({**config, "wearer": 3}))
    with pytest.raises(LearnError, match=r"config\.json: is damaged"):
        PatternPredictor.load(broken)
    (broken / "config.json").write_text(json.dumps({**config, "picture": 64}))
    with pytest.raises(LearnError, match=r"predictor\.onnx: is damaged"):
        PatternPredictor.load(broken).predict(Photo(picture(album, 0), ()))
    (broken / "config.json").write_text(json.dumps(config))
    (broken / "pictures.npz").write_bytes(b"PK")
    with pytest.raises(LearnError, match=r"pictures\.npz: is damaged"):
        PatternPredictor.load(broken).predict(Photo(picture(album, 0), ()))
    with np.load(folder / "pictures.npz") as file:
        known = dict(file)
    for change in ({"usual": np.float32(np.nan)}, {"usual": np.float32(-1)}, {"middle": [1.0]}):
        np.savez(broken / "pictures.npz", **{**known, **change})
        with pytest.raises(LearnError, match=r"pictures\.npz: is damaged"):
            PatternPredictor.load(broken).predict(Photo(picture(album, 0), ()))


def test_certainty_is_of_cells_that_may_be_cloth():
    sure = np.zeros((34, 16, 16), np.float32)
    assert certainty(sure) == 0
    sure[[0, 17], 4:8, 4:8] = 1
    sure[[1, 5, 18, 22]] = 1
    assert certainty(sure) == 1
    unsure = sure.copy()
    unsure[[0, 17], 4:8, 4:8] = 0.6
    assert certainty(unsure) < 0.3


def test_doubts_are_where_a_network_is_unsure():
    channels = np.zeros((34, 16, 16), np.float32)
    channels[[1, 5, 18, 22]] = 1
    channels[[0, 17], 4:8, 4:8] = 1
    assert not uncertainty_of(channels).any()
    channels[0, 4, 4] = 0.5
    channels[1:5, 6, 6] = 0.25
    told = uncertainty_of(channels)
    assert told.shape == (2, 16, 16) and not told[1].any()
    assert told[0, 4, 4] == 1 and 0.3 < told[0, 6, 6] < 0.5
    assert np.count_nonzero(told) == 2
