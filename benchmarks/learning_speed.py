"""How fast networks are trained and used on one core, and how much memory that takes.

    python benchmarks/learning_speed.py data/vae-variety --space runs/vae-variety/model

Every figure is a median. A network is trained for `--steps` steps of 64 garments of the dataset's
validation split, in a process of its own, whose peak memory is reported. A garment is used as
`encode` (pattern to latent vector, with its raster) and `step` (latent vector to a pattern that was
repaired and checked, with its parts), over `--garments` garments.
"""

import argparse
import json
import os
import resource
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported

import numpy as np
from provenance import provenance

from garmentimage.dataset.overview import dataset_hash
from garmentimage.latent.space import LatentSpace
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.repair.repairer import repair

BATCH = 64
TRAININGS = {
    "GarmentImage VAE, N = 16": ("raster", 16, "32-true"),
    "GarmentImage VAE, N = 16, bf16-mixed": ("raster", 16, "bf16-mixed"),
    "GarmentImage VAE, N = 32": ("raster", 32, "32-true"),
    "vector VAE": ("vectors", 16, "32-true"),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--space", default="vae-variety")
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--garments", type=int, default=100)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    result: dict[str, Any] = {**provenance([]), "data_sha256": dataset_hash(args.data)}
    for name, how in TRAININGS.items():
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as alone:
            result[name] = alone.submit(trained, args.data, args.steps, *how).result()
    result["use [ms]"] = used(args.data, args.space, args.garments)
    print(json.dumps(result, indent=1))
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def trained(data: Path, steps: int, kind: str, grid: int, precision: str) -> dict[str, float]:
    """Samples a second, and the largest memory of the process."""
    import torch
    from lightning_fabric import Fabric

    torch.set_num_threads(1)
    fabric = Fabric(accelerator="cpu", devices=1, precision=precision)  # type: ignore[arg-type]
    model, examples = made(data, kind, grid)
    weights = sum(each.numel() for each in model.parameters())
    model, optimizer = fabric.setup(model, torch.optim.AdamW(model.parameters(), 1e-3))
    taken = []
    for _ in range(steps):
        began = time.perf_counter()
        losses = model(examples.batch(torch.randint(0, len(examples), (BATCH,))))
        optimizer.zero_grad()
        fabric.backward(losses["loss"])
        optimizer.step()
        taken.append(time.perf_counter() - began)
    return {
        "weights": weights,
        "samples_a_second": round(BATCH / float(np.median(taken)), 1),
        "peak_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1),
    }


def made(data: Path, kind: str, grid: int) -> tuple[Any, Any]:
    """A network that has learnt nothing yet, and what it learns from."""
    import torch

    from garmentimage.learn.data.pattern_vectors import build_vocabulary, read_patterns, to_vectors
    from garmentimage.learn.data.rasters import rasters_from_channels
    from garmentimage.learn.models.garment_vae import GarmentVAE, vae_config
    from garmentimage.learn.models.vector_vae import VectorVAE, VectorVAEConfig

    patterns = read_patterns(data, "validation")[:256]
    torch.manual_seed(0)
    if kind == "vectors":
        words = build_vocabulary(patterns)
        return VectorVAE(VectorVAEConfig(len(words.panels), words.vertices)), to_vectors(
            patterns, words
        )
    images = np.stack([encode(each, grid).to_channels() for each in patterns])
    model = GarmentVAE(vae_config(grid))
    model = model.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    return model, rasters_from_channels(images.reshape(len(images), 2, -1, grid, grid))


def used(data: Path, name: str, count: int) -> dict[str, float]:
    """Milliseconds of what exploring does."""
    from garmentimage.learn.data.pattern_vectors import read_patterns

    space = LatentSpace.load(name)
    patterns = read_patterns(data, "validation")[:count]
    latents = [space.encode(each) for each in patterns]
    channels = [space.decode_channels(z[None])[0] for z in latents]
    images = [repair(each)[0] for each in channels]
    rasters = [encode(each, space.grid).to_channels()[None] for each in patterns]
    return {
        "encode: pattern to latent": timed(space.encode, patterns),
        "of it the network": timed(space.encode_channels, rasters),
        "step: latent to checked pattern": timed(space.decode, latents),
        "network": timed(lambda z: space.decode_channels(z[None]), latents),
        "repair": timed(repair, channels),
        "decoding": timed(decode, images),
    }


def timed(work: Callable[[Any], object], items: Sequence[Any]) -> float:
    """The median over items [ms]."""
    taken = []
    for item in items:
        began = time.perf_counter()
        work(item)
        taken.append(time.perf_counter() - began)
    return round(1000 * float(np.median(taken)), 2)


if __name__ == "__main__":
    sys.exit(main())
