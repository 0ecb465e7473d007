"""How the project hangs together: imports only look back, and importing it is quick."""

import ast
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

import garmentimage

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "garmentimage"

ROOMS = (
    {"errors"},
    {"system"},
    {"geometry"},
    {"pattern"},
    {"compare"},
    {"body"},
    {"draft"},
    {"raster"},
    {"drape"},
    {"metrics", "render", "examples"},
    {"dataset"},
    {"networks"},
    {"latent"},
    {"predict"},
    {"learn"},
    {"text_edit"},
    {"evaluate"},
    {"cli"},
    {"__main__"},
)
"""The way the data goes; a room imports from itself and from what stands before its step."""
MAX_FILES = 14
"""In a room, without those of the rooms in it."""

HEAVY = ("scipy", "numba", "matplotlib", "shapely", "trimesh", "torch")
IMPORT_LIMIT_S = 0.25

# Words that say who works on the project, and how; spelled so that this file does not hold them.
UNWANTED = re.compile(
    "|".join(
        (
            r"\b[aA]gents?\b",
            r"\b[cC]l[a]ude\b|\b[cC]hatG[P]T\b|\bLL[M]s?\b",
            r"\bsub-?agents?\b",
            r"\bthis (issue|task|ticket)\b",
            r"\b[iI]ssue #?\d+",
            r"/wor[k]/",
            r"/tmp/pa[t]\b",
            r"\bT[O]DO\b|\bFIXM[E]\b|\bXX[X]\b",
        )
    )
)
TEXT = {".py", ".md", ".toml", ".cff", ".yaml", ".yml", ".txt", ".cfg", ".json", ""}


def room(module: str) -> str:
    return module.split(".")[1] if "." in module else "garmentimage"


def imports(path: Path) -> set[str]:
    """Rooms that a file imports from, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
            if node.module == "garmentimage":
                names = [f"garmentimage.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        found |= {room(name) for name in names if name.split(".")[0] == "garmentimage"}
    return found


def source_files() -> list[Path]:
    return [p for p in sorted(SOURCE.rglob("*.py")) if p.parent != SOURCE or p.stem != "__init__"]


def imported(path: Path) -> set[str]:
    """Modules and packages of this project that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {node.module} | {name for name in inner if is_module(name)}
    return {name for name in found if name.split(".")[0] == "garmentimage"}


def is_module(name: str) -> bool:
    return (SOURCE.parent / name.replace(".", "/")).with_suffix(".py").is_file()


@pytest.mark.parametrize("path", source_files(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_imports_only_look_back(path):
    own = path.relative_to(SOURCE).parts[0].removesuffix(".py")
    steps = [names for names in ROOMS if own in names]
    assert steps, f"room {own!r} has no place in ROOMS yet"
    before = ROOMS[: ROOMS.index(steps[0])]
    allowed = {own, "garmentimage", "__version__"}.union(*before)
    assert imports(path) <= allowed


@pytest.mark.parametrize("path", source_files(), ids=lambda p: str(p.relative_to(SOURCE)))
def test_from_outside_a_room_only_its_package_is_imported(path):
    """`garmentimage.raster.decode` from anywhere, `....decode.curve_fit` from inside it only."""
    rooms = {".".join(folder.parts) for folder in path.relative_to(SOURCE.parent).parents}
    private = {
        name
        for name in imported(path)
        if is_module(name) and name.rsplit(".", 1)[0] not in rooms and name != "garmentimage.errors"
    }
    assert private == set()


def test_no_room_has_too_many_files():
    rooms = {path.parent for path in SOURCE.rglob("*.py")}
    crowded = {str(r.relative_to(SOURCE)) for r in rooms if len(list(r.glob("*.py"))) > MAX_FILES}
    assert crowded == set()


def run_python(code: str) -> str:
    return subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout


def test_every_public_name_is_there():
    assert all(hasattr(garmentimage, name) for name in garmentimage.__all__)


def test_no_public_name_is_that_of_a_module_beside_it():
    """Else the package's attribute depends on what was imported, and the docs show the module."""
    for stub in SOURCE.rglob("__init__.pyi"):
        modules = {path.stem for path in stub.parent.iterdir()} - {"__init__"}
        names = {
            alias.asname or alias.name
            for node in ast.parse(stub.read_text(encoding="utf-8")).body
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        assert not names & modules, stub


def test_importing_loads_nothing_heavy():
    code = f"import sys, garmentimage; print([m for m in {HEAVY!r} if m in sys.modules])"
    assert run_python(code).strip() == "[]"


def test_importing_is_quick():
    """The best of some runs, since a busy machine only ever makes it slower."""
    code = (
        "import time; t = time.perf_counter(); import garmentimage; print(time.perf_counter() - t)"
    )
    deadline = time.monotonic() + 20
    while float(run_python(code)) >= IMPORT_LIMIT_S:
        assert time.monotonic() < deadline, f"import garmentimage takes {IMPORT_LIMIT_S} s or more"


def tracked_files() -> list[Path]:
    listing = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listing.returncode != 0:
        pytest.skip("not a git checkout")
    return [ROOT / line for line in listing.stdout.splitlines()]


def test_files_speak_of_garments_only():
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in tracked_files()
        if path.suffix in TEXT and path.is_file() and path != Path(__file__)
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if UNWANTED.search(line)
    ]
    assert found == []
