"""Building: a dataset made shard by shard, on this machine or on a cluster, resumed where it ended.

Words of this file:

- A **plan** says which rows go into which shard, all of them known before any is made.
- A **shard** is made whole by one worker, sent to the driver as bytes, and written there under its
  final name in one step. So whatever is killed, there are only whole shards, and what is missing
  is made again: the same rows, as a row depends on nothing but its task.
"""

import hashlib
import json
import logging
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from garmentimage.dataset.card import card
from garmentimage.dataset.recipe import PERIOD, SPLITS, Recipe
from garmentimage.dataset.row import SCHEMA, Failed, Task, make_row
from garmentimage.dataset.shard import failures_of, row_count, shard_bytes
from garmentimage.errors import DatasetError
from garmentimage.files import shown_path, write_atomically

SHARD_ROWS = 100
PLAN_FILE, SUMMARY_FILE, CARD_FILE = "build.json", "summary.json", "README.md"
DATA = "data"
"""Folder of the shards."""
MOST_ROWS = 10_000_000
WAITING = 2
"""Shards that each worker has before it, at most."""


@dataclass(frozen=True)
class Build:
    """What is built, and where."""

    recipe: Recipe
    folder: Path
    count: int
    """Rows of each type."""
    seed: int = 0
    grid: int = 16

    def identity(self) -> dict[str, Any]:
        """What tells one dataset from another."""
        return {
            "recipe": self.recipe.name,
            "version": self.recipe.version,
            "schema": SCHEMA,
            "count": self.count,
            "seed": self.seed,
            "grid": self.grid,
            "shard_rows": SHARD_ROWS,
        }


