"""Prompts of editing by text, and how the result of each is judged: by geometry, not by a network.

A prompt is asked only of garments of which it is not true already. "Long" and the like are judged
against the garment as it was: what is asked for is a change.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from garmentimage.body.measurements import measurements
from garmentimage.metrics.traits import Traits, placed_panels
from garmentimage.metrics.validity import drawing_faults
from garmentimage.pattern.model import Pattern
from garmentimage.text.contrast import (
    LONG_CM,
    LONG_SLEEVE_CM,
    NARROW_CM,
    SHORT_CM,
    SHORT_SLEEVE_CM,
    WIDE_CM,
)

LONGER_CM = 5.0
"""Less is no change of length."""
WIDER = 1.1
"""Nor is a width of less than this times the other."""
LEAST_PIECE = 100.0
"""Pieces of a panel above the waist that are smaller are not looked at [cm2]."""

Touched = Literal["sleeves", "below the waist"]


@dataclass(frozen=True)
class Prompt:
    """A text, and what it asks for."""

    text: str
    group: Literal["topology", "parts", "geometry"]
    touches: Touched
    """Where the garment may change."""
    holds: Callable[[Traits, Traits], bool]
    """Whether a garment, the second, is what the text makes of the first."""


PROMPTS = (
    Prompt("pants", "topology", "below the waist", lambda a, b: b.legs),
    Prompt("skirt", "topology", "below the waist", lambda a, b: not b.legs),
    Prompt("dress", "topology", "below the waist", lambda a, b: not b.legs and b.pieces == 1),
    Prompt("two pieces", "topology", "below the waist", lambda a, b: b.pieces == 2),
    Prompt("long sleeves", "parts", "sleeves", lambda a, b: (b.sleeves or 0) >= LONG_SLEEVE_CM),
    Prompt(
        "short sleeves",
        "parts",
        "sleeves",
        lambda a, b: b.sleeves is not None and b.sleeves <= SHORT_SLEEVE_CM,
    ),
    Prompt("sleeveless", "parts", "sleeves", lambda a, b: b.sleeves is None),
    Prompt("long", "geometry", "below the waist", lambda a, b: b.length >= a.length + LONGER_CM),
    Prompt("short", "geometry", "below the waist", lambda a, b: b.length <= a.length - LONGER_CM),
    Prompt("wide", "geometry", "below the waist", lambda a, b: b.width >= a.width * WIDER),
    Prompt("narrow", "geometry", "below the waist", lambda a, b: b.width <= a.width / WIDER),
    Prompt("flared", "geometry", "below the waist", lambda a, b: b.width >= a.width * WIDER),
)
EXTREME: dict[str, Callable[[Traits], bool]] = {
    "long": lambda t: t.length > LONG_CM[t.legs],
    "short": lambda t: t.length < SHORT_CM[t.legs],
    "wide": lambda t: t.width > WIDE_CM[t.legs],
    "flared": lambda t: t.width > WIDE_CM[t.legs],
    "narrow": lambda t: t.width < NARROW_CM[t.legs],
}
"""Garments that are so already, of which it is not asked."""


def is_asked(prompt: Prompt, start: Traits) -> bool:
    """Whether a prompt asks a garment for a change."""
    if prompt.group == "geometry":
        return not EXTREME[prompt.text](start)
    return not prompt.holds(start, start)


def kept(prompt: Prompt, start: Pattern, end: Pattern | None) -> float:
    """How much of what a text does not speak of stays: the mean IoU of the panels there.

    Where sleeves may change, all panels but them are looked at, else all that is of any panel above
    the waist. Centroids are aligned, as in `panel_iou`; what is missing or new counts 0.
    """
    import shapely
    from scipy.optimize import linear_sum_assignment

    if end is None or any(drawing_faults(panel) for panel in end.panels):
        return 0.0
    ious: list[float] = []
    for is_front in (True, False):
        one, two = (_staying(pattern, prompt.touches, is_front) for pattern in (start, end))
        shared = np.array(
            [[shapely.intersection(a, b).area / shapely.union(a, b).area for b in two] for a in one]
        ).reshape(len(one), len(two))
        pairs = linear_sum_assignment(shared, maximize=True)
        ious += [*shared[pairs], *[0.0] * abs(len(one) - len(two))]
    return float(np.mean(ious)) if ious else 1.0


def _staying(pattern: Pattern, touched: Touched, is_front: bool) -> list[Any]:
    """What of each panel should stay, its centroid at the origin, before the body or behind it."""
    import shapely
    import shapely.affinity

    above = shapely.box(-400, measurements("mean-female").waist_height, 400, 400)
    found = []
    for placed in placed_panels(pattern):
        if placed.is_front != is_front or (touched == "sleeves" and placed.is_sleeve):
            continue
        cloth = shapely.make_valid(shapely.Polygon(placed.outline))
        if touched != "sleeves":
            cloth = shapely.intersection(cloth, above)
        if cloth.area > LEAST_PIECE:
            x, y = cloth.centroid.x, cloth.centroid.y
            found.append(shapely.affinity.translate(cloth, -x, -y))
    return found
