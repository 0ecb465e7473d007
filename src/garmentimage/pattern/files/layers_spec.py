"""What the field "garmentimage" says of cloth on cloth: panels sewn onto others, and pleats."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from garmentimage.errors import PatternError, quoted
from garmentimage.pattern.checks import check_side
from garmentimage.pattern.files.values import (
    as_integer,
    as_list,
    as_number,
    as_object,
    as_point,
    member,
)
from garmentimage.pattern.model import Panel, Pleat, PleatFold, Point, SewnOnto, Side

FOLDS: Mapping[str, PleatFold] = {
    "left": "left",
    "right": "right",
    "box": "box",
    "inverted": "inverted",
}


@dataclass(frozen=True)
class LayersReader:
    """Reads both, with the panels as they were read."""

    panels: Sequence[Panel]
    orders: Mapping[str, Sequence[int]]
    """By panel, for each of its edges' numbers in the file the one that it has now."""
    middles: Mapping[str, Point]
    """For panels that were moved in their own coordinates the place that is now the origin [cm]."""
    scale: float  # cm per file unit

    def onto(self, values: Any, place: str) -> tuple[SewnOnto, ...]:
        """What is sewn onto cloth, edges by their new numbers."""
        return tuple(
            self._sewn_onto(as_object(value, f"{place}, {k}"), f"{place}, {k}")
            for k, value in enumerate(as_list(values, place))
        )

    def _sewn_onto(self, given: Mapping[str, Any], place: str) -> SewnOnto:
        name, on = (str(member(given, key, place)) for key in ("panel", "on"))
        numbers = tuple(sorted(self._edges(given, name, place)))
        rows = as_list(member(given, "matrix", place), f"{place}, matrix")
        if len(rows) != 2:
            raise PatternError(f"{place}, matrix: give two rows of two numbers")
        first, second = (as_point(row, f"{place}, matrix") for row in rows)
        x, y = as_point(member(given, "offset", place), f"{place}, offset")
        offset = x * self.scale, y * self.scale
        if on in self.middles and name in self.middles:
            # As the panels' own vertices were moved.
            own, base = self.middles[name], self.middles[on]
            offset = (
                offset[0] + first[0] * own[0] + first[1] * own[1] - base[0],
                offset[1] + second[0] * own[0] + second[1] * own[1] - base[1],
            )
        return SewnOnto(name, numbers, on, (first, second), offset)

    def pleats(self, values: Any, place: str) -> tuple[Pleat, ...]:
        """Pressed pleats, edges by their new numbers."""
        return tuple(
            self._pleat(as_object(value, f"{place}, {k}"), f"{place}, {k}")
            for k, value in enumerate(as_list(values, place))
        )

    def _pleat(self, given: Mapping[str, Any], place: str) -> Pleat:
        name = str(member(given, "panel", place))
        numbers = self._edges(given, name, place)
        if len(numbers) != 2:
            raise PatternError(f"{place}, edges: a pleat has two edges, not {len(numbers)}")
        first, second = numbers
        count = next(len(p.outline.edges) for p in self.panels if p.name == name)
        if second != (first + 1) % count:  # the outline was given the other way round
            first, second = second, first
        fold = str(member(given, "fold", place))
        if fold not in FOLDS:
            raise PatternError(f"{place}, fold: is {quoted(fold)}; there are {', '.join(FOLDS)}")
        pressed = as_number(member(given, "pressed", place), f"{place}, pressed")
        return Pleat(name, (first, second), FOLDS[fold], pressed * self.scale)

    def _edges(self, given: Mapping[str, Any], name: str, place: str) -> list[int]:
        """The edges of a panel that a field names, by their new numbers."""
        counts = {panel.name: len(panel.outline.edges) for panel in self.panels}
        values = as_list(member(given, "edges", place), f"{place}, edges")
        edges = [as_integer(edge, f"{place}, edges") for edge in values]
        for edge in edges:
            check_side(Side(name, edge), counts, place)
        return [self.orders[name][edge] for edge in edges]
