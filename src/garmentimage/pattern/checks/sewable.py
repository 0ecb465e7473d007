"""Can this pattern be sewn? Errors where it cannot, findings where it should be looked at.

An error is raised at the first fault; a `Finding` is a fact that the pattern's maker should know
and that does not stop the work.
"""

from collections.abc import Mapping, Sequence
from dataclasses import astuple
from math import hypot, isfinite

import numpy as np
from jaxtyping import Float

from garmentimage.errors import PatternError, StitchError, quoted
from garmentimage.geometry import CHORDS, connected_components, polyline_length
from garmentimage.pattern.checks.placement import placement_findings
from garmentimage.pattern.checks.pleated import check_pleats, pressed_findings
from garmentimage.pattern.checks.split_seams import half_sewn_findings
from garmentimage.pattern.finding import Finding, some
from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Edge,
    Loop,
    Panel,
    Pattern,
    Point,
    Quadratic,
    Side,
    chord_count,
)
from garmentimage.pattern.seam_runs import STUB_CM, stubs

MAX_NAME_LENGTH = 200  # characters of a panel's name
MAX_PANELS = 10_000
"""Panels of a pattern."""
MAX_EDGES = 100_000
"""Edges of a panel."""
MAX_STITCHES = 200_000
"""Stitches of a pattern."""
MAX_CLOTH_LAYER = 15
MAX_COORDINATE = 1e12
"""Largest coordinate [cm]."""
MAX_PANEL_SIZE = 20_000.0
"""Largest width or height of a panel [cm]; real ruffled skirts reach 1,500."""
MIN_EDGE_LENGTH = 1e-6
"""Two vertices nearer than this are one place [cm]; real edges go down to 0.0005."""
MIN_PANEL_WIDTH = 1e-7
"""Least area of a panel, as a share of its squared perimeter; a waistband of 1 x 1455 has 2e-4."""
STRAIGHT_TOL = 1e-6  # breadth of a set of points, as a share of its length, that makes it a line
GRAIN_TOL = 1e-6
"""How far the length of a grain line's direction may be from 1."""
ARC_TOL = 1e-12
"""Share by which a radius may fall short of half the chord before it is called too short."""

RIGID_TOL = 1e-4  # how far the matrix of what is sewn onto cloth may be from orthonormal
BEYOND_CM = 0.5  # what is sewn onto cloth may lie so far beyond it

FAR_AWAY = 1e5  # panel coordinates beyond this lose precision for nothing [cm]
MAX_USUAL_EDGES = 1_000  # more edges than this in one panel are likely a traced outline
MAX_GATHER_RATIO = 3.5
"""Sides of a stitch more unequal than this are likely a mistake; real gathers reach 3 and a bit."""
GATHER_SLACK = 1.0  # a difference in length that is never worth a word [cm]
SEGMENT_BLOCK = 512
"""Segments that are tested against all others at a time; bounds the memory of a scribble."""


def check_pattern(
    pattern: Pattern, *, stitch_numbers: Sequence[int] | None = None
) -> tuple[Finding, ...]:
    """Say whether a pattern can be sewn, and what about it is odd.

    Args:
        pattern: any pattern.
        stitch_numbers: what messages call the stitches; default: their positions.

    Returns:
        What does not stop the work but should be known, panels first.

    Raises:
        PatternError: a panel that cannot be cut from cloth; names the panel and the edges.
        StitchError: a stitch that does not join two edges; names the stitch.
    """
    numbers = range(len(pattern.stitches)) if stitch_numbers is None else stitch_numbers
    check_structure(pattern, stitch_numbers=numbers)
    return (
        *(finding for panel in pattern.panels for finding in _check_shape(panel)),
        *_check_stubs(pattern),
        *_check_lengths(pattern, numbers),
        *half_sewn_findings(pattern, numbers),
        *_check_places_on(pattern),
        *pressed_findings(pattern),
        *_check_assembly(pattern),
        *placement_findings(pattern),
    )


