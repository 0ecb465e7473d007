"""Where a figure comes from: commit, date, and a hash of the pattern files."""

import hashlib
from datetime import UTC, datetime
from pathlib import Path

from garmentimage.system.provenance import source_commit


def provenance(paths: list[Path]) -> dict[str, str]:
    """Commit, date and, where it is of pattern files, their hash, to be kept with a result."""
    told = {"commit": source_commit(), "date": datetime.now(UTC).date().isoformat()}
    return told | ({"data_sha256": data_hash(paths)} if paths else {})


def data_hash(folders: list[Path]) -> str:
    """SHA-256 over the names and contents of all pattern files, in order of name."""
    digest = hashlib.sha256()
    for folder in folders:
        for file in sorted(folder.rglob("*.json")):
            if not file.name.endswith("_manifest.json"):
                digest.update(f"{file.parent.name}/{file.name}".encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()
