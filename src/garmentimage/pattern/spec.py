"""Reading and writing sewing patterns as *specification.json*.

Garment-Pattern-Generator and GarmentCode share this format. We read both of its curvature
syntaxes, any units, relative and absolute control points; we write GarmentCode's syntax in cm with
relative control points. Fields that we do not know come back where they were.

What the format has no place for lives in one field, "garmentimage", beside "pattern":

    "garmentimage": {
      "schema": 1,
      "panels": {NAME: {
        "holes":       [{"vertices": [...], "edges": [...]}],   as in a panel
        "grain":       [x, y],                                  unit direction of the warp
        "notches":     [{"edge": k, "at": share of its length}],
        "cloth_layer": 1 }},
      "stitches": [{"position": k, "stitch": [...]}] }          stitches that touch a hole

Edges of holes are numbered on after the panel's own edges. A pattern without such things is
written without the field.
"""

import json
import math
import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np

from garmentimage.errors import (
    PatternError,
    PatternFileError,
    PatternWarning,
    StitchError,
    quoted,
)
from garmentimage.files import shown_path, write_atomically
from garmentimage.pattern.check import (
    ARC_TOL,
    COORDINATE_LIMIT,
    EDGE_LIMIT,
    GRAIN_TOL,
    PANEL_LIMIT,
    SHORTEST_EDGE,
    STITCH_LIMIT,
    Finding,
    check_name,
    check_pattern,
    check_structure,
    edge_place,
    panel_place,
)
from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Curvature,
    Edge,
    Loop,
    Notch,
    Panel,
    Pattern,
    Point,
    Quadratic,
    Side,
    Stitch,
    Vector,
    euler_angles,
    relative_control,
)

SCHEMA = 1
"""Version of the field "garmentimage"."""
OURS = "garmentimage"
SAME_DIRECTION_FLAG = "right_wrong"
CM_PER_METRE = 100

FILE_LIMIT = 100_000_000
"""Bytes of a pattern file."""
NESTING_LIMIT = 100
"""Objects and lists within each other."""
FINDING_LIMIT = 50
"""Findings that reading one pattern gives; the rest is counted."""
ROUNDING_SHORTFALL = 1e-3
"""Share by which rounding may leave an arc's radius under half its chord; real files: 3e-6."""
ROTATION_TOL = 1e-4
"""How far a rotation matrix may be from orthonormal."""

PARAMETER_COUNTS = {"quadratic": 1, "cubic": 2, "circle": 3}
PANEL_FIELDS = ("translation", "rotation", "vertices", "edges")
WRITTEN_PROPERTIES = {
    "curvature_coords": "relative",
    "normalize_panel_translation": False,
    "units_in_meter": CM_PER_METRE,
}


def load_pattern(path: str | os.PathLike[str]) -> Pattern:
    """Read a sewing pattern; what was mended or looks odd is told as a `PatternWarning`.

    Raises:
        PatternFileError: the file cannot be read, or is no pattern.
        PatternError: the pattern cannot be sewn; names the panel and the edge.
        StitchError: a stitch joins nothing.
    """
    pattern, found = read_pattern(path)
    for finding in found:
        warnings.warn(f"{shown_path(path)}: {finding}", PatternWarning, stacklevel=2)
    return pattern


def read_pattern(path: str | os.PathLike[str]) -> tuple[Pattern, tuple[Finding, ...]]:
    """Read a sewing pattern, and say what was mended or looks odd.

    Raises:
        PatternFileError, PatternError, StitchError: as `load_pattern`.
    """
    try:
        raw = _read_bytes(path)
        try:
            return read_spec(_parse(raw), name=Path(path).stem)
        except _LongInteger:
            return _refuse_long_integers(raw)
    except PatternError as error:
        raise type(error)(f"{shown_path(path)}: {error}") from None


def pattern_from_spec(data: Any, name: str = "") -> Pattern:
    """The pattern that a parsed specification.json describes; warns as `load_pattern` does."""
    pattern, found = read_spec(data, name)
    for finding in found:
        warnings.warn(str(finding), PatternWarning, stacklevel=2)
    return pattern


def read_spec(data: Any, name: str = "") -> tuple[Pattern, tuple[Finding, ...]]:
    """The pattern that a parsed specification.json describes, and what was mended or looks odd.

    Raises:
        PatternFileError, PatternError, StitchError: as `load_pattern`.
    """
    _check_nesting(data)
    return _Reader().read(data, name)