def check_structure(pattern: Pattern, *, stitch_numbers: Sequence[int] | None = None) -> None:
    """Check all that can be seen without geometry: names, numbers, loops, what stitches name.

    A pattern that passes can be written to a file and read again.

    Raises:
        PatternError: a name, a number or a loop that cannot be.
        StitchError: a stitch that names nothing, or an edge that is sewn twice.
    """
    if not pattern.panels:
        raise PatternError("the pattern has no panels (pattern.panels is empty); add at least one")
    if len(pattern.panels) > MAX_PANELS:
        raise PatternError(f"{len(pattern.panels)} panels; at most {MAX_PANELS} are taken")
    seen: set[str] = set()
    for panel in pattern.panels:
        check_name(panel.name)
        if panel.name in seen:
            raise PatternError(f"two panels are named {quoted(panel.name)}; rename one")
        seen.add(panel.name)
        _check_panel_structure(panel)
    numbers = range(len(pattern.stitches)) if stitch_numbers is None else stitch_numbers
    _check_stitches(pattern, numbers)
    _check_onto(pattern)
    check_pleats(pattern)


def check_name(name: str) -> None:
    """A panel's name must be short enough and writable as UTF-8."""
    if len(name) > MAX_NAME_LENGTH:
        raise PatternError(
            f"panel {quoted(name)}: its name has {len(name)} characters; "
            f"at most {MAX_NAME_LENGTH} are taken"
        )
    if any("\ud800" <= c <= "\udfff" for c in name):
        raise PatternError(
            f"panel {quoted(name)}: its name holds half a character (a lone surrogate), "
            "which no file can hold; rename it"
        )


def panel_place(name: str) -> str:
    """How messages call a panel."""
    return f"panel {quoted(name)}"


def edge_place(name: str, edge: int) -> str:
    """How messages call an edge."""
    return f"{panel_place(name)}, edge {edge}"


def _check_panel_structure(panel: Panel) -> None:
    place = panel_place(panel.name)
    count = len(panel.edges)
    if count > MAX_EDGES:
        raise PatternError(f"{place}: {count} edges; at most {MAX_EDGES} are taken")
    for what, vector in (("translation", panel.translation), ("rotation", panel.rotation)):
        if not all(isfinite(v) and abs(v) <= MAX_COORDINATE for v in vector):
            raise PatternError(f"{place}: its {what} is not finite; give three ordinary numbers")
    for loop, numbers in zip(panel.loops, panel.edge_ranges, strict=True):
        _check_loop(loop, place, numbers.start)
    if panel.grain is not None and not abs(hypot(*panel.grain) - 1) <= GRAIN_TOL:
        raise PatternError(f"{place}: its grain line is not a unit direction; divide by its length")
    for notch in panel.notches:
        if not (0 <= notch.edge < count and 0 <= notch.at <= 1):
            raise PatternError(
                f"{place}: a notch at {notch.at} of edge {notch.edge}; the edge must exist "
                "and the place be a share from 0 to 1"
            )
    if not 0 <= panel.cloth_layer <= MAX_CLOTH_LAYER:
        raise PatternError(f"{place}: cloth layer {panel.cloth_layer}; give 0 to {MAX_CLOTH_LAYER}")


def _check_loop(loop: Loop, place: str, first: int) -> None:
    """Check vertices, edge ends and curves of a loop that begins with edge `first` of its panel."""
    for k, (x, y) in enumerate(loop.vertices):
        if not (abs(x) <= MAX_COORDINATE and abs(y) <= MAX_COORDINATE):
            raise PatternError(
                f"{place}, vertex {k}: its coordinates are not finite, or beyond "
                f"{MAX_COORDINATE:g} cm; give ordinary numbers"
            )
    if len(loop.edges) < 2:
        raise PatternError(f"{place}: a closed outline needs two edges or more")
    starts: set[int] = set()
    for k, edge in enumerate(loop.edges):
        where = f"{place}, edge {first + k}"
        check_ends((edge.start, edge.end), len(loop.vertices), where)
        after = loop.edges[(k + 1) % len(loop.edges)]
        if edge.end != after.start:
            raise PatternError(
                f"{where}: ends at vertex {edge.end}, but the next edge starts at {after.start}; "
                "the edges must form one closed chain"
            )
        if edge.start in starts:
            raise PatternError(
                f"{where}: the outline passes vertex {edge.start} a second time; "
                "a panel's outline must not touch itself"
            )
        starts.add(edge.start)
        _check_edge(edge, loop.vertices, where)


