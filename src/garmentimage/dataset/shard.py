"""Shards: rows as Parquet files, readable by Hugging Face `datasets`, pandas and others.

The schema has the features of `datasets`, so that it decodes pictures and rasters; the key
`garmentimage` of its metadata holds the settings of the build, the types of the recipe, and the
rows that failed. Pages have checksums.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from io import BytesIO
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from garmentimage.dataset.recipe import Recipe
from garmentimage.dataset.row import SCHEMA, FailedRow
from garmentimage.errors import DatasetError
from garmentimage.raster import CONTRACT_2

METADATA_KEY = b"garmentimage"
READ_SCHEMAS = (2, SCHEMA)
ROW_GROUP = 50
"""Rows of a row group, which is read at a time."""
_TEXTS = (
    "id", "recipe", "type", "kind", "split", "body", "fabric", "parameters", "pattern", "report",
)  # fmt: skip
_PICTURE = pa.struct([("bytes", pa.binary()), ("path", pa.string())])


def schema(recipe: Recipe, grid: int) -> pa.Schema:
    """Columns of a shard, with the features of `datasets` as metadata."""
    raster = pa.float32()
    for _ in range(4):
        raster = pa.list_(raster)
    fields = [(name, pa.string()) for name in _TEXTS if recipe.views or name != "report"]
    fields += [(name, pa.int64()) for name in ("version", "seed", "index")]
    fields += [("captions", pa.list_(pa.string())), ("raster", raster)]
    features: dict[str, Any] = {name: _value(str(kind)) for name, kind in fields[:-2]}
    features["captions"] = {"feature": _value("string"), "_type": "List"}
    shape = [None, CONTRACT_2.channels_per_layer, grid, grid]
    features["raster"] = {"shape": shape, "dtype": "float32", "_type": "Array4D"}
    for name in picture_columns(recipe):
        fields.append((name, _PICTURE))
        features[name] = {"_type": "Image"}
    return pa.schema(fields, metadata={b"huggingface": _json({"info": {"features": features}})})


def picture_columns(recipe: Recipe) -> tuple[str, ...]:
    """Columns of pictures."""
    return (*(f"picture_{view}" for view in recipe.views), "panels") if recipe.views else ()


@dataclass(frozen=True)
class ShardMetadata:
    """Metadata of a shard."""

    identity: Mapping[str, Any]
    """See `Shard.identity`."""
    types: tuple[str, ...]
    """All types of its recipe."""
    failed: tuple[FailedRow, ...]
    """Planned rows that could not be made."""


def shard_bytes(
    recipe: Recipe,
    grid: int,
    rows: Sequence[dict[str, Any]],
    failed: Sequence[FailedRow],
    identity: Mapping[str, Any],
) -> bytes:
    """A Parquet file with some rows; the same bytes for the same rows."""
    wanted = schema(recipe, grid)
    metadata = {
        "schema": SCHEMA,
        "identity": identity,
        "types": [each.name for each in recipe.types],
        "failed": [asdict(each) for each in failed],
    }
    wanted = wanted.with_metadata({**wanted.metadata, METADATA_KEY: _json(metadata)})
    columns = {name: [_cell(row, name) for row in rows] for name in wanted.names}
    arrays = [
        _rasters(columns[field.name], field.type)
        if field.name == "raster"
        else pa.array(columns[field.name], field.type)
        for field in wanted
    ]
    file = BytesIO()
    pq.write_table(
        pa.Table.from_arrays(arrays, schema=wanted),
        file,
        row_group_size=ROW_GROUP,
        compression="zstd",
        write_page_checksum=True,
    )
    return file.getvalue()


def parse_metadata(schema: pa.Schema) -> ShardMetadata:
    """The metadata in a shard's schema."""
    try:
        data = json.loads((schema.metadata or {})[METADATA_KEY])
        version = data["schema"]
        metadata = ShardMetadata(
            dict(data["identity"]),
            tuple(data["types"]),
            tuple(FailedRow(**each) for each in data["failed"]),
        )
        texts = [
            *metadata.types,
            *(text for each in metadata.failed for text in asdict(each).values()),
        ]
        if not all(isinstance(text, str) for text in texts):
            raise TypeError
    except (KeyError, TypeError, ValueError, RecursionError):
        raise DatasetError(
            "not a shard of this version of garmentimage; remove it and build again"
        ) from None
    if version not in READ_SCHEMAS:
        raise DatasetError(
            f"is a shard of version {version!r}; this garmentimage reads {min(READ_SCHEMAS)} to "
            f"{max(READ_SCHEMAS)}"
        )
    return metadata


def _cell(row: dict[str, Any], name: str) -> Any:
    if name == "panels":
        return {"bytes": row["panels"], "path": None}
    if name.startswith("picture_"):
        return {"bytes": row["pictures"][name.removeprefix("picture_")], "path": None}
    return row[name]


def _rasters(rasters: Sequence[np.ndarray], kind: pa.DataType) -> pa.Array:
    """Nested lists of equal rasters, without a Python object for every number."""
    flat: pa.Array = pa.array(np.concatenate([r.ravel() for r in rasters]) if rasters else [],
                              pa.float32())  # fmt: skip
    sizes = [
        [r.shape[axis] for r in rasters for _ in range(int(np.prod(r.shape[:axis])))]
        for axis in range(4)
    ]
    for lengths in sizes[::-1]:
        offsets = np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)]).astype(np.int32)
        flat = pa.ListArray.from_arrays(pa.array(offsets, pa.int32()), flat)
    return flat.cast(kind)


def _value(kind: str) -> dict[str, str]:
    return {"dtype": kind, "_type": "Value"}


def _json(data: Any) -> bytes:
    return json.dumps(data, sort_keys=True, separators=(",", ":")).encode()
