"""Building a dataset shard by shard, on this machine or on a cluster; interrupted builds resume.

Terms:

- A **plan** assigns every row to a shard before any row is made.
- A **shard** is made by one worker, sent to the driver as bytes, and written there under its final
  name in one step. So a killed build leaves only complete shards, and the missing ones are made by
  the next call: with the same rows, since a row depends on nothing but its task.
"""

import hashlib
import json
import os
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from garmentimage.dataset.card import dataset_card
from garmentimage.dataset.engine import check_scheduler, run_tasks
from garmentimage.dataset.recipe import MAX_ROWS, PERIOD, SPLITS, Recipe
from garmentimage.dataset.row import SCHEMA, FailedRow, RowTask, make_row
from garmentimage.dataset.shard import parse_metadata, schema, shard_bytes
from garmentimage.errors import DatasetError, quoted
from garmentimage.raster.encode import GRIDS
from garmentimage.system import shown_path, write_atomically

SHARD_ROWS = 100
PLAN_FILE, SUMMARY_FILE, CARD_FILE = "build.json", "summary.json", "README.md"
UNSEEN = "unseen"
DATA = "data"
"""Folder of the shards."""
REMEDY = "remove it and build again"


@dataclass(frozen=True)
class BuildSettings:
    """Which dataset to build, and where."""

    recipe: Recipe
    folder: Path
    count: int
    """Rows of each type."""
    seed: int = 0
    grid: int = 16
    unseen: int | None = None
    """Rows of each unseen type; None: `count`."""

    def rows_of(self, split: str) -> int:
        """Rows of each type of a split, over all its splits."""
        return self.unseen if split == "unseen" and self.unseen is not None else self.count

    def identity(self) -> dict[str, Any]:
        """The settings that determine its rows, for the plan file."""
        return {
            "recipe": self.recipe.name,
            "version": self.recipe.version,
            "schema": SCHEMA,
            "count": self.count,
            "seed": self.seed,
            "grid": self.grid,
            "shard_rows": SHARD_ROWS,
            **({} if self.unseen is None else {UNSEEN: self.unseen}),
        }


