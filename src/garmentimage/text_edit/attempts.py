"""Several attempts at an edit: each is checked by geometry, and the best one is returned."""

from collections.abc import Callable
from dataclasses import dataclass

from garmentimage.metrics import EditedRegion, measure_shape, preserved_iou
from garmentimage.networks import DecodedGarment
from garmentimage.pattern import Pattern
from garmentimage.text_edit.goal import parse_goal

GUIDANCE_BOOSTS = (2.0, 3.0, 1.0, 3.0)
"""Factors of the guidance scale by attempt, for texts whose goal geometry can check.

The rest of the garment is held in place then, so the guidance may be stronger. Noise differs
between attempts."""
MAX_ATTEMPTS = len(GUIDANCE_BOOSTS)
MIN_PRESERVED_IOU = 0.85
"""Another attempt is made where less of the rest of the garment is preserved, as panel IoU."""


@dataclass(frozen=True)
class BestAttempt:
    """The best of several attempts."""

    step: DecodedGarment
    number: int
    """Which attempt it was, from 0."""
    count: int
    """Attempts made."""
    achieved: bool | None
    """Whether the goal is reached, by geometry; None if geometry cannot decide."""


def best_attempt(
    source: Pattern | None,
    text: str,
    attempt: Callable[[float, EditedRegion | None], DecodedGarment],
    max_attempts: int,
) -> BestAttempt:
    """Repeat an edit until it succeeds, and return the best attempt.

    An edit succeeds if the garment can be sewn, its goal (`parse_goal`) is reached and the rest is
    preserved, as far as geometry can decide. Attempts are ordered by these three criteria.

    Args:
        source: the garment before the edit; None if it has no pattern.
        text: the prompt.
        attempt: makes one edit, given a factor of the guidance scale and the region that may change
            (None: anything may).
        max_attempts: up to `MAX_ATTEMPTS`.
    """
    before, goal = measure_shape(source), parse_goal(text)
    found: list[tuple[tuple[bool, bool, float], DecodedGarment, bool | None]] = []
    for boost in GUIDANCE_BOOSTS[:max_attempts]:
        step = attempt(boost, goal.region) if goal else attempt(1.0, None)
        is_garment, achieved, preserved = step.pattern is not None and not step.faults, None, 1.0
        if before is not None and goal is not None:
            after = measure_shape(step.pattern)
            achieved = after is not None and goal.is_achieved(before, after)
            assert source is not None  # its shape was measured
            preserved = preserved_iou(goal.region, source, step.pattern)
        found.append(((is_garment, achieved is not False, preserved), step, achieved))
        if is_garment and achieved is not False and preserved >= MIN_PRESERVED_IOU:
            break
    number = max(range(len(found)), key=lambda k: found[k][0])
    _, step, achieved = found[number]
    return BestAttempt(step, number, len(found), achieved)
