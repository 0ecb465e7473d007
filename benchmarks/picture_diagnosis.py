"""Why garments come out wrong: by their parameters, by colour, by the weight on boundaries.

    python benchmarks/picture_diagnosis.py parameters data/d2 runs/image-d2 [--out FILE.json]
    python benchmarks/picture_diagnosis.py colour data/d1 runs/d1-cascade-0/model [--out FILE.json]
    python benchmarks/picture_diagnosis.py shares data/fresh image-wide [--out FILE.json]

`parameters` reads the records that `garmentimage evaluate image` left, predicts nothing, and tells
the figures of the cascade by fifths of each parameter of the unseen garments. `colour` paints
dresses of the validation split, whole or below the waist, as bottoms of the recipe are, and counts
the panels that the network finds then. `shares` frees shares of edge types of a weight that
boundaries had in training, on all garments but those of the training split, of a dataset with
another seed than that of the training.
"""

import argparse
import json
import sys
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import ImageColor
from provenance import provenance

import garmentimage as gi
from garmentimage.dataset.overview import dataset_hash, read_summary
from garmentimage.dataset.read import parse_patterns, read_tables
from garmentimage.dataset.recipe import load_recipe
from garmentimage.learn.data.images import load_split
from garmentimage.metrics.intervals import interval
from garmentimage.metrics.similarity import likeness
from garmentimage.networks.decoded import decoded_garment
from garmentimage.raster.channels import join_channels, split_channels

