"""Stubs dissolved: the edges beside a leftover edge of a millimetre meet."""

from collections.abc import Container
from dataclasses import replace
from math import dist

from garmentimage.pattern.model import Circle, Edge, Loop, Panel, Pattern, Point, Side
from garmentimage.pattern.seam_runs import stubs


def without_stubs(pattern: Pattern) -> Pattern:
    """The pattern without its stubs (see `seams`), its edges renumbered; itself where it has none.

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
    return replace(pattern, panels=tuple(panels), stitches=stitches)


def _without(panel: Panel, gone: Container[int], kept: list[int]) -> Panel:
    loops, first = [], 0
    for loop in panel.loops:
        count = len(loop.edges)
        loops.append(_closed_up(loop, [k for k in range(count) if first + k not in gone]))
        first += count
    notches = tuple(
        replace(notch, edge=kept.index(notch.edge))
        for notch in panel.notches
        if notch.edge not in gone
    )
    return replace(panel, outline=loops[0], holes=tuple(loops[1:]), notches=notches)


def _closed_up(loop: Loop, kept: list[int]) -> Loop:
    """A loop of some of its edges, each beginning where the one before it ends."""
    edges = [loop.edges[k] for k in kept]
    joined = [
        replace(edge, start=before.end)
        for before, edge in zip([edges[-1], *edges[:-1]], edges, strict=True)
    ]
    used = sorted({edge.start for edge in joined})
    vertices = tuple(loop.vertices[v] for v in used)
    return Loop(
        vertices,
        tuple(
            replace(
                _stretched(edge, old, loop.vertices),
                start=used.index(edge.start),
                end=used.index(edge.end),
            )
            for edge, old in zip(joined, edges, strict=True)
        ),
    )


def _stretched(edge: Edge, old: Edge, vertices: tuple[Point, ...]) -> Edge:
    """An edge with its shape kept; only arcs hold a length that goes with their chord's."""
    if not isinstance(edge.curvature, Circle) or edge.start == old.start:
        return edge
    before, now = (dist(vertices[e.start], vertices[e.end]) for e in (old, edge))
    radius = edge.curvature.radius * now / before
    return replace(edge, curvature=replace(edge.curvature, radius=radius))
