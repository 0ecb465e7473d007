"""What do networks learn of cloth on cloth? One small VAE, with channels of three layouts.

    python benchmarks/learning_layers.py data|train|judge WORK [--count 240] [--steps 1500]

`data` drafts and encodes garments of twelve kinds (N = 16); 12 of each are held out. `train` trains
the same VAE for the same number of steps with contract 1 (on the garments that it holds, panels
that wrap round cut), with contract 2 and two layers (on these garments, and on all without a second
sheet), and with contract 2 and four layers. `judge` takes the held-out garments through the
networks, decodes them with full repair, and compares them with what their images decode to without
a network. Every stage resumes where it was stopped.
"""

import argparse
import hashlib
import json
import math
import sys
import time
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from provenance import provenance
from tqdm import tqdm

import garmentimage as gi
from garmentimage.compare import match_panels, structure_faults
from garmentimage.draft import sample
from garmentimage.errors import GarmentImageError
from garmentimage.learn import TrainingSettings, train
from garmentimage.learn.data import Rasters
from garmentimage.learn.data.rasters import rasters_from_channels
from garmentimage.learn.models import GarmentVAE, output_channels
from garmentimage.learn.models.garment_vae import GarmentVAEConfig
from garmentimage.metrics import interval
from garmentimage.networks import decoded_garment, topology_or_empty
from garmentimage.pattern import Pattern
from garmentimage.raster import CONTRACTS, ChannelLayout, EdgeType

GRID, SEED, HELD_OUT = 16, 77, 12
KINDS = (
    *("tee", "skirt", "pants", "top-skirt", "one-panel-dress"),
    *("hoodie", "vest", "blazer", "pocket-skirt", "cargo-pants", "peplum-top", "pleated-skirt"),
)
GROUPS = ("plain", "hood", "lapel", "pocket", "peplum", "pleat")
VARIANTS = {
    "contract 1": (1, 2, 1),
    "contract 2, two layers, garments of contract 1": (2, 2, 1),
    "contract 2, two layers": (2, 2, 2),
    "contract 2, four layers": (2, 4, 2),
}
"""Contract and layers of the network, and the contract that holds its garments."""
SIZE: dict[str, Any] = {"channels": (32, 64, 64)}
BATCH = 32


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("stage", choices=("data", "train", "judge"))
    parser.add_argument("work", type=Path)
    parser.add_argument("--count", type=int, default=240, help="garments of each kind")
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("-o", "--out", type=Path)
    options = parser.parse_args()
    torch.set_num_threads(1)
    options.work.mkdir(parents=True, exist_ok=True)
    if options.stage == "data":
        draft_all(options.work, options.count)
    elif options.stage == "train":
        for name in VARIANTS:
            _, facts = trained(name, options.work, options.steps)
            print(name, json.dumps(facts), flush=True)
    else:
        result = judged(options.work, options.steps)
        if options.out:
            options.out.write_text(json.dumps(result, indent=1) + "\n")
        print(json.dumps(result, indent=1))
    return 0


def draft_all(work: Path, count: int) -> None:
    """Draft and encode what is not there yet, kind by kind in turn; failures are kept as such."""
    for index in tqdm(range(count), disable=None):
        for kind in KINDS:
            file = work / f"{kind}-{index:04d}.npz"
            if file.exists() or file.with_suffix(".failed").exists():
                continue
            pattern = next(iter(sample(kind, 1, SEED, first=index))).pattern
            try:
                gi.save_image(gi.encode(pattern, GRID), file)
            except GarmentImageError as error:
                file.with_suffix(".failed").write_text(str(error))


@cache
def garments(work: Path, *, held_out: bool) -> dict[str, gi.GarmentImage]:
    """Images of the data by name, without their marks."""
    files = sorted(work.glob("*-[0-9][0-9][0-9][0-9].npz"))
    chosen = [file for file in files if (int(file.stem[-4:]) < HELD_OUT) == held_out]
    return {file.stem: gi.load_image(file).without_marks() for file in chosen}


def fits(image: gi.GarmentImage, layers: int, contract: int) -> bool:
    """Whether a variant has a garment; contract 1 has panels that wrap round, cut."""
    return image.layers <= layers and (contract == 2 or image.cut_at_wraps().contract == 1)


