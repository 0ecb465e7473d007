"""From the values of a specification.json to a pattern, repairing what can be repaired."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot
from typing import Any

import numpy as np

from garmentimage.errors import PatternError, PatternFileError, StitchError, quoted
from garmentimage.pattern.checks import (
    ARC_TOL,
    GRAIN_TOL,
    MAX_EDGES,
    MAX_PANELS,
    MAX_STITCHES,
    MIN_EDGE_LENGTH,
    check_ends,
    check_name,
    check_pattern,
    check_side,
    edge_place,
    panel_place,
)
from garmentimage.pattern.direction import outward, turned_edge
from garmentimage.pattern.files.json_file import check_nesting
from garmentimage.pattern.files.layers_spec import LayersReader
from garmentimage.pattern.files.values import (
    as_flag,
    as_integer,
    as_list,
    as_number,
    as_numbers,
    as_object,
    as_point,
    member,
    shown,
    without,
)
from garmentimage.pattern.finding import Finding
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

SCHEMA = 2  # newest version of the field "garmentimage"; 2 has "onto" and "pleats"
OURS = "garmentimage"
SAME_DIRECTION_FLAG = "right_wrong"
CM_PER_METRE = 100

MAX_FINDINGS = 50  # findings that reading one pattern gives; the rest is counted
ROUNDING_SHORTFALL = 1e-3
"""Share by which rounding may leave an arc's radius under half its chord; real files: 3e-6."""
ROTATION_TOL = 1e-4  # how far a rotation matrix may be from orthonormal

STRAIGHT_NAMES = ("line", "linear", "straight")
"""What other tools call the curvature of an edge that has none."""
PARAMETER_COUNTS = {"quadratic": 1, "cubic": 2, "circle": 3}
PANEL_FIELDS = ("translation", "rotation", "vertices", "edges")
KNOWN_PROPERTIES = ("curvature_coords", "normalize_panel_translation", "units_in_meter")


def read_spec(data: Any, name: str = "") -> tuple[Pattern, tuple[Finding, ...]]:
    """The pattern that a parsed specification.json describes, and what was repaired or looks odd.

    Raises:
        PatternFileError, PatternError, StitchError: names the panel, the edge, the stitch.
    """
    check_nesting(data)
    return _Reader().read(data, name)


@dataclass(frozen=True)
class _Units:
    """How the numbers of a file are to be understood."""

    scale: float  # cm per file unit
    absolute: bool  # control points are given in panel coordinates
    recentre: bool  # panels are to be moved to the mean of their vertices

    def point(self, point: Point) -> Point:
        """A point of the file in cm."""
        return point[0] * self.scale, point[1] * self.scale


