"""Garments in words: captions and prompts, from the parameters that a garment was drafted with.

- A **caption** describes one garment in a sentence; every value of a parameter has a word.
- A **prompt** is a short phrase as people type it to ask for a change: "long sleeves", "pants",
  "short and wide". Each phrase is about one **aspect** of a garment, and used only where the
  parameters are clearly so: sleeves of a medium length are neither short nor long.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

Levels = tuple[tuple[float, str], ...]
"""Words, each for values less than a limit; the first that applies is used."""
Phrases = Mapping[str, tuple[str, ...]]
"""Phrases of one meaning, by aspect or by value of a parameter."""

# --- Captions -----------------------------------------------------------------------------------

NOUNS: Mapping[str, str] = {
    "one-panel-dress": "dress",
    "one-panel-jumpsuit": "jumpsuit",
    "top-skirt": "dress of a top and a skirt",
    "top-pants": "jumpsuit of a top and trousers",
    "shirt": "shirt",
    "skirt": "skirt",
    "pants": "trousers",
    "tee": "T-shirt",
    "tank": "tank top",
    "jacket": "jacket",
    "hoodie": "hoodie",
    "blazer": "blazer",
    "coat": "coat",
    "vest": "vest",
    "blouse": "blouse",
    "cargo-pants": "cargo trousers",
    "pocket-skirt": "skirt",
    "peplum-top": "peplum top",
    "pleated-skirt": "pleated skirt",
    "button-shirt": "open shirt",
    "polo-shirt": "polo shirt",
    "turtleneck": "turtleneck",
}
SLEEVE_LENGTH_WORDS: Levels = ((0.5, "short"), (0.8, "three-quarter"), (9.9, "long"))
"""By `sleeve_length`, as a share of the arm."""
SLEEVE_SHAPE_WORDS: Levels = ((0.0, "flared"), (0.35, "straight"), (9.9, "narrow"))
"""By `sleeve_taper`."""
LENGTH_WORDS: Mapping[str, Levels] = {
    "skirt_length": ((0.45, "mini"), (0.6, "knee-length"), (0.8, "midi"), (9.9, "maxi")),
    "body_length": ((42, "mini"), (58, "knee-length"), (70, "midi"), (999, "maxi")),
    "leg_length": ((0.35, "short-legged"), (0.75, "cropped"), (9.9, "full-length")),
}
"""As shares of the waist's height, in cm below the waist, and as shares of the inside leg."""
FLARE_WORDS: Mapping[str, Levels] = {
    "flare": ((0.1, "straight"), (0.3, "A-line"), (9.9, "wide")),
    "skirt_flare": ((0.1, "straight"), (0.3, "A-line"), (9.9, "wide")),
    "leg_flare": ((0.0, "tapered"), (8.0, "straight-legged"), (99.0, "flared")),
}
KINDS_WITH_LENGTH = frozenset(
    {"one-panel-dress", "top-skirt", "skirt", "one-panel-jumpsuit", "top-pants", "pants"}
)
"""Captions of these kinds name the length."""


def captions(kind: str, parameters: Mapping[str, Any]) -> tuple[str, ...]:
    """Three captions, the longest first.

    Args:
        kind: a name from `kinds()`.
        parameters: of the draft.

    Example:
        >>> captions("skirt", {"skirt_length": 0.4, "skirt_flare": 0.2})
        ('a mini A-line skirt', 'a mini skirt', 'a skirt')
    """
    name = NOUNS[kind]
    length = _first(LENGTH_WORDS, parameters) if kind in KINDS_WITH_LENGTH else ""
    shape = _first(FLARE_WORDS, parameters)
    extras = _extras(parameters)
    plain = _article(name)
    return (
        _article(" ".join(filter(None, (length, shape, name)))) + _listed(extras),
        _article(" ".join(filter(None, (length, name)))) + _listed(extras[:1]),
        plain,
    )


