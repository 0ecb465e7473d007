"""From the values of a template's file to its pattern, parameters and constraints."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, TypeVar

import numpy as np

from garmentimage.draft.templates.influence import Bend, Moving, Outlines, Run
from garmentimage.draft.templates.parameter import (
    Constraint,
    ParameterType,
    TemplateParameter,
    TemplateValue,
    as_json,
    parameter_place,
    value_of,
)
from garmentimage.errors import PatternError, PatternFileError, quoted
from garmentimage.pattern import Loop, Panel, Pattern, Quadratic, euler_angles, mirrored_curvature
from garmentimage.pattern.checks import MIN_EDGE_LENGTH, check_pattern, edge_place, panel_place
from garmentimage.pattern.files import (
    CM_PER_METRE,
    as_integer,
    as_list,
    as_number,
    as_numbers,
    as_object,
    as_point,
    member,
    shown,
)

LENGTH_EQUALITY = "length_equality"
"""The one type of constraint."""
HALF_TURN = np.diag([-1.0, 1.0, -1.0])
"""Half a turn about the vertical axis."""


T = TypeVar("T", bound=Enum)


@dataclass(frozen=True)
class Parts:
    """What a template's file holds."""

    pattern: Pattern
    """With every parameter at its default and no constraint applied; lengths of `extra` in cm."""
    parameters: Mapping[str, TemplateParameter]
    constraints: tuple[Constraint, ...]


def read_parts(data: Mapping[str, Any], pattern: Pattern) -> Parts:
    """The parts of a template.

    Args:
        data: the parsed file.
        pattern: what `read_spec` made of it.
    """
    _check_edge_order(data["pattern"]["panels"])
    if not data.get("properties", {}).get("normalized_edge_loops"):
        pattern = replace(pattern, panels=tuple(counter_clockwise(p) for p in pattern.panels))
    return _Reader(pattern, data).parts()


def with_outlines(pattern: Pattern, outlines: Outlines) -> Pattern:
    """The pattern with other outlines of its panels."""
    panels = tuple(replace(p, outline=outlines[p.name]) for p in pattern.panels)
    return replace(pattern, panels=panels)


