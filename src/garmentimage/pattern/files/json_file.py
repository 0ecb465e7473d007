"""JSON files as bytes and values, however they are damaged or meant to harm."""

import json
import math
import os
from typing import Any

from garmentimage.errors import PatternError, PatternFileError, quoted
from garmentimage.system import read_limited

MAX_FILE_BYTES = 100_000_000
MAX_NESTING = 100  # objects and lists within each other
TOO_DEEP = f"nests objects and lists more than {MAX_NESTING} deep; no pattern does"
OTHER_KINDS = (
    # (first bytes, what such a file is)
    (b"\x93NUMPY", "an image (.npy), not a pattern; `garmentimage decode` makes a pattern of it"),
    (b"PK\x03\x04", "an image (.npz), not a pattern; `garmentimage decode` makes a pattern of it"),
    (b"\x89PNG", "a picture (PNG), not a pattern; give the file that it was drawn from"),
)
"""Files that are taken for patterns by mistake."""


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """The whole file, or a PatternFileError that says why it cannot be had."""
    return read_limited(
        path, MAX_FILE_BYTES, PatternFileError, kind="pattern file", too_large="no pattern is"
    )


class LongInteger(Exception):
    """A JSON integer of more digits than Python reads."""


def parse(raw: bytes, **options: Any) -> Any:
    """JSON in UTF-8, UTF-16 or UTF-32; duplicate keys are refused."""
    for start, kind in OTHER_KINDS:
        if raw.startswith(start):
            raise PatternFileError(f"is {kind}")
    if not raw.strip():
        raise PatternFileError("is empty; save the pattern again")
    try:
        text = raw.decode(json.detect_encoding(raw))
    except UnicodeDecodeError as error:
        raise PatternFileError(
            f"is not text ({error.encoding} fails at byte {error.start}); save it as UTF-8 JSON"
        ) from None
    try:
        return json.loads(
            text,
            object_pairs_hook=_unique,
            # One object per constant, so that an unknown field holding it equals itself.
            parse_constant={"NaN": math.nan, "Infinity": math.inf, "-Infinity": -math.inf}.get,
            **options,
        )
    except json.JSONDecodeError as error:
        raise PatternFileError(
            f"is not JSON ({error.msg} at line {error.lineno}, column {error.colno}, "
            f"character {error.pos}); save the pattern again"
        ) from None
    except RecursionError:
        raise PatternFileError(TOO_DEEP) from None
    except PatternError:
        raise
    except ValueError:
        raise LongInteger from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for k, key in enumerate(keys) if key in keys[:k])
        raise PatternFileError(
            f"the name {quoted(twice)} occurs twice in one object (two panels of that name, "
            "or a field given twice); rename or remove one"
        )
    return found


def capped_integer(text: str) -> int | float:
    """An integer, infinite where it has more digits than Python reads."""
    try:
        return int(text)
    except ValueError:
        return math.inf


def check_nesting(data: Any) -> None:
    """Refuse values that nest too deep to be compared or written again."""
    level = [data]
    for _ in range(MAX_NESTING):
        level = [value for value in level if isinstance(value, (dict, list))]
        if not level:
            return
        level = [
            inner
            for value in level
            for inner in (value.values() if isinstance(value, dict) else value)
        ]
    raise PatternFileError(TOO_DEEP)
