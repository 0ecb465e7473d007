"""Where a result comes from: the commit of this package, and the versions of what it stands on."""

import hashlib
import platform
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

WEIGHT_FILES = ("decoder.onnx", "encoder.onnx", "model.safetensors", "predictor.onnx")
"""Files that tell a network from others."""
PACKAGES = ("garmentimage", "numpy", "numba", "scipy", "shapely", "pillow")


def source_commit() -> str:
    """The commit of the clone that this package runs from, see `commit_of`."""
    return commit_of(Path(__file__).parents[1])


def commit_of(package: Path) -> str:
    """The commit of the clone that a Python package lies in; empty where it lies in none.

    `+changed` follows where files of the package differ from the commit.
    """
    commit = _git(package, "rev-parse", "HEAD")
    if not commit or _git(package, "ls-files", "--error-unmatch", "__init__.py") is None:
        return ""
    return commit + ("+changed" if _git(package, "status", "--porcelain", ".") else "")


def versions(*more: str) -> list[str]:
    """Python and the packages that results depend on, with these too: `numpy 2.4.6`."""
    found = [f"Python {platform.python_version()}"]
    for name in (*PACKAGES, *more):
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return found


def weights_hash(folder: Path) -> str:
    """SHA-256 of a network's files."""
    digest = hashlib.sha256()
    for name in WEIGHT_FILES:
        if (folder / name).is_file():
            digest.update((folder / name).read_bytes())
    return digest.hexdigest()


def _git(folder: Path, *words: str) -> str | None:
    """What git prints, or None where it fails."""
    try:
        done = subprocess.run(
            ["git", "-C", folder, *words], capture_output=True, text=True, check=False, timeout=20
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip() if done.returncode == 0 else None
