"""True rasters as a network would give them, repaired and decoded: what is lost.

    python benchmarks/softened.py FOLDER... [--count 600] [--drafts 500] [--grid 16]
        [--kept data/rasters] [-o OUT.json]

FOLDERs of pattern files are sources, and so are drafts of every kind. Each true raster is given as
shares of .9, .99 and .999 for what is true, the rest spread evenly; as these with noise of one nat
added to every logit; and as outputs of a network of squared errors, the truth with noise of 0.1.
The pattern decoded at each level of repair is compared with that of the raster itself at that
level. The noise is drawn anew for each raster, from its name.
"""

import argparse
import hashlib
import json
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from provenance import provenance
from tqdm import tqdm
from true_rasters import DRAFTS, true_rasters

import garmentimage as gi
from garmentimage.errors import DecodeError
from garmentimage.metrics.similarity import likeness
from garmentimage.raster.channel_kind import ChannelKind
from garmentimage.raster.channels import (
    CHANNELS_PER_LAYER,
    EDGE_TYPE_COUNT,
    join_channels,
    split_channels,
)
from garmentimage.raster.repair.repairer import LEVELS, RepairLevel, repair

SHARES = 0.9, 0.99, 0.999
NOISE_NATS, SQUARED_NOISE = 1.0, 0.1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", type=Path, nargs="*", metavar="FOLDER")
    parser.add_argument("--count", type=int, default=600, help="garments of each folder")
    parser.add_argument("--drafts", type=int, default=500)
    parser.add_argument("--grid", type=int, default=16)
    parser.add_argument("--kept", type=Path, default=Path("data/rasters"), help="for images")
    parser.add_argument("-o", "--out", type=Path)
    args = parser.parse_args()
    result: dict[str, Any] = {**provenance(args.folders), "seed": 0, "grid": args.grid}
    for folder in (None, *args.folders):
        count = args.count if folder else args.drafts
        images = true_rasters(folder, args.grid, count, args.kept)
        source = folder.name if folder else DRAFTS
        result[source] = measured(source, images)
        print(source, json.dumps(result[source], indent=1), flush=True)
    if args.out:
        args.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return 0


def measured(source: str, images: dict[str, gi.GarmentImage]) -> dict[str, Any]:
    """By form and level, the shares of rasters that keep all panels, and come back the same."""
    found: Counter[tuple[str, str, str]] = Counter()
    lost: dict[str, list[str]] = {}
    decodable: Counter[str] = Counter()
    for name, image in tqdm(images.items(), source, disable=None, leave=False):
        bare = image.without_marks()
        for level in LEVELS:
            plain, _ = repair(bare, level)
            try:
                truth = gi.decode(plain, repair=level)
            except DecodeError:
                continue
            decodable[level] += 1
            for form, channels, kind in forms(bare, name):
                fate = fate_of(channels, kind, level, plain, truth)
                found.update((form, level, each) for each in fate)
                if "panels" not in fate and level == "full":
                    lost.setdefault(form, []).append(name)
    names = [form for form, _, _ in forms(bare, name)]
    return {
        "rasters": len(images),
        "decoded as they are": dict(decodable),
        "forms": {
            form: {
                level: {
                    "no panel lost": round(found[form, level, "panels"] / decodable[level], 4),
                    "same stitch graph": round(found[form, level, "graph"] / decodable[level], 4),
                    "same image": round(found[form, level, "image"] / decodable[level], 4),
                }
                for level in LEVELS
            }
            for form in names
        },
        "lost panels at full repair": lost,
    }


def fate_of(
    channels: np.ndarray,
    kind: ChannelKind,
    level: RepairLevel,
    plain: gi.GarmentImage,
    truth: gi.Pattern,
) -> set[str]:
    """Which of panels, stitch graph and image are what they were."""
    image, _ = repair(channels, level, kind=kind)
    if np.array_equal(image.inside, plain.inside) and np.array_equal(
        image.edge_type, plain.edge_type
    ):
        return {"panels", "graph", "image"}
    try:
        pattern = gi.decode(image, repair=level)
    except DecodeError:
        return set()
    fate = {"panels"} if len(pattern.panels) >= len(truth.panels) else set()
    return fate | ({"graph"} if likeness(truth, pattern).topology else set())


def forms(image: gi.GarmentImage, name: str) -> Iterator[tuple[str, np.ndarray, ChannelKind]]:
    """The raster as networks of several sorts would give it: name, numbers, and their kind."""
    seed = int.from_bytes(hashlib.sha256(name.encode()).digest()[:4], "big")
    for share in SHARES:
        rng = np.random.default_rng(seed)
        yield f"shares of {share:g}", softened(image, share), "shares"
        yield f"shares of {share:g}, noise", softened(image, share, rng), "shares"
    rng = np.random.default_rng(seed)
    channels = image.to_channels().astype(float)
    noisy = channels.reshape(image.layers, CHANNELS_PER_LAYER, -1)
    noisy[:, : 1 + 2 * EDGE_TYPE_COUNT] += rng.normal(
        0, SQUARED_NOISE, noisy[:, : 1 + 2 * EDGE_TYPE_COUNT].shape
    )
    yield f"squared errors, noise of {SQUARED_NOISE:g}", channels, "channels"


def softened(
    image: gi.GarmentImage, share: float, rng: np.random.Generator | None = None
) -> np.ndarray:
    """Channels in which all that is true has a share; `rng` draws noise for their logits."""
    flags, types, vectors, _ = split_channels(image.to_channels().astype(float))
    rest = (1 - share) / (EDGE_TYPE_COUNT - 1)
    odds = (2 * flags - 1) * np.log(share / (1 - share))
    each = np.log(np.where(types > 0.5, share, rest))
    if rng is not None:
        odds = odds + rng.normal(0, NOISE_NATS, odds.shape)
        each = each + rng.normal(0, NOISE_NATS, each.shape)
    weights = np.exp(each)
    shares = weights / weights.sum(axis=2, keepdims=True)
    return join_channels(1 / (1 + np.exp(-odds)), shares, vectors)


if __name__ == "__main__":
    sys.exit(main())