# Bytes to values.


def _read_bytes(path: str | os.PathLike[str]) -> bytes:
    try:
        with Path(path).open("rb") as file:
            raw = file.read(FILE_LIMIT + 1)
    except FileNotFoundError:
        raise PatternFileError("there is no such file; check its name") from None
    except IsADirectoryError:
        raise PatternFileError("is a folder; name a pattern file in it") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise PatternFileError(f"cannot be read ({reason})") from None
    if len(raw) > FILE_LIMIT:
        raise PatternFileError(f"is larger than {FILE_LIMIT // 1_000_000} MB; no pattern is")
    return raw


class _LongInteger(Exception):
    """A JSON integer of more digits than Python reads."""


def _parse(raw: bytes, **options: Any) -> Any:
    """JSON in UTF-8, UTF-16 or UTF-32; duplicate keys are refused."""
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
        raise PatternFileError(_too_deep()) from None
    except PatternError:
        raise
    except ValueError:
        raise _LongInteger from None


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


def _refuse_long_integers(raw: bytes) -> Any:
    """Read again with such numbers as infinite, so that the error can name their place."""
    read_spec(_parse(raw, parse_int=_capped_integer))
    raise PatternFileError("holds a number of thousands of digits; remove it")


def _capped_integer(text: str) -> int | float:
    try:
        return int(text)
    except ValueError:
        return math.inf


def _check_nesting(data: Any) -> None:
    level = [data] if isinstance(data, (dict, list)) else []
    for _ in range(NESTING_LIMIT):
        if not level:
            return
        level = [
            inner
            for value in level
            for inner in (value.values() if isinstance(value, dict) else value)
            if isinstance(inner, (dict, list))
        ]
    raise PatternFileError(_too_deep())


def _too_deep() -> str:
    return f"nests objects and lists more than {NESTING_LIMIT} deep; no pattern does"


# Values to patterns.


@dataclass(frozen=True)
class _Units:
    """How the numbers of a file are to be understood."""

    scale: float
    """cm per file unit."""
    absolute: bool
    """Control points are given in panel coordinates."""
    recentre: bool
    """Panels are to be moved to the mean of their vertices."""

    def length(self, value: float) -> float:
        """A length of the file in cm; numbers of cm files come through unchanged."""
        return value if self.scale == 1 else value * self.scale

    def point(self, point: Point) -> Point:
        """A point of the file in cm."""
        return self.length(point[0]), self.length(point[1])


