"""The bodice: front and back of the trunk, from the neck to the waist and beyond.

Coordinates of a half: x = 0 is the middle of the body, y = 0 the waist. The proportions are those
of the block that tailors draft: a fifth of the neck girth for width and depth of the neckline, a
quarter of the girths for each half, the armhole hollowed out to the width across chest or back.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import hypot, sqrt

from garmentimage.body import BodyMeasurements
from garmentimage.draft import rules
from garmentimage.draft.designs import (
    WAIST_DARTS,
    BodiceDesign,
    CutoutDesign,
    DartDesign,
    HemDesign,
    NeckDesign,
)
from garmentimage.draft.panel import (
    FRONT,
    GAP,
    LEFT,
    SIDES,
    STRAIGHT,
    NamedCurve,
    Outline,
    PanelDraft,
    closed,
    layer_depth,
    lerp,
    lines,
    other,
    placed,
    plus_side,
    whole,
)
from garmentimage.draft.parts.darts import with_side_dart, with_waist_darts
from garmentimage.errors import DraftError
from garmentimage.geometry import Bezier, Curve, Line, Point
from garmentimage.pattern import Loop, loop_from_curves

BACK_NECK_RISE = 2.0
"""The neck point of a draft lies so much above the middle of the back neck [cm]."""
NECK_SHARE = 1 / 5
"""Width of half the neck, as a share of the neck girth ..."""
NECK_TRIM = 0.2
"""... less this [cm]."""
STEEPEST_SHOULDER = 0.6
"""Most fall of a shoulder seam, as a share of its length."""
HIP_EASE_LEAST = 4.0
"""A hem at the hip or below is wider than the hip by at least this [cm]."""
SHORT_SIDE = 4.0
"""A side seam continues below the hip as an edge of its own from this length on [cm]."""
ROUND = 0.5523
"""Length of the handles of a quarter circle drawn as a cubic, in radii."""
BOAT_WIDTH = 2.5
"""How much farther from the neck a boat neckline lies [cm] ..."""
BOAT_DEPTH = 0.5
"""... and how deep it is, as a share of the depth of the others."""
SQUARE_TAPER = 0.12
"""A square neckline is narrower at its corners than at the shoulder by this share."""


BelowWaist = Callable[[str], Outline]
"""Draws what lies below the waist on one side of the wearer: from the middle round, ending with
the side seam. It ends at the waist, or anywhere below the armpit."""


@dataclass(frozen=True)
class BodiceBlock:
    """The lines of a bodice on one body, before front and back part."""

    body: BodyMeasurements
    bodice: BodiceDesign
    neck: NeckDesign
    intake: float = 0.0
    """What waist darts take out of each half [cm]; the waist is so much wider."""

    @cached_property
    def neck_point(self) -> Point:
        """Where neck and shoulder meet on the body."""
        width = NECK_SHARE * self.body.neck_base_girth - NECK_TRIM
        return width, self.body.back_waist_length + BACK_NECK_RISE

    @cached_property
    def slope(self) -> Point:
        """Unit direction of the shoulder seam, from the neck outwards."""
        body = self.body
        fall = (body.neck_point_height - body.shoulder_height) / body.shoulder_length
        fall = min(fall, STEEPEST_SHOULDER)
        return sqrt(1 - fall * fall), -fall

    @cached_property
    def shoulder_ends(self) -> tuple[float, float]:
        """Where the shoulder seam begins and ends, from the neck point along the shoulder [cm]."""
        boat = BOAT_WIDTH if self.neck.neckline == "boat" else 0.0
        reach = self.bodice.shoulder_reach * self.body.shoulder_length
        return self.neck.neck_width + boat, reach

    @cached_property
    def strap(self) -> Point:
        """Inner end of the shoulder seam."""
        return self._on_shoulder(self.shoulder_ends[0])

    @cached_property
    def shoulder(self) -> Point:
        """Outer end of the shoulder seam."""
        return self._on_shoulder(self.shoulder_ends[1])

    @cached_property
    def armpit(self) -> Point:
        """Where side seam and armhole meet."""
        width = (self.body.bust_girth + self.bodice.bust_ease) / 4
        depth = self.body.armscye_depth + self.bodice.armhole_ease
        return width, self.body.back_waist_length - depth

    @cached_property
    def waist(self) -> Point:
        """Where the side seam passes the waist."""
        close = (self.body.waist_girth + self.bodice.bust_ease) / 4
        straight = max(self.armpit[0], close)
        width = straight + self.bodice.waist_shaping * (close - straight)
        return max(width, close + self.intake), 0.0

    @cached_property
    def hip(self) -> Point:
        """Where the side seam passes the hip."""
        body = self.body
        least = (body.hip_girth + max(self.bodice.bust_ease / 2, HIP_EASE_LEAST)) / 4
        return max(least, self.waist[0]), body.hip_height - body.waist_height

    @cached_property
    def bust(self) -> Point:
        """The bust point."""
        return self.body.bust_point_distance / 2, self.body.bust_height - self.body.waist_height

    @cached_property
    def depth(self) -> float:
        """Distance of front and back panels from the body's middle [cm]."""
        return layer_depth(self.body)

    def width(self, drop: float, flare: float) -> float:
        """Half the width at a distance below the waist, or above it where negative [cm]."""
        (hip, hip_level), (waist, _), (armpit, top) = self.hip, self.waist, self.armpit
        if drop <= 0:
            return waist + (armpit - waist) * -drop / top
        share = min(drop / -hip_level, 1.0)
        below = max(drop + hip_level, 0.0)
        return waist + (hip - waist) * share * share * (3 - 2 * share) + flare * below

    def _on_shoulder(self, along: float) -> Point:
        (x, y), (dx, dy) = self.neck_point, self.slope
        return x + along * dx, y + along * dy


