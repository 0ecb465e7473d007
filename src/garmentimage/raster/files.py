"""GarmentImages on disk: our `.npz`, the authors' `.npy`, and bare channels as `.npy`.

An `.npz` holds plain arrays: `inside` bool, `edge_type` int8 and `deformation` float32 as in
`GarmentImage`, `columns` and `rows` float64 (the grid lines on the body, cm), and `meta`, UTF-8
JSON as bytes: format, version, name, layer names, panel marks, and for the reader's information
the cell size and origin. Images that need channel contract 2 are files of version 2, which have
one array more, `turned` bool; all others are files of version 1.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentimage.errors import ImageError, OutputError, check_type
from garmentimage.raster.authors_layout import (
    ChannelOrder,
    channels_from_authors,
    detect_channel_order,
    to_authors,
)
from garmentimage.raster.channel_kind import ChannelKind
from garmentimage.raster.channels import (
    CONTRACT_1,
    MAX_GRID,
    MAX_LAYERS,
    MIN_GRID,
    check_channels,
)
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType, GarmentImage
from garmentimage.raster.panel_marks import mark_from_json, mark_to_json, read_text
from garmentimage.system import (
    NPY_MAGIC,
    ZIP_MAGIC,
    errors_about,
    npy_bytes,
    npz_bytes,
    parse_npy,
    parse_npz,
    read_limited,
    shown_path,
    write_atomically,
)

FORMAT = "garmentimage"
VERSION = 2
MAX_FILE_BYTES = 160 * 2**20
"""Largest file that is read: 16 layers of 256 x 256 cells in float64 fit."""
MAX_META_BYTES = 4 * 2**20  # largest `meta` [bytes]
_ARRAYS = ("meta", "inside", "edge_type", "deformation", "columns", "rows")
_ADDED = ("turned",)  # arrays that files of version 2 have


def save_image(image: GarmentImage, path: str | Path) -> None:
    """Write the image: `.npz` keeps all of it, `.npy` is the authors' layout (channels only).

    Raises:
        OutputError: the name ends otherwise, or the file cannot be written.
        ImageError: a `.npy` of an image that has not two layers, or that contract 1 does not hold.
        TypeError: it is not a GarmentImage.
    """
    check_type(image, GarmentImage, "encode(pattern) makes one")
    path = Path(path)
    match path.suffix.lower():
        case ".npz":
            data = image_bytes(image)
        case ".npy":
            data = npy_bytes(to_authors(image))
        case suffix:
            raise OutputError(
                f"{shown_path(path)}: images end in .npz or .npy, not {suffix or 'without one'}"
            )
    write_atomically(path, data)


def image_bytes(image: GarmentImage) -> bytes:
    """The image as a `.npz` file, all of it."""
    columns, rows = np.array(image.frame.columns), np.array(image.frame.rows)
    meta = {
        "format": FORMAT,
        "version": image.contract,
        "name": image.name,
        "layer_names": list(image.layer_names),
        "cell_size_cm": [float(np.median(np.diff(columns))), float(np.median(np.diff(rows)))],
        "origin_cm": [float(columns[0]), float(rows[0])],
        "marks": [mark_to_json(mark) for mark in image.marks],
    }
    arrays = {
        "meta": np.frombuffer(json.dumps(meta, allow_nan=False).encode("ascii"), np.uint8),
        "inside": np.asarray(image.inside, np.bool_),
        "edge_type": np.asarray(image.edge_type, np.int8),
        "deformation": np.asarray(image.deformation, np.float32),
        "columns": columns,
        "rows": rows,
    }
    if image.contract == 2:
        arrays["turned"] = np.asarray(image.turned, np.bool_)
    return npz_bytes(arrays)


def load_image(
    path: str | Path,
    *,
    order: ChannelOrder | str | None = None,
    kind: ChannelKind | None = None,
) -> GarmentImage:
    """Read an image from an `.npz` or `.npy` file; its content decides which.

    Args:
        path: the file.
        order: order of the channels of a `.npy`; default: detected from the values.
        kind: what the numbers of a `.npy` are, see `GarmentImage.from_channels`; default: likewise.

    Raises:
        ImageError: the file holds no GarmentImage; the message names the file.
    """
    path = Path(path)
    with errors_about(path):
        data = _read(path)
        if data.startswith(NPY_MAGIC):
            image = GarmentImage.from_channels(_channels(data, order), kind=kind)
            return replace(image, name=path.stem)
        if data.startswith(ZIP_MAGIC):
            return _from_arrays(parse_npz(data, _ARRAYS, _ADDED), path.stem)
        raise ImageError("not an .npz or .npy file; `garmentimage encode` turns a pattern into one")


def load_channels(path: str | Path, *, order: ChannelOrder | str | None = None) -> np.ndarray:
    """Channels [17 L or 26 L, N, N] in our order from any image file; soft values stay soft.

    Arguments and errors are those of `load_image`.
    """
    with errors_about(path):
        data = _read(path)
        if data.startswith(NPY_MAGIC):
            return _channels(data, order)
    return load_image(path).to_channels()


def _read(path: str | Path) -> bytes:
    return read_limited(
        path,
        MAX_FILE_BYTES,
        ImageError,
        kind=".npz or .npy file",
        too_large="a GarmentImage is far smaller",
        must_be_ordinary=True,
    )


def _channels(data: bytes, order: ChannelOrder | str | None) -> np.ndarray:
    array = check_channels(parse_npy(data))
    try:
        chosen = detect_channel_order(array) if order is None else ChannelOrder(order)
    except ValueError as error:  # ImageErrors are ValueErrors, too
        raise ImageError(str(error)) from None
    if chosen is ChannelOrder.OURS:
        return array
    if len(array) != 34:
        raise ImageError(f"{len(array)} channels; the authors' layout has 34")
    return channels_from_authors(array)


def _from_arrays(arrays: dict[str, np.ndarray], stem: str) -> GarmentImage:
    meta = _meta(arrays["meta"])
    inside, edge_type, deformation = (arrays[k] for k in ("inside", "edge_type", "deformation"))
    layers, grid = _size(inside)
    version = meta["version"]
    turned = np.zeros_like(inside) if version == 1 else _added(arrays, "turned", version)
    for name, array, shape, kinds in (
        ("inside", inside, (layers, grid, grid), "b"),
        ("turned", turned, (layers, grid, grid), "b"),
        ("edge_type", edge_type, (layers, 2, grid, grid), "iu"),
        ("deformation", deformation, (layers, 4, 2, grid, grid), "f"),
        ("columns", arrays["columns"], (grid + 1,), "f"),
        ("rows", arrays["rows"], (grid + 1,), "f"),
    ):
        if array.shape != shape or array.dtype.kind not in kinds:
            raise ImageError(f"array {name!r} is {array.dtype} {array.shape}, wanted {shape}")
        if array.dtype.kind == "f" and not (np.abs(array) <= np.finfo(np.float32).max).all():
            raise ImageError(f"array {name!r} holds values that are not finite")
    type_count = CONTRACT_1.edge_type_count if version == 1 else len(EdgeType)
    if edge_type.min() < 0 or edge_type.max() >= type_count:
        raise ImageError(f"array 'edge_type' holds values outside 0..{type_count - 1}")
    for name in ("columns", "rows"):
        if not (np.diff(arrays[name]) > 0).all():
            raise ImageError(f"the grid lines in {name!r} do not increase")
    names = meta.get("layer_names")
    if not isinstance(names, list) or len(names) != layers:
        raise ImageError(f"'layer_names' must be {layers} names")
    marks = meta.get("marks", [])
    if not isinstance(marks, list) or len(marks) > inside.size:
        raise ImageError("'marks' must be a list, with no more marks than cells")
    return GarmentImage(
        # A copy: for arrays that cannot be written to, all code would be compiled once more.
        inside=inside.copy(),
        edge_type=edge_type.astype(np.int8),
        deformation=deformation.astype(np.float32),
        frame=BodyFrame(tuple(map(float, arrays["columns"])), tuple(map(float, arrays["rows"]))),
        layer_names=tuple(read_text(n) for n in names),
        marks=tuple(mark_from_json(mark, layers, grid) for mark in marks),
        name=read_text(meta.get("name", "")) or stem,
        turned=turned & inside,
    )


def _added(arrays: dict[str, np.ndarray], name: str, version: int) -> np.ndarray:
    if name not in arrays:
        raise ImageError(f"not a GarmentImage of version {version}, the array {name!r} is missing")
    return arrays[name]


def _size(inside: np.ndarray) -> tuple[int, int]:
    shape = inside.shape
    if len(shape) != 3 or not 0 < shape[0] <= MAX_LAYERS:
        raise ImageError(f"array 'inside' has shape {shape}, wanted (layers, N, N)")
    if not MIN_GRID <= shape[1] <= MAX_GRID:
        raise ImageError(f"a grid of {shape[1]} cells; wanted {MIN_GRID} to {MAX_GRID}")
    return shape[0], shape[1]


def _meta(array: np.ndarray) -> dict[str, Any]:
    if array.dtype != np.uint8 or array.ndim != 1 or array.size > MAX_META_BYTES:
        raise ImageError("array 'meta' is not a short text")
    try:
        meta = json.loads(array.tobytes().decode("utf-8"))
    except (ValueError, RecursionError):
        raise ImageError("array 'meta' is not JSON") from None
    if not isinstance(meta, dict) or meta.get("format") != FORMAT:
        raise ImageError(f"array 'meta' does not say format {FORMAT!r}")
    version = meta.get("version")
    if not isinstance(version, int) or version < 1:
        raise ImageError(f"version {str(version)[:20]!r} is not a number from 1 up")
    if version > VERSION:
        raise ImageError(
            f"written by a newer garmentimage (format {version}, this one reads up to {VERSION}); "
            "update the package"
        )
    return meta
