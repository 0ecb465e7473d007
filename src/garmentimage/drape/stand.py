"""Standing: a sewing pattern is put where its wearer stands.

Pattern files come with their origin on the floor or near the pelvis, drawn for a body that we do
not know, and a little off in front or behind. A pattern that stands right is left as it is; any
other is moved, not bent, by the least that puts it right:

1. Patterns round the pelvis are lifted to the floor (`floor_shift`).
2. A garment with shoulder seams hangs from the **shoulders**: the seams come to lie from
   `TOUCH` to `DRAWN_ABOVE` over the body's shoulder line, at the place where they are lowest.
3. A garment without them that ends near the waist hangs from the **waist**: its top edge goes to
   the waist, or, where it is longer than the waist, as far down as the body is thick enough to
   hold it; trousers that are too short for that go no higher than the crotch lets them.
4. Any other, a strapless dress for one, is held by the **chest**, and keeps its height where that
   is under the arms.
5. Front and back are moved forward or backward until the body is clear of both.

It is never moved sideways: a garment may be meant to be unlike on its two sides.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from garmentimage.body.body import Body
from garmentimage.body.measure import shoulder_point, taut_girth, trunk_outline
from garmentimage.errors import DraftError
from garmentimage.pattern.model import Circle, Edge, Loop, Panel, Pattern, Side
from garmentimage.raster.place import floor_shift

TOUCH, DRAWN_ABOVE = 1.0, 8.5
"""Least and greatest height of the shoulder seams over the shoulders [cm]. Cloth must come down on
the body from above; drafts are drawn higher, as the cloth goes forward over the chest."""
WAIST_BELOW, WAIST_ABOVE = 1.0, 4.5
"""A top edge that fits the waist may lie this far below or above it [cm]; bands go up from it."""
EASE = 8.0
"""A top edge holds where it is no longer than the body is round there, and this [cm]: a band that
is held at its height stands off by no more than 1.3 cm all round then."""
UNDER_ARMS = 3.0
"""A garment held by the chest ends at least so far under the shoulder joints [cm]."""
MOST_LOWERED = 12.0
"""What would have to be lowered by more for that [cm], as a hood would, is worn higher up."""
CROTCH_ROOM = 1.0
"""The crotch of trousers keeps this far below the crotch of the body [cm]."""
WAIST_LIMIT = 118.0
"""A garment that begins lower than this over the floor [cm] begins at the waist. In designs by
others waists go up to 115 cm, and garments without straps begin at 124 cm."""
STRAP_REACH = 35.0
"""Where a garment begins at the waist, seams that go further out than this [cm] are no straps: the
side seams of a circle skirt also face up."""
TOP_BAND = 8.0
"""Edges whose tops are within this of the highest are at the top together [cm]."""
OFF_SHOULDER = 1.3
"""Seams are compared with the shoulders out to this many times the shoulder point's distance."""
NEAR_AXIS = 8.0
"""A panel that comes nearer than this to the middle [cm] belongs to the trunk; sleeves do not."""
MIDDLE = 3.0
"""Points no further than this from the one nearest to the middle [cm] are in the middle."""
FACING_UP = 0.5
"""Least upward part of the unit direction in which the middle of an edge faces out of its panel."""
LEVEL_STEP = 1.0
"""Distance between the levels at which the body is measured below the waist [cm]."""
SHARES = np.linspace(0, 1, 9)
"""Where along an edge its points are taken."""
STATURES = (90.0, 230.0)
"""Statures that a pattern may be made for [cm]."""
DEPTH_GAP = 5.0
"""Panels that lie less far apart in depth [cm] do not tell front from back."""
DEPTH_END = 0.25
"""The panels in front are those in this share of the depth of the whole garment."""
BODIES_KEPT, GIRTHS_KEPT = 16, 256
"""Bodies whose shoulders are remembered, and girths of bodies."""
DEPTH_ROOM = 3.0
"""Distance from the body that the planes of front and back should have [cm]."""

Points = Float[np.ndarray, "_ 3"]


class Held(Enum):
    """What holds a garment up."""

    SHOULDERS = "shoulders"
    WAIST = "waist"
    CHEST = "chest"