def below_waist(block: BodiceBlock, hem: HemDesign, drop: float) -> BelowWaist:
    """Down to a hem at `drop` cm below the waist (above it where negative)."""

    def half(side: str) -> Outline:
        slant = hem.hem_slant if side == LEFT else -hem.hem_slant
        # The hem hangs from the side seam: where that is flared, it is as long as the middle line.
        hip_level, own_drop = -block.hip[1], drop + slant
        turn = hypot(1.0, hem.flare)
        steep = hip_level + (own_drop - hip_level) / turn if own_drop > hip_level else own_drop
        corner = (block.width(steep, hem.flare), -steep)
        slope = -slant / block.width(drop, hem.flare)
        return (
            NamedCurve("hem", hem_curve((0.0, -drop), corner, slope)),
            *side_below_waist(block, corner, hem.flare),
        )

    return half


def side_below_waist(block: BodiceBlock, corner: Point, flare: float) -> Outline:
    """The side seam from the hem's corner up to the waist; nothing where the hem is near it."""
    (wx, wy), (hx, hy), y = block.waist, block.hip, corner[1]
    if y > wy - SHORT_SIDE:
        return ()
    bottom, lean = (corner, 0.0) if y > hy - SHORT_SIDE else ((hx, hy), flare)
    rise = wy - bottom[1]
    curve = Bezier(
        bottom,
        ((bottom[0] - 0.35 * rise * lean, bottom[1] + 0.35 * rise), (wx, wy - 0.4 * rise)),
        (wx, wy),
    )
    upper = (NamedCurve("side_seam", curve),)
    return upper if bottom == corner else (*lines("side_seam", corner, bottom), *upper)


def hem_curve(middle: Point, corner: Point, slope: float) -> Curve:
    """From the middle, where it has the given slope, to the corner at the side."""
    control = (0.5 * corner[0], middle[1] + 0.5 * slope * corner[0])
    if abs(corner[1] - middle[1] - slope * corner[0]) < STRAIGHT:
        return Line(middle, corner)
    return Bezier(middle, (control,), corner)


def to_waist(block: BodiceBlock) -> BelowWaist:
    """Nothing below the waist: its edge is sewn to a skirt or to trousers."""
    return lambda _: lines("waist", (0.0, 0.0), block.waist)


def half_bodice(
    block: BodiceBlock, below: BelowWaist, facing: str, side: str, darts: DartDesign | None
) -> Outline:
    """A half from the lower end of the middle line round to the neck."""
    lower = below(side)
    half = (*lower, *upper_half(block, facing, lower[-1].curve.end))
    if darts is None:
        return half
    count = WAIST_DARTS[darts.front_darts if facing == FRONT else darts.back_darts]
    if count:
        half = with_waist_darts(half, darts, count, block.bust)
    return (
        with_side_dart(half, darts, block.bust) if facing == FRONT and darts.has_side_dart else half
    )


def trunk(
    block: BodiceBlock,
    below: BelowWaist,
    facing: str,
    *,
    split: bool = False,
    darts: DartDesign | None = None,
    cutout: CutoutDesign | None = None,
) -> tuple[PanelDraft, ...]:
    """The front or the back of a garment: one panel, or two that meet in the middle."""
    halves = {side: half_bodice(block, below, facing, side, darts) for side in SIDES}
    plus = plus_side(facing)
    height = block.body.waist_height
    if not split:
        holes = cutout_holes(block, cutout) if cutout and cutout.cutout == facing else ()
        outline = whole(halves[plus], halves[other(plus)], facing)
        return (placed(facing, outline, facing, (0.0, height, block.depth), holes=holes),)
    middle = "cf" if facing == FRONT else "cb"
    panels = []
    for side in SIDES:
        origin = (GAP / 2 if side == LEFT else -GAP / 2, height, block.depth)
        outline = closed(halves[side], middle)
        panels.append(placed(f"{side}_{facing}", outline, facing, origin, side=side))
    return tuple(panels)


