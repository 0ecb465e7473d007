"""Pages of the documentation site that are made from the code; mkdocs.yml names them as a hook.

- `reference/python/*.md`: one page for each package, its names as the package's stub lists them.
- `contributing/files.md`: what every file of the code holds, by its own first sentence.
- `reference/commands.md`: what `python -m garmentimage VERB --help` prints, verb by verb.
- `benchmarks/results/*.json`: the measured files, so that links to them work in the built site.

No file is written into `docs`; the pages exist while the site is built.
"""

import ast
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"
PACKAGE = "garmentimage"
RESULTS = ROOT / "benchmarks" / "results"

PYTHON_PAGES = "reference/python"
COMMAND_PAGE = "reference/commands.md"
FILE_PAGE = "contributing/files.md"
HELP_COLUMNS = 100
"""Width of the help texts [characters]."""
MAX_VALUE = 120
"""Longest value of a constant that is shown whole [characters]."""
MAX_DEPTH = 3
"""Of subcommands below subcommands."""
_BOX = "│╭╮╰╯─|"
_NOT_COMMANDS = re.compile(r"^(options|parameters|arguments|positional arguments|usage)\b", re.I)


@dataclass(frozen=True)
class Room:
    """A package of the project and what it gives to others."""

    module: str
    """Dotted name, as it is imported."""
    summary: str
    """Docstring of the package."""
    names: tuple[str, ...]
    """Public names, sorted."""


@cache
def rooms() -> tuple[Room, ...]:
    """Every package with a stub, `garmentimage` itself first, then by name."""
    stubs = sorted((SOURCE / PACKAGE).rglob("__init__.pyi"))
    return tuple(_room(stub) for stub in stubs)


