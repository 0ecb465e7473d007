"""Draw the example patterns in src/garmentimage/examples.

    python scripts/draw_examples.py [FOLDER]

All lengths are cm. A panel is drawn as seen from outside the body, counter-clockwise, with the
wearer's waist (trousers: the crotch line) at y = 0. Back panels are seen from behind, so the
wearer's left is at negative x there, and are placed by half a turn about the vertical axis.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import hypot
from pathlib import Path

import numpy as np

from garmentimage.geometry.curves import Bezier, Curve, Line, Point
from garmentimage.pattern.files.spec import save_pattern
from garmentimage.pattern.model import (
    Loop,
    Notch,
    Panel,
    Pattern,
    Side,
    Stitch,
    Vector,
    loop_from_curves,
)

FOLDER = Path(__file__).parents[1] / "src" / "garmentimage" / "examples"

WAIST_HEIGHT = 100.0
CROTCH_HEIGHT = 75.0
FRONT_Z, BACK_Z = 22.0, -20.0
SLEEVE_Z = 14.0
FACING_BACK = 180.0
"""Turn about the vertical axis of a panel on the wearer's back [degrees]."""

NECK = (8.0, 42.0)
SHOULDER = (18.5, 38.0)
ARMPIT = (24.0, 21.0)
FRONT_ARMHOLE = ((17.5, 21.0), (14.5, 29.5))
BACK_ARMHOLE = ((18.5, 21.0), (16.0, 29.5))

ARM_ANGLE = 38.0
"""How far the sleeves point down [degrees]."""
CAP_HEIGHT = 11.5
SLEEVE_GAP = 4.0
"""From the shoulder's end to the top of the sleeve [cm]."""


@dataclass(frozen=True)
class Named:
    """A curve of the outline and what the tailor calls it."""

    name: str
    curve: Curve


def line(name: str, *points: Point) -> list[Named]:
    """Straight edges through the points; more than one get the name with a number."""
    pairs = list(pairwise(points))
    names = [name] if len(pairs) == 1 else [f"{name}_{k}" for k in range(len(pairs))]
    return [Named(n, Line(a, b)) for n, (a, b) in zip(names, pairs, strict=True)]


def curve(name: str, start: Point, first: Point, second: Point, end: Point) -> list[Named]:
    """One cubic edge with the two control points."""
    return [Named(name, Bezier(start, (first, second), end))]


def mirrored_curve(original: Curve) -> Curve:
    """The curve mirrored at x = 0 and walked the other way."""
    back = original.reversed()

    def flip(p: Point) -> Point:
        return -p[0], p[1]

    if isinstance(back, Bezier):
        return Bezier(flip(back.start), tuple(flip(c) for c in back.controls), flip(back.end))
    return Line(flip(back.start), flip(back.end))


def mirrored(chain: Sequence[Named]) -> list[Named]:
    """A chain mirrored at x = 0, walked so that a closed one stays counter-clockwise."""
    return [Named(n.name, mirrored_curve(n.curve)) for n in reversed(chain)]


def on_side(side: str, chain: Sequence[Named]) -> list[Named]:
    """The chain with the wearer's side in its names."""
    return [replace(n, name=f"{side}_{n.name}") for n in chain]


@dataclass(frozen=True)
class Drawn:
    """A panel with names for its edges."""

    panel: Panel
    names: tuple[str, ...]

    def side(self, name: str) -> Side:
        """The edge of this name."""
        return Side(self.panel.name, self.names.index(name))


def draw(
    name: str,
    chain: Sequence[Named],
    translation: Vector,
    *,
    label: str,
    rotation: Vector = (0.0, 0.0, 0.0),
) -> Drawn:
    """A panel from a closed chain of named curves."""
    curves = [n.curve for n in chain]
    for before, after in zip([curves[-1], *curves], curves, strict=False):
        assert before.end == after.start, (name, before.end, after.start)
    outline = loop_from_curves(curves)
    panel = Panel(name, outline, translation=translation, rotation=rotation, label=label)
    return Drawn(panel, tuple(n.name for n in chain))


def sew(a: Drawn, b: Drawn, *names: str) -> list[Stitch]:
    """Stitches between edges of the same name."""
    return [Stitch(a.side(n), b.side(n)) for n in names]


