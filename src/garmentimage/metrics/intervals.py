"""Means with intervals of 95 %, by bootstrap."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLES = 2000
AT_ONCE = 10_000_000
"""Numbers that are drawn at a time."""


@dataclass(frozen=True)
class Interval:
    """A mean over so many values, and where it lies in 95 % of resamples."""

    mean: float
    low: float
    high: float
    n: int


def interval(values: Sequence[float], *, seed: int = 0) -> Interval:
    """Mean of one value or more, with its percentile interval (Efron 1979).

    Raises:
        ValueError: there are none.
    """
    known = np.asarray(values, float)
    if not len(known):
        raise ValueError("there are no values to take a mean of")
    random, rows = np.random.default_rng(seed), max(AT_ONCE // len(known), 1)
    parts = [min(rows, RESAMPLES - done) for done in range(0, RESAMPLES, rows)]
    means = np.concatenate([random.choice(known, (n, len(known))).mean(1) for n in parts])
    low, high = np.percentile(means, [2.5, 97.5])
    return Interval(round(float(known.mean()), 4), round(float(low), 4), round(float(high), 4),
                    len(known))  # fmt: skip
