"""Seams of which one side is cut by a vertex, and only a part of it is sewn."""

from collections.abc import Sequence

import numpy as np

from garmentimage.errors import quoted
from garmentimage.pattern.finding import Finding
from garmentimage.pattern.model import Panel, Pattern, Side, Stitch

SAME_LENGTH = 0.05
"""Lengths that differ by less than this share are the same, but for a little ease."""
MIN_MISSING = 0.1  # a free edge that is a smaller share of the longer side is not a forgotten half
SMOOTH = 0.94  # least cosine between edges that continue each other, 20 degrees


def half_sewn_findings(pattern: Pattern, numbers: Sequence[int]) -> list[Finding]:
    """Stitches whose shorter side continues as a free edge that makes up the difference.

    Args:
        pattern: one that passes `check_structure`.
        numbers: what messages call the stitches.
    """
    found = []
    for number, stitch in zip(numbers, pattern.stitches, strict=True):
        free = _forgotten(pattern, stitch)
        if free is not None:
            lengths = sorted(pattern.curve(side).length for side in stitch.sides)
            found.append(
                Finding(
                    f"stitch {number}",
                    f"sews {lengths[1]:.1f} cm to {lengths[0]:.1f} cm, and edge {free.edge} of "
                    f"panel {quoted(free.panel)} beside it, which is as long as the rest, is free; "
                    "sew it, too, by cutting the longer side",
                    "half-sewn",
                )
            )
    return found


def _forgotten(pattern: Pattern, stitch: Stitch) -> Side | None:
    """The free edge that continues where the shorter side ends, and is as long as the rest."""
    short, long = sorted(stitch.sides, key=lambda side: pattern.curve(side).length)
    whole = pattern.curve(long).length
    missing = whole - pattern.curve(short).length
    if missing < MIN_MISSING * whole:
        return None
    panel = pattern.by_name[short.panel]
    count = len(panel.outline.edges)
    if short.edge >= count:
        return None
    for step in (1, -1):
        beside = Side(short.panel, (short.edge + step) % count)
        length = pattern.curve(beside).length
        first, second = (short.edge, beside.edge) if step == 1 else (beside.edge, short.edge)
        if (
            beside not in pattern.partners
            and abs(length - missing) <= SAME_LENGTH * whole
            and _goes_on(panel, first, second)
        ):
            return beside
    return None


def _goes_on(panel: Panel, first: int, second: int) -> bool:
    """Whether the second edge leaves in about the direction in which the first arrives."""
    ends = panel.curves[first].at(np.array([0.98, 1.0]))
    starts = panel.curves[second].at(np.array([0.0, 0.02]))
    arriving, leaving = np.diff(ends, axis=0)[0], np.diff(starts, axis=0)[0]
    size = np.linalg.norm(arriving) * np.linalg.norm(leaving)
    return bool(size > 0 and arriving @ leaving >= SMOOTH * size)
