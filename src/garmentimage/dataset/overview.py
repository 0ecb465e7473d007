"""An overview of a dataset: its summary, its hash, and rows as a contact sheet."""

import hashlib
import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from garmentimage.dataset.building import SUMMARY_FILE
from garmentimage.dataset.read import read_header, rows_at, shard_files
from garmentimage.errors import DatasetError
from garmentimage.pattern.files import pattern_from_spec
from garmentimage.raster import GarmentImage
from garmentimage.render import compose, contact_sheet, picture_bytes
from garmentimage.system import shown_path

TILE = 256
"""Rows of a tile [pixel]."""


def read_summary(folder: Path) -> dict[str, Any]:
    """The summary of a built dataset.

    Raises:
        DatasetError: there is no finished dataset, or it is damaged.
    """
    file = folder / SUMMARY_FILE
    try:
        summary: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        if not _is_summary(summary):
            raise ValueError
    except FileNotFoundError:
        raise DatasetError(
            f"{shown_path(folder)}: holds no finished dataset; `garmentimage build` makes one"
        ) from None
    except OSError as error:
        raise DatasetError(
            f"{shown_path(file)}: cannot be read ({error.strerror}); name a folder that "
            "`garmentimage build` made"
        ) from None
    except (ValueError, RecursionError, KeyError, TypeError, AttributeError):
        raise DatasetError(
            f"{shown_path(file)}: is damaged; remove it and build the dataset again"
        ) from None
    if sum(read_header(shard).rows for shard in shard_files(folder)) != summary["rows"]:
        raise DatasetError(
            f"{shown_path(folder)}: its shards do not have the {summary['rows']} rows of its "
            "summary; build it again"
        )
    return summary


def dataset_hash(folder: Path) -> str:
    """SHA-256 of a built dataset: over the names and hashes of its shards.

    Raises:
        DatasetError: there is no finished dataset, or it is damaged.
    """
    shards = read_summary(folder).get("shards", {})
    text = "".join(f"{name} {shard['sha256']}\n" for name, shard in sorted(shards.items()))
    return hashlib.sha256(text.encode()).hexdigest()


def _is_summary(data: Any) -> bool:
    """Whether data has the layout that `build_dataset` writes, in the parts used."""
    return (
        type(data["rows"]) is type(data["seed"]) is int
        and isinstance(data["recipe"], str)
        and all(isinstance(shard["sha256"], str) for shard in data.get("shards", {}).values())
        and all(
            name.isprintable() and type(n) is int and n >= 0
            for counts in (data["splits"], data["failed"])
            for name, n in counts.items()
        )
    )


def row_sheet(folder: Path, count: int) -> UInt8[np.ndarray, "row col 3"]:
    """Some rows, evenly spread over all shards: pattern and raster, and pictures beside them.

    Raises:
        DatasetError: there are no rows, or a shard is damaged.
    """
    total = sum(read_header(file).rows for file in shard_files(folder))
    if not total:
        raise DatasetError(f"{shown_path(folder)}: has no rows")
    rows = rows_at(folder, np.linspace(0, total - 1, count).astype(int).tolist())
    return contact_sheet([_tile(row) for row in rows], [row["id"] for row in rows], columns=3)


def _tile(row: dict[str, Any]) -> UInt8[np.ndarray, "row col 3"]:
    from PIL import Image

    raster = np.array(row["raster"], np.float32)
    image = GarmentImage.from_channels(raster.reshape(-1, *raster.shape[2:]))
    figure = compose([pattern_from_spec(json.loads(row["pattern"])), image])
    files = [picture_bytes(figure, "png", dpi=60)]
    files += [cell["bytes"] for name, cell in row.items() if name.startswith("picture_")]
    pictures = [Image.open(BytesIO(file)).convert("RGB") for file in files]
    scaled = [p.resize((max(round(p.width * TILE / p.height), 1), TILE)) for p in pictures]
    return np.concatenate([np.asarray(p) for p in scaled], axis=1)