def symmetric(bottom: list[Named], half: list[Named], top: list[Named], facing: str) -> list[Named]:
    """A body panel: bottom edges left to right, the half at positive x going up, the top, down."""
    right_hand, left_hand = ("left", "right") if facing == "front" else ("right", "left")
    return [*bottom, *on_side(right_hand, half), *top, *on_side(left_hand, mirrored(half))]


def body(name: str, chain: list[Named]) -> Drawn:
    """A front or back panel at waist height."""
    back = name == "back"
    return draw(
        name,
        chain,
        (0.0, WAIST_HEIGHT, BACK_Z if back else FRONT_Z),
        rotation=(0.0, FACING_BACK if back else 0.0, 0.0),
        label="body",
    )


def armhole_and_shoulder(facing: str) -> list[Named]:
    """From the armpit up to the neck."""
    controls = FRONT_ARMHOLE if facing == "front" else BACK_ARMHOLE
    return [*curve("armhole", ARMPIT, *controls, SHOULDER), *line("shoulder", SHOULDER, NECK)]


def neckline(lowest: float) -> list[Named]:
    """One symmetric curve over the neck, down to the height `lowest` in the middle."""
    depth = (NECK[1] - lowest) / 0.75
    low = NECK[1] - depth
    return curve("neck", NECK, (NECK[0] - 1, low), (1 - NECK[0], low), (-NECK[0], NECK[1]))


def length_of(drawn: Drawn, name: str) -> float:
    """Length of a named edge [cm]."""
    return drawn.panel.curves[drawn.names.index(name)].length


def solve(function, low: float, high: float) -> float:
    """Where the increasing `function` is 0, by halving."""
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high) / 2


def sleeve_half(cap_length: float, length: float, taper: float) -> list[Named]:
    """The half of a sleeve that points along x, its cap sewn to an armhole of `cap_length`.

    The fold line from crown to cuff lies on y = 0, the underarm below it.
    """

    def cap(width: float) -> Bezier:
        under = (CAP_HEIGHT, -width)
        return Bezier(under, ((CAP_HEIGHT - 4.5, 2.2 - width * 0.75), (0.2, -width * 0.55)), (0, 0))

    width = solve(lambda w: cap(w).length - cap_length, 8.0, 30.0)
    under, cuff = (CAP_HEIGHT, -width), (length, taper - width)
    return [
        *line("underarm", under, cuff),
        *line("cuff", cuff, (length, 0.0)),
        *line("top", (length, 0.0), (0.0, 0.0)),
        Named("armhole", cap(width).reversed()),
    ]


def sleeves(front: Drawn, back: Drawn, length: float, taper: float) -> tuple[list[Drawn], list]:
    """Four sleeve halves and all stitches that hold them."""
    halves, stitches = [], []
    x, y = SHOULDER[0] + SLEEVE_GAP, WAIST_HEIGHT + SHOULDER[1]
    for side, sign in (("left", 1), ("right", -1)):
        pair = []
        for body_panel, facing, z in ((front, "front", SLEEVE_Z), (back, "back", -SLEEVE_Z)):
            chain = sleeve_half(length_of(body_panel, f"{side}_armhole"), length, taper)
            if (side == "left") != (facing == "front"):
                chain = mirrored(chain)
            turn = FACING_BACK if facing == "back" else 0.0
            half = draw(
                f"{side}_sleeve_{facing}",
                chain,
                (sign * x, y, z),
                rotation=(0.0, turn, -sign * ARM_ANGLE),
                label="arm",
            )
            stitches.append(Stitch(half.side("armhole"), body_panel.side(f"{side}_armhole")))
            pair.append(half)
        stitches += sew(pair[0], pair[1], "top", "underarm")
        halves += pair
    return halves, stitches


def body_seams(front: Drawn, back: Drawn, *sides: str) -> list[Stitch]:
    """Shoulder and side seams of both sides."""
    names = [f"{side}_{name}" for side in ("left", "right") for name in ("shoulder", *sides)]
    return sew(front, back, *names)


