"""Small garments made by code for the tests of placement and support."""

from dataclasses import replace

import numpy as np

from garmentimage.pattern.model import Circle, Edge, Loop, Panel, Pattern, Side, Stitch

FLAT_DEPTH = 16.0
"""How far front and back stand off the middle plane [cm]."""


def moved(pattern: Pattern, step) -> Pattern:
    """The pattern with its origin elsewhere."""
    return replace(
        pattern,
        panels=tuple(
            replace(p, translation=tuple(np.add(p.translation, step).tolist()))
            for p in pattern.panels
        ),
    )


def sheared(pattern: Pattern, slope: float = 0.4) -> Pattern:
    """The pattern, leaning to its wearer's left by so much of every height."""

    def lean(panel: Panel) -> Panel:
        by = slope * panel.matrix[0, 0]
        vertices = tuple((x + by * y, y) for x, y in panel.outline.vertices)
        x, y, z = panel.translation
        outline = replace(panel.outline, vertices=vertices)
        return replace(panel, outline=outline, translation=(x + slope * y, y, z))

    return replace(pattern, panels=tuple(lean(p) for p in pattern.panels))


def without(pattern: Pattern, *names: str) -> Pattern:
    """The pattern without panels of these names."""
    return replace(
        pattern,
        panels=tuple(p for p in pattern.panels if p.name not in names),
        stitches=tuple(s for s in pattern.stitches if not {s.a.panel, s.b.panel} & set(names)),
    )


def world(pattern: Pattern) -> np.ndarray:
    """Points of all outlines, placed [cm]."""
    return np.concatenate([p.to_world(p.outline.polygon) for p in pattern.panels])


def unnamed(pattern: Pattern, *, labels: bool = True) -> Pattern:
    """The pattern with names that tell nothing, its edges without labels if asked."""
    names = {panel.name: f"piece {k}" for k, panel in enumerate(pattern.panels)}

    def side(old: Side) -> Side:
        return Side(names[old.panel], old.edge)

    def loop(old: Loop) -> Loop:
        return (
            old if labels else replace(old, edges=tuple(replace(e, label=None) for e in old.edges))
        )

    onto = tuple(replace(o, panel=names[o.panel], on=names[o.on]) for o in pattern.onto)
    return replace(
        pattern,
        onto=onto,
        panels=tuple(
            replace(p, name=names[p.name], label=None, outline=loop(p.outline))
            for p in pattern.panels
        ),
        stitches=tuple(replace(s, a=side(s.a), b=side(s.b)) for s in pattern.stitches),
    )


def front_and_back(outline: Loop, seams: tuple[tuple[int, int], ...], height: float) -> Pattern:
    """The outline as a front and, mirrored, as a back; `seams` are edges of both."""
    front = Panel("front", outline, translation=(0.0, height, FLAT_DEPTH))
    back = replace(
        front, name="back", translation=(0.0, height, -FLAT_DEPTH), rotation=(0.0, 180.0, 0.0)
    )
    stitches = tuple(Stitch(Side("front", a), Side("back", b)) for a, b in seams)
    return Pattern((front, back), stitches, "made by a test")


def _loop(*vertices: tuple[float, float]) -> Loop:
    count = len(vertices)
    return Loop(vertices, tuple(Edge(k, (k + 1) % count) for k in range(count)))


def tube(top: float, *, length: float = 55.0, height: float = 104.0) -> Pattern:
    """A straight skirt of front and back whose waist is `top` round."""
    half = top / 4
    corners = ((-half, -length), (half, -length), (half, 0.0), (-half, 0.0))
    return front_and_back(_loop(*corners), ((1, 3), (3, 1)), height)


def strapless_dress(bust: float, waist: float, *, height: float = 104.0) -> Pattern:
    """A dress without straps whose top edge is `bust` round, its waist 22 cm below."""
    b, w = bust / 4, waist / 4
    corners = ((-2 * w, -60.0), (2 * w, -60.0), (w, 0.0), (b, 22.0), (-b, 22.0), (-w, 0.0))
    return front_and_back(_loop(*corners), ((1, 5), (2, 4), (4, 2), (5, 1)), height)


def circle_skirt(degrees: float, *, waist: float, length: float, height: float = 104.0) -> Pattern:
    """A skirt of two parts of a ring, `degrees` of it in all, without a band."""
    half = np.deg2rad(degrees) / 4
    inner = waist / (4 * half)
    outer = inner + length
    sin, cos = np.sin(half), np.cos(half)
    corners = (
        (-outer * sin, -outer * cos),
        (outer * sin, -outer * cos),
        (inner * sin, -inner * cos),
        (-inner * sin, -inner * cos),
    )
    outline = Loop(
        tuple((float(x), float(y + inner)) for x, y in corners),
        (
            Edge(0, 1, Circle(outer, bool(half > np.pi / 2), True)),
            Edge(1, 2),
            Edge(2, 3, Circle(inner, bool(half > np.pi / 2), False)),
            Edge(3, 0),
        ),
    )
    return front_and_back(outline, ((1, 3), (3, 1)), height)
