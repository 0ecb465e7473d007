"""The documents: their code and commands run, links hold, and nothing public is undocumented."""

import ast
import contextlib
import doctest
import importlib
import inspect
import io
import itertools
import json
import re
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

import nbformat
import numpy as np
import pytest
import shapely
from nbclient import NotebookClient
from PIL import Image

import garmentimage as gi
from garmentimage.body import BodyMeasurements
from garmentimage.cli import main
from garmentimage.drape import FABRICS, DrapeReport
from garmentimage.drape.verdict.judging import MAX_PENETRATION, MAX_SLID, MAX_STRAIN
from garmentimage.examples import example_path
from garmentimage.geometry import centroid
from garmentimage.pattern.files import pattern_from_spec, pattern_to_spec
from garmentimage.raster import PanelMark
from garmentimage.raster.panel_marks import mark_from_json
from tests.compare.garments import darted_skirt
from tests.test_architecture import ROOMS, SOURCE

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
BODIES = (DOCS / "how-to" / "bodies.md").read_text(encoding="utf-8")
DRAPE = (DOCS / "how-to" / "drape.md").read_text(encoding="utf-8")
FORMATS = (DOCS / "reference" / "formats.md").read_text(encoding="utf-8")

LANGUAGES = {"sh", "bash", "python", "json", "text"}
"""Of code blocks: `sh` and `python` are run; of `bash` commands and options are only looked up."""
GENERATED = (
    "reference/python/",
    "reference/commands.md",
    "contributing/files.md",
    "benchmarks/results/",
)
"""Pages that exist only while the site is built (scripts/site_pages.py)."""
MAX_README_WORDS = 700
"""Outside code and tables."""


@dataclass(frozen=True)
class Block:
    language: str
    text: str


