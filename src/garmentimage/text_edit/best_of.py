"""An edit is looked at, and made anew where it did not do what was asked, or did more."""

from collections.abc import Callable
from dataclasses import dataclass

from garmentimage.metrics import EditedRegion, measure_shape, preserved_iou
from garmentimage.networks import Step
from garmentimage.pattern import Pattern
from garmentimage.text_edit.goal import parse_goal

GUIDANCE_BOOSTS = (2.0, 3.0, 1.0, 3.0)
"""How much further than usual a text pushes whose meaning geometry can judge, by try: what it is
not about is held, so it may push. Noise is new each time."""
MAX_ATTEMPTS = len(GUIDANCE_BOOSTS)
MIN_PRESERVED_IOU = 0.85
"""The garment is made anew where less of the rest is kept, as panel IoU."""


@dataclass(frozen=True)
class BestAttempt:
    """The best of some tries."""

    step: Step
    number: int
    """Which it was, from 0."""
    count: int
    """Tries made."""
    done: bool | None
    """Whether geometry tells that the text is true; None if it cannot tell."""


def best_attempt(
    given: Pattern | None,
    text: str,
    attempt: Callable[[float, EditedRegion | None], Step],
    tries: int,
) -> BestAttempt:
    """What a text makes of a garment, at the first try that is good or else the best of all.

    Good is a garment that can be sewn, of which geometry tells that what the text asks for is done
    and the rest stayed, as far as it can tell (`parse_goal`). The best is such a garment, then one
    that is done, then the one of which most stayed.

    Args:
        given: the garment as it was; None if it was none.
        text: what is asked for.
        attempt: makes an edit anew, given how much further than usual it should go and where the
            garment may change (None if the text does not tell).
        tries: the most, up to as many as `GUIDANCE_BOOSTS` has.
    """
    before, wanted = measure_shape(given), parse_goal(text)
    found: list[tuple[tuple[bool, bool, float], Step, bool | None]] = []
    for further in GUIDANCE_BOOSTS[:tries]:
        step = attempt(further, wanted.touched) if wanted else attempt(1.0, None)
        is_garment, done, stayed = step.pattern is not None and not step.faults, None, 1.0
        if before is not None and wanted is not None:
            after = measure_shape(step.pattern)
            done = after is not None and wanted.is_done(before, after)
            assert given is not None  # it has traits
            stayed = preserved_iou(wanted.touched, given, step.pattern)
        found.append(((is_garment, done is not False, stayed), step, done))
        if is_garment and done is not False and stayed >= MIN_PRESERVED_IOU:
            break
    number = max(range(len(found)), key=lambda k: found[k][0])
    _, step, done = found[number]
    return BestAttempt(step, number, len(found), done)
