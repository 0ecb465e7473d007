"""Darts: wedges that are folded away so that flat cloth follows the bust and the waist."""

from garmentimage.draft import rules
from garmentimage.draft.designs import DartDesign
from garmentimage.draft.panel import NamedCurve, Outline, distance, lerp, lines, moved
from garmentimage.errors import DraftError
from garmentimage.geometry import Point

SECOND_DART = 0.3
"""How far the second waist dart lies from the first, as a share of the lower edge."""


def with_waist_darts(half: Outline, design: DartDesign, count: int, bust: Point) -> Outline:
    """A half with `count` darts in its straight lower edge, which comes first."""
    edge = half[0]
    start, end = edge.curve.start, edge.curve.end
    total = distance(start, end)
    ux, uy = (end[0] - start[0]) / total, (end[1] - start[1]) / total
    height = design.dart_reach * (bust[1] - start[1])
    drawn: Outline = ()
    for k in range(count):
        share, mouth = design.dart_place + k * SECOND_DART, design.dart_width / total
        middle = lerp(start, end, share)
        tip = (middle[0] - uy * height, middle[1] + ux * height)
        check_dart_tip(tip, bust)
        first, last = lerp(start, end, share - mouth / 2), lerp(start, end, share + mouth / 2)
        before = drawn[-1].curve.end if drawn else start
        drawn += lines(edge.label, before, first) + lines(f"waist_dart_{k + 1}", first, tip, last)
    return (*drawn, *lines(edge.label, drawn[-1].curve.end, end), *half[1:])


def with_side_dart(half: Outline, design: DartDesign, bust: Point) -> Outline:
    """A half with a dart in the highest edge of its side seam.

    All that lies below gets longer by the width of the dart, so the side seam keeps its length
    once the dart is closed.
    """
    last = max(k for k, named in enumerate(half) if named.label == "side_seam")
    curve, width = half[last].curve, design.side_dart_width
    below, above = curve.split(curve.parameter(1 - design.side_dart_place))
    mouth = above.start
    tip = (
        mouth[0] - design.side_dart_reach * (mouth[0] - bust[0]),
        mouth[1] - width / 2,
    )
    check_dart_tip(tip, bust)
    lower = moved((*half[:last], NamedCurve("side_seam", below)), 0.0, -width)
    legs = lines("side_dart", lower[-1].curve.end, tip, mouth)
    return (*lower, *legs, NamedCurve("side_seam", above), *half[last + 1 :])


def check_dart_tip(tip: Point, bust: Point) -> None:
    """Refuse a dart that ends at or past the bust point."""
    if distance(tip, bust) < rules.BUST_CLEARANCE:
        raise DraftError(
            f"a dart ends {distance(tip, bust):.1f} cm from the bust point, at least "
            f"{rules.BUST_CLEARANCE} cm are needed; make its reach smaller"
        )
