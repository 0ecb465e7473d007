"""How long a drape takes on one core, by stage, and how many more two processes do.

    python benchmarks/drape_speed.py [FILE...] [--vertices 2000] [--repeats 3] [--scaling 24]
    python benchmarks/drape_speed.py --other ADAPTER.py
    python benchmarks/drape_speed.py --newton

Without files, the bundled patterns and the middle draft of each kind. Each garment is draped
`--repeats` times after a first, untimed time; a figure is the median of its CPU times.
`--scaling N` measures the wall time of N drapes with one and with two processes.
`--other` names a Python file with a function `drape_file(path, body, vertices)` that runs another
drape program up to a picture of 256 pixels: it is given the pattern as a file, placed on the body,
its times are taken in turn with ours, and the ratio is reported. `--newton` drapes the bundled
dress with the solvers of newton, which must be installed.
"""

import argparse
import importlib.util
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import numpy as np
from provenance import provenance

from garmentimage.body.body import Body, load_body
from garmentimage.body.body_measurements import measurements
from garmentimage.body.stance import stand_straight
from garmentimage.draft.kind import KINDS
from garmentimage.draft.sampling import drafted
from garmentimage.drape import draping as wear
from garmentimage.drape.draped_garment import DrapedGarment
from garmentimage.drape.fabric import load_fabric
from garmentimage.drape.start.placement import place_on_body
from garmentimage.examples import example_names, example_path
from garmentimage.pattern.files.spec import load_pattern, save_pattern
from garmentimage.pattern.model import Pattern
from garmentimage.render.worn.photographing import body_camera, picture
from garmentimage.render.worn.surface import surfaces_of
from garmentimage.system.processes import TimedOut, map_in_processes

BODY, FABRIC = "mean-female", "cotton"
STAGES = {
    "mesh": ("mesh", "rest_of"),
    "placing": ("standing", "start_points", "items"),
    "simulation": ("solve",),
    "judging": ("judge",),
}
"""Functions that `drape` calls, by the stage that they belong to."""
LARGE, SMALL = 256, 64
"""Sizes of the pictures [pixel]."""
TIME_LIMIT_S = 120.0
NEWTON_SOLVERS = ("style3d", "vbd")
NAME_WIDTH = 24

Adapter = Callable[[Path, Body, int], object]


def main() -> int:
    options = arguments()
    garments = chosen(options.paths)
    if hasattr(os, "sched_setaffinity"):
        cores = os.sched_getaffinity(0)
        os.sched_setaffinity(0, {min(cores)})
    other = adapter(options.other) if options.other else None
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        for pattern in garments:
            steps = {"ours": lambda p=pattern: stages(p, options.vertices)}
            if other:
                steps["other"] = other_step(other, pattern, Path(folder), options.vertices)
            rows[pattern.name] = row = medians(steps, options.repeats)
            print_row(pattern.name, row, heading=len(rows) == 1)
    result: dict[str, Any] = {
        **provenance([]),
        "load": os.getloadavg()[0],
        "vertices": options.vertices,
        "garments": rows,
        "all": summary(list(rows.values())),
    }
    print_row("median", result["all"])
    if other:
        print(f"other / ours, median: {result['all']['ratio']:.2f}")
    if options.newton:
        result["newton"] = newton_rows(options.vertices)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, cores)
    if options.scaling:
        result["scaling"] = scaling(garments, options.vertices, options.scaling)
    if options.out:
        options.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path)
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--scaling", type=int, default=0, help="drapes with one and two processes")
    parser.add_argument("--other", type=Path, help="adapter of another drape program")
    parser.add_argument("--newton", action="store_true", help="compare with newton, on the CPU")
    parser.add_argument("-o", "--out", type=Path, help="write the figures as JSON")
    return parser.parse_args()


def chosen(paths: list[Path]) -> list[Pattern]:
    if paths:
        return [load_pattern(path) for path in paths]
    bundled = [replace(load_pattern(example_path(name)), name=name) for name in example_names()]
    wearer = measurements(BODY)
    return bundled + [replace(drafted(k, wearer, 0.5), name=n) for n, k in KINDS.items()]


# --- Times ---------------------------------------------------------------------------------------


def stages(pattern: Pattern, vertices: int) -> dict[str, float]:
    """CPU time of each stage of one drape and of its pictures [s], and how it went."""
    taken = dict.fromkeys(STAGES, 0.0)
    with clocks(taken):
        start = process_time()
        worn = wear.drape_pattern(pattern, BODY, fabric=FABRIC, vertices=vertices)
        taken["drape"] = process_time() - start
    start = process_time()
    surfaces, camera = surfaces_of(worn), body_camera(worn.body)
    picture(surfaces, camera, size=LARGE)
    taken["picture"] = process_time() - start
    taken["total"] = taken["drape"] + taken["picture"]
    start = process_time()
    picture(surfaces, camera, size=SMALL)
    taken["small"] = process_time() - start
    return taken | facts(worn)


def facts(worn: DrapedGarment) -> dict[str, float]:
    report = worn.report
    return {
        "vertices": worn.cloth.vertex_count,
        "frames": report.frames,
        "layers": report.items,
        "faults": len(report.faults),
    }


@contextmanager
def clocks(taken: dict[str, float]) -> Iterator[None]:
    """Adds the time of the functions that `drape` calls to their stages."""
    before = {name: getattr(wear, name) for names in STAGES.values() for name in names}

    def clocked(function: Callable, stage: str) -> Callable:
        def call(*args: Any, **kwargs: Any) -> Any:
            start = process_time()
            try:
                return function(*args, **kwargs)
            finally:
                taken[stage] += process_time() - start

        return call

    for stage, names in STAGES.items():
        for name in names:
            setattr(wear, name, clocked(before[name], stage))
    try:
        yield
    finally:
        for name, function in before.items():
            setattr(wear, name, function)