def check_ends(ends: tuple[int, int], vertex_count: int, where: str) -> None:
    """Check that an edge joins vertices that exist; `where` names it in the message."""
    for end in ends:
        if not 0 <= end < vertex_count:
            raise PatternError(
                f"{where}: joins vertex {end}, but the panel has vertices 0 to {vertex_count - 1}"
            )


def _check_edge(edge: Edge, vertices: Sequence[Point], where: str) -> None:
    """Check that an edge has a length and a curve that exists."""
    (x0, y0), (x1, y1) = vertices[edge.start], vertices[edge.end]
    chord = hypot(x1 - x0, y1 - y0)
    if chord < MIN_EDGE_LENGTH:
        raise PatternError(
            f"{where}: has no length (vertices {edge.start} and {edge.end} are the same place); "
            "remove it or move a vertex"
        )
    match edge.curvature:
        case Circle(radius):
            if not chord / 2 * (1 - ARC_TOL) <= radius <= MAX_COORDINATE:
                raise PatternError(
                    f"{where}: an arc of radius {radius:g} cm cannot join points {chord:g} cm "
                    f"apart; the radius must be at least {chord / 2:g} cm"
                )
        case Quadratic() | Cubic() as curve:
            if not all(abs(v) <= MAX_COORDINATE for control in astuple(curve) for v in control):
                raise PatternError(f"{where}: its curvature is not finite; give ordinary numbers")


def check_side(side: Side, edge_counts: Mapping[str, int], where: str) -> None:
    """Check that the side of a stitch, named `where` in the message, is an edge of a panel.

    Raises:
        StitchError: there is no such panel, or no such edge.
    """
    if side.panel not in edge_counts:
        raise StitchError(f"{where}: names panel {quoted(side.panel)}, which does not exist")
    count = edge_counts[side.panel]
    if not 0 <= side.edge < count:
        raise StitchError(
            f"{where}: names edge {side.edge} of panel {quoted(side.panel)}, which has edges 0 to "
            f"{count - 1}"
        )


def _check_stitches(pattern: Pattern, numbers: Sequence[int]) -> None:
    """Check that stitches name edges that exist, and no edge twice."""
    stitches = pattern.stitches
    if len(stitches) > MAX_STITCHES:
        raise StitchError(f"{len(stitches)} stitches; at most {MAX_STITCHES} are taken")
    edge_counts = {panel.name: len(panel.edges) for panel in pattern.panels}
    user: dict[Side, int] = {}
    for number, stitch in zip(numbers, stitches, strict=True):
        for side in stitch.sides:
            check_side(side, edge_counts, f"stitch {number}")
        if stitch.a == stitch.b:
            raise StitchError(
                f"stitch {number}: sews edge {stitch.a.edge} of panel {quoted(stitch.a.panel)} "
                "to itself; name two different edges"
            )
        for side in stitch.sides:
            if side in user:
                raise StitchError(
                    f"stitches {user[side]} and {number}: both sew edge {side.edge} of panel "
                    f"{quoted(side.panel)}; split the edge or remove one stitch"
                )
            user[side] = number


def _check_onto(pattern: Pattern) -> None:
    """Check what is sewn onto cloth: panels and edges exist, once, and the place is rigid."""
    taken = {side for stitch in pattern.stitches for side in stitch.sides}
    seen: set[str] = set()
    for sewn in pattern.onto:
        for name in (sewn.panel, sewn.on):
            if name not in pattern.by_name:
                raise StitchError(
                    f"panel {quoted(sewn.panel)} is sewn onto panel {quoted(sewn.on)}: there is no "
                    f"panel {quoted(name)}"
                )
        place = f"{panel_place(sewn.panel)}, sewn onto panel {quoted(sewn.on)}"
        if sewn.panel == sewn.on or sewn.panel in seen:
            raise StitchError(f"{place}: it can be sewn onto one other panel; remove the rest")
        seen.add(sewn.panel)
        count = len(pattern.by_name[sewn.panel].outline.edges)
        if not sewn.edges or list(sewn.edges) != sorted(set(sewn.edges) & set(range(count))):
            raise StitchError(
                f"{place}: its edges are {list(sewn.edges)}; name edges of its outline, 0 to "
                f"{count - 1}, once each and in order"
            )
        both = taken & set(sewn.sides)
        if both:
            edge = min(side.edge for side in both)
            raise StitchError(f"{place}: edge {edge} is also stitched to an edge; remove one")
        matrix = np.array(sewn.matrix, float)
        numbers = np.array([*matrix.ravel(), *sewn.offset])
        rigid = np.abs(matrix @ matrix.T - np.eye(2)).max() <= RIGID_TOL
        if not (np.abs(numbers) <= MAX_COORDINATE).all() or not rigid:
            raise StitchError(
                f"{place}: its place is not a rigid motion; give a matrix of orthonormal rows and "
                "an offset in cm"
            )


