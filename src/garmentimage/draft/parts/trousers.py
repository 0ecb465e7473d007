"""Trousers in four panels, and the legs of a jumpsuit.

Coordinates of a leg: x = 0 is the middle of the body, y = 0 the waist, the wearer's side at x > 0.
The crotch reaches over the middle by a share of the hip girth, twice as far behind as in front.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

from garmentimage.body import BodyMeasurements
from garmentimage.draft import rules
from garmentimage.draft.assemble import Assembly
from garmentimage.draft.designs import TrousersDesign
from garmentimage.draft.panel import (
    BACK,
    FACINGS,
    FRONT,
    GAP,
    HANDLE,
    LEFT,
    RIGHT,
    SIDES,
    NamedCurve,
    Outline,
    PanelDraft,
    Seam,
    layer_depth,
    length,
    lerp,
    lines,
    placed,
)
from garmentimage.draft.parts.bodice import BelowWaist, BodiceBlock
from garmentimage.geometry import Bezier, Curve, Point

CROTCH_REACH = {FRONT: 1 / 18, BACK: 1 / 9}
"""How far the crotch reaches over the middle, in hip girths."""
WAIST_LEAN = {FRONT: 1.0, BACK: 3.0}
"""How far the middle seam leans over at the waist [cm]."""
WAIST_RISE = {FRONT: 0.0, BACK: 2.5}
"""How far the middle rises over the side at the waist [cm]."""
BACK_LEG_EXTRA = 2.0
"""How much wider than the front the back of a leg is [cm]."""
CROTCH_HANDLE = 0.6
"""How far the crotch curve continues straight at both ends, as a share of its height and reach."""
CROTCH_LIFT = 0.05
"""How much it rises towards the middle, as a share of its height."""
SHORT_LEG = 6.0
"""A leg continues below the knee as an edge of its own from this length on [cm]."""
JUMPSUIT_RISE = 3.0
"""How much deeper than that of trousers the crotch of a jumpsuit lies [cm]."""
JUMPSUIT_THIGH = 1.5
"""How much wider than the thigh the legs of a jumpsuit are [cm]."""
LEG_APART = 1.0
"""Least distance of the legs of a jumpsuit from the body's middle at the hem [cm]."""
SEAM_STEPS = 50
"""Most steps that make the inside seams equally long; each divides the rest by about ten."""
SEAM_EXACT = 1e-6
"""How exactly they are [cm]."""


class Leg(NamedTuple):
    """Outer and inner line of one leg panel."""

    inner: Outline
    """From the crotch down to the hem."""
    outer: Outline
    """From the hem up to the hip."""


def add_trousers(
    garment: Assembly,
    body: BodyMeasurements,
    design: TrousersDesign,
    waist: float | None = None,
) -> dict[str, Seam]:
    """Draw trousers: four panels.

    Args:
        garment: takes the panels.
        body: measurements.
        design: the legs.
        waist: length of the straight edge that they are sewn to, in front and behind [cm];
            default: they hang from the body's waist, the middle behind rises to hold them.

    Returns:
        Their upper edges by facing, in loop order.

    Raises:
        DraftError: the thigh does not pass.
    """
    # The middle behind rises over the side, and stays clear of a waistband.
    height = body.waist_height - GAP - (max(WAIST_RISE.values()) if waist is None else 0.0)
    panels: dict[tuple[str, str], PanelDraft] = {}
    inner_seam: float | None = None
    thigh = 0.0
    for facing in FACINGS:
        outline = leg_outline(body, design, facing, waist, inner_seam)
        inner_seam = length(n for n in outline if n.label == "inseam")
        reach = -min(n.curve.start[0] for n in outline)
        thigh += reach + _hip_width(body, design)
        for side in SIDES:
            x = reach + GAP / 2 if side == LEFT else -reach - GAP / 2
            origin = (x, height, layer_depth(body))
            name = f"{side}_trouser_{facing}"
            panels[facing, side] = placed(name, outline, facing, origin, side=side, label="leg")
    garment.add(*panels.values())
    rules.check_thigh(thigh, body.thigh_girth)
    for side in SIDES:
        for label in ("inseam", "side_seam"):
            garment.sew(panels[FRONT, side].seam(label), panels[BACK, side].seam(label))
    for facing in FACINGS:
        garment.sew(*(panels[facing, side].seam("crotch") for side in SIDES))
    return {
        FRONT: panels[FRONT, LEFT].seam("waist") + panels[FRONT, RIGHT].seam("waist"),
        BACK: panels[BACK, RIGHT].seam("waist") + panels[BACK, LEFT].seam("waist"),
    }


