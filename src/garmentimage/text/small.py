"""The small diffusion model that comes with the package, as guidance."""

from functools import cached_property
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from garmentimage.dataset.wording import every_phrase
from garmentimage.errors import LearnError
from garmentimage.files import shown_path
from garmentimage.learn.denoiser import Denoiser, shares
from garmentimage.learn.sentences import SIZE, embedded
from garmentimage.learn.weights import load_weights
from garmentimage.text.guidance import Pictures

SCALE = 3.0
"""How much more a text counts than its absence."""
FAMILIAR = 0.5
"""Texts whose meaning is less near than this to all that the model was told are strange to it."""


class SmallDiffusion:
    """The model in a folder; it works on pictures as they are.

    Raises:
        LearnError: the folder holds none, or the sentence encoder is not installed.
    """

    def __init__(self, folder: str | Path) -> None:
        self.model = load_weights(Denoiser, folder)
        if self.model.config.text != SIZE:
            raise LearnError(
                f"{shown_path(folder)}: is told texts of {self.model.config.text} numbers, the "
                f"sentence encoder gives {SIZE}; get it again"
            )

    def hidden(self, pictures: Pictures) -> Tensor:
        """Colours from -1 to 1.

        Raises:
            LearnError: pictures of another size than it was trained on.
        """
        wanted, side = self.model.config.picture, pictures.shape[-1]
        if side != wanted:
            raise LearnError(
                f"the denoiser is for pictures of {wanted} pixels, the picture network draws "
                f"{side}; name two that were trained on one dataset"
            )
        return 2 * pictures - 1

    def shares(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Of picture and of noise."""
        return shares(times)

    def told(self, text: str) -> Tensor | None:
        """The meaning of a text; None of the empty one."""
        return torch.from_numpy(embedded([text])) if text else None

    def noise(self, noisy: Tensor, times: Float[Tensor, " n"], told: Tensor | None) -> Tensor:
        """The noise that it sees."""
        text = None if told is None else told.to(noisy).expand(len(noisy), -1)
        return self.model.noise(noisy, times, text)

    def familiar(self, text: str) -> tuple[float, str]:
        """How near the meaning of a text is to what it was told in training, and what is nearest.

        From 1, the same, to 0 or less.
        """
        near = self._phrases[1] @ embedded([text])[0]
        best = int(near.argmax())
        return float(near[best]), self._phrases[0][best]

    @cached_property
    def _phrases(self) -> tuple[tuple[str, ...], np.ndarray]:
        known = every_phrase()
        return known, embedded(known)
