"""Keep what matters of a round-trip report, with where it came from.

    garmentimage roundtrip FOLDER... --grid 16 --report report.json
    python benchmarks/condense.py report.json FOLDER... -o benchmarks/results/roundtrip-16.json

The result holds the figures of each kind, every failure with its reason, the commit, the date and
a hash of the pattern files, so that the figures can be made again and compared.
"""

import argparse
import hashlib
import json
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path


def data_hash(folders: list[Path]) -> str:
    """SHA-256 over the names and contents of all pattern files, in order of name."""
    digest = hashlib.sha256()
    for folder in folders:
        for file in sorted(folder.rglob("*.json")):
            if not file.name.endswith("_manifest.json"):
                digest.update(f"{file.parent.name}/{file.name}".encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()


def condensed(report: dict, folders: list[Path]) -> dict:
    """The report without the files that came back the same."""
    failures = {}
    for row in report["files"]:
        trip = row["with_marks"]
        if not trip["success"]:
            failures[row["file"]] = trip.get("message") or "; ".join(trip["reasons"])
    commit = subprocess.run(
        ["git", "rev-parse", "HEAD"], capture_output=True, text=True, check=False
    ).stdout.strip()
    return {
        "commit": commit,
        "date": datetime.now(UTC).date().isoformat(),
        "data_sha256": data_hash(folders),
        "grid": report["grid"],
        "versions": report["versions"],
        "summary": report["summary"],
        "failures": failures,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("report", type=Path)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True)
    args = parser.parse_args()
    result = condensed(json.loads(args.report.read_text()), args.folders)
    args.out.write_text(json.dumps(result, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