def _extras(parameters: Mapping[str, Any]) -> list[str]:
    """Sleeves, neckline, cutout and darts."""
    found = []
    if parameters.get("sleeves") == "none":
        found.append("no sleeves")
    elif "sleeve_length" in parameters:
        long = _word(SLEEVE_LENGTH_WORDS, parameters["sleeve_length"])
        found.append(f"{long} {_word(SLEEVE_SHAPE_WORDS, parameters['sleeve_taper'])} sleeves")
    if "neckline" in parameters:
        neck = {"v": "V-neckline", "boat": "boat neckline"}.get(
            parameters["neckline"], f"{parameters['neckline']} neckline"
        )
        found.append(_article(neck))
    if parameters.get("cutout", "none") != "none":
        found.append(f"a hole in the {parameters['cutout']}")
    darts = [
        side for side in ("front", "back") if parameters.get(f"{side}_darts", "none") != "none"
    ]
    if darts:
        found.append(f"darts in the {' and the '.join(darts)}")
    return found


def _first(words: Mapping[str, Levels], parameters: Mapping[str, Any]) -> str:
    return next((_word(each, parameters[n]) for n, each in words.items() if n in parameters), "")


def _word(levels: Levels, value: float) -> str:
    return next(word for limit, word in levels if value < limit)


def _article(words: str) -> str:
    if words.endswith("trousers") and "of a top" not in words:
        return words
    return f"{'an' if words[0] in 'aeiouAEIO' else 'a'} {words}"


def _listed(extras: list[str]) -> str:
    if not extras:
        return ""
    *most, last = extras
    return " with " + (f"{', '.join(most)} and {last}" if most else last)


# --- Prompts ------------------------------------------------------------------------------------

KIND_PHRASES: Mapping[str, Phrases] = {
    "one-panel-dress": {
        "kind": ("a dress", "dress", "a one-piece dress", "a gown", "a frock"),
        "bottom": ("a skirt", "skirt", "with a skirt", "a skirt instead of pants"),
        "pieces": ("one piece", "one-piece", "in one piece", "no waist seam"),
    },
    "top-pants": {
        "kind": ("a top and pants", "a top and trousers", "a top with trousers", "a jumpsuit"),
        "bottom": ("pants", "trousers", "with pants", "with trousers", "legs", "slacks"),
        "pieces": ("two pieces", "two-piece", "in two pieces", "a seam at the waist"),
    },
}
"""Phrases for every garment of a kind, by aspect."""
LEVEL_PHRASES: Mapping[str, Mapping[str, tuple[tuple[float, float, tuple[str, ...]], ...]]] = {
    "body_length": {
        "length": (
            (0, 45, ("short", "a short dress", "a mini dress", "above the knee", "shorter")),
            (52, 60, ("knee-length", "to the knee")),
            (65, 999, ("long", "a long dress", "a maxi dress", "below the knee", "longer")),
        )
    },
    "flare": {
        "width": (
            (0, 0.12, ("narrow", "a narrow skirt", "slim", "straight", "a pencil skirt")),
            (0.2, 0.3, ("an A-line skirt", "A-line")),
            (0.34, 9, ("wide", "a wide skirt", "flared", "a flared skirt", "a circle skirt")),
        )
    },
    "leg_length": {
        "length": (
            (0, 0.4, ("short", "shorts", "short pants", "short legs", "shorter")),
            (0.5, 0.75, ("cropped", "cropped pants", "capri pants")),
            (0.82, 9, ("long", "long pants", "full-length trousers", "long legs", "longer")),
        )
    },
    "leg_flare": {
        "width": (
            (-9, 1, ("narrow", "narrow legs", "slim", "tapered", "skinny pants")),
            (4, 8, ("straight-legged", "straight pants")),
            (14, 99, ("wide", "wide legs", "flared", "flared pants", "bell-bottoms")),
        )
    },
    "sleeve_length": {
        "sleeves": (
            (0, 0.55, ("short sleeves", "with short sleeves", "short-sleeved")),
            (0.62, 0.78, ("three-quarter sleeves", "sleeves to below the elbow")),
            (0.86, 9, ("long sleeves", "with long sleeves", "long-sleeved")),
        )
    },
    "sleeve_taper": {
        "sleeve shape": (
            (-9, 0.1, ("bell sleeves", "wide sleeves", "flared sleeves")),
            (0.7, 9, ("narrow sleeves", "tight sleeves")),
        )
    },
    "bust_ease": {
        "fit": (
            (0, 6, ("tight", "close-fitting", "fitted")),
            (17, 99, ("loose", "oversized", "baggy")),
        )
    },
}
"""By parameter and aspect: phrases for values of at least one limit and less than another."""
BOTTOMS = {"body_length": "skirt", "flare": "skirt", "leg_length": "pants", "leg_flare": "pants"}
"""The part of the garment that a length or width belongs to."""
NO_SLEEVES = ("sleeveless", "no sleeves", "without sleeves")
ANY_SLEEVES = ("sleeves", "with sleeves")
NECKLINES: Phrases = {
    "round": ("a round neckline", "crew neck"),
    "v": ("a V-neckline", "V-neck"),
    "square": ("a square neckline", "square neck"),
    "boat": ("a boat neckline", "boat neck"),
}
MAX_ASPECTS = 4
SEPARATORS = (", ", " and ", " with ", " ")


