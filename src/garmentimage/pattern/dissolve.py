"""Stubs dissolved: the edges beside a leftover edge of up to 2 mm are made to meet."""

from collections.abc import Container
from dataclasses import replace
from math import dist

from garmentimage.pattern.model import Circle, Edge, Loop, Panel, Pattern, Point, Side
from garmentimage.pattern.seam_runs import stubs


def without_stubs(pattern: Pattern) -> Pattern:
    """The pattern without its stubs (see `seam_runs`), edges renumbered; itself where it has none.

    The edge after a stub begins where the stub did; nothing else moves.
    """
    left_out = stubs(pattern)
    if not left_out:
        return pattern
    number: dict[Side, Side] = {}
    panels = []
    for panel in pattern.panels:
        gone = {side.edge for side in left_out if side.panel == panel.name}
        kept = [k for k in range(len(panel.edges)) if k not in gone]
        number |= {Side(panel.name, k): Side(panel.name, n) for n, k in enumerate(kept)}
        panels.append(_without(panel, gone, kept) if gone else panel)
    stitches = tuple(
        replace(stitch, a=number[stitch.a], b=number[stitch.b])
        for stitch in pattern.stitches
        if stitch.a not in left_out
    )
    onto = tuple(
        replace(o, edges=tuple(number[side].edge for side in o.sides if side in number))
        for o in pattern.onto
    )
    pleats = tuple(
        replace(p, edges=(number[p.sides[0]].edge, number[p.sides[1]].edge))
        for p in pattern.pleats
        if not left_out.intersection(p.sides)
    )
    return replace(pattern, panels=tuple(panels), stitches=stitches, onto=onto, pleats=pleats)


def _without(panel: Panel, gone: Container[int], kept: list[int]) -> Panel:
    outline, *holes = (
        _closed_up(loop, [k - numbers.start for k in numbers if k not in gone])
        for loop, numbers in zip(panel.loops, panel.edge_ranges, strict=True)
    )
    notches = tuple(
        replace(notch, edge=kept.index(notch.edge))
        for notch in panel.notches
        if notch.edge not in gone
    )
    return replace(panel, outline=outline, holes=tuple(holes), notches=notches)


def _closed_up(loop: Loop, kept: list[int]) -> Loop:
    """A loop of some of its edges, each beginning where the one before it ends."""
    edges = [loop.edges[k] for k in kept]
    joined = []
    for before, old in zip([edges[-1], *edges[:-1]], edges, strict=True):
        joined.append(_stretched(replace(old, start=before.end), old, loop.vertices))
    used = sorted({edge.start for edge in joined})
    return Loop(
        tuple(loop.vertices[v] for v in used),
        tuple(replace(e, start=used.index(e.start), end=used.index(e.end)) for e in joined),
    )


def _stretched(edge: Edge, old: Edge, vertices: tuple[Point, ...]) -> Edge:
    """An edge with its shape kept; only arcs hold a length that goes with their chord's."""
    if not isinstance(edge.curvature, Circle) or edge.start == old.start:
        return edge
    before, now = (dist(vertices[e.start], vertices[e.end]) for e in (old, edge))
    radius = edge.curvature.radius * now / before
    return replace(edge, curvature=replace(edge.curvature, radius=radius))