def leg_outline(
    body: BodyMeasurements,
    design: TrousersDesign,
    facing: str,
    waist: float | None,
    inner_seam: float | None,
) -> Outline:
    """One leg panel, from the crotch down the inside seam and round.

    Args:
        body: measurements.
        design: the legs.
        facing: front or back.
        waist: as for `add_trousers` [cm].
        inner_seam: length that the inside seam is to have [cm]; default: as drafted.
    """
    hip = (_hip_width(body, design), body.hip_height - body.waist_height)
    if waist is None:
        # Front and back share the corner at the side, so that their side seams are equal.
        whole = (body.waist_girth + rules.WAIST_EASE) / 2 + sum(WAIST_LEAN.values())
        corner, middle = (whole / 2, 0.0), (WAIST_LEAN[facing], WAIST_RISE[facing])
    else:
        corner, middle = (waist / 2, 0.0), (0.0, 0.0)
    crotch = (-CROTCH_REACH[facing] * body.hip_girth, _crotch_level(body, design))
    axis = (hip[0] - CROTCH_REACH[FRONT] * body.hip_girth) / 2
    lines_of = LegLines(body, design, hip, axis, BACK_LEG_EXTRA if facing == BACK else 0.0)
    leg = lines_of.leg(crotch)
    if inner_seam is not None:
        for _ in range(SEAM_STEPS):
            excess = length(leg.inner) - inner_seam
            if abs(excess) <= SEAM_EXACT:
                break
            crotch = (crotch[0], crotch[1] - excess)
            leg = lines_of.leg(crotch)
    return (
        *leg.inner,
        *lines("hem", leg.inner[-1].curve.end, leg.outer[0].curve.start),
        *leg.outer,
        NamedCurve("side_seam", hip_curve(hip, corner)),
        *lines("waist", corner, middle),
        *crotch_seam(middle, hip[1], crotch),
    )


def crotch_seam(waist: Point, hip_level: float, crotch: Point) -> Outline:
    """The middle seam: straight from the waist to the hip, then round to the crotch."""
    turn = (0.0, hip_level)
    dx, dy = turn[0] - waist[0], turn[1] - waist[1]
    onward = CROTCH_HANDLE * (hip_level - crotch[1])
    first = (turn[0] - onward * dx / dy, hip_level - onward)
    second = (crotch[0] * (1 - CROTCH_HANDLE), crotch[1] + CROTCH_LIFT * (hip_level - crotch[1]))
    return (
        *lines("crotch", waist, turn),
        NamedCurve("crotch", Bezier(turn, (first, second), crotch)),
    )


def hip_curve(hip: Point, waist: Point) -> Curve:
    """The side seam from the hip, which it passes upright, up to the waist: hardly curved."""
    upright = (hip[0], hip[1] + HANDLE * (waist[1] - hip[1]))
    return Bezier(hip, (upright, lerp(waist, hip, HANDLE)), waist)


