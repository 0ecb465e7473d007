"""Random small garments for laws: `@given(garments())`.

Front and back with side seams, drawn with random curves; perhaps a waistband, a skirt, sleeves,
waist darts, a hole in the front. All are valid, stand on a body with the feet at y = 0, and have
panels that run counter-clockwise seen from outside.
"""

from dataclasses import dataclass
from itertools import pairwise

from hypothesis import strategies as st

from garmentimage.geometry.curves import Bezier, Curve, Line, Point
from garmentimage.pattern.model import Loop, Panel, Pattern, Side, Stitch, loop_from_curves

WAIST = 100.0
FRONT_Z, BACK_Z, SLEEVE_Z = 22.0, -20.0, 14.0
DART_AT, DART_WIDTH, DART_TIP = 10.5, 2.5, 11.0
BAND_HEIGHT, GAP = 4.0, 2.0


@dataclass(frozen=True)
class Half:
    """Measures of one side of the wearer [cm], from the body's axis and the waist."""

    waist: float
    armpit: Point
    side_bend: float
    armhole_bend: float
    shoulder: Point
    hem: Point
    skirt_bend: float


@dataclass(frozen=True)
class Design:
    """What a garment is made of."""

    left: Half
    right: Half
    neck: Point
    neck_depth: float
    bodice: bool
    band: bool
    skirt: bool
    sleeves: bool
    darts: bool
    hole: float
    """Radius of a hole in the front of the bodice; 0: none."""
    fullness: float
    """Width of the skirt's top as a multiple of what it is sewn to."""


def _lengths(low, high):
    """Lengths in steps of a hundredth of a millimetre, as a tailor would never see them."""
    steps = st.integers(round(low * 1000), round(high * 1000))
    return steps.map(lambda k: k / 1000)


@st.composite
def _halves(draw):
    return Half(
        waist=draw(_lengths(17, 22)),
        armpit=(draw(_lengths(22.5, 26)), draw(_lengths(19, 23))),
        side_bend=draw(_lengths(-2, 1)),
        armhole_bend=draw(_lengths(0.5, 5)),
        shoulder=(draw(_lengths(16, 19)), draw(_lengths(36, 39))),
        hem=(draw(_lengths(24, 45)), -draw(_lengths(30, 60))),
        skirt_bend=draw(_lengths(-2, 3)),
    )


@st.composite
def designs(draw, *, holes=True):
    left = draw(_halves())
    bodice, skirt = draw(st.sampled_from([(True, False), (False, True), (True, True)]))
    darts = bodice and draw(st.booleans())
    return Design(
        left=left,
        right=left if draw(st.booleans()) else draw(_halves()),
        neck=(draw(_lengths(6, 9)), draw(_lengths(40.5, 43))),
        neck_depth=draw(_lengths(2, 10)),
        bodice=bodice,
        band=skirt and draw(st.booleans()),
        skirt=skirt,
        sleeves=bodice and draw(st.booleans()),
        darts=darts,
        hole=draw(_lengths(3.5, 5.5)) if holes and bodice and draw(st.booleans()) else 0.0,
        fullness=draw(st.sampled_from([1.0, 1.0, 1.5])),
    )


def garments(*, holes=True):
    """Random garments; `holes=False` leaves out those with a hole."""
    return designs(holes=holes).map(garment)


class _Piece:
    """A panel that is being drawn: curves counter-clockwise, with names for sewing."""

    def __init__(self, name, named, translation, rotation=(0.0, 0.0, 0.0), holes=()):
        self.name, self.edge_names = name, [n for n, _ in named]
        outline = loop_from_curves([c for _, c in named])
        self.panel = Panel(name, outline, holes, translation=translation, rotation=rotation)

    def side(self, edge_name) -> Side:
        return Side(self.name, self.edge_names.index(edge_name))


def _mirrored(named):
    def flip(p):
        return -p[0], p[1]

    def back(c: Curve) -> Curve:
        if isinstance(c, Line):
            return Line(flip(c.end), flip(c.start))
        assert isinstance(c, Bezier)
        return Bezier(flip(c.end), tuple(flip(p) for p in reversed(c.controls)), flip(c.start))

    return [(name, back(c)) for name, c in reversed(named)]


def _for_side(side, named):
    return [(f"{side}_{name}", c) for name, c in named]