@dataclass
class _Reader:
    """Builds a pattern and gathers findings on the way."""

    found: list[Finding] = field(default_factory=list)

    def note(self, place: str, message: str) -> None:
        self.found.append(Finding(place, message))

    def read(self, data: Any, name: str) -> tuple[Pattern, tuple[Finding, ...]]:
        top = _object(data, "top level")
        body = _object(_member(top, "pattern", "top level"), "pattern")
        ours = self.ours(top)
        properties = self.properties(top)
        units = _units(properties)
        panel_data = _object(_member(body, "panels", "pattern"), "pattern.panels")
        if not panel_data:
            raise PatternError("pattern.panels: is empty; a pattern needs at least one panel")
        if len(panel_data) > PANEL_LIMIT:
            raise PatternError(
                f"pattern.panels: {len(panel_data)} panels; at most {PANEL_LIMIT} are taken"
            )
        our_panels = _object(ours.get("panels", {}), f"{OURS}.panels")
        for other in our_panels:
            if other not in panel_data:
                raise PatternFileError(
                    f"{OURS}.panels: names panel {quoted(other)}, which does not exist"
                )
        panels, orders = [], {}
        for key, value in panel_data.items():
            check_name(key)
            mine = _object(our_panels.get(key, {}), f"{OURS}.panels, {panel_place(key)}")
            panel, orders[key] = self.panel(key, _object(value, panel_place(key)), mine, units)
            panels.append(panel)
        numbers, stitches = self.stitches(body, ours, panels, orders)
        pattern = Pattern(
            tuple(panels), stitches, name=name, extra=self.extra(top, body, properties, ours)
        )
        self.found.extend(check_pattern(pattern, stitch_numbers=numbers))
        return pattern, _limited(self.found)

    def properties(self, top: Mapping[str, Any]) -> Mapping[str, Any]:
        if "properties" not in top:
            self.note("top level", "has no 'properties'; cm and relative curvature are assumed")
            return {}
        properties = _object(top["properties"], "properties")
        if "units_in_meter" not in properties:
            self.note("properties.units_in_meter", "is missing; cm are assumed")
        return properties

    def ours(self, top: Mapping[str, Any]) -> Mapping[str, Any]:
        if OURS not in top:
            return {}
        ours = _object(top[OURS], OURS)
        schema = ours.get("schema")
        if type(schema) is not int or not 1 <= schema <= SCHEMA:
            raise PatternFileError(
                f"{OURS}.schema: is {_shown(schema)}, but this version reads 1 to {SCHEMA}; "
                "update garmentimage or remove the field"
            )
        return ours

    def extra(
        self,
        top: Mapping[str, Any],
        body: Mapping[str, Any],
        properties: Mapping[str, Any],
        ours: Mapping[str, Any],
    ) -> dict[str, Any]:
        """What we do not know, by place; places without such things are left out."""
        in_pattern = _without(body, ("panels", "stitches"))
        if "panel_order" in in_pattern:
            in_pattern["panel_order"] = self.panel_order(in_pattern["panel_order"], body["panels"])
        our_panels = {
            name: rest
            for name, given in ours.get("panels", {}).items()
            if (rest := _without(given, ("holes", "grain", "notches", "cloth_layer")))
        }
        in_ours = _without(ours, ("schema", "panels", "stitches"))
        places = {
            "top": _without(top, ("pattern", "properties", OURS)),
            "pattern": in_pattern,
            "properties": _without(properties, WRITTEN_PROPERTIES),
            "ours": {**in_ours, **({"panels": our_panels} if our_panels else {})},
        }
        return {place: fields for place, fields in places.items() if fields}

    def panel_order(self, given: Any, panels: Mapping[str, Any]) -> list[str]:
        order = ordered_names(given, panels)
        if order != given:
            self.note("pattern.panel_order", "does not name each panel once; it was mended")
        return order

    def panel(
        self, name: str, data: Mapping[str, Any], ours: Mapping[str, Any], units: _Units
    ) -> tuple[Panel, list[int]]:
        """A panel, and for each of its edges' old numbers the new one."""
        place = panel_place(name)
        outline, order = self.loop(data, name, units, 0)
        holes: list[Loop] = []
        for k, hole in enumerate(_list(ours.get("holes", []), f"{place}, holes")):
            first = len(order)
            loop, hole_order = self.loop(_object(hole, f"{place}, hole {k}"), name, units, first)
            holes.append(loop)
            order = order + [first + number for number in hole_order]
        tx, ty, tz = (units.length(v) for v in self.placement(data, "translation", place))
        if units.recentre:
            middle = np.mean(outline.vertices, axis=0)
            outline, *holes = (_moved(loop, middle) for loop in (outline, *holes))
            # As every reader of this format does, without turning the offset by the rotation.
            tx, ty = tx + float(middle[0]), ty + float(middle[1])
        label, known = _label(data)
        panel = Panel(
            name,
            outline,
            tuple(holes),
            translation=(tx, ty, tz),
            rotation=self.placement(data, "rotation", place),
            label=label,
            grain=self.grain(ours, place),
            notches=_notches(ours, place, order),
            cloth_layer=_integer(ours.get("cloth_layer", 0), f"{place}, cloth_layer"),
            extra=_without(data, (*PANEL_FIELDS, *known)),
        )
        return panel, order

    def placement(self, data: Mapping[str, Any], what: str, place: str) -> Vector:
        if what not in data:
            self.note(place, f"has no {what}; (0, 0, 0) is assumed")
            return 0.0, 0.0, 0.0
        value = data[what]
        where = f"{place}, {what}"
        if (
            what == "rotation"
            and isinstance(value, list)
            and any(isinstance(row, list) for row in value)
        ):
            return _angles_of_matrix(value, where)
        x, y, z = _numbers(value, 3, where)
        return x, y, z

    def grain(self, ours: Mapping[str, Any], place: str) -> Point | None:
        if ours.get("grain") is None:
            return None
        x, y = _numbers(ours["grain"], 2, f"{place}, grain")
        length = hypot(x, y)
        if not length > 0:
            raise PatternError(f"{place}, grain: has no direction; give two numbers, not both 0")
        return (x, y) if abs(length - 1) <= GRAIN_TOL else (x / length, y / length)

    def loop(
        self, data: Mapping[str, Any], name: str, units: _Units, first: int
    ) -> tuple[Loop, list[int]]:
        """A closed loop, and for each old edge number the new one; mends order and direction."""
        place = panel_place(name)
        vertices = tuple(
            units.point(_point(v, f"{place}, vertex {k}"))
            for k, v in enumerate(_list(_member(data, "vertices", place), f"{place}, vertices"))
        )
        edge_data = _list(_member(data, "edges", place), f"{place}, edges")
        if len(edge_data) > EDGE_LIMIT:
            raise PatternError(f"{place}: {len(edge_data)} edges; at most {EDGE_LIMIT} are taken")
        edges = [
            self.edge(e, vertices, units, f"{place}, edge {first + k}")
            for k, e in enumerate(edge_data)
        ]
        chain = self.chain(edges, name, first)
        order = [0] * len(edges)
        for new, (old, _) in enumerate(chain):
            order[old] = new
        edges = [_turned(edges[old]) if backwards else edges[old] for old, backwards in chain]
        return self.used_vertices(Loop(vertices, tuple(edges)), place), order

    def edge(self, data: Any, vertices: Sequence[Point], units: _Units, where: str) -> Edge:
        given = _object(data, where)
        ends = _list(_member(given, "endpoints", where), f"{where}, endpoints")
        if len(ends) != 2:
            raise PatternError(f"{where}: has {len(ends)} endpoints; give two vertex numbers")
        start, end = (_integer(v, f"{where}, endpoints") for v in ends)
        for vertex in (start, end):
            if not 0 <= vertex < len(vertices):
                raise PatternError(
                    f"{where}: joins vertex {vertex}, but the panel has vertices 0 to "
                    f"{len(vertices) - 1}"
                )
        if start == end:
            raise PatternError(
                f"{where}: has no length (it joins vertex {start} to itself); remove it"
            )
        label, known = _label(given)
        return Edge(
            start,
            end,
            self.curvature(given.get("curvature"), vertices[start], vertices[end], units, where),
            label=label,
            extra=_without(given, ("endpoints", "curvature", *known)),
        )

    def curvature(
        self, data: Any, start: Point, end: Point, units: _Units, where: str
    ) -> Curvature:
        if data is None:
            return None
        chord = hypot(end[0] - start[0], end[1] - start[1])
        if chord < SHORTEST_EDGE:
            raise PatternError(
                f"{where}: has no length (its ends are the same place); remove it or move a vertex"
            )

        def control(value: Any) -> Point:
            point = _point(value, f"{where}, curvature")
            return relative_control(start, end, units.point(point)) if units.absolute else point

        if isinstance(data, list):
            return Quadratic(control(data))
        given = _object(data, f"{where}, curvature")
        kind = given.get("type")
        params = _list(given.get("params"), f"{where}, curvature params")
        wanted = PARAMETER_COUNTS.get(kind) if isinstance(kind, str) else None
        if wanted is None:
            raise PatternError(
                f"{where}: curvature type {_shown(kind)} is not known; "
                "use quadratic, cubic or circle"
            )
        if len(params) != wanted:
            raise PatternError(
                f"{where}: a {kind} curve has {wanted} parameters, not {len(params)}"
            )
        if kind == "quadratic":
            return Quadratic(control(params[0]))
        if kind == "cubic":
            return Cubic(control(params[0]), control(params[1]))
        radius = units.length(_number(params[0], f"{where}, radius"))
        large, right = (_flag(v, f"{where}, curvature") for v in params[1:])
        if chord / 2 * (1 - ROUNDING_SHORTFALL) < radius < chord / 2 * (1 - ARC_TOL):
            self.note(
                where, f"its radius is a hair under half the chord; {chord / 2:g} cm is taken"
            )
            radius = chord / 2
        return Circle(radius, large, right)

    def chain(self, edges: Sequence[Edge], name: str, first: int) -> list[tuple[int, bool]]:
        """Edge numbers in loop order, each with whether the edge must be turned round."""
        count = len(edges)
        if all(edges[k - 1].end == edges[k].start for k in range(count)):
            return [(k, False) for k in range(count)]
        chain = _chained(edges, name, first)
        turned = [old for old, backwards in chain if backwards]
        if 2 * len(turned) > count:
            # The loop was walked against most of its edges: walk it the other way.
            chain = [(old, not backwards) for old, backwards in (chain[0], *chain[:0:-1])]
            turned = [old for old, backwards in chain if backwards]
        if turned:
            numbers = ", ".join(str(first + k) for k in sorted(turned)[:5])
            self.note(
                f"{panel_place(name)}, edge {numbers}",
                "ran backwards in the loop and was turned round",
            )
        if any(old != new for new, (old, _) in enumerate(chain)):
            self.note(
                panel_place(name),
                "its edges were not in the order of the loop; they were sorted and renumbered",
            )
        return chain

    def used_vertices(self, loop: Loop, place: str) -> Loop:
        """The loop without vertices that no edge uses."""
        used = {v for e in loop.edges for v in (e.start, e.end)}
        unused = [k for k in range(len(loop.vertices)) if k not in used]
        if not unused:
            return loop
        self.note(place, f"vertex {unused[0]} is used by no edge and was left out")
        kept = sorted(used)
        new = {old: k for k, old in enumerate(kept)}
        edges = tuple(replace(e, start=new[e.start], end=new[e.end]) for e in loop.edges)
        return Loop(tuple(loop.vertices[k] for k in kept), edges)

    def stitches(
        self,
        body: Mapping[str, Any],
        ours: Mapping[str, Any],
        panels: Sequence[Panel],
        orders: Mapping[str, Sequence[int]],
    ) -> tuple[list[int], tuple[Stitch, ...]]:
        """The stitches with the numbers that the file gives them; copies are left out."""
        if "stitches" not in body:
            self.note("pattern", "has no 'stitches'; none are assumed")
        data = list(_list(body.get("stitches", []), "pattern.stitches"))
        plain = {p.name: len(p.outline.edges) for p in panels}
        all_edges = {p.name: len(p.edges) for p in panels}
        stitches = [self.stitch(s, f"stitch {k}", plain) for k, s in enumerate(data)]
        for k, entry in enumerate(_list(ours.get("stitches", []), f"{OURS}.stitches")):
            where = f"{OURS}.stitches, entry {k}"
            given = _object(entry, where)
            position = _integer(_member(given, "position", where), f"{where}, position")
            if not 0 <= position <= len(stitches):
                raise StitchError(f"{where}: position {position} is not one of a stitch")
            stitch = self.stitch(_member(given, "stitch", where), f"{where}, stitch", all_edges)
            stitches.insert(position, stitch)
        if len(stitches) > STITCH_LIMIT:
            raise StitchError(f"{len(stitches)} stitches; at most {STITCH_LIMIT} are taken")
        numbers, kept = self.without_copies(stitches)
        return numbers, tuple(_renumbered(stitch, orders) for stitch in kept)

    def stitch(self, data: Any, place: str, edge_counts: Mapping[str, int]) -> Stitch:
        parts = _list(data, place, StitchError)
        if not 2 <= len(parts) <= 3 or (len(parts) == 3 and not isinstance(parts[2], str)):
            raise StitchError(
                f"{place}: has {len(parts)} entries; a stitch has two sides, each with 'panel' "
                "and 'edge', and perhaps a flag"
            )
        a, rest_a = _side(parts[0], f"{place}, side 0", edge_counts)
        b, rest_b = _side(parts[1], f"{place}, side 1", edge_counts)
        flag = parts[2] if len(parts) == 3 else None
        if flag not in (None, SAME_DIRECTION_FLAG):
            self.note(place, f"its flag {quoted(flag)} is not known and has no effect")
        extra = {key: rest for key, rest in (("a", rest_a), ("b", rest_b)) if rest}
        same = flag == SAME_DIRECTION_FLAG
        return Stitch(a, b, same, flag=None if same else flag, extra=extra)

    def without_copies(self, stitches: Sequence[Stitch]) -> tuple[list[int], list[Stitch]]:
        first: dict[tuple[frozenset[Side], bool], int] = {}
        numbers, kept = [], []
        for number, stitch in enumerate(stitches):
            key = (frozenset(stitch.sides), stitch.same_direction)
            if key in first:
                self.note(
                    f"stitches {first[key]} and {number}", "are the same; the second was left out"
                )
                continue
            first[key] = number
            numbers.append(number)
            kept.append(stitch)
        return numbers, kept


