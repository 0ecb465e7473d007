"""Evaluation of editing by text: every editing method, prompt and held-out garment.

Records are written to a folder one by one, so that an interrupted run resumes. Nothing is trained.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

import numpy as np
import torch

from garmentimage.dataset import dataset_hash, parse_patterns, read_rows
from garmentimage.errors import LearnError
from garmentimage.evaluate.codecs import Codec, RasterCodec, VectorCodec
from garmentimage.evaluate.garment import measure_garment
from garmentimage.evaluate.prompts import PROMPTS, Prompt, is_applicable
from garmentimage.evaluate.records import Records
from garmentimage.latent import LatentSpace
from garmentimage.learn import load_weights
from garmentimage.learn.data import embed_texts
from garmentimage.learn.models import ImageDecoder
from garmentimage.metrics import EditedRegion, interval, measure_shape, preserved_iou
from garmentimage.networks import DecodedGarment
from garmentimage.pattern import Pattern
from garmentimage.system import shown_path, weights_hash
from garmentimage.text_edit import (
    DEFAULT_STEPS,
    MAX_ATTEMPTS,
    REPROJECTIONS,
    best_attempt,
    check_pair,
    denoiser_guidance,
    edit_prompts,
    run_edit,
)

SEED = 50
TIME_LIMIT_S = 600.0
GROUPS = ("topology", "parts", "geometry")


@dataclass(frozen=True)
class EditMethod:
    """A way to edit garments: networks with settings, or a baseline."""

    name: str
    kind: Literal["raster", "vectors", "nothing", "caption"]
    data: str
    """The dataset that it was trained on."""
    space: str = ""
    """Folder of its latent space; of a vector VAE, of its weights."""
    pictures: str = ""
    denoiser: str = ""
    strength: float = 1.0
    steps: int = DEFAULT_STEPS
    tries: int = MAX_ATTEMPTS


@dataclass(frozen=True)
class EditItem:
    """One garment and one prompt for one method."""

    editing: EditMethod
    prompt: int
    """Which of `PROMPTS`."""
    garment: int
    split: str
    number: int
    """Of the item among those of its method."""

    @property
    def name(self) -> str:
        """File of its record."""
        return self.editing.name


def evaluate_text_edits(
    editors: Sequence[EditMethod],
    data: Path,
    folder: Path,
    garments: int = 24,
    *,
    validation: bool = False,
    workers: int = 2,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> dict[str, Any]:
    """Apply every editing method to the same garments and prompts.

    Args:
        editors: the methods.
        data: a dataset; its test garments are edited, types in turn.
        folder: where records are written; a run that was interrupted resumes.
        garments: number of garments.
        validation: edit garments of the validation split, to choose settings by.
        workers: processes.
        progress: called with the number of items that are complete, and of all.

    Returns:
        By method, figures with intervals of 95 %, for each prompt and each group of prompts.

    Raises:
        LearnError: a network cannot be read, there are too few garments, or the folder holds
            records of other networks, data or amounts.
    """
    for each in editors:
        _check(each)
    items = _items(editors, str(data), garments, "validation" if validation else "test")
    data_sha256 = dataset_hash(data)
    networks = {
        each.name: {"data_sha256": data_sha256} | {
            name: weights_hash(Path(getattr(each, name))) if getattr(each, name) else ""
            for name in ("space", "pictures", "denoiser")
        } | {"strength": each.strength, "steps": each.steps, "tries": each.tries}
        for each in editors
    }  # fmt: skip
    records = Records(folder, {"garments": garments, "validation": validation}, networks)
    found = records.gather(
        items, score_edit_item, workers=workers, time_limit=TIME_LIMIT_S, progress=progress
    )
    return {
        each.name: summarise_edits([found[item] for item in items if item.editing == each])
        for each in editors
    }


def score_edit_item(item: EditItem) -> dict[str, Any]:
    """The record of an item."""
    prompt = PROMPTS[item.prompt]
    start = held_out_garments(item.editing.data, item.split)[item.garment]
    began = perf_counter()
    end, fault = apply_edit(item.editing, start, prompt.text)
    took = perf_counter() - began
    before, after = measure_shape(start), measure_shape(end)
    assert before is not None  # see `applicable_prompts`
    return {
        "prompt": prompt.text,
        "group": prompt.group,
        "done": after is not None and prompt.is_achieved(before, after),
        "kept": preserved_iou(prompt.region, start, end),
        "valid": measure_garment(end, fault).valid,
        "seconds": round(took, 2),
        "before": asdict(before),
        "after": asdict(after) if after else None,
    }


def apply_edit(editing: EditMethod, start: Pattern, text: str) -> tuple[Pattern | None, str]:
    """The garment that a method makes of another, and its first fault; empty if it is valid."""
    if editing.kind == "caption":
        return _nearest_caption(editing.data, text), ""
    codec = load_method_codec(editing).symmetrised_for(start)
    z = codec.latents([start])[0]
    step = (
        codec.decode(z) if editing.kind == "nothing" else _best_edit(editing, codec, z, start, text)
    )
    return step.pattern, step.faults[0] if step.faults else ""


def summarise_edits(records: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Figures by prompt, by group and of all."""
    known = [record for record in records if "lost" not in record]
    summary: dict[str, Any] = {"measured": len(known), "lost": len(records) - len(known)}
    groups: dict[str, list[Mapping[str, Any]]] = {"all": list(known)}
    for group in GROUPS:
        groups[group] = [record for record in known if record["group"] == group]
    for prompt in PROMPTS:
        groups[f"'{prompt.text}'"] = [r for r in known if r["prompt"] == prompt.text]
    for name, rows in groups.items():
        if rows:
            summary[name] = {
                key: asdict(interval([float(row[key]) for row in rows]))
                for key in ("done", "kept", "valid", "seconds")
            }
    return summary


