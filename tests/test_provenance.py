"""Where results come from."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from garmentimage import provenance


def test_versions_name_python_and_what_is_installed_only():
    told = provenance.versions("no-such-package")
    assert told[0].startswith("Python 3.")
    assert any(name.startswith("numpy ") for name in told)
    assert not any("no-such-package" in name for name in told)


def told_by(file: Path) -> str:
    code = f"import runpy; print(runpy.run_path({str(file)!r})['source_commit']())"
    return subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout.strip()


def git(folder: Path, *words: str) -> str:
    options = ["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false"]
    return subprocess.run(
        ["git", "-C", folder, *options, *words], check=True, capture_output=True, text=True
    ).stdout.strip()


def test_the_commit_of_a_clone_is_told_with_its_changes(tmp_path):
    file = tmp_path / "provenance.py"
    shutil.copy(provenance.__file__, file)
    assert told_by(file) == ""
    git(tmp_path, "init", "-q")
    git(tmp_path, "commit", "-q", "--allow-empty", "-m", "nothing")
    assert told_by(file) == ""  # a package that is installed inside some other repository
    git(tmp_path, "add", file.name)
    git(tmp_path, "commit", "-q", "-m", "all")
    assert re.fullmatch("[0-9a-f]{40}", told_by(file))
    file.write_text(file.read_text() + "\n")
    assert told_by(file).endswith("+changed")
