"""Every kind of garment at random: drafted, judged and sent through the raster and back.

    python benchmarks/drafting.py data/drafts [--count 500] [--seed 0] [--grid 16] [-o OUT.json]

Samples `count` garments of each kind into a folder of its own (made again each time), on bodies
drawn at random, and tells per kind: draws rejected, drafts a second on one core, and of the
round trip at one grid the share that comes back the same, and the panels' IoU.
"""

import argparse
import json
import shutil
import statistics
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from provenance import provenance
from tqdm import tqdm

from garmentimage.draft.kind import KINDS
from garmentimage.draft.sampling import ANY_BODY, sample
from garmentimage.metrics.roundtrip import roundtrip_many, summarise, summary_table
from garmentimage.pattern.files.spec import save_pattern


def sampled(kind: str, count: int, seed: int, folder: Path) -> dict[str, Any]:
    """Draft garments of a kind into a folder; how many draws were rejected, why, and how fast."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    times: list[float] = []
    reasons: dict[str, int] = {}
    drawn = sample(kind, count, seed, body=ANY_BODY)
    while True:
        start = time.process_time()
        one = next(drawn, None)
        if one is None:
            break
        times.append((time.process_time() - start) / (1 + len(one.rejected)))
        for reason in one.rejected:
            reasons[reason] = reasons.get(reason, 0) + 1
        save_pattern(one.pattern, folder / f"{kind}_{seed}_{one.index:06d}.json")
    rejected = sum(reasons.values())
    return {
        "count": count,
        "rejected": rejected,
        "rejected_share": round(rejected / (count + rejected), 4),
        "reasons": dict(sorted(reasons.items(), key=lambda item: -item[1])[:10]),
        "drafts_a_second": round(1 / statistics.median(times)),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path, help="where the drafted patterns go")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--grid", type=lambda text: text if text == "auto" else int(text), default=16
    )
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--workers", type=int, default=None)
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    drafts = {}
    for kind in args.kinds:
        drafts[kind] = sampled(kind, args.count, args.seed, args.folder / kind)
        print(kind, json.dumps(drafts[kind]), flush=True)
    files = [f for kind in args.kinds for f in sorted((args.folder / kind).glob("*.json"))]
    with tqdm(total=len(files), disable=None, leave=False) as bar:
        reports = roundtrip_many(
            files, args.grid, workers=args.workers, progress=lambda _: bar.update()
        )
    summary = summarise(reports)
    print(summary_table(summary))
    failures = {
        r.file: r.with_marks.message
        or "; ".join(r.with_marks.result.reasons if r.with_marks.result else ())
        for r in reports
        if not r.with_marks.success
    }
    for name, reason in failures.items():
        print(f"{name}: {reason}")
    if args.out:
        result = {
            **provenance([args.folder / kind for kind in args.kinds]),
            "seed": args.seed,
            "grid": args.grid,
            "drafts": drafts,
            "round_trip": [asdict(row) for row in summary],
            "failures": failures,
        }
        args.out.write_text(json.dumps(result, indent=1, default=str) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
