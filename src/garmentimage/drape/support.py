"""What holds a garment up, recognised by its shape and not by its place in the file.

1. A garment that arms leave through openings of their own hangs from the **shoulders**; so does a
   poncho, whose seams face up like those of a circle skirt, but whose top edge is shorter.
2. Any other hangs from the **waist** or, as a strapless dress, from the **chest**: the panels at
   its top are named, its crotch lies nearer or farther below its top, its top edge is too short
   for the chest, or it widens at once, or it is narrow where the waist lies.
3. Where none of that decides, the height in its file does, which is not certain.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from garmentimage.body import Body, Points3
from garmentimage.drape.girths import bust_height, chest_level, trunk_girth, waist_height
from garmentimage.drape.world_panels import (
    FACING,
    Opening,
    WorldEdge,
    WorldPanel,
    band_height,
    crotch_of,
    girth_at,
    mean_height,
    midway_depth,
    openings_of,
)
from garmentimage.pattern import Pattern, Side, floor_shift

BOTTOM = re.compile(r"skirt|pant|trouser|waist|(^|_)wb(_|$)|leg(_|$)|shorts", re.IGNORECASE)
"""Names of panels whose top edge is worn at the waist."""
TOP = re.compile(r"torso|bodice|bust|chest|dress|corset|strapless|bandeau", re.IGNORECASE)
"""Names of panels whose top edge is worn at the chest."""
TOO_SHORT_AT_WAIST = 0.88
"""Without armholes, seams that face up are those of a circle skirt, whose top edge is at
least this share of the waist, or of a poncho."""
TOP_BAND = 8.0
"""Edges whose tops are within this of the highest are at the top together [cm]."""
TOO_SHORT = 0.92  # a top edge shorter than this share of the bust is not worn there
CROTCH_TO_CHEST = 0.95
"""Trousers that reach up to the chest are as long above the crotch as this share of the body."""
FLARED, FLARED_BELOW = 1.12, 10.0
"""A garment that is so many times as wide as its top edge this far below it [cm] is a skirt."""
BAND = 12.0  # panels at the top that are lower than this are a waistband [cm]
WAISTED, WAIST_BELOW = 0.95, (10.0, 35.0)
"""A garment that is narrower than this share of its top so far below it [cm] has a waist."""
HEM = 3.0  # edges that are curved keep within this of their height at the sides [cm]


class SupportSite(Enum):
    """What holds a garment up."""

    SHOULDERS = "shoulders"
    WAIST = "waist"
    CHEST = "chest"


@dataclass(frozen=True, eq=False)
class ShoulderSeam:
    """A seam over a shoulder, in the world."""

    sides: tuple[Side, Side]
    points: Points3  # on the sides that face up


@dataclass(frozen=True, eq=False)
class Support:
    """What holds a garment up, and how that is known."""

    site: SupportSite
    reason: str  # how it was recognised, as a clause
    is_certain: bool  # whether the garment itself shows it; otherwise the height in its file did
    edges: tuple[WorldEdge, ...]  # the free edges at its top
    seams: tuple[ShoulderSeam, ...]  # its shoulder seams
    crotch: float | None  # height of its crotch [cm]


def find_support(pattern: Pattern, panels: Mapping[str, WorldPanel], body: Body) -> Support:
    """What holds up a garment that is all sewn together."""
    openings = openings_of(pattern, panels)
    highest = max(float(e.points[:, 1].max()) for p in panels.values() for e in p.edges)
    crotch = crotch_of(pattern, panels, highest)
    edges = _top_edges(openings)
    seams = _shoulder_seams(pattern, panels)
    arms = _arms(openings, crotch)
    if arms and not seams:
        # One of the two panels may stand askew in the file.
        seams = _shoulder_seams(pattern, panels, sides_up=1)
    if arms and (seams or any(not panel.on_trunk for panel in panels.values())):
        reason = "arms leave it through openings of their own"
        return Support(SupportSite.SHOULDERS, reason, True, edges, seams, crotch)
    named = _named(pattern, edges)
    length = sum(edge.length for edge in edges)
    round_waist = trunk_girth(body, waist_height(body))
    if named is None and seams and 0 < length < TOO_SHORT_AT_WAIST * round_waist:
        reason = f"its seams face up and its top edge of {length:.0f} cm is too short for the waist"
        return Support(SupportSite.SHOULDERS, reason, False, edges, seams, crotch)
    site, reason, is_certain = named or _waist_or_chest(pattern, panels, edges, crotch, body)
    return Support(site, reason, is_certain, edges, (), crotch)


def _arms(openings: Sequence[Opening], crotch: float | None) -> list[Opening]:
    """One-sided openings that are not trouser legs.

    Legs are the lowest on each side, where there is a crotch and no hem round both.
    """
    sided = [o for o in openings if o.one_sided]
    legged = crotch is not None and all(
        o.points[:, 1].min() > crotch for o in openings if not o.one_sided
    )
    if not legged:
        return sided
    legs = []
    for side in (1, -1):
        own = [o for o in sided if side * o.points[:, 0].mean() > 0]
        legs += sorted(own, key=lambda o: o.height)[:1]
    return [o for o in sided if o not in legs]


def _shoulder_seams(
    pattern: Pattern, panels: Mapping[str, WorldPanel], *, sides_up: int = 2
) -> tuple[ShoulderSeam, ...]:
    """The highest seams between front and back of the trunk that face up, on as many sides."""
    found, middle = [], midway_depth(panels)
    for stitch in pattern.stitches:
        a, b = (panels[side.panel] for side in stitch.sides)
        if (a.centre[2] - middle) * (b.centre[2] - middle) >= 0:
            continue
        sides = [panels[side.panel].edges[side.edge] for side in stitch.sides]
        up = [edge.points for edge in sides if edge.faces_up]
        if a.on_trunk and b.on_trunk and len(up) >= sides_up:
            found.append(ShoulderSeam(stitch.sides, np.concatenate(up)))
    highest = max((float(seam.points[:, 1].max()) for seam in found), default=0.0)
    return tuple(seam for seam in found if seam.points[:, 1].max() > highest - TOP_BAND)


def _top_edges(openings: Sequence[Opening]) -> tuple[WorldEdge, ...]:
    """The edges of the topmost opening; those at its top, where it reaches down to a hem."""
    if not openings:
        return ()
    middle = [o for o in openings if not o.one_sided] or openings
    top = max(middle, key=lambda o: o.height)
    if len(middle) > 1 or all(edge.up > -FACING for edge in top.edges):
        return top.edges
    high = [edge for edge in top.edges if edge.faces_up] or list(top.edges)
    highest = max(float(edge.points[:, 1].max()) for edge in high)
    return tuple(edge for edge in high if edge.points[:, 1].max() > highest - TOP_BAND)


def _named(pattern: Pattern, edges: Sequence[WorldEdge]) -> tuple[SupportSite, str, bool] | None:
    """What the names of the panels at the top say, if they do."""
    panels = [pattern.by_name[name] for name in dict.fromkeys(e.side.panel for e in edges)]
    waist = [p.name for p in panels if BOTTOM.search(p.name) or p.label == "leg"]
    chest = [p.name for p in panels if TOP.search(p.name)]
    for site, named in ((SupportSite.WAIST, waist), (SupportSite.CHEST, chest)):
        if named:
            return site, f"panel {named[0][:40]!r} at its top is named for the {site.value}", True
    return None


def _waist_or_chest(
    pattern: Pattern,
    panels: Mapping[str, WorldPanel],
    edges: tuple[WorldEdge, ...],
    crotch: float | None,
    body: Body,
) -> tuple[SupportSite, str, bool]:
    waist, bust = waist_height(body), bust_height(body)
    top = mean_height(edges) if edges else 0.0
    height = top + floor_shift(pattern)
    in_file = SupportSite.WAIST if height < (waist + bust) / 2 else SupportSite.CHEST
    length = sum(e.length for e in edges)
    if edges and length < TOO_SHORT * trunk_girth(body, bust):
        reason = f"its top edge of {length:.0f} cm is too short for the chest"
        return SupportSite.WAIST, reason, True
    if edges and crotch is not None:
        rise, least = top - crotch, chest_level(body) - float(body.landmarks["crotch"][1])
        reason = f"its crotch lies {rise:.0f} cm below its top edge"
        if rise < CROTCH_TO_CHEST * least:
            return SupportSite.WAIST, reason, True
        # A low crotch, else.
        return in_file, reason, in_file is SupportSite.CHEST
    if edges and girth_at(panels, top - FLARED_BELOW) > FLARED * length:
        return SupportSite.WAIST, "it widens at once below its top edge", True
    if 0 < band_height(pattern, panels, edges) <= BAND:
        return SupportSite.WAIST, "it has a waistband", True
    narrow = _narrowest(panels, edges, top)
    if narrow is not None:
        return SupportSite.CHEST, f"it narrows to {narrow:.0f} cm below its top edge", True
    return in_file, f"its top edge lies {height:.0f} cm over the floor in its file", False


def _narrowest(
    panels: Mapping[str, WorldPanel], edges: Sequence[WorldEdge], top: float
) -> float | None:
    """How wide the panels at the top are where they are narrow as at a waist [cm], if they are.

    Others may lie apart from them in the file, with gaps between.
    """
    upper = {edge.side.panel: panels[edge.side.panel] for edge in edges}
    heights = {n: np.concatenate([e.points[:, 1] for e in p.edges]) for n, p in upper.items()}
    lowest = max((float(y.min()) for y in heights.values()), default=top)
    levels = np.arange(top - WAIST_BELOW[0], max(top - WAIST_BELOW[1], lowest + HEM), -2.0)
    widths = [girth_at(upper, y) for y in levels.tolist()]
    if not widths or min(widths) >= WAISTED * girth_at(upper, top - HEM):
        return None
    return min(widths)
