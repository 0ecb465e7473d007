"""The documents: what stands in them runs as it is written."""

import ast
import inspect
import itertools
import json
import re
import shlex
import shutil
from pathlib import Path

import nbformat
import numpy as np
import pytest
import shapely
from nbclient import NotebookClient
from PIL import Image

from garmentimage.body.body_measurements import NAMES, BodyMeasurements
from garmentimage.cli.app import main
from garmentimage.drape.fabric import FABRICS
from garmentimage.drape.verdict.judging import DEEPEST, MOST_SLID, MOST_STRAIN
from garmentimage.drape.worn import DrapeReport
from garmentimage.examples import example_path, example_picture
from garmentimage.geometry.polygons import centroid
from garmentimage.pattern.files.spec import load_pattern, pattern_from_spec, pattern_to_spec
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import PanelMark
from garmentimage.raster.panel_marks import mark_from_json
from tests.compare.garments import darted_skirt

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BODIES = (ROOT / "docs" / "how-to" / "bodies.md").read_text(encoding="utf-8")
DRAPE = (ROOT / "docs" / "how-to" / "drape.md").read_text(encoding="utf-8")
PREDICT = (ROOT / "docs" / "how-to" / "predict.md").read_text(encoding="utf-8")
EXPLORE = (ROOT / "docs" / "how-to" / "explore.md").read_text(encoding="utf-8")
METRICS = (ROOT / "docs" / "how-to" / "compare.md").read_text(encoding="utf-8")
TEXT = (ROOT / "docs" / "how-to" / "edit.md").read_text(encoding="utf-8")
FORMATS = (ROOT / "docs" / "reference" / "formats.md").read_text(encoding="utf-8")


def blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.mark.slow
def test_the_commands_of_the_readme_run_as_written(tmp_path, monkeypatch, capsys):
    """From the second block on; `make demo` leaves the folder out/, a template is the reader's."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    examples = Path("src", "garmentimage", "examples")
    shutil.copytree(ROOT / examples, examples)
    shutil.copy(ROOT / "tests" / "draft" / "templates" / "flared_skirt.json", "template.json")
    preparing, *commands = blocks(README, "sh")
    copying = [shlex.split(line) for line in preparing.splitlines() if line.startswith("cp ")]
    assert copying
    for _, source, target in copying:
        shutil.copy(source, target)
    (code,) = blocks(README, "python")
    exec(code, {})
    assert Path("out", "dress-again.json").is_file()
    for line in "".join(commands).replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if not words:
            continue
        program, *arguments = words
        assert program == "garmentimage"
        assert main(arguments) == 0, line
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.slow
def test_editing_by_text_runs_as_written(tmp_path, monkeypatch, capsys):
    """And does what the picture there shows: the top of the dress stays, below it are two legs."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    for line in blocks(TEXT, "sh")[0].splitlines():
        program, *arguments = shlex.split(line)
        assert program == "garmentimage" and main(arguments) == 0, line
    edited = load_pattern("out/edited/edited.json")
    assert len(edited.panels) == 6 and (tmp_path / "out" / "edited" / "edited.glb").exists()
    (code,) = blocks(TEXT, "python")
    capsys.readouterr()
    exec(code, {})
    assert capsys.readouterr().out.startswith("() 6")