@dataclass(frozen=True)
class _Reader:
    pattern: Pattern
    data: Mapping[str, Any]

    def parts(self) -> Parts:
        given = as_object(self.data.get("parameters", {}), "parameters")
        if not given:
            raise PatternFileError(
                "is a pattern without 'parameters', so nothing can be drawn from it; "
                "name a template"
            )
        order = self.order(given)
        parameters = {name: self.parameter(name, given[name]) for name in order}
        values = {name: self.value(parameters[name], given[name]) for name in order}
        constraint_data = as_object(self.data.get("constraints", {}), "constraints")
        constraints = {name: self.constraint(name, c) for name, c in constraint_data.items()}
        outlines: Outlines = {p.name: p.outline for p in self.pattern.panels}
        for name in reversed(list(constraints)):
            factors = self.factors(name, constraint_data[name])
            outlines = constraints[name].undone(outlines, factors)
        for name in reversed(order):
            outlines = parameters[name].undone(outlines, values[name])
        extra = self.pattern.extra
        top = {**extra["top"], "parameters": _in_cm(given, parameters)}
        pattern = with_outlines(replace(self.pattern, extra={**extra, "top": top}), outlines)
        _check_restored(pattern)
        return Parts(pattern, parameters, tuple(constraints.values()))

    def unit(self, kind: ParameterType) -> float:
        """What 1 in the file is for a parameter of this type [cm for lengths]."""
        if kind is not ParameterType.ADDITIVE_LENGTH:
            return 1.0
        scale: float = CM_PER_METRE / self.data.get("properties", {}).get(
            "units_in_meter", CM_PER_METRE
        )
        return scale

    def order(self, given: Mapping[str, Any]) -> list[str]:
        """Names of the parameters in the order of their application."""
        order = as_list(self.data.get("parameter_order", list(given)), "parameter_order")
        names = [name if isinstance(name, str) else shown(name) for name in order]
        if sorted(names) != sorted(given):
            odd = (set(names) ^ set(given)) or {n for n in names if names.count(n) > 1}
            raise PatternError(
                f"parameter_order: must name each of the {len(given)} parameters once; "
                f"look at {quoted(min(odd))}"
            )
        return names

    def parameter(self, name: str, data: Any) -> TemplateParameter:
        place = parameter_place(name)
        given = as_object(data, place)
        kind = _member_of(ParameterType, member(given, "type", place), f"{place}, type")
        where = f"{place}, range"
        ranges = tuple(
            (as_number(low * self.unit(kind), where), as_number(high * self.unit(kind), where))
            for low, high in _ranges(member(given, "range", place), kind, where)
        )
        targets = list(self.targets(given, place))
        if kind is ParameterType.CURVE:
            bends = tuple(self.bend(panel, entry, where) for panel, entry, where in targets)
            return TemplateParameter(name, kind, ranges, bends=bends)
        runs = tuple(self.run(panel, entry, where) for panel, entry, where in targets)
        return TemplateParameter(name, kind, ranges, runs=runs)

    def value(self, parameter: TemplateParameter, given: Mapping[str, Any]) -> TemplateValue:
        """What the file's pattern was drawn with [cm for lengths]."""
        where = f"{parameter_place(parameter.name)}, value"
        numbers = parameter.numbers(given.get("value", parameter.default), where)
        return value_of([v * self.unit(parameter.type) for v in numbers])

    def constraint(self, name: str, data: Any) -> Constraint:
        place = f"constraint {quoted(name)}"
        given = as_object(data, place)
        if given.get("type") != LENGTH_EQUALITY:
            raise PatternError(
                f"{place}, type: is {shown(given.get('type'))}; use {LENGTH_EQUALITY!r}"
            )
        runs = tuple(self.run(p, entry, where) for p, entry, where in self.targets(given, place))
        if not runs:
            raise PatternError(f"{place}, influence: names no edges; name some or remove it")
        return Constraint(name, runs)

    def factors(self, name: str, data: Mapping[str, Any]) -> list[float]:
        """By how much the constraint scaled each of its runs in the file's pattern."""
        found = []
        for _, entry, where in self.targets(data, f"constraint {quoted(name)}"):
            factor = as_number(entry.get("value", 1), f"{where}, value")
            if factor == 0:
                raise PatternError(f"{where}, value: is 0, which cannot be undone; set it to 1")
            found.append(factor)
        return found

    def targets(self, given: Mapping[str, Any], place: str) -> Iterable[tuple[Panel, Any, str]]:
        """Each influenced panel with each entry of its edge list, and the entry's place."""
        for item in as_list(member(given, "influence", place), f"{place}, influence"):
            where = f"{place}, influence"
            influence = as_object(item, where)
            name = member(influence, "panel", where)
            panel = self.pattern.by_name.get(name) if isinstance(name, str) else None
            if panel is None:
                raise PatternError(f"{where}: names panel {shown(name)}, which does not exist")
            where = f"{where} on {panel_place(panel.name)}"
            for entry in as_list(member(influence, "edge_list", where), f"{where}, edge_list"):
                yield panel, entry, where

    def run(self, panel: Panel, entry: Any, where: str) -> Run:
        given = as_object(entry, f"{where}, edge_list")
        numbers = member(given, "id", where)
        edges = tuple(
            _edge(panel, number, f"{where}, id")
            for number in (numbers if isinstance(numbers, list) else [numbers])
        )
        if not edges:
            raise PatternError(f"{where}, id: names no edge; give one number or more")
        moving = _member_of(Moving, member(given, "direction", where), f"{where}, direction")
        along = as_point(given["along"], f"{where}, along") if "along" in given else None
        if along is not None and math.hypot(*along) < MIN_EDGE_LENGTH:
            raise PatternError(f"{where}, along: has no direction; give two numbers, not both 0")
        return Run(panel.name, edges, moving, along)

    def bend(self, panel: Panel, entry: Any, where: str) -> Bend:
        number = _edge(panel, entry, f"{where}, edge_list")
        if not isinstance(panel.edges[number].curvature, Quadratic):
            raise PatternError(
                f"{where}: edge {number} is not a quadratic curve, so it cannot be bent; "
                "give it a curvature [x, y]"
            )
        return Bend(panel.name, number)


