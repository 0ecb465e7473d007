"""A garment as cloth: every panel as triangles, joined where stitches join the panels.

One edge length serves the whole garment. Each edge of a panel is cut by arc length into equal
parts, as many as the edge it is sewn to; a gathered seam has the parts of its longer side. Where
cloth is narrow (bands, straps) the parts are shorter, so that two rows of triangles lie across.

Words of this file: the **parts** of a side are the straight lines that stand for it; a part is
**closed** when the stitches make its two ends one vertex.
"""

from collections.abc import Mapping, Sequence
from math import ceil, sqrt

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.mesh.pleated import slit_at_folds
from garmentimage.drape.mesh.triangulate import cloth_widths, split_sides, triangulate
from garmentimage.errors import DrapeError, quoted
from garmentimage.geometry import Curve, component_labels, polyline_length
from garmentimage.pattern import Panel, Pattern, Side

DEFAULT_VERTICES = 2000  # vertices of a garment by default
MIN_VERTICES, MAX_VERTICES = 50, 100_000
"""Bounds of the number of vertices that a caller may choose."""
MAX_PANELS, MAX_EDGES, MAX_CLOTH = 500, 5_000, 40.0
"""Panels, edges and cloth [m²] of a garment that is draped. With the most cloth in designs by
others it has 8 m²; more of any would take minutes, and suggests wrong units or a tracing."""
MAX_OFFSET = 1e5
"""Distance of a panel's vertices from its origin [cm]; farther off, triangles lose their shape."""
MIN_EDGE_LENGTH, MAX_EDGE_LENGTH = 0.3, 6.0
"""Bounds of the edge length [cm]: finer than the thickness kept between cloth and skin adds
no detail, coarser no sleeve goes round a wrist. A tiny garment has fewer vertices than chosen, a
huge one more."""
COUNT_TOL = 0.1
"""Share by which the number of vertices may miss the target before the garment is meshed again."""
MAX_ATTEMPTS = 5  # attempts to meet the number of vertices, and to free a panel of faults
CELL = sqrt(3) / 2
"""Area of cloth that a vertex of a hexagonal lattice stands for, in squared edge lengths."""
LENGTH_LOSS = 0.01  # share of a curve's length that its parts may lose
FINER = 4  # times that a curve is cut finer at most to keep its length
NARROW_SHARE = 0.25
"""Edge length in narrow cloth, in its widths: two rows of equilateral triangles."""
MIN_NARROW_SHARE = 0.5  # least edge length in narrow cloth, as a share of the garment's
SHORT = 0.5
"""Edges longer than this, in edge lengths, have two parts: a strap ends there, or a band."""
CLOSED_PARTS = 3  # parts of a side whose ends are one vertex; three make a round opening

Triangles = tuple[Float[np.ndarray, "_ 2"], Int[np.ndarray, "_ 3"]]
"""One panel's points and faces, counter-clockwise."""


def mesh(pattern: Pattern, *, vertices: int = DEFAULT_VERTICES) -> Cloth:
    """Cut a garment into triangles and sew them.

    Args:
        pattern: a garment that passes `check_pattern`.
        vertices: how many to make once sewn; met within a tenth unless the edge length
            reaches a bound (0.3 or 6 cm) or the panels have more vertices by themselves, see
            `explain_vertex_count`.

    Raises:
        DrapeError: a garment too large for any body, or a panel that has no triangles; names the
            panel.
    """
    check_size(pattern)
    if not MIN_VERTICES <= vertices <= MAX_VERTICES:
        raise DrapeError(f"{vertices} vertices; choose {MIN_VERTICES} to {MAX_VERTICES}")
    slit = slit_at_folds(pattern)
    length = _first_length(pattern, vertices)
    for _ in range(MAX_ATTEMPTS):
        cloth = _mesh(slit.pattern, length)
        better = _bounded(length * sqrt(cloth.vertex_count / vertices))
        if better == length or abs(cloth.vertex_count / vertices - 1) < COUNT_TOL:
            break
        length = better
    return slit.whole(cloth, pattern)


def explain_vertex_count(count: int, wanted: int) -> str:
    """Why a cloth has another number of vertices than was chosen; empty where it is met."""
    if abs(count / wanted - 1) <= COUNT_TOL:
        return ""
    why = (
        f"edges shorter than {MIN_EDGE_LENGTH:g} cm would add no detail"
        if count < wanted
        else f"its outlines have so many, and edges are no longer than {MAX_EDGE_LENGTH:g} cm"
    )
    return f"the cloth has {count} vertices instead of {wanted}: {why}"