@dataclass(frozen=True)
class Standing:
    """What was done to a pattern to put it on a body."""

    held: Held
    lifted: float
    """How far up the pattern was moved in all, after scaling [cm]."""
    forward: float
    """How far it was moved to the front [cm]."""
    scale: float
    """What its lengths were multiplied by."""
    around_pelvis: bool
    """Whether the file had its origin near the pelvis."""
    level: float
    """Height at which the garment is held [cm]: of the neck points, of the top edge, or of the
    highest point of a garment held by the chest."""
    opening: float
    """Length of the top edge of a garment held by the waist [cm], else 0."""


def standing(
    pattern: Pattern, body: Body, *, made_for: float | None = None
) -> tuple[Pattern, Standing]:
    """The pattern, moved to where the body wears it, and what was done.

    Args:
        pattern: in either world: feet on the floor, or the origin near the pelvis.
        body: its landmarks `left_neck_point`, `left_shoulder_joint`, `waist_front` and `crotch`
            are looked at.
        made_for: stature that the pattern was made for [cm]: all of it is scaled to the body's
            stature. Without it nothing is scaled.

    Raises:
        DraftError: `made_for` is no stature.
    """
    stature = float(np.ptp(body.vertices[:, 1]))
    scale = 1.0 if made_for is None else stature / _checked(made_for)
    shift = floor_shift(pattern)
    placed = _scaled(_moved(pattern, shift, 0.0), scale)
    pieces = _pieces(placed)
    held, up, level, opening = _hold(placed, pieces, body)
    forward = _forward(pieces, body, up)
    report = Standing(held, shift * scale + up, forward, scale, shift > 0, level, opening)
    return _moved(placed, up, forward), report


def _checked(stature: float) -> float:
    low, high = STATURES
    if not low <= stature <= high:
        raise DraftError(
            f"a pattern cannot be made for a stature of {stature:g} cm; give {low:g} to {high:g} cm"
        )
    return stature


# --- Moving --------------------------------------------------------------------------------------


def _moved(pattern: Pattern, up: float, forward: float) -> Pattern:
    if up == forward == 0:
        return pattern
    return replace(pattern, panels=tuple(_moved_panel(p, up, forward) for p in pattern.panels))


def _moved_panel(panel: Panel, up: float, forward: float) -> Panel:
    x, y, z = panel.translation
    return replace(panel, translation=(x, y + up, z + forward))


def _scaled(pattern: Pattern, scale: float) -> Pattern:
    """Panels and their places, as seen from the middle of the floor."""
    if scale == 1:
        return pattern
    return replace(pattern, panels=tuple(_scaled_panel(p, scale) for p in pattern.panels))


def _scaled_panel(panel: Panel, scale: float) -> Panel:
    x, y, z = panel.translation
    return replace(
        panel,
        outline=_scaled_loop(panel.outline, scale),
        holes=tuple(_scaled_loop(hole, scale) for hole in panel.holes),
        translation=(x * scale, y * scale, z * scale),
    )


def _scaled_loop(loop: Loop, scale: float) -> Loop:
    return replace(
        loop,
        vertices=tuple((x * scale, y * scale) for x, y in loop.vertices),
        edges=tuple(_scaled_edge(edge, scale) for edge in loop.edges),
    )


def _scaled_edge(edge: Edge, scale: float) -> Edge:
    """Only arcs hold a length; control points are relative to the edge."""
    if not isinstance(edge.curvature, Circle):
        return edge
    return replace(edge, curvature=replace(edge.curvature, radius=edge.curvature.radius * scale))


# --- What holds the garment ----------------------------------------------------------------------


@dataclass(frozen=True)
class _Edge:
    """An edge of an outline in the world."""

    side: Side
    points: Points
    faces_up: bool


@dataclass(frozen=True)
class _Piece:
    """A panel in the world."""

    edges: tuple[_Edge, ...]
    centre: Float[np.ndarray, " 3"]
    area: float

    @property
    def on_trunk(self) -> bool:
        return min(float(np.abs(e.points[:, 0]).min()) for e in self.edges) < NEAR_AXIS


_Pieces = Mapping[str, _Piece]


def _pieces(pattern: Pattern) -> _Pieces:
    return {panel.name: _piece(panel) for panel in pattern.panels}


