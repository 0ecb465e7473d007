"""Bad files made by others, and what each deserves; skipped where they are absent."""

import time
from pathlib import Path

import pytest

from garmentimage.errors import PatternError
from garmentimage.pattern.files.spec import read_pattern, save_pattern
from tests.corpus import corpus_folder, unpacked

pytestmark = pytest.mark.corpus

SECONDS = 30
"""No file may take longer, on a slow machine; the slowest takes 2 on a quick one."""


def expectations():
    folder = corpus_folder()
    if folder is None or not (folder / "nasty" / "INDEX.md").is_file():
        return []
    rows = (folder / "nasty" / "INDEX.md").read_text(encoding="utf-8").splitlines()
    cells = [[c.strip() for c in row.strip("|").split("|")] for row in rows if row.startswith("|")]
    return [(c[0], c[2], c[3]) for c in cells if c[0].endswith(".json")]


@pytest.fixture(scope="module")
def nasty(tmp_path_factory):
    return unpacked("nasty/nasty_patterns.tar.xz", tmp_path_factory.mktemp("nasty"))


@pytest.mark.timed
@pytest.mark.parametrize(("name", "deserved", "place"), expectations())
def test_a_nasty_file_gets_what_it_deserves(nasty, tmp_path, name, deserved, place):
    begun = time.perf_counter()
    try:
        pattern, found = read_pattern(Path(nasty) / name)
    except PatternError as error:
        assert "ERROR" in deserved
        message = str(error)
        assert name in message
        assert "\n" not in message
        assert len(message) < 500
        assert_names(message, place)
    else:
        assert not deserved.startswith("ERROR") or "REPAIR" in deserved or "warn" in deserved
        if "warn" in deserved:
            assert found
            assert_names(" | ".join(str(f) for f in found), place)
        save_pattern(pattern, tmp_path / "again.json")
        assert read_pattern(tmp_path / "again.json")[0] == pattern
    assert time.perf_counter() - begun < SECONDS


def assert_names(message, place):
    """The panel, edge, vertex or stitch that the index names must be in the message."""
    words = place.replace(",", "").split()
    for kind in ("edge", "vertex"):
        if kind in words and words[words.index(kind) + 1].isdigit():
            assert f"{kind} {words[words.index(kind) + 1]}" in message or "edges" in message
    for word in words:
        if word in ("front", "back", "stub", "flat") or word.endswith("torso"):
            assert word in message
    if place.startswith("stitch"):
        assert place.split()[1] in message
    if "." in place:
        assert place in message
