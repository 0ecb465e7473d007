"""A garment seen in a mirror, and an image seen in one."""

from dataclasses import replace

import numpy as np

from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Loop,
    Panel,
    Pattern,
    Quadratic,
    Side,
    Stitch,
    euler_angles,
)

FLIP = np.diag([-1.0, 1.0, 1.0])


def mirrored_pattern(pattern: Pattern) -> Pattern:
    """x -> -x in the world; loops are reversed, so that they still run as seen from outside."""
    count = {p.name: [len(loop.edges) for loop in p.loops] for p in pattern.panels}

    def side(old: Side) -> Side:
        first = 0
        for n in count[old.panel]:
            if old.edge < first + n:
                return Side(old.panel, first + n - 1 - (old.edge - first))
            first += n
        raise AssertionError

    stitches = tuple(Stitch(side(s.a), side(s.b), s.same_direction) for s in pattern.stitches)
    return Pattern(tuple(map(_panel, pattern.panels)), stitches)


def _panel(panel: Panel) -> Panel:
    rotation = euler_angles(FLIP @ panel.matrix @ FLIP)
    x, y, z = panel.translation
    return replace(
        panel,
        outline=_loop(panel.outline),
        holes=tuple(map(_loop, panel.holes)),
        rotation=rotation,
        translation=(-x, y, z),
        notches=(),
    )


def _loop(loop: Loop) -> Loop:
    edges = tuple(
        replace(e, start=e.end, end=e.start, curvature=_curvature(e.curvature))
        for e in reversed(loop.edges)
    )
    return Loop(tuple((-x, y) for x, y in loop.vertices), edges)


def _curvature(curvature):
    """Mirrored and walked the other way: along turns round, the side stays."""
    match curvature:
        case None | Circle():
            return curvature
        case Quadratic((x, y)):
            return Quadratic((1 - x, y))
        case Cubic((x, y), (u, v)):
            return Cubic((1 - u, v), (1 - x, y))


def mirrored_types(image):
    """(flags, bottom types, left types) of the mirrored image; column 0 loses its left line."""
    inside = image.inside[..., ::-1]
    bottom = image.edge_type[:, 0, :, ::-1]
    left = np.zeros_like(image.edge_type[:, 1])
    left[..., 1:] = image.edge_type[:, 1, :, :0:-1]
    return inside, bottom, left