def _lines(name, points):
    return [(f"{name}_{k}", Line(a, b)) for k, (a, b) in enumerate(pairwise(points))]


def _bodice_half(half: Half, design: Design):
    waist, armpit, shoulder = (half.waist, 0.0), half.armpit, half.shoulder
    middle = ((waist[0] + armpit[0]) / 2 + half.side_bend, armpit[1] / 2)
    bend = half.armhole_bend
    hollow = (
        (armpit[0] - 3 - bend, armpit[1] + 0.5),
        (shoulder[0] - bend, (armpit[1] + shoulder[1]) / 2),
    )
    return [
        ("side", Bezier(waist, (middle,), armpit)),
        ("armhole", Bezier(armpit, hollow, shoulder)),
        ("shoulder", Line(shoulder, design.neck)),
    ]


def _skirt_half(half: Half, top: float):
    hem, corner = half.hem, (top, 0.0)
    control = (corner[0] + half.skirt_bend + 1.0, hem[1] * 0.4)
    return [("skirt_side", Bezier(hem, (control,), corner))]


def _placed(name, named, height, holes=()):
    back = name.endswith("back")
    return _Piece(
        name,
        named,
        (0.0, height, BACK_Z if back else FRONT_Z),
        (0.0, 180.0 if back else 0.0, 0.0),
        holes,
    )


def _sides(facing, design):
    """(names, halves) at positive and at negative x, as seen from outside."""
    both = [("left", design.left), ("right", design.right)]
    return both if facing == "front" else both[::-1]


def _bodice(facing, design: Design, height):
    (plus, plus_half), (minus, minus_half) = _sides(facing, design)
    points = [(-minus_half.waist, 0.0)]
    if design.darts:
        for x in (-DART_AT, DART_AT):
            points += [(x - DART_WIDTH / 2, 0.0), (x, DART_TIP), (x + DART_WIDTH / 2, 0.0)]
    points.append((plus_half.waist, 0.0))
    neck = design.neck
    low = neck[1] - design.neck_depth / 0.75
    named = [
        *_lines("waist", points),
        *_for_side(plus, _bodice_half(plus_half, design)),
        ("neck", Bezier(neck, ((neck[0] - 1, low), (1 - neck[0], low)), (-neck[0], neck[1]))),
        *_for_side(minus, _mirrored(_bodice_half(minus_half, design))),
    ]
    holes = (_round_hole((0.0, 13.0), design.hole),) if design.hole and facing == "front" else ()
    return _placed(f"bodice_{facing}", named, height, holes)


def _round_hole(centre: Point, radius: float) -> Loop:
    (x, y), r, k = centre, radius, 0.55 * radius
    left, top, right, bottom = (x - r, y), (x, y + r), (x + r, y), (x, y - r)
    return loop_from_curves(
        [
            Bezier(left, ((x - r, y + k), (x - k, y + r)), top),
            Bezier(top, ((x + k, y + r), (x + r, y + k)), right),
            Bezier(right, ((x + r, y - k), (x + k, y - r)), bottom),
            Bezier(bottom, ((x - k, y - r), (x - r, y - k)), left),
        ]
    )


def _spread(widths, left, right):
    """x of the ends of edges that share left..right as `widths` do."""
    total, xs = sum(widths), [left]
    for width in widths[:-1]:
        xs.append(xs[-1] + width / total * (right - left))
    return [*xs, right]


def _band(facing, widths, height):
    total = sum(widths)
    xs = _spread(widths, -total / 2, total / 2)
    low = [(x, 0.0) for x in xs]
    high = [(x, BAND_HEIGHT) for x in reversed(xs)]
    named = [
        *_lines("lower", low),
        ("end_plus", Line(low[-1], high[0])),
        *_lines("upper", high),
        ("end_minus", Line(high[-1], low[0])),
    ]
    return _placed(f"band_{facing}", named, height)


def _skirt(facing, design: Design, widths, height):
    (plus, plus_half), (minus, minus_half) = _sides(facing, design)
    top = sum(widths) * design.fullness / 2
    xs = _spread(widths[::-1], top, -top)
    named = [
        ("hem", Line((-minus_half.hem[0], minus_half.hem[1]), plus_half.hem)),
        *_for_side(plus, _skirt_half(plus_half, top)),
        *_lines("top", [(x, 0.0) for x in xs]),
        *_for_side(minus, _mirrored(_skirt_half(minus_half, top))),
    ]
    return _placed(f"skirt_{facing}", named, height)