def phrases(kind: str, parameters: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    """The phrases that are true of a garment, by aspect.

    Args:
        kind: a name from `kinds()`; only dresses and tops + trousers have phrases for their kind.
        parameters: of the draft.

    Example:
        >>> phrases("one-panel-dress", {"body_length": 70.0, "sleeves": "none"})["length"][0]
        'long'
    """
    found: dict[str, tuple[str, ...]] = dict(KIND_PHRASES.get(kind, {}))
    for name, aspects in LEVEL_PHRASES.items():
        if name not in parameters or (name.startswith("sleeve_") and not _has_sleeves(parameters)):
            continue
        value = float(parameters[name])
        for aspect, levels in aspects.items():
            for low, high, words in levels:
                if low <= value < high:
                    found[aspect] = words
    if "sleeves" in parameters and not _has_sleeves(parameters):
        found["sleeves"] = NO_SLEEVES
    elif "sleeves" in parameters:
        found["any sleeves"] = ANY_SLEEVES
    if parameters.get("neckline") in NECKLINES:
        found["neckline"] = NECKLINES[parameters["neckline"]]
    return found


def random_prompt(kind: str, parameters: Mapping[str, Any], random: np.random.Generator) -> str:
    """Some of the phrases of a garment, chosen and joined at random; most often only one.

    Args:
        kind: a name from `kinds()`.
        parameters: of the draft.
        random: for the choice.
    """
    choices = list(phrases(kind, parameters).values())
    if not choices:
        return kind
    count = min(1 + int(random.geometric(0.5) - 1), MAX_ASPECTS, len(choices))
    chosen = [choices[int(k)] for k in random.permutation(len(choices))[:count]]
    words = [each[int(random.integers(len(each)))] for each in chosen]
    separator = SEPARATORS[int(random.integers(len(SEPARATORS)))] if count == 2 else ", "
    return separator.join(words)


def all_phrases() -> tuple[str, ...]:
    """All phrases, in alphabetical order."""
    return tuple(sorted(_aspects()))


def aspect_of(phrase: str) -> str:
    """The aspect of a phrase: "sleeves", "length"."""
    return _aspects()[phrase]


@cache
def synonyms(phrase: str) -> frozenset[str]:
    """All phrases of the same meaning, including the phrase itself."""
    return frozenset(word for _, words in _groups() if phrase in words for word in words)


@cache
def bottoms_of(phrase: str) -> frozenset[str]:
    """What a length or width may describe: "skirt", "pants" or both; empty for other phrases."""
    return frozenset(
        bottom
        for name, bottom in BOTTOMS.items()
        for levels in LEVEL_PHRASES[name].values()
        for _, _, words in levels
        if phrase in words
    )


@cache
def _aspects() -> dict[str, str]:
    """Phrases with their aspects."""
    return {phrase: aspect for aspect, words in _groups() for phrase in words}


def _groups() -> list[tuple[str, tuple[str, ...]]]:
    """Groups of phrases of one meaning, with their aspect."""
    return [
        *(group for kind in KIND_PHRASES.values() for group in kind.items()),
        *((aspect, words) for aspects in LEVEL_PHRASES.values()
          for aspect, levels in aspects.items() for _, _, words in levels),
        *(("neckline", words) for words in NECKLINES.values()),
        ("sleeves", NO_SLEEVES),
        ("any sleeves", ANY_SLEEVES),
    ]  # fmt: skip


def _has_sleeves(parameters: Mapping[str, Any]) -> bool:
    return bool(parameters.get("sleeves", "none") != "none")
