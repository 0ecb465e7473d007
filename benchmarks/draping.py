"""Garments draped on a body: how many come out well, why others do not, and how long it takes.

    python benchmarks/draping.py [FOLDER...] [--count 100] [--seed 0] [--workers 2] [-o OUT.json]
    python benchmarks/draping.py FOLDER... --count 50 --sheet OUT.png

Without folders: `count` random garments of each drafted kind, on the body that they are drafted
for. With folders: `count` evenly spread pattern files of each, with `--lapels` of those that have
panels sewn right side to wrong side. A group a kind or a folder; the files of a folder come in
order of name.
"""

import argparse
import json
import statistics
import sys
import time
from collections import Counter
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from provenance import provenance
from tqdm import tqdm

from garmentimage.draft.kind import KINDS
from garmentimage.draft.sampling import sample
from garmentimage.drape.draping import drape_pattern
from garmentimage.errors import GarmentImageError
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Pattern
from garmentimage.render.worn.photographing import body_camera, picture
from garmentimage.render.worn.surface import surfaces_of
from garmentimage.system.processes import TimedOut, map_in_processes

BODY = "mean-female"
PICTURE = 256
TIME_LIMIT_S = 120.0
SHEET_VIEWS = ("front", "side", "back")


@dataclass(frozen=True)
class Task:
    """A garment to drape."""

    group: str
    name: str
    source: Path | tuple[str, int, int]
    """A file, or kind, seed and index."""
    body: str
    vertices: int
    keep_picture: bool


def pattern_of(task: Task) -> Pattern:
    if isinstance(task.source, Path):
        return read_pattern(task.source)[0]
    kind, seed, index = task.source
    pattern = next(sample(kind, 1, seed, body=task.body, first=index)).pattern
    return replace(pattern, name=task.name)


def run(task: Task) -> dict[str, Any]:
    row: dict[str, Any] = {"group": task.group, "name": task.name}
    try:
        pattern = pattern_of(task)
        start = time.process_time()
        worn = drape_pattern(pattern, task.body, vertices=task.vertices)
        row["drape_s"] = time.process_time() - start
        surfaces = surfaces_of(worn)
        start = time.process_time()
        picture(surfaces, body_camera(worn.body), size=PICTURE)
        row["picture_s"] = time.process_time() - start
    except GarmentImageError as error:
        sentence = f"{type(error).__name__}: {error}".replace(str(task.source), task.name)
        return {**row, "faults": [sentence]}
    row |= asdict(worn.report)
    if task.keep_picture:
        cameras = [body_camera(worn.body, view) for view in SHEET_VIEWS]
        cut = PICTURE // 6
        row["picture"] = np.concatenate(
            [picture(surfaces, c, size=PICTURE).colour[:, cut:-cut] for c in cameras], axis=1
        )
    return row


def tasks(args: argparse.Namespace) -> list[Task]:
    rest = (args.body, args.vertices, args.sheet is not None)
    if not args.folders:
        return [
            Task(kind, f"{kind} {k}", (kind, args.seed, k), *rest)
            for kind in args.kinds
            for k in range(args.count)
        ]
    found = []
    for folder in args.folders:
        files = sorted(f for f in folder.rglob("*.json") if "manifest" not in f.name)
        if args.lapels:
            files = [f for f in files if "right_wrong" in f.read_text(encoding="utf-8")]
        step = max(len(files) / args.count, 1.0)
        chosen = [files[int(k * step)] for k in range(min(args.count, len(files)))]
        found += [Task(folder.name, f.stem, f.resolve(), *rest) for f in chosen]
    return found


def cause(fault: str) -> str:
    """A fault without its figures, for counting."""
    words = fault.split(":")[0].split("(")[0].split()
    return " ".join(w for w in words if not any(c.isdigit() for c in w))


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    good = [r for r in rows if not r["faults"]]
    measured = [r for r in rows if "drape_s" in r]
    out: dict[str, Any] = {
        "garments": len(rows),
        "good": len(good),
        "share": round(len(good) / len(rows), 4),
        "causes": dict(Counter(cause(f) for r in rows for f in r["faults"]).most_common()),
    }
    for key in ("drape_s", "picture_s", "frames", "strain", "crossings"):
        if measured:
            out[f"median {key}"] = round(statistics.median(r[key] for r in measured), 4)
    return out


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--lapels", action="store_true")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--body", default=BODY)
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--sheet", type=Path, help="draw every drape on one picture")
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    todo = tasks(args)
    rows: dict[int, dict[str, Any]] = {}
    started = time.perf_counter()
    with tqdm(total=len(todo), unit="drape", disable=None, file=sys.stderr) as bar:
        for done in map_in_processes(run, todo, workers=args.workers, time_limit=TIME_LIMIT_S):
            task, result = todo[done.number], done.result
            if isinstance(result, TimedOut):
                result = {"group": task.group, "name": task.name, "faults": [result.reason]}
            rows[done.number] = result
            bar.update()
    wall = time.perf_counter() - started
    ordered = [rows[k] for k in range(len(todo))]
    if args.sheet:
        draw_sheet(args.sheet, ordered)
    groups: dict[str, list[dict[str, Any]]] = {}
    for row in ordered:
        groups.setdefault(row["group"], []).append(row)
    result = {
        **provenance(args.folders),
        "seed": args.seed,
        "body": args.body,
        "vertices": args.vertices,
        "workers": args.workers,
        "wall_s": round(wall, 1),
        "all": summary(ordered),
        "groups": {name: summary(group) for name, group in groups.items()},
        "failures": {f"{r['group']}/{r['name']}": r["faults"] for r in ordered if r["faults"]},
    }
    for name, group in result["groups"].items():
        print(f"{name:28} {json.dumps(group)}")
    print(f"{'all':28} {json.dumps(result['all'])}")
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def draw_sheet(path: Path, rows: list[dict[str, Any]], columns: int = 5) -> None:
    """Front, side and back of every drape; a red bar over the bad ones."""
    from PIL import Image, ImageDraw

    tiles = []
    for row in rows:
        if "picture" not in row:
            continue
        image = Image.fromarray(row.pop("picture"))
        draw = ImageDraw.Draw(image)
        if row["faults"]:
            draw.rectangle((0, 0, image.width, 3), fill=(220, 0, 0))
        draw.text((3, 4), row["name"][:60], fill=(0, 0, 0))
        draw.text((3, 16), "; ".join(map(cause, row["faults"])), fill=(200, 0, 0))
        tiles.append(np.asarray(image))
    tiles += [np.full_like(tiles[0], 255)] * (-len(tiles) % columns)
    lines = [np.concatenate(tiles[k : k + columns], axis=1) for k in range(0, len(tiles), columns)]
    Image.fromarray(np.concatenate(lines)).save(path)


if __name__ == "__main__":
    sys.exit(main())