def dress() -> Pattern:
    """A knee-length one-piece dress with a flared skirt and short sleeves."""
    hem, waist = (36.0, -51.0), (19.5, 1.0)
    side = [
        *curve("skirt_side", hem, (30.0, -30.0), (19.5, -14.0), waist),
        *curve("side", waist, (19.5, 8.0), (22.0, 15.0), ARMPIT),
    ]
    bottom = curve("hem", (-hem[0], hem[1]), (-14.0, -54.5), (14.0, -54.5), hem)

    def panel(name: str, neck: float) -> Drawn:
        half = [*side, *armhole_and_shoulder(name)]
        return body(name, symmetric(bottom, half, neckline(neck), name))

    front, back = panel("front", 32.0), panel("back", 39.5)
    arms, stitches = sleeves(front, back, length=25.0, taper=1.5)
    panels = [front, back, *arms]
    return Pattern(
        tuple(d.panel for d in panels),
        (*body_seams(front, back, "skirt_side", "side"), *stitches),
        name="dress",
    )


def dart_at(x: float, width: float, bottom: float, tip: float) -> list[Point]:
    """The three points of a dart that opens downwards."""
    return [(x - width / 2, bottom), (x, tip), (x + width / 2, bottom)]


def along(start: Point, end: Point, distance: float) -> Point:
    """The point at a distance from `start` towards `end`."""
    share = distance / hypot(end[0] - start[0], end[1] - start[1])
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def darted_hem(corner: Point, dart_x: float, width: float, tip: float) -> list[Named]:
    """A straight hem with a dart on either side of the centre, left to right."""
    x, y = corner
    points = [(-x, y), *dart_at(-dart_x, width, y, tip), *dart_at(dart_x, width, y, tip), (x, y)]
    names = ["hem_0", "dart_0", "dart_1", "hem_1", "dart_2", "dart_3", "hem_2"]
    return [Named(n, Line(a, b)) for n, a, b in zip(names, points, points[1:], strict=False)]


def darted_shirt() -> Pattern:
    """A fitted shirt: waist darts in front and back, bust darts in the side seams."""
    below_dart, dart_depth = 13.0, 11.0
    front_corner, back_corner = (21.5, -5.0), (21.0, -2.5)
    back_length = hypot(ARMPIT[0] - back_corner[0], ARMPIT[1] - back_corner[1])
    front_length = hypot(ARMPIT[0] - front_corner[0], ARMPIT[1] - front_corner[1])
    lower = along(front_corner, ARMPIT, below_dart)
    upper = along(front_corner, ARMPIT, below_dart + front_length - back_length)
    middle = np.add(lower, upper) / 2
    inward = np.array([lower[1] - upper[1], upper[0] - lower[0]])
    tip = middle + inward / np.hypot(*inward) * dart_depth
    front_side = [
        *line("side_lower", front_corner, lower),
        *line("bust_dart", lower, (float(tip[0]), float(tip[1])), upper),
        *line("side_upper", upper, ARMPIT),
    ]
    back_middle = along(back_corner, ARMPIT, below_dart)
    back_side = [
        *line("side_lower", back_corner, back_middle),
        *line("side_upper", back_middle, ARMPIT),
    ]

    def panel(name: str, corner: Point, side: list[Named], neck: float, tip: float) -> Drawn:
        bottom = darted_hem(corner, 9.5, 3.0, tip)
        half = [*side, *armhole_and_shoulder(name)]
        return body(name, symmetric(bottom, half, neckline(neck), name))

    front = panel("front", front_corner, front_side, 34.0, 11.0)
    back = panel("back", back_corner, back_side, 39.5, 13.0)
    darts = [
        Stitch(panel.side(a), panel.side(b))
        for panel in (front, back)
        for a, b in (("dart_0", "dart_1"), ("dart_2", "dart_3"))
    ]
    darts += [
        Stitch(front.side(f"{side}_bust_dart_0"), front.side(f"{side}_bust_dart_1"))
        for side in ("left", "right")
    ]
    arms, stitches = sleeves(front, back, length=30.0, taper=2.0)
    panels = [front, back, *arms]
    return Pattern(
        tuple(d.panel for d in panels),
        (*body_seams(front, back, "side_lower", "side_upper"), *darts, *stitches),
        name="darted_shirt",
    )


