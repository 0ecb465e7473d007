"""How long encoding, decoding, importing and starting take, on one core.

    python benchmarks/speed.py [FILE_OR_FOLDER...] [--grid N] [--other ADAPTER.py] [--folder]

Without files, the bundled patterns. Each file is encoded and decoded `--repeats` times after a
first, untimed time; the table gives the median, the slowest tenth and the worst over the files.
`--other` names a Python file with a function `encode_file(path, grid)` that runs another encoder:
its times are taken in turn with ours, in the same process, and the ratio is reported (over the
files that both encode). The shares of encoding's stages are taken from a profile, and `--folder`
measures round trips of all files with one process and with one for each core.
"""

import argparse
import cProfile
import importlib.util
import os
import pstats
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported
CORES = os.sched_getaffinity(0) if hasattr(os, "sched_setaffinity") else set()
if CORES:
    os.sched_setaffinity(0, {min(CORES)})

import numpy as np

import garmentimage as gi
from garmentimage.examples import example_names, example_path
from garmentimage.pattern.files.spec import read_pattern

FRESH_REPEATS = 5
NAME_WIDTH = 48
STAGES = {
    "placing, splitting, seams": (
        ("placement.py", "place"),
        ("seam_graph.py", "build_seam_graph"),
    ),
    "layout": (("solve.py", "draw"),),
    "routing": (("route.py", "route"),),
    "compaction": (("attempts.py", "_compacted"),),
    "polish": (("polish.py", "polish"),),
    "symmetry and numbering": (
        ("symmetry.py", "find_mirror"),
        ("symmetry.py", "right_half"),
        ("canonical.py", "canonical"),
    ),
    "deformation": (("rasterize.py", "_deform"),),
    "proof": (("proof.py", "disproof"),),
}
"""Functions by which the stages of encoding are recognised."""
FRESH = "import garmentimage as gi; gi.decode(gi.encode(gi.load_pattern({path!r}), grid={grid}))"


def main() -> None:
    options = arguments()
    paths = pattern_files(options.paths) or [Path(example_path(n)) for n in example_names()]
    other = adapter(options.other) if options.other else None
    rows: dict[str, list[float]] = {"encode": [], "decode": [], "other": [], "both": []}
    refused = 0
    for path in paths:
        try:
            times = file_times(path, options.grid, options.repeats, other)
        except gi.GarmentImageError as error:
            refused += 1
            print(f"{path.name}: {error}", file=sys.stderr)
            continue
        for name, value in times.items():
            rows[name].append(value)
        if "other" in times:
            rows["both"].append(times["encode"])
    load = os.getloadavg()[0]
    print(f"{len(paths) - refused} files, N = {options.grid}, one core, load {load:.1f}; in ms\n")
    print(f"{'step':{NAME_WIDTH}}{'median':>9}{'90 %':>9}{'worst':>9}")
    for name, values in rows.items():
        if values and name != "both":
            print_row("other encoder" if name == "other" else name, values)
    if rows["other"]:
        ratio = np.median(np.array(rows["other"]) / np.array(rows["both"]))
        print(f"{'other encoder / encode, median':{NAME_WIDTH}}{ratio:9.1f}")
    for name, values in fresh_times(paths[0], options.grid).items():
        print_row(name, values)
    print("\nshare of encoding, by profile")
    for name, share in stage_shares(paths, options.grid).items():
        print(f"{name:{NAME_WIDTH}}{share:9.1%}")
    if options.folder:
        print(f"\n{len(paths)} round trips, s")
        for workers, seconds in folder_times(paths, options.grid).items():
            print(f"{f'{workers} processes':{NAME_WIDTH}}{seconds:9.1f}")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path)
    parser.add_argument("--grid", type=int, default=16)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--other", type=Path)
    parser.add_argument("--folder", action="store_true", help="measure round trips on all cores")
    return parser.parse_args()


def pattern_files(paths: list[Path]) -> list[Path]:
    return [f for p in paths for f in (sorted(p.rglob("*.json")) if p.is_dir() else [p])]


