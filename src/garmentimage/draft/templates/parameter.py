"""Parameters of a pattern template: their types, ranges and values, and what they change."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any

import numpy as np

from garmentimage.draft.templates.influence import (
    Bend,
    Outlines,
    Run,
    bent,
    equalising_factors,
    lengthened,
    scaled,
)
from garmentimage.errors import PatternError, quoted
from garmentimage.pattern.files import as_number

TemplateValue = float | tuple[float, float]
"""What a parameter is set to: one number, or two for a curve that moves along its edge too."""

MIN_DRAW = 0.01
"""Draws nearer to 0 than this are moved out to it: a factor of 0 could not be undone."""
RANGE_TOL = 1e-6
"""How far beyond its range a value may lie; published samples round to this."""


class ParameterType(Enum):
    """What a parameter's value means."""

    LENGTH = "length"
    """Factor by which runs of edges grow along their lines."""
    ADDITIVE_LENGTH = "additive_length"
    """Length by which runs of edges grow along their lines [cm]."""
    CURVE = "curve"
    """Factor of a control point's distance from its edge; two factors: also of its way along."""

    @property
    def neutral(self) -> float:
        """The value that changes nothing."""
        return 0.0 if self is ParameterType.ADDITIVE_LENGTH else 1.0


@dataclass(frozen=True)
class TemplateParameter:
    """A named way to change a template."""

    name: str
    type: ParameterType
    ranges: tuple[tuple[float, float], ...]
    """Lowest and highest value; two such pairs where the value is a pair."""
    runs: tuple[Run, ...] = ()
    """What a length changes, in this order."""
    bends: tuple[Bend, ...] = ()
    """What a curve changes."""

    @property
    def default(self) -> TemplateValue:
        """The value that changes nothing; a template's range need not hold it."""
        return value_of([self.type.neutral] * len(self.ranges))

    def draw(self, rng: np.random.Generator) -> TemplateValue:
        """A value from the range, all equally likely."""
        return value_of([_drawn(low, high, rng) for low, high in self.ranges])

    def checked(self, value: Any) -> TemplateValue:
        """The value, if it is the default or in the range."""
        place = parameter_place(self.name)
        numbers = self.numbers(value, place)
        for number, (low, high) in zip(numbers, self.ranges, strict=True):
            if number != self.type.neutral and not low - RANGE_TOL <= number <= high + RANGE_TOL:
                raise PatternError(
                    f"{place}: is {number:g}; give a number from {low:g} to {high:g}, "
                    f"or {self.type.neutral:g} to change nothing"
                )
        return value_of(numbers)

    def numbers(self, value: Any, place: str) -> list[float]:
        """One number for each range; `place` names the value's place in messages."""
        many = isinstance(value, (list, tuple))
        plain = [v.item() if isinstance(v, np.generic) else v for v in (value if many else [value])]
        if len(plain) != len(self.ranges):
            wanted = "1 number" if len(self.ranges) == 1 else f"{len(self.ranges)} numbers"
            raise PatternError(f"{place}: takes {wanted}, not {len(plain)}")
        return [as_number(v, place) for v in plain]

    def applied(self, outlines: Outlines, value: TemplateValue) -> Outlines:
        """The outlines changed by this parameter."""
        match self.type:
            case ParameterType.LENGTH:
                for run in self.runs:
                    outlines = scaled(outlines, run, _numbers(value)[0])
            case ParameterType.ADDITIVE_LENGTH:
                for run in self.runs:
                    outlines = lengthened(outlines, run, _numbers(value)[0])
            case ParameterType.CURVE:
                along, across = (1.0, *_numbers(value))[-2:]
                for bend in self.bends:
                    outlines = bent(outlines, bend, along, across)
        return outlines

    def undone(self, outlines: Outlines, value: TemplateValue) -> Outlines:
        """The outlines as they were before this parameter was applied."""
        if self.type is ParameterType.ADDITIVE_LENGTH:
            inverse = [-v for v in _numbers(value)]
        elif 0 in _numbers(value):
            raise PatternError(
                f"{parameter_place(self.name)}: its value 0 cannot be undone; set it to 1"
            )
        else:
            inverse = [1 / v for v in _numbers(value)]
        return replace(self, runs=self.runs[::-1]).applied(outlines, value_of(inverse))


@dataclass(frozen=True)
class Constraint:
    """Runs that are scaled to their mean extent, so that they can be sewn together."""

    name: str
    runs: tuple[Run, ...]

    def applied(self, outlines: Outlines) -> tuple[Outlines, list[float]]:
        """The outlines with the runs made equal, and the factor of each run."""
        factors = equalising_factors(outlines, self.runs)
        for run, factor in zip(self.runs, factors, strict=True):
            outlines = scaled(outlines, run, factor)
        return outlines, factors

    def undone(self, outlines: Outlines, factors: Sequence[float]) -> Outlines:
        """The outlines as they were before the runs were scaled by `factors`."""
        for run, factor in zip(self.runs[::-1], factors[::-1], strict=True):
            outlines = scaled(outlines, run, 1 / factor)
        return outlines


def parameter_place(name: str) -> str:
    """How messages call a parameter."""
    return f"parameter {quoted(name)}"


def _numbers(value: TemplateValue) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def value_of(numbers: Sequence[float]) -> TemplateValue:
    """One or two numbers as a parameter's value."""
    return numbers[0] if len(numbers) == 1 else (numbers[0], numbers[1])


def as_json(value: Any) -> Any:
    """A value as JSON gives it back: tuples as lists."""
    return list(value) if isinstance(value, tuple) else value


def _drawn(low: float, high: float, rng: np.random.Generator) -> float:
    value = float(rng.uniform(low, high))
    apart = math.copysign(MIN_DRAW, value)
    return apart if abs(value) < MIN_DRAW and low <= apart <= high else value