def leg_front() -> list[Named]:
    """The wearer's left leg in front; x = 0 is the centre front, y = 0 the crotch line."""
    hem_in, hem_out = (-0.5, -67.0), (19.5, -67.0)
    hip, waist, centre, curve_top = (24.5, 6.0), (21.0, 25.0), (0.8, 24.5), (0.0, 8.0)
    crotch = (-5.0, 0.0)
    return [
        *line("hem", hem_in, hem_out),
        *curve("outseam", hem_out, (20.5, -45.0), (24.8, -14.0), hip),
        *curve("hip", hip, (24.4, 13.0), (23.0, 19.0), waist),
        *line("waist", waist, centre),
        *line("centre", centre, curve_top),
        *curve("crotch", curve_top, (-0.2, 3.5), (-1.5, 0.6), crotch),
        *curve("inseam", crotch, (-2.6, -14.0), (-1.4, -38.0), hem_in),
    ]


def leg_back() -> list[Named]:
    """The wearer's left leg at the back, drawn as if seen through the body."""
    front = {n.name: n.curve for n in leg_front()}
    hem_in, hem_out = (-1.5, -67.0), (20.5, -67.0)
    hip, waist, centre, curve_top = (25.5, 6.0), (22.0, 25.0), (3.2, 27.0), (0.6, 8.5)

    def inseam(height: float) -> Bezier:
        return Bezier((-9.0, height), ((-4.4, height - 13.0), (-2.6, -38.0)), hem_in)

    crotch_height = solve(lambda h: inseam(h).length - front["inseam"].length, -8.0, 4.0)
    crotch = (-9.0, crotch_height)
    down, dart_width, dart_depth = np.subtract(centre, waist), 2.6, 11.0
    along_waist = down / np.hypot(*down)
    middle = np.add(waist, centre) / 2
    left, right = middle - along_waist * dart_width / 2, middle + along_waist * dart_width / 2
    tip = middle + dart_depth * np.array([-along_waist[1], along_waist[0]])
    points = [(float(p[0]), float(p[1])) for p in (waist, left, tip, right, centre)]
    names = ["waist_0", "dart_0", "dart_1", "waist_1"]
    return [
        *line("hem", hem_in, hem_out),
        *curve("outseam", hem_out, (21.5, -45.0), (25.8, -14.0), hip),
        *curve("hip", hip, (25.4, 13.0), (24.0, 19.0), waist),
        *(Named(n, Line(a, b)) for n, a, b in zip(names, points, points[1:], strict=False)),
        *line("centre", centre, curve_top),
        *curve("crotch", curve_top, (-0.2, 3.2), (-2.8, crotch_height + 0.4), crotch),
        Named("inseam", inseam(crotch_height)),
    ]


def band(name: str, widths: Sequence[float], z: float, turn: float) -> Drawn:
    """A straight waistband whose lower edges have the given widths, left to right."""
    height, gap = 4.0, 2.5
    xs = np.concatenate([[0.0], np.cumsum(widths)]) - sum(widths) / 2
    lower = [(float(x), 0.0) for x in xs]
    chain = [
        *(Named(f"waist_{k}", Line(a, b)) for k, (a, b) in enumerate(pairwise(lower))),
        *line("end_0", lower[-1], (lower[-1][0], height)),
        *line("upper", (lower[-1][0], height), (lower[0][0], height)),
        *line("end_1", (lower[0][0], height), lower[0]),
    ]
    top = CROTCH_HEIGHT + 25.0
    return draw(name, chain, (0.0, top + gap, z), rotation=(0.0, turn, 0.0), label="body")