WEIGHTS = 1.0, 3.0**0.5, 3.0, 5.0
FIFTHS = np.linspace(0, 1, 6)
DRESS, DRESSES = "one-panel dress", 60
WAIST = 0.44
"""Where the waist is, as a share of the picture from its top."""
BLUER = 15
"""Cloth is bluer than red by more than this, of 255; skin and background are not."""
BRIGHT = 230.0
"""Blue of that cloth in the light."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=tuple(TOLD))
    parser.add_argument("data", type=Path)
    parser.add_argument("found", type=Path, help="folder of records; a network")
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    result = {
        **provenance([]),
        "data_sha256": dataset_hash(args.data),
        **TOLD[args.what](args.data, args.found),
    }
    print(json.dumps(result, indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def by_parameter(data: Path, records: Path) -> dict[str, Any]:
    """Panel IoU and exact topology, means over seeds, by fifths of each parameter."""
    rows: dict[int, list[dict[str, Any]]] = {}
    name = read_summary(data)["recipe"]  # other records are of other repairs
    for file in sorted(records.glob(f"unseen-cascade-{name}-cascade-[0-9].jsonl")):
        for line in file.read_text(encoding="utf-8").splitlines():
            record = json.loads(line)
            if "lost" not in record:
                rows.setdefault(record["number"], []).append(record)
    given = [
        json.loads(text)
        for table in read_tables(data, "unseen", ["parameters"])
        for text in table["parameters"].to_pylist()
    ]
    numbers = sorted(rows)
    iou, topology = (
        np.array([np.mean([record[key] for record in rows[n]]) for n in numbers])
        for key in ("panel_iou", "topology")
    )
    fifths: dict[str, list[dict[str, float]]] = {}
    for name in given[numbers[0]]:
        values = [given[n][name] for n in numbers]
        if not all(isinstance(value, float) for value in values) or len(set(values)) < len(FIFTHS):
            continue
        ends = np.quantile(values, FIFTHS)
        which = np.clip(np.searchsorted(ends, values, side="right") - 1, 0, len(FIFTHS) - 2)
        fifths[name] = [
            {
                "from": round(float(ends[k]), 3),
                "to": round(float(ends[k + 1]), 3),
                "panel_iou": round(float(iou[which == k].mean()), 4),
                "topology": round(float(topology[which == k].mean()), 4),
            }
            for k in range(len(FIFTHS) - 1)
        ]
    is_exact = topology == 1
    wrong: dict[int, list[float]] = {}
    for record in (record for n in numbers for record in rows[n]):
        if not record["topology"]:
            wrong.setdefault(record["panels found"], []).append(record["panel_iou"])
    return {
        "garments": len(numbers),
        "seams right with all seeds": round(float(is_exact.mean()), 4),
        "panel IoU of these": round(float(iou[is_exact].mean()), 4),
        "panel IoU of the others": round(float(iou[~is_exact].mean()), 4),
        "seams wrong, by panels found, of all seeds": {
            panels: {"garments": len(found), "panel IoU": round(float(np.mean(found)), 4)}
            for panels, found in sorted(wrong.items())
        },
        "fifths": fifths,
    }


def by_colour(data: Path, network: Path) -> dict[str, Any]:
    """How many dresses come back as how many panels, painted and as they are."""
    bottom = np.array(
        ImageColor.getrgb(load_recipe(read_summary(data)["recipe"]).colours["bottom"])
    )
    predictor = gi.PatternPredictor.load(network)
    album = load_split(data, "validation")
    dresses = [k for k, name in enumerate(album.types) if name == DRESS][:DRESSES]
    counts: dict[str, Counter[int]] = {}
    for number in dresses:
        upward = album.garments.pictures[number].numpy()
        plain = np.ascontiguousarray(upward[:, ::-1].transpose(1, 2, 0))
        waist = round(WAIST * len(plain))
        for name, pixels in (
            ("as they are", plain),
            ("painted below the waist", painted(plain, bottom, waist)),
            ("painted", painted(plain, bottom, 0)),
        ):
            pattern = predictor.predict(pixels).garment.pattern
            panels = len(pattern.panels) if pattern else 0
            counts.setdefault(name, Counter())[panels] += 1
    return {
        "dresses": len(dresses),
        "by panels": {name: dict(sorted(found.items())) for name, found in counts.items()},
    }


def by_shares(data: Path, network: str | Path) -> dict[str, Any]:
    """Panel IoU and exact topology with shares of edge types freed of a weight on boundaries."""
    predictor = gi.PatternPredictor.load(network)
    albums = [load_split(data, split) for split in ("validation", "test")]
    given = [
        predictor.channels(
            np.ascontiguousarray(album.garments.pictures[[k]].numpy()[:, :, ::-1]).transpose(
                0, 2, 3, 1
            )
        )[0]
        for album in albums
        for k in range(len(album.ids))
    ]
    truths = [p for album in albums for p in parse_patterns(list(album.patterns), data)]
    types = [name for album in albums for name in album.types]
    told: dict[str, Any] = {"garments": len(truths), "by weight": {}}
    for weight in WEIGHTS:
        found = []
        for channels, truth in zip(given, truths, strict=True):
            step = decoded_garment(np.zeros(0, np.float32), freed(channels, weight), "full")
            found.append(likeness(truth, step.pattern).figures())
        told["by weight"][f"{weight:g}"] = {
            key: {
                **asdict(interval([each[key] for each in found])),
                "by type": {
                    name: round(
                        float(
                            np.mean(
                                [f[key] for f, t in zip(found, types, strict=True) if t == name]
                            )
                        ),
                        4,
                    )
                    for name in sorted(set(types))
                },
            }
            for key in ("panel_iou", "topology")
        }
    return told


def freed(channels: Float32[np.ndarray, "34 row col"], weight: float) -> np.ndarray:
    """The same, as if boundaries had not had a weight in training."""
    flags, types, vectors, _ = split_channels(channels)
    shares = types.copy()
    shares[:, :, 0] *= weight
    return join_channels(flags, shares / shares.sum(axis=2, keepdims=True), vectors)


def painted(
    pixels: UInt8[np.ndarray, "row col 3"], colour: np.ndarray, first_row: int
) -> UInt8[np.ndarray, "row col 3"]:
    """The same cloth in another colour, from a row down."""
    values = pixels.astype(float)
    cloth = values[..., 2] - values[..., 0] > BLUER
    cloth[:first_row] = False
    light = values[..., 2:] / BRIGHT
    return np.where(cloth[..., None], colour * light, values).clip(0, 255).astype(np.uint8)


TOLD = {"parameters": by_parameter, "colour": by_colour, "shares": by_shares}

if __name__ == "__main__":
    sys.exit(main())
