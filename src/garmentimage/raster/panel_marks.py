"""Panel marks as JSON objects, each field checked as it is read."""

import math
import sys
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from garmentimage.errors import ImageError
from garmentimage.raster.image import Division, PanelMark

MAX_NAME_LENGTH = 1000  # longest name of a layer or panel


def mark_to_json(mark: PanelMark) -> dict[str, Any]:
    """The mark as plain JSON values; without divisions it is what earlier releases wrote."""
    values = asdict(mark)
    if not mark.divisions:
        del values["divisions"]
    return values


def read_text(value: Any) -> str:
    """`value`, if it is a text of sensible length; else an ImageError."""
    if not isinstance(value, str) or len(value) > MAX_NAME_LENGTH:
        raise ImageError(f"a name is not a text of at most {MAX_NAME_LENGTH} characters")
    return value


def _is_number(value: Any) -> bool:
    """Whether this is a finite number that a float holds."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return math.isfinite(value) if isinstance(value, float) else abs(value) <= sys.float_info.max


def _numbers(count: int) -> Callable[[Any], tuple[float, ...]]:
    def read(value: Any) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) != count:
            raise ImageError(f"wanted {count} numbers, found {str(value)[:40]!r}")
        for v in value:
            if not _is_number(v):
                raise ImageError(f"wanted {count} numbers, found {str(v)[:40]!r} among them")
        return tuple(map(float, value))

    return read


def _optional(read: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda value: None if value is None else read(value)


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ImageError(f"wanted a whole number from 0 up, found {str(value)[:40]!r}")
    return value


def _cell(value: Any) -> tuple[int, ...]:
    if not isinstance(value, list) or len(value) != 2:
        raise ImageError("a cell is a row and a column")
    return tuple(_whole(v) for v in value)


def _matrix(value: Any) -> tuple[tuple[float, ...], ...]:
    if not isinstance(value, list) or len(value) != 2:
        raise ImageError("a matrix is two rows of two numbers")
    rows = tuple(_numbers(2)(row) for row in value)
    if not np.allclose(np.array(rows) @ np.array(rows).T, np.eye(2), atol=1e-6):
        raise ImageError(f"the matrix {rows} is not orthogonal")
    return rows


def _divisions(value: Any) -> tuple[Division, ...]:
    if not isinstance(value, list):
        raise ImageError("divisions are a list")
    return tuple(map(_division, value))


def _division(value: Any) -> Division:
    if not isinstance(value, list) or len(value) != 4 or not isinstance(value[3], list):
        raise ImageError("a division is a row, a column, a side and a list of shares")
    row, col, side = (_whole(v) for v in value[:3])
    shares = _numbers(len(value[3]))(value[3])
    if side > 3 or any(not 0 <= share <= 1 for share in shares) or list(shares) != sorted(shares):
        raise ImageError("a division's side is 0 to 3, its shares increase from 0 to 1")
    return row, col, side, shares


_MARK_FIELDS: dict[str, Callable[[Any], Any]] = {
    "name": read_text,
    "layer": _whole,
    "cell": _cell,
    "matrix": _matrix,
    "anchor": _numbers(2),
    "rotation": _optional(_numbers(3)),
    "translation": _optional(_numbers(3)),
    "split_of": _optional(read_text),
    "label": _optional(read_text),
    "grain": _optional(_numbers(2)),
    "divisions": _divisions,
}


def mark_from_json(value: Any, layers: int, grid: int) -> PanelMark:
    """A mark from its JSON object; fields that a later release may add are left out.

    Raises:
        ImageError: a field is missing or is not what it should be.
    """
    if not isinstance(value, dict) or not {"name", "layer", "cell"} <= set(value):
        raise ImageError("a mark needs a name, a layer and a cell")
    known = {}
    for name, read in _MARK_FIELDS.items():
        if name not in value:
            continue
        try:
            known[name] = read(value[name])
        except ImageError as error:
            raise ImageError(f"mark {str(value['name'])[:40]!r}, {name}: {error}") from None
    mark = PanelMark(**known)
    if mark.layer >= layers or max(mark.cell) >= grid:
        raise ImageError(f"mark {mark.name[:40]!r} lies outside the grid")
    return mark
