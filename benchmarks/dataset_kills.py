"""Datasets whose building is killed: after resuming, the same rows as without, and none twice.

    python benchmarks/dataset_kills.py FOLDER [--recipe d2] [--count 125] [--kills 5] [-o OUT.json]

The recipe is built once undisturbed. Then it is built again, its driver killed (signal 9, with all
its processes) at random moments and started anew; and once more, one of its workers killed at
random moments instead. The shards of all three must be equal, byte for byte.
"""

import argparse
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from provenance import provenance

GARMENTIMAGE = [sys.executable, "-m", "garmentimage"]


def digests(folder: Path) -> dict[str, str]:
    return {
        f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in sorted(folder.glob("data/*"))
    }


def start(args: argparse.Namespace, folder: Path) -> subprocess.Popen[bytes]:
    command = [*GARMENTIMAGE, "build", args.recipe, "--count", str(args.count), "-o", str(folder)]
    return subprocess.Popen(command, start_new_session=True, stderr=subprocess.DEVNULL)


def workers_of(driver: int) -> list[int]:
    """Processes below the driver that work: all of its children's children with most CPU time."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
            if os.getsid(int(stat.parent.name)) == driver and int(stat.parent.name) != driver:
                found.append((int(fields[11]), int(stat.parent.name)))
        except (OSError, ValueError):
            continue
    return [pid for _, pid in sorted(found, reverse=True)[:2]]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--recipe", default="d2")
    parser.add_argument("--count", type=int, default=125)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    rng = random.Random(args.seed)
    shutil.rmtree(args.folder, ignore_errors=True)
    began = time.monotonic()
    assert start(args, args.folder / "whole").wait() == 0
    whole, seconds = digests(args.folder / "whole"), time.monotonic() - began
    result = {**provenance([]), "rows": 0, "whole_s": round(seconds, 1)}
    result["rows"] = json.loads((args.folder / "whole" / "summary.json").read_text())["rows"]

    killed_at = []
    for _ in range(args.kills):
        driver, wait = start(args, args.folder / "driver"), rng.uniform(3, seconds / 2)
        time.sleep(wait)
        if driver.poll() is None:
            os.killpg(driver.pid, signal.SIGKILL)
            killed_at.append(round(wait, 1))
        driver.wait()
        left = digests(args.folder / "driver")
        assert left.items() <= whole.items(), "a shard is not whole"
    assert start(args, args.folder / "driver").wait() == 0
    result["driver_killed_at_s"] = killed_at
    result["driver_same"] = digests(args.folder / "driver") == whole

    driver, killed_at = start(args, args.folder / "worker"), []
    began = time.monotonic()
    for _ in range(args.kills):
        time.sleep(rng.uniform(3, seconds / 4))
        victims = workers_of(driver.pid)
        if driver.poll() is None and victims:
            os.kill(rng.choice(victims), signal.SIGKILL)
            killed_at.append(round(time.monotonic() - began, 1))
    result["worker_exit"] = driver.wait()
    result["worker_killed_at_s"] = killed_at
    result["worker_same"] = digests(args.folder / "worker") == whole
    print(json.dumps(result, indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0 if result["driver_same"] and result["worker_same"] else 1


if __name__ == "__main__":
    sys.exit(main())