def _chained(edges: Sequence[Edge], name: str, first: int) -> list[tuple[int, bool]]:
    """Follow the edges from vertex to vertex, starting along edge 0; True: walked backwards."""
    at: dict[int, list[int]] = {}
    for k, edge in enumerate(edges):
        at.setdefault(edge.start, []).append(k)
        at.setdefault(edge.end, []).append(k)
    for vertex, users in at.items():
        if len(users) == 1:
            raise PatternError(
                f"{edge_place(name, first + users[0])}: the outline is open at vertex {vertex}; "
                "add the missing edge"
            )
        if len(users) > 2:
            raise PatternError(
                f"{edge_place(name, first + users[0])}: {len(users)} edges meet at vertex "
                f"{vertex}; a panel's outline must be one simple loop"
            )
    chain = [(0, False)]
    here = edges[0].end
    while len(chain) < len(edges):
        k = next((k for k in at[here] if k != chain[-1][0]), 0)
        if k == 0:
            missed = min(set(range(len(edges))) - {old for old, _ in chain})
            raise PatternError(
                f"{edge_place(name, first + missed)}: belongs to a second loop; a panel has one "
                "outline (make it a panel of its own, or a hole)"
            )
        backwards = edges[k].start != here
        chain.append((k, backwards))
        here = edges[k].start if backwards else edges[k].end
    return chain


