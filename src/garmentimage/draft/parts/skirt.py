"""Skirts in gores: two, four, six or eight panels, flared or gathered.

Coordinates of a gore: x = 0 is its own middle, y = 0 the waist.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import hypot

from garmentimage.body import BodyMeasurements
from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import PleatDesign, SkirtDesign
from garmentimage.draft.panel import (
    BACK,
    FACINGS,
    FRONT,
    GAP,
    HANDLE,
    STRAIGHT,
    NamedCurve,
    Outline,
    PanelDraft,
    Seam,
    layer_depth,
    lerp,
    lines,
    mirrored,
    placed,
)
from garmentimage.draft.parts.pleats import folded_width, pleated_waist, press_pleats
from garmentimage.errors import DraftError
from garmentimage.geometry import Bezier, Curve, Line, Point

HIP_EASE = 4.0
"""How much wider than the hip a skirt is [cm]."""
BELOW_HIP = 2.0
"""Least length of a skirt below the hip [cm]."""
GORE_NAMES = {
    1: ("",),
    2: ("right_", "left_"),
    3: ("right_", "middle_", "left_"),
    4: ("right_side_", "right_", "left_", "left_side_"),
}
"""Names of the gores of a front, from the wearer's right to the left."""


@dataclass(frozen=True)
class Gore:
    """The lines that all gores of a skirt share [cm]."""

    top: float
    """Half the width at the waist."""
    hip: float
    """Half the width at the hip."""
    hip_drop: float
    """From the waist down to the hip; 0 where the skirt hangs straight from the waist."""
    flare: float

    def corner(self, drop: float) -> Point:
        """The lower end of the side seam for a hem `drop` below the waist, along the seam."""
        below = (drop - self.hip_drop) / hypot(1.0, self.flare)
        return self.hip + self.flare * below, -self.hip_drop - below

    def side(self, drop: float) -> Outline:
        """The side seam at x >= 0, from the hem up to the waist."""
        hip, waist = (self.hip, -self.hip_drop), (self.top, 0.0)
        lower = lines("side_seam", self.corner(drop), hip)
        if self.hip_drop == 0:
            return lower
        near_hip = (hip[0] + HANDLE * hip[1] * self.flare, (1 - HANDLE) * hip[1])
        near_waist = lerp(waist, hip, HANDLE)
        return (*lower, NamedCurve("side_seam", Bezier(hip, (near_hip, near_waist), waist)))

    def outline(self, minus_drop: float, plus_drop: float, waist: Outline) -> Outline:
        """A gore whose side seams end `minus_drop` and `plus_drop` below the waist."""
        minus, plus = self.side(minus_drop), self.side(plus_drop)
        (mx, my), (px, py) = self.corner(minus_drop), self.corner(plus_drop)
        low = -(minus_drop + plus_drop) / 2
        return (
            NamedCurve("hem", _hem((-mx, my), (px, py), low)),
            *plus,
            *waist,
            *mirrored(minus),
        )


def _hem(start: Point, end: Point, low: float) -> Curve:
    """From corner to corner, at height `low` in its middle."""
    middle = (start[1] + end[1]) / 2
    if abs(middle - low) < STRAIGHT:
        return Line(start, end)
    return Bezier(start, (((start[0] + end[0]) / 2, 2 * low - middle),), end)


def add_skirt(
    garment: Assembly,
    body: BodyMeasurements,
    design: SkirtDesign,
    waist: dict[str, float] | None = None,
    pleats: PleatDesign | None = None,
) -> dict[str, Seam]:
    """Draw a skirt.

    Args:
        garment: takes the panels.
        body: measurements.
        design: the skirt.
        waist: length of what it is sewn to, by facing [cm]; default: the body's waist with ease.
        pleats: pleats in each gore; default: none.

    Returns:
        Its upper edges by facing, in loop order.

    Raises:
        DraftError: it does not reach below the hip.
    """
    count = design.gores // 2
    if waist is None:
        waist = {f: (body.waist_girth + rules.WAIST_EASE) / 2 for f in FACINGS}
    waists = {f: design.skirt_fullness * waist[f] / count for f in FACINGS}
    folded = folded_width(pleats) if pleats else 0.0
    tops = {f: (w + folded) / 2 for f, w in waists.items()}
    hip = (body.hip_girth + HIP_EASE) / design.gores / 2 + folded / 2
    hip_drop = body.waist_height - body.hip_height
    if max(tops.values()) >= hip:
        # A gathered skirt is wide enough for the hip from its top on.
        hip, hip_drop = max(tops.values()), 0.0
    drop = design.skirt_length * body.waist_height
    # Seams from the wearer's right (-1) to the left (+1), the same for front and back.
    drops = [drop + design.skirt_slant * (2 * k / count - 1) for k in range(count + 1)]
    if min(drops) < hip_drop + BELOW_HIP:
        raise DraftError(
            f"the skirt ends {min(drops):.1f} cm below the waist, the hip lies {hip_drop:.1f} cm "
            "below it; make skirt_length larger or skirt_slant smaller"
        )
    rows: dict[str, list[PanelDraft]] = {}
    for facing in FACINGS:
        gore = Gore(tops[facing], hip, hip_drop, design.skirt_flare)
        across = 2 * gore.corner(max(drops))[0] + GAP
        rows[facing] = []
        for k, name in enumerate(GORE_NAMES[count]):
            ends = (drops[k], drops[k + 1])
            top = gore.top, 0.0
            edge = (
                pleated_waist(waists[facing], pleats)
                if pleats
                else lines("waist", top, (-gore.top, 0.0))
            )
            outline = gore.outline(*(ends if facing == FRONT else ends[::-1]), edge)
            x = (k - (count - 1) / 2) * across
            origin = (x, body.waist_height - GAP, layer_depth(body))
            rows[facing].append(placed(f"{name}skirt_{facing}", outline, facing, origin))
        garment.add(*rows[facing])
        if pleats:
            for panel in rows[facing]:
                press_pleats(garment, panel, pleats, drop)
    _sew_sides(garment, rows[FRONT], rows[BACK])
    return {
        FRONT: tuple(ref for panel in reversed(rows[FRONT]) for ref in panel.seam("waist")),
        BACK: tuple(ref for panel in rows[BACK] for ref in panel.seam("waist")),
    }


def _sew_sides(garment: Assembly, front: list[PanelDraft], back: list[PanelDraft]) -> None:
    """Sew neighbours to each other, round the body; panels go from the right to the left."""
    for right, left in pairwise(front):
        garment.sew(_at(right, plus=True), _at(left, plus=False))
    for right, left in pairwise(back):
        garment.sew(_at(right, plus=False), _at(left, plus=True))
    garment.sew(_at(front[-1], plus=True), _at(back[-1], plus=False))
    garment.sew(_at(front[0], plus=False), _at(back[0], plus=True))


def _at(panel: PanelDraft, *, plus: bool) -> Seam:
    """The side seam of a gore at positive or at negative x."""
    seam = panel.seam("side_seam")
    half = [r for r in seam if (panel.outline[r.number].curve.end[0] > 0) == plus]
    return tuple(half)