def _member_of(kind: type[T], value: Any, where: str) -> T:
    for entry in kind:
        if entry.value == value:
            return entry
    known = ", ".join(entry.value for entry in kind)
    raise PatternError(f"{where}: is {shown(value)}; use one of {known}")


def _ranges(data: Any, kind: ParameterType, where: str) -> list[tuple[float, float]]:
    """One range, or for a curve perhaps two."""
    many = as_list(data, where)
    pair = kind is ParameterType.CURVE and any(isinstance(item, list) for item in many)
    if pair and len(many) != 2:
        raise PatternError(f"{where}: has {len(many)} ranges; give one or two")
    ranges = []
    for item in many if pair else [many]:
        low, high = as_numbers(item, 2, where)
        if low > high:
            raise PatternError(f"{where}: runs from {low:g} down to {high:g}; swap them")
        ranges.append((low, high))
    return ranges


def _edge(panel: Panel, value: Any, where: str) -> int:
    """Number of an edge of the panel's outline."""
    number = as_integer(value, where)
    count = len(panel.outline.edges)
    if not 0 <= number < count:
        raise PatternError(f"{where}: names edge {number}; the panel has edges 0 to {count - 1}")
    return number


def _check_edge_order(panels: Mapping[str, Any]) -> None:
    """Parameters name edges by number, so reading the pattern must not have renumbered them."""
    for name, panel in panels.items():
        ends = [edge["endpoints"] for edge in panel["edges"]]
        for k in range(len(ends)):
            if ends[k - 1][1] != ends[k][0]:
                raise PatternError(
                    f"{edge_place(name, k)}: does not start where the edge before it ends; "
                    "parameters name edges by number, so sort the edges of a template by hand"
                )


def _check_restored(pattern: Pattern) -> None:
    """A value that is not the one its pattern was drawn with gives itself away."""
    try:
        check_pattern(pattern)
    except PatternError as error:
        raise type(error)(
            f"with the values of its parameters undone, {error} (are these the values that the "
            "pattern was drawn with?)"
        ) from None


def counter_clockwise(panel: Panel) -> Panel:
    """A clockwise panel seen from its other side; the cloth does not move.

    The published samples are turned so. They also change the sign of the translation's x, which
    moves the panel by up to 4 mm; we do the same, so that ours lie where theirs do. The 'along'
    directions of parameters stay as they are, there and here; all known ones lie on an axis.
    """
    if panel.outline.area > 0:
        return panel
    x, y, z = panel.translation
    return replace(
        panel,
        outline=_mirrored(panel.outline),
        holes=tuple(_mirrored(hole) for hole in panel.holes),
        translation=(-x, y, z),
        rotation=euler_angles(panel.matrix @ HALF_TURN),
        grain=None if panel.grain is None else (-panel.grain[0], panel.grain[1]),
    )


def _mirrored(loop: Loop) -> Loop:
    """The loop with left and right exchanged; its edges keep their numbers and directions."""
    vertices = tuple((-x, y) for x, y in loop.vertices)
    edges = tuple(replace(e, curvature=mirrored_curvature(e.curvature)) for e in loop.edges)
    return Loop(vertices, edges)


def _in_cm(
    given: Mapping[str, Any], parameters: Mapping[str, TemplateParameter]
) -> dict[str, dict[str, Any]]:
    """The file's fields of its parameters, with defaults for values and lengths in cm."""
    found = {}
    for name, fields in given.items():
        parameter = parameters[name]
        ranges = [list(pair) for pair in parameter.ranges]
        found[name] = {
            **fields,
            "range": ranges if len(ranges) > 1 else ranges[0],
            "value": as_json(parameter.default),
        }
    return found
