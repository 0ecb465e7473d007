"""What is true of a garment, of that which a text speaks of: what an edit sets the text against.

"Long sleeves" is set against "sleeveless" where there are none: the difference is about sleeves
and nothing else. Words that are said of skirts and of legs alike, such as "wide", are told with
what the garment has, on both sides: else most of what is wide in the model's eyes has legs. What is
true is read off the pattern by geometry; what cannot be read, such as necklines, is left out.
"""

from functools import cache

import numpy as np
from jaxtyping import Float32

from garmentimage.dataset import all_phrases, aspect_of, bottoms_of
from garmentimage.learn.data import embedded
from garmentimage.metrics import ShapeAttributes, measure_shape
from garmentimage.pattern import Pattern

MIN_FAMILIARITY = 0.5
"""Texts whose meaning is less near than this to all that is said of garments are strange."""
SHORT_CM, LONG_CM = (48.0, 60.0), (62.0, 78.0)
"""Skirts and legs that end less far below the waist are short, those that end further are long."""
NARROW_CM, WIDE_CM = (46.0, 25.0), (68.0, 31.0)
"""Skirts and legs that are less wide at the hem, from side to side, are narrow, wider ones wide:
the outer quarters of the garments that `text-edit` trains on."""
SHORT_SLEEVE_CM, LONG_SLEEVE_CM = 31.0, 44.0
"""Sleeves that are shorter or longer than this, of the default body: they end before 60 % and after
83 % of the arm."""


def nearest_phrase(text: str) -> tuple[float, str]:
    """How near a text is to what is said of garments in training, and the phrase that is nearest.

    From 1, the same, to 0 or less.

    Raises:
        LearnError: the sentence encoder is not installed.
    """
    phrases, meanings = _phrases()
    near = meanings @ embedded([text])[0]
    best = int(near.argmax())
    return float(near[best]), phrases[best]


def edit_prompts(pattern: Pattern | None, text: str) -> tuple[str, str]:
    """A text as a model should be told it of a garment, and what is true instead.

    Args:
        pattern: the garment; None if it is none.
        text: what is said.

    Returns:
        The text, and what is true of that which it speaks of; empty if that is not known.
    """
    found = measure_shape(pattern)
    near, phrase = nearest_phrase(text)
    if found is None or near < MIN_FAMILIARITY:
        return text, ""
    said = describe(found)
    true = said.get(aspect_of(phrase), "")
    if len(bottoms_of(phrase)) > 1:
        return f"{text}, {said['bottom']}", f"{true}, {said['bottom']}"
    return text, true


def describe(found: ShapeAttributes) -> dict[str, str]:
    """A phrase for each aspect of a garment that its traits tell."""
    legs = int(found.legs)
    sleeves = found.sleeves
    return {
        "kind": "a top and pants" if legs else "a dress",
        "bottom": "pants" if legs else "skirt",
        "pieces": "one piece" if found.pieces == 1 else "two pieces",
        "sleeves": "sleeveless" if sleeves is None else _level(
            sleeves, SHORT_SLEEVE_CM, LONG_SLEEVE_CM,
            ("short sleeves", "three-quarter sleeves", "long sleeves"),
        ),
        "any sleeves": "sleeveless" if sleeves is None else "sleeves",
        "length": _level(
            found.length, SHORT_CM[legs], LONG_CM[legs],
            ("short", "cropped" if legs else "knee-length", "long"),
        ),
        "width": _level(
            found.width, NARROW_CM[legs], WIDE_CM[legs],
            ("narrow", "straight-legged" if legs else "A-line", "wide"),
        ),
    }  # fmt: skip


def _level(value: float, low: float, high: float, words: tuple[str, str, str]) -> str:
    return words[0] if value < low else words[2] if value > high else words[1]


@cache
def _phrases() -> tuple[tuple[str, ...], Float32[np.ndarray, "phrase text"]]:
    known = all_phrases()
    return known, embedded(known)
