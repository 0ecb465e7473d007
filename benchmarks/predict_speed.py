"""How long it takes from a picture to a pattern on one core, and what of it.

    python benchmarks/predict_speed.py data/d2 [--network NAME] [--pictures 100] [--out FILE.json]

Pictures of the validation split go, one by one, through the network, repair, decoding and checking;
medians, and the slowest tenth. Reading the file and finding the wearer in a photograph are timed on
the same pictures as PNG files.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import numpy as np
from PIL import Image
from provenance import provenance

from garmentimage.dataset.overview import dataset_hash
from garmentimage.learn.data.images import load_split
from garmentimage.networks.decoded import decoded_garment
from garmentimage.predict.photo import frame_photo, read_photo
from garmentimage.predict.predictor import DEFAULT_NETWORK, PatternPredictor


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--network", default=DEFAULT_NETWORK)
    parser.add_argument("--pictures", type=int, default=100)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    network = PatternPredictor.load(args.network)
    result: dict[str, Any] = {
        **provenance([]),
        "data_sha256": dataset_hash(args.data),
        "times [ms]": timed(network, args.data, args.pictures),
    }
    print(json.dumps(result, indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def timed(network: PatternPredictor, data: Path, count: int) -> dict[str, dict[str, float]]:
    pictures = load_split(data, "validation").garments.pictures[:count].numpy()
    times: dict[str, list[float]] = {
        name: [] for name in ("file", "network", "pattern", "from picture to pattern")
    }
    with tempfile.TemporaryDirectory() as folder:
        for number, upward in enumerate(pictures):
            path = Path(folder) / f"{number}.png"
            Image.fromarray(np.ascontiguousarray(upward[:, ::-1].transpose(1, 2, 0))).save(path)
            began = time.perf_counter()
            photo = frame_photo(read_photo(path), network.box, network.size)
            read = time.perf_counter()
            channels = network.channels(photo.pixels[None])[0]
            seen = time.perf_counter()
            decoded_garment(np.zeros(0, np.float32), channels, "full")
            done = time.perf_counter()
            if number:  # the first one compiles
                for name, seconds in zip(
                    times, (read - began, seen - read, done - seen, done - began), strict=True
                ):
                    times[name].append(1000 * seconds)
    return {
        name: {
            "median": round(float(np.median(values)), 1),
            "slowest tenth from": round(float(np.quantile(values, 0.9)), 1),
        }
        for name, values in times.items()
    }


if __name__ == "__main__":
    sys.exit(main())
