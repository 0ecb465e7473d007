"""Small patterns for tests of placing and drawing: rectangles on the body, sewn as a test wants."""

from dataclasses import replace

import numpy as np

from garmentimage.geometry.curves import Line
from garmentimage.pattern.model import (
    Circle,
    Edge,
    Loop,
    Panel,
    Pattern,
    Side,
    Stitch,
    loop_from_curves,
)
from garmentimage.raster.frame import BodyFrame

BOTTOM, RIGHT, TOP, LEFT = range(4)
"""Edges of `rectangle`, counter-clockwise."""

BACK = (0.0, 180.0, 0.0)
"""Rotation of a panel that faces back."""
LEFT_SIDE = (0.0, 90.0, 0.0)
"""Rotation of a panel that faces the wearer's left, the right of a picture of the front."""


def square_frame(grid: int, cell: float, *, left: float, bottom: float) -> BodyFrame:
    """Square cells of `cell` cm whose lower left corner lies at (left, bottom) [cm]."""
    columns, rows = (tuple(low + cell * k for k in range(grid + 1)) for low in (left, bottom))
    return BodyFrame(columns, rows)


def polygon(name, points, place, rotation=(0.0, 0.0, 0.0), holes=()):
    """A panel with straight edges; edge k leaves point k."""
    points = [(float(x), float(y)) for x, y in points]
    return Panel(name, _loop(points), holes, translation=place, rotation=rotation)


def rectangle(name, width, height, place, rotation=(0.0, 0.0, 0.0), holes=()):
    """A panel centred on its origin."""
    x, y = width / 2, height / 2
    return polygon(name, [(-x, -y), (x, -y), (x, y), (-x, y)], place, rotation, holes)


def _loop(points):
    ends = [*points[1:], points[0]]
    return loop_from_curves([Line(a, b) for a, b in zip(points, ends, strict=True)])


def stitch(a, i, b, j, *, same_direction=False):
    return Stitch(Side(a, i), Side(b, j), same_direction)


def tube(width=50.0, height=60.0, middle=70.0):
    """A skirt of a front and a back."""
    return Pattern(
        (
            rectangle("front", width, height, (0.0, middle, 20.0)),
            rectangle("back", width, height, (0.0, middle, -20.0), BACK),
        ),
        (stitch("front", RIGHT, "back", LEFT), stitch("front", LEFT, "back", RIGHT)),
    )


def gored_tube(depth=30.0):
    """A skirt of a front, a back and a gore on the wearer's left that wraps round the side."""
    gore = rectangle("gore", depth, 60.0, (30.0, 70.0, 0.0), LEFT_SIDE)
    front, back = tube().panels
    return Pattern(
        (front, back, gore),
        (
            stitch("front", RIGHT, "gore", LEFT),
            stitch("gore", RIGHT, "back", LEFT),
            stitch("front", LEFT, "back", RIGHT),
        ),
    )


def ring(degrees, sewn=False):
    """A ring of a circle skirt, with a gap behind."""
    inner, outer, half = 10.0, 40.0, np.deg2rad(degrees) / 2
    at = np.array([half, -half])
    points = [
        (r * np.sin(a), r * np.cos(a)) for r, ends in ((inner, at), (outer, at[::-1])) for a in ends
    ]
    edges = (
        Edge(0, 1, Circle(inner, degrees > 180, False)),
        Edge(1, 2),
        Edge(2, 3, Circle(outer, degrees > 180, True)),
        Edge(3, 0),
    )
    panel = Panel("ring", Loop(tuple((float(x), float(y)) for x, y in points), edges))
    panel = replace(panel, translation=(0.0, 100.0, 15.0))
    if panel.outline.area < 0:
        curves = [curve.reversed() for curve in reversed(panel.outline.curves)]
        panel = replace(panel, outline=loop_from_curves(curves))
    straight = [k for k, curve in enumerate(panel.curves) if curve.is_straight]
    seam = Stitch(*(Side("ring", k) for k in straight))
    return Pattern((panel,), (seam,) if sewn else ())
