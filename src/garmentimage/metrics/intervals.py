"""Means with intervals of 95 %, by bootstrap."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLES = 2000


@dataclass(frozen=True)
class Interval:
    """A mean over so many values, and where it lies in 95 % of resamples."""

    mean: float
    low: float
    high: float
    n: int


def interval(values: Sequence[float], *, seed: int = 0) -> Interval:
    """Mean of one value or more, with its percentile interval (Efron 1979)."""
    known = np.asarray(values, float)
    means = np.random.default_rng(seed).choice(known, (RESAMPLES, len(known))).mean(1)
    low, high = np.percentile(means, [2.5, 97.5])
    return Interval(round(float(known.mean()), 4), round(float(low), 4), round(float(high), 4),
                    len(known))  # fmt: skip