def channels_of(image: gi.GarmentImage, contract: int, layers: int) -> np.ndarray:
    """Channels of an image for a network, [channel, row, column]."""
    image = image.cut_at_wraps() if contract == 1 else image
    return image.to_channels(CONTRACT_NUMBERS[contract], layers=layers)


CONTRACT_NUMBERS: dict[int, Any] = {1: 1, 2: 2}


def rasters(work: Path, name: str, *, held_out: bool) -> Rasters:
    """What a variant learns from, or is watched by."""
    contract, layers, holds = VARIANTS[name]
    layout = ChannelLayout(CONTRACTS[CONTRACT_NUMBERS[contract]], layers)
    images = garments(work, held_out=held_out).values()
    found = np.stack([channels_of(i, contract, layers) for i in images if fits(i, layers, holds)])
    return rasters_from_channels(found.reshape(len(found), layers, -1, GRID, GRID), layout)


def trained(name: str, work: Path, steps: int) -> tuple[GarmentVAE, dict[str, Any]]:
    """The network of a variant, and what its training came to."""
    contract, layers, _ = VARIANTS[name]
    config = GarmentVAEConfig(
        channels_contract=CONTRACTS[CONTRACT_NUMBERS[contract]].name, layers=layers, **SIZE
    )
    train_set, held_out = (rasters(work, name, held_out=each) for each in (False, True))
    epochs = math.ceil(steps / (len(train_set) // BATCH))
    torch.manual_seed(0)
    run = train(
        GarmentVAE(config).to(memory_format=torch.channels_last),  # type: ignore[call-overload]
        train_set,
        held_out,
        folder=work / f"run-{steps}-{name.replace(', ', '-').replace(' ', '-')}",
        settings=TrainingSettings(epochs=epochs, batch=BATCH),
        facts={"network": "vae", "variant": name, "data_sha256": data_hash(work)},
    )
    done = epochs * (len(train_set) // BATCH)
    seconds = sum(line["seconds"] for line in run.log)
    return run.model, {
        "channels": config.layout.channels,
        "weights": sum(part.numel() for part in run.model.parameters()),
        "garments": len(train_set),
        "steps": done,
        "minutes": round(seconds / 60, 1),
        "ms_a_step": round(1000 * seconds / done, 1),
        "held_out_losses": {k[9:]: v for k, v in run.log[-1].items() if k.startswith("held-out")},
    }


@cache
def data_hash(work: Path) -> str:
    """SHA-256 of the channels of all garments, in order of name."""
    digest = hashlib.sha256()
    for held_out in (False, True):
        for name, image in garments(work, held_out=held_out).items():
            digest.update(name.encode() + image.to_channels(2, layers=4).tobytes())
    return digest.hexdigest()


def judged(work: Path, steps: int) -> dict[str, Any]:
    """All variants, by group of garments."""
    result: dict[str, Any] = {
        **provenance([]),
        "data_sha256": data_hash(work),
        "not_encoded": len(list(work.glob("*.failed"))),
        "seed": SEED,
        "variants": {},
    }
    plain: dict[str, float] = {}
    for name in VARIANTS:
        network, facts = trained(name, work, steps)
        file = work / f"judged-{steps}-{name.replace(' ', '-')}.json"
        if not file.exists():
            file.write_text(json.dumps(reconstructions(network, name, work)))
        rows = json.loads(file.read_text())
        groups = {group: [row for row in rows if row["group"] == group] for group in GROUPS}
        groups["all"] = rows
        found = {row["garment"]: row["iou"] for row in rows if row["group"] == "plain"}
        plain = plain or found
        difference = interval([found[each] - plain[each] for each in plain])
        facts["plain_iou_minus_contract_1"] = [difference.mean, difference.low, difference.high]
        facts["by_group"] = {group: means(of) for group, of in groups.items() if of}
        result["variants"][name] = facts
    return result


@torch.no_grad()
def reconstructions(network: GarmentVAE, name: str, work: Path) -> list[dict[str, Any]]:
    """Every held-out garment that a variant holds, through its network and back."""
    contract, layers, holds = VARIANTS[name]
    rows = []
    for garment, image in tqdm(garments(work, held_out=True).items(), disable=None):
        if not fits(image, layers, holds):
            continue
        channels = channels_of(image, contract, layers)
        truth = gi.decode(channels)
        began = time.perf_counter()
        z = network.encode(_inputs(channels, contract, layers))[0]
        shares = output_channels(network.decode(z))[0].numpy()
        through = time.perf_counter()
        found = decoded_garment(z[0].numpy(), shares, "full")
        rows.append(
            {
                "garment": garment,
                "group": group_of(garment, image),
                **compared(truth, found.pattern),
                "cells": cells_and_edges(channels, shares),
                "network_ms": 1000 * (through - began),
                "repair_ms": 1000 * (time.perf_counter() - through),
            }
        )
    return rows


def _inputs(channels: np.ndarray, contract: int, layers: int) -> torch.Tensor:
    layout = ChannelLayout(CONTRACTS[CONTRACT_NUMBERS[contract]], layers)
    layered = channels.reshape(1, layers, -1, GRID, GRID)
    return rasters_from_channels(layered, layout).inputs()


def group_of(name: str, image: gi.GarmentImage) -> str:
    """What a garment has; a blazer with pockets is among the lapels."""
    if image.turned.any():
        return "lapel"
    if image.layers > 2:
        return "peplum" if name.startswith("peplum") else "pocket"
    if (image.edge_type == EdgeType.CREASE).any():
        return "pleat"
    return "hood" if (image.edge_type == EdgeType.WRAP).any() else "plain"


def cells_and_edges(true_channels: np.ndarray, shares: np.ndarray) -> dict[str, list[int]]:
    """How much of each sort a network shows before repair, and how much there is: cells inside and
    turned (both, either), and grid edges of each type (found, all).
    """
    truth, found = (gi.GarmentImage.from_channels(each) for each in (true_channels, shares))
    counts = {
        name: [int((a & b).sum()), int((a | b).sum())]
        for name, a, b in (
            ("inside", truth.inside, found.inside),
            ("turned", truth.turned, found.turned),
        )
    }
    for kind in EdgeType:
        is_kind = truth.edge_type == kind
        counts[kind.name] = [int((is_kind & (found.edge_type == kind)).sum()), int(is_kind.sum())]
    return counts


def compared(truth: Pattern, found: Pattern | None) -> dict[str, Any]:
    """One garment against the truth; of seams from right side to wrong side, pockets and pleats,
    how many there are and how many came back.
    """
    wrong_sides = Counter(_turned_seams(truth, {}))
    wanted = {
        "turned_seams": wrong_sides.total(),
        "onto": len(truth.onto),
        "pleats": len(truth.pleats),
    }
    if found is None or structure_faults(found):
        return {"decoded": False, "iou": 0.0, "same": False, "wanted": wanted, "back": {}}
    matching = match_panels(truth, found)
    panels = {there: here for here, there in matching.panel_map.items()}
    again = Counter(_turned_seams(found, panels))
    return {
        "decoded": True,
        "iou": matching.mean_iou,
        "same": topology_or_empty(found) == topology_or_empty(truth),
        "wanted": wanted,
        "back": {
            "turned_seams": (wrong_sides & again).total(),
            "onto": min(len(found.onto), len(truth.onto)),
            "pleats": min(len(found.pleats), len(truth.pleats)),
        },
        "extra_turned_seams": (again - wrong_sides).total(),
    }


def _turned_seams(pattern: Pattern, names: dict[str, str]) -> list[tuple[str, ...]]:
    """The panels on both sides of each seam from right side to wrong side, under other names."""
    return [
        tuple(sorted(names.get(side.panel, side.panel) for side in stitch.sides))
        for stitch in pattern.stitches
        if stitch.same_direction
    ]


def means(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares and means over some garments."""
    found: dict[str, Any] = {"garments": len(rows)}
    for key, digits in (("decoded", 3), ("iou", 4), ("same", 3)):
        found[key] = round(float(np.mean([row[key] for row in rows])), digits)
    for key in ("turned_seams", "onto", "pleats"):
        total = sum(row["wanted"][key] for row in rows)
        if total:
            found[key] = [sum(row["back"].get(key, 0) for row in rows), total]
    cells = {key: np.sum([row["cells"][key] for row in rows], axis=0) for key in rows[0]["cells"]}
    found["cells"] = {key: round(float(a / b), 3) for key, (a, b) in cells.items() if b}
    found["extra_turned_seams"] = sum(row.get("extra_turned_seams", 0) for row in rows)
    for key in ("network_ms", "repair_ms"):
        found[key] = round(float(np.median([row[key] for row in rows])), 1)
    return found


if __name__ == "__main__":
    sys.exit(main())
