"""Is a picture from the front trusted more than one that is turned? Confidence by view.

    python benchmarks/picture_views.py [--count 6] [--seed 0] [--out FILE.json]

Drafted garments of every kind are worn and photographed from the front and turned about the
upright; reported are the mean confidence of each network, and the share of garments whose front is
trusted more than the turned view.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from provenance import provenance

import garmentimage as gi
from garmentimage.predict.predictor import PatternPredictor, predictor_names
from garmentimage.render.worn.camera import VIEWS
from garmentimage.render.worn.photographing import body_camera, picture
from garmentimage.render.worn.surface import surfaces_of

TURNS = (0, 30, 45, 90, 180)
"""From the front, to the wearer's left [degrees]."""
KINDS = (
    "tee", "tank", "shirt", "skirt", "pants", "one-panel-dress", "top-skirt", "top-pants",
    "jacket", "hoodie",
)  # fmt: skip
SIZE = 256


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=6, help="garments of each kind")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    networks = {name: PatternPredictor.load(name) for name in predictor_names()}
    found: dict[str, list[list[float]]] = {name: [] for name in networks}
    for kind in KINDS:
        for sample in gi.sample(kind, args.count, seed=args.seed):
            worn = gi.drape_pattern(sample.pattern)
            if worn.report.faults:
                continue
            views = [turned(worn, degrees) for degrees in TURNS]
            for name, network in networks.items():
                found[name].append([network.predict(view).confidence for view in views])
    result = {**provenance([]), "seed": args.seed, "turns": TURNS, "networks": {}}
    for name, rows in found.items():
        table = np.array(rows)
        result["networks"][name] = {
            "garments": len(table),
            "confidence": table.mean(0).round(3).tolist(),
            "front_is_higher": (table[:, :1] > table).mean(0).round(3).tolist()[1:],
        }
        print(name, result["networks"][name])
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


def turned(worn: gi.DrapedGarment, degrees: float) -> np.ndarray:
    """A plain picture from another side."""
    look = gi.Look()
    surfaces = surfaces_of(worn, skin=look.skin, colours=look.colours, prints=look.prints)
    camera = replace(body_camera(worn.body, "front"), azimuth=VIEWS["front"] + np.deg2rad(degrees))
    shown = picture(
        surfaces, camera, size=SIZE, light=look.light, background=look.background, seams=False
    )
    return shown.colour


if __name__ == "__main__":
    main()
