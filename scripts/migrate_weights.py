"""Rename the weights and configuration fields of trained networks to those of this version, once.

    python scripts/migrate_weights.py FOLDER...

A folder is what `garmentimage train` calls RUN/model. In `model.safetensors` and `config.json`
names change, and nothing else: the tensors stay bit for bit; ONNX files are not touched. As the
hash of a VAE's files changes, give the VAE of an image decoder together with it: the decoder knows
it by its hash.
"""

import argparse
import json
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from safetensors import safe_open
from safetensors.torch import save

from garmentimage.errors import GarmentImageError, LearnError
from garmentimage.learn.weights import WEIGHTS_CONTRACT
from garmentimage.system import shown_path, weights_hash, write_together

CONFIG_FILE, WEIGHTS_FILE = "config.json", "model.safetensors"
Renames = Sequence[tuple[str, str]]
"""Regular expressions of the starts of weights' names, and what replaces them."""

LEVELS: Renames = [
    (r"down\.", "levels.down."),
    (r"halve\.", "levels.downsample."),
    (r"up\.", "levels.up."),
    (r"narrow\.", "levels.project."),
    (r"take\.", "stem."),
    (r"give\.", "head."),
    (r"places$", "positions"),
]
UNET: Renames = [
    *((start, new) for start, new in LEVELS if start != r"take\."),
    (r"look\.", "image_stem."),
    (r"take\.", "map_stem."),
]


@dataclass(frozen=True)
class Kind:
    """A kind of network."""

    has: str
    """A field of its configuration, in either version, that no kind further down has."""
    weights: Renames
    fields: Mapping[str, str]
    """Fields of its configuration, and their names now."""


KINDS = (
    Kind(
        "network",
        [
            (r"see\.take\.", "image_encoder.stem."),
            (r"see\.net\.", "image_encoder.resnet."),
            (r"see\.spread$", "image_encoder.std"),
            (r"see\.", "image_encoder."),
            (r"whole\.", "global_features."),
            (r"to_there\.", "presence_head."),
            (r"to_place\.", "placement_head."),
            (r"to_edge\.", "edge_head."),
            (r"usual\.places$", "output_prior.placements"),
            (r"usual\.", "output_prior."),
            (r"narrow\.", "project."),
            (r"places$", "positions"),
        ],
        {},
    ),
    Kind(
        "boundary_weight",  # of a cascade; a VAE has it, too, and `blocks`
        [(rf"(to_\w+)\.{start}", rf"\1.{new}") for start, new in UNET],
        {
            "squares": "squared_losses",
            "noise": "label_noise",
            "recombine": "waist_mix",
            "even": "adjust_logits",
        },
    ),
    Kind(
        "vertices",
        [
            (r"kinds$", "panel_embedding"),
            (r"asked$", "distribution_tokens"),
            (r"out\.", "head."),
        ],
        {},
    ),
    Kind(
        "vae_sha256",
        [(r"take\.", "stem."), (r"narrow\.", "project."), (r"give\.", "head.")],
        {"spread": "latent_noise"},
    ),
    Kind(
        "text",
        [*LEVELS, (r"nothing$", "null_text"), (r"told\.", "conditioning.")],
        {"unsaid": "condition_dropout"},
    ),
)
VAE = Kind(
    "blocks",
    [
        (r"places\.", "positions."),
        (r"decoder\.(\d+)\.steer\.", r"decoder.\1.film."),
        (r"up\.", "project."),
        (r"decode_out\.", "head."),
    ],
    {},
)


def main() -> int:
    """Migrate the folders, or none of them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER")
    try:
        for line in migrate(parser.parse_args().folders):
            print(line)
    except (GarmentImageError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def migrate(folders: Sequence[Path]) -> list[str]:
    """Rename in all folders, VAEs before the networks that know them by their hash.

    Returns:
        A line for each folder.

    Raises:
        LearnError: a folder holds no network of ours, or an image decoder without its VAE.
    """
    configs = {folder: _read_config(folder) for folder in folders}
    old = [each for each in folders if "weights_contract" not in configs[each]]
    hashes = {weights_hash(folder): folder for folder in folders}
    for folder in old:
        of = configs[folder].get("vae_sha256")
        if of and of not in hashes:
            raise LearnError(
                f"{shown_path(folder)}: belongs to a VAE that is not among these folders; give "
                "that VAE's folder, too, as it was when this was trained"
            )
    lines = [
        f"{shown_path(each)}: is of this version already" for each in folders if each not in old
    ]
    for folder in sorted(old, key=lambda each: "vae_sha256" in configs[each]):
        config = dict(configs[folder])
        if config.get("vae_sha256"):
            config["vae_sha256"] = weights_hash(hashes[config["vae_sha256"]])
        lines.append(_migrate(folder, config))
    return lines


def _migrate(folder: Path, config: Mapping[str, Any]) -> str:
    kind = _kind_of(folder, config)
    fields = {kind.fields.get(name, name): value for name, value in config.items()}
    text = json.dumps({"weights_contract": WEIGHTS_CONTRACT, **fields}, indent=1) + "\n"
    files: dict[str | PathLike[str], bytes | str] = {folder / CONFIG_FILE: text}
    if not (folder / WEIGHTS_FILE).is_file():
        write_together(files)
        return f"{shown_path(folder)}: {CONFIG_FILE} renamed; there are no weights"
    with safe_open(folder / WEIGHTS_FILE, "pt") as file:
        tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 not a dict
        metadata = file.metadata()
    renamed = {_renamed(name, kind.weights): value for name, value in tensors.items()}
    assert len(renamed) == len(tensors)
    write_together({**files, folder / WEIGHTS_FILE: save(renamed, metadata)})
    count = len(renamed.keys() - tensors.keys())
    return f"{shown_path(folder)}: {count} of {len(renamed)} weights renamed"


def _renamed(name: str, renames: Renames) -> str:
    for start, new in renames:
        found, count = re.subn(f"^{start}", new, name)
        if count:
            return found
    return name


def _kind_of(folder: Path, config: Mapping[str, Any]) -> Kind:
    for kind in (VAE, *KINDS):
        if kind.has in config:
            return kind
    raise LearnError(f"{shown_path(folder)}: holds none of our networks")


def _read_config(folder: Path) -> dict[str, Any]:
    try:
        config = json.loads((folder / CONFIG_FILE).read_text(encoding="utf-8"))
        _kind_of(folder, config)
        return dict(config)
    except (OSError, ValueError, TypeError) as error:
        if isinstance(error, LearnError):
            raise
        raise LearnError(
            f"{shown_path(folder)}: holds no network (its {CONFIG_FILE} cannot be read)"
        ) from None


if __name__ == "__main__":
    raise SystemExit(main())
