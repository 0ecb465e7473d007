"""Figures as tables of Markdown."""

from collections.abc import Mapping
from typing import Any


def latent_table(figures: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """One row for each figure, one column for each network; intervals of 95 % in brackets."""
    names = list(figures)
    lines = [f"| | {' | '.join(names)} |", "|---" * (len(names) + 1) + "|"]
    for stage in figures[names[0]]:
        keys = dict.fromkeys(
            key
            for name in names
            for key, value in figures[name][stage].items()
            if isinstance(value, Mapping)
        )
        for key in keys:
            cells = [_cell(figures[name][stage].get(key)) for name in names]
            lines.append(f"| {stage}: {key} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


IMAGE_COLUMNS = (
    ("panel IoU", "panel_iou"),
    ("exact topology", "topology"),
    ("stitch F1", "stitch_f1_by_length"),
    ("valid", "valid"),
    ("draped", "draped"),
)


def image_table(figures: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """Picture to pattern: one row for each guesser, columns for garments seen and unseen."""
    splits = ("seen", "unseen")
    heads = [f"{name}, {split}" for name, _ in IMAGE_COLUMNS for split in splits]
    lines = [f"| | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    for name, found in figures.items():
        cells = [
            _cell(found.get(split, {}).get(key)) for _, key in IMAGE_COLUMNS for split in splits
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


CEILING = "true image"
"""Who guesses the truth as far as a GarmentImage can hold it."""


def held_out_table(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Picture to pattern with each type left out in turn: a row for each, columns for who guesses.

    Args:
        results: figures by guesser, as `image_table` takes them, by type left out.
    """
    names = list(dict.fromkeys(name for figures in results.values() for name in figures))
    names = [name for name in names if name == CEILING or not ("," in name or "true " in name)]
    columns = (("panel_iou", "seen"), ("panel_iou", "unseen"), ("topology", "unseen"))
    called = dict((key, name) for name, key in IMAGE_COLUMNS)
    heads = [f"{name}: {called[key]}, {split}" for name in names for key, split in columns]
    lines = [f"| left out | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    for held_out, figures in results.items():
        cells = [
            _cell(figures.get(name, {}).get(split, {}).get(key))
            for name in names
            for key, split in columns
        ]
        lines.append(f"| {held_out} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


TEXT_COLUMNS = (("done", "done"), ("kept", "the rest kept"), ("valid", "valid"))


def text_table(figures: Mapping[str, Mapping[str, Any]]) -> str:
    """Editing by text: rows for groups of prompts and each prompt, columns for who edits."""
    names = list(figures)
    heads = [f"{name}: {what}" for name in names for _, what in TEXT_COLUMNS]
    lines = [f"| | {' | '.join(heads)} |", "|---" * (len(heads) + 1) + "|"]
    rows = [key for key, value in figures[names[0]].items() if isinstance(value, Mapping)]
    for row in rows:
        cells = [_cell(figures[name].get(row, {}).get(key)) for name in names
                 for key, _ in TEXT_COLUMNS]  # fmt: skip
        lines.append(f"| {row} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _cell(value: Mapping[str, float] | None) -> str:
    if value is None:
        return "-"
    if "mean" not in value:
        return ", ".join(f"{name} {count}" for name, count in value.items())
    return f"{value['mean']:.3f} ({value['low']:.3f} to {value['high']:.3f})"
