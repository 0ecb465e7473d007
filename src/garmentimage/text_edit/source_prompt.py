"""The source prompt of an edit: what is true of the garment in the aspect that a text is about.

"Long sleeves" is contrasted with "sleeveless" where there are none: the difference of the two
gradients then concerns sleeves only (see `guidance`). Words that apply to skirts and legs alike,
such as "wide", get the garment's bottom appended in both prompts, since the model associates most
of them with legs. Geometry reads the source prompt off the pattern; what it cannot read, such as
necklines, is left out.
"""

from functools import cache

import numpy as np
from jaxtyping import Float32

from garmentimage.dataset import all_phrases, aspect_of, bottoms_of
from garmentimage.learn.data import embed_texts
from garmentimage.metrics import ShapeAttributes, measure_shape
from garmentimage.pattern import Pattern

MIN_FAMILIARITY = 0.5
"""Texts are unfamiliar if their cosine similarity to every training phrase is less than this."""
SHORT_CM, LONG_CM = (48.0, 60.0), (62.0, 78.0)
"""Skirts and legs are short if they end less than this below the waist, long if more [cm]."""
NARROW_CM, WIDE_CM = (46.0, 25.0), (68.0, 31.0)
"""Skirts and legs are narrow if their hem is less wide than this, from side to side, and wide if it
is wider [cm]: the quartiles of the garments in recipe `text-edit`."""
SHORT_SLEEVE_CM, LONG_SLEEVE_CM = 31.0, 44.0
"""Sleeves are short if shorter than this and long if longer [cm], on the default body: they end
before 60 % and after 83 % of the arm."""


def nearest_phrase(text: str) -> tuple[float, str]:
    """The training phrase that is nearest to a text, after its cosine similarity.

    Raises:
        LearnError: the sentence encoder is not installed.
    """
    phrases, embeddings = _phrases()
    similarity = embeddings @ embed_texts([text])[0]
    best = int(similarity.argmax())
    return float(similarity[best]), phrases[best]


def edit_prompts(pattern: Pattern | None, text: str) -> tuple[str, str]:
    """The target prompt and the source prompt of an edit.

    Args:
        pattern: the garment; None if it has none.
        text: what it should become.

    Returns:
        The prompt for the edited garment, and the one that is true of the garment before the edit;
        empty if that is not known.

    Raises:
        LearnError: the sentence encoder is not installed.
    """
    shape = measure_shape(pattern)
    similarity, phrase = nearest_phrase(text)
    if shape is None or similarity < MIN_FAMILIARITY:
        return text, ""
    found = describe(shape)
    source = found.get(aspect_of(phrase), "")
    if len(bottoms_of(phrase)) > 1:
        return f"{text}, {found['bottom']}", f"{source}, {found['bottom']}"
    return text, source


def describe(shape: ShapeAttributes) -> dict[str, str]:
    """A true phrase by aspect, for the aspects that geometry can read."""
    legs = int(shape.legs)
    sleeves = shape.sleeves
    return {
        "kind": "a top and pants" if legs else "a dress",
        "bottom": "pants" if legs else "skirt",
        "pieces": "one piece" if shape.pieces == 1 else "two pieces",
        "sleeves": "sleeveless" if sleeves is None else _level(
            sleeves, SHORT_SLEEVE_CM, LONG_SLEEVE_CM,
            ("short sleeves", "three-quarter sleeves", "long sleeves"),
        ),
        "any sleeves": "sleeveless" if sleeves is None else "sleeves",
        "length": _level(
            shape.length, SHORT_CM[legs], LONG_CM[legs],
            ("short", "cropped" if legs else "knee-length", "long"),
        ),
        "width": _level(
            shape.width, NARROW_CM[legs], WIDE_CM[legs],
            ("narrow", "straight-legged" if legs else "A-line", "wide"),
        ),
    }  # fmt: skip


def _level(value: float, low: float, high: float, words: tuple[str, str, str]) -> str:
    return words[0] if value < low else words[2] if value > high else words[1]


@cache
def _phrases() -> tuple[tuple[str, ...], Float32[np.ndarray, "phrase text"]]:
    known = all_phrases()
    return known, embed_texts(known)