def _best_edit(
    editing: EditMethod, codec: Codec, z: np.ndarray, start: Pattern, text: str
) -> DecodedGarment:
    torch.set_num_threads(1)
    guidance, _ = denoiser_guidance(editing.denoiser, text)
    target_prompt, source_prompt = edit_prompts(start, text)

    def attempt(boost: float, region: EditedRegion | None) -> DecodedGarment:
        found = run_edit(
            torch.from_numpy(np.asarray(z, np.float32)),
            _image_decoder(editing.pictures),
            guidance,
            target_prompt,
            source_prompt,
            strength=editing.strength,
            steps=editing.steps,
            boost=boost,
            region=region,
        )
        return codec.decode(codec.reproject(found.numpy(), REPROJECTIONS))

    return best_attempt(start, text, attempt, editing.tries).step


def _check(editing: EditMethod) -> None:
    """Read the networks of a method once, so that what does not fit is found before the work."""
    if editing.kind == "caption":
        return
    load_method_codec(editing)
    if editing.kind == "nothing":
        return
    pictures = _image_decoder(editing.pictures)
    check_pair(Path(editing.space), pictures)
    guidance, _ = denoiser_guidance(editing.denoiser, "a dress")
    guidance.gradient(pictures.draw(torch.zeros(1, pictures.config.latent)), "a dress", 0.0)


@cache
def load_method_codec(editing: EditMethod) -> Codec:
    """The latent space of a method, loaded once in each process."""
    if editing.kind == "vectors":
        return VectorCodec(Path(editing.space))
    return RasterCodec(LatentSpace.load(editing.space))


@cache
def _image_decoder(folder: str) -> Any:
    return load_weights(ImageDecoder, folder)


def applicable_prompts(garments: Sequence[Pattern]) -> list[tuple[int, Prompt]]:
    """Numbers of garments, with the prompts that are not yet true of them."""
    return [
        (number, prompt)
        for number, start in enumerate(measure_shape(pattern) for pattern in garments)
        for prompt in PROMPTS
        if start and is_applicable(prompt, start)
    ]


@cache
def held_out_garments(data: str, split: str) -> list[Pattern]:
    """Garments of a split, in random order, types taking turns."""
    texts: dict[str, list[str]] = {}
    for name, text in read_rows(data, split, "type", "pattern"):
        texts.setdefault(name, []).append(text)
    random = np.random.default_rng(SEED)
    for group in texts.values():
        random.shuffle(group)
    most = max(len(group) for group in texts.values())
    turns = [group[k] for k in range(most) for group in texts.values() if k < len(group)]
    return parse_patterns(turns, data)


@cache
def _nearest_caption(data: str, text: str) -> Pattern:
    """The first training garment with the caption that is nearest to a text."""
    first: dict[str, str] = {}
    for captions, pattern in read_rows(data, "train", "captions", "pattern"):
        for caption in captions:
            first.setdefault(caption, pattern)
    captions = list(first)
    best = int((embed_texts(captions) @ embed_texts([text])[0]).argmax())
    return parse_patterns([first[captions[best]]], data)[0]


def _items(editors: Sequence[EditMethod], data: str, garments: int, split: str) -> list[EditItem]:
    known = held_out_garments(data, split)
    if len(known) < garments:
        raise LearnError(
            f"{shown_path(data)}: has {len(known)} garments of split {split}; {garments} are needed"
        )
    asked = applicable_prompts(known[:garments])
    return [
        EditItem(editing, PROMPTS.index(prompt), garment, split, number)
        for editing in editors
        for number, (garment, prompt) in enumerate(asked)
    ]