def _check_places_on(pattern: Pattern) -> list[Finding]:
    """What is sewn onto a panel but lies beyond its cloth."""
    import shapely

    found = []
    for sewn in pattern.onto:
        outline, *holes = (loop.polygon for loop in pattern.by_name[sewn.on].loops)
        cloth = shapely.Polygon(outline, holes).buffer(BEYOND_CM)
        lines = [sewn.carried(pattern.curve(side).sample(CHORDS)) for side in sewn.sides]
        if not all(cloth.covers(shapely.LineString(line)) for line in lines):
            found.append(
                Finding(
                    panel_place(sewn.panel),
                    f"is sewn onto panel {quoted(sewn.on)}, but lies partly beyond its cloth; "
                    "move it, or sew it into the seam there",
                )
            )
    return found


def _check_shape(panel: Panel) -> list[Finding]:
    """Area, size and simplicity of the panel's loops."""
    place = panel_place(panel.name)
    found = []
    rings = [loop.polygon for loop in panel.loops]
    for loop, ring in zip(panel.loops, rings, strict=True):
        origin, size = ring.min(axis=0), np.ptp(ring, axis=0)
        if size.max() > MAX_PANEL_SIZE:
            raise PatternError(
                f"{place}: is {size.max() / 100:.6g} m in size; at most "
                f"{MAX_PANEL_SIZE / 100:g} m are taken; check the units"
            )
        if np.abs(origin).max() > FAR_AWAY:
            found.append(
                Finding(place, f"lies {np.abs(origin).max():.3g} cm from its own origin; move it")
            )
        perimeter = polyline_length(ring) + hypot(*(ring[0] - ring[-1]))
        if abs(loop.area) < MIN_PANEL_WIDTH * perimeter**2 and _on_one_line(ring):
            raise PatternError(f"{place}: has no area; its edges lie on one line")
        unused = set(range(len(loop.vertices))) - {e.start for e in loop.edges}
        if unused:
            found.append(Finding(place, f"vertex {min(unused)} is used by no edge"))
    if len(panel.edges) > MAX_USUAL_EDGES:
        found.append(Finding(place, f"has {len(panel.edges)} edges; a curve may do for many"))
    _check_simple(panel, rings)
    return found


def _on_one_line(ring: Float[np.ndarray, "n 2"]) -> bool:
    """Unlike an area of 0, which the two halves of a crossed panel may also give."""
    longer, shorter = np.linalg.svd(ring - ring.mean(axis=0), compute_uv=False)
    return bool(shorter <= STRAIGHT_TOL * longer)


def _check_simple(panel: Panel, rings: list[np.ndarray]) -> None:
    """No edge meets another, holes lie inside and apart, cloth is on one side of all edges."""
    from shapely import Polygon, is_valid

    if not is_valid(Polygon(rings[0], rings[1:])):
        raise PatternError(_crossing_message(panel, rings))
    outer = panel.outline.area > 0
    for k, hole in enumerate(panel.holes):
        if (hole.area > 0) == outer:
            raise PatternError(
                f"{panel_place(panel.name)}: hole {k} runs the same way round as the outline; "
                "reverse its edges, so that the cloth lies on the same side of both"
            )


def _crossing_message(panel: Panel, rings: list[np.ndarray]) -> str:
    place = panel_place(panel.name)
    pair = _crossing_edges(panel, rings)
    if pair is None:
        return f"{place}: a hole lies outside the cloth or in another hole; move it inside"
    a, b, (x, y) = pair
    if a == b:
        return f"{place}, edge {a}: crosses itself near ({x:.1f}, {y:.1f}) cm; smooth its curve"
    return (
        f"{place}, edges {a} and {b}: cross or touch each other near ({x:.1f}, {y:.1f}) cm; "
        "move a vertex or flatten a curve so that the outline is simple"
    )


