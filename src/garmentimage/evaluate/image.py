"""Evaluation of prediction from pictures, on garments of seen and unseen types.

All predictors are measured on the same garments. Records are written to a folder one by one, so
that an interrupted run resumes. Nothing is trained.
"""

import json
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from garmentimage.dataset import (
    dataset_hash,
    has_split,
    parse_patterns,
    shard_files,
    shard_metadata,
)
from garmentimage.errors import LearnError
from garmentimage.evaluate.amounts import ImageAmounts
from garmentimage.evaluate.garment import measure_garment
from garmentimage.evaluate.predictors import TEACHER_STAGES, Predictor, load_predictor
from garmentimage.evaluate.records import Records
from garmentimage.evaluate.splits import TEST_SPLITS, check_splits, check_training
from garmentimage.metrics import interval, likeness
from garmentimage.raster.repair import LEVELS
from garmentimage.system import shown_path, source_commit, weights_hash

if TYPE_CHECKING:
    from garmentimage.learn.data import ImageSplit
    from garmentimage.pattern import Pattern

SEED = 31
TIME_LIMIT_S = 300.0
ACCESS_LOG = "opened.jsonl"
"""Log of when the test splits were used, and for which predictors."""
SPLIT_NAMES = {"test": "seen", "unseen": "unseen"}
STAGE_NAMES = {"flags": "flags", "types": "flags and edge types", "vectors": "image"}
"""The ground truth that a teacher-forced cascade is given, by its last stage."""
BY_TYPE = "panel_iou", "topology"
"""Figures that are also given by type of garment."""


@dataclass(frozen=True)
class ImageItem:
    """One garment for one predictor."""

    predictor: Predictor
    data: str
    held_out: str
    """The type that the networks were not trained on; empty if the dataset has a split `unseen`."""
    split: str
    number: int
    worn: bool
    validation: bool = False
    """Of the validation split instead of the test splits."""

    @property
    def name(self) -> str:
        """File of its record."""
        start = "validation-" if self.validation else ""
        return f"{start}{SPLIT_NAMES[self.split]}-{self.predictor.key}"


def with_baselines(predictors: Sequence[Predictor]) -> list[Predictor]:
    """The predictors with baselines, and with ablations of the first cascade."""
    found = [
        *predictors,
        Predictor("nearest picture", "nearest"),
        Predictor("another of its type", "random"),
    ]
    first = next((each for each in predictors if each.kind == "cascade"), None)
    if first is not None:
        found += [
            Predictor(first.name, "cascade", first.folder, level)
            for level in LEVELS
            if level != first.level
        ]
        if (Path(first.folder) / "model.safetensors").is_file():
            found += [
                Predictor(f"true {STAGE_NAMES[kind]}", kind, first.folder)
                for kind in TEACHER_STAGES
            ]
    return found


