"""Where pattern files by others lie, for tests that need them; they are not part of the project.

`GARMENTIMAGE_CORPUS` names their folder; without it `shared` beside the repository is looked at.
Good patterns are its `gpg` and `garmentcode`, or what `patterns/dev_patterns.tar.xz` unpacks to.
Tests that need files which are not there are skipped.
"""

import os
import tarfile
import tempfile
from functools import cache
from pathlib import Path

import pytest

from garmentimage.metrics.roundtrip import garment_kind

ROOT = Path(__file__).parents[1]
PATTERNS = "patterns/dev_patterns.tar.xz"
PATTERN_FOLDERS = ("gpg", "garmentcode")
SAMPLE_SIZE = 200
"""Files of the fixed sample that continuous integration runs."""


def corpus_folder() -> Path | None:
    """GARMENTIMAGE_CORPUS, or a folder `shared` beside the repository."""
    given = os.environ.get("GARMENTIMAGE_CORPUS")
    folder = Path(given) if given else ROOT.parent / "shared"
    return folder if folder.is_dir() else None


def unpacked(archive: str, target: Path) -> Path:
    """The archive of the corpus, unpacked into `target`; skips the test where there is none."""
    folder = corpus_folder()
    if folder is None or not (folder / archive).is_file():
        pytest.skip(f"no {archive} in GARMENTIMAGE_CORPUS or ../shared")
    _extract(folder / archive, target)
    return target


def _extract(archive: Path, target: Path) -> None:
    with tarfile.open(archive) as tar:
        # Python before 3.11.4 knows no filters; nor does it need them for our own archives.
        tar.extraction_filter = getattr(tarfile, "data_filter", lambda member, path: member)
        tar.extractall(target)


def corpus_files() -> list[Path]:
    """All good patterns, sorted; skips the test where there are none."""
    root = _patterns_folder()
    return sorted(path for folder in PATTERN_FOLDERS for path in (root / folder).rglob("*.json"))


def corpus_sample(count: int = SAMPLE_SIZE) -> list[Path]:
    """The same files every time: each kind in proportion, evenly spread over its sorted names."""
    return sample(corpus_files(), count)


def sample(files: list[Path], count: int) -> list[Path]:
    """`count` of `files` by rule: at least one of each kind, the rest in proportion."""
    kinds: dict[str, list[Path]] = {}
    for path in sorted(files):
        kinds.setdefault(garment_kind(path), []).append(path)
    spare = max(count - len(kinds), 0)
    wished = {kind: spare * len(paths) / len(files) for kind, paths in kinds.items()}
    quota = {kind: 1 + int(wish) for kind, wish in wished.items()}
    # Largest remainder: the kinds that rounding down has cost most get one more.
    by_loss = sorted(kinds, key=lambda kind: (int(wished[kind]) - wished[kind], kind))
    for kind in by_loss[: max(count - sum(quota.values()), 0)]:
        quota[kind] += 1
    chosen = {
        paths[k * len(paths) // quota[kind]]
        for kind, paths in kinds.items()
        for k in range(quota[kind])
    }
    return sorted(chosen)


def _patterns_folder() -> Path:
    folder = corpus_folder()
    if folder is not None and all((folder / name).is_dir() for name in PATTERN_FOLDERS):
        return folder
    if folder is None or not (folder / PATTERNS).is_file():
        pytest.skip("no patterns by others in GARMENTIMAGE_CORPUS or ../shared")
    return _unpacked_once(folder / PATTERNS)


@cache
def _unpacked_once(archive: Path) -> Path:
    """The archive's folder, unpacked once for each state of the archive."""
    state = archive.stat()
    name = f"garmentimage-corpus-{state.st_size}-{state.st_mtime_ns}"
    target = Path(tempfile.gettempdir(), name)
    if not target.is_dir():
        with tempfile.TemporaryDirectory(dir=target.parent) as folder:
            _extract(archive, Path(folder, "corpus"))
            try:
                Path(folder, "corpus").rename(target)
            except OSError:  # Another test process was quicker.
                assert target.is_dir()
    return target
