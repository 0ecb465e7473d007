"""How much the silhouette of a drape changes when the edges of its triangles are half as long.

    python benchmarks/mesh_size.py [--vertices 2000] [-o OUT.json]

The bundled patterns and the plain garment of each kind, from the front and from the side: the
change of the silhouette's area, and the area that only one of the two silhouettes covers, both as
shares of the coarser one's area.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from provenance import provenance

from garmentimage.draft.kind import KINDS, draft_pattern
from garmentimage.drape.draped_garment import DrapedGarment
from garmentimage.drape.draping import drape_pattern
from garmentimage.examples import example_names, example_path
from garmentimage.pattern.files.spec import load_pattern
from garmentimage.render.worn.photographing import body_camera, picture
from garmentimage.render.worn.surface import surfaces_of

VIEWS = ("front", "side")
SIZE = 512
MOST = 0.01
"""Half the edge length should change the area by less than this share."""


def silhouette(worn: DrapedGarment, view: str) -> np.ndarray:
    return picture(surfaces_of(worn), body_camera(worn.body, view), size=SIZE).silhouette


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    garments = {name: load_pattern(example_path(name)) for name in example_names()}
    garments |= {kind: draft_pattern(kind) for kind in KINDS}
    rows = {}
    print(f"{'':24}" + "".join(f"{view + ': area':>14}{'apart':>9}" for view in VIEWS))
    for name, pattern in garments.items():
        pair = [
            drape_pattern(pattern, vertices=count) for count in (args.vertices, 4 * args.vertices)
        ]
        row = {}
        for view in VIEWS:
            coarse, fine = (silhouette(worn, view) for worn in pair)
            row[f"{view} area"] = float(fine.sum() / coarse.sum() - 1)
            row[f"{view} apart"] = float(np.abs(fine - coarse).sum() / coarse.sum())
        rows[name] = {key: round(value, 4) for key, value in row.items()}
        print(f"{name:24}" + "".join(
            f"{row[f'{v} area']:+14.2%}{row[f'{v} apart']:9.2%}" for v in VIEWS
        ), flush=True)  # fmt: skip
    changes = {view: [abs(row[f"{view} area"]) for row in rows.values()] for view in VIEWS}
    summary = {
        view: {
            f"below {MOST:.0%}": sum(c < MOST for c in change),
            "median": round(float(np.median(change)), 4),
            "most": max(change),
        }
        for view, change in changes.items()
    }
    print(json.dumps(summary))
    result = {**provenance([]), "vertices": args.vertices, "garments": rows, "summary": summary}
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
