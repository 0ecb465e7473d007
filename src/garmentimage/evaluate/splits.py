"""Checks that networks were not trained on the garments that they are measured on."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from garmentimage.errors import DatasetError, LearnError, quoted
from garmentimage.evaluate.predictors import Predictor
from garmentimage.evaluate.records import RUN_FILE
from garmentimage.system import shown_path

TEST_SPLITS = ("test", "unseen")
"""Splits for test: of seen and of unseen types."""


def check_splits(data: Path, held_out: str = "") -> dict[str, Any]:
    """Check that no garment for test is in the training or validation split.

    Compared are rows, patterns, types of unseen garments, and bodies if the recipe has test bodies.

    Returns:
        Counts of the training garments and of what they share with the test splits: nothing.

    Raises:
        DatasetError: a value is in both.
    """
    from garmentimage.dataset import load_recipe, read_summary

    bodies = ("body",) if load_recipe(read_summary(data)["recipe"]).test_bodies else ()
    columns = ("id", "pattern", "type", *bodies)
    learnt: dict[str, set[str]] = {name: set() for name in columns}
    for split in ("train", "validation"):
        for name, values in _column_values(data, split, columns, held_out).items():
            learnt[name] |= values
    shared: dict[str, int] = {}
    unseen_types = {held_out} if held_out else set()
    for split in TEST_SPLITS:
        for name, values in _column_values(data, split, columns).items():
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
    """All values of some columns in a split; none if there is no such split."""
    from garmentimage.dataset import has_split, read_tables

    found: dict[str, set[str]] = {name: set() for name in columns}
    if not has_split(data, split):
        return found
    for table in read_tables(data, split, list(columns)):
        kept = [name != without for name in table["type"].to_pylist()]
        for name, values in found.items():
            values.update(
                v for v, is_kept in zip(table[name].to_pylist(), kept, strict=True) if is_kept
            )
    return found


def check_training(predictor: Predictor, data_sha256: str, held_out: str) -> None:
    """Refuse a network that was trained on other data, which may contain the garments for test."""
    run = read_run(predictor)
    if not run:
        return  # copied without its run; only its card names its data
    trained, without = run.get("data_sha256"), run.get("without", [])
    if trained != data_sha256:
        raise LearnError(
            f"{shown_path(predictor.folder)}: was not trained on the dataset of this evaluation"
        )
    if held_out and held_out not in without:
        raise LearnError(
            f"{shown_path(predictor.folder)}: was trained on type {quoted(held_out)}, too; train "
            f"it with --without {quoted(held_out)}"
        )


def read_run(predictor: Predictor) -> dict[str, Any]:
    """Metadata of the training run of a network; empty if it was copied without it.

    Raises:
        LearnError: the file is damaged.
    """
    file = Path(predictor.folder).parent / RUN_FILE
    if not file.is_file():
        return {}
    try:
        run = json.loads(file.read_text(encoding="utf-8"))["run"]
        return dict(run)
    except (ValueError, KeyError, TypeError):
        raise LearnError(f"{shown_path(file)}: is damaged") from None


def group_by_held_out(
    predictors: Sequence[Predictor], data: Path, *, validation: bool = False
) -> dict[str, list[Predictor]]:
    """Predictors by the type that their networks were trained without.

    If the dataset has a split `unseen`, the key is "", unless for validation. A network that was
    trained on all types is measured on seen ones.

    Raises:
        LearnError: a network was trained without several types.
    """
    from garmentimage.dataset import has_split

    has_unseen_split = has_split(data, "unseen")
    if has_unseen_split and not (
        validation and any(read_run(each).get("without") for each in predictors)
    ):
        return {"": list(predictors)}
    found: dict[str, list[Predictor]] = {}
    for predictor in predictors:
        without = read_run(predictor).get("without", [])
        if len(without) > 1:
            raise LearnError(
                f"{shown_path(predictor.folder)}: was trained without {len(without)} types; this "
                "dataset takes networks that were trained without one, or on all"
            )
        held_out = without[0] if without else ""
        # Of one network trained without each type in turn, `NAME-TYPE`, the name is `NAME`.
        name = predictor.name.removesuffix(f"-{held_out}") if held_out else predictor.name
        found.setdefault(held_out, []).append(replace(predictor, name=name))
    return found