@dataclass(frozen=True)
class LegLines:
    """The lines of one leg panel below the hip; y = 0 is the waist [cm]."""

    body: BodyMeasurements
    design: TrousersDesign
    hip: Point
    """Where the side seam passes the hip."""
    axis: float
    """x of the middle of the leg, its crease."""
    extra: float = 0.0
    """How much wider it is on the inside."""
    apart: float | None = None
    """Least x of the inside; default: none."""

    def leg(self, crotch: Point) -> Leg:
        """The leg whose inside seam begins at `crotch`."""
        body, design = self.body, self.design
        level = _crotch_level(body, design)
        knee = body.knee_height - body.waist_height
        hem = level - design.leg_length * (body.crotch_height - body.ankle_height)
        quarter, flare = (body.knee_girth + design.knee_ease) / 4, design.leg_flare / 4
        if hem < knee - SHORT_LEG:
            inner_knee, outer_knee = self._row(quarter, knee)
            inner_hem, outer_hem = self._row(quarter + flare, hem)
            below = lines("inseam", inner_knee, inner_hem)
            above = lines("side_seam", outer_hem, outer_knee)
            return Leg(
                (NamedCurve("inseam", _inner(crotch, inner_knee, inner_hem)), *below),
                (*above, NamedCurve("side_seam", _outer(outer_knee, self.hip, outer_hem))),
            )
        # A hem above the knee: on the way from the thigh to the knee.
        share = min((level - hem) / (level - knee), 1.0)
        narrowed = share * (2 - share)
        (inner_x, _), (outer_x, _) = self._row(quarter, knee)
        inner_hem = (crotch[0] + narrowed * (inner_x - crotch[0]) - share * flare, hem)
        outer_hem = (self.hip[0] + narrowed * (outer_x - self.hip[0]) + share * flare, hem)
        if self.apart is not None:
            inner_hem = (max(inner_hem[0], self.apart), hem)
        return Leg(
            (NamedCurve("inseam", _inner(crotch, inner_hem, inner_hem)),),
            (NamedCurve("side_seam", _outer(outer_hem, self.hip, outer_hem)),),
        )

    def _row(self, quarter: float, y: float) -> tuple[Point, Point]:
        """Inner and outer point at the height y, `quarter` away from the axis."""
        axis = self.axis
        if self.apart is not None:
            axis = max(axis, quarter + self.apart)
        return (axis - quarter - self.extra, y), (axis + quarter, y)


def legs_below_waist(block: BodiceBlock, design: TrousersDesign) -> BelowWaist:
    """Both legs in one panel with the bodice: a jumpsuit's lower part."""
    body = block.body
    deeper = replace(design, crotch_ease=design.crotch_ease + JUMPSUIT_RISE)
    width = max(
        (body.hip_girth + design.hip_ease) / 4,
        (body.thigh_girth + JUMPSUIT_THIGH) / 2,
        block.waist[0],
    )
    # The cloth that passes between the legs of trousers lies at the side here, below the hip.
    crotch = (0.0, _crotch_level(body, deeper))
    hip = (width, (block.hip[1] + crotch[1]) / 2)
    leg = LegLines(body, deeper, hip, width / 2, apart=LEG_APART).leg(crotch)
    rise = -hip[1]
    to_waist = Bezier(
        hip, ((hip[0], hip[1] + 0.35 * rise), (block.waist[0], -0.4 * rise)), block.waist
    )
    half = (
        *leg.inner,
        *lines("hem", leg.inner[-1].curve.end, leg.outer[0].curve.start),
        *leg.outer,
        NamedCurve("side_seam", to_waist),
    )
    return lambda _: half


def _hip_width(body: BodyMeasurements, design: TrousersDesign) -> float:
    return (body.hip_girth + design.hip_ease) / 4


def _crotch_level(body: BodyMeasurements, design: TrousersDesign) -> float:
    return body.crotch_height - body.waist_height - design.crotch_ease


def _inner(crotch: Point, below: Point, hem: Point) -> Bezier:
    """The inside seam from the crotch down, hollowed out; it continues straight to the hem."""
    upper = lerp(crotch, below, HANDLE)
    return Bezier(crotch, (upper, _onward(hem, below, HANDLE * (crotch[1] - below[1]))), below)


def _outer(below: Point, hip: Point, hem: Point) -> Bezier:
    """The side seam from below up to the hip, which it passes upright."""
    rise = hip[1] - below[1]
    return Bezier(
        below, (_onward(hem, below, HANDLE * rise), (hip[0], hip[1] - HANDLE * rise)), hip
    )


def _onward(hem: Point, knee: Point, rise: float) -> Point:
    """The line from the hem through the knee, `rise` above the knee; upright without a hem."""
    if hem == knee:
        return knee[0], knee[1] + rise
    return knee[0] + rise * (knee[0] - hem[0]) / (knee[1] - hem[1]), knee[1] + rise
