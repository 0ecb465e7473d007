"""Placement: a sewing pattern is put where its wearer stands.

Pattern files have their origin on the floor, near the pelvis or anywhere, and are drawn for an
unknown body. So a garment is placed by what holds it up (`support`) and by its lengths against
those of the body, never by its place in the file. Every item of clothing of a pattern is moved by
itself, not bent:

1. What hangs from the **shoulders** comes to lie with the lowest point of its shoulder seams as far
   over the body's shoulder line as in a draft for this body.
2. What hangs from the **waist** has its top edge there, a waistband above it. A top edge longer
   than the waist goes down to where the body is thick enough to hold it; trousers that are too
   short go no higher than the crotch lets them.
3. What is held by the **chest** has its top edge halfway from the bust points to the arms.
4. The body is between front and back, the back close behind it.

The whole pattern is moved sideways only where it is its own mirror image about a plane other than
x = 0: a garment may be asymmetric on purpose.

A top edge **supports** a garment only where an elastic or a belt could hold it: where it is hardly
longer than the body is round. An edge that is labelled `waist` is drawn together as by an elastic.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body, Points3
from garmentimage.drape.girths import (
    chest_level,
    shoulder,
    shoulder_seam_rise,
    trunk_girth,
    waist_height,
)
from garmentimage.drape.support import BAND, Support, SupportSite, find_support
from garmentimage.drape.world_panels import (
    WorldEdge,
    WorldPanel,
    band_height,
    below_band,
    connected_garments,
    girth_at,
    mean_height,
    panels_in_world,
    seam_length,
    without_pockets,
)
from garmentimage.errors import DraftError
from garmentimage.pattern import Circle, Loop, Panel, Pattern, Side
from garmentimage.pattern.checks import symmetry_plane

EASE = 8.0
"""A belt draws a top edge together by this much at most [cm], so it holds where the edge is no
longer than the body is round, and this."""
FRILL = 25.0  # greatest height of what stands up from the waist, wider at its top [cm]
BAND_ABOVE = 4.5
"""A waistband goes up from the waist by its height, but no more than this [cm]."""
ON_HIPS = 0.45
"""Clothes are worn on the hips down to this share of the way from the waist to the crotch."""
DRAWN_TOGETHER, TIGHT = 0.45, 3.0
"""An elastic draws cloth together to this share of its length at least. At rest, belts and elastics
are shorter than the body is round by `TIGHT` [cm]."""
ELASTIC = "waist"  # label of an edge that is drawn together at the waist
TIGHT_WITHIN = 14.0  # what holds a strapless garment lies within this below its top edge [cm]
CROTCH_ROOM = 1.0  # the crotch of trousers keeps this far below the crotch of the body [cm]
TOUCH = 1.0
"""A single strap begins so far over the shoulder [cm]: what is held beside it does not sink."""
OFF_SHOULDER = 1.3
"""Seams are compared with the shoulders out to this many times the shoulder point's distance."""
LEVEL_STEP = 1.0
"""Distance between the levels at which the body is measured below the waist [cm]."""
STATURES = (90.0, 230.0)  # statures that a pattern may be made for [cm]
DEPTH_GAP = 5.0
"""Panels that lie less far apart in depth [cm] do not distinguish front from back."""
DEPTH_ROOM = 3.0  # distance from the body that the plane of the back should have [cm]
BACK_NEARER = 4.0  # the body stands nearer to the back than midway by this at most [cm]
DEPTH_END = 0.25
"""The panels in front are those in this share of the depth of the whole garment."""


@dataclass(frozen=True, kw_only=True)
class _Hold:
    """How far up an item of clothing goes, and what holds it there."""

    shift_up: float  # how far up it was moved in all, after scaling [cm]
    edges: tuple[Side, ...]
    """The edges that are worn at its level: the free edges at its top, as a rule."""
    level: float
    """Height at which it is worn [cm]: of the neck points, or the mean of its top edge."""
    length: float = 0.0
    """Length of its top edge or, strapless, how wide it is under it, where it is tightest [cm]."""
    girth: float = 0.0
    """How far round the body is at its waist, or at the chest where it should hold [cm]."""
    is_supported: bool = False  # whether its top edge can hold it there
    drawn_length: float = 0.0
    """Length to which a belt or an elastic draws its top edge together [cm]; 0 not at the waist."""


