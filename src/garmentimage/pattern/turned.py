"""A garment turned over: every loop walked the other way."""

from dataclasses import replace

from garmentimage.pattern.model import Pattern, Side, loop_from_curves


def turned_over(pattern: Pattern) -> Pattern:
    """The same cloth at the same place, its other face out: every loop is walked the other way.

    Older files do not care in which direction loops run; one in which all run clockwise, seen from
    outside the body, is the inside-out of what it means. Names of edges are not kept.
    """
    number: dict[Side, Side] = {}
    panels = []
    for panel in pattern.panels:
        loops, first = [], 0
        for loop in panel.loops:
            last = first + len(loop.edges) - 1
            for k in range(len(loop.edges)):
                number[Side(panel.name, first + k)] = Side(panel.name, last - k)
            loops.append(loop_from_curves([curve.reversed() for curve in reversed(loop.curves)]))
            first = last + 1
        panels.append(replace(panel, outline=loops[0], holes=tuple(loops[1:]), notches=()))
    stitches = tuple(replace(s, a=number[s.a], b=number[s.b]) for s in pattern.stitches)
    return replace(pattern, panels=tuple(panels), stitches=stitches)
