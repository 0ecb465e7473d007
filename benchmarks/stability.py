"""How much an image changes when its garment hardly does.

    python benchmarks/stability.py FILE_OR_FOLDER... [--garments 200] [--report OUT.json]

Takes a fixed, evenly spread choice of the pattern files found and measures, at one grid size:

- vertices moved by 0.1 mm and by 3 mm in seeded random directions: cells whose inside flag
  changes, and the share of boundary grid edges whose type changes;
- left-right symmetric garments (every panel has a mirror image within 1 cm): share whose flags and
  types are exactly symmetric;
- garments with sleeves or a hood (by panel name): share of the other panels' cells that stay when
  the sleeves or the hood are put on.
"""

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from provenance import provenance
from tqdm import tqdm

from garmentimage import GarmentImage, GarmentImageError, Pattern, encode
from garmentimage.compare.matching import panel_iou
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Loop, Panel
from garmentimage.raster.cells import label_panels

MOVES_CM = (0.01, 0.3)
DRAWS = 2
MIRROR_IOU = 0.97
ADDED = ("sleeve", "hood")


def moved(pattern: Pattern, distance: float, rng: np.random.Generator) -> Pattern:
    """Every vertex moved by `distance` [cm] in a random direction."""

    def loop(old: Loop) -> Loop:
        angle = rng.uniform(0, 2 * np.pi, len(old.vertices))
        step = distance * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return replace(old, vertices=tuple(map(tuple, (np.array(old.vertices) + step).tolist())))

    panels = tuple(
        replace(p, outline=loop(p.outline), holes=tuple(loop(h) for h in p.holes))
        for p in pattern.panels
    )
    return replace(pattern, panels=panels)


def change(a: GarmentImage, b: GarmentImage) -> tuple[int, float]:
    """Flags that differ, and the share of boundary grid edges whose type differs."""
    boundary = (a.edge_type > 0) | (b.edge_type > 0)
    return (
        int((a.inside != b.inside).sum()),
        float((a.edge_type != b.edge_type).sum() / max(boundary.sum(), 1)),
    )


def is_symmetric_image(image: GarmentImage) -> bool:
    """Whether flags and types equal their left-right mirror image."""
    bottom, left = image.edge_type[:, 0], image.edge_type[:, 1]
    return bool(
        np.array_equal(image.inside, image.inside[..., ::-1])
        and np.array_equal(bottom, bottom[..., ::-1])
        and np.array_equal(left[..., 1:], left[..., :0:-1])
    )


def is_symmetric_garment(pattern: Pattern) -> bool:
    """Whether every panel has a mirror image: shape, place, and both sides of every stitch."""
    flip = np.diag([-1.0, 1.0, 1.0])
    image: dict[str, str] = {}
    for panel in pattern.panels:
        best = max(
            (q for q in pattern.panels),
            key=lambda q: _mirror_score(panel, q, flip),
        )
        if _mirror_score(panel, best, flip) < MIRROR_IOU:
            return False
        image[panel.name] = best.name
    joined = sorted(tuple(sorted((s.a.panel, s.b.panel))) for s in pattern.stitches)
    turned = sorted(tuple(sorted((image[s.a.panel], image[s.b.panel]))) for s in pattern.stitches)
    return all(image[image[n]] == n for n in image) and joined == turned


def _mirror_score(a: Panel, b: Panel, flip: np.ndarray) -> float:
    here = a.to_world(a.outline.polygon) @ flip
    there = b.to_world(b.outline.polygon)
    gap = max(
        float(np.abs(here.min(axis=0) - there.min(axis=0)).max()),
        float(np.abs(here.max(axis=0) - there.max(axis=0)).max()),
    )
    if gap > 1.0:
        return 0.0
    return max(panel_iou(a, _flipped(b)), panel_iou(a, b))


def _flipped(panel: Panel) -> Panel:
    def loop(old: Loop) -> Loop:
        flipped = tuple((-x, y) for x, y in old.vertices)
        edges = tuple(replace(e, curvature=_mirror_curvature(e.curvature)) for e in old.edges)
        return replace(old, vertices=flipped, edges=edges)

    return replace(panel, outline=loop(panel.outline), holes=())


def _mirror_curvature(curvature):  # type: ignore[no-untyped-def]
    if curvature is None:
        return None
    if hasattr(curvature, "radius"):
        return replace(curvature, right=not curvature.right)
    changes = {"control": (curvature.control[0], -curvature.control[1])}
    if hasattr(curvature, "control2"):
        changes["control2"] = (curvature.control2[0], -curvature.control2[1])
    return replace(curvature, **changes)


