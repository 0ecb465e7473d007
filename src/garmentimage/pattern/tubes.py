"""Tubes: panels that are sewn to themselves all round, as a skirt of one rectangle.

A tube is drawn flat on one side of the body, and its seam lies on the other side.
"""

import numpy as np

from garmentimage.pattern.model import Panel, Pattern, Side
from garmentimage.pattern.placement import FRONTAL

TUBE_SHARE = 0.5
"""A panel whose sewn sides lie farther apart than this share of its size makes a tube: laid
flat with these sides joined, as those of a ring or a dart can be, it would tear."""


def tube_sides(pattern: Pattern, panel: Panel) -> tuple[list[Side], list[Side]] | None:
    """If a panel that faces front, back or up is a tube, its sides that are sewn together.

    First those at its lower end, along the axis of the world along which its ends lie apart.
    """
    if np.abs(panel.matrix[1:, 2]).max() < FRONTAL:
        return None
    size = float(np.ptp(panel.outline.polygon, axis=0).max())
    first, second = [], []
    for stitch in pattern.stitches:
        if stitch.a.panel != panel.name or stitch.b.panel != panel.name:
            continue
        middles = np.array([pattern.curve(side).sample(2)[1] for side in stitch.sides])
        if np.linalg.norm(middles[0] - middles[1]) <= TUBE_SHARE * size:
            continue
        gap = np.diff(panel.to_world(middles), axis=0)[0]
        lower = int(gap[np.abs(gap).argmax()] < 0)
        first.append(stitch.sides[lower])
        second.append(stitch.sides[1 - lower])
    return (first, second) if first else None