def _sleeve(side, facing, half: Half, height):
    cap, width, length, taper = 11.0, half.armpit[0] - 9.0, 26.0, 1.5
    under, crown = (cap, -width), (0.0, 0.0)
    named = [
        ("underarm", Line(under, (length, taper - width))),
        ("cuff", Line((length, taper - width), (length, 0.0))),
        ("top", Line((length, 0.0), crown)),
        ("cap", Bezier(crown, ((0.2, -width * 0.5), (cap - 4, 2 - width * 0.8)), under)),
    ]
    if (side == "left") != (facing == "front"):
        named = _mirrored(named)
    sign, back = (1 if side == "left" else -1), facing == "back"
    return _Piece(
        f"{side}_sleeve_{facing}",
        named,
        (sign * (half.shoulder[0] + 4), height + half.shoulder[1], -SLEEVE_Z if back else SLEEVE_Z),
        (0.0, 180.0 if back else 0.0, -sign * 35.0),
    )


def _sew_pair(front: _Piece, back: _Piece, *names):
    return [
        Stitch(front.side(f"{side}_{name}"), back.side(f"{side}_{name}"))
        for name in names
        for side in ("left", "right")
    ]


def _waist_edges(piece: _Piece, design: Design):
    """Names of the waist edges that are sewn to what lies below, left to right."""
    return ["waist_0", "waist_3", "waist_6"] if design.darts else ["waist_0"]


def garment(design: Design) -> Pattern:
    """The pattern of a design."""
    pieces, stitches = [], []
    bottoms: dict[str, list[tuple[Side, float]]] = {}
    height = WAIST
    if design.bodice:
        front, back = (_bodice(facing, design, height + GAP) for facing in ("front", "back"))
        pieces += [front, back]
        stitches += _sew_pair(front, back, "side", "shoulder")
        for facing, piece in (("front", front), ("back", back)):
            names = _waist_edges(piece, design)
            sides = [piece.side(n) for n in names]
            bottoms[facing] = [(s, piece.panel.curves[s.edge].length) for s in sides]
            if design.darts:
                stitches += [
                    Stitch(piece.side("waist_1"), piece.side("waist_2")),
                    Stitch(piece.side("waist_4"), piece.side("waist_5")),
                ]
        if design.sleeves:
            for side, half in (("left", design.left), ("right", design.right)):
                pair = [_sleeve(side, facing, half, height + GAP) for facing in ("front", "back")]
                stitches += [Stitch(pair[0].side(n), pair[1].side(n)) for n in ("top", "underarm")]
                stitches += [
                    Stitch(sleeve.side("cap"), body.side(f"{side}_armhole"))
                    for sleeve, body in zip(pair, (front, back), strict=True)
                ]
                pieces += pair
    width = design.left.waist + design.right.waist
    if design.band:
        height -= BAND_HEIGHT + GAP
        pair = []
        for facing in ("front", "back"):
            above = bottoms.get(facing)
            band = _band(facing, [w for _, w in above] if above else [width], height)
            count = len(above) if above else 1
            if above:
                stitches += [
                    Stitch(side, band.side(f"upper_{count - 1 - k}"))
                    for k, (side, _) in enumerate(above)
                ]
            sides = [band.side(f"lower_{k}") for k in range(count)]
            bottoms[facing] = [(s, band.panel.curves[s.edge].length) for s in sides]
            pair.append(band)
        stitches += [
            Stitch(pair[0].side("end_plus"), pair[1].side("end_minus")),
            Stitch(pair[0].side("end_minus"), pair[1].side("end_plus")),
        ]
        pieces += pair
    if design.skirt:
        height -= GAP
        pair = []
        for facing in ("front", "back"):
            above = bottoms.get(facing, [])
            skirt = _skirt(facing, design, [w for _, w in above] or [width], height)
            stitches += [
                Stitch(side, skirt.side(f"top_{len(above) - 1 - k}"))
                for k, (side, _) in enumerate(above)
            ]
            pair.append(skirt)
        stitches += _sew_pair(*pair, "skirt_side")
        pieces += pair
    return Pattern(tuple(p.panel for p in pieces), tuple(stitches), name="garment")
