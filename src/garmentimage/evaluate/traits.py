"""What a garment is like, read off its pattern by geometry: what edits by text are judged by.

All of it is told from the front panels as they stand at the body, in world coordinates [cm]: x to
the wearer's left, y up from the floor. No network has a say.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from garmentimage.body.measurements import measurements
from garmentimage.metrics.matching import loop_polygon
from garmentimage.metrics.validity import drawing_faults
from garmentimage.pattern.model import Pattern

SLEEVE_FROM, SLEEVE_BELOW = 26.0, 30.0
"""Panels whose middle is further than this from the body's middle, and no lower than this under the
top of the garment, are sleeves [cm]."""
LEVELS = (3.0, 6.0, 9.0)
"""Heights above the hem at which legs are looked for [cm]."""
LEG_GAP = 0.5
"""Legs are further apart than this [cm]."""
MIDDLE = 12.0
"""The gap between them is no further than this from the body's middle [cm]."""
MIDDLE_LINES = (-9.0, 9.0)
"""Where panels that lie on top of each other are counted [cm]."""


@dataclass(frozen=True)
class Traits:
    """What a garment is like."""

    legs: bool
    """Two separate pieces of cloth at the hem."""
    pieces: int
    """Panels on top of each other in front, without sleeves: 2 where there is a waist seam."""
    sleeves: float | None
    """From the body's middle to the end of the sleeves [cm]; None without."""
    length: float
    """From the waist of the default body down to the hem [cm]."""
    width: float
    """Of the front at the hem, of one leg where there are legs [cm]."""


def traits(pattern: Pattern | None) -> Traits | None:
    """What a garment is like; None where there is nothing to see in front."""
    if pattern is None or any(drawing_faults(panel) for panel in pattern.panels):
        return None
    front = [
        world[:, :2]
        for panel in pattern.panels
        if (world := panel.to_world(loop_polygon(panel.outline)))[:, 2].mean() > 0
    ]
    if not front:
        return None
    top = max(float(outline[:, 1].max()) for outline in front)
    sleeves = [outline for outline in front if _is_sleeve(outline, top)]
    body = [outline for outline in front if not _is_sleeve(outline, top)]
    if not body:
        return None
    hem = min(float(outline[:, 1].min()) for outline in body)
    cuts = [_cut(body, hem + level) for level in LEVELS]
    legs = sum(_is_split(cut) for cut in cuts) * 2 > len(cuts)
    wide = sum(end - start for start, end in cuts[-1])
    return Traits(
        legs=legs,
        pieces=max(_stacked(body, x) for x in MIDDLE_LINES),
        sleeves=max(float(np.abs(outline[:, 0]).max()) for outline in sleeves) if sleeves else None,
        length=measurements("mean-female").waist_height - hem,
        width=wide / 2 if legs else wide,
    )


def _is_sleeve(outline: Float[np.ndarray, "n 2"], top: float) -> bool:
    x, y = (outline.min(0) + outline.max(0)) / 2
    return bool(abs(x) > SLEEVE_FROM and y > top - SLEEVE_BELOW)


def _cut(outlines: Sequence[Float[np.ndarray, "n 2"]], height: float) -> list[tuple[float, float]]:
    """Stretches of cloth at a height, from the right to the left of the wearer [cm]."""
    found = []
    for outline in outlines:
        found += _crossed(outline, axis=1, at=height)
    return sorted(found)


def _stacked(outlines: Sequence[Float[np.ndarray, "n 2"]], x: float) -> int:
    """Panels that a line down the body crosses."""
    return sum(bool(_crossed(outline, axis=0, at=x)) for outline in outlines)


def _crossed(
    outline: Float[np.ndarray, "n 2"], *, axis: int, at: float
) -> list[tuple[float, float]]:
    """Where a line lies within an outline, by the even-odd rule."""
    after = np.roll(outline, -1, axis=0)
    a, b = outline[:, axis] - at, after[:, axis] - at
    crossing = (a < 0) != (b < 0)
    share = a[crossing] / (a[crossing] - b[crossing])
    along = outline[crossing, 1 - axis]
    places = np.sort(along + share * (after[crossing, 1 - axis] - along))
    return [(float(s), float(e)) for s, e in places.reshape(-1, 2)]


def _is_split(stretches: Sequence[tuple[float, float]]) -> bool:
    """Whether there is a gap near the middle of the body, with cloth on both sides of it."""
    return any(
        start - end > LEG_GAP and abs(start + end) / 2 < MIDDLE
        for (_, end), (start, _) in pairwise(stretches)
    )
