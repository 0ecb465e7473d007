"""Prompts for the evaluation of editing by text, each with a geometric test of its result.

A prompt is applied only to garments of which it is not yet true. "Long" and the like are tested
against the garment before the edit: they ask for a change.
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
    """A text with its test."""

    text: str
    group: Literal["topology", "parts", "geometry"]
    region: EditedRegion
    """Where the garment may change."""
    is_achieved: Callable[[ShapeAttributes, ShapeAttributes], bool]
    """Test of the attributes before and after an edit."""


PROMPTS = (
    Prompt("pants", "topology", "below the waist", lambda _, b: b.legs),
    Prompt("skirt", "topology", "below the waist", lambda _, b: not b.legs),
    Prompt("dress", "topology", "below the waist", lambda _, b: not b.legs and b.pieces == 1),
    Prompt("two pieces", "topology", "below the waist", lambda _, b: b.pieces == 2),
    Prompt("long sleeves", "parts", "sleeves", lambda _, b: (b.sleeves or 0) >= LONG_SLEEVE_CM),
    Prompt(
        "short sleeves",
        "parts",
        "sleeves",
        lambda _, b: b.sleeves is not None and b.sleeves <= SHORT_SLEEVE_CM,
    ),
    Prompt("sleeveless", "parts", "sleeves", lambda _, b: b.sleeves is None),
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
"""Tests of whether a prompt is true of a garment already."""


def is_applicable(prompt: Prompt, start: ShapeAttributes) -> bool:
    """Whether a prompt asks for a change of a garment."""
    if prompt.group == "geometry":
        return not ALREADY_TRUE[prompt.text](start)
    return not prompt.is_achieved(start, start)
