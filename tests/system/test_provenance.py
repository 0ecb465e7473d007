"""Where results come from."""

import re
import subprocess
from pathlib import Path

from garmentimage.system import provenance


def test_versions_name_python_and_what_is_installed_only():
    told = provenance.versions("no-such-package")
    assert told[0].startswith("Python 3.")
    assert any(name.startswith("numpy ") for name in told)
    assert not any("no-such-package" in name for name in told)


def git(folder: Path, *words: str) -> str:
    options = ["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false"]
    return subprocess.run(
        ["git", "-C", folder, *options, *words], check=True, capture_output=True, text=True
    ).stdout.strip()


def test_the_commit_of_a_clone_is_given_with_changes_anywhere_in_the_package(tmp_path):
    module = tmp_path / "room" / "module.py"
    module.parent.mkdir()
    module.write_text("")
    (tmp_path / "__init__.py").write_text("")
    assert provenance.commit_of(tmp_path) == ""
    git(tmp_path, "init", "-q")
    git(tmp_path, "commit", "-q", "--allow-empty", "-m", "nothing")
    assert provenance.commit_of(tmp_path) == ""  # it is installed inside some other repository
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-q", "-m", "all")
    assert re.fullmatch("[0-9a-f]{40}", provenance.commit_of(tmp_path))
    module.write_text("\n")
    assert provenance.commit_of(tmp_path).endswith("+changed")
