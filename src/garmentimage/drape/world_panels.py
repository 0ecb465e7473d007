"""Panels in 3D before they are meshed: outlines, openings, sides of the wearer.

Words of this file:

- An **opening** is a connected line of free edges, once the panels are sewn: a neckline, a hem.
- An opening is **one-sided** where it lies on one side of the wearer, as that of a sleeve does.
- A panel lies on the **trunk** where it comes near the middle; sleeves do not.
- The **crotch** is where a seam between the wearer's sides meets an inseam.

Nothing here depends on where the origin of the pattern's file is, but for the middle plane (x = 0).
"""

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from garmentimage.body import Points3
from garmentimage.geometry import connected_components
from garmentimage.pattern import Panel, Pattern, Side
from garmentimage.pattern.checks import components

NEAR_AXIS = 8.0
"""A panel that comes nearer than this to the middle [cm] belongs to the trunk; sleeves do not."""
MIDDLE = 3.0
"""A panel whose middle lies within this of the plane of symmetry [cm] is on neither side."""
OVER_MIDDLE = 0.15
"""A one-sided opening goes over the middle by this share of its reach at most."""
FACING = 0.5
"""Least upward part of the unit direction in which the middle of an edge that faces up faces out of
its panel; the same downward."""
SHARES = np.linspace(0, 1, 9)  # where along an edge its points are taken


@dataclass(frozen=True, eq=False)
class WorldEdge:
    """An edge of a panel in the world."""

    side: Side
    points: Points3
    length: float  # [cm]
    up: float
    """Upward part of the unit direction in which its middle faces out of the panel."""

    @property
    def faces_up(self) -> bool:
        """By its middle."""
        return self.up > FACING


@dataclass(frozen=True, eq=False)
class WorldPanel:
    """A panel in the world."""

    flat: Panel  # as it is drawn
    edges: tuple[WorldEdge, ...]  # numbered as the panel's: outer loop first, then holes
    centre: Float[np.ndarray, " 3"]  # middle of its bounding box [cm]
    area: float  # [cm²]

    @property
    def on_trunk(self) -> bool:
        """Whether it comes near the middle."""
        return min(float(np.abs(e.points[:, 0]).min()) for e in self.edges) < NEAR_AXIS


@dataclass(frozen=True, eq=False)
class Opening:
    """A connected line of free edges."""

    edges: tuple[WorldEdge, ...]

    @cached_property
    def points(self) -> Points3:
        """Points along its edges."""
        return np.concatenate([e.points for e in self.edges])

    @cached_property
    def height(self) -> float:
        """Mean height, by length [cm]."""
        return mean_height(self.edges)

    @cached_property
    def one_sided(self) -> bool:
        """Whether it lies on one side of the wearer."""
        low, high = float(self.points[:, 0].min()), float(self.points[:, 0].max())
        return min(-low, high) < OVER_MIDDLE * max(-low, high)


def mean_height(edges: Sequence[WorldEdge]) -> float:
    """Mean height of edges, by length [cm]."""
    heights = [float(np.trapezoid(e.points[:, 1], SHARES)) for e in edges]
    return float(np.average(heights, weights=[max(e.length, 1e-9) for e in edges]))


def panels_in_world(pattern: Pattern) -> Mapping[str, WorldPanel]:
    """Every panel in the world, by name."""
    return {panel.name: _world_panel(panel) for panel in pattern.panels}


def _world_panel(panel: Panel) -> WorldPanel:
    matrix = panel.matrix
    middle = len(SHARES) // 2
    edges: list[WorldEdge] = []
    for k, loop in enumerate(panel.loops):
        # The outer side of an edge is on its right where its loop runs counter-clockwise, and a
        # hole's lies within the hole.
        turn = np.sign(loop.area) * (1 if k == 0 else -1)
        for curve in loop.curves:
            flat = curve.at(SHARES)
            along = flat[middle + 1] - flat[middle - 1]
            up = turn * (along[1] * matrix[1, 0] - along[0] * matrix[1, 1])
            up = float(up / max(np.hypot(*along), 1e-12))
            points = flat @ matrix[:, :2].T + panel.translation
            edges.append(WorldEdge(Side(panel.name, len(edges)), points, curve.length, up))
    points = np.concatenate([e.points for e in edges])
    return WorldPanel(
        panel, tuple(edges), (points.min(0) + points.max(0)) / 2, abs(panel.outline.area)
    )


def connected_garments(pattern: Pattern) -> list[Pattern]:
    """The items of clothing of a pattern, each all sewn together, in the order of the file."""
    return [
        Pattern(
            tuple(panel for panel in pattern.panels if panel.name in names),
            tuple(stitch for stitch in pattern.stitches if stitch.a.panel in names),
            pattern.name,
            tuple(sewn for sewn in pattern.onto if sewn.panel in names),
            tuple(pleat for pleat in pattern.pleats if pleat.panel in names),
        )
        for names in map(set, components(pattern))
    ]


def sewn_on_panels(pattern: Pattern) -> frozenset[str]:
    """Names of the panels that are sewn onto others, and of those that are stitched to them."""
    sewn_on = {sewn.panel for sewn in pattern.onto}
    parts = components(replace(pattern, onto=())) if sewn_on else []
    return frozenset(name for names in parts if sewn_on & set(names) for name in names)


