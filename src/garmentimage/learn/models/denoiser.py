"""A small diffusion model of images of worn garments, conditioned on a sentence embedding.

Formulation: an image x (colours from -1 to 1) under noise e is alpha x + sigma e, with alpha =
cos(pi t / 2) and sigma = sin(pi t / 2) at time t (cosine schedule, Nichol and Dhariwal 2021). A
U-Net predicts v = alpha e - sigma x (Salimans and Ho 2022); its loss is the squared error of v.
Time and text scale and shift its features (FiLM). Some texts are replaced by a learnt null
embedding in training, so that the model also knows images without text (classifier-free guidance,
Ho and Salimans 2022).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.blocks import FiLMBlock, UNetLevels
from garmentimage.learn.data import CaptionedImages
from garmentimage.learn.weights import Network, NetworkConfig

PATCH = 2
"""Pixels a side of a patch, which become channels before the first convolution."""
FREQUENCIES = 32
"""Sines, and as many cosines, of the time embedding."""
MAX_FREQUENCY = 1000.0
MIN_TIME = 1e-3
"""Training times lie between this and 1 minus this: at both ends, v says nothing of one part."""


@dataclass(frozen=True)
class DenoiserConfig(NetworkConfig):
    """Size of the network, and how it is trained."""

    picture: int = 64
    """Pixels a side."""
    text: int = 384
    """Length of a sentence embedding."""
    channels: Sequence[int] = (48, 96, 128, 160)
    """Of each level: at half the image's resolution, a quarter, and so on."""
    width: int = 256
    """Length of the condition that time and text are mapped to."""
    condition_dropout: float = 0.15
    """Share of images whose text is replaced by the null embedding in training."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.picture % (PATCH * 2 ** (len(self.channels) - 1)):
            raise LearnError(
                f"pictures of {self.picture} pixels cannot be halved {len(self.channels)} times"
            )


class Denoiser(Network):
    """Noisy images to their noise."""

    def __init__(self, config: DenoiserConfig) -> None:
        super().__init__()
        self.config = config
        widths, side = config.channels, config.picture // PATCH
        self.null_text = nn.Parameter(torch.zeros(config.text))
        self.conditioning = nn.Sequential(
            nn.Linear(2 * FREQUENCIES + config.text, config.width),
            nn.SiLU(),
            nn.Linear(config.width, config.width),
            nn.SiLU(),
        )
        self.stem = nn.Conv2d(3 * PATCH**2, widths[0], 3, padding=1)
        self.positions = nn.Parameter(torch.zeros(widths[0], side, side))
        self.levels = UNetLevels(widths, lambda width: FiLMBlock(width, config.width))
        self.head = nn.Conv2d(widths[0], 3 * PATCH**2, 3, padding=1)

    def forward(self, batch: CaptionedImages) -> dict[str, Tensor]:
        """Losses: the mean squared error of v, over images and times."""
        clean = 2 * batch.images() - 1
        count = len(clean)
        # One time in each of `count` equal intervals: less variance than times drawn one by one.
        times = (torch.rand(count) + torch.arange(count)) / count
        times = times.clamp(MIN_TIME, 1 - MIN_TIME).to(clean.device)
        alpha, sigma = alpha_sigma(times)
        noise = torch.randn_like(clean)
        text = batch.text_embeddings.to(clean.dtype)
        is_dropped = torch.rand(count, 1, device=clean.device) < self.config.condition_dropout
        text = torch.where(is_dropped, self.null_text.to(text.dtype), text)
        found = self._v(alpha * clean + sigma * noise, times, text)
        loss = functional.mse_loss(found, alpha * noise - sigma * clean)
        return {"v": loss, "loss": loss}

    def noise(
        self,
        noisy: Float[Tensor, "n 3 pixel_row pixel_col"],
        times: Float[Tensor, " n"],
        text: Float[Tensor, "n text"] | None,
    ) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """The noise e = alpha v + sigma (noisy image) in images with colours from -1 to 1.

        Args:
            noisy: the images.
            times: from 0, no noise, to 1, noise alone.
            text: sentence embeddings; None for the null embedding.
        """
        if text is None:
            text = self.null_text.expand(len(noisy), -1)
        alpha, sigma = alpha_sigma(times)
        return alpha * self._v(noisy, times, text) + sigma * noisy

    def _v(self, noisy: Tensor, times: Tensor, text: Float[Tensor, "n text"]) -> Tensor:
        condition = self.conditioning(torch.cat([time_embedding(times).to(text.dtype), text], 1))
        x = self.stem(functional.pixel_unshuffle(noisy, PATCH)) + self.positions
        return functional.pixel_shuffle(self.head(self.levels(x, condition)), PATCH)


def alpha_sigma(
    times: Float[Tensor, " n"],
) -> tuple[Float[Tensor, "n 1 1 1"], Float[Tensor, "n 1 1 1"]]:
    """Weights of image and noise at these times; their squares sum to 1."""
    angle = (0.5 * math.pi * times)[:, None, None, None]
    return angle.cos(), angle.sin()


def time_embedding(times: Float[Tensor, " n"]) -> Float[Tensor, "n 64"]:
    """Sines and cosines of times at geometric frequencies (Vaswani et al. 2017)."""
    frequencies = torch.exp(
        torch.linspace(0.0, math.log(MAX_FREQUENCY), FREQUENCIES, device=times.device)
    )
    angle = times[:, None] * frequencies
    return torch.cat([angle.sin(), angle.cos()], 1)
