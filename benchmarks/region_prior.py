"""What garments are on the raster: how often panels are small, bands one cell wide, seams broken.

    python benchmarks/region_prior.py FOLDER... [--count 600] [--grid 16 32] [--kept data/rasters]
        [-o OUT.json]

FOLDERs of pattern files are sources, and so are drafts of every kind. Every fourth garment, by a
hash of its name, is for validation: what is fitted on the others is reported beside what these say.
The constants of `raster/repair/walls.py` and `raster/repair/labelling.py` come from here: the price
of a thing is minus the logarithm of its share among things of its sort [nats], sources counting
the same.
"""

import argparse
import json
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from provenance import provenance
from true_rasters import DRAFTS, is_validation, true_rasters

import garmentimage as gi
from garmentimage.raster.cells import label_panels
from garmentimage.raster.image import BOTTOM, EdgeType

SIZES = 1, 2, 3
BAND_LENGTH = 3


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", type=Path, nargs="*", metavar="FOLDER")
    parser.add_argument("--count", type=int, default=600, help="garments of each source")
    parser.add_argument("--grid", type=int, nargs="*", default=[16, 32])
    parser.add_argument("--kept", type=Path, default=Path("data/rasters"), help="for images")
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    result: dict[str, Any] = {**provenance(args.folders), "count": args.count, "seed": 0}
    for grid in args.grid:
        found = {}
        for folder in (None, *args.folders):
            images = true_rasters(folder, grid, args.count, args.kept)
            parts: dict[str, Counter[str]] = {"fitted": Counter(), "validation": Counter()}
            for name, image in images.items():
                parts["validation" if is_validation(name) else "fitted"] += counts(image)
            found[folder.name if folder else DRAFTS] = parts
        result[f"N = {grid}"] = told(found)
        print(f"N = {grid}", json.dumps(result[f"N = {grid}"], indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def told(found: dict[str, dict[str, Counter[str]]]) -> dict[str, Any]:
    """Shares by source and split, and prices, the mean share over sources."""
    names = [name for name in MEASURED if name != "rasters"]
    shares = {
        split: {
            source: {name: _share(parts[split], name) for name in names}
            | {"rasters": parts[split]["rasters"]}
            for source, parts in found.items()
        }
        for split in ("fitted", "validation")
    }
    prices = {}
    for split, sources in shares.items():
        means = {name: float(np.mean([each[name] for each in sources.values()])) for name in names}
        prices[split] = {name: round(float(-np.log(m)), 2) for name, m in means.items() if m > 0}
    return {"shares": shares, "prices [nats]": prices}


MEASURED = {
    **{f"panels of {size} cells" if size > 1 else "panels of 1 cell": "panels" for size in SIZES},
    "panels of fewer than 4 cells": "panels",
    "panels of fewer than 4 cells, not sewn side by side": "panels",
    "bands": "panels",
    "broken seams": "seams",
    "slits": "panels",
    "slits of 1 grid edge": "panels",
    "odd folds": "folds",
    "rasters with a panel of fewer than 4 cells": "rasters",
}
"""What is counted, and among how many of what."""


def _share(counted: Counter[str], name: str) -> float:
    return round(counted[name] / max(counted[MEASURED[name]], 1), 5)


def counts(image: gi.GarmentImage) -> Counter[str]:
    """How many there are of each sort of thing."""
    found = Counter(rasters=1)
    labels, panels = label_panels(image.inside, image.edge_type)
    found["panels"] = panels
    beside = _seams(image, labels)
    for label in range(panels):
        _, rows, cols = np.nonzero(labels == label)
        size = len(rows)
        if size <= max(SIZES):
            found[f"panels of {size} cells" if size > 1 else "panels of 1 cell"] += 1
            found["panels of fewer than 4 cells"] += 1
            if not any(label in pair for pair in beside):
                found["panels of fewer than 4 cells, not sewn side by side"] += 1
        if size >= BAND_LENGTH and min(np.ptp(rows), np.ptp(cols)) == 0:
            found["bands"] += 1
    found["rasters with a panel of fewer than 4 cells"] = int(
        found["panels of fewer than 4 cells"] > 0
    )
    for (one, other), kinds in beside.items():
        if one != other:
            found["seams"] += 1
            found["broken seams"] += len(kinds) > 1
    slits = _slits(image, labels)
    found["slits"], found["slits of 1 grid edge"] = len(slits), slits.count(1)
    found["folds"], found["odd folds"] = _folds(image)
    return found


def _walls(image: gi.GarmentImage, labels: np.ndarray) -> list[tuple[int, int, int, int, int, int]]:
    """(layer, h, row, col) of grid edges between two inside cells that divide, and their panels."""
    walls = []
    for layer, h, row, col in np.argwhere(image.edge_type > 0).tolist():
        before = (row - 1, col) if h == BOTTOM else (row, col - 1)
        if min(before) < 0 or image.edge_type[layer, h, row, col] == EdgeType.FRONT_TO_BACK:
            continue
        one, other = int(labels[layer][before]), int(labels[layer, row, col])
        if min(one, other) >= 0:
            walls.append((layer, h, row, col, min(one, other), max(one, other)))
    return walls


def _seams(image: gi.GarmentImage, labels: np.ndarray) -> dict[tuple[int, int], set[int]]:
    """By pair of panels that touch along a side-by-side seam, the types of the grid edges there."""
    found: dict[tuple[int, int], set[int]] = {}
    for layer, h, row, col, one, other in _walls(image, labels):
        found.setdefault((one, other), set()).add(int(image.edge_type[layer, h, row, col]))
    return {pair: kinds for pair, kinds in found.items() if int(EdgeType.SIDE_BY_SIDE) in kinds}


def _slits(image: gi.GarmentImage, labels: np.ndarray) -> list[int]:
    """Numbers of grid edges of the walls that end inside a panel, chain by chain."""
    open_walls = {w[:4]: None for w in _walls(image, labels) if w[4] == w[5]}
    lengths = []
    while open_walls:
        queue, length = [open_walls.popitem()[0]], 0
        while queue:
            layer, h, row, col = queue.pop()
            length += 1
            ends = {(row, col), (row, col + 1) if h == BOTTOM else (row + 1, col)}
            for near in list(open_walls):
                far = (near[2], near[3] + 1) if near[1] == BOTTOM else (near[2] + 1, near[3])
                if near[0] == layer and ends & {near[2:], far}:
                    del open_walls[near]
                    queue.append(near)
        lengths.append(length)
    return lengths


def _folds(image: gi.GarmentImage) -> tuple[int, int]:
    """Front-to-back grid edges, and how many have not cloth on one and the same side in both."""
    total = odd = 0
    padded = np.pad(image.inside, ((0, 0), (1, 0), (1, 0)))
    for layer in range(0, image.layers - 1, 2):
        for h, row, col in np.argwhere(image.edge_type[layer] == EdgeType.FRONT_TO_BACK).tolist():
            here = padded[layer : layer + 2, row + 1, col + 1]
            before = padded[layer : layer + 2, row + (h != BOTTOM), col + (h == BOTTOM)]
            total += 1
            odd += bool((here[0] == before[0]) or (here[0] != here[1]) or (before[0] != before[1]))
    return total, odd


if __name__ == "__main__":
    sys.exit(main())