def evaluate_images(
    predictors: Sequence[Predictor],
    data: Path,
    folder: Path,
    amounts: ImageAmounts = ImageAmounts(),  # noqa: B008 - frozen
    *,
    held_out: str = "",
    validation: bool = False,
    workers: int = 2,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> dict[str, Any]:
    """Evaluate predictors on the same garments.

    Args:
        predictors: see `with_baselines`.
        data: a dataset of pictures.
        folder: where records are written; a run that was interrupted resumes.
        amounts: numbers of garments.
        held_out: a type of the dataset that the networks were trained without; its test garments
            are the unseen ones. Empty: those of the split `unseen`.
        validation: measure on the validation split, to choose settings by. There, garments are
            unseen if their type is the one held out.
        workers: processes.
        progress: called with the number of items that are complete, and of all.

    Returns:
        By predictor and split, figures with intervals of 95 %.

    Raises:
        LearnError: a network cannot be read or was trained on what it is measured on, or the
            folder holds records of other networks, data or amounts.
        DatasetError: the dataset has no pictures, or its splits overlap.
    """
    identity = {"data_sha256": dataset_hash(data), "held_out": held_out}
    disjoint = check_splits(data, held_out)
    for predictor in predictors:
        if predictor.folder:
            check_training(predictor, identity["data_sha256"], held_out)
            load_predictor(predictor, str(data), held_out)
    store = Records(
        folder, asdict(amounts), {each.key: identity | _weights_hash(each) for each in predictors}
    )
    items = _items(predictors, str(data), held_out, amounts, validation)
    records = store.gather(
        items,
        score_image_item,
        workers=workers,
        time_limit=TIME_LIMIT_S,
        progress=progress,
        is_whole=lambda item, record: not item.worn or record["draped"] is not None,
        begin=lambda missing: None if validation else _log_access(folder, missing),
    )
    return {
        "splits": disjoint,
        "opened": [json.loads(line) for line in _lines(folder / ACCESS_LOG)],
        "figures": summarise_images(items, records),
    }


def score_image_item(item: ImageItem) -> dict[str, Any]:
    """The record of an item."""
    album, patterns = load_garments(item.data, item.split, item.held_out, item.validation)
    guess = load_predictor(item.predictor, item.data, item.held_out)(album, item.number)
    return {
        "type": album.types[item.number],
        **likeness(patterns[item.number], guess.pattern).figures(),
        "panels found": len(guess.pattern.panels) if guess.pattern else 0,
        "draped": measure_garment(guess.pattern, guess.fault).valid if item.worn else None,
        "fault": guess.fault,
        "repairs": guess.repairs,
        "confidence": guess.confidence,
    }


def summarise_images(
    items: Sequence[ImageItem], records: Mapping[ImageItem, Mapping[str, Any]]
) -> dict[str, dict[str, Any]]:
    """Figures by predictor and split; of networks of one name the mean over their seeds."""
    groups: defaultdict[tuple[str, str], list[ImageItem]] = defaultdict(list)
    for item in items:
        groups[item.predictor.label, SPLIT_NAMES[item.split]].append(item)
    summary: defaultdict[str, dict[str, Any]] = defaultdict(dict)
    for (label, split), members in groups.items():
        garments: defaultdict[int, list[Mapping[str, Any]]] = defaultdict(list)
        seeds: defaultdict[str, list[float]] = defaultdict(list)
        known = [item for item in members if "lost" not in records[item]]
        for item in known:
            garments[item.number].append(records[item])
            seeds[item.predictor.key].append(records[item]["panel_iou"])
        if not known:
            continue
        figures = _figures(list(garments.values()))
        figures["lost"] = len(members) - len(known)
        if len(seeds) > 1:
            figures["panel_iou by seed"] = {
                key: round(float(np.mean(values)), 4) for key, values in sorted(seeds.items())
            }
        types: defaultdict[str, list[Sequence[Mapping[str, Any]]]] = defaultdict(list)
        for found in garments.values():
            types[found[0]["type"]].append(found)
        if len(types) > 1:
            figures["by type"] = {
                each: {key: _figures(types[each])[key] for key in BY_TYPE} for each in sorted(types)
            }
        summary[label][split] = figures
    return dict(summary)


def _figures(garments: Sequence[Sequence[Mapping[str, Any]]]) -> dict[str, Any]:
    """Each garment's records are those of some seeds."""
    figures: dict[str, Any] = {}
    for name in garments[0][0]:
        if name in ("type", "fault", "repairs", "panels found"):
            continue
        means = []
        for records in garments:
            known = [float(each[name]) for each in records if each[name] is not None]
            if known:
                means.append(float(np.mean(known)))
        if means:
            figures[name] = asdict(interval(means))
    every = [record for records in garments for record in records]
    repairs = Counter(rule for record in every for rule in record["repairs"])
    figures["repaired"] = {rule: round(n / len(every), 4) for rule, n in repairs.most_common()}
    faults = Counter(_fault_class(record["fault"]) for record in every if record["fault"])
    figures["faults"] = dict(faults.most_common())
    return figures


def _items(
    predictors: Sequence[Predictor],
    data: str,
    held_out: str,
    amounts: ImageAmounts,
    validation: bool,
) -> list[ImageItem]:
    items = []
    for split in TEST_SPLITS:
        if not amounts.of(split) or (
            split == "unseen" and not has_unseen(data, held_out, validation)
        ):
            continue
        album, _ = load_garments(data, split, held_out, validation)
        if len(album.ids) < amounts.of(split):
            raise LearnError(
                f"{shown_path(data)}: has {len(album.ids)} {SPLIT_NAMES[split]} garments for "
                f"{'validation' if validation else 'test'}; {amounts.of(split)} are needed "
                f"(--{SPLIT_NAMES[split]})"
            )
        order = measuring_order(album)
        for predictor in predictors:
            is_part = predictor.level != "full" or predictor.kind in TEACHER_STAGES
            count = min(amounts.parts, amounts.of(split)) if is_part else amounts.of(split)
            items += [
                ImageItem(
                    predictor,
                    data,
                    held_out,
                    split,
                    number,
                    worn=not is_part and k < amounts.draped,
                    validation=validation,
                )
                for k, number in enumerate(order[:count])
            ]
    return items


def has_unseen(data: str, held_out: str, validation: bool = False) -> bool:
    """Whether there are garments of unseen types to measure on."""
    if held_out or validation:  # the split `unseen` is for test only
        return bool(held_out)
    return has_split(data, "unseen")


def measuring_order(album: "ImageSplit") -> list[int]:
    """Random order in which its garments are measured."""
    order: list[int] = np.random.default_rng(SEED).permutation(len(album.ids)).tolist()
    return order


@cache
def load_garments(
    data: str, split: str, held_out: str, validation: bool = False
) -> "tuple[ImageSplit, list[Pattern]]":
    """Garments of seen or unseen types to measure on, with their patterns."""
    from garmentimage.learn.data import load_split

    place = "validation" if validation else "test"
    if held_out:
        without = (
            {held_out}
            if split == "test"
            else {*shard_metadata(shard_files(data)[0]).types} - {held_out}
        )
        album = load_split(data, place, without=sorted(without))
    else:
        album = load_split(data, place if split == "test" else split)
    return album, parse_patterns(album.patterns, data)


def _weights_hash(predictor: Predictor) -> dict[str, str]:
    return {"weights_sha256": weights_hash(Path(predictor.folder)) if predictor.folder else ""}


def _log_access(folder: Path, missing: Sequence[ImageItem]) -> None:
    """Add to the log that the test splits are used now."""
    line = {
        "when": datetime.now(UTC).isoformat(timespec="seconds"),
        "commit": source_commit(),
        "for": sorted({item.predictor.key for item in missing}),
        "garments": dict(Counter(SPLIT_NAMES[item.split] for item in missing)),
    }
    with (folder / ACCESS_LOG).open("a", encoding="utf-8") as opened:
        opened.write(json.dumps(line) + "\n")


def _lines(file: Path) -> list[str]:
    return file.read_text(encoding="utf-8").splitlines() if file.exists() else []


def _fault_class(fault: str) -> str:
    """A fault without names and numbers, for counting."""
    words = fault.split("(")[0].split(";")[0].split()
    kept = [word for word in words if not any(c.isdigit() for c in word) and "'" not in word]
    return " ".join(kept)[:60]
