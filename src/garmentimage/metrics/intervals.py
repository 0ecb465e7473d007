"""Means with 95 % confidence intervals, by the percentile bootstrap (Efron 1979)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

RESAMPLES = 2000
MAX_NUMBERS = 10_000_000
"""Numbers in memory at a time."""


@dataclass(frozen=True)
class Interval:
    """A mean with its 95 % confidence interval."""

    mean: float
    low: float
    high: float
    n: int
    """Number of values."""


def interval(values: Sequence[float] | Float[np.ndarray, " n"], *, seed: int = 0) -> Interval:
    """Mean of one or more values with its 95 % interval, rounded to four decimals.

    Raises:
        ValueError: there are no values.
    """
    known = np.asarray(values, float)
    if not len(known):
        raise ValueError("there are no values to take a mean of")
    mean = low = high = float(known.mean())
    if len(known) > 1:  # scipy refuses one value
        from scipy.stats import bootstrap

        found = bootstrap(
            (known,), np.mean, n_resamples=RESAMPLES, batch=max(MAX_NUMBERS // len(known), 1),
            vectorized=True, method="percentile", random_state=np.random.default_rng(seed),
        ).confidence_interval  # fmt: skip
        low, high = float(found.low), float(found.high)
    return Interval(round(mean, 4), round(low, 4), round(high, 4), len(known))
