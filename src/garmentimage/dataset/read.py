"""Reading built datasets: shards of a split, rows by number, rasters as arrays."""

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from jaxtyping import Float32

from garmentimage.dataset.building import DATA
from garmentimage.dataset.recipe import SPLITS
from garmentimage.dataset.shard import ShardMetadata, parse_metadata
from garmentimage.errors import DatasetError, quoted
from garmentimage.pattern import Pattern
from garmentimage.pattern.files import pattern_from_spec
from garmentimage.system import shown_path

Read = TypeVar("Read")


def shard_files(folder: str | Path, split: str | None = None) -> list[Path]:
    """The shards of a split, or of all, in order.

    Raises:
        DatasetError: there are none, or some are missing.
    """
    if split is not None and split not in SPLITS:
        raise DatasetError(f"there is no split {quoted(split)}; choose {', '.join(SPLITS)}")
    files = []
    for name in (split,) if split else SPLITS:
        found = sorted((Path(folder) / DATA).glob(f"{name}-*.parquet"))
        wanted = [f"{name}-{k:05d}-of-{len(found):05d}.parquet" for k in range(len(found))]
        if [file.name for file in found] != wanted:
            raise DatasetError(
                f"{shown_path(folder)}: its split {quoted(name)} is incomplete, or has files of "
                "another dataset; resume the build with the command that started it"
            )
        files += found
    if not files:
        what = f"split {quoted(split)}" if split else "shards"
        raise DatasetError(f"{shown_path(folder)}: has no {what}; `garmentimage build` makes one")
    return files


def has_split(folder: str | Path, split: str) -> bool:
    """Whether a dataset has a split; recipes without unseen types have no split `unseen`.

    Raises:
        DatasetError: there is no dataset, or a shard is missing.
    """
    return any(file.name.startswith(f"{split}-") for file in shard_files(folder))


def read_tables(
    folder: str | Path, split: str | None, columns: Sequence[str] | None = None
) -> Iterator[pa.Table]:
    """Rows of a split, one shard at a time.

    Raises:
        DatasetError: there are none, a column does not exist, or a shard is damaged.
    """
    for file in shard_files(folder, split):
        yield _read(file, lambda shard: shard.read(columns), columns)


def read_rows(folder: str | Path, split: str | None, *columns: str) -> Iterator[tuple[Any, ...]]:
    """Values of some columns, row by row.

    Raises:
        DatasetError: there are none, a column does not exist, or a shard is damaged.
    """
    for table in read_tables(folder, split, columns):
        yield from zip(*(table[name].to_pylist() for name in columns), strict=True)


def rows_at(folder: str | Path, numbers: Sequence[int]) -> list[dict[str, Any]]:
    """Rows by their number over all shards; only the shards that hold them are read."""
    wanted, rows, first = sorted(set(numbers)), [], 0
    for file in shard_files(folder):
        last = first + read_header(file).rows
        here = [number - first for number in wanted if first <= number < last]
        if here:
            rows += _read(file, lambda shard: shard.read()).take(pa.array(here)).to_pylist()
        first = last
    if len(rows) < len(wanted):
        raise DatasetError(f"{shown_path(folder)}: has {first} rows")
    return rows


class ShardHeader(NamedTuple):
    """What a shard holds, without its rows."""

    metadata: ShardMetadata
    columns: tuple[str, ...]
    rows: int
    row_groups: int
    """They are read one at a time."""


def read_header(file: Path) -> ShardHeader:
    """The header of a shard."""
    return _read(
        file,
        lambda shard: ShardHeader(
            parse_metadata(shard.schema_arrow),
            tuple(shard.schema_arrow.names),
            shard.metadata.num_rows,
            shard.num_row_groups,
        ),
    )


def shard_metadata(file: Path) -> ShardMetadata:
    """The metadata of a shard.

    Raises:
        DatasetError: it is damaged, or not a shard of garmentimage.
    """
    return read_header(file).metadata


def row_group(file: Path, number: int, columns: Sequence[str]) -> pa.Table:
    """One group of rows."""
    return _read(file, lambda shard: shard.read_row_group(number, list(columns)))


def raster_arrays(column: pa.ChunkedArray) -> list[Float32[np.ndarray, "_ channel _ _"]]:
    """The rasters of some rows, without a Python object for every number.

    They have 26 channels a layer; those of datasets of earlier releases have 17.

    Raises:
        DatasetError: a row has none, or not all have the same grid.
    """
    lists = column.combine_chunks()
    if not len(lists):
        return []
    if lists.null_count:
        raise DatasetError("a row has no raster; build the dataset again")
    layers = lists.value_lengths().to_numpy(zero_copy_only=False)
    numbers, sizes = lists, []
    for _ in range(3):
        numbers = numbers.flatten()
        sizes.append(np.unique(numbers.value_lengths().to_numpy(zero_copy_only=False)))
    if any(len(size) != 1 for size in sizes):
        raise DatasetError("rasters of a dataset have different grids; build it again")
    channels, rows, cols = (int(size[0]) for size in sizes)
    values = numbers.flatten().to_numpy(zero_copy_only=False)
    parts = np.split(values, np.cumsum(layers)[:-1] * channels * rows * cols)
    return [part.reshape(-1, channels, rows, cols) for part in parts]


def parse_patterns(texts: Sequence[str], folder: str | Path) -> list[Pattern]:
    """Patterns from the JSON of rows.

    Args:
        texts: of column `pattern`.
        folder: of the dataset, for messages.

    Raises:
        DatasetError: one is damaged.
    """
    try:
        return [pattern_from_spec(json.loads(text)) for text in texts]
    except (TypeError, ValueError) as error:
        raise DatasetError(
            f"{shown_path(folder)}: a pattern is damaged ({error}); build it again"
        ) from None


def _read(file: Path, part: Callable[[Any], Read], columns: Sequence[str] | None = None) -> Read:
    """A part of a shard, with errors that name the file."""
    try:
        with pq.ParquetFile(file, page_checksum_verification=True) as shard:
            parse_metadata(shard.schema_arrow)
            for name in columns or ():
                if name not in shard.schema_arrow.names:
                    raise DatasetError(f"has no column {quoted(name)}")
            return part(shard)
    except DatasetError as error:
        raise DatasetError(f"{shown_path(file)}: {error}") from None
    except (pa.ArrowException, OSError) as error:
        reason = getattr(error, "strerror", None) or "it is damaged"
        raise DatasetError(
            f"{shown_path(file)}: cannot be read ({reason}); remove it and build again"
        ) from None
