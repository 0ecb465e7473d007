"""Plain language: docs, docstrings, comments, messages and help read as standard English.

Phrases that a stranger would stumble over, each with what to write instead. Everything that people
read is searched: Markdown pages, and strings and comments of the code, messages and help included.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("src", "docs", "scripts", "benchmarks")
EXEMPT = ("scripts/migrate_weights.py",)
"""Names keys of networks that were trained before they were renamed."""
FILES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "Makefile")


@dataclass(frozen=True)
class Phrase:
    """A regular expression, in brackets where this file would find itself, and the remedy."""

    pattern: str
    instead: str


PHRASES = (
    Phrase(r"\bto[l]d\b", "given, reported, inferred"),
    Phrase(r"\b(te[l]ls?|te[l]ling) of\b", "detects, reports, describes"),
    Phrase(r"\bunless to[l]d\b", "the default, in brackets"),
    Phrase(r"\bg(oes|one|o|oing) o[n] (with|where|from)\b", "resumes, continues"),
    Phrase(r"\bwill n[o]t do\b", "is invalid"),
    Phrase(r"\bwhat co[m]es? (of|out)\b", "the result"),
    Phrase(r"\bco[m]es? of\b", "results from"),
    Phrase(r"\bcom(es|e|ing) wit[h] (the|this) package\b", "is bundled"),
    Phrase(
        r"(?<!there )(?<!There )\bis n[o] (?!longer\b|more\b|less\b|such\b|way\b)\w+", "is not a"
    ),
    Phrase(r"\bthat are n[o]ne\b", "that are invalid"),
    Phrase(r"\bin th[e] way\b", "already exists; prevents it"),
    Phrase(r"\bto th[e] letter\b", "exactly"),
    Phrase(r"\bdo(es)? wit[h]out\b", "does not need; disables"),
    Phrase(r"\blear[n]t?\b by heart", "overfitted"),
    Phrase(r"\bgive[n] up\b", "timed out, abandoned"),
    Phrase(r"\bfor eve[r]\b", "always"),
    Phrase(r"\bwhat i[s] asked\b", "the request"),
    Phrase(r"\bthe way there and b[a]ck\b", "round trip"),
    Phrase(r"\ba way o[u]t\b", "a remedy"),
    Phrase(r"\bhang togethe[r]\b", "are connected"),
)
SEARCH = re.compile("|".join(f"(?:{phrase.pattern})" for phrase in PHRASES))


def remedy(found: str) -> str:
    return next(p.instead for p in PHRASES if re.search(p.pattern, found))


def read_by_people(path: Path) -> Iterator[tuple[int, str]]:
    """Lines with their numbers: all of a text, comments and strings of a program."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        yield from enumerate(text.splitlines(), 1)
        return
    kinds = {tokenize.STRING, tokenize.COMMENT, getattr(tokenize, "FSTRING_MIDDLE", -1)}
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in kinds:
            yield from enumerate(token.string.split("\n"), token.start[0])


def searched() -> list[Path]:
    exempt = {ROOT / name for name in EXEMPT}
    found = [ROOT / name for name in FILES]
    for folder in FOLDERS:
        for suffix in ("*.py", "*.md", "*.toml", "*.sh", "*.ipynb"):
            found += sorted((ROOT / folder).rglob(suffix))
    return [path for path in found if path not in exempt]


def findings(path: Path) -> list[str]:
    name = path.relative_to(ROOT)
    return [
        f"{name}:{number}: {match.group(0)!r} (rather: {remedy(match.group(0))})"
        for number, line in read_by_people(path)
        for match in SEARCH.finditer(line)
    ]


def room_of(path: Path) -> str:
    parts = path.relative_to(ROOT).parts
    return parts[2] if parts[:2] == ("src", "garmentimage") and len(parts) > 3 else parts[0]


@pytest.mark.parametrize("room", sorted({room_of(path) for path in searched()}))
def test_plain_language(room):
    found = [line for path in searched() if room_of(path) == room for line in findings(path)]
    assert not found, "\n".join(found)


def test_the_search_finds_a_phrase_in_a_docstring_a_comment_and_a_message(tmp_path, monkeypatch):
    phrase = "what " + "comes of it"
    file = tmp_path / "src" / "x.py"
    file.parent.mkdir()
    file.write_text(f'"""A module, {phrase}."""\n# {phrase}\nraise ValueError(f"{{1}} {phrase}")\n')
    ast.parse(file.read_text(encoding="utf-8"))
    monkeypatch.setitem(globals(), "ROOT", tmp_path)
    assert [line.split(":")[1] for line in findings(file)] == ["1", "2", "3"]