def _room(stub: Path) -> Room:
    module = ".".join(stub.parent.relative_to(SOURCE).parts)
    names = [
        alias.asname or alias.name
        for node in ast.parse(stub.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    summary = _docstring(stub.with_suffix(".py"))
    return Room(module, summary, tuple(sorted(names, key=_order)))


def _order(name: str) -> tuple[bool, str]:
    """Functions and classes first, constants last."""
    return name.isupper(), name.lower()


@cache
def sources() -> dict[str, dict[str, str]]:
    """Per package: public name -> dotted path of its definition, as the stubs say."""
    found: dict[str, dict[str, str]] = {}
    for stub in sorted((SOURCE / PACKAGE).rglob("__init__.pyi")):
        module = ".".join(stub.parent.relative_to(SOURCE).parts)
        tree = ast.parse(stub.read_text(encoding="utf-8"))
        found[module] = {
            alias.asname or alias.name: f"{_absolute(module, node)}.{alias.name}"
            for node in tree.body
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
    return found


def _absolute(module: str, node: ast.ImportFrom) -> str:
    parts = module.split(".")
    base = parts[: len(parts) - node.level + 1] if node.level else []
    return ".".join([*base, *filter(None, [node.module])])


def definition(module: str, name: str) -> str:
    """Dotted path of the module-level definition behind a public name, through all imports."""
    path = sources()[module][name]
    owner, _, last = path.rpartition(".")
    if last in sources().get(owner, {}):
        return definition(owner, last)
    origin = _imported(owner).get(last)
    if origin is None:
        return path
    owner, _, last = origin.rpartition(".")
    return definition(owner, last) if last in sources().get(owner, {}) else origin


@cache
def _imported(module: str) -> dict[str, str]:
    """Names that a module imports from this project, and from where."""
    return {
        alias.asname or alias.name: f"{node.module}.{alias.name}"
        for node in ast.parse(_file_of(module).read_text(encoding="utf-8")).body
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGE)
        for alias in node.names
    }


def _file_of(module: str) -> Path:
    path = SOURCE / module.replace(".", "/")
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def page_of(room: Room) -> str:
    """Path of a package's page below `docs`."""
    return f"{PYTHON_PAGES}/{room.module}.md"


@cache
def owners() -> dict[str, str]:
    """Per definition the package whose page describes it: the root, else the nearest to it."""
    found: dict[str, str] = {}
    for module in sorted(sources(), key=lambda m: (m != PACKAGE, -len(m.split(".")), m)):
        for name in sources()[module]:
            path = definition(module, name)
            if module == PACKAGE or path.startswith(f"{module}."):
                found.setdefault(path, module)
    return found


@dataclass(frozen=True)
class Constant:
    """A constant or a type alias of a module."""

    value: str
    """As the code writes it."""
    meaning: str
    """The string below it; of several assigned together, the string below all of them."""


@cache
def constants(module: str) -> dict[str, Constant]:
    """Constants and aliases that a module defines, by name."""
    body = ast.parse(_file_of(module).read_text(encoding="utf-8")).body
    found = {}
    for node, after in zip(body, [*body[1:], None], strict=True):
        if isinstance(node, ast.Assign):
            targets: list[ast.expr] = [node.targets[0]]
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets = [node.target]
        else:
            continue
        assert node.value is not None
        values = [node.value]
        if isinstance(targets[0], ast.Tuple):
            targets = targets[0].elts
            value = node.value
            values = value.elts if isinstance(value, ast.Tuple) else [value] * len(targets)
        text = ""
        if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            text = " ".join(str(after.value.value).split())
        for target, value in zip(targets, values, strict=True):
            if isinstance(target, ast.Name):
                found[target.id] = Constant(ast.unparse(value), text)
    return found


def constant(path: str) -> Constant | None:
    """The constant of a dotted path, None for functions and classes."""
    module, _, name = path.rpartition(".")
    return constants(module).get(name)


def room_page(room: Room) -> str:
    """Markdown of a package's page: an entry for each name that no other page describes."""
    lines = [f"# `{room.module}`", "", room.summary, ""]
    rows, elsewhere = [], []
    for name in room.names:
        path = definition(room.module, name)
        owner = owners().get(path, room.module)
        value = constant(path)
        if owner != room.module:
            known = {definition(owner, other): other for other in sources()[owner]}
            elsewhere.append(f"[`{name}`]({owner}.md#{owner}.{known[path]})")
        elif value is None:
            lines += [f"::: {room.module}.{name}", ""]
        else:
            rows.append(_constant_row(f"{room.module}.{name}", value))
    if rows:
        lines += [
            "## Constants and types",
            "",
            "| name | value | meaning |",
            "|---|---|---|",
            *rows,
        ]
        lines.append("")
    if elsewhere:
        lines += [f"Also here, described on other pages: {', '.join(elsewhere)}.", ""]
    return "\n".join(lines)


def _constant_row(path: str, value: Constant) -> str:
    name = path.rpartition(".")[2]
    shown = value.value if len(value.value) <= MAX_VALUE else value.value[:MAX_VALUE] + " ..."
    cells = (f'<a id="{path}"></a>`{name}`', f"`{shown}`", value.meaning)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def index_page() -> str:
    """The list of all packages."""
    rows = [
        f"| [`{room.module}`]({room.module}.md) | {_first_sentence(room.summary)} |"
        for room in rooms()
    ]
    return "\n".join(
        [
            "# Python API",
            "",
            f"`import {PACKAGE} as gi` gives the names of [`{PACKAGE}`]({PACKAGE}.md), which is",
            "all that most programs need. Further names are imported from the package that they",
            "belong to, such as `from garmentimage.compare import compare_patterns`. Modules",
            "inside a package are private. Lengths are cm unless a page says otherwise.",
            "",
            "| package | what it is |",
            "|---|---|",
            *rows,
            "",
        ]
    )


def _first_sentence(text: str) -> str:
    paragraph = " ".join(text.split("\n\n")[0].split())
    return re.split(r"(?<=[.])\s(?=[A-Z])", paragraph)[0].replace("|", "\\|")


def file_page() -> str:
    """Markdown of the list of all files, package by package."""
    lines = [
        "# Files",
        "",
        "Every file of the code and what it holds, in its own first sentence. Packages are in",
        "alphabetical order; the [floor plan](floor-plan.md) has the order of the data flow.",
        "",
    ]
    for package in sorted(p.parent for p in (SOURCE / PACKAGE).rglob("__init__.py")):
        name = ".".join(package.relative_to(SOURCE).parts)
        files = [f for f in sorted(package.glob("*.py")) if not f.stem.startswith("__")]
        lines += [f"## `{name}`", "", _first_sentence(_docstring(package / "__init__.py")), ""]
        lines += ["| file | what it holds |", "|---|---|"] if files else []
        lines += [f"| `{f.name}` | {_first_sentence(_docstring(f))} |" for f in files]
        lines.append("")
    return "\n".join(lines)


def _docstring(file: Path) -> str:
    return ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""


def help_of(words: tuple[str, ...]) -> str | None:
    """What `garmentimage WORDS --help` prints, None where there is no such command."""
    path = os.pathsep.join(filter(None, [str(SOURCE), os.environ.get("PYTHONPATH")]))
    plain = {"COLUMNS": str(HELP_COLUMNS), "NO_COLOR": "1", "TERM": "dumb", "PYTHONPATH": path}
    done = subprocess.run(
        [sys.executable, "-m", PACKAGE, *words, "--help"],
        env={**os.environ, **plain},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    return done.stdout.rstrip() if done.returncode == 0 and done.stdout.strip() else None


def listed_commands(text: str) -> list[str]:
    """Words that a help text lists as commands, whichever library printed it.

    They stand at the start of indented or boxed lines, under any heading but those of options and
    parameters.
    """
    found: list[str] = []
    takes = False
    for line in text.splitlines():
        boxed = line.startswith(tuple(_BOX))
        inner = line.strip(_BOX + " ")
        heading = line.startswith("╭") or (line[:1].strip() and line.endswith(":") and not boxed)
        if heading:
            takes = not _NOT_COMMANDS.match(inner)
        elif takes and (word := _command(line.strip("│|"), inner)) and word not in found:
            found.append(word)
    return found


def _command(line: str, inner: str) -> str | None:
    match = re.match(r"^ {1,6}([a-z][a-z0-9]*(?:-[a-z0-9]+)*)(?: {2,}\S|\s*$)", line)
    return match.group(1) if match and inner else None


@cache
def commands() -> dict[tuple[str, ...], str]:
    """Help text of every command and subcommand, in the order in which they are listed."""
    start = help_of(())
    if start is None:
        raise RuntimeError(f"`python -m {PACKAGE} --help` failed")
    with ThreadPoolExecutor(2) as pool:
        return {(): start, **_below((), start, pool)}


def _below(
    words: tuple[str, ...], text: str, pool: ThreadPoolExecutor
) -> dict[tuple[str, ...], str]:
    if len(words) == MAX_DEPTH:
        return {}
    paths = [(*words, word) for word in listed_commands(text)]
    found: dict[tuple[str, ...], str] = {}
    for path, printed in zip(paths, pool.map(help_of, paths), strict=True):
        if printed is not None and printed != text:
            found |= {path: printed, **_below(path, printed, pool)}
    return found


def command_page() -> str:
    """Markdown of the command reference."""
    lines = [
        "# Commands",
        "",
        "What `garmentimage COMMAND --help` prints, made when this site was built.",
        "[Errors and exit codes](errors.md) are the same for all commands.",
        "",
    ]
    for words, text in commands().items():
        level = min(len(words) + 1, 4) if words else 2
        title = " ".join(["garmentimage", *words])
        lines += [f"{'#' * level} `{title}`", "", "```text", text, "```", ""]
    return "\n".join(lines)


def on_config(config):
    """Put the pages of the packages into the navigation, below the entry `Python API`."""
    from mkdocs.config.defaults import MkDocsConfig

    assert isinstance(config, MkDocsConfig)
    pages = [f"{PYTHON_PAGES}/index.md", *({room.module: page_of(room)} for room in rooms())]
    for section in config.nav or []:
        for entries in section.values():
            for entry in entries if isinstance(entries, list) else []:
                if isinstance(entry, dict) and "Python API" in entry:
                    entry["Python API"] = pages
    return config


def on_files(files, config):
    """Add the generated pages and the measured files."""
    from mkdocs.structure.files import File

    made = {
        f"{PYTHON_PAGES}/index.md": index_page(),
        COMMAND_PAGE: command_page(),
        FILE_PAGE: file_page(),
        **{page_of(room): room_page(room) for room in rooms()},
    }
    for path, text in made.items():
        files.append(File.generated(config, path, content=text))
    for file in sorted(RESULTS.glob("*.json")):
        place = f"benchmarks/results/{file.name}"
        files.append(File.generated(config, place, abs_src_path=str(file)))
    return files


def on_page_markdown(markdown, page, **_):
    """Links to measured files hold in the repository and in the site."""
    if page.file.src_uri.startswith("benchmarks/"):
        return markdown.replace("](../../benchmarks/results/", "](results/")
    return markdown.replace("](../../benchmarks/results/", "](../benchmarks/results/")


def on_post_build(config):
    """Refuse pages that would load anything from the net when they are viewed."""
    from mkdocs.exceptions import PluginError

    loads = re.compile(r"<(?:script|img|iframe|source)[^>]+src=[\"']?(?:https?:)?//[^>]+>")
    styles = re.compile(r"<link[^>]+rel=[\"']?(?:stylesheet|preconnect)[^>]+(?:https?:)?//[^>]+>")
    for page in sorted(Path(config.site_dir).rglob("*.html")):
        text = page.read_text(encoding="utf-8")
        found = loads.search(text) or styles.search(text)
        if found:
            raise PluginError(f"{page} loads something from the net: {found.group(0)}")