def _turned(edge: Edge) -> Edge:
    """The same curve walked the other way."""
    curvature = edge.curvature
    match curvature:
        case Quadratic(control):
            curvature = Quadratic(_seen_from_end(control))
        case Cubic(control, control2):
            curvature = Cubic(_seen_from_end(control2), _seen_from_end(control))
        case Circle(radius, large, right):
            curvature = Circle(radius, large, not right)
    return replace(edge, start=edge.end, end=edge.start, curvature=curvature)


def _seen_from_end(control: Point) -> Point:
    return 1 - control[0], -control[1]


def _label(data: Mapping[str, Any]) -> tuple[str | None, tuple[str, ...]]:
    """The label, and the field if it is one that we understand; others stay as they are."""
    label = data.get("label")
    if label is None or isinstance(label, str):
        return label, ("label",)
    return None, ()


def _moved(loop: Loop, middle: np.ndarray) -> Loop:
    x, y = float(middle[0]), float(middle[1])
    return replace(loop, vertices=tuple((vx - x, vy - y) for vx, vy in loop.vertices))


def _units(properties: Mapping[str, Any]) -> _Units:
    per_metre = _number(properties.get("units_in_meter", CM_PER_METRE), "properties.units_in_meter")
    if not per_metre > 0:
        raise PatternFileError(
            f"properties.units_in_meter: is {per_metre:g}; give a number above 0 (100 for cm)"
        )
    coords = properties.get("curvature_coords", "relative")
    if coords not in ("relative", "absolute"):
        raise PatternFileError(
            f"properties.curvature_coords: is {_shown(coords)}; use 'relative' or 'absolute'"
        )
    scale = 1.0 if per_metre == CM_PER_METRE else CM_PER_METRE / per_metre
    return _Units(
        scale, coords == "absolute", properties.get("normalize_panel_translation") is True
    )