def trousers() -> Pattern:
    """Straight trousers: two front legs, two back legs with darts, a waistband in two parts."""
    front_shift, back_shift = 6.0, 10.0

    def leg(side: str, facing: str) -> Drawn:
        chain = leg_front() if facing == "front" else leg_back()
        if (side == "left") != (facing == "front"):
            chain = mirrored(chain)
        sign = 1 if side == "left" else -1
        if facing == "front":
            place, turn = (sign * front_shift, CROTCH_HEIGHT, FRONT_Z), 0.0
        else:
            place, turn = (sign * back_shift, CROTCH_HEIGHT, BACK_Z), FACING_BACK
        return draw(f"{side}_leg_{facing}", chain, place, rotation=(0.0, turn, 0.0), label="leg")

    lf, rf, lb, rb = (leg(s, f) for f in ("front", "back") for s in ("left", "right"))
    # A band's lower edges run left to right as seen from outside.
    front_parts = [rf.side("waist"), lf.side("waist")]
    back_parts = [
        lb.side("waist_0"),
        lb.side("waist_1"),
        rb.side("waist_1"),
        rb.side("waist_0"),
    ]
    by_name = {d.panel.name: d for d in (lf, rf, lb, rb)}

    def widths(parts: list[Side]) -> list[float]:
        return [by_name[p.panel].panel.curves[p.edge].length for p in parts]

    front_band = band("waistband_front", widths(front_parts), FRONT_Z, 0.0)
    back_band = band("waistband_back", widths(back_parts), BACK_Z, FACING_BACK)
    stitches = [
        *sew(lf, rf, "centre", "crotch"),
        *sew(lb, rb, "centre", "crotch"),
        *sew(lf, lb, "outseam", "hip", "inseam"),
        *sew(rf, rb, "outseam", "hip", "inseam"),
        *sew_darts(lb, rb),
        *(Stitch(front_band.side(f"waist_{k}"), part) for k, part in enumerate(front_parts)),
        *(Stitch(back_band.side(f"waist_{k}"), part) for k, part in enumerate(back_parts)),
        Stitch(front_band.side("end_0"), back_band.side("end_1")),
        Stitch(front_band.side("end_1"), back_band.side("end_0")),
    ]
    panels = (lf, rf, lb, rb, front_band, back_band)
    return Pattern(tuple(d.panel for d in panels), tuple(stitches), name="trousers")


def sew_darts(*legs: Drawn) -> list[Stitch]:
    """The waist dart of each back leg."""
    return [Stitch(leg.side("dart_0"), leg.side("dart_1")) for leg in legs]


def oval(centre: Point, width: float, height: float) -> Loop:
    """An oval hole of four curves, clockwise: the cloth lies on its left."""
    roundness = 0.5523  # the usual share at which a cubic follows a quarter of a circle
    x, y = centre
    a, b = width / 2, height / 2
    left, top, right, bottom = (x - a, y), (x, y + b), (x + a, y), (x, y - b)
    ka, kb = a * roundness, b * roundness
    return loop_from_curves(
        [
            Bezier(left, ((x - a, y + kb), (x - ka, y + b)), top),
            Bezier(top, ((x + ka, y + b), (x + a, y + kb)), right),
            Bezier(right, ((x + a, y - kb), (x + ka, y - b)), bottom),
            Bezier(bottom, ((x - ka, y - b), (x - a, y - kb)), left),
        ]
    )


def cutout_top() -> Pattern:
    """A sleeveless top to the hip with an oval cut out of the front above the waist."""
    hem, waist = (26.0, -18.0), (20.5, 0.0)
    side = [
        *curve("hip_side", hem, (24.5, -11.0), (20.5, -6.0), waist),
        *curve("side", waist, (20.5, 7.0), (22.2, 15.0), ARMPIT),
    ]
    bottom = curve("hem", (-hem[0], hem[1]), (-9.0, -19.5), (9.0, -19.5), hem)

    def panel(name: str, neck: float) -> Drawn:
        half = [*side, *armhole_and_shoulder(name)]
        drawn = body(name, symmetric(bottom, half, neckline(neck), name))
        sides = [drawn.side(f"{s}_side").edge for s in ("left", "right")]
        # The same place on both panels: their side seams run in opposite directions.
        marks = tuple(Notch(k, 0.5) for k in sides)
        return replace(drawn, panel=replace(drawn.panel, grain=(0.0, 1.0), notches=marks))

    front, back = panel("front", 31.0), panel("back", 38.0)
    front = replace(front, panel=replace(front.panel, holes=(oval((0.0, 11.0), 17.0, 13.0),)))
    return Pattern(
        (front.panel, back.panel),
        tuple(body_seams(front, back, "hip_side", "side")),
        name="cutout_top",
    )


def draw_all() -> tuple[Pattern, ...]:
    """Every example."""
    return dress(), darted_shirt(), trousers(), cutout_top()


def main() -> None:
    """Write every example."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    for pattern in draw_all():
        save_pattern(pattern, folder / f"{pattern.name}.json")


if __name__ == "__main__":
    main()
