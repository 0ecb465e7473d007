"""Keep what matters of a round-trip report, with where it came from.

    garmentimage roundtrip FOLDER... --grid 16 --report report.json
    python benchmarks/condense.py report.json FOLDER... -o benchmarks/results/roundtrip-16.json

The result holds the figures of each kind, every failure with its reason, the commit, the date and
a hash of the pattern files, so that the figures can be made again and compared.
"""

import argparse
import json
import sys
from pathlib import Path

from provenance import provenance


def condensed(report: dict, folders: list[Path]) -> dict:
    """The report without the files that came back the same."""
    failures = {}
    for row in report["files"]:
        trip = row["with_marks"]
        if not trip["success"]:
            failures[row["file"]] = trip.get("message") or "; ".join(trip["reasons"])
    return {
        **provenance(folders),
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
