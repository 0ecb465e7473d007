"""Captions: what a garment is, in words, from the parameters that it was drafted with.

They say nothing that the parameters do not: a long sleeve is one of at least 80 % of the arm.
"""

from collections.abc import Mapping
from typing import Any

Steps = tuple[tuple[float, str], ...]

NAMES: Mapping[str, str] = {
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
}
SLEEVE_LENGTHS: Steps = ((0.5, "short"), (0.8, "three-quarter"), (9.9, "long"))
"""Words for less than a share of the arm."""
SLEEVE_SHAPES: Steps = ((0.0, "flared"), (0.35, "straight"), (9.9, "narrow"))
"""Words for less than a taper."""
LENGTHS: Mapping[str, Steps] = {
    "skirt_length": ((0.45, "mini"), (0.6, "knee-length"), (0.8, "midi"), (9.9, "maxi")),
    "body_length": ((42, "mini"), (58, "knee-length"), (70, "midi"), (999, "maxi")),
    "leg_length": ((0.35, "short-legged"), (0.75, "cropped"), (9.9, "full-length")),
}
"""Words for less than a share of the waist's height, than cm below the waist, and than a share of
the inside leg."""
FLARES: Mapping[str, Steps] = {
    "flare": ((0.1, "straight"), (0.3, "A-line"), (9.9, "wide")),
    "skirt_flare": ((0.1, "straight"), (0.3, "A-line"), (9.9, "wide")),
    "leg_flare": ((0.0, "tapered"), (8.0, "straight-legged"), (99.0, "flared")),
}
WITH_LENGTH = {"one-panel-dress", "top-skirt", "skirt", "one-panel-jumpsuit", "top-pants", "pants"}


def captions(kind: str, parameters: Mapping[str, Any]) -> tuple[str, ...]:
    """Three captions, the longest first.

    Example:
        >>> captions("skirt", {"skirt_length": 0.4, "skirt_flare": 0.2})
        ('a mini A-line skirt', 'a mini skirt', 'a skirt')
    """
    name = NAMES[kind]
    length = _first(LENGTHS, parameters) if kind in WITH_LENGTH else ""
    shape = _first(FLARES, parameters)
    extras = _extras(parameters)
    plain = _article(name)
    return (
        _article(" ".join(filter(None, (length, shape, name)))) + _listed(extras),
        _article(" ".join(filter(None, (length, name)))) + _listed(extras[:1]),
        plain,
    )


def _extras(parameters: Mapping[str, Any]) -> list[str]:
    found = []
    if parameters.get("sleeves") == "none":
        found.append("no sleeves")
    elif "sleeve_length" in parameters:
        long = _word(SLEEVE_LENGTHS, parameters["sleeve_length"])
        found.append(f"{long} {_word(SLEEVE_SHAPES, parameters['sleeve_taper'])} sleeves")
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


def _first(words: Mapping[str, Steps], parameters: Mapping[str, Any]) -> str:
    return next((_word(steps, parameters[n]) for n, steps in words.items() if n in parameters), "")


def _word(steps: Steps, value: float) -> str:
    return next(word for end, word in steps if value < end)


def _article(words: str) -> str:
    if words.endswith("trousers") and "of a top" not in words:
        return words
    return f"{'an' if words[0] in 'aeiouAEIO' else 'a'} {words}"


def _listed(extras: list[str]) -> str:
    if not extras:
        return ""
    *most, last = extras
    return " with " + (f"{', '.join(most)} and {last}" if most else last)