@dataclass(frozen=True, kw_only=True)
class Placement(_Hold):
    """Where an item of clothing was put on a body, and what holds it there."""

    site: SupportSite
    reason: str  # how that was recognised, as a clause
    is_certain: bool
    """Whether the garment itself shows it; otherwise only the height in its file did."""
    panels: frozenset[str]  # names of its panels
    seams: tuple[Side, ...]  # the sides of its shoulder seams
    shift_forward: float  # how far it was moved to the front [cm]
    shift_left: float  # how far it was moved to the wearer's left, as the whole pattern was [cm]
    scale: float  # what its lengths were multiplied by


def place_on_body(
    pattern: Pattern, body: Body, *, made_for: float | None = None
) -> tuple[Pattern, tuple[Placement, ...]]:
    """The pattern, moved to where the body wears it, and where each item of clothing was put.

    Moving all of the pattern up, down, forward or back changes nothing in the result, nor does
    moving a symmetric one sideways.

    Args:
        pattern: anywhere, x = 0 in its middle or in its plane of symmetry.
        body: its landmarks `left_neck_point`, `cervical`, `left_shoulder_joint`, `waist_front` and
            `crotch` are used.
        made_for: stature that the pattern was made for [cm]: all of it is scaled to the body's
            stature. By default nothing is scaled.

    Raises:
        DraftError: `made_for` is out of range.
    """
    scale = 1.0
    if made_for is not None:
        low, high = STATURES
        if not low <= made_for <= high:
            raise DraftError(
                f"a pattern cannot be made for a stature of {made_for:g} cm; "
                f"give {low:g} to {high:g} cm"
            )
        scale = float(np.ptp(body.vertices[:, 1])) / made_for
    moved: dict[str, Panel] = {}
    found = []
    scaled = _scaled(pattern, scale)
    left = -(symmetry_plane(scaled) or 0.0)
    for part in connected_garments(_moved(scaled, (left, 0.0, 0.0))):
        placed, report = _place(part, body, scale, left)
        moved |= placed.by_name
        found.append(report)
    return replace(pattern, panels=tuple(moved[p.name] for p in pattern.panels)), tuple(found)


def _place(pattern: Pattern, body: Body, scale: float, left: float) -> tuple[Pattern, Placement]:
    # Pockets hold nothing up, and their own places in the file are not where they are sewn on.
    alone = without_pockets(pattern)
    panels = panels_in_world(alone)
    support = find_support(alone, panels, body)
    match support.site:
        case SupportSite.SHOULDERS:
            hold = _on_shoulders(panels, support, body)
        case SupportSite.WAIST:
            hold = _at_waist(alone, panels, support, body)
        case SupportSite.CHEST:
            hold = _at_chest(panels, support, body)
    report = Placement(
        **vars(hold),
        site=support.site,
        reason=support.reason,
        is_certain=support.is_certain,
        panels=frozenset(panel.name for panel in pattern.panels),
        seams=tuple(side for seam in support.seams for side in seam.sides),
        shift_forward=_forward(panels, body, hold.shift_up),
        shift_left=left,
        scale=scale,
    )
    return _moved(pattern, (0.0, report.shift_up, report.shift_forward)), report


# --- Moving --------------------------------------------------------------------------------------


def _moved(pattern: Pattern, by: tuple[float, float, float]) -> Pattern:
    if not any(by):
        return pattern
    left, up, forward = by
    places = [panel.translation for panel in pattern.panels]
    shifted = [(x + left, y + up, z + forward) for x, y, z in places]
    panels = zip(pattern.panels, shifted, strict=True)
    return replace(pattern, panels=tuple(replace(p, translation=to) for p, to in panels))