def check_size(pattern: Pattern) -> None:
    """Refuse what is too large to be a garment, or to be draped in reasonable time.

    Raises:
        DrapeError: says what it has too much of.
    """
    panels, edges = pattern.panels, sum(len(p.edges) for p in pattern.panels)
    if len(panels) > MAX_PANELS:
        raise DrapeError(
            f"it has {len(panels)} panels; at most {MAX_PANELS} can be draped: take fewer garments"
        )
    if edges > MAX_EDGES:
        largest = max(panels, key=lambda p: len(p.edges))
        raise DrapeError(
            f"it has {edges} edges, {len(largest.edges)} of them round panel "
            f"{quoted(largest.name)}; at most {MAX_EDGES} can be draped: trace it in longer "
            "steps, or make one curve of edges that go on smoothly"
        )
    for panel in panels:
        away = float(np.abs(panel.outline.polygon).max())
        if away > MAX_OFFSET:
            raise DrapeError(
                f"panel {quoted(panel.name)} lies {away:.3g} cm from its own origin, where numbers "
                f"are too coarse; move its vertices within {MAX_OFFSET:g} cm"
            )
    cloth = sum(abs(p.outline.area) for p in panels) / 1e4
    if cloth > MAX_CLOTH:
        raise DrapeError(
            f"it has {cloth:.3g} m² of cloth, more than any garment ({MAX_CLOTH:g}): its units "
            "are others; check properties.units_in_meter, which is 100 for cm and 1000 for mm"
        )


def _first_length(pattern: Pattern, vertices: int) -> float:
    """Edge length h that gives about so many vertices [cm].

    A lattice has area / (CELL h²) of them; half a row more lies along each free edge.
    """
    area = sum(abs(p.outline.area) - sum(abs(h.area) for h in p.holes) for p in pattern.panels)
    free = sum(pattern.curve(s).length for s in pattern.sides() if s not in pattern.partners)
    row = free / 4 / vertices
    return _bounded(row + sqrt(row * row + area / (CELL * vertices)))


def _bounded(length: float) -> float:
    return min(max(length, MIN_EDGE_LENGTH), MAX_EDGE_LENGTH)


def _mesh(pattern: Pattern, length: float) -> Cloth:
    """The garment with one edge length [cm]."""
    parts = _parts(pattern, length)
    for _ in range(MAX_ATTEMPTS):
        rings = [_rings(p, parts) for p in pattern.panels]
        widths = [float(np.median(cloth_widths(r))) for r in rings]
        spacings = [_part_length(width, length) for width in widths]
        meshes = [triangulate(r, h) for r, h in zip(rings, spacings, strict=True)]
        made = [m for m in meshes if m is not None]
        if len(made) == len(meshes):
            cloth = _sewn(pattern, parts, made)
            faulty = [
                side
                for side, corners in cloth.sides.items()
                if np.any(cloth.vertex[corners[1:]] == cloth.vertex[corners[:-1]])
            ]
            if not faulty:
                return _sewn(pattern, parts, _opened(cloth, made))
            finer = {side: CLOSED_PARTS * parts[side] for side in faulty}
        else:
            faulty = [
                Side(p.name, k)
                for p, m in zip(pattern.panels, meshes, strict=True)
                for k in range(len(p.edges))
                if m is None
            ]
            finer = {side: 2 * parts[side] for side in faulty}
        parts = _shared(pattern, {**parts, **finer})
    raise DrapeError(
        f"panel {quoted(faulty[0].panel)} cannot be cut into triangles near edge "
        f"{faulty[0].edge}: it crosses itself there, or its stitches tie it to itself"
    )


def _parts(pattern: Pattern, length: float) -> dict[Side, int]:
    """How many parts each side has; the same on both sides of a stitch."""
    first = {s: max(1, round(pattern.curve(s).length / length)) for s in pattern.sides()}
    own: dict[Side, int] = {}
    for panel in pattern.panels:
        sides = [Side(panel.name, k) for k in range(len(panel.edges))]
        ends = np.cumsum([first[side] for side in sides])[:-1]
        widths = np.split(cloth_widths(_rings(panel, first)), ends)
        for side, curve, width in zip(sides, panel.curves, widths, strict=True):
            own[side] = _part_count(curve, _part_length(float(np.median(width)), length))
    return _shared(pattern, own)