@dataclass
class _Reader:
    """Builds a pattern and gathers findings on the way."""

    found: list[Finding] = field(default_factory=list)
    middles: dict[str, Point] = field(default_factory=dict)
    """For panels that were moved in their own coordinates the place that is now the origin [cm]."""

    def note(self, place: str, message: str) -> None:
        self.found.append(Finding(place, message))

    def read(self, data: Any, name: str) -> tuple[Pattern, tuple[Finding, ...]]:
        top = as_object(data, "top level")
        body = as_object(member(top, "pattern", "top level"), "pattern")
        ours = self.ours(top)
        properties = self.properties(top)
        units = _units(properties)
        panel_data = self.filled(as_object(member(body, "panels", "pattern"), "pattern.panels"))
        body = {**body, "panels": panel_data}
        if not panel_data:
            raise PatternError("pattern.panels: is empty; a pattern needs at least one panel")
        if len(panel_data) > MAX_PANELS:
            raise PatternError(
                f"pattern.panels: {len(panel_data)} panels; at most {MAX_PANELS} are taken"
            )
        our_panels = as_object(ours.get("panels", {}), f"{OURS}.panels")
        for other in our_panels:
            if other not in panel_data:
                raise PatternFileError(
                    f"{OURS}.panels: names panel {quoted(other)}, which does not exist"
                )
        panels, orders = [], {}
        for key, value in panel_data.items():
            check_name(key)
            mine = as_object(our_panels.get(key, {}), f"{OURS}.panels, {panel_place(key)}")
            panel, orders[key] = self.panel(key, as_object(value, panel_place(key)), mine, units)
            panels.append(panel)
        numbers, stitches = self.stitches(body, ours, panels, orders)
        layers = LayersReader(panels, orders, self.middles, units.scale)
        onto = layers.onto(ours.get("onto", []), f"{OURS}.onto")
        pleats = layers.pleats(ours.get("pleats", []), f"{OURS}.pleats")
        extra = self.extra(top, body, properties, ours)
        pattern = Pattern(tuple(panels), stitches, name, onto, pleats, extra)
        pattern, turned = outward(pattern)
        self.found.extend(turned)
        self.found.extend(check_pattern(pattern, stitch_numbers=numbers))
        return pattern, _limited(self.found)

    def filled(self, panels: Mapping[str, Any]) -> dict[str, Any]:
        """The panels without empty slots, as networks of a fixed number of panels write them."""
        filled = {}
        for name, panel in panels.items():
            if isinstance(panel, dict) and panel.get("vertices") == [] == panel.get("edges"):
                self.note(panel_place(name), "has neither vertices nor edges and was left out")
            else:
                filled[name] = panel
        return filled

    def properties(self, top: Mapping[str, Any]) -> Mapping[str, Any]:
        if "properties" not in top:
            self.note("top level", "has no 'properties'; cm and relative curvature are assumed")
            return {}
        properties = as_object(top["properties"], "properties")
        if "units_in_meter" not in properties:
            self.note("properties.units_in_meter", "is missing; cm are assumed")
        return properties

    def ours(self, top: Mapping[str, Any]) -> Mapping[str, Any]:
        if OURS not in top:
            return {}
        ours = as_object(top[OURS], OURS)
        schema = ours.get("schema")
        if type(schema) is not int or not 1 <= schema <= SCHEMA:
            raise PatternFileError(
                f"{OURS}.schema: is {shown(schema)}, but this version reads 1 to {SCHEMA}; "
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
        in_pattern = without(body, ("panels", "stitches"))
        if "panel_order" in in_pattern:
            order = ordered_names(in_pattern["panel_order"], body["panels"])
            if order != in_pattern["panel_order"]:
                self.note("pattern.panel_order", "does not name each panel once; it was completed")
            in_pattern["panel_order"] = order
        our_panels = {
            name: rest
            for name, given in ours.get("panels", {}).items()
            if (rest := without(given, ("holes", "grain", "notches", "cloth_layer")))
        }
        in_ours = without(ours, ("schema", "panels", "stitches", "onto", "pleats"))
        places = {
            "top": without(top, ("pattern", "properties", OURS)),
            "pattern": in_pattern,
            "properties": without(properties, KNOWN_PROPERTIES),
            "ours": {**in_ours, **({"panels": our_panels} if our_panels else {})},
        }
        return {place: fields for place, fields in places.items() if fields}

    def panel(
        self, name: str, data: Mapping[str, Any], ours: Mapping[str, Any], units: _Units
    ) -> tuple[Panel, list[int]]:
        """A panel, and for each of its edges' old numbers the new one."""
        place = panel_place(name)
        outline, order = self.loop(data, name, units, 0)
        holes: list[Loop] = []
        for k, hole in enumerate(as_list(ours.get("holes", []), f"{place}, holes")):
            first = len(order)
            loop, hole_order = self.loop(as_object(hole, f"{place}, hole {k}"), name, units, first)
            holes.append(loop)
            order = order + [first + number for number in hole_order]
        tx, ty, tz = (v * units.scale for v in self.placement(data, "translation", place))
        if units.recentre:
            middle = np.mean(outline.vertices, axis=0)
            self.middles[name] = (float(middle[0]), float(middle[1]))
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
            cloth_layer=as_integer(ours.get("cloth_layer", 0), f"{place}, cloth_layer"),
            extra=without(data, (*PANEL_FIELDS, *known)),
        )
        return panel, order

    def placement(self, data: Mapping[str, Any], what: str, place: str) -> Vector:
        if what not in data:
            self.note(place, f"has no {what}; (0, 0, 0) is assumed")
            return 0.0, 0.0, 0.0
        value, where = data[what], f"{place}, {what}"
        if what == "rotation" and isinstance(value, list):
            if any(isinstance(row, list) for row in value):
                return _angles_of_matrix(value, where)
            if len(value) == 4:
                raise PatternError(
                    f"{where}: four numbers, as of a quaternion; give three angles in degrees "
                    "about the fixed axes x, y, z, or a 3 x 3 matrix"
                )
        x, y, z = as_numbers(value, 3, where)
        return x, y, z

    def grain(self, ours: Mapping[str, Any], place: str) -> Point | None:
        if ours.get("grain") is None:
            return None
        x, y = as_numbers(ours["grain"], 2, f"{place}, grain")
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
            units.point(as_point(v, f"{place}, vertex {k}"))
            for k, v in enumerate(as_list(member(data, "vertices", place), f"{place}, vertices"))
        )
        edge_data = as_list(member(data, "edges", place), f"{place}, edges")
        if len(edge_data) > MAX_EDGES:
            raise PatternError(f"{place}: {len(edge_data)} edges; at most {MAX_EDGES} are taken")
        edges = [
            self.edge(e, vertices, units, f"{place}, edge {first + k}")
            for k, e in enumerate(edge_data)
        ]
        chain = self.chain(edges, name, first)
        order = [0] * len(edges)
        for new, (old, _) in enumerate(chain):
            order[old] = new
        edges = [turned_edge(edges[old]) if backwards else edges[old] for old, backwards in chain]
        return self.used_vertices(Loop(vertices, tuple(edges)), place), order

    def edge(self, data: Any, vertices: Sequence[Point], units: _Units, where: str) -> Edge:
        given = as_object(data, where)
        ends = as_list(member(given, "endpoints", where), f"{where}, endpoints")
        if len(ends) != 2:
            raise PatternError(f"{where}: has {len(ends)} endpoints; give two vertex numbers")
        start, end = (as_integer(v, f"{where}, endpoints") for v in ends)
        check_ends((start, end), len(vertices), where)
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
            extra=without(given, ("endpoints", "curvature", *known)),
        )

    def curvature(
        self, data: Any, start: Point, end: Point, units: _Units, where: str
    ) -> Curvature:
        if data is None:
            return None
        chord = hypot(end[0] - start[0], end[1] - start[1])
        if chord < MIN_EDGE_LENGTH:
            raise PatternError(
                f"{where}: has no length (its ends are the same place); remove it or move a vertex"
            )

        def control(value: Any) -> Point:
            point = as_point(value, f"{where}, curvature")
            return relative_control(start, end, units.point(point)) if units.absolute else point

        if isinstance(data, list):
            return Quadratic(control(data))
        given = as_object(data, f"{where}, curvature")
        kind = given.get("type")
        if kind in STRAIGHT_NAMES:
            return None
        params = as_list(given.get("params"), f"{where}, curvature params")
        wanted = PARAMETER_COUNTS.get(kind) if isinstance(kind, str) else None
        if wanted is None:
            raise PatternError(
                f"{where}: curvature type {shown(kind)} is not known; "
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
        radius = as_number(params[0], f"{where}, radius") * units.scale
        large, right = (as_flag(v, f"{where}, curvature") for v in params[1:])
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
        unused = set(range(len(loop.vertices))) - used
        if not unused:
            return loop
        self.note(place, f"vertex {min(unused)} is used by no edge and was left out")
        new = {old: k for k, old in enumerate(sorted(used))}
        edges = tuple(replace(e, start=new[e.start], end=new[e.end]) for e in loop.edges)
        return Loop(tuple(loop.vertices[k] for k in new), edges)

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
        data = list(as_list(body.get("stitches", []), "pattern.stitches"))
        plain = {p.name: len(p.outline.edges) for p in panels}
        all_edges = {p.name: len(p.edges) for p in panels}
        stitches = [self.stitch(s, f"stitch {k}", plain) for k, s in enumerate(data)]
        for k, entry in enumerate(as_list(ours.get("stitches", []), f"{OURS}.stitches")):
            where = f"{OURS}.stitches, entry {k}"
            given = as_object(entry, where)
            position = as_integer(member(given, "position", where), f"{where}, position")
            if not 0 <= position <= len(stitches):
                raise StitchError(f"{where}: position {position} is not one of a stitch")
            stitch = self.stitch(member(given, "stitch", where), f"{where}, stitch", all_edges)
            stitches.insert(position, stitch)
        if len(stitches) > MAX_STITCHES:
            raise StitchError(f"{len(stitches)} stitches; at most {MAX_STITCHES} are taken")
        numbers, kept = self.without_copies(stitches)
        return numbers, tuple(_renumbered(stitch, orders) for stitch in kept)

    def stitch(self, data: Any, place: str, edge_counts: Mapping[str, int]) -> Stitch:
        parts = as_list(data, place, StitchError)
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
        for number, stitch in enumerate(stitches):
            earlier = first.setdefault((frozenset(stitch.sides), stitch.same_direction), number)
            if earlier != number:
                self.note(
                    f"stitches {earlier} and {number}", "are the same; the second was left out"
                )
        return list(first.values()), [stitches[number] for number in first.values()]


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


def _label(data: Mapping[str, Any]) -> tuple[str | None, tuple[str, ...]]:
    """The label, and the field if it is one that we understand; others stay as they are."""
    label = data.get("label")
    return (label, ("label",)) if label is None or isinstance(label, str) else (None, ())


def _moved(loop: Loop, middle: np.ndarray) -> Loop:
    x, y = float(middle[0]), float(middle[1])
    return replace(loop, vertices=tuple((vx - x, vy - y) for vx, vy in loop.vertices))


def _units(properties: Mapping[str, Any]) -> _Units:
    per_metre = as_number(
        properties.get("units_in_meter", CM_PER_METRE), "properties.units_in_meter"
    )
    if not per_metre > 0:
        raise PatternFileError(
            f"properties.units_in_meter: is {per_metre:g}; give a number above 0 (100 for cm)"
        )
    coords = properties.get("curvature_coords", "relative")
    if coords not in ("relative", "absolute"):
        raise PatternFileError(
            f"properties.curvature_coords: is {shown(coords)}; use 'relative' or 'absolute'"
        )
    scale = 1.0 if per_metre == CM_PER_METRE else CM_PER_METRE / per_metre
    return _Units(scale, coords == "absolute", bool(properties.get("normalize_panel_translation")))


def _angles_of_matrix(value: Any, where: str) -> Vector:
    matrix = np.array([as_numbers(row, 3, where) for row in as_list(value, where)])
    if matrix.shape != (3, 3) or not (
        np.abs(matrix @ matrix.T - np.eye(3)).max() < ROTATION_TOL and np.linalg.det(matrix) > 0
    ):
        raise PatternError(f"{where}: is not a rotation matrix; give three angles in degrees")
    return euler_angles(matrix)


def _notches(ours: Mapping[str, Any], place: str, order: Sequence[int]) -> tuple[Notch, ...]:
    notches = []
    for k, notch in enumerate(as_list(ours.get("notches", []), f"{place}, notches")):
        where = f"{place}, notch {k}"
        given = as_object(notch, where)
        edge = as_integer(member(given, "edge", where), where)
        if not 0 <= edge < len(order):
            raise PatternError(f"{where}: is on edge {edge}, which does not exist")
        notches.append(Notch(order[edge], as_number(member(given, "at", where), where)))
    return tuple(notches)


def _side(data: Any, where: str, edge_counts: Mapping[str, int]) -> tuple[Side, dict[str, Any]]:
    given = as_object(data, where, StitchError)
    panel = member(given, "panel", where, StitchError)
    if not isinstance(panel, str):
        raise StitchError(f"{where}: names panel {shown(panel)}, which does not exist")
    edge = as_integer(member(given, "edge", where, StitchError), f"{where}, edge", StitchError)
    side = Side(panel, edge)
    check_side(side, edge_counts, where)
    return side, without(given, ("panel", "edge"))


def _renumbered(stitch: Stitch, orders: Mapping[str, Sequence[int]]) -> Stitch:
    a, b = (Side(s.panel, orders[s.panel][s.edge]) for s in stitch.sides)
    return stitch if (a, b) == stitch.sides else replace(stitch, a=a, b=b)


def _limited(found: Sequence[Finding]) -> tuple[Finding, ...]:
    if len(found) <= MAX_FINDINGS:
        return tuple(found)
    rest = len(found) - MAX_FINDINGS
    return (*found[:MAX_FINDINGS], Finding("pattern", f"{rest} further findings are not shown"))


def ordered_names(given: Any, names: Iterable[str]) -> list[str]:
    """`given` as far as it names each of `names` once, then those that it leaves out."""
    known = dict.fromkeys(names)
    listed = given if isinstance(given, list) else []
    return list(dict.fromkeys([*(n for n in listed if isinstance(n, str) and n in known), *known]))
