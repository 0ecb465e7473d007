"""What the numbers for flags and edge types are: shares, logits, or channels to be decided.

- **shares**: probabilities, as after a sigmoid and a softmax.
- **logits**: what a network gives before these.
- **channels**: the channels themselves, decided at .5 and by the largest of four, as a network
  that was taught with squared errors gives them: a little below 0 and above 1.
"""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from garmentimage.errors import ImageError

ChannelKind = Literal["shares", "logits", "channels"]
CHANNEL_KINDS: tuple[ChannelKind, ...] = get_args(ChannelKind)

SHARE_SLACK = 0.02  # shares may lie this far outside 0..1
MAX_OUTLIERS = 0.01  # share of the numbers that may be outliers
CHANNEL_SLACK, MAX_CHANNEL_OUTLIERS = 0.5, 0.05
"""Channels lie within 0..1 give or take the first, but for the second share of them."""
MAX_SUM_ERROR = 0.5
"""Of channels, the sum of a grid edge's four types misses 1 by less, in half of all places or more;
nothing draws that of logits to 1."""


def resolve_channel_kind(
    flags: Float[np.ndarray, "layer row col"],
    types: Float[np.ndarray, "layer 2 4 row col"],
    kind: ChannelKind | None,
) -> ChannelKind:
    """The given kind; or what numbers are, judged by all of them, so that no outlier decides.

    Raises:
        ImageError: there is no such kind.
    """
    if kind is not None:
        if kind not in CHANNEL_KINDS:
            raise ImageError(f"no kind of channels {kind!r}; there are {', '.join(CHANNEL_KINDS)}")
        return kind
    if is_binary(flags, types):
        return "channels"
    numbers = np.concatenate([flags.ravel(), types.ravel()])
    beyond = np.maximum(-numbers, numbers - 1)
    if (beyond > SHARE_SLACK).mean() <= MAX_OUTLIERS:
        return "shares"
    return "channels" if are_channels(types) else "logits"


def are_channels(types: Float[np.ndarray, "layer 2 4 row col"]) -> bool:
    """Whether numbers of edge types are one-hot but for the errors of a network."""
    beyond = np.maximum(-types, types - 1)
    is_near_one = np.median(np.abs(types.sum(axis=2) - 1)) < MAX_SUM_ERROR
    return bool(is_near_one and (beyond > CHANNEL_SLACK).mean() <= MAX_CHANNEL_OUTLIERS)


def is_binary(flags: np.ndarray, types: np.ndarray) -> bool:
    """Whether all numbers are 0 or 1, so that there is nothing to guess."""
    return all(bool(((each == 0) | (each == 1)).all()) for each in (flags, types))
