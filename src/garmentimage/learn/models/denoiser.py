"""A small diffusion model of pictures of worn garments, told what they show by a sentence.

A U-Net predicts v (Salimans and Ho 2022) of pictures under noise of a cosine schedule (Nichol and
Dhariwal 2021); time and text scale and shift its features. In training some texts are left out, so
that it also knows pictures without one (classifier-free guidance, Ho and Salimans 2022).
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.data import Captioned

FOLD = 2
"""Pixels a side that are taken together, as channels."""
WAVES = 32
"""Frequencies by which the network is told the time."""
LEAST_TIME = 1e-3


@dataclass(frozen=True)
class DenoiserConfig:
    """Size of the network, and what it is taught with."""

    picture: int = 64
    """Pixels a side."""
    text: int = 384
    """Numbers of a sentence."""
    channels: tuple[int, ...] = (48, 96, 128, 160)
    """At half the picture's size, a quarter, and so on."""
    width: int = 256
    """Numbers that time and text become."""
    unsaid: float = 0.15
    """Share of pictures that are shown without their text."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))  # JSON has lists
        if self.picture % (FOLD * 2 ** (len(self.channels) - 1)):
            raise LearnError(
                f"pictures of {self.picture} pixels cannot be halved {len(self.channels)} times"
            )


class Denoiser(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Noisy pictures to their noise; times run from 0, no noise, to 1, nothing else."""

    def __init__(self, config: DenoiserConfig) -> None:
        super().__init__()
        self.config = config
        widths = config.channels
        self.nothing = nn.Parameter(torch.zeros(config.text))
        self.told = nn.Sequential(
            nn.Linear(2 * WAVES + config.text, config.width),
            nn.SiLU(),
            nn.Linear(config.width, config.width),
            nn.SiLU(),
        )
        self.take = nn.Conv2d(3 * FOLD**2, widths[0], 3, padding=1)
        self.places = nn.Parameter(
            torch.zeros(widths[0], config.picture // FOLD, config.picture // FOLD)
        )
        self.down = nn.ModuleList(_Told(width, config.width) for width in widths)
        self.halve = nn.ModuleList(nn.Conv2d(a, b, 3, 2, 1) for a, b in pairwise(widths))
        self.up = nn.ModuleList(_Told(width, config.width) for width in widths)
        self.narrow = nn.ModuleList(nn.Conv2d(b, a, 1) for a, b in pairwise(widths))
        self.give = nn.Conv2d(widths[0], 3 * FOLD**2, 3, padding=1)

    def forward(self, batch: Captioned) -> dict[str, Tensor]:
        """The whole loss: squared error of v at times drawn evenly."""
        clean = 2 * batch.seen() - 1
        count = len(clean)
        times = (torch.rand(count) + torch.arange(count)) / count  # evenly within the batch
        times = times.clamp(LEAST_TIME, 1 - LEAST_TIME).to(clean.device)
        alpha, sigma = shares(times)
        noise = torch.randn_like(clean)
        text = batch.meanings.to(clean.dtype)
        unsaid = torch.rand(count, 1, device=clean.device) < self.config.unsaid
        text = torch.where(unsaid, self.nothing.to(text.dtype), text)
        found = self._v(alpha * clean + sigma * noise, times, text)
        loss = functional.mse_loss(found, alpha * noise - sigma * clean)
        return {"v": loss, "loss": loss}

    def noise(
        self,
        noisy: Float[Tensor, "n 3 pixel_row pixel_col"],
        times: Float[Tensor, " n"],
        text: Float[Tensor, "n text"] | None,
    ) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """The noise in pictures whose colours are from -1 to 1; text None says nothing."""
        if text is None:
            text = self.nothing.expand(len(noisy), -1)
        alpha, sigma = shares(times)
        return alpha * self._v(noisy, times, text) + sigma * noisy

    def _v(self, noisy: Tensor, times: Tensor, text: Tensor) -> Tensor:
        told = self.told(torch.cat([_waves(times).to(text.dtype), text], 1))
        x = self.take(functional.pixel_unshuffle(noisy, FOLD)) + self.places
        kept = []
        for level, block in enumerate(self.down):
            x = block(self.halve[level - 1](x) if level else x, told)
            kept.append(x)
        for level in range(len(self.up) - 1, -1, -1):
            x = self.up[level](x, told)
            if level:
                x = functional.interpolate(self.narrow[level - 1](x), scale_factor=2)
                x = x + kept[level - 1]
        return functional.pixel_shuffle(self.give(x), FOLD)


class _Told(nn.Module):
    """Two convolutions beside a shortcut, scaled and shifted by what is told."""

    def __init__(self, width: int, told: int) -> None:
        super().__init__()
        self.norm1, self.norm2 = nn.GroupNorm(8, width), nn.GroupNorm(8, width)
        self.conv1 = nn.Conv2d(width, width, 3, padding=1)
        self.conv2 = nn.Conv2d(width, width, 3, padding=1)
        self.film = nn.Linear(told, 2 * width)
        nn.init.zeros_(self.conv2.weight)

    def forward(self, x: Tensor, told: Tensor) -> Tensor:
        scale, shift = self.film(told)[:, :, None, None].chunk(2, 1)
        y = self.conv1(functional.silu(self.norm1(x)))
        y = self.norm2(y) * (1 + scale) + shift
        out: Tensor = x + self.conv2(functional.silu(y))
        return out


def shares(times: Float[Tensor, " n"]) -> tuple[Float[Tensor, "n 1 1 1"], Float[Tensor, "n 1 1 1"]]:
    """Of picture and of noise at these times; their squares sum to 1."""
    angle = (0.5 * math.pi * times)[:, None, None, None]
    return angle.cos(), angle.sin()


def _waves(times: Float[Tensor, " n"]) -> Float[Tensor, "n 64"]:
    speeds = torch.exp(torch.linspace(0.0, math.log(1000.0), WAVES, device=times.device))
    angle = times[:, None] * speeds
    return torch.cat([angle.sin(), angle.cos()], 1)
