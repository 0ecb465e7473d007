"""Repair on what a network of pictures predicts: the same channels at any version of the package.

    python benchmarks/repair_predictions.py data/d2 image-d2 unseen --channels out/d2-unseen.npy
        [--count 200] [-o OUT.json]

Predicts the first garments of a split and keeps their channels, or takes those that are kept; then
repairs and decodes them at full level and compares them with the truth. Called from two checkouts
with the same channels, it tells what another repair is worth.
"""

import argparse
import json
import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np
from provenance import provenance

import garmentimage as gi
from garmentimage.dataset.overview import dataset_hash
from garmentimage.dataset.read import parse_patterns
from garmentimage.learn.data.images import load_split
from garmentimage.metrics.intervals import interval
from garmentimage.metrics.similarity import likeness
from garmentimage.networks.decoded import decoded_garment

FIGURES = "panel_iou", "topology", "panels", "valid"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("network")
    parser.add_argument("split")
    parser.add_argument("--channels", type=Path, required=True, help="kept, or to be kept")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    album = load_split(args.data, args.split)
    truths = parse_patterns(list(album.patterns[: args.count]), args.data)
    if not args.channels.exists():
        predictor = gi.PatternPredictor.load(args.network)
        upright = album.garments.pictures[: args.count].numpy()[:, :, ::-1].transpose(0, 2, 3, 1)
        predicted = [predictor.channels(np.ascontiguousarray(each)[None])[0] for each in upright]
        args.channels.parent.mkdir(parents=True, exist_ok=True)
        np.save(args.channels, np.stack(predicted))
    found = []
    for channels, truth in zip(np.load(args.channels), truths, strict=True):
        step = decoded_garment(np.zeros(0, np.float32), channels, "full")
        found.append(likeness(truth, step.pattern).figures())
    result = {
        **provenance([]),
        "data_sha256": dataset_hash(args.data),
        "network": args.network,
        "split": args.split,
        "garments": len(found),
        **{key: asdict(interval([float(each[key]) for each in found])) for key in FIGURES},
    }
    print(json.dumps(result, indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