@pytest.mark.slow
def test_the_notebook_of_editing_by_text_runs_and_ends_with_a_garment(tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    notebook = nbformat.read(ROOT / "docs" / "how-to" / "edit.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "saved with its outputs"
    place = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=place).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert sum("image/png" in output.get("data", ()) for output in outputs) == 3
    said = "".join(output["text"] for output in outputs if output["output_type"] == "stream")
    assert "valid - 10 panels" in said  # networks know sleeves that are cut front and back
    assert len(load_pattern(tmp_path / "short-pants.json").panels) == 10


@pytest.mark.slow
def test_exploring_runs_as_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    for line in blocks(EXPLORE, "sh")[0].splitlines():
        program, *arguments = shlex.split(line)
        if program == "garmentimage":
            assert main(arguments) == 0, line
    (code,) = blocks(EXPLORE, "python")
    exec(code, {})
    assert "Traceback" not in capsys.readouterr().err


def test_the_mark_in_the_formats_has_every_field():
    meta = json.loads(blocks(FORMATS, "json")[0])
    (mark,) = meta["marks"]
    assert list(mark) == list(PanelMark.__dataclass_fields__)
    assert mark_from_json(mark, layers=2, grid=16).name == "left_sleeve_back"
    for field in mark:
        assert f"`{field}`" in FORMATS


def test_the_frame_in_the_formats_is_the_standard_one():
    table = re.findall(r"^\| (\d+) \| ([-.\d]+) \| ([-.\d]+) \|$", FORMATS, re.MULTILINE)
    lines = [(int(k), float(x), float(y)) for k, x, y in table if k != x]
    frame = BodyFrame.standard(16)
    assert lines == list(zip(range(17), frame.columns, frame.rows))
    for grid in (8, 32, 50):
        places = 16 * np.arange(grid + 1) / grid
        for own, told in zip((frame.columns, frame.rows), list(zip(*lines))[1:]):
            wanted = np.interp(places, np.arange(17), told)
            finer = BodyFrame.standard(grid)
            assert np.allclose(wanted, finer.columns if own is frame.columns else finer.rows)


def test_a_mark_leads_to_the_panels_own_coordinates_as_the_formats_say():
    """On a hole off the middle: holes are filled before the centroid is taken."""
    pattern = load_pattern(example_path("cutout_top"))
    panel = pattern.by_name["front"]
    image = encode(pattern)
    mark = next(m for m in image.marks if m.name == "front")
    bare = decode(image.without_marks()).by_name
    (decoded,) = (p for p in bare.values() if p.holes)
    cloth = shapely.Polygon(panel.outline.polygon, [hole.polygon for hole in panel.holes])
    q = decoded.outline.polygon
    matrix = np.array(mark.matrix)
    own = (q - centroid(q)) @ matrix + np.array(mark.anchor)
    assert np.allclose(mark.anchor, centroid(panel.outline.polygon), atol=0.05)
    assert np.hypot(*(np.array(mark.anchor) - np.array(cloth.centroid.coords[0]))) > 0.1
    assert np.allclose(own.min(axis=0), panel.outline.polygon.min(axis=0), atol=0.3)
    assert np.allclose(own.max(axis=0), panel.outline.polygon.max(axis=0), atol=0.3)


def test_the_bodies_table_says_what_the_class_says():
    """Every field of `BodyMeasurements` with the words below it, in order."""
    body = ast.parse(inspect.getsource(BodyMeasurements)).body[0].body
    fields = [
        (field.target.id, words.value.value)
        for field, words in itertools.pairwise(body)
        if isinstance(field, ast.AnnAssign)
    ]
    assert len(fields) == len(NAMES)
    assert re.findall(r"^\| `(\w+)` \| (.*) \|$", BODIES, re.MULTILINE) == fields


def test_the_field_in_the_formats_can_be_read():
    data = pattern_to_spec(darted_skirt())
    data |= json.loads(blocks(FORMATS, "json")[1])
    del data["garmentimage"]["stitches"]
    front = pattern_from_spec(data).by_name["front"]
    assert len(front.holes) == len(front.notches) == front.cloth_layer == 1
    assert front.grain == (0.0, 1.0)


@pytest.mark.slow
def test_the_examples_of_draping_run_as_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(example_path("dress"), "dress.json")
    (commands,) = blocks(DRAPE, "sh")
    for line in commands.splitlines():
        assert main(shlex.split(line)[1:]) == 0, line
    names: dict[str, object] = {}
    for code in blocks(DRAPE, "python"):
        exec(code, names)


def test_the_fabrics_table_says_what_the_fabrics_are():
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \| ([\d,]+) \| (\d+) \| ([\d.]+) \|$", DRAPE, re.M)
    told = {
        name: (float(weight), float(stretch.replace(",", "")), float(bend), float(friction))
        for name, weight, stretch, bend, friction in rows
    }
    assert told == {
        name: (pytest.approx(1e4 * f.weight), f.stretch, f.bend, f.friction)
        for name, f in FABRICS.items()
    }


def test_the_report_table_has_every_field_and_limit():
    table = dict(re.findall(r"^\| (`[a-z`, ]+`) \| .* \| (.*) \|$", DRAPE, re.M))
    fields = {f for names in table for f in re.findall(r"`(\w+)`", names)}
    assert set(DrapeReport.__dataclass_fields__) <= fields
    for name, limit in (("penetration", DEEPEST), ("strain", MOST_STRAIN), ("slid", MOST_SLID)):
        assert float(table[f"`{name}`"]) == limit


def test_the_options_of_the_documents_are_known(capsys):
    with pytest.raises(SystemExit):
        main(["render", "--help"])
    known = capsys.readouterr().out
    for option in re.findall(r"`(--[\w-]+)", DRAPE):
        assert option in known


def test_the_code_on_metrics_runs_as_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    shutil.copy(example_path("dress"), tmp_path / "out" / "dress.json")
    names: dict[str, object] = {}
    for code in blocks(METRICS, "python"):
        exec(code, names)
    told = capsys.readouterr().out
    assert "Interval(mean=" in told and "aipparel {" in told


@pytest.mark.slow
def test_what_is_said_of_predicting_runs_as_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shutil.copy(example_picture(), "photo.png")
    Image.open(example_picture()).convert("RGB").save("other.jpg")
    for line in blocks(PREDICT, "sh")[0].splitlines():
        assert main(shlex.split(line)[1:]) == 0, line
    assert {file.suffix for file in Path("out", "predicted").glob("photo.*")} == {
        ".json", ".npz", ".glb", ".png",
    }  # fmt: skip
    (code,) = blocks(PREDICT, "python")
    exec(code, {})
    confidence, shape = capsys.readouterr().out.splitlines()[-1].split(maxsplit=1)
    assert float(confidence) > 0.5 and shape == "(2, 16, 16)" and Path("photo.json").is_file()