def _angles_of_matrix(value: Any, where: str) -> Vector:
    rows = [_numbers(row, 3, where) for row in _list(value, where)]
    matrix = np.array(rows)
    if matrix.shape != (3, 3) or not (
        np.abs(matrix @ matrix.T - np.eye(3)).max() < ROTATION_TOL and np.linalg.det(matrix) > 0
    ):
        raise PatternError(f"{where}: is no rotation matrix; give three angles in degrees")
    return euler_angles(matrix)


def _notches(ours: Mapping[str, Any], place: str, order: Sequence[int]) -> tuple[Notch, ...]:
    notches = []
    for k, notch in enumerate(_list(ours.get("notches", []), f"{place}, notches")):
        where = f"{place}, notch {k}"
        given = _object(notch, where)
        edge = _integer(_member(given, "edge", where), where)
        if not 0 <= edge < len(order):
            raise PatternError(f"{where}: is on edge {edge}, which does not exist")
        notches.append(Notch(order[edge], _number(_member(given, "at", where), where)))
    return tuple(notches)


def _side(data: Any, where: str, edge_counts: Mapping[str, int]) -> tuple[Side, dict[str, Any]]:
    given = _object(data, where, StitchError)
    panel = _member(given, "panel", where, StitchError)
    if not isinstance(panel, str) or panel not in edge_counts:
        raise StitchError(f"{where}: names panel {_shown(panel)}, which does not exist")
    edge = _integer(_member(given, "edge", where, StitchError), f"{where}, edge", StitchError)
    if not 0 <= edge < edge_counts[panel]:
        raise StitchError(
            f"{where}: names edge {edge} of panel {quoted(panel)}, which has edges 0 to "
            f"{edge_counts[panel] - 1}"
        )
    return Side(panel, edge), _without(given, ("panel", "edge"))


