"""How many drawn garments become rows, and how large a row is, for every recipe.

    python benchmarks/dataset_shares.py FOLDER [--count 200] [-o OUT.json]

Goes on where it was stopped, as `garmentimage build` does.
"""

import argparse
import json
import sys
from pathlib import Path

from provenance import provenance

from garmentimage.dataset.building import DATA, BuildSettings, build_dataset
from garmentimage.dataset.recipe import load_recipe, recipe_names


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    result = {**provenance([]), "rows_a_type": args.count, "seed": 0, "recipes": {}}
    for name in recipe_names():
        folder = args.folder / name
        summary = build_dataset(
            BuildSettings(load_recipe(name), folder, args.count), workers=args.workers
        )
        size = sum(path.stat().st_size for path in (folder / DATA).glob("*.parquet"))
        result["recipes"][name] = {
            "drawn": args.count * len(load_recipe(name).types),
            "rows": summary["rows"],
            "share": summary["share"],
            "failed": summary["failed"],
            "bytes_a_row": round(size / summary["rows"]),
        }
        print(name, result["recipes"][name], flush=True)
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