def without_pockets(pattern: Pattern) -> Pattern:
    """The garment without what is sewn onto it."""
    over = sewn_on_panels(pattern)
    left = tuple(panel for panel in pattern.panels if panel.name not in over)
    stitches = tuple(stitch for stitch in pattern.stitches if stitch.a.panel not in over)
    pleats = tuple(pleat for pleat in pattern.pleats if pleat.panel not in over)
    plain = replace(pattern, panels=left, stitches=stitches, onto=(), pleats=pleats)
    return plain if over else pattern


def openings_of(pattern: Pattern, panels: Mapping[str, WorldPanel]) -> list[Opening]:
    """The openings of a garment."""
    # The start of side k has the number 2 k, its end 2 k + 1. Ends are joined where sides follow
    # each other round a loop, where they are sewn, and along free edges.
    number = {side: 2 * k for k, side in enumerate(pattern.sides())}
    free = [e for p in panels.values() for e in p.edges if e.side not in pattern.partners]
    joined = [(number[e.side], number[e.side] + 1) for e in free]
    for panel in pattern.panels:
        first = 0
        for loop in panel.loops:
            own = [number[Side(panel.name, first + k)] for k in range(len(loop.edges))]
            joined += [(own[k - 1] + 1, own[k]) for k in range(len(own))]
            first += len(own)
    for stitch in pattern.stitches:
        a, b, turn = number[stitch.a], number[stitch.b], int(not stitch.same_direction)
        joined += [(a, b + turn), (a + 1, b + 1 - turn)]
    lines = connected_components(2 * len(number), joined)
    line_of = {end: k for k, line in enumerate(lines) for end in line}
    found: dict[int, list[WorldEdge]] = {}
    for edge in free:
        found.setdefault(line_of[number[edge.side]], []).append(edge)
    return [Opening(tuple(edges)) for edges in found.values()]


def crotch_of(pattern: Pattern, panels: Mapping[str, WorldPanel], top: float) -> float | None:
    """Height of the lowest crotch corner under `top` [cm]; None where there is none.

    An inseam joins front and back of one leg. Hems and waists have no such corner.
    """
    heights = []
    for panel in panels.values():
        count = len(panel.flat.outline.edges)
        kinds = [_joins(pattern, panels, edge.side) for edge in panel.edges[:count]]
        for k, edge in enumerate(panel.edges[:count]):
            if {kinds[k - 1], kinds[k]} == {"sides", "inseam"}:
                heights.append(float(edge.points[0, 1]))
    return min((y for y in heights if y < top), default=None)


def _joins(pattern: Pattern, panels: Mapping[str, WorldPanel], side: Side) -> str:
    """What an edge is sewn to: across the "sides" of the wearer, by an "inseam", or else."""
    partner = pattern.partners.get(side)
    if partner is None:
        return "nothing"
    (x, _, z), (u, _, w) = panels[side.panel].centre, panels[partner.panel].centre
    if x * u < 0 and min(abs(x), abs(u)) > MIDDLE:
        return "sides"
    middle = midway_depth(panels)
    return "inseam" if (z - middle) * (w - middle) < 0 else "other"


def midway_depth(panels: Mapping[str, WorldPanel]) -> float:
    """Depth halfway between the panels furthest in front and furthest behind [cm]."""
    depths = [float(panel.centre[2]) for panel in panels.values()]
    return (min(depths) + max(depths)) / 2


def girth_at(panels: Mapping[str, WorldPanel], height: float) -> float:
    """How wide the panels are at a height, all together [cm]."""
    total = 0.0
    for panel in panels.values():
        points = panel.flat.to_world(panel.flat.outline.polygon)
        a, b = points, np.roll(points, -1, axis=0)
        crosses = (a[:, 1] > height) != (b[:, 1] > height)
        share = (height - a[crosses, 1]) / (b[crosses, 1] - a[crosses, 1])
        hits = a[crosses] + share[:, None] * (b[crosses] - a[crosses])
        normal = panel.flat.matrix[:, 2]
        along = np.sort(hits @ [normal[2], 0.0, -normal[0]])
        total += float((along[1::2] - along[::2]).sum())
    return total


def band_height(
    pattern: Pattern, panels: Mapping[str, WorldPanel], edges: Sequence[WorldEdge]
) -> float:
    """How high the panels are that end in these edges above, and are sewn to others below [cm].

    0 where one of them is not sewn to others below.
    """
    heights = [0.0]
    lower = below_band(pattern, panels, edges)
    for name in dict.fromkeys(edge.side.panel for edge in edges):
        below = [e for e in lower if e.side.panel == name]
        if not below:
            return 0.0
        # The mean height of a curved band: its area over the mean length of its two edges.
        around = sum(e.length for e in (*(e for e in edges if e.side.panel == name), *below))
        heights.append(2 * panels[name].area / max(around, 1e-9))
    return max(heights)


def below_band(
    pattern: Pattern, panels: Mapping[str, WorldPanel], edges: Sequence[WorldEdge]
) -> tuple[WorldEdge, ...]:
    """The lower edges of the waistband that ends in these edges above."""
    names = dict.fromkeys(edge.side.panel for edge in edges)
    return tuple(e for n in names for e in panels[n].edges if _goes_down(pattern, e, names))


def seam_length(pattern: Pattern, edge: WorldEdge) -> float:
    """Length of an edge, or of what it is gathered to where that is shorter [cm]."""
    partner = pattern.partners.get(edge.side)
    return edge.length if partner is None else min(edge.length, pattern.curve(partner).length)


def _goes_down(pattern: Pattern, edge: WorldEdge, names: Container[str]) -> bool:
    """Whether an edge is sewn to what is below a band, none of whose panels it is."""
    partner = pattern.partners.get(edge.side)
    return edge.up < 0 and partner is not None and partner.panel not in names