def _renumbered(stitch: Stitch, orders: Mapping[str, Sequence[int]]) -> Stitch:
    a, b = (Side(s.panel, orders[s.panel][s.edge]) for s in stitch.sides)
    return stitch if (a, b) == stitch.sides else replace(stitch, a=a, b=b)


def _limited(found: Sequence[Finding]) -> tuple[Finding, ...]:
    if len(found) <= FINDING_LIMIT:
        return tuple(found)
    rest = len(found) - FINDING_LIMIT
    return (*found[:FINDING_LIMIT], Finding("pattern", f"{rest} further findings are not shown"))


# Small values, each checked.


def _object(value: Any, where: str, error: type[PatternError] = PatternFileError) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise error(f"{where}: must be an object, not {_kind(value)}")
    return value


def _list(value: Any, where: str, error: type[PatternError] = PatternFileError) -> list[Any]:
    if not isinstance(value, list):
        raise error(f"{where}: must be a list, not {_kind(value)}")
    return value


def _member(
    data: Mapping[str, Any], key: str, where: str, error: type[PatternError] = PatternFileError
) -> Any:
    if key not in data:
        raise error(f"{where}: '{key}' is missing; add it")
    return data[key]


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise PatternError(f"{where}: must be a number, not {_kind(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not abs(number) <= COORDINATE_LIMIT:
        shown = "NaN" if math.isnan(number) else "infinite or too large"
        raise PatternError(
            f"{where}: must be a finite number (up to {COORDINATE_LIMIT:g}); this one is {shown}"
        )
    return number


def _numbers(value: Any, count: int, where: str) -> list[float]:
    if not isinstance(value, list) or len(value) != count:
        given = f"{len(value)} values" if isinstance(value, list) else _kind(value)
        raise PatternError(f"{where}: must be a list of {count} numbers, not {given}")
    return [_number(v, where) for v in value]


def _point(value: Any, where: str) -> Point:
    # The common case first: a garment has hundreds of points.
    if type(value) is list and len(value) == 2:
        x, y = value
        if type(x) is float and type(y) is float and abs(x) <= COORDINATE_LIMIT >= abs(y):
            return x, y
    x, y = _numbers(value, 2, where)
    return x, y


def _integer(value: Any, where: str, error: type[PatternError] = PatternError) -> int:
    if type(value) is not int:
        raise error(f"{where}: must be a whole number, not {_shown(value)}")
    return value


def _flag(value: Any, where: str) -> bool:
    if value not in (0, 1) or not isinstance(value, (int, float)):
        raise PatternError(f"{where}: a circle's flags must be 0 or 1, not {_shown(value)}")
    return bool(value)


def _kind(value: Any) -> str:
    names: Iterable[tuple[type, str]] = (
        (dict, "an object"),
        (list, "a list"),
        (str, "text"),
        (bool, "true or false"),
        (int, "a number"),
        (float, "a number"),
    )
    return next((name for kind, name in names if isinstance(value, kind)), "null")


def _shown(value: Any) -> str:
    """A value of a file, short enough for a message."""
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return repr(value) if abs(value) <= COORDINATE_LIMIT else "a number out of range"
    return _kind(value)


def _without(data: Mapping[str, Any], known: Iterable[str]) -> dict[str, Any]:
    names = tuple(known)
    return {key: value for key, value in data.items() if key not in names}


def ordered_names(given: Any, names: Iterable[str]) -> list[str]:
    """`given` as far as it names each of `names` once, then those that it leaves out."""
    names = list(names)
    known = set(names)
    listed = [n for n in given if isinstance(n, str)] if isinstance(given, list) else []
    order = dict.fromkeys(n for n in listed if n in known)
    return list(dict.fromkeys([*order, *names]))


# Patterns to values to bytes.


def save_pattern(pattern: Pattern, path: str | os.PathLike[str]) -> None:
    """Write a pattern as specification.json, whole or not at all; `load_pattern` gives it back.

    Raises:
        PatternError: the pattern has a fault that a file cannot hold (a name twice, an open loop).
        OutputError: the place cannot be written to.
    """
    write_atomically(path, json.dumps(pattern_to_spec(pattern)) + "\n")


def pattern_to_spec(pattern: Pattern) -> dict[str, Any]:
    """The pattern as specification.json holds it: GarmentCode's syntax, cm, relative curvature.

    Raises:
        PatternError: the pattern has a fault that a file cannot hold.
    """
    check_structure(pattern)
    extra = pattern.extra
    body = {
        **extra.get("pattern", {}),
        "panels": {p.name: _panel_spec(p) for p in pattern.panels},
        "stitches": [_stitch_spec(s) for s in pattern.stitches if not _touches_hole(pattern, s)],
    }
    if "panel_order" in body:
        body["panel_order"] = ordered_names(body["panel_order"], body["panels"])
    data = {
        "pattern": body,
        **extra.get("top", {}),
        "properties": {**extra.get("properties", {}), **WRITTEN_PROPERTIES},
    }
    ours = _ours_spec(pattern)
    return {**data, OURS: ours} if ours else data


def _panel_spec(panel: Panel) -> dict[str, Any]:
    label = {} if panel.label is None else {"label": panel.label}
    return {
        **panel.extra,
        "translation": list(panel.translation),
        "rotation": list(panel.rotation),
        **_loop_spec(panel.outline),
        **label,
    }


def _loop_spec(loop: Loop) -> dict[str, Any]:
    return {
        "vertices": [list(v) for v in loop.vertices],
        "edges": [_edge_spec(e) for e in loop.edges],
    }


def _edge_spec(edge: Edge) -> dict[str, Any]:
    data: dict[str, Any] = {**edge.extra, "endpoints": [edge.start, edge.end]}
    match edge.curvature:
        case Quadratic(control):
            data["curvature"] = {"type": "quadratic", "params": [list(control)]}
        case Cubic(control, control2):
            data["curvature"] = {"type": "cubic", "params": [list(control), list(control2)]}
        case Circle(radius, large, right):
            data["curvature"] = {"type": "circle", "params": [radius, int(large), int(right)]}
    if edge.label is not None:
        data["label"] = edge.label
    return data


def _stitch_spec(stitch: Stitch) -> list[Any]:
    sides: list[Any] = [
        {**stitch.extra.get(key, {}), "panel": side.panel, "edge": side.edge}
        for key, side in (("a", stitch.a), ("b", stitch.b))
    ]
    flag = SAME_DIRECTION_FLAG if stitch.same_direction else stitch.flag
    return sides if flag is None else [*sides, flag]


def _touches_hole(pattern: Pattern, stitch: Stitch) -> bool:
    panels = pattern.by_name
    return any(side.edge >= len(panels[side.panel].outline.edges) for side in stitch.sides)


def _ours_spec(pattern: Pattern) -> dict[str, Any]:
    """The field "garmentimage", empty where the plain format says it all."""
    unknown = dict(pattern.extra.get("ours", {}))
    unknown_panels = unknown.pop("panels", {})
    panels = {}
    for panel in pattern.panels:
        fields = {**unknown_panels.get(panel.name, {}), **_panel_ours(panel)}
        if fields:
            panels[panel.name] = fields
    stitches = [
        {"position": k, "stitch": _stitch_spec(s)}
        for k, s in enumerate(pattern.stitches)
        if _touches_hole(pattern, s)
    ]
    ours = {
        **unknown,
        **({"panels": panels} if panels else {}),
        **({"stitches": stitches} if stitches else {}),
    }
    return {"schema": SCHEMA, **ours} if ours else {}


def _panel_ours(panel: Panel) -> dict[str, Any]:
    data: dict[str, Any] = {}
    if panel.holes:
        data["holes"] = [_loop_spec(hole) for hole in panel.holes]
    if panel.grain is not None:
        data["grain"] = list(panel.grain)
    if panel.notches:
        data["notches"] = [{"edge": n.edge, "at": n.at} for n in panel.notches]
    if panel.cloth_layer:
        data["cloth_layer"] = panel.cloth_layer
    return data
