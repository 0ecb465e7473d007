"""Pattern templates: pattern files whose edges stretch and bend by named parameters.

Garments of the data sets that Korosteleva and Lee published in 2021 are such templates with
parameters drawn at random. Beside "pattern" a template holds

    "parameters": {NAME: {
      "type":  "length" | "additive_length" | "curve",
      "range": [low, high],       for a curve also two ranges: along the edge, and across it
      "value": 1 or 0,            a number for each range
      "influence": [{"panel": P, "edge_list": [
        {"id": k | [k, ...], "direction": "start" | "end" | "both", "along": [x, y]},  of a length
        k ]}] }},                                                                      of a curve
    "parameter_order": [NAME, ...],
    "constraints": {NAME: {"type": "length_equality", "influence": as of a length}}

Parameters are applied in that order, then constraints: each scales its runs of edges to their mean
extent. A drawn pattern holds the same fields with its values, and is read as its template again.
"""

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentimage.draft.templates.influence import Outlines
from garmentimage.draft.templates.parameter import (
    Constraint,
    TemplateParameter,
    TemplateValue,
    as_json,
    parameter_place,
)
from garmentimage.draft.templates.reader import read_parts, with_outlines
from garmentimage.errors import PatternError, PatternFileError, PatternWarning, quoted
from garmentimage.pattern import Pattern
from garmentimage.pattern.checks import check_pattern, panel_place
from garmentimage.pattern.files import LongInteger, parse, read_bytes, read_spec, without
from garmentimage.system import did_you_mean, errors_about, shown_path


@dataclass(frozen=True)
class Template:
    """A sewing pattern and the parameters that change it."""

    pattern: Pattern
    """The pattern with every parameter at its default and no constraint applied."""
    parameters: Mapping[str, TemplateParameter]
    """Parameters by name, in the order in which they are applied."""
    constraints: tuple[Constraint, ...] = ()

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> "Template":
        """Read a template, or a pattern drawn from one, from its file.

        What was mended or looks odd in its pattern is reported as a `PatternWarning`.

        Raises:
            PatternFileError: the file cannot be read, or is not a template.
            PatternError: names the parameter, or the panel and edge, that cannot be.
        """
        with errors_about(path):
            try:
                data = parse(read_bytes(path))
            except LongInteger:
                raise PatternFileError("holds a number of thousands of digits; remove it") from None
            pattern, found = read_spec(data, Path(path).stem)
            parts = read_parts(data, pattern)
        for finding in found:
            warnings.warn(f"{shown_path(path)}: {finding}", PatternWarning, stacklevel=2)
        return cls(parts.pattern, parts.parameters, parts.constraints)

    def draw(self, rng: np.random.Generator) -> dict[str, TemplateValue]:
        """A value for each parameter, uniform in its range, as the published samples were drawn.

        They were drawn again where the pattern crossed itself; `with_values` refuses such values.
        """
        return {name: parameter.draw(rng) for name, parameter in self.parameters.items()}

    def with_values(self, values: Mapping[str, Any]) -> Pattern:
        """The pattern for these values; parameters that are not named keep their defaults.

        It holds the values as published samples do, so it can be saved and read as a template.

        Raises:
            PatternError: a name that no parameter has, a value out of range, or values that
                together make a panel cross itself or turn inside out.
        """
        for name in values:
            if name not in self.parameters:
                hint = did_you_mean(quoted(name), map(quoted, self.parameters))
                raise PatternError(f"{parameter_place(name)}: there is none; {hint}")
        given = {
            name: parameter.checked(values.get(name, parameter.default))
            for name, parameter in self.parameters.items()
        }
        outlines, factors = self._applied(given)
        drawn = with_outlines(self.pattern, outlines)
        try:
            check_pattern(drawn)
            _check_sides(self.pattern, drawn)
        except PatternError as error:
            raise type(error)(f"with these values of its parameters, {error}") from None
        return replace(drawn, extra=_recorded(self.pattern.extra, given, factors))

    def _applied(
        self, values: Mapping[str, TemplateValue]
    ) -> tuple[Outlines, dict[str, list[float]]]:
        """The outlines for these values, and the factors of each constraint."""
        outlines: Outlines = {p.name: p.outline for p in self.pattern.panels}
        for name, parameter in self.parameters.items():
            outlines = parameter.applied(outlines, values[name])
        factors = {}
        for constraint in self.constraints:
            outlines, factors[constraint.name] = constraint.applied(outlines)
        return outlines, factors


def _check_sides(template: Pattern, drawn: Pattern) -> None:
    """A curve that has passed its whole panel leaves a simple outline round the other side."""
    for before, after in zip(template.panels, drawn.panels, strict=True):
        if before.outline.area * after.outline.area < 0:
            raise PatternError(f"{panel_place(after.name)}: is turned inside out; bend it less")


def _recorded(
    extra: Mapping[str, Any],
    values: Mapping[str, TemplateValue],
    factors: Mapping[str, Sequence[float]],
) -> dict[str, Any]:
    """The further fields of a drawn pattern: those of the template, with what was applied."""
    top = dict(extra["top"])
    top["parameters"] = {
        name: {**fields, "value": as_json(values[name])}
        for name, fields in top["parameters"].items()
    }
    if factors:
        top["constraints"] = {
            name: _with_factors(fields, factors[name])
            for name, fields in top["constraints"].items()
        }
    return {**extra, "top": top}


def _with_factors(fields: Mapping[str, Any], factors: Sequence[float]) -> dict[str, Any]:
    """The fields of a constraint with the factor that each of its runs was scaled by.

    Published samples also note a run's "length" before that; it would not fit another draw.
    """
    left = iter(factors)
    influence = [
        {
            **item,
            "edge_list": [
                {**without(entry, ("length",)), "value": next(left)} for entry in item["edge_list"]
            ],
        }
        for item in fields["influence"]
    ]
    return {**fields, "influence": influence}