def _crossing_edges(
    panel: Panel, rings: list[np.ndarray]
) -> tuple[int, int, tuple[float, float]] | None:
    """The first two edges that meet elsewhere than at a common corner, and where."""
    import shapely

    starts = np.concatenate(rings)
    numbers = np.split(np.arange(len(starts)), np.cumsum([len(ring) for ring in rings])[:-1])
    after = np.concatenate([np.roll(own, -1) for own in numbers])
    owner = np.repeat(np.arange(len(panel.edges)), [chord_count(c) for c in panel.curves])
    segments = shapely.linestrings(np.stack([starts, starts[after]], axis=1))
    tree = shapely.STRtree(segments)
    for low in range(0, len(segments), SEGMENT_BLOCK):
        i, j = tree.query(segments[low : low + SEGMENT_BLOCK], predicate="intersects")
        i = i + low
        later = j > i
        i, j = i[later], j[later]
        meeting = shapely.intersection(segments[i], segments[j])
        corner = ((after[i] == j) | (after[j] == i)) & (shapely.get_dimensions(meeting) == 0)
        hits = np.flatnonzero(~corner)
        if len(hits):
            hit = hits[np.lexsort((j[hits], i[hits]))[0]]
            point = shapely.get_coordinates(meeting[hit])[0]
            a, b = sorted((int(owner[i[hit]]), int(owner[j[hit]])))
            return a, b, (float(point[0]), float(point[1]))
    return None


def _check_stubs(pattern: Pattern) -> list[Finding]:
    """Edges that are left over at corners."""
    found: dict[str, list[int]] = {}
    for side in sorted(stubs(pattern), key=lambda side: side.edge):
        found.setdefault(side.panel, []).append(side.edge)
    return [
        Finding(
            panel_place(panel.name),
            f"edge{'s' if len(edges) > 1 else ''} {some(edges)} {_are(edges)} shorter than "
            f"{STUB_CM:g} cm and dissolved in images and drapes: their neighbours are made to meet",
        )
        for panel in pattern.panels
        if (edges := found.get(panel.name))
    ]


def _check_lengths(pattern: Pattern, numbers: Sequence[int]) -> list[Finding]:
    found = []
    for number, stitch in zip(numbers, pattern.stitches, strict=True):
        short, long = sorted(pattern.curve(side).length for side in stitch.sides)
        if long > MAX_GATHER_RATIO * short and long - short > GATHER_SLACK:
            found.append(
                Finding(
                    f"stitch {number}",
                    f"sews {long:.1f} cm to {short:.1f} cm ({long / short:.1f} times as long); "
                    "gathers are rarely that dense",
                )
            )
    return found


def _check_assembly(pattern: Pattern) -> list[Finding]:
    """Parts that are not connected."""
    if len(pattern.panels) == 1:
        return []
    if not pattern.stitches and not pattern.onto:
        return [Finding("pattern.stitches", f"{len(pattern.panels)} panels and no stitches")]
    pieces = components(pattern)
    if len(pieces) == 1:
        return []
    loose = [name for piece in pieces for name in piece if len(piece) == 1]
    found = []
    if loose:
        found.append(
            Finding("pattern.stitches", f"{some(loose)} {_are(loose)} sewn to no other panel")
        )
    sewn = [piece[0] for piece in pieces if len(piece) > 1]
    if len(sewn) > 1:
        found.append(
            Finding(
                "pattern.stitches",
                f"{len(sewn)} garments that no stitch joins; they begin with {some(sewn)}",
            )
        )
    return found


def components(pattern: Pattern) -> list[list[str]]:
    """Names of the panels that are sewn together or onto each other, in the order of the panels."""
    number = {panel.name: k for k, panel in enumerate(pattern.panels)}
    joined = [(number[s.a.panel], number[s.b.panel]) for s in pattern.stitches]
    joined += [(number[o.panel], number[o.on]) for o in pattern.onto]
    return [
        [pattern.panels[k].name for k in members]
        for members in connected_components(len(number), joined)
    ]


def _are(things: Sequence[object]) -> str:
    return "is" if len(things) == 1 else "are"
