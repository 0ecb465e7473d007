"""Prompts of editing by text, and how the result of each is judged: by geometry, not by a network.

A prompt is asked only of garments of which it is not true already. "Long" and the like are judged
against the garment as it was: what is asked for is a change.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from garmentimage.metrics import EditedRegion, ShapeAttributes
from garmentimage.text_edit import (
    LONG_CM,
    LONG_SLEEVE_CM,
    MIN_LENGTH_CHANGE_CM,
    MIN_WIDTH_RATIO,
    NARROW_CM,
    SHORT_CM,
    SHORT_SLEEVE_CM,
    WIDE_CM,
)


@dataclass(frozen=True)
class Prompt:
    """A text, and what it asks for."""

    text: str
    group: Literal["topology", "parts", "geometry"]
    region: EditedRegion
    """Where the garment may change."""
    is_achieved: Callable[[ShapeAttributes, ShapeAttributes], bool]
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
    Prompt(
        "long",
        "geometry",
        "below the waist",
        lambda a, b: b.length >= a.length + MIN_LENGTH_CHANGE_CM,
    ),
    Prompt(
        "short",
        "geometry",
        "below the waist",
        lambda a, b: b.length <= a.length - MIN_LENGTH_CHANGE_CM,
    ),
    Prompt(
        "wide", "geometry", "below the waist", lambda a, b: b.width >= a.width * MIN_WIDTH_RATIO
    ),
    Prompt(
        "narrow", "geometry", "below the waist", lambda a, b: b.width <= a.width / MIN_WIDTH_RATIO
    ),
    Prompt(
        "flared", "geometry", "below the waist", lambda a, b: b.width >= a.width * MIN_WIDTH_RATIO
    ),
)
ALREADY_TRUE: dict[str, Callable[[ShapeAttributes], bool]] = {
    "long": lambda t: t.length > LONG_CM[t.legs],
    "short": lambda t: t.length < SHORT_CM[t.legs],
    "wide": lambda t: t.width > WIDE_CM[t.legs],
    "flared": lambda t: t.width > WIDE_CM[t.legs],
    "narrow": lambda t: t.width < NARROW_CM[t.legs],
}
"""Garments that are so already, of which it is not asked."""


def is_applicable(prompt: Prompt, start: ShapeAttributes) -> bool:
    """Whether a prompt asks a garment for a change."""
    if prompt.group == "geometry":
        return not ALREADY_TRUE[prompt.text](start)
    return not prompt.is_achieved(start, start)