@dataclass(frozen=True)
class Shard:
    """Some rows of one split, by their positions in it."""

    name: str
    build: BuildSettings
    split: str
    places: range

    def identity(self) -> dict[str, Any]:
        """The settings that determine its rows."""
        build = self.build.identity()
        own = {key: build[key] for key in ("recipe", "version", "schema", "seed", "grid")}
        return own | {"split": self.split, "places": [self.places.start, self.places.stop]}

    @property
    def tasks(self) -> list[RowTask]:
        """Tasks of its rows; types take turns."""
        what, block = self.build, _block(self.build.recipe, self.split)
        turns = ((place // len(block), block[place % len(block)]) for place in self.places)
        return [
            RowTask(what.recipe, what.seed, what.grid, number, turn * PERIOD + index)
            for turn, (index, number) in turns
        ]


@dataclass(frozen=True)
class FinishedShard:
    """A written shard."""

    name: str
    rows: int
    failed: tuple[FailedRow, ...]
    sha256: str


def plan_shards(build: BuildSettings) -> tuple[Shard, ...]:
    """All shards of a dataset, split by split; types take turns within a split.

    Raises:
        DatasetError: the grid or a number of rows is out of range.
    """
    low, high = GRIDS
    if not low <= build.grid <= high or build.grid % 2:
        raise DatasetError(f"grid is {build.grid}; give an even number from {low} to {high}")
    types = build.recipe.types
    for count in (build.count, build.rows_of("unseen")):
        if not 1 <= count <= MAX_ROWS // len(types):
            raise DatasetError(
                f"{count} rows a type; give 1 to {MAX_ROWS // len(types)} with this recipe"
            )
    shards = []
    for split in SPLITS:
        block = _block(build.recipe, split)
        whole, rest = divmod(build.rows_of(split), PERIOD)
        rows = whole * len(block) + sum(index < rest for index, _ in block)
        parts = [range(k, min(k + SHARD_ROWS, rows)) for k in range(0, rows, SHARD_ROWS)]
        shards += [
            Shard(f"{split}-{k:05d}-of-{len(parts):05d}.parquet", build, split, places)
            for k, places in enumerate(parts)
        ]
    return tuple(shards)


def _block(recipe: Recipe, split: str) -> list[tuple[int, int]]:
    """(index, type number) of the rows of a split, among the first `PERIOD` of every type."""
    return [
        (index, number)
        for index in range(PERIOD)
        for number, each in enumerate(recipe.types)
        if recipe.split(each, index) == split
    ]


def make_shard(shard: Shard) -> bytes:
    """Make all rows of a shard; returns its file."""
    made = [make_row(task) for task in shard.tasks]
    rows = [row for row in made if not isinstance(row, FailedRow)]
    failed = [row for row in made if isinstance(row, FailedRow)]
    return shard_bytes(shard.build.recipe, shard.build.grid, rows, failed, shard.identity())


def build_dataset(
    what: BuildSettings,
    *,
    scheduler: str | None = None,
    workers: int = 2,
    progress: Callable[[FinishedShard, bool], None] = lambda *_: None,
    command: str = "",
) -> dict[str, Any]:
    """Make the missing shards of a dataset, and write its summary and card.

    Args:
        what: the dataset.
        scheduler: address of a running Dask scheduler; None for processes on this machine.
        workers: processes on this machine.
        progress: called with every shard, and whether it was made by this call.
        command: the command line, for the dataset card.

    Returns:
        The summary that is also written to `summary.json`.

    Raises:
        DatasetError: the folder holds another dataset, the scheduler does not answer, a number is
            out of range, or no row can be made with these settings.
        OutputError: a file cannot be written; finished shards are kept.
    """
    shards = plan_shards(what)
    if scheduler is not None:
        check_scheduler(scheduler)
    data = _prepare_folder(what)
    _check_names(data, {shard.name for shard in shards})
    done: dict[str, FinishedShard] = {}
    for shard in shards:
        if os.path.lexists(data / shard.name):
            done[shard.name] = _verified(data / shard.name, shard)
            progress(done[shard.name], False)
    missing = [shard for shard in shards if shard.name not in done]
    for shard, raw in run_tasks(make_shard, missing, scheduler, workers) if missing else ():
        write_atomically(data / shard.name, raw)
        done[shard.name] = _finished(shard, raw)
        progress(done[shard.name], True)
    summary = _summary(what, [done[shard.name] for shard in shards])
    if not summary["rows"]:
        cause, number = next(iter(summary["failed"].items()))
        raise DatasetError(
            f"{shown_path(what.folder)}: no row could be made; {number} failed because of {cause}; "
            "build it with other settings in another folder"
        )
    card = dataset_card(what.recipe, summary, command)
    for name, text in ((SUMMARY_FILE, _json_text(summary)), (CARD_FILE, card)):
        if missing or not (what.folder / name).exists():
            write_atomically(what.folder / name, text)
    return summary


def _prepare_folder(what: BuildSettings) -> Path:
    """The folder of the shards, created if needed."""
    folder, wanted = what.folder, what.identity()
    file, data = folder / PLAN_FILE, folder / DATA
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.path.lexists(file):
            _check_plan(file, wanted)
        elif any(not path.name.startswith(".") for path in folder.iterdir()):
            raise DatasetError(
                f"{shown_path(folder)}: holds files but no dataset; choose another folder"
            )
        else:
            write_atomically(file, _json_text(wanted))
        data.mkdir(exist_ok=True)
    except (OSError, ValueError) as error:
        if isinstance(error, DatasetError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise DatasetError(
            f"{shown_path(folder)}: cannot be used ({reason}); choose another folder"
        ) from None
    return data


def _check_plan(file: Path, wanted: dict[str, Any]) -> None:
    """Refuse a folder with another dataset."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(found, dict) or not found.keys() >= wanted.keys():
            raise ValueError
    except (ValueError, RecursionError):
        raise DatasetError(f"{shown_path(file)}: is damaged; choose another folder") from None
    for key in (*wanted, UNSEEN):
        value = wanted.get(key)
        if repr(found.get(key)) != repr(value):
            raise DatasetError(
                f"{shown_path(file.parent)}: holds a dataset of {key} "
                f"{quoted(str(found.get(key)))}, not {value!r}; choose another folder"
            )


def _check_names(data: Path, planned: set[str]) -> None:
    """Refuse files beside the shards: readers would read them, too."""
    for path in data.iterdir():
        if path.name not in planned and not path.name.startswith("."):
            raise DatasetError(f"{shown_path(path)}: not a shard of this dataset; remove it")


def _verified(path: Path, shard: Shard) -> FinishedShard:
    """An existing shard, read completely."""
    if path.is_symlink() or not path.is_file():
        raise DatasetError(f"{shown_path(path)}: not a regular file; {REMEDY}")
    try:
        raw = path.read_bytes()
        table = pq.read_table(BytesIO(raw), page_checksum_verification=True)
        done = _finished(shard, raw)
    except DatasetError as error:
        raise DatasetError(f"{shown_path(path)}: {error}") from None
    except (pa.ArrowException, OSError) as error:
        reason = getattr(error, "strerror", None) or "it is damaged"
        raise DatasetError(f"{shown_path(path)}: cannot be read ({reason}); {REMEDY}") from None
    if not table.schema.equals(schema(shard.build.recipe, shard.build.grid)):
        raise DatasetError(f"{shown_path(path)}: has other columns than planned; {REMEDY}")
    return done


def _finished(shard: Shard, raw: bytes) -> FinishedShard:
    file = pq.ParquetFile(BytesIO(raw))
    metadata, rows = parse_metadata(file.schema_arrow), file.metadata.num_rows
    if metadata.identity != shard.identity() or rows + len(metadata.failed) != len(shard.places):
        raise DatasetError(f"has other rows than planned; {REMEDY}")
    return FinishedShard(shard.name, rows, metadata.failed, hashlib.sha256(raw).hexdigest())


def _summary(what: BuildSettings, done: list[FinishedShard]) -> dict[str, Any]:
    rows = Counter({split: 0 for split in SPLITS})
    for each in done:
        rows[each.name.split("-")[0]] += each.rows
    failed = Counter(f"{r.stage}: {_cause(r.reason)}" for each in done for r in each.failed)
    planned = sum(len(shard.places) for shard in plan_shards(what))
    return {
        **what.identity(),
        "rows": sum(rows.values()),
        "share": round(sum(rows.values()) / planned, 4),
        "splits": {split: n for split, n in rows.items() if n},
        "failed": dict(failed.most_common()),
        "shards": {each.name: {"rows": each.rows, "sha256": each.sha256} for each in done},
    }


def _cause(reason: str) -> str:
    """A reason without its numbers, for counting."""
    words = reason.split(";")[0].split(":")[0].split("(")[0].split()
    return " ".join(word for word in words if not any(c.isdigit() for c in word))


def _json_text(data: dict[str, Any]) -> str:
    return json.dumps(data, indent=1) + "\n"
