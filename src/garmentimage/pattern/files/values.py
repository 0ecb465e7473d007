"""Values from a JSON file, each checked: what is not as it should be is named with its place."""

import math
from collections.abc import Container, Iterable, Mapping
from typing import Any

from garmentimage.errors import PatternError, PatternFileError, quoted
from garmentimage.geometry import Point
from garmentimage.pattern.checks import MAX_COORDINATE


def as_object(
    value: Any, where: str, error: type[PatternError] = PatternFileError
) -> dict[str, Any]:
    """The value if it is a JSON object; `where` names its place in messages."""
    if not isinstance(value, dict):
        raise error(f"{where}: must be an object, not {json_type_name(value)}")
    return value


def as_list(value: Any, where: str, error: type[PatternError] = PatternFileError) -> list[Any]:
    """The value if it is a JSON list."""
    if not isinstance(value, list):
        raise error(f"{where}: must be a list, not {json_type_name(value)}")
    return value


def member(
    data: Mapping[str, Any], key: str, where: str, error: type[PatternError] = PatternFileError
) -> Any:
    """A field that must be there."""
    if key not in data:
        raise error(f"{where}: '{key}' is missing; add it")
    return data[key]


def as_number(value: Any, where: str) -> float:
    """The value as a finite float, not beyond `MAX_COORDINATE`."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise PatternError(f"{where}: must be a number, not {json_type_name(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not abs(number) <= MAX_COORDINATE:
        shown = "NaN" if math.isnan(number) else "infinite or too large"
        raise PatternError(
            f"{where}: must be a finite number (up to {MAX_COORDINATE:g}); this one is {shown}"
        )
    return number


def as_numbers(value: Any, count: int, where: str) -> list[float]:
    """The value if it is a list of `count` numbers."""
    if not isinstance(value, list) or len(value) != count:
        given = f"{len(value)} values" if isinstance(value, list) else json_type_name(value)
        raise PatternError(f"{where}: must be a list of {count} numbers, not {given}")
    return [as_number(v, where) for v in value]


def as_point(value: Any, where: str) -> Point:
    """The value if it is a list of two numbers."""
    # The common case first: a garment has hundreds of points.
    if type(value) is list and len(value) == 2:
        x, y = value
        if type(x) is float and type(y) is float and abs(x) <= MAX_COORDINATE >= abs(y):
            return x, y
    x, y = as_numbers(value, 2, where)
    return x, y


def as_integer(value: Any, where: str, error: type[PatternError] = PatternError) -> int:
    """The value if it is a whole number, written as one."""
    if type(value) is not int:
        raise error(f"{where}: must be a whole number, not {shown(value)}")
    return value


def as_flag(value: Any, where: str) -> bool:
    """The value if it is 0, 1, true or false."""
    if value not in (0, 1) or not isinstance(value, (int, float)):
        raise PatternError(f"{where}: a circle's flags must be 0 or 1, not {shown(value)}")
    return bool(value)


def json_type_name(value: Any) -> str:
    """What a value is, in words."""
    names: Iterable[tuple[type, str]] = (
        (dict, "an object"),
        (list, "a list"),
        (str, "text"),
        (bool, "true or false"),
        (int, "a number"),
        (float, "a number"),
    )
    return next((name for kind, name in names if isinstance(value, kind)), "null")


def shown(value: Any) -> str:
    """A value of a file, short enough for a message."""
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return repr(value) if abs(value) <= MAX_COORDINATE else "a number out of range"
    return json_type_name(value)


def without(data: Mapping[str, Any], known: Container[str]) -> dict[str, Any]:
    """The fields that are not known."""
    return {key: value for key, value in data.items() if key not in known}