def medians(steps: dict[str, Callable[[], dict[str, float]]], repeats: int) -> dict[str, float]:
    """Median of every figure over the repeats; the programs take turns, after a first time."""
    for name, step in list(steps.items()):
        try:
            step()
        except Exception as error:
            if name == "ours":
                raise
            print(f"the other program fails ({type(error).__name__}: {error})", file=sys.stderr)
            del steps[name]
    taken: dict[str, list[float]] = {}
    for _ in range(repeats):
        for step in steps.values():
            for key, value in step().items():
                taken.setdefault(key, []).append(value)
    row = {key: float(np.median(values)) for key, values in taken.items()}
    return row | ({"ratio": row["other"] / row["total"]} if "other" in row else {})


def summary(rows: list[dict[str, float]]) -> dict[str, float]:
    """Median of every figure over the garments that have it."""
    keys = dict.fromkeys(key for row in rows for key in row)
    return {key: float(np.median([row[key] for row in rows if key in row])) for key in keys}


def print_row(name: str, row: dict[str, float], *, heading: bool = False) -> None:
    """Times in ms, counts as they are."""
    counts = ("vertices", "frames", "layers", "faults", "ratio")
    if heading:
        print(f"CPU time in ms\n{'':{NAME_WIDTH}}" + "".join(f"{key:>11}" for key in row))
    cells = (f"{v:11.2f}" if k == "ratio" else f"{v * (k in counts or 1000):11.1f}"
             for k, v in row.items())  # fmt: skip
    print(f"{name:{NAME_WIDTH}}" + "".join(cells), flush=True)


# --- Other programs ------------------------------------------------------------------------------


def adapter(path: Path) -> Adapter:
    spec = importlib.util.spec_from_file_location("other_drape", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.drape_file


def other_step(
    other: Adapter, pattern: Pattern, folder: Path, vertices: int
) -> Callable[[], dict[str, float]]:
    body = stand_straight(load_body(BODY))
    path = folder / f"{pattern.name}.json"
    save_pattern(place_on_body(pattern, body)[0], path)

    def step() -> dict[str, float]:
        start = process_time()
        other(path, body, vertices)
        return {"other": process_time() - start}

    return step


def newton_rows(vertices: int) -> dict[str, dict[str, float]]:
    """Newton's solvers and ours on the bundled dress, for as many frames."""
    from newton_drape import newton_drape

    pattern, fabric = load_pattern(example_path("dress")), load_fabric(FABRIC)
    start = process_time()
    worn = wear.drape_pattern(pattern, BODY, fabric=FABRIC, vertices=vertices)
    seconds = process_time() - start
    report = worn.report
    print(
        f"ours: {seconds:.2f} s for {report.frames} frames, penetration {report.penetration:.2f} "
        f"cm, strain {report.strain:.2f}, {report.speed:.1f} cm/s at the end"
    )
    rows = {}
    for solver in NEWTON_SOLVERS:
        found = newton_drape(
            pattern, BODY, fabric, vertices=vertices, frames=report.frames, solver=solver
        )
        apart = np.linalg.norm(found.points - worn.points, axis=1)
        rows[solver] = {
            "seconds": found.seconds,
            "compiling": found.compiling,
            "ratio": found.seconds / seconds,
            "seam_gap": found.seam_gap,
            "penetration": found.penetration,
            "strain": found.strain,
            "speed": found.speed,
            "mean_apart": float(apart.mean()),
        }
        print(
            f"newton {solver}: {found.seconds:.1f} s ({found.seconds / seconds:.0f} x ours; and "
            f"{found.compiling:.0f} s to compile or load), seams gape {found.seam_gap:.2f} cm at "
            f"most, penetration {found.penetration:.2f} cm, strain {found.strain:.2f}, "
            f"{found.speed:.1f} cm/s at the end, {apart.mean():.2f} cm from ours on average",
            flush=True,
        )
    return rows


# --- Two processes -------------------------------------------------------------------------------


def scaling(garments: list[Pattern], vertices: int, count: int) -> dict[str, float]:
    """Drapes a second [1/s] with one and with two processes, once each has draped a first one."""
    rates = {}
    for workers in (1, 2):
        tasks = [(garments[k % len(garments)], vertices) for k in range(-workers, count)]
        first_end, spans = 0.0, []
        for done in map_in_processes(draped_span, tasks, workers=workers, time_limit=TIME_LIMIT_S):
            if isinstance(done.result, TimedOut):
                raise SystemExit(done.result.reason)
            if done.is_first:
                first_end = max(first_end, done.result[1])
            spans.append(done.result)
        timed = [span for span in spans if span[0] >= first_end]
        wall = max(end for _, end, _ in timed) - min(start for start, _, _ in timed)
        cpu = float(np.mean([seconds for _, _, seconds in timed]))
        rates[workers] = len(timed) / wall
        print(f"{workers} processes: {rates[workers]:.2f} drapes/s, {cpu:.3f} s of CPU each")
    print(f"two processes / one: {rates[2] / rates[1]:.2f} (load {os.getloadavg()[0]:.1f})")
    return {"one": rates[1], "two": rates[2], "ratio": rates[2] / rates[1]}


def draped_span(task: tuple[Pattern, int]) -> tuple[float, float, float]:
    """When a drape with its picture began and ended, and its CPU time [s]."""
    start, cpu = time.monotonic(), process_time()
    worn = wear.drape_pattern(task[0], BODY, fabric=FABRIC, vertices=task[1])
    picture(surfaces_of(worn), body_camera(worn.body), size=LARGE)
    return start, time.monotonic(), process_time() - cpu


if __name__ == "__main__":
    sys.exit(main())
