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
from garmentimage.raster.channels import ChannelParts

ChannelKind = Literal["shares", "logits", "channels"]
CHANNEL_KINDS: tuple[ChannelKind, ...] = get_args(ChannelKind)

SHARE_SLACK = 0.02  # shares may lie this far outside 0..1
MAX_OUTLIERS = 0.01  # share of the numbers that may be outliers
CHANNEL_SLACK, MAX_CHANNEL_OUTLIERS = 0.5, 0.05
"""Channels lie within 0..1 give or take the first, but for the second share of them."""
MAX_SUM_ERROR = 0.5
"""Of channels, the sum of a grid edge's four types misses 1 by less, in half of all places or more;
nothing draws that of logits to 1."""


def resolve_channel_kind(parts: ChannelParts, kind: ChannelKind | None) -> ChannelKind:
    """The given kind; or what numbers are, judged by all of them, so that no outlier decides.

    Raises:
        ImageError: there is no such kind.
    """
    if kind is not None:
        if kind not in CHANNEL_KINDS:
            raise ImageError(f"no kind of channels {kind!r}; there are {', '.join(CHANNEL_KINDS)}")
        return kind
    if is_binary(parts):
        return "channels"
    numbers = _decided(parts)
    beyond = np.maximum(-numbers, numbers - 1)
    if (beyond > SHARE_SLACK).mean() <= MAX_OUTLIERS:
        return "shares"
    return "channels" if are_channels(parts.types) else "logits"


def are_channels(types: Float[np.ndarray, "layer 2 type row col"]) -> bool:
    """Whether numbers of edge types are one-hot but for the errors of a network."""
    beyond = np.maximum(-types, types - 1)
    is_near_one = np.median(np.abs(types.sum(axis=2) - 1)) < MAX_SUM_ERROR
    return bool(is_near_one and (beyond > CHANNEL_SLACK).mean() <= MAX_CHANNEL_OUTLIERS)


def is_binary(parts: ChannelParts) -> bool:
    """Whether all flags and types are 0 or 1, so that there is nothing to guess."""
    numbers = _decided(parts)
    return bool(((numbers == 0) | (numbers == 1)).all())


def _decided(parts: ChannelParts) -> Float[np.ndarray, " number"]:
    """All numbers that stand for decisions: those of flags and types."""
    decided = (parts.flags, parts.types, parts.turned)
    return np.concatenate([each.ravel() for each in decided if each is not None])