def cutout_holes(block: BodiceBlock, design: CutoutDesign) -> tuple[Loop, ...]:
    """The hole of a cut-out, clockwise."""
    rx, ry = design.cutout_width / 2, design.cutout_height / 2
    depth = block.neck.neck_depth if design.cutout == FRONT else block.neck.back_neck_depth
    neck = block.strap[1] - depth
    y = design.cutout_place * neck
    room = min(neck - y - ry, block.waist[0] - rx, block.armpit[0] - rx)
    if room < rules.HOLE_MARGIN:
        raise DraftError(
            f"the cut-out leaves {room:.1f} cm of cloth, at least {rules.HOLE_MARGIN} cm are "
            "needed; make it smaller or cutout_place lower"
        )
    kx, ky = ROUND * rx, ROUND * ry
    points = ((-rx, y), (0.0, y + ry), (rx, y), (0.0, y - ry))
    bends = (
        ((-rx, y + ky), (-kx, y + ry)),
        ((kx, y + ry), (rx, y + ky)),
        ((rx, y - ky), (kx, y - ry)),
        ((-kx, y - ry), (-rx, y - ky)),
    )
    quarters = tuple(
        Bezier(points[k], controls, points[(k + 1) % 4]) for k, controls in enumerate(bends)
    )
    return (loop_from_curves(quarters),)


def upper_half(block: BodiceBlock, facing: str, start: Point) -> Outline:
    """A half from the side seam up to the middle of the neck."""
    (x, y), (ax, ay) = start, block.armpit
    if abs(x - ax) < STRAIGHT:
        side: Curve = Line(start, block.armpit)
    else:
        side = Bezier(start, ((x, y + 0.4 * (ay - y)), lerp(block.armpit, start, 0.3)), (ax, ay))
    return (
        NamedCurve("side_seam", side),
        NamedCurve("armhole", armhole(block, facing)),
        *lines("shoulder", block.shoulder, block.strap),
        *(front_neck(block) if facing == FRONT else back_neck(block)),
    )


def armhole(block: BodiceBlock, facing: str) -> Bezier:
    """The armhole of a half, from the armpit up to the shoulder.

    It leaves the side seam level, meets the shoulder seam at a right angle, and is hollowed out to
    the width across the chest or the back in between.
    """
    body, (ax, ay), (sx, sy) = block.body, block.armpit, block.shoulder
    across = (body.across_front if facing == FRONT else body.across_back) / 2
    across += block.bodice.bust_ease / 16
    inner = min(across, sx - (1.0 if facing == FRONT else 0.5), ax - 3.0)
    down = 0.5 * (sy - ay)
    dx, dy = block.slope
    upper = (sx + down * dy, sy - down * dx)
    # The curve's middle, an eighth of the ends and three eighths of the controls, lies at `inner`.
    lower_x = (8 * inner - ax - sx - 3 * upper[0]) / 3
    lower_x = min(max(lower_x, block.strap[0]), ax - 1.0)
    return Bezier((ax, ay), ((lower_x, ay), upper), (sx, sy))


def front_neck(block: BodiceBlock) -> Outline:
    """The front neckline of a half, from the shoulder to the middle."""
    (x, y), depth, shape = block.strap, block.neck.neck_depth, block.neck.neckline
    low = y - depth
    if shape == "v":
        return lines("neck", (x, y), (0.0, low))
    if shape == "square":
        return lines("neck", (x, y), (x * (1 - SQUARE_TAPER), low), (0.0, low))
    if shape == "boat":
        low = y - BOAT_DEPTH * depth
        curve = Bezier((x, y), (lerp((x, y), (0.0, low), 0.4), (0.5 * x, low)), (0.0, low))
    else:
        curve = Bezier((x, y), ((0.95 * x, low + 0.42 * depth), (0.6 * x, low)), (0.0, low))
    return (NamedCurve("neck", curve),)


def back_neck(block: BodiceBlock) -> Outline:
    """The back neckline of a half, from the shoulder to the middle."""
    (x, y), depth = block.strap, block.neck.back_neck_depth
    low = y - depth
    curve = Bezier((x, y), ((0.85 * x, low + 0.2 * depth), (0.5 * x, low)), (0.0, low))
    return (NamedCurve("neck", curve),)
