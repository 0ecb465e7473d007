"""Panels whose edges run clockwise: files of older tools have them in any direction.

Seen from outside the body the edges of a panel run counter-clockwise; that says which face is the
right side, and which ends of a seam meet. A panel that runs the other way, though its place is
right, would be sewn with a twist. Where it stands tells: if the ends of seams lie nearer to each
other once all panels that face inwards run the other way, these are turned round. No cloth moves.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from garmentimage.pattern.checks import facing_inwards
from garmentimage.pattern.finding import Finding, some
from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Edge,
    Loop,
    Notch,
    Panel,
    Pattern,
    Point,
    Quadratic,
    Side,
)

NEARER_CM = 1e-6  # rounding of the mean distance of seam ends


def outward(pattern: Pattern) -> tuple[Pattern, tuple[Finding, ...]]:
    """The pattern with panels turned round that run clockwise, and a finding that names them.

    Args:
        pattern: one that passes `check_structure`.
    """
    names = facing_inwards(pattern)
    if not names:
        return pattern, ()
    turned = turned_round(pattern, names)
    if _apart(turned) > _apart(pattern) + NEARER_CM:
        return pattern, ()
    message = "ran clockwise seen from outside the body, and was turned round; no cloth moved"
    if len(names) > 1:
        message = message.replace("was turned", "were turned")
    return turned, (Finding(f"panel {some(names)}", message, "clockwise"),)


def turned_edge(edge: Edge) -> Edge:
    """The same curve walked the other way."""
    curvature = edge.curvature
    match curvature:
        case Quadratic(control):
            curvature = Quadratic(_seen_from_end(control))
        case Cubic(control, control2):
            curvature = Cubic(_seen_from_end(control2), _seen_from_end(control))
        case Circle():
            curvature = replace(curvature, right=not curvature.right)
    return replace(edge, start=edge.end, end=edge.start, curvature=curvature)


def _seen_from_end(control: Point) -> Point:
    return 1 - control[0], -control[1]


def turned_round(pattern: Pattern, names: Collection[str]) -> Pattern:
    """The pattern with the loops of some panels walked the other way; edges get new numbers.

    The cloth stays in its place, its other face out.
    """
    new_number = {
        panel.name: [k for numbers in panel.edge_ranges for k in reversed(numbers)]
        for panel in pattern.panels
        if panel.name in names
    }

    def side(given: Side) -> Side:
        numbers = new_number.get(given.panel)
        return given if numbers is None else Side(given.panel, numbers[given.edge])

    return replace(
        pattern,
        panels=tuple(
            _turned_panel(panel, new_number[panel.name]) if panel.name in names else panel
            for panel in pattern.panels
        ),
        stitches=tuple(replace(s, a=side(s.a), b=side(s.b)) for s in pattern.stitches),
        onto=tuple(
            replace(o, edges=tuple(sorted(side(edge).edge for edge in o.sides)))
            for o in pattern.onto
        ),
        pleats=tuple(
            replace(p, edges=(side(p.sides[1]).edge, side(p.sides[0]).edge))
            if p.panel in names
            else p
            for p in pattern.pleats
        ),
    )


def _turned_panel(panel: Panel, numbers: list[int]) -> Panel:
    outline, *holes = (
        Loop(loop.vertices, tuple(turned_edge(e) for e in reversed(loop.edges)))
        for loop in panel.loops
    )
    notches = tuple(Notch(numbers[n.edge], 1 - n.at) for n in panel.notches)
    return replace(panel, outline=outline, holes=tuple(holes), notches=notches)


def _apart(pattern: Pattern) -> float:
    """Mean distance of the ends that seams bring together, as the panels stand [cm]."""
    ends = np.array([0.0, 1.0])
    total = 0.0
    for stitch in pattern.stitches:
        a, b = (pattern.in_world(side, ends) for side in stitch.sides)
        total += float(np.linalg.norm(a - (b if stitch.same_direction else b[::-1])))
    return total / max(len(pattern.stitches), 1)
