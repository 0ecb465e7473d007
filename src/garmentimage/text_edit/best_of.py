"""An edit is looked at, and made anew where it did not do what was asked, or did more."""

from collections.abc import Callable
from dataclasses import dataclass

from garmentimage.metrics import Touched, kept, traits
from garmentimage.networks import Step
from garmentimage.pattern import Pattern
from garmentimage.text_edit.goal import asked

FURTHER = (2.0, 3.0, 1.0, 3.0)
"""How much further than usual a text pushes whose meaning geometry can judge, by try: what it is
not about is held, so it may push. Noise is new each time."""
MOST_TRIES = len(FURTHER)
ENOUGH = 0.85
"""The garment is made anew where less of the rest is kept, as panel IoU."""


@dataclass(frozen=True)
class Tried:
    """The best of some tries."""

    step: Step
    number: int
    """Which it was, from 0."""
    count: int
    """Tries made."""
    done: bool | None
    """Whether geometry tells that the text is true; None if it cannot tell."""


def best_try(
    given: Pattern | None,
    text: str,
    attempt: Callable[[float, Touched | None], Step],
    tries: int,
) -> Tried:
    """What a text makes of a garment, at the first try that is good or else the best of all.

    Good is a garment that can be sewn, of which geometry tells that what the text asks for is done
    and the rest stayed, as far as it can tell (`asked`). The best is such a garment, then one that
    is done, then the one of which most stayed.

    Args:
        given: the garment as it was; None if it was none.
        text: what is asked for.
        attempt: makes an edit anew, given how much further than usual it should go and where the
            garment may change (None if the text does not tell).
        tries: the most, up to as many as `FURTHER` has.
    """
    before, wanted = traits(given), asked(text)
    found: list[tuple[tuple[bool, bool, float], Step, bool | None]] = []
    for further in FURTHER[:tries]:
        step = attempt(further, wanted.touched) if wanted else attempt(1.0, None)
        is_garment, done, stayed = step.pattern is not None and not step.faults, None, 1.0
        if before is not None and wanted is not None:
            after = traits(step.pattern)
            done = after is not None and wanted.is_done(before, after)
            assert given is not None  # it has traits
            stayed = kept(wanted.touched, given, step.pattern)
        found.append(((is_garment, done is not False, stayed), step, done))
        if is_garment and done is not False and stayed >= ENOUGH:
            break
    number = max(range(len(found)), key=lambda k: found[k][0])
    _, step, done = found[number]
    return Tried(step, number, len(found), done)