@dataclass(frozen=True)
class Shard:
    """Some rows of one split, told by where they stand in it."""

    name: str
    build: Build
    split: str
    places: range

    @property
    def tasks(self) -> list[Task]:
        """Its rows; types take turns."""
        what, block = self.build, _block(self.build.recipe, self.split)
        turns = ((place // len(block), block[place % len(block)]) for place in self.places)
        return [
            Task(what.recipe, what.seed, what.grid, number, turn * PERIOD + index)
            for turn, (index, number) in turns
        ]


@dataclass(frozen=True)
class Done:
    """A shard that is written."""

    name: str
    rows: int
    failed: tuple[Failed, ...]
    sha256: str


def plan(build: Build) -> tuple[Shard, ...]:
    """All shards of a dataset, split by split; types take turns within a split.

    Raises:
        DatasetError: a number that will not do.
    """
    types = build.recipe.types
    if not 1 <= build.count <= MOST_ROWS // len(types):
        raise DatasetError(
            f"{build.count} rows a type; give 1 to {MOST_ROWS // len(types)} with this recipe"
        )
    shards = []
    for split in SPLITS:
        block = _block(build.recipe, split)
        whole, rest = divmod(build.count, PERIOD)
        rows = whole * len(block) + sum(index < rest for index, _ in block)
        parts = [range(k, min(k + SHARD_ROWS, rows)) for k in range(0, rows, SHARD_ROWS)]
        shards += [
            Shard(f"{split}-{k:05d}-of-{len(parts):05d}.parquet", build, split, places)
            for k, places in enumerate(parts)
        ]
    return tuple(shards)


def _block(recipe: Recipe, split: str) -> list[tuple[int, int]]:
    """Numbers and types of the rows of a split, among the first `PERIOD` of every type."""
    return [
        (index, number)
        for index in range(PERIOD)
        for number, each in enumerate(recipe.types)
        if recipe.split(each, index) == split
    ]


def make_shard(shard: Shard) -> bytes:
    """All rows of a shard, as its file."""
    made = [make_row(task) for task in shard.tasks]
    rows = [row for row in made if not isinstance(row, Failed)]
    failed = [row for row in made if isinstance(row, Failed)]
    return shard_bytes(shard.build.recipe, shard.build.grid, rows, failed)


def build(
    what: Build,
    *,
    scheduler: str | None = None,
    workers: int = 2,
    progress: Callable[[Done, bool], None] = lambda done, fresh: None,
    command: str = "",
) -> dict[str, Any]:
    """Make what is missing of a dataset, and sum it up.

    Args:
        what: the dataset.
        scheduler: address of a running Dask scheduler; none for processes on this machine.
        workers: processes on this machine.
        progress: called with every shard, and whether it was made now.
        command: how it was called, for the dataset card.

    Returns:
        The summary that is also written to `summary.json`.

    Raises:
        DatasetError: the folder holds another dataset, or a scheduler that does not answer.
        OutputError: a file that cannot be written; what was finished stays.
    """
    shards = plan(what)
    data = _prepared(what)
    done = {s.name: _read(data / s.name) for s in shards if (data / s.name).is_file()}
    for each in done.values():
        progress(each, False)
    missing = [shard for shard in shards if shard.name not in done]
    for shard, raw in _made(missing, scheduler, workers) if missing else ():
        write_atomically(data / shard.name, raw)
        done[shard.name] = _told(shard.name, raw)
        progress(done[shard.name], True)
    summary = _summary(what, [done[shard.name] for shard in shards])
    write_atomically(what.folder / SUMMARY_FILE, _text(summary))
    write_atomically(what.folder / CARD_FILE, card(what.recipe, summary, command))
    return summary


def _prepared(what: Build) -> Path:
    """The folder of the shards, made where it is not there."""
    file, wanted = what.folder / PLAN_FILE, what.identity()
    try:
        (what.folder / DATA).mkdir(parents=True, exist_ok=True)
        text = file.read_text(encoding="utf-8") if file.exists() else None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise DatasetError(
            f"{shown_path(what.folder)}: cannot be used ({reason}); choose another folder"
        ) from None
    if text is None:
        write_atomically(file, _text(wanted))
        return what.folder / DATA
    try:
        found = dict(json.loads(text))
    except (ValueError, TypeError):
        raise DatasetError(f"{shown_path(file)}: is damaged; choose another folder") from None
    for key, value in wanted.items():
        if found.get(key) != value:
            raise DatasetError(
                f"{shown_path(what.folder)}: holds a dataset of {key} {found.get(key)}, not "
                f"{value}; choose another folder"
            )
    return what.folder / DATA


def _read(path: Path) -> Done:
    try:
        return _told(path.name, path.read_bytes())
    except DatasetError as error:
        raise DatasetError(f"{shown_path(path)}: {error}") from None


def _told(name: str, raw: bytes) -> Done:
    failed = tuple(failures_of(raw))
    return Done(name, row_count(raw), failed, hashlib.sha256(raw).hexdigest())


def _made(
    shards: list[Shard], scheduler: str | None, workers: int
) -> Iterator[tuple[Shard, bytes]]:
    """Shards with their bytes, as they come; only a few wait at any time."""
    from distributed import as_completed

    with _client(scheduler, min(workers, len(shards))) as client:
        waiting = iter(shards)
        most = WAITING * max(len(client.scheduler_info()["workers"]), 1)
        of_future = {}
        running = as_completed()
        for shard in islice(waiting, most):
            future = client.submit(make_shard, shard, pure=False)
            of_future[future.key] = shard
            running.add(future)
        for future in running:
            raw = future.result()
            yield of_future.pop(future.key), raw
            future.release()
            following = next(waiting, None)
            if following is not None:
                future = client.submit(make_shard, following, pure=False)
                of_future[future.key] = following
                running.add(future)


def _client(scheduler: str | None, workers: int) -> Any:
    from distributed import Client, LocalCluster

    if scheduler is None:
        with _deaf_children():
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                memory_limit=0,
                dashboard_address="127.0.0.1:0",
                host="127.0.0.1",
                silence_logs=logging.CRITICAL,
            )
        return _Both(Client(cluster), cluster)
    try:
        return Client(scheduler, timeout="20s")
    except (OSError, ValueError, TypeError) as error:
        raise DatasetError(
            f"the scheduler {scheduler} does not answer ({type(error).__name__}); start one with "
            "`dask scheduler`, and workers with `dask worker`"
        ) from None


@contextmanager
def _deaf_children() -> Iterator[None]:
    """Processes started inside do not hear Ctrl-C: the driver stops them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class _Both:
    """A client that closes its cluster, too."""

    def __init__(self, client: Any, cluster: Any) -> None:
        self.client, self.cluster = client, cluster

    def __enter__(self) -> Any:
        return self.client

    def __exit__(self, *_: object) -> None:
        self.client.close()
        self.cluster.close()


def _summary(what: Build, done: list[Done]) -> dict[str, Any]:
    rows = Counter({split: 0 for split in SPLITS})
    for each in done:
        rows[each.name.split("-")[0]] += each.rows
    failed = [row for each in done for row in each.failed]
    asked = what.count * len(what.recipe.types)
    return {
        **what.identity(),
        "rows": sum(rows.values()),
        "share": round(sum(rows.values()) / asked, 4),
        "splits": {split: n for split, n in rows.items() if n},
        "failed": dict(
            Counter(f"{row.stage}: {_cause(row.reason)}" for row in failed).most_common()
        ),
        "shards": {each.name: {"rows": each.rows, "sha256": each.sha256} for each in done},
    }


def _cause(reason: str) -> str:
    """A reason without its figures, for counting."""
    words = reason.split(";")[0].split(":")[0].split("(")[0].split()
    return " ".join(word for word in words if not any(c.isdigit() for c in word))


def _text(data: dict[str, Any]) -> str:
    return json.dumps(data, indent=1) + "\n"