def _scaled(pattern: Pattern, scale: float) -> Pattern:
    """Panels and their places, as seen from the origin."""
    if scale == 1:
        return pattern
    panels = []
    for panel in pattern.panels:
        outline, *holes = (_scaled_loop(loop, scale) for loop in panel.loops)
        x, y, z = panel.translation
        to = (x * scale, y * scale, z * scale)
        panels.append(replace(panel, outline=outline, holes=tuple(holes), translation=to))
    onto = tuple(
        replace(sewn, offset=(sewn.offset[0] * scale, sewn.offset[1] * scale))
        for sewn in pattern.onto
    )
    pleats = tuple(replace(p, pressed=p.pressed * scale) for p in pattern.pleats)
    return replace(pattern, panels=tuple(panels), onto=onto, pleats=pleats)


def _scaled_loop(loop: Loop, scale: float) -> Loop:
    # Only circles hold a length; control points of other curves are relative to the edge.
    edges = [
        replace(edge, curvature=replace(edge.curvature, radius=edge.curvature.radius * scale))
        if isinstance(edge.curvature, Circle)
        else edge
        for edge in loop.edges
    ]
    vertices = tuple((x * scale, y * scale) for x, y in loop.vertices)
    return replace(loop, vertices=vertices, edges=tuple(edges))


# --- Height --------------------------------------------------------------------------------------


def _on_shoulders(panels: Mapping[str, WorldPanel], support: Support, body: Body) -> _Hold:
    neck = float(body.landmarks["left_neck_point"][1])
    over = _over_shoulders([seam.points for seam in support.seams], body)
    if len(over):
        up = shoulder_seam_rise(body) - float(over.min())
    else:
        # Seams beyond the shoulders, or sleeves that go up to the neckline.
        up = neck - (mean_height(support.edges) if support.edges else _highest(panels))
    sides = {bool(seam.points[:, 0].mean() > 0) for seam in support.seams}
    if len(sides) == 1:
        # Only one shoulder carries it, so that its top edge has to hold it on the other.
        return _tight_at_chest(panels, support.edges, body, up - shoulder_seam_rise(body) + TOUCH)
    return _Hold(shift_up=up, edges=_sides(support.edges), level=neck)


def _sides(edges: Sequence[WorldEdge]) -> tuple[Side, ...]:
    return tuple(edge.side for edge in edges)


def _over_shoulders(seams: Sequence[Points3], body: Body) -> Float[np.ndarray, " n"]:
    """How far the points of seams lie over the line from neck point to shoulder point [cm]."""
    if not seams:
        return np.empty(0)
    neck, end = body.landmarks["left_neck_point"], shoulder(body)
    points = np.concatenate(seams)
    away = np.abs(points[:, 0])
    on = (away >= neck[0]) & (away <= OFF_SHOULDER * end[0])
    line = np.interp(away[on], [neck[0], end[0]], [neck[1], end[1]])
    heights: np.ndarray = points[on, 1] - line
    return heights


def _highest(panels: Mapping[str, WorldPanel]) -> float:
    return max(float(e.points[:, 1].max()) for panel in panels.values() for e in panel.edges)


def _at_waist(
    pattern: Pattern, panels: Mapping[str, WorldPanel], support: Support, body: Body
) -> _Hold:
    """The top edge at the waist, or as far down as the body is thick enough to hold it."""
    waist, crotch = waist_height(body), float(body.landmarks["crotch"][1])
    edges, band = support.edges, band_height(pattern, panels, support.edges)
    length, round_waist = sum(e.length for e in edges), trunk_girth(body, waist)
    ring = below_band(pattern, panels, edges) if 0 < band <= FRILL else ()
    if ring and (narrow := sum(seam_length(pattern, e) for e in ring)) < length - EASE:
        # A frill is worn by its lower edge.
        edges, length, band = ring, narrow, 0.0
    top = mean_height(edges) if edges else _highest(panels)
    shortest = length - EASE
    labels = {pattern.by_name[e.side.panel].edges[e.side.edge].label for e in edges}
    if shortest > round_waist and labels == {ELASTIC}:
        shortest = DRAWN_TOGETHER * length
    levels = np.arange(waist, crotch, -LEVEL_STEP).tolist()
    fits = next((y for y in levels if trunk_girth(body, y) >= shortest), None)
    level = waist if fits is None else fits
    # What is shorter than the body is round is tight already.
    loose = fits is not None and length > trunk_girth(body, level)
    drawn_length = trunk_girth(body, level) - TIGHT if loose else length
    if level == waist:
        level += min(band, BAND_ABOVE) if band <= BAND else 0.0
    up = level - top
    if support.crotch is not None:
        up = min(up, crotch - CROTCH_ROOM - support.crotch)
    return _Hold(
        shift_up=up,
        edges=_sides(edges),
        level=top + up,
        length=length,
        girth=round_waist,
        is_supported=fits is not None,
        drawn_length=drawn_length,
    )


