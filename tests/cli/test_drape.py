"""The verbs that drape and photograph, as a user types them."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image

import garmentimage as gi
from garmentimage.body.body import load_body
from garmentimage.cli.app import main
from garmentimage.drape.draped_garment import DrapeReport
from garmentimage.drape.outfits import outfit
from garmentimage.errors import DrapeError
from garmentimage.examples import example_path
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.render.worn.maps import MAX_PANELS, panel_numbers

DRESS = example_path("dress")
TROUSERS = example_path("trousers")
FEW = ("--vertices", "400")


def run(capsys, *words):
    capsys.readouterr()
    code = main([str(w) for w in words])
    out, err = capsys.readouterr()
    return code, out, err


@pytest.fixture(scope="session")
def glb(tmp_path_factory):
    """The bundled trousers on a body, of few vertices."""
    path = tmp_path_factory.mktemp("worn") / "trousers.glb"
    assert main(["drape", str(TROUSERS), *FEW, "-o", str(path)]) == 0
    return path


@pytest.fixture
def rags(tmp_path):
    """The panels of the dress, not sewn."""
    data = json.loads(DRESS.read_text())
    data["pattern"]["stitches"] = []
    path = tmp_path / "rags.json"
    path.write_text(json.dumps(data))
    return path


def pixels(path):
    with Image.open(path) as image:
        return np.asarray(image).astype(int)


def write_obj(path, faces):
    body = load_body()
    lines = [f"v {x} {y} {z}" for x, y, z in body.vertices.round(3).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    path.write_text("\n".join(lines))
    return path


def test_a_drape_is_written_in_every_format_with_a_picture_and_a_report(capsys, tmp_path):
    for ending in ("glb", "obj", "ply"):
        out, image = tmp_path / f"a.{ending}", tmp_path / f"{ending}.png"
        words = (TROUSERS, *FEW, "-o", out, "--image", image, "--size", 64)
        code, told, err = run(capsys, "drape", *words, "--json")
        assert (code, err) == (0, "")
        facts = json.loads(told)
        assert facts["report"]["settled"]
        assert facts["report"]["faults"] == []
        assert set(facts["report"]) == set(DrapeReport.__dataclass_fields__)
        assert out.stat().st_size > 0
        assert pixels(image).shape == (64, 64, 3)


def test_a_drape_tells_how_it_went_in_one_line(capsys, tmp_path):
    code, told, _ = run(capsys, "drape", TROUSERS, *FEW, "-o", tmp_path / "a.ply")
    assert code == 0
    assert told.count("\n") == 1
    for words in ("at rest", "cm under the skin", "off the waist", "stretched by"):
        assert words in told


def test_an_image_is_decoded_and_draped(capsys, tmp_path):
    image = tmp_path / "trousers.npz"
    assert main(["encode", str(TROUSERS), "-o", str(image)]) == 0
    code, _, _ = run(capsys, "drape", image, *FEW, "-o", tmp_path / "a.glb")
    assert code == 0
    assert len(gi.load_drape(tmp_path / "a.glb").cloth.pattern.panels) == 6


def test_garments_worn_together_keep_their_panels_and_stitches(capsys, tmp_path):
    out = tmp_path / "a.glb"
    top = example_path("cutout_top")
    assert run(capsys, "drape", top, TROUSERS, "--vertices", 800, "-o", out)[0] == 0
    worn = gi.load_drape(out)
    alone = [gi.load_pattern(path) for path in (top, TROUSERS)]
    assert worn.report.items == 2
    assert len(worn.cloth.pattern.panels) == sum(len(p.panels) for p in alone)
    assert len(worn.cloth.pattern.stitches) == sum(len(p.stitches) for p in alone)


def test_the_same_garment_twice_gets_new_names():
    pattern = gi.load_pattern(TROUSERS)
    both = outfit([pattern, pattern], load_body())
    names = [panel.name for panel in both.panels]
    assert len(set(names)) == 2 * len(pattern.panels)
    half = len(pattern.stitches)
    first, second = both.stitches[:half], both.stitches[half:]
    assert not {s.panel for x in first for s in x.sides} & {
        s.panel for x in second for s in x.sides
    }


def test_maps_tell_the_same_view_as_the_picture(capsys, tmp_path, glb):
    names = ("depth", "normal", "panels", "silhouette")
    words = [w for name in names for w in (f"--{name}", tmp_path / f"{name}.png")]
    assert run(capsys, "render", glb, "-o", tmp_path / "a.png", "--size", 96, *words)[0] == 0
    depth, normal, panels, cloth = (pixels(tmp_path / f"{name}.png") for name in names)
    views = gi.photograph(gi.load_drape(glb), size=96)
    assert np.array_equal(pixels(tmp_path / "a.png"), views.colour)
    seen = np.isfinite(views.depth)
    assert np.array_equal(depth > 0, seen)
    assert np.abs(depth[seen] / 100 - views.depth[seen]).max() <= 0.0051
    assert np.abs(normal / 127.5 - 1 - views.normal).max() <= 0.0041
    assert np.array_equal(panels, views.panel + 1)
    assert np.abs(cloth / 255 - views.silhouette).max() <= 0.002


def test_more_panels_than_a_palette_holds_are_refused(glb):
    views = gi.photograph(gi.load_drape(glb), size=16)
    views.panel[0, 0] = MAX_PANELS + 1
    with pytest.raises(gi.RenderError, match="distinguishes 254 of them"):
        panel_numbers(views)


def colours(path):
    return pixels(path).reshape(-1, 3)


def test_options_of_the_look_change_what_they_say(capsys, tmp_path, glb):
    base = ("render", glb, "--size", 64, "-o")
    assert run(capsys, *base, tmp_path / "a.png", "--colour", "red", "--background", "lime")[0] == 0
    seen = colours(tmp_path / "a.png")
    assert (seen == (0, 255, 0)).all(axis=1).mean() > 0.5
    assert (seen[:, 0] > 2 * seen[:, 1:].max(axis=1)).mean() > 0.02
    made = {}
    for k, words in enumerate(
        (
            (),
            ("--print", "checks"),
            ("--print", "checks", "--repeat", 20),
            ("--print", "bottom=stripes"),
            ("--skin", "#3d241a"),
            ("--seams",),
            ("--view", "back"),
            ("--look", 1),
            ("--look", 2),
            ("--look", 1, "--colour", "navy"),
            ("--print", tmp_path / "a.png"),
        )
    ):
        out = tmp_path / f"b{k}.png"
        assert run(capsys, *base, out, *words)[0] == 0
        made[out.read_bytes()] = words
    assert len(made) == 11


def test_a_pattern_is_draped_before_it_is_photographed(capsys, tmp_path, glb):
    words = ("--size", 64, "-o")
    assert run(capsys, "render", TROUSERS, *FEW, *words, tmp_path / "a.png")[0] == 0
    assert run(capsys, "render", glb, *words, tmp_path / "b.png")[0] == 0
    a, b = colours(tmp_path / "a.png"), colours(tmp_path / "b.png")
    # A GLB holds single precision, which may turn a few samples at outlines.
    assert (np.abs(a - b).max(axis=1) > 8).mean() < 0.002


def test_a_bad_drape_is_refused_or_kept_with_a_warning(capsys, tmp_path):
    words = ("drape", TROUSERS, *FEW, "--body", "short-round-male", "-o", tmp_path / "a.glb")
    code, _, err = run(capsys, *words)
    assert code == 2
    assert "too tight" in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())
    code, _, err = run(capsys, *words, "--keep-bad")
    assert code == 0
    assert err.startswith("warning: ")
    assert (tmp_path / "a.glb").is_file()
    code, _, err = run(capsys, "render", tmp_path / "a.glb", "-o", tmp_path / "a.png")
    assert code == 2
    assert not (tmp_path / "a.png").exists()
    words = ("render", tmp_path / "a.glb", "-o", tmp_path / "a.png", "--size", 64, "--keep-bad")
    assert run(capsys, *words)[0] == 0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("drape", DRESS, "--body", "mean-femal"), "did you mean mean-female"),
        (("drape", DRESS, "--body", "none.obj"), "there is no such file"),
        (("drape", DRESS, "--body", "me.json"), "measurements have no shape"),
        (("drape", DRESS, "--body", "me.obj", "--pose", "a"), "--pose is for shipped bodies"),
        (("drape", DRESS, "--pose", "z"), "--pose is 'z'; choose t or a"),
        (("drape", DRESS, "--fabric", "coton"), "did you mean cotton"),
        (("drape", DRESS, "--view", "above"), "choose front, back, side or turned"),
        (("drape", DRESS, "--size", "5000"), "give 16 to 2048 pixels"),
        (("drape", DRESS, "--size", "big"), "not a whole number"),
        (("drape", DRESS, "--vertices", "7"), "7 vertices; choose 50"),
        (("drape", DRESS, "--vertices", "many"), "not a whole number"),
        (("drape", DRESS, "--made-for", "tall"), "--made-for is 'tall', not a number"),
        (("drape", DRESS, "--made-for", "3"), "3"),
        (("drape", DRESS, "--image", "a.jpg"), "must end in .png"),
        (("drape", DRESS, "--sise", "64"), "did you mean --size"),
        (("drape", "none.json"), "no such file"),
    ],
)
def test_a_wrong_drape_is_one_sentence_and_no_file(capsys, tmp_path, monkeypatch, words, sentence):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, *words, "-o", "a.glb")
    assert (code, out) == (2, "")
    assert sentence in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--colour", "nocolour"), "is not a colour"),
        (("--colour", "tpo=red"), "did you mean top"),
        (("--print", "tartan"), "choose stripes, checks, dots or a picture file"),
        (("--print", "none.png"), "cannot be read"),
        (("--print", "dots", "--repeat", "0"), "give 0.1 to 1000 cm"),
        (("--background", "none.png"), "cannot be read"),
        (("--skin", "#12"), "is not a colour"),
        (("--look", "x"), "not a whole number"),
        (("--look", "-1"), "--look is -1; give 0 or more"),
        (("--view", "top"), "--view is 'top'; choose front"),
        (("--size", "8"), "give 16 to 2048 pixels"),
        (("--body", "mean-male"), "--body is for patterns"),
        (("--tucked",), "--tucked is for patterns"),
        (("--depth", "a.png"), "another output"),
        (("--panels", "a.jpg"), "must end in .png"),
    ],
)
def test_a_wrong_render_is_one_sentence_and_no_file(
    capsys, tmp_path, monkeypatch, glb, words, sentence
):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, "render", glb, *words, "-o", "a.png")
    assert (code, out) == (2, "")
    assert sentence in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_files_that_will_not_do_are_told(capsys, tmp_path, glb, rags):
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "text.glb").write_text("not a mesh")
    shutil.copy(glb, mine / "copy.obj")
    cube = mine / "cube.glb"
    import trimesh

    trimesh.creation.box().export(cube)
    out = tmp_path / "a.png"
    for file, sentence in (
        (mine / "text.glb", "is not a GLB that can be read"),
        (cube, "holds no garment of garmentimage"),
        (mine / "copy.obj", "write a .glb"),
        (mine / "none.glb", "there is no such file"),
        (rags, "has no stitches"),
    ):
        code, _, err = run(capsys, "render", file, "-o", out)
        assert code == 2
        remarks = [line for line in err.splitlines() if not line.startswith("warning: ")]
        assert len(remarks) == 1
        assert sentence in remarks[0]
        assert not out.exists()
    code, _, err = run(capsys, "render", glb, TROUSERS, "-o", out)
    assert code == 2
    assert "is draped already" in err


def test_half_a_body_is_refused_and_one_with_a_small_hole_is_dressed(capsys, tmp_path):
    faces, height = load_body().faces, load_body().vertices[:, 1]
    torn = write_obj(tmp_path / "torn.obj", faces[(height < 95)[faces].all(1)])
    out = tmp_path / "a.glb"
    code, _, err = run(capsys, "drape", TROUSERS, *FEW, "--body", torn, "-o", out)
    assert code == 2
    assert "torn.obj: is open: a hole" in err
    assert err.count("\n") == 1
    assert not out.exists()
    whole = write_obj(tmp_path / "whole.obj", faces[20:])
    assert run(capsys, "drape", TROUSERS, *FEW, "--body", whole, "-o", out)[0] == 0
    assert gi.load_drape(out).body.name == "whole"


def test_auto_takes_the_body_that_fits_and_says_which(capsys, tmp_path):
    slim = tmp_path / "slim.json"
    gi.save_pattern(gi.draft_pattern("pants", body="slim-female"), slim)
    out = tmp_path / "a.glb"
    code, result, err = run(capsys, "drape", slim, *FEW, "--body", "auto", "--json", "-o", out)
    assert code == 0
    assert json.loads(result)["body"] == "slim-female"
    assert "body: slim-female (waist" in err


def test_long_waits_are_said_and_short_ones_are_not(capsys, tmp_path, monkeypatch):
    out = tmp_path / "a.glb"
    assert "takes about" not in run(capsys, "drape", TROUSERS, *FEW, "-o", out)[2]
    monkeypatch.setattr("garmentimage.cli.terminal.PATIENCE", 0.0)
    assert "draping takes about" in run(capsys, "drape", TROUSERS, *FEW, "-o", out)[2]


def test_centimetres_read_as_metres_are_refused_with_the_remedy(capsys, tmp_path):
    data = json.loads(TROUSERS.read_text(encoding="utf-8"))
    data["properties"]["units_in_meter"] = 1
    huge, out = tmp_path / "huge.json", tmp_path / "a.glb"
    huge.write_text(json.dumps(data), encoding="utf-8")
    code, _, err = run(capsys, "drape", huge, "-o", out)
    assert code == 2
    assert "m² of cloth" in err and "units_in_meter" in err
    assert not out.exists()


def test_an_output_that_cannot_be_written_is_told_before_the_work(capsys, tmp_path, rags):
    """The pattern cannot be draped either; the output is looked at first."""
    (tmp_path / "folder.glb").mkdir()
    for out, sentence in (
        (tmp_path / "a.stl", "must end in .glb or .obj or .ply"),
        (tmp_path / "missing" / "a.glb", "make it first"),
    ):
        code, _, err = run(capsys, "drape", rags, "-o", out)
        assert code == 2
        assert sentence in err
        assert err.count("\n") == 1
    words = ("-o", tmp_path / "a.glb", "--image", tmp_path / "missing" / "a.png")
    code, _, err = run(capsys, "drape", rags, *words)
    assert code == 2
    assert "make it first" in err
    (tmp_path / "folder.png").mkdir()
    for words in (
        ("-o", tmp_path / "folder.glb"),
        ("-o", tmp_path / "a.glb", "--image", tmp_path / "folder.png"),
    ):
        code, _, err = run(capsys, "drape", TROUSERS, *FEW, *words)
        assert code == 2
        assert "is a folder" in err
    assert {p.name for p in tmp_path.iterdir()} == {"folder.glb", "folder.png", "rags.json"}


def test_what_has_no_stitches_is_refused_in_python_too(rags):
    with pytest.raises(DrapeError, match="no stitches"):
        gi.drape_pattern(read_pattern(rags)[0])
