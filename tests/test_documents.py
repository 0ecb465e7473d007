"""The documents: what stands in them runs as it is written."""

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest

from garmentimage.cli import main
from garmentimage.pattern.spec import pattern_from_spec, pattern_to_spec
from garmentimage.raster.image import PanelMark
from garmentimage.raster.marks import mark_from_json
from tests.metrics.garments import darted_skirt

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
FORMATS = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")


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
    for line in "".join(commands).splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == "garmentimage"
        assert main(arguments) == 0, line
    assert "Traceback" not in capsys.readouterr().err


def test_the_mark_in_the_formats_has_every_field():
    meta = json.loads(blocks(FORMATS, "json")[0])
    (mark,) = meta["marks"]
    assert list(mark) == list(PanelMark.__dataclass_fields__)
    assert mark_from_json(mark, layers=2, grid=16).name == "left_sleeve_back"
    for field in mark:
        assert f"`{field}`" in FORMATS


def test_the_field_in_the_formats_can_be_read():
    data = pattern_to_spec(darted_skirt())
    data |= json.loads(blocks(FORMATS, "json")[1])
    del data["garmentimage"]["stitches"]
    front = pattern_from_spec(data).by_name["front"]
    assert len(front.holes) == len(front.notches) == front.cloth_layer == 1
    assert front.grain == (0.0, 1.0)