def _piece(panel: Panel) -> _Piece:
    outline, matrix, area = panel.outline, panel.matrix, panel.outline.area
    flat = np.concatenate([curve.at(SHARES) for curve in outline.curves])
    points = (flat @ matrix[:, :2].T + panel.translation).reshape(len(outline.edges), -1, 3)
    middle = len(SHARES) // 2
    along = (
        flat.reshape(len(points), -1, 2)[:, middle + 1]
        - flat.reshape(len(points), -1, 2)[:, middle - 1]
    )
    # The outer side of an edge is on its right where the loop runs counter-clockwise.
    up = (along[:, 1] * matrix[1, 0] - along[:, 0] * matrix[1, 1]) * np.sign(area)
    faces_up = up > FACING_UP * np.hypot(along[:, 0], along[:, 1])
    edges = tuple(
        _Edge(Side(panel.name, k), points[k], bool(faces_up[k])) for k in range(len(points))
    )
    low, high = points.min((0, 1)), points.max((0, 1))
    return _Piece(edges, (low + high) / 2, abs(area))


def _hold(pattern: Pattern, pieces: _Pieces, body: Body) -> tuple[Held, float, float, float]:
    """What holds the garment, how far it has to go up, its level then, its opening [cm]."""
    edges = _top_edges(pattern, pieces)
    top = _middle_top(edges, pieces)
    over = _over_shoulders(_shoulder_seams(pattern, pieces, top), body)
    if len(over):
        up = _into(float(over.min()), TOUCH, DRAWN_ABOVE)
        return Held.SHOULDERS, up, float(body.landmarks["left_neck_point"][1]), 0.0
    if top >= WAIST_LIMIT:
        up = min(float(body.landmarks["left_shoulder_joint"][1]) - UNDER_ARMS - top, 0.0)
        up = up if up > -MOST_LOWERED else 0.0
        return Held.CHEST, up, top + up, 0.0
    opening = sum(pattern.curve(edge.side).length for edge in edges)
    up = _to_waist(top, opening, body)
    crotch = _crotch(pattern, pieces, top)
    if crotch is not None:
        up = min(up, float(body.landmarks["crotch"][1]) - CROTCH_ROOM - crotch)
    return Held.WAIST, up, top + up, opening


def _into(value: float, low: float, high: float) -> float:
    """The least that must be added to bring a value between two others."""
    return float(np.clip(value, low, high)) - value


def _top_edges(pattern: Pattern, pieces: _Pieces) -> list[_Edge]:
    """The free edges at the top of a garment that face up."""
    edges = [
        edge
        for piece in pieces.values()
        for edge in piece.edges
        if edge.faces_up and edge.side not in pattern.partners
    ]
    tops = [edge.points[:, 1].max() for edge in edges]
    return [edge for edge, top in zip(edges, tops) if top > max(tops) - TOP_BAND]


def _middle_top(edges: list[_Edge], pieces: _Pieces) -> float:
    """Height of the top edges where they are nearest to the middle [cm]; the highest if unlike.

    The waist of a circle skirt lies deep in the middle of its panels. Where no top edge is free,
    as under a hood, it is the highest point.
    """
    if not edges:
        return max(float(e.points[:, 1].max()) for piece in pieces.values() for e in piece.edges)
    points = np.concatenate([edge.points for edge in edges])
    away = np.abs(points[:, 0])
    return float(points[away <= away.min() + MIDDLE, 1].max())


def _shoulder_seams(pattern: Pattern, pieces: _Pieces, top: float) -> list[Points]:
    """The seams between front and back of the trunk that face up, as points."""
    reach = np.inf if top >= WAIST_LIMIT else STRAP_REACH
    found = []
    for stitch in pattern.stitches:
        a, b = (pieces[side.panel] for side in stitch.sides)
        if a.centre[2] * b.centre[2] >= 0 or not (a.on_trunk and b.on_trunk):
            continue
        sides = [
            piece.edges[s.edge]
            for piece, s in zip((a, b), stitch.sides)
            if s.edge < len(piece.edges)
        ]
        if len(sides) < 2 or not all(edge.faces_up for edge in sides):
            continue
        points = np.concatenate([edge.points for edge in sides])
        if points[:, 1].min() > WAIST_LIMIT and np.abs(points[:, 0]).max() < reach:
            found.append(points)
    highest = max((float(points[:, 1].max()) for points in found), default=0.0)
    return [points for points in found if points[:, 1].max() > highest - TOP_BAND]


