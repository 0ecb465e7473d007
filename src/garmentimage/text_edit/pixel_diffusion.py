"""Guidance by the bundled diffusion model, which works on pixels."""

from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from garmentimage.errors import LearnError
from garmentimage.learn import load_weights
from garmentimage.learn.data import TEXT_SIZE, embed_texts
from garmentimage.learn.models import Denoiser, alpha_sigma
from garmentimage.system import shown_path
from garmentimage.text_edit.guidance import NoiseSchedule, Pictures

DEFAULTS: dict[str, Any] = {"scale": 6.0, "noise_samples": 2, "schedule": NoiseSchedule(0.9, 0.5)}
"""Of `ScoreDistillation`: much noise, so that legs may become a skirt."""


class PixelDiffusion:
    """A denoiser in a folder.

    Raises:
        LearnError: the folder has no denoiser, or the sentence encoder is not installed.
    """

    def __init__(self, folder: str | Path) -> None:
        self.model = load_weights(Denoiser, folder)
        if self.model.config.text != TEXT_SIZE:
            raise LearnError(
                f"{shown_path(folder)}: takes text embeddings of {self.model.config.text} numbers, "
                f"the sentence encoder gives {TEXT_SIZE}; download it again"
            )

    def encode(self, pictures: Pictures) -> Tensor:
        """Colours from -1 to 1.

        Raises:
            LearnError: pictures of another size than it was trained on.
        """
        wanted, side = self.model.config.picture, pictures.shape[-1]
        if side != wanted:
            raise LearnError(
                f"the denoiser takes pictures of {wanted} pixels, the picture network draws "
                f"{side}; name two that were trained on one dataset"
            )
        return 2 * pictures - 1

    def alpha_sigma(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Factors of picture and noise."""
        return alpha_sigma(times)

    def embed_prompt(self, text: str) -> Tensor | None:
        """The sentence embedding of a prompt; None for the empty one."""
        return torch.from_numpy(embed_texts([text])) if text else None

    def predict_noise(
        self, noisy: Tensor, times: Float[Tensor, " n"], prompt: Tensor | None
    ) -> Tensor:
        """The noise in noisy pictures."""
        embedding = None if prompt is None else prompt.to(noisy).expand(len(noisy), -1)
        return self.model.noise(noisy, times, embedding)
