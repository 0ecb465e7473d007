"""Keep what matters of a round-trip report, with where it came from.

    garmentimage roundtrip FOLDER... --grid 16 --report report.json
    python benchmarks/condense.py report.json FOLDER... -o benchmarks/results/roundtrip-16.json

The result holds the figures of each kind, every failure with its reason, the commit, the date and
a hash of the pattern files, so that the figures can be made again and compared. Folders of designs
of all sorts, as GarmentCodeData's, are also classified by the names of their panels; causes are
classes of reasons.
"""

import argparse
import json
import re
import sys
from collections import Counter
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
        "garments": by_garment(report, folders),
        "causes": dict(Counter(cause(reason) for reason in failures.values()).most_common()),
        "failures": failures,
    }


GARMENTS = (
    ("hood", "with a hood"),
    ("collar", "with a collar"),
    ("torso.*pant|pant.*torso", "top and trousers"),
    ("torso.*skirt|skirt.*torso", "dress, or top and skirt"),
    ("torso", "top"),
    ("pant", "trousers"),
    ("skirt", "skirt"),
)
"""What panels are called together -> what the garment is; the first that fits. Skirts of cuffs,
`sl_cuff_skirt`, are none."""
CAUSES = (
    ("right side to wrong side|lie on top of each other", "needs a second cloth layer"),
    ("seams of panels .* cross", "seams cross when laid flat"),
    ("crowd each other", "seams crowd each other"),
    ("do not all fit|too small for", "panels do not fit the grid"),
    ("grid edges left", "too few grid edges for a bend"),
    ("cross or touch each other near", "an outline that crosses itself"),
    ("does not decode to it", "refused by its proof"),
    ("took longer|timed out", "timed out"),
)


def cause(reason: str) -> str:
    """The class of a reason; those that fit a finer grid are a class of their own."""
    name = next((name for rule, name in CAUSES if re.search(rule, reason)), "came back different")
    return f"{name}; fits a finer grid" if "it fits a grid of" in reason else name


def by_garment(report: dict, folders: list[Path]) -> dict:
    """For what garments are by their panels: files, and those that came back the same."""
    files = {f"{p.parent.name}/{p.name}": p for folder in folders for p in folder.rglob("*.json")}
    counts: dict[str, dict[str, int]] = {}
    for row in report["files"]:
        pattern = json.loads(files[row["file"]].read_text())["pattern"]
        names = " ".join(sorted(pattern["panels"])).replace("cuff_skirt", "cuff")
        kind = next((kind for rule, kind in GARMENTS if re.search(rule, names)), "other")
        told = counts.setdefault(kind, {"files": 0, "same": 0, "same_without_marks": 0, "wraps": 0})
        told["files"] += 1
        told["same"] += row["with_marks"]["success"]
        told["same_without_marks"] += row["without_marks"]["success"]
        told["wraps"] += row["wrapped_panels"] > 0
    return dict(sorted(counts.items()))


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
