"""Proof that networks were not trained on the garments that they are measured on."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from garmentimage.errors import DatasetError, LearnError, quoted
from garmentimage.evaluate.predictors import Predictor
from garmentimage.evaluate.records import RUN_FILE
from garmentimage.system import shown_path

SPLITS = ("test", "unseen")
"""Of a dataset: garments of types that were trained on, and of others."""


def check_splits(data: Path, held_out: str = "") -> dict[str, Any]:
    """Prove that no garment that is measured on is one that networks learn from.

    Neither its row, nor its pattern, nor its type where it is unseen; nor who wears it, where the
    recipe has bodies for test.

    Returns:
        How much was learnt from, and how much of it is in test: nothing.

    Raises:
        DatasetError: says what is in both.
    """
    from garmentimage.dataset import load_recipe, read_summary

    bodies = ("body",) if load_recipe(read_summary(data)["recipe"]).test_bodies else ()
    told = ("id", "pattern", "type", *bodies)
    learnt: dict[str, set[str]] = {name: set() for name in told}
    for split in ("train", "validation"):
        for name, values in _column_values(data, split, told, held_out).items():
            learnt[name] |= values
    shared: dict[str, int] = {}
    unseen_types = {held_out} if held_out else set()
    for split in SPLITS:
        for name, values in _column_values(data, split, told).items():
            if name == "type" and split == "unseen" and not held_out:
                unseen_types |= values
            if name == "type" and split == "test":
                continue
            both = learnt[name] & values
            if both:
                raise DatasetError(
                    f"{shown_path(data)}: {len(both)} of split {quoted(split)} have the same "
                    f"{name} as garments in training, such as {quoted(min(both)[:60])}"
                )
            shared[f"{name} of split {split} in training"] = len(both)
    return {
        "rows learnt from": len(learnt["id"]),
        "types learnt from": sorted(learnt["type"]),
        "unseen types": sorted(unseen_types),
        **shared,
    }


def _column_values(
    data: Path, split: str, columns: Sequence[str], without: str = ""
) -> dict[str, set[str]]:
    """All values of some columns in a split; none where there is no such split."""
    from garmentimage.dataset import has_split, read_tables

    found: dict[str, set[str]] = {name: set() for name in columns}
    if not has_split(data, split):
        return found
    for table in read_tables(data, split, list(columns)):
        kept = [name != without for name in table["type"].to_pylist()]
        for name, values in found.items():
            values.update(v for v, is_kept in zip(table[name].to_pylist(), kept) if is_kept)
    return found


def check_training(guesser: Predictor, data_sha256: str, held_out: str) -> None:
    """Refuse a network that was trained on other data: the garments measured on may be in those."""
    run = read_run(guesser)
    if not run:
        return  # not from a run of this machine; its card tells what it was trained on
    trained, without = run.get("data_sha256"), run.get("without", [])
    if trained != data_sha256:
        raise LearnError(
            f"{shown_path(guesser.folder)}: was trained on other data than it is to be measured on"
        )
    if held_out and held_out not in without:
        raise LearnError(
            f"{shown_path(guesser.folder)}: was trained on type {quoted(held_out)}, too; train it "
            f"with --without {quoted(held_out)}"
        )


def read_run(guesser: Predictor) -> dict[str, Any]:
    """What is known of the run that a network came from; nothing where it was copied away."""
    file = Path(guesser.folder).parent / RUN_FILE
    if not file.is_file():
        return {}
    try:
        run = json.loads(file.read_text(encoding="utf-8"))["run"]
        return dict(run)
    except (ValueError, KeyError, TypeError):
        raise LearnError(f"{shown_path(file)}: is damaged") from None


def group_by_held_out(
    guessers: Sequence[Predictor], data: Path, *, validation: bool = False
) -> dict[str, list[Predictor]]:
    """Guessers by the type that their networks were trained without; "" where splits tell it.

    For validation they never tell it. A network trained on all types is measured on seen ones.

    Raises:
        LearnError: a network was trained without several types.
    """
    from garmentimage.dataset import has_split

    is_told = has_split(data, "unseen")
    if is_told and not (validation and any(read_run(each).get("without") for each in guessers)):
        return {"": list(guessers)}
    found: dict[str, list[Predictor]] = {}
    for guesser in guessers:
        without = read_run(guesser).get("without", [])
        if len(without) > 1:
            raise LearnError(
                f"{shown_path(guesser.folder)}: was trained without {len(without)} types; this "
                "dataset takes networks that were trained without one, or on all"
            )
        held_out = without[0] if without else ""
        # Of one network trained without each type in turn, `NAME-TYPE`, the name is `NAME`.
        name = guesser.name.removesuffix(f"-{held_out}") if held_out else guesser.name
        found.setdefault(held_out, []).append(replace(guesser, name=name))
    return found
