"""Patterns changed as strangers' files are: traced, corners doubled, panels thin, tiny or huge."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from garmentimage.geometry.curves import Curve, Line
from garmentimage.pattern.model import Loop, Pattern, Side, loop_from_curves

Cut = Callable[[Side, Curve], list[tuple[Curve, bool]]]
"""The curves that an edge becomes, each with whether it is sewn where the edge was."""


def recut(pattern: Pattern, cut: Cut) -> Pattern:
    """The same garment with every edge cut as `cut` says; sewn parts keep their partners."""
    parts: dict[Side, list[int]] = {}
    panels = []
    for panel in pattern.panels:
        loops, k, number = [], 0, 0
        for loop in panel.loops:
            curves = []
            for curve in loop.curves:
                pieces = cut(Side(panel.name, k), curve)
                sewn = [number + n for n, (_, is_sewn) in enumerate(pieces) if is_sewn]
                parts[Side(panel.name, k)] = sewn
                curves += [piece for piece, _ in pieces]
                number += len(pieces)
                k += 1
            loops.append(loop_from_curves(curves))
        panels.append(replace(panel, outline=loops[0], holes=tuple(loops[1:]), notches=()))
    stitches = []
    for stitch in pattern.stitches:
        a, b = parts[stitch.a], parts[stitch.b]
        pairs = zip(a, b if stitch.same_direction else b[::-1], strict=True)
        stitches += [
            replace(stitch, a=Side(stitch.a.panel, x), b=Side(stitch.b.panel, y)) for x, y in pairs
        ]
    return replace(pattern, panels=tuple(panels), stitches=tuple(stitches))


def traced(pattern: Pattern, step: float) -> Pattern:
    """Every edge as straight ones of about `step` cm; sewn edges step by step, as CAD has them."""

    def count(side: Side) -> int:
        partner = pattern.partners.get(side, side)
        longest = max(pattern.curve(side).length, pattern.curve(partner).length)
        return max(1, math.ceil(longest / step - 1e-9))

    def cut(side: Side, curve: Curve) -> list[tuple[Curve, bool]]:
        points = [(float(x), float(y)) for x, y in curve.sample(count(side))]
        return [(Line(a, b), True) for a, b in pairwise(points)]

    return recut(pattern, cut)


def doubled(pattern: Pattern, corner: Side, size: float) -> Pattern:
    """A free edge of `size` cm put in before an edge, as an extra vertex that closes a loop."""

    def cut(side: Side, curve: Curve) -> list[tuple[Curve, bool]]:
        if side != corner:
            return [(curve, True)]
        stub, rest = curve.split(curve.parameter(size / curve.length))
        return [(stub, False), (rest, True)]

    return recut(pattern, cut)


def moved(pattern: Pattern, change: Callable[[np.ndarray], np.ndarray]) -> Pattern:
    """Every vertex put where `change` says: points [n, 2] -> [n, 2], in each panel's frame."""

    def loop(old: Loop) -> Loop:
        points = change(np.array(old.vertices, float))
        return replace(old, vertices=tuple((float(x), float(y)) for x, y in points))

    panels = [
        replace(p, outline=loop(p.outline), holes=tuple(loop(h) for h in p.holes))
        for p in pattern.panels
    ]
    return replace(pattern, panels=tuple(panels))
