"""The card of a dataset: its contents and provenance, in the format of Hugging Face."""

from typing import Any

from garmentimage.dataset.recipe import Recipe
from garmentimage.system import source_commit, versions

COLUMNS = {
    "id": "name of the row",
    "recipe, version, seed, index": "what it was made from",
    "type, kind, parameters": "the kind of garment and, as JSON, its design parameters, those that "
    "do nothing, too",
    "split": "train, validation, test, or unseen: types that are in no other split",
    "body, fabric": "who wears it, and what it is made of",
    "pattern": "the sewing pattern, as specification JSON",
    "raster": "the GarmentImage, float32: layers (front, back) x 26 channels x N x N, row 0 at the "
    "bottom; channels: inside, turned, types of the bottom edge (8), of the left edge (8), "
    "(dx, dy) of the bottom, right, top and left edge [cm]",
    "captions": "what it is in words, from its parameters, the longest first",
}
PANELS = (
    "which panel is where in the first picture: 0 nothing, 1 body, 2 the first panel of `pattern`, "
    "3 the second, and so on"
)


def dataset_card(recipe: Recipe, summary: dict[str, Any], command: str) -> str:
    """The README.md of a dataset, with the metadata for `datasets`."""
    splits = "".join(
        f"  - split: {split}\n    path: data/{split}-*.parquet\n" for split in summary["splits"]
    )
    columns = dict(COLUMNS)
    for view in recipe.views:
        columns[f"picture_{view}"] = f"the garment on the body, {recipe.picture} pixels, RGB"
    if recipe.views:
        columns |= {"panels": PANELS, "report": "how the drape went, as JSON"}
    commit = source_commit()
    rows = "\n".join(f"| {name} | {words} |" for name, words in columns.items())
    types = "\n".join(
        f"| {t.name} | {t.kind} | {'' if t.seen else 'unseen'} |" for t in recipe.types
    )
    failed = "".join(f"| {cause} | {n} |\n" for cause, n in summary["failed"].items())
    if failed:
        failed = f"| drawn, but no row because of | rows |\n|---|---|\n{failed}"
    return f"""---
pretty_name: {recipe.name} garments
tags: [sewing patterns, garments]
configs:
- config_name: default
  data_files:
{splits}---

# {recipe.name}

{recipe.doc}

{summary["rows"]:,} rows of {summary["rows"] + sum(summary["failed"].values()):,} drawn: \
{", ".join(f"{n:,} {split}" for split, n in summary["splits"].items())}.

| column | what it holds |
|---|---|
{rows}

```python
import datasets
rows = datasets.load_dataset("FOLDER")["train"].with_format("numpy")
```

| type | kind | |
|---|---|---|
{types}

{failed}
Made by `{command or "garmentimage.dataset.build_dataset"}`, recipe version {recipe.version}, seed \
{summary["seed"]}, N = {summary["grid"]}, with \
{", ".join([*versions("pyarrow"), *([f"commit {commit}"] if commit else [])])}.
The same command makes the same rows again; `summary.json` has the sha256 of every shard.
"""