def _part_length(width: float, length: float) -> float:
    """Length of the parts along cloth of some width [cm]."""
    return min(max(width * NARROW_SHARE, MIN_NARROW_SHARE * length), length)


def _part_count(curve: Curve, length: float) -> int:
    """Parts of about a length for a curve: two where it is not short, more where it bends."""
    count = max(round(curve.length / length), 2 if curve.length > SHORT * length else 1)
    if curve.is_straight:
        return count
    loss = max(1 - polyline_length(curve.sample(count)) / curve.length, 0.0)
    return ceil(count * min(max(sqrt(loss / LENGTH_LOSS), 1.0), FINER))


def _shared(pattern: Pattern, own: Mapping[Side, int]) -> dict[Side, int]:
    """The greater number of parts for both sides of each stitch."""
    partners = pattern.partners
    return {side: max(count, own[partners.get(side, side)]) for side, count in own.items()}


def _rings(panel: Panel, parts: Mapping[Side, int]) -> list[Float[np.ndarray, "_ 2"]]:
    """The loops of a panel as polygons of so many parts [cm]."""
    rings, first = [], 0
    for loop in panel.loops:
        runs = [
            curve.sample(parts[Side(panel.name, first + k)])[:-1]
            for k, curve in enumerate(loop.curves)
        ]
        rings.append(np.concatenate(runs))
        first += len(runs)
    return rings


def _corners(panel: Panel, parts: Mapping[Side, int], first: int) -> dict[Side, np.ndarray]:
    """Corners along each edge of a panel whose corners are numbered from `first`."""
    corners: dict[Side, np.ndarray] = {}
    for loop in panel.loops:
        start = first
        for _ in loop.edges:
            side = Side(panel.name, len(corners))
            corners[side] = np.arange(first, first + parts[side] + 1)
            first += parts[side]
        corners[side][-1] = start
    return corners


def _sewn(pattern: Pattern, parts: Mapping[Side, int], meshes: Sequence[Triangles]) -> Cloth:
    """The panels' triangles as one cloth."""
    counts = [len(points) for points, _ in meshes]
    firsts = [0, *np.cumsum(counts).tolist()]
    sides: dict[Side, np.ndarray] = {}
    faces = []
    for panel, first, (_, own) in zip(pattern.panels, firsts[:-1], meshes, strict=True):
        sides |= _corners(panel, parts, first)
        faces.append(own + first if panel.outline.area > 0 else own[:, ::-1] + first)
    return Cloth(
        pattern=pattern,
        flat=np.concatenate([points for points, _ in meshes]),
        faces=np.concatenate(faces),
        panel=np.repeat(np.arange(len(counts)), counts),
        vertex=_vertices(pattern, sides, firsts[-1]),
        sides=sides,
    )


def _vertices(
    pattern: Pattern, sides: Mapping[Side, np.ndarray], count: int
) -> Int[np.ndarray, " corner"]:
    """The vertex of each corner: numbers in the order of first corners."""
    joins = [
        np.stack([sides[s.a], sides[s.b] if s.same_direction else sides[s.b][::-1]], axis=1)
        for s in pattern.stitches
    ]
    joined = np.concatenate([np.zeros((0, 2), np.int64), *joins])
    return component_labels(count, joined).astype(np.int64)


def _opened(cloth: Cloth, made: Sequence[Triangles]) -> list[Triangles]:
    """The panels' triangles with every side cut in two whose ends are one vertex.

    Else a triangle beside it would be a line: at the tip of a cone, whose legs are sewn together.
    """
    ends = np.concatenate([cloth.faces[:, (k, (k + 1) % 3)] for k in range(3)])
    closed = ends[cloth.vertex[ends[:, 0]] == cloth.vertex[ends[:, 1]]]
    sides = np.unique(np.sort(closed, axis=1), axis=0)
    opened = list(made)
    for k in np.unique(cloth.panel[sides[:, 0]]).tolist():
        first = int(np.searchsorted(cloth.panel, k))
        own = sides[cloth.panel[sides[:, 0]] == k] - first
        points, faces = made[k]
        opened[k] = split_sides(points, faces, [(i, j) for i, j in own.tolist()])
    return opened
