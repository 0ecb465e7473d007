"""How fast a dataset is built, what the scheduler costs, and how much memory the driver takes.

    python benchmarks/dataset_speed.py FOLDER [--recipe d2] [--count 500] [-o OUT.json]

Rate: rows a second of a whole build, start of the workers included. Overhead: with one worker, the
time from the first shard to the last against the same shards made in this process, which has made
one before. Memory: greatest resident size of the driver after builds of 1 and 5 times `--memory`
rows a type, of a recipe without pictures.
"""

import argparse
import json
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

from provenance import provenance

from garmentimage.dataset.building import BuildSettings, build_dataset, make_shard, plan_shards
from garmentimage.dataset.recipe import load_recipe

OVERHEAD_COUNT = 100


def peak_mb(name: str, folder: Path, count: int) -> float:
    """Greatest resident size of a driver in a process of its own [MB]."""
    code = (
        "import re\n"
        "from pathlib import Path\n"
        "from garmentimage.dataset.building import Build, build\n"
        "from garmentimage.dataset.recipe import recipe\n"
        "if __name__ == '__main__':\n"
        f"    build(Build(recipe({name!r}), Path({str(folder)!r}), {count}))\n"
        "    status = Path('/proc/self/status').read_text()\n"
        "    print(int(re.search(r'VmHWM:\\s+(\\d+)', status).group(1)) / 1024)\n"
    )
    script = folder.with_suffix(".py")
    script.write_text(code)
    return float(subprocess.run([sys.executable, script], check=True, capture_output=True).stdout)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--recipe", default="d2")
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--memory", type=int, default=250)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    shutil.rmtree(args.folder, ignore_errors=True)
    args.folder.mkdir(parents=True)
    what = BuildSettings(load_recipe(args.recipe), args.folder / "rate", args.count)
    began = time.perf_counter()
    summary = build_dataset(what, workers=args.workers)
    seconds = time.perf_counter() - began
    result = {
        **provenance([]),
        "recipe": args.recipe,
        "workers": args.workers,
        "rows": summary["rows"],
        "share": summary["share"],
        "failed": summary["failed"],
        "seconds": round(seconds, 1),
        "rows_a_second": round(summary["rows"] / seconds, 2),
    }
    one = replace(what, folder=args.folder / "overhead", count=OVERHEAD_COUNT)
    shards = plan_shards(one)
    make_shard(shards[0])
    taken = {}
    for shard in shards:
        began = time.perf_counter()
        make_shard(shard)
        taken[shard.name] = time.perf_counter() - began
    ends: dict[str, float] = {}
    build_dataset(
        one, workers=1, progress=lambda done, _: ends.update({done.name: time.perf_counter()})
    )
    first = min(ends, key=lambda name: ends[name])
    work = sum(seconds for name, seconds in taken.items() if name != first)
    result["overhead"] = round((max(ends.values()) - ends[first]) / work - 1, 4)
    for times in (1, 5):
        count = times * args.memory
        rows = count * len(load_recipe("vae-topology").types)
        peak = peak_mb("vae-topology", args.folder / f"memory-{times}", count)
        result[f"driver_mb_{rows}_rows"] = round(peak, 1)
    print(json.dumps(result, indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