def without_added(pattern: Pattern) -> Pattern | None:
    """The garment without its sleeves and hood; None where there are none, or nothing is left."""
    kept = tuple(p for p in pattern.panels if not any(w in p.name.lower() for w in ADDED))
    if len(kept) in (0, len(pattern.panels)):
        return None
    names = {p.name for p in kept}
    stitches = tuple(s for s in pattern.stitches if {s.a.panel, s.b.panel} <= names)
    return replace(pattern, panels=kept, stitches=stitches)


def kept_share(less: GarmentImage, more: GarmentImage) -> float:
    """Share of the cells of `less` that belong to the same panel in `more`."""
    kept = total = 0
    cells = [_cells(image) for image in (less, more)]
    for name, mine in cells[0].items():
        total += len(mine)
        kept += len(mine & cells[1].get(name, set()))
    return kept / total


def _cells(image: GarmentImage) -> dict[str, set[tuple[int, ...]]]:
    labels, _ = label_panels(image.inside, image.edge_type)
    return {
        mark.name: set(map(tuple, np.argwhere(labels == labels[mark.layer][mark.cell]).tolist()))
        for mark in image.marks
    }


def choose(paths: list[Path], count: int) -> list[Path]:
    """An evenly spread, fixed choice: the same number from each folder, in order of name."""
    files = [p for path in paths for p in ([path] if path.is_file() else path.rglob("*.json"))]
    folders: dict[Path, list[Path]] = {}
    for file in sorted(f for f in files if "manifest" not in f.name):
        folders.setdefault(file.parent, []).append(file)
    share = max(count // max(len(folders), 1), 1)
    chosen = []
    for group in folders.values():
        step = max(len(group) / share, 1.0)
        chosen += [group[int(k * step)] for k in range(min(share, len(group)))]
    return chosen


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("paths", nargs="+", type=Path)
    parser.add_argument("--garments", type=int, default=200)
    parser.add_argument("--grid", type=int, default=16)
    parser.add_argument("--report", type=Path)
    args = parser.parse_args()
    rows = []
    for file in tqdm(choose(args.paths, args.garments), unit="garment", file=sys.stderr):
        row: dict[str, object] = {"file": f"{file.parent.name}/{file.name}"}
        rows.append(row)
        try:
            pattern, _ = read_pattern(file)
            image = encode(pattern, args.grid)
        except GarmentImageError as error:
            row["error"] = type(error).__name__
            continue
        row["cells"] = int(image.inside.sum())
        if is_symmetric_garment(pattern):
            row["symmetric"] = is_symmetric_image(image)
        for distance in MOVES_CM:
            changes = []
            for seed in range(DRAWS):
                try:
                    again = encode(moved(pattern, distance, np.random.default_rng(seed)), args.grid)
                except GarmentImageError:
                    row["lost"] = int(row.get("lost", 0)) + 1  # type: ignore[call-overload]
                    continue
                changes.append(change(image, again))
            if changes:
                row[f"{distance:g} cm"] = np.mean(changes, axis=0).tolist()
        less = without_added(pattern)
        if less is not None:
            try:
                row["kept"] = kept_share(encode(less, args.grid), image)
            except GarmentImageError as error:
                row["without sleeves or hood"] = type(error).__name__
    summary = summarise(rows)
    if args.report:
        args.report.write_text(
            json.dumps({**provenance(args.paths), "grid": args.grid, "summary": summary}, indent=1)
        )
    print(json.dumps(summary, indent=1))
    return 0


def summarise(rows: list[dict[str, object]]) -> dict[str, object]:
    done = [r for r in rows if "cells" in r]
    out: dict[str, object] = {"garments": len(rows), "errors": len(rows) - len(done)}
    for distance in MOVES_CM:
        pairs = np.array([r[f"{distance:g} cm"] for r in done if f"{distance:g} cm" in r])
        if len(pairs):
            out[f"cells changed at {distance:g} cm"] = round(float(pairs[:, 0].mean()), 3)
            out[f"edges changed at {distance:g} cm"] = round(float(pairs[:, 1].mean()), 4)
    symmetric = [r["symmetric"] for r in done if "symmetric" in r]
    kept = [r["kept"] for r in done if "kept" in r]
    out["symmetric garments"] = len(symmetric)
    out["symmetric images"] = round(float(np.mean(symmetric)), 4) if symmetric else None
    out["garments with sleeves or hood"] = len(kept)
    out["cells kept, mean"] = round(float(np.mean(kept)), 4) if kept else None
    out["cells kept >= 90 %, share"] = (
        round(float(np.mean(np.array(kept) >= 0.9)), 4) if kept else None
    )
    out["encodes after moving failed"] = sum(int(r.get("lost", 0)) for r in done)  # type: ignore[call-overload]
    return out


if __name__ == "__main__":
    sys.exit(main())
