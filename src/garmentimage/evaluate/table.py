"""Figures as Markdown tables, with 95 % intervals in brackets."""

from collections.abc import Mapping
from typing import Any

from garmentimage.metrics import markdown_table

IMAGE_COLUMNS = (
    ("panel IoU", "panel_iou"),
    ("exact topology", "topology"),
    ("stitch F1", "stitch_f1_by_length"),
    ("valid", "valid"),
    ("draped", "draped"),
)
TEXT_COLUMNS = (("done", "done"), ("kept", "the rest kept"), ("valid", "valid"))
UPPER_BOUND = "true image"
"""The predictor that is given the true GarmentImage."""


def latent_table(figures: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """Latent spaces: a row for each figure, a column for each network."""
    names = list(figures)
    rows = []
    for stage in figures[names[0]]:
        keys = dict.fromkeys(
            key
            for name in names
            for key, value in figures[name][stage].items()
            if isinstance(value, Mapping)
        )
        rows += [
            [f"{stage}: {key}", *(_cell(figures[name][stage].get(key)) for name in names)]
            for key in keys
        ]
    return markdown_table(["", *names], rows)


def image_table(figures: Mapping[str, Mapping[str, Mapping[str, Any]]]) -> str:
    """Prediction: a row for each predictor, columns for seen and unseen garments."""
    columns = [(name, key, split) for name, key in IMAGE_COLUMNS for split in ("seen", "unseen")]
    return markdown_table(
        ["", *(f"{name}, {split}" for name, _, split in columns)],
        [
            [name, *(_cell(found.get(split, {}).get(key)) for _, key, split in columns)]
            for name, found in figures.items()
        ],
    )


def held_out_table(results: Mapping[str, Mapping[str, Any]]) -> str:
    """Prediction with each type left out in turn: a row for each type, columns for predictors.

    Args:
        results: by type that was left out, figures as `image_table` takes them.
    """
    names = list(dict.fromkeys(name for figures in results.values() for name in figures))
    names = [name for name in names if name == UPPER_BOUND or not ("," in name or "true " in name)]
    titles = {key: name for name, key in IMAGE_COLUMNS}
    columns = [
        (name, key, split)
        for name in names
        for key, split in (("panel_iou", "seen"), ("panel_iou", "unseen"), ("topology", "unseen"))
    ]
    return markdown_table(
        ["left out", *(f"{name}: {titles[key]}, {split}" for name, key, split in columns)],
        [
            [
                held_out,
                *(
                    _cell(figures.get(name, {}).get(split, {}).get(key))
                    for name, key, split in columns
                ),
            ]
            for held_out, figures in results.items()
        ],
    )


def text_edits_table(figures: Mapping[str, Mapping[str, Any]]) -> str:
    """Editing by text: rows for groups of prompts and prompts, columns for methods."""
    columns = [(name, key, title) for name in figures for key, title in TEXT_COLUMNS]
    first = next(iter(figures.values()))
    rows = [key for key, value in first.items() if isinstance(value, Mapping)]
    return markdown_table(
        ["", *(f"{name}: {title}" for name, _, title in columns)],
        [
            [row, *(_cell(figures[n].get(row, {}).get(key)) for n, key, _ in columns)]
            for row in rows
        ],
    )


def _cell(value: Mapping[str, float] | None) -> str:
    if value is None:
        return "-"
    if "mean" not in value:
        return ", ".join(f"{name} {count}" for name, count in value.items())
    return f"{value['mean']:.3f} ({value['low']:.3f} to {value['high']:.3f})"
