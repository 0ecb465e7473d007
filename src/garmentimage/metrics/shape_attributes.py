"""Shape attributes of a garment, measured on its pattern; edits by text are judged by them.

They are measured on the front panels placed at the body, in world coordinates [cm]: x to the
wearer's left, y up from the floor. Panels decoded from a network's image are placed roughly, with
sleeves too near the body and overlapping legs. So shapes are measured precisely, and of positions
only the side and the height of a panel are used.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from garmentimage.body import measurements
from garmentimage.compare import drawing_faults, loop_polygon
from garmentimage.pattern import Pattern

SIDE = 4.0
"""A panel belongs to a side if its centre is further than this from the centre of the body [cm]."""
SLEEVE_BELOW = 30.0
"""It is a sleeve if its centre is less than this below the top of the garment [cm]."""
LEVELS = (3.0, 6.0, 9.0)
"""Heights above the hem at which legs are detected [cm]."""
LEG_GAP, APART = 0.5, 0.2
"""Overlapping legs are moved apart until their smallest distance is the second; they count as legs
if their distance at the hem is more than the first [cm]."""
MIDDLE = 12.0
"""The gap between them is at most this far from the centre of the body [cm]."""
MIDDLE_LINES = (-9.0, 9.0)
"""x of the vertical lines along which panels are counted [cm]."""


@dataclass(frozen=True)
class ShapeAttributes:
    """Attributes of a garment, on the default body."""

    legs: bool
    """Two separate pieces of cloth at the hem."""
    pieces: int
    """Front panels one above the other, without sleeves: 2 if there is a waist seam."""
    sleeves: float | None
    """Length of the sleeves along the arm [cm]; None without."""
    length: float
    """From the waist of the default body down to the hem [cm]."""
    width: float
    """Of the front at the hem, or of one leg [cm]."""


def measure_shape(pattern: Pattern | None) -> ShapeAttributes | None:
    """Shape attributes of a pattern; None if it cannot be drawn or has no front panels."""
    if pattern is None or any(drawing_faults(panel) for panel in pattern.panels):
        return None
    sides = [each for each in panels_at_body(pattern) if each.is_front]
    sleeves = [each.outline for each in sides if each.is_sleeve]
    body = _beside([each.outline for each in sides if not each.is_sleeve])
    if not body:
        return None
    hem = min(float(outline[:, 1].min()) for outline in body)
    cuts = [
        sorted(cloth for outline in body for cloth in _crossed(outline, axis=1, at=hem + level))
        for level in LEVELS
    ]
    legs = sum(_is_split(cut) for cut in cuts) * 2 > len(cuts)
    wide = sum(end - start for start, end in cuts[-1])
    return ShapeAttributes(
        legs=legs,
        pieces=max(sum(bool(_crossed(each, axis=0, at=x)) for each in body) for x in MIDDLE_LINES),
        sleeves=max(float(np.ptp(outline[:, 0])) for outline in sleeves) if sleeves else None,
        length=measurements("mean-female").waist_height - hem,
        width=wide / 2 if legs else wide,
    )


@dataclass(frozen=True)
class PanelAtBody:
    """A panel at the body, projected on the frontal plane."""

    outline: Float[np.ndarray, "n 2"]
    is_front: bool
    is_sleeve: bool


def panels_at_body(pattern: Pattern) -> list[PanelAtBody]:
    """The panels of a pattern at the body."""
    worlds = [panel.to_world(loop_polygon(panel.outline)) for panel in pattern.panels]
    top = max((float(world[:, 1].max()) for world in worlds), default=0.0)
    panels = []
    for world in worlds:
        x, y = _middle(world[:, :2])
        is_sleeve = bool(abs(x) > SIDE and y > top - SLEEVE_BELOW)
        panels.append(PanelAtBody(world[:, :2], bool(world[:, 2].mean() > 0), is_sleeve))
    return panels


def _middle(outline: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " 2"]:
    middle: Float[np.ndarray, " 2"] = (outline.min(0) + outline.max(0)) / 2
    return middle


def _beside(outlines: Sequence[Float[np.ndarray, "_ 2"]]) -> list[Float[np.ndarray, "_ 2"]]:
    """Panels of the left and of the right moved apart where they lie on each other."""
    sides = [
        int(np.sign(x)) if abs(x := float(_middle(each)[0])) > SIDE else 0 for each in outlines
    ]
    ends = [
        min(
            float((s * each[:, 0]).min())
            for each, s in zip(outlines, sides, strict=True)
            if s == side
        )
        for side in (1, -1)
        if side in sides
    ]
    move = max(APART - sum(ends), 0.0) / 2 if len(ends) == 2 else 0.0
    return [each + np.array([side * move, 0.0]) for each, side in zip(outlines, sides, strict=True)]


def _crossed(
    outline: Float[np.ndarray, "n 2"], *, axis: int, at: float
) -> list[tuple[float, float]]:
    """Intervals of a line inside an outline, by the even-odd rule."""
    after = np.roll(outline, -1, axis=0)
    a, b = outline[:, axis] - at, after[:, axis] - at
    crossing = (a < 0) != (b < 0)
    share = a[crossing] / (a[crossing] - b[crossing])
    along = outline[crossing, 1 - axis]
    places = np.sort(along + share * (after[crossing, 1 - axis] - along))
    return [(float(s), float(e)) for s, e in places.reshape(-1, 2)]


def _is_split(intervals: Sequence[tuple[float, float]]) -> bool:
    """Whether there is a gap near the middle of the body, with cloth on both sides of it."""
    return any(
        start - end > LEG_GAP and abs(start + end) / 2 < MIDDLE
        for (_, end), (start, _) in pairwise(intervals)
    )