def on_hips(body: Body) -> float:
    """How far below the waist clothes that sit on the hips are worn, at most [cm]."""
    return ON_HIPS * (waist_height(body) - float(body.landmarks["crotch"][1]))


def _at_chest(panels: Mapping[str, WorldPanel], support: Support, body: Body) -> _Hold:
    """The top edge over the bust; it holds where the garment is tight enough under it."""
    level, edges = chest_level(body), support.edges
    if not edges:
        return _Hold(shift_up=level - _highest(panels), edges=(), level=level)
    up = level - max(mean_height(edges), _side_height(edges))
    return _tight_at_chest(panels, edges, body, up)


def _side_height(edges: Sequence[WorldEdge]) -> float:
    """Height of a top edge at the wearer's sides [cm]."""
    points = np.concatenate([e.points for e in edges])
    return float(points[np.abs(points[:, 0]).argmax(), 1])


def _tight_at_chest(
    panels: Mapping[str, WorldPanel], edges: tuple[WorldEdge, ...], body: Body, up: float
) -> _Hold:
    """A garment moved `up` that is held where it is tightest under its top edge at the sides."""
    side = min(_side_height(edges), chest_level(body) - up)
    heights = np.arange(side - LEVEL_STEP, side - TIGHT_WITHIN, -LEVEL_STEP).tolist()
    widths = [(girth_at(panels, y), trunk_girth(body, y + up)) for y in heights]
    widths = [(own, around) for own, around in widths if own > 0]
    hold = _Hold(shift_up=up, edges=_sides(edges), level=mean_height(edges) + up)
    if not widths:
        return hold
    length, around = min(widths, key=lambda pair: pair[0] - pair[1])
    return replace(hold, length=length, girth=around, is_supported=length <= around + EASE)


# --- Depth ---------------------------------------------------------------------------------------


def _forward(panels: Mapping[str, WorldPanel], body: Body, up: float) -> float:
    """How far the panels must go forward for the body to be between front and back [cm].

    The back comes to lie `DEPTH_ROOM` behind it, or the body midway where there is less room, and
    nearly midway where there is far more.
    """
    depths = np.array([panel.centre[2] for panel in panels.values()])
    areas = np.array([panel.area for panel in panels.values()])
    heights = np.concatenate([e.points[:, 1] for panel in panels.values() for e in panel.edges])
    low, high = _body_depths(body, heights.min() + up, heights.max() + up)
    if np.ptp(depths) < DEPTH_GAP:
        return (low + high) / 2 - float(np.average(depths, weights=areas))
    share = (depths - depths.min()) / np.ptp(depths)
    front, back = (
        float(np.average(depths[at_end], weights=areas[at_end]))
        for at_end in (share >= 1 - DEPTH_END, share <= DEPTH_END)
    )
    midway = ((front - back) - (high - low)) / 2
    return low - max(min(DEPTH_ROOM, midway), midway - BACK_NEARER) - back


def _body_depths(body: Body, bottom: float, top: float) -> tuple[float, float]:
    """Depths of the back and of the front of the trunk between two heights [cm]."""
    place = body.landmarks
    bottom, top = max(bottom, place["crotch"][1]), min(top, place["left_neck_point"][1])
    x, y, z = body.vertices.T
    trunk = z[(y >= bottom) & (y <= top) & (np.abs(x) < place["left_shoulder_joint"][0])]
    return (float(trunk.min()), float(trunk.max())) if len(trunk) else (0.0, 0.0)
