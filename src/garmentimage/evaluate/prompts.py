"""Prompts of editing by text, and how the result of each is judged: by geometry, not by a network.

A prompt is asked only of garments of which it is not true already. "Long" and the like are judged
against the garment as it was: what is asked for is a change.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from garmentimage.body.measurements import measurements
from garmentimage.evaluate.traits import Traits
from garmentimage.metrics.matching import loop_polygon
from garmentimage.metrics.validity import drawing_faults
from garmentimage.pattern.model import Panel, Pattern

LONGER_CM = 5.0
"""Less is no change of length."""
WIDER = 1.1
"""Nor is a width of less than this times the other."""
SHORT_SLEEVE_CM, LONG_SLEEVE_CM = 53.0, 66.0
"""Sleeves end before or after this, from the middle of the default body: 60 % and 83 % of the
arm."""

SLEEVES_FROM_CM = 4.0
"""Beyond the shoulder, where sleeves are."""

Touched = Literal["sleeves", "below the waist", "all"]


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
    "long": lambda t: t.length > (78.0 if t.legs else 62.0),
    "short": lambda t: t.length < (60.0 if t.legs else 48.0),
    "wide": lambda t: t.width > (34.0 if t.legs else 66.0),
    "flared": lambda t: t.width > (34.0 if t.legs else 66.0),
    "narrow": lambda t: t.width < (20.0 if t.legs else 48.0),
}
"""Garments that are so already, of which it is not asked."""


def is_asked(prompt: Prompt, start: Traits) -> bool:
    """Whether a prompt asks a garment for a change."""
    if prompt.group == "geometry":
        return not EXTREME[prompt.text](start)
    return not prompt.holds(start, start)


def kept(prompt: Prompt, start: Pattern, end: Pattern | None) -> float:
    """How much of what a text does not speak of stays: IoU of the cloth there, at the body.

    Of front and back together; where sleeves may change, all but them is looked at, else all that
    is above the waist.
    """
    import shapely

    if end is None or any(drawing_faults(panel) for panel in end.panels):
        return 0.0
    shares = []
    for sign in (1, -1):
        one, two = (_cloth(pattern.panels, sign, prompt.touches) for pattern in (start, end))
        both, either = shapely.intersection(one, two).area, shapely.union(one, two).area
        shares.append((both, either))
    both, either = np.sum(shares, axis=0)
    return float(both / either) if either else 1.0


def _cloth(panels: Sequence[Panel], sign: int, touched: Touched) -> Any:
    """Where untouched cloth lies before the body (1) or behind it (-1)."""
    import shapely

    low = measurements("mean-female").waist_height
    far = measurements("mean-female").shoulder_width / 2 + SLEEVES_FROM_CM
    stays = shapely.box(-far, 0, far, 400) if touched == "sleeves" else shapely.box(
        -200, low, 200, 400
    )  # fmt: skip
    found = []
    for panel in panels:
        world = panel.to_world(loop_polygon(panel.outline))
        if world[:, 2].mean() * sign > 0:
            found.append(shapely.make_valid(shapely.Polygon(world[:, :2])))
    return shapely.intersection(shapely.union_all(found), stays)