def adapter(path: Path) -> Callable[[Path, int], object]:
    spec = importlib.util.spec_from_file_location("other_encoder", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.encode_file


def file_times(
    path: Path, grid: int, repeats: int, other: Callable[[Path, int], object] | None
) -> dict[str, float]:
    """Median milliseconds of each step on one file; the steps take turns."""
    pattern, _ = read_pattern(path)
    image = gi.encode(pattern, grid=grid)
    steps = {
        "encode": lambda: gi.encode(pattern, grid=grid),
        "decode": lambda: gi.decode(image),
    }
    if other:
        steps["other"] = lambda: other(path, grid)
    for name, step in list(steps.items()):
        try:
            step()
        except Exception as error:
            if name != "other":
                raise
            print(f"{path.name}: the other encoder fails ({error})", file=sys.stderr)
            del steps[name]
    taken = {name: [] for name in steps}
    for _ in range(repeats):
        for name, step in steps.items():
            taken[name].append(milliseconds(step))
    return {name: float(np.median(values)) for name, values in taken.items()}


def stage_shares(paths: list[Path], grid: int) -> dict[str, float]:
    """What share of encoding's time each stage takes, over all files."""
    patterns = [read_pattern(path)[0] for path in paths]
    profile = cProfile.Profile()
    for pattern in patterns:
        try:
            profile.runcall(gi.encode, pattern, grid=grid)
        except gi.GarmentImageError:
            continue
    taken: dict[tuple[str, str], float] = {}
    for (file, _, name), row in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        key = Path(file).name, name
        taken[key] = taken.get(key, 0.0) + row[3]
    whole = taken["encoder.py", "encode"]
    shares = {
        s: sum(taken.get(f, 0.0) for f in functions) / whole for s, functions in STAGES.items()
    }
    return shares | {"the rest": 1 - sum(shares.values())}


def folder_times(paths: list[Path], grid: int) -> dict[int, float]:
    """Seconds that the round trips of all files take, start of the processes included."""
    from garmentimage.metrics.roundtrip import roundtrip_many

    if CORES:
        os.sched_setaffinity(0, CORES)
    counts = sorted({1, len(CORES) or os.cpu_count() or 1})
    return {
        n: milliseconds(lambda n=n: roundtrip_many(paths, grid, workers=n)) / 1000 for n in counts
    }


def fresh_times(path: Path, grid: int) -> dict[str, list[float]]:
    """Milliseconds of whole new processes; the bare interpreter's start is in all of them."""

    def run(*arguments: str, **variables: str) -> float:
        environment = {**os.environ, **variables}
        command = [sys.executable, "-W", "ignore", *arguments]
        return milliseconds(
            lambda: subprocess.run(command, env=environment, check=True, capture_output=True)
        )

    way = FRESH.format(path=str(path), grid=grid)
    with tempfile.TemporaryDirectory() as empty:
        compiling = run("-c", way, NUMBA_CACHE_DIR=empty)
    starts = {
        "python, no import": ("-c", "pass"),
        "import garmentimage": ("-c", "import garmentimage"),
        "garmentimage --version": ("-m", "garmentimage", "--version"),
        "garmentimage check FILE": ("-m", "garmentimage", "check", str(path)),
        "encode and decode, new process, compiled before": ("-c", way),
    }
    taken = {
        name: [run(*command) for _ in range(FRESH_REPEATS)] for name, command in starts.items()
    }
    return taken | {"the same, compiling first": [compiling]}


def milliseconds(step: Callable[[], object]) -> float:
    start = perf_counter()
    step()
    return 1000 * (perf_counter() - start)


def print_row(name: str, values: list[float]) -> None:
    slowest = np.quantile(values, 0.9)
    print(f"{name:{NAME_WIDTH}}{np.median(values):9.1f}{slowest:9.1f}{max(values):9.1f}")


if __name__ == "__main__":
    main()
