"""Sewing patterns as SVG at true scale: one path per edge, sewing partners as data attributes.

    <g class="panel" data-panel="front">
      <path id="panel-0-edge-3" class="edge sewn" data-panel="front" data-edge="3" data-stitch="1"
            data-partner-panel="back" data-partner-edge="5" d="M ..."/>

One unit of the drawing is a millimetre. Each panel lies in its own coordinates, only moved.
"""

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, sin, sqrt
from xml.sax.saxutils import escape

import numpy as np

from garmentimage.geometry import Arc, Bezier, Curve, Point, centroid
from garmentimage.pattern.model import Panel, Pattern, Side, Stitch
from garmentimage.pattern.pleats import PleatFoldLine, fold_lines
from garmentimage.system import write_atomically

MM_PER_CM = 10.0
MARGIN = 2.0  # free space round every panel [cm]
SHEET_SHAPE = 1.4
"""Wanted width of the sheet as a multiple of the side of a square of the same area."""
GRAIN_SHARE = 0.5  # length of a drawn grain line, as a share of the panel's smaller side
NOTCH_LENGTH = 0.6  # length of a drawn notch, into the cloth [cm]
TEXT_SIZE = 1.2
"""Height of the names [cm]."""
GOLDEN_ANGLE = 137.508  # step of the hue from stitch to stitch [degrees]; keeps neighbours apart
NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML cannot hold."""

STYLE = """
.edge { fill: none; stroke: #444; stroke-width: 0.8; stroke-linecap: round }
.sewn { stroke-width: 1.6 }
.grain, .notch { stroke: #444; stroke-width: 0.5 }
text { font-family: sans-serif; text-anchor: middle; fill: #444 }
""".strip()

FOLD_STYLE = """
.fold { stroke: #444; stroke-width: 0.5; stroke-dasharray: 4 2 }
.fold.beneath { stroke-dasharray: 1 2 }
""".rstrip()


@dataclass(frozen=True)
class Spot:
    """Where a panel lies on the sheet: its box's lower left corner [cm]."""

    x: float
    y: float


def save_svg(pattern: Pattern, path: str | os.PathLike[str]) -> None:
    """Write `pattern_to_svg(pattern)` to a file, whole or not at all.

    Raises:
        OutputError: the place cannot be written to.
    """
    write_atomically(path, pattern_to_svg(pattern))


def pattern_to_svg(pattern: Pattern) -> str:
    """The pattern as an SVG document in mm, its panels side by side."""
    spots, width, height = lay_out([_size(panel) for panel in pattern.panels])
    sewn = {
        side: (number, partner, stitch)
        for number, stitch in enumerate(pattern.stitches)
        for side, partner in ((stitch.a, stitch.b), (stitch.b, stitch.a))
    }
    groups = [
        _panel_group(number, panel, spot, height, sewn, _folds(pattern, panel))
        for number, (panel, spot) in enumerate(zip(pattern.panels, spots, strict=True))
    ]
    w, h = _mm(width), _mm(height)
    return "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}mm" height="{h}mm" '
            f'viewBox="0 0 {w} {h}">',
            f"<title>{_text(pattern.name or 'sewing pattern')}</title>",
            f"<style>{STYLE}{FOLD_STYLE if pattern.pleats else ''}</style>",
            *groups,
            "</svg>\n",
        ]
    )


def lay_out(sizes: Sequence[tuple[float, float]]) -> tuple[list[Spot], float, float]:
    """Boxes on shelves, the tallest first, none over another.

    Args:
        sizes: (width, height) of each box [cm].

    Returns:
        A place for each box, in the given order, and the sheet's width and height [cm].
    """
    area = sum((w + MARGIN) * (h + MARGIN) for w, h in sizes)
    wanted = max(SHEET_SHAPE * sqrt(area), max(w for w, _ in sizes) + 2 * MARGIN)
    spots: list[Spot] = [Spot(0, 0)] * len(sizes)
    x = y = width = MARGIN
    shelf = 0.0
    for k in sorted(range(len(sizes)), key=lambda k: (-sizes[k][1], k)):
        w, h = sizes[k]
        if x > MARGIN and x + w + MARGIN > wanted:
            x, y, shelf = MARGIN, y + shelf + MARGIN, 0.0
        spots[k] = Spot(x, y)
        x += w + MARGIN
        shelf = max(shelf, h)
        width = max(width, x)
    return spots, width, y + shelf + MARGIN


def _size(panel: Panel) -> tuple[float, float]:
    width, height = np.ptp(panel.outline.polygon, axis=0)
    return float(width), float(height)


@dataclass(frozen=True)
class _Sheet:
    """Takes a panel's points to the drawing: moved, y down, in mm."""

    dx: float
    dy: float
    height: float

    def point(self, point: Point) -> str:
        return f"{_mm(point[0] + self.dx)} {_mm(self.height - point[1] - self.dy)}"

    def line(self, css: str, a: Point, b: Point) -> str:
        (x1, y1), (x2, y2) = (self.point(p).split() for p in (a, b))
        return f'<line class="{css}" x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}"/>'


def _panel_group(
    number: int,
    panel: Panel,
    spot: Spot,
    height: float,
    sewn: dict[Side, tuple[int, Side, Stitch]],
    folds: Sequence[PleatFoldLine],
) -> str:
    low = panel.outline.polygon.min(axis=0)
    sheet = _Sheet(spot.x - float(low[0]), spot.y - float(low[1]), height)
    name = _text(panel.name)
    lines = [f'<g class="panel" id="panel-{number}" data-panel="{name}">']
    for k, curve in enumerate(panel.curves):
        partner = sewn.get(Side(panel.name, k))
        lines.append(
            f'<path id="panel-{number}-edge-{k}" class="edge{" sewn" if partner else ""}" '
            f'data-panel="{name}" data-edge="{k}"{_partner(partner)} d="{_path(curve, sheet)}"/>'
        )
    lines.extend(sheet.line("notch", *_notch_ends(panel, n.edge, n.at)) for n in panel.notches)
    lines.extend(
        sheet.line("fold" if fold.is_seen else "fold beneath", fold.start, fold.end)
        for fold in folds
    )
    x, y = (float(v) for v in centroid(panel.outline.polygon))
    if panel.grain is not None:
        reach = GRAIN_SHARE * min(_size(panel)) / 2
        gx, gy = panel.grain[0] * reach, panel.grain[1] * reach
        lines.append(sheet.line("grain", (x - gx, y - gy), (x + gx, y + gy)))
    size = min(TEXT_SIZE, 2 * _size(panel)[0] / max(len(panel.name), 1))
    px, py = sheet.point((x, y)).split()
    lines.append(f'<text x="{px}" y="{py}" font-size="{_mm(size)}">{name}</text>')
    return "\n".join([*lines, "</g>"])


def _folds(pattern: Pattern, panel: Panel) -> list[PleatFoldLine]:
    own = (pleat for pleat in pattern.pleats if pleat.panel == panel.name)
    return [fold for pleat in own for fold in fold_lines(pattern, pleat)]


def _partner(found: tuple[int, Side, Stitch] | None) -> str:
    if found is None:
        return ""
    number, partner, stitch = found
    ends = ' data-same-direction="true"' if stitch.same_direction else ""
    hue = round(number * GOLDEN_ANGLE % 360)
    return (
        f' data-stitch="{number}" data-partner-panel="{_text(partner.panel)}" '
        f'data-partner-edge="{partner.edge}"{ends} style="stroke: hsl({hue}, 70%, 42%)"'
    )


def _path(curve: Curve, sheet: _Sheet) -> str:
    start, end = sheet.point(curve.start), sheet.point(curve.end)
    if isinstance(curve, Bezier):
        controls = " ".join(sheet.point(c) for c in curve.controls)
        return f"M {start} {'Q' if len(curve.controls) == 1 else 'C'} {controls} {end}"
    if isinstance(curve, Arc):
        radius = _mm(curve.radius)
        # Here y points down, so an arc that bulges right runs against the sweep.
        return f"M {start} A {radius} {radius} 0 {int(curve.large)} {int(not curve.right)} {end}"
    return f"M {start} L {end}"


def _notch_ends(panel: Panel, edge: int, share: float) -> tuple[Point, Point]:
    """A notch from the edge into the cloth, which lies left of a counter-clockwise outline."""
    curve = panel.curves[edge]
    t = curve.parameter(share)
    before, here, after = curve.at(np.array([max(t - 1e-3, 0), t, min(t + 1e-3, 1)]))
    angle = atan2(*(after - before)[::-1])
    side = NOTCH_LENGTH if panel.outline.area > 0 else -NOTCH_LENGTH
    x, y = float(here[0]), float(here[1])
    return (x, y), (x - side * sin(angle), y + side * cos(angle))


def _mm(cm: float) -> str:
    """A length in mm to the hundredth of a micrometre, without a tail of zeros."""
    text = f"{cm * MM_PER_CM:.5f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _text(name: str) -> str:
    r"""Any text, fit for XML: what XML cannot hold is written as \uXXXX, the rest is escaped."""
    plain = NOT_XML.sub(lambda found: f"\\u{ord(found[0]):04x}", name)
    return escape(plain, {'"': "&quot;", "\n": "&#10;", "\t": "&#9;", "\r": "&#13;"})
