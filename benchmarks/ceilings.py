"""The most that any method can reach by each figure, when it predicts images and nothing else.

    python benchmarks/ceilings.py [FOLDER...] [--count N] [--grid N] [-o RESULT.json]

Every garment is encoded, and what its channels alone bring back is compared with it: a network
that predicts the true image reaches these figures and no more. Folders hold pattern files; drafted
garments of all kinds come first. With `--contract 1` panels that wrap round the body are cut in
two, as networks of that contract have them.
"""

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from provenance import provenance

import garmentimage as gi
from garmentimage.draft.sampling import sample
from garmentimage.metrics import likeness, published_figures, slots_of
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Pattern

PUBLISHED = ("neuraltailor", "sewformer", "aipparel")


def main() -> int:
    options = arguments()
    sources = {"drafted": list(drafted(options.count))}
    sources |= {folder.name: list(spread(folder, options.count)) for folder in options.folders}
    told = {"grid": options.grid, "contract": options.contract, **provenance(options.folders)}
    told["sources"] = {name: ceiling(garments, options) for name, garments in sources.items()}
    text = json.dumps(told, indent=1) + "\n"
    if options.out:
        options.out.write_text(text)
    print(text)
    return 0


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=110, help="garments of each source")
    parser.add_argument("--grid", type=int, default=16)
    parser.add_argument("--contract", type=int, choices=(1, 2), default=2)
    parser.add_argument("-o", "--out", type=Path)
    return parser.parse_args()


def drafted(count: int) -> Iterator[Pattern]:
    """Random garments of every kind, as many of each."""
    kinds = list(gi.kinds())
    for kind in kinds:
        for one in sample(kind, max(count // len(kinds), 1), 0):
            yield one.pattern


def spread(folder: Path, count: int) -> Iterator[Pattern]:
    """Evenly spread over the sorted files of a folder; those that hold no pattern are passed by."""
    files = sorted(folder.rglob("*.json"))
    for k in np.unique(np.linspace(0, len(files) - 1, min(count, len(files))).round().astype(int)):
        try:
            yield read_pattern(files[k])[0]
        except gi.GarmentImageError:
            continue


def ceiling(garments: list[Pattern], options: argparse.Namespace) -> dict:
    """Means of all figures over the garments that can be encoded."""
    rows: list[dict[str, float | None]] = []
    refused = wrapped = 0
    for truth in garments:
        try:
            image = gi.encode(truth, grid=options.grid)
            if options.contract == 1:
                image = image.cut_at_wraps()
                image.to_channels(1)
        except gi.GarmentImageError:
            refused += 1
            continue
        wrapped += any(mark.split_of is not None for mark in image.marks)
        rows.append(figures(truth, gi.decode(image.without_marks())))
    names = list(dict.fromkeys(name for row in rows for name in row))
    known = {n: [row[n] for row in rows if row.get(n) is not None] for n in names}
    means = {n: round(float(np.nanmean(v)), 4) for n, v in known.items() if not np.isnan(v).all()}
    return {"garments": len(garments), "refused": refused, "wrapped": wrapped, "figures": means}


def figures(truth: Pattern, found: Pattern) -> dict[str, float | None]:
    """Our own figures of one garment, and those of published codes where its panels fit slots."""
    told = likeness(truth, found).figures()
    names = [panel.name for panel in truth.panels]
    edges = max(len(p.outline.edges) for pattern in (truth, found) for p in pattern.panels)
    try:
        pair = [slots_of(truth, names, edges)], [slots_of(found, names, edges, like=truth)]
    except gi.GarmentImageError:  # a panel with holes
        return told
    for mode in PUBLISHED:
        told |= {f"{mode} {n}": value for n, value in published_figures(*pair, mode).items()}
    return told


if __name__ == "__main__":
    sys.exit(main())
