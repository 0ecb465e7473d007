"""Parameters of a design: what may be chosen, within which range, in which unit.

A design is a frozen dataclass whose fields are made with `parameter` (a number within a range) or
`choice` (one of some options); a kind of garment offers some of them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from math import isfinite
from typing import Any

from garmentimage.errors import DraftError, quoted
from garmentimage.system import did_you_mean, join_words

Value = float | int | str

_KEY = "parameter"


@dataclass(frozen=True)
class Parameter:
    """One thing about a garment that can be chosen."""

    name: str
    default: Value
    doc: str
    low: float = 0.0
    high: float = 0.0
    """Smallest and largest value of a number, both allowed."""
    unit: str = ""
    """Unit of a number: cm, or what it is a share of."""
    options: tuple[Value, ...] = ()
    """What can be chosen; empty for a number."""

    def checked(self, value: Any) -> Value:
        """The value, if it can be chosen; numbers and options may come as text."""
        if self.options:
            for option in self.options:
                if str(value) == str(option):
                    return option
            raise DraftError(
                f"{self.name} is {quoted(str(value))}; choose {join_words(self.options)}"
            )
        number = _number(value)
        if number is None or not self.low <= number <= self.high:
            given = f"{number:g}" if number is not None else quoted(str(value))
            raise DraftError(
                f"{self.name} is {given}; give a number from {self.low:g} to {self.high:g}"
                f"{f' [{self.unit}]' if self.unit else ''}"
            )
        return number


def parameter(default: float, low: float, high: float, unit: str, doc: str) -> Any:
    """A dataclass field that holds a number from `low` to `high`."""
    return field(
        default=default, metadata={_KEY: Parameter("", default, doc, float(low), float(high), unit)}
    )


def choice(default: Value, options: tuple[Value, ...], doc: str) -> Any:
    """A dataclass field that holds one of `options`."""
    return field(default=default, metadata={_KEY: Parameter("", default, doc, options=options)})


def parameters_of(design: type) -> dict[str, Parameter]:
    """The parameters of a design, by name, in the order of its fields."""
    return {f.name: replace(f.metadata[_KEY], name=f.name) for f in fields(design)}


def checked_values(
    parameters: Mapping[str, Parameter], given: Mapping[str, Any], what: str
) -> dict[str, Value]:
    """A value for every parameter: what is given, else the default.

    Raises:
        DraftError: a name that `what` does not have, or a value that it does not take.
    """
    for name in given:
        if name not in parameters:
            raise DraftError(
                f"{what} has no parameter {quoted(name)}; {did_you_mean(name, parameters)}"
            )
    return {
        name: p.checked(given[name]) if name in given else p.default
        for name, p in parameters.items()
    }


def _number(value: Any) -> float | None:
    """The finite number that a value is or spells."""
    if isinstance(value, bool):
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if isfinite(number) else None
