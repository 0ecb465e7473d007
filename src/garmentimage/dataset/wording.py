"""Many wordings of what a garment is, from its parameters: what text-conditioned networks learn.

`captions` tells a garment in three sentences; here are the short phrases that people type when they
want a change: "long sleeves", "pants", "short and wide". Each is about one **aspect** of a garment,
and only said where the parameters are plainly so: sleeves of a middle length are neither short nor
long.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

Phrases = Mapping[str, tuple[str, ...]]

KINDS: Mapping[str, Phrases] = {
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
"""Of every garment of a kind, by aspect."""
LEVELS: Mapping[str, Mapping[str, tuple[tuple[float, float, tuple[str, ...]], ...]]] = {
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
"""Phrases for parameters of at least one value and less than another, by aspect."""
BOTTOMS = {"body_length": "skirt", "flare": "skirt", "leg_length": "pants", "leg_flare": "pants"}
"""What parameters are of that tell lengths and widths."""
NO_SLEEVES = ("sleeveless", "no sleeves", "without sleeves")
ANY_SLEEVES = ("sleeves", "with sleeves")
NECKLINES: Phrases = {
    "round": ("a round neckline", "crew neck"),
    "v": ("a V-neckline", "V-neck"),
    "square": ("a square neckline", "square neck"),
    "boat": ("a boat neckline", "boat neck"),
}
MAX_ASPECTS = 4
JOINTS = (", ", " and ", " with ", " ")


def phrases(kind: str, parameters: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    """What may be said of a garment, by aspect.

    Args:
        kind: a name from `kinds()`; of other kinds than dresses and tops + trousers the name is
            not among the phrases.
        parameters: as it was drafted.

    Example:
        >>> phrases("one-panel-dress", {"body_length": 70.0, "sleeves": "none"})["length"][0]
        'long'
    """
    told: dict[str, tuple[str, ...]] = dict(KINDS.get(kind, {}))
    for name, aspects in LEVELS.items():
        if name not in parameters or (name.startswith("sleeve_") and not _has_sleeves(parameters)):
            continue
        value = float(parameters[name])
        for aspect, levels in aspects.items():
            for low, high, words in levels:
                if low <= value < high:
                    told[aspect] = words
    if "sleeves" in parameters and not _has_sleeves(parameters):
        told["sleeves"] = NO_SLEEVES
    elif "sleeves" in parameters:
        told["any sleeves"] = ANY_SLEEVES
    if parameters.get("neckline") in NECKLINES:
        told["neckline"] = NECKLINES[parameters["neckline"]]
    return told


def random_prompt(kind: str, parameters: Mapping[str, Any], random: np.random.Generator) -> str:
    """A few of the phrases of a garment, chosen and joined at random; one alone most often."""
    told = list(phrases(kind, parameters).values())
    if not told:
        return kind
    count = min(1 + int(random.geometric(0.5) - 1), MAX_ASPECTS, len(told))
    chosen = [told[int(k)] for k in random.permutation(len(told))[:count]]
    words = [each[int(random.integers(len(each)))] for each in chosen]
    joint = JOINTS[int(random.integers(len(JOINTS)))] if count == 2 else ", "
    return joint.join(words)


def all_phrases() -> tuple[str, ...]:
    """All phrases that may be said of some garment."""
    return tuple(sorted(_aspects()))


def aspect_of(phrase: str) -> str:
    """What a phrase is about: "sleeves", "length"."""
    return _aspects()[phrase]


@cache
def synonyms(phrase: str) -> frozenset[str]:
    """All phrases that are said of the same garments, the phrase among them."""
    return frozenset(word for _, words in _groups() if phrase in words for word in words)


@cache
def bottoms_of(phrase: str) -> frozenset[str]:
    """Of what a length or width is said: "skirt", "pants" or both; of other phrases nothing."""
    return frozenset(
        bottom
        for name, bottom in BOTTOMS.items()
        for levels in LEVELS[name].values()
        for _, _, words in levels
        if phrase in words
    )


@cache
def _aspects() -> dict[str, str]:
    """Phrases with their aspects."""
    return {phrase: aspect for aspect, words in _groups() for phrase in words}


def _groups() -> list[tuple[str, tuple[str, ...]]]:
    """Phrases that are said together, with their aspect."""
    return [
        *(told for kind in KINDS.values() for told in kind.items()),
        *((aspect, words) for aspects in LEVELS.values() for aspect, levels in aspects.items()
          for _, _, words in levels),
        *(("neckline", words) for words in NECKLINES.values()),
        ("sleeves", NO_SLEEVES),
        ("any sleeves", ANY_SLEEVES),
    ]  # fmt: skip


def _has_sleeves(parameters: Mapping[str, Any]) -> bool:
    return bool(parameters.get("sleeves", "none") != "none")