def _over_shoulders(seams: list[Points], body: Body) -> Float[np.ndarray, " n"]:
    """How far the points of seams lie over the line from neck point to shoulder point [cm]."""
    if not seams:
        return np.empty(0)
    neck, shoulder = body.landmarks["left_neck_point"], _shoulder(body)
    points = np.concatenate(seams)
    away = np.abs(points[:, 0])
    on = (away >= neck[0]) & (away <= OFF_SHOULDER * shoulder[0])
    line = np.interp(away[on], [neck[0], shoulder[0]], [neck[1], shoulder[1]])
    return points[on, 1] - line


@lru_cache(maxsize=BODIES_KEPT)
def _shoulder(body: Body) -> Float[np.ndarray, " 3"]:
    return shoulder_point(body)


def _to_waist(top: float, opening: float, body: Body) -> float:
    """How far up a top edge must go to lie where it holds [cm].

    That is looked for from the waist down to halfway to the crotch. A top edge too long for all of
    it is meant to be drawn together at the waist.
    """
    waist, crotch = (float(body.landmarks[name][1]) for name in ("waist_front", "crotch"))
    levels = np.arange(waist, (waist + crotch) / 2, -LEVEL_STEP).tolist()
    level = next((y for y in levels if _girth(body, y) >= opening - EASE), waist)
    if level == waist:
        return _into(top, waist - WAIST_BELOW, waist + WAIST_ABOVE)
    return level - top


@lru_cache(maxsize=GIRTHS_KEPT)
def _girth(body: Body, height: float) -> float:
    """Girth of the trunk [cm]."""
    return taut_girth(trunk_outline(body, height)[:, [0, 2]])


def _crotch(pattern: Pattern, pieces: _Pieces, top: float) -> float | None:
    """Height of the lowest corner where a seam between the wearer's sides meets an inseam [cm].

    An inseam joins front and back of one leg. Hems and waists have no such corner.
    """
    heights = []
    for piece in pieces.values():
        kinds = [_joins(pattern, pieces, edge.side) for edge in piece.edges]
        for k, edge in enumerate(piece.edges):
            if {kinds[k - 1], kinds[k]} == {"sides", "inseam"}:
                heights.append(float(edge.points[0, 1]))
    return min((y for y in heights if y < top), default=None)


def _joins(pattern: Pattern, pieces: _Pieces, side: Side) -> str:
    """What an edge is sewn to: across the "sides" of the wearer, by an "inseam", or else."""
    partner = pattern.partners.get(side)
    if partner is None:
        return "nothing"
    (x, _, z), (u, _, w) = pieces[side.panel].centre, pieces[partner.panel].centre
    if x * u < 0 and min(abs(x), abs(u)) > MIDDLE:
        return "sides"
    return "inseam" if z * w < 0 else "other"


# --- Depth ---------------------------------------------------------------------------------------


def _forward(pieces: _Pieces, body: Body, up: float) -> float:
    """How far the panels must go forward for the body to be between front and back [cm].

    The least that gives both `DEPTH_ROOM`, or the same where there is less for them.
    """
    depths = np.array([piece.centre[2] for piece in pieces.values()])
    areas = np.array([piece.area for piece in pieces.values()])
    if np.ptp(depths) < DEPTH_GAP:
        return 0.0
    share = (depths - depths.min()) / np.ptp(depths)
    front, back = (
        float(np.average(depths[at_end], weights=areas[at_end]))
        for at_end in (share >= 1 - DEPTH_END, share <= DEPTH_END)
    )
    heights = np.concatenate([e.points[:, 1] for piece in pieces.values() for e in piece.edges])
    low, high = _body_depths(body, heights.min() + up, heights.max() + up)
    room = min(DEPTH_ROOM, ((front - back) - (high - low)) / 2)
    return _into(0.0, high + room - front, low - room - back)


def _body_depths(body: Body, bottom: float, top: float) -> tuple[float, float]:
    """Depths of the back and of the front of the trunk between two heights [cm]."""
    place = body.landmarks
    bottom, top = max(bottom, place["crotch"][1]), min(top, place["left_neck_point"][1])
    x, y, z = body.vertices.T
    trunk = z[(y >= bottom) & (y <= top) & (np.abs(x) < place["left_shoulder_joint"][0])]
    return (float(trunk.min()), float(trunk.max())) if len(trunk) else (0.0, 0.0)