def page_name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def blocks(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    found = re.findall(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [Block(*each) for each in found]


def json_blocks(text: str) -> list[str]:
    return re.findall(r"^```json\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def commands(text: str) -> list[list[str]]:
    """Lines of a shell block as words, comments left out, `a && b` as two."""
    lines = text.replace("\\\n", " ").splitlines()
    words = [shlex.split(line, comments=True) for line in lines]
    return [list(part) for line in words for part in _parts(line)]


def _parts(words: list[str]) -> list[list[str]]:
    whole: list[list[str]] = [[]]
    for word in words:
        if word in ("&&", "&"):
            whole.append([])
        else:
            whole[-1].append(word)
    return [part for part in whole if part]


def prepare(folder: Path) -> None:
    """What README and the guides find beside them: a checkout's examples."""
    examples = Path("src", "garmentimage", "examples")
    shutil.copytree(ROOT / examples, folder / examples)
    (folder / "out").mkdir()


def run_command(words: list[str]) -> None:
    """Run a line of an `sh` block as the shell would."""
    program, *rest = words
    if program == "garmentimage":
        assert main(rest) == 0, words
    elif program == "cp":
        shutil.copy(*rest)
    elif program == "mkdir":
        Path(rest[-1]).mkdir(parents=True, exist_ok=True)
    else:
        assert program in ("make", "."), words  # sets up what the tests have


runnable = [page for page in PAGES if {"sh", "python"} & {b.language for b in blocks(page)}]


@pytest.mark.slow
@pytest.mark.parametrize("page", runnable, ids=page_name)
def test_code_and_commands_of_a_page_run_as_written(page, tmp_path, monkeypatch, capsys):
    """In the order of the page, in one folder; Python blocks share their names."""
    monkeypatch.chdir(tmp_path)
    prepare(tmp_path)
    names: dict[str, object] = {"__name__": "page"}
    for block in blocks(page):
        if block.language == "sh":
            for words in commands(block.text):
                run_command(words)
        elif block.language == "python":
            exec(block.text, names)
    assert "Traceback" not in capsys.readouterr().err
    if page.name == "edit.md":
        # What the picture there shows: below the top of the dress are two legs.
        assert len(gi.load_pattern("out/edited/edited.json").panels) == 6
    if page.name == "predict.md":
        made = {file.suffix for file in Path("out", "predicted").glob("photo.*")}
        assert made == {".json", ".npz", ".glb", ".png"}


@pytest.mark.slow
def test_the_notebook_of_editing_by_text_runs_and_ends_with_a_garment(tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    notebook = nbformat.read(DOCS / "how-to" / "edit.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "saved with its outputs"
    place = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=place).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert sum("image/png" in output.get("data", ()) for output in outputs) == 3
    printed = "".join(output["text"] for output in outputs if output["output_type"] == "stream")
    assert "valid - 10 panels" in printed  # networks know sleeves that are cut front and back
    assert len(gi.load_pattern(tmp_path / "short-pants.json").panels) == 10


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_every_code_block_has_a_known_language(page):
    assert {block.language for block in blocks(page)} <= LANGUAGES


@pytest.fixture(scope="module")
def help_texts():
    """Help of every command, by its words, as the command reference is made of it."""

    def of(words: tuple[str, ...]) -> str:
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.suppress(SystemExit):
            main([*words, "--help"])
        return out.getvalue()

    cache: dict[tuple[str, ...], str] = {}

    def cached(words: tuple[str, ...]) -> str:
        if words not in cache:
            cache[words] = of(words)
        return cache[words]

    return cached


def documented_commands() -> list[tuple[str, list[str]]]:
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        lines = [b.text for b in blocks(page) if b.language in ("sh", "bash")]
        lines += re.findall(r"`(garmentimage [^`\n]+)`", text)
        for line in lines:
            for words in commands(line):
                if words[0] == "garmentimage" and words[1:] and words[1][0].islower():
                    found.append((page_name(page), words[1:]))
    return found


@pytest.mark.parametrize(("page", "words"), documented_commands(), ids=lambda v: str(v)[:60])
def test_every_documented_command_and_option_exists(page, words, help_texts):
    """Also those that take hours and are not run."""
    verb = words[0]
    known = help_texts((verb,))
    assert known, f"{page}: there is no command {verb!r}"
    if len(words) > 1 and re.fullmatch(r"[a-z][a-z-]+", words[1]):
        known += help_texts((verb, words[1]))  # of a subcommand
    missing = [word for word in words if word.startswith("--") and word.split("=")[0] not in known]
    assert missing == [], f"{page}: {shlex.join(words)}"


def test_the_options_of_the_tables_exist(help_texts):
    for page in ("drape.md", "render.md"):
        text = (DOCS / "how-to" / page).read_text(encoding="utf-8")
        known = help_texts(("drape",)) + help_texts(("render",))
        assert [o for o in re.findall(r"`(--[\w-]+)", text) if o not in known] == []


def slug(heading: str) -> str:
    """The anchor of a heading, as Python-Markdown makes it."""
    plain = re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", plain).strip().lower())


@pytest.mark.parametrize("page", [*PAGES, *sorted(ROOT.glob("*.md"))], ids=page_name)
def test_links_and_pictures_of_a_page_exist(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    broken = []
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("https://", "http://")):
            continue
        path, _, anchor = target.partition("#")
        place = (page.parent / path).resolve() if path else page
        if place.is_relative_to(DOCS) and str(place.relative_to(DOCS)).startswith(GENERATED):
            continue
        if not place.is_file():
            broken.append(target)
        elif anchor and place.suffix == ".md":
            headings = re.findall(r"^#+ (.*)$", place.read_text(encoding="utf-8"), re.M)
            if anchor not in map(slug, headings):
                broken.append(target)
    assert broken == []


def test_every_picture_can_be_read_and_is_used():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    for picture in sorted((DOCS / "images").iterdir()):
        assert f"images/{picture.name}" in text, f"{picture.name} is on no page"
        with Image.open(picture) as opened:
            opened.verify()


def test_every_result_file_has_a_place_in_the_benchmarks():
    text = "".join(p.read_text(encoding="utf-8") for p in (DOCS / "benchmarks").glob("*.md"))
    files = sorted((ROOT / "benchmarks" / "results").glob("*.json"))
    assert [file.name for file in files if f"results/{file.name})" not in text] == []


def test_the_readme_is_short():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    prose = re.sub(r"^```.*?^```$|^\|.*$", "", text, flags=re.M | re.S)
    prose = "\n".join(line for line in prose.splitlines() if not line.startswith("|"))
    assert len(prose.split()) <= MAX_README_WORDS


@pytest.fixture
def script(monkeypatch):
    """Imports a script by its name."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    return importlib.import_module


@pytest.fixture
def site_pages(script):
    return script("site_pages")


@pytest.mark.slow
def test_the_pictures_of_the_algorithms_can_be_drawn_anew(script, tmp_path):
    """All but those of draping, which take longer; the same pictures as on the pages."""
    draw = script("draw_algorithms")
    for name in ("encode", "channels", "frame", "decode", "repair"):
        draw.PICTURES[name](tmp_path)
    assert len(list(tmp_path.iterdir())) == 15
    for picture in tmp_path.iterdir():
        with Image.open(picture) as new, Image.open(DOCS / "images" / picture.name) as shown:
            assert new.size == shown.size, picture.name


@pytest.mark.parametrize("name", ["demo", "draw_algorithms", "draw_worn", "try_wheel"])
def test_the_names_that_a_script_imports_exist(name, script):
    script(name)


def test_every_public_name_has_an_entry_that_is_not_empty(site_pages):
    """Functions and classes by their docstring, constants and types by value."""
    empty = []
    for room in site_pages.rooms():
        assert room.summary, f"{room.module} has no docstring"
        page = site_pages.room_page(room)
        for name in room.names:
            assert f"{room.module}.{name}" in page or f"`{name}`](" in page
            path = site_pages.definition(room.module, name)
            if site_pages.constant(path) is None and not documented(path):
                empty.append(f"{room.module}.{name}")
    assert empty == []


def documented(path: str) -> bool:
    """Whether the function or class of a dotted path has a docstring; nothing is imported."""
    module, _, name = path.rpartition(".")
    place = SOURCE.parent / module.replace(".", "/")
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        kinds = (ast.FunctionDef, ast.ClassDef)
        if isinstance(node, kinds) and node.name == name:
            return bool(ast.get_docstring(node))
    return False


def test_commands_are_found_in_help_texts_of_both_styles(site_pages):
    plain = """usage: x

commands:
  COMMAND
    check      say
    show       draw

options:
  -h
"""
    boxed = """Usage: x COMMAND

╭─ Patterns ────╮
│ check  Say.   │
│ show   Draw.  │
╰───────────────╯
╭─ Parameters ──╮
│ json  Print.  │
╰───────────────╯
"""
    assert site_pages.listed_commands(plain) == ["check", "show"]
    assert site_pages.listed_commands(boxed) == ["check", "show"]


def test_every_room_is_in_the_floor_plan():
    text = (DOCS / "contributing" / "floor-plan.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([\w/]+)` \| (.+) \|$", text.split("| folder |")[0], re.M)
    rooms = {str(f.parent.relative_to(SOURCE)) for f in SOURCE.rglob("__init__.py")} - {"."}
    assert {name for name, _ in rows} - {"errors"} == {r.replace("\\", "/") for r in rooms}
    # In an order in which imports look back only.
    step = {name: k for k, names in enumerate(ROOMS) for name in names}
    order = [step[name.split("/")[0]] for name, _ in rows]
    assert order == sorted(order)


@pytest.mark.parametrize("page", PAGES, ids=page_name)
def test_files_of_the_code_that_a_page_names_exist(page):
    named = re.findall(r"`((?:[\w.-]+/)+\w+\.py)`", page.read_text(encoding="utf-8"))
    new = {"draft/parts/poncho.py"}  # of an example
    missing = [f for f in named if not (SOURCE / f).is_file() and not (ROOT / f).is_file()]
    assert not set(missing) - new


EXAMPLES = [f for f in sorted(SOURCE.rglob("*.py")) if ">>> " in f.read_text(encoding="utf-8")]


@pytest.mark.parametrize("file", EXAMPLES, ids=page_name)
def test_examples_in_docstrings_hold(file):
    name = ".".join(file.relative_to(SOURCE.parent).with_suffix("").parts)
    result = doctest.testmod(importlib.import_module(name))
    assert result.attempted and not result.failed


def test_the_mark_in_the_formats_has_every_field():
    meta = json.loads(json_blocks(FORMATS)[0])
    (mark,) = meta["marks"]
    assert list(mark) == list(PanelMark.__dataclass_fields__)
    assert mark_from_json(mark, layers=2, grid=16).name == "left_sleeve_back"
    for field in mark:
        assert f"`{field}`" in FORMATS


def test_the_frame_in_the_formats_is_the_standard_one():
    table = re.findall(r"^\| (\d+) \| ([-.\d]+) \| ([-.\d]+) \|$", FORMATS, re.MULTILINE)
    lines = [(int(k), float(x), float(y)) for k, x, y in table if k != x]
    frame = gi.BodyFrame.standard(16)
    assert lines == list(zip(range(17), frame.columns, frame.rows, strict=True))
    _, columns, rows = zip(*lines, strict=True)
    for grid in (8, 32, 50):
        places = 16 * np.arange(grid + 1) / grid
        finer = gi.BodyFrame.standard(grid)
        assert np.allclose(np.interp(places, np.arange(17), columns), finer.columns)
        assert np.allclose(np.interp(places, np.arange(17), rows), finer.rows)


def test_a_mark_leads_to_the_panels_own_coordinates_as_the_formats_say():
    """On a hole off the middle: holes are filled before the centroid is taken."""
    pattern = gi.load_pattern(example_path("cutout_top"))
    panel = pattern.by_name["front"]
    image = gi.encode(pattern)
    mark = next(m for m in image.marks if m.name == "front")
    bare = gi.decode(image.without_marks()).by_name
    (decoded,) = (p for p in bare.values() if p.holes)
    cloth = shapely.Polygon(panel.outline.polygon, [hole.polygon for hole in panel.holes])
    q = decoded.outline.polygon
    matrix = np.array(mark.matrix)
    own = (q - centroid(q)) @ matrix + np.array(mark.anchor)
    assert np.allclose(mark.anchor, centroid(panel.outline.polygon), atol=0.05)
    assert np.hypot(*(np.array(mark.anchor) - np.array(cloth.centroid.coords[0]))) > 0.1
    assert np.allclose(own.min(axis=0), panel.outline.polygon.min(axis=0), atol=0.3)
    assert np.allclose(own.max(axis=0), panel.outline.polygon.max(axis=0), atol=0.3)


def test_the_field_in_the_formats_can_be_read():
    data = pattern_to_spec(darted_skirt())
    data |= json.loads(json_blocks(FORMATS)[1])
    del data["garmentimage"]["stitches"]
    front = pattern_from_spec(data).by_name["front"]
    assert len(front.holes) == len(front.notches) == front.cloth_layer == 1
    assert front.grain == (0.0, 1.0)


def test_the_bodies_table_says_what_the_class_says():
    """Every field of `BodyMeasurements` with the words below it, in order."""
    body = ast.parse(inspect.getsource(BodyMeasurements)).body[0].body
    fields = [
        (field.target.id, words.value.value)
        for field, words in itertools.pairwise(body)
        if isinstance(field, ast.AnnAssign)
    ]
    assert len(fields) == len(BodyMeasurements.__dataclass_fields__)
    assert re.findall(r"^\| `(\w+)` \| (.*) \|$", BODIES, re.MULTILINE) == fields


def test_the_fabrics_table_says_what_the_fabrics_are():
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \| ([\d,]+) \| (\d+) \| ([\d.]+) \|$", DRAPE, re.M)
    table = {
        name: (float(weight), float(stretch.replace(",", "")), float(bend), float(friction))
        for name, weight, stretch, bend, friction in rows
    }
    assert table == {
        name: (pytest.approx(1e4 * f.weight), f.stretch, f.bend, f.friction)
        for name, f in FABRICS.items()
    }


def test_the_report_table_has_every_field_and_limit():
    table = dict(re.findall(r"^\| (`[a-z`, ]+`) \| .* \| (.*) \|$", DRAPE, re.M))
    fields = {f for names in table for f in re.findall(r"`(\w+)`", names)}
    assert set(DrapeReport.__dataclass_fields__) <= fields
    limits = {"penetration": MAX_PENETRATION, "strain": MAX_STRAIN, "slid": MAX_SLID}
    for name, limit in limits.items():
        assert float(table[f"`{name}`"]) == limit


def test_the_errors_table_is_the_tree_of_errors():
    text = (DOCS / "reference" / "errors.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+Error)` \| .* \| `(\w+)` \|$", text, re.M)
    assert {name for name, _ in rows} == {n for n in gi.__all__ if n.endswith("Error")}
    for name, base in rows:
        assert base in {c.__name__ for c in getattr(gi, name).__mro__[1:]}
