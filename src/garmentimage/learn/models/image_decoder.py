"""Latent vectors to pictures of the worn garment (paper, Section 4.2, Figure 5b).

The encoder of the VAE stays as it is; only this is trained.
"""

from dataclasses import dataclass
from itertools import pairwise

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.data import Worn
from garmentimage.learn.models.unet import Block

START = 4
"""Pixels a side that the latent vector becomes first."""


@dataclass(frozen=True)
class ImageDecoderConfig:
    """Size of the network."""

    latent: int = 32
    picture: int = 64
    """Pixels a side; `START` times a power of two."""
    channels: tuple[int, ...] = (128, 96, 64, 48, 32)
    """At 4, 8, 16, 32 and 64 pixels a side."""
    spread: float = 0.5
    """How far latent vectors are moved in training, in the encoder's own standard deviations."""
    vae_sha256: str = ""
    """Of the files of the VAE whose latent vectors they are (`weights_hash`)."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))  # JSON has lists
        if START * 2 ** (len(self.channels) - 1) != self.picture:
            raise LearnError(
                f"pictures of {self.picture} pixels a side; this network draws "
                f"{START * 2 ** (len(self.channels) - 1)}, as recipe text-edit has them"
            )


class ImageDecoder(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Latent vectors to pictures."""

    def __init__(self, config: ImageDecoderConfig) -> None:
        super().__init__()
        self.config = config
        widths = config.channels
        self.take = nn.Linear(config.latent, widths[0] * START * START)
        self.blocks = nn.ModuleList(Block(width) for width in widths)
        self.narrow = nn.ModuleList(nn.Conv2d(a, b, 1) for a, b in pairwise(widths))
        self.give = nn.Conv2d(widths[-1], 3, 3, padding=1)

    def forward(self, batch: Worn) -> dict[str, Tensor]:
        """The whole loss: mean absolute error of colours, from 0 to 1."""
        z = batch.latents.float()
        if self.training:
            z = z + self.config.spread * batch.spread * torch.randn_like(z)
        loss = functional.l1_loss(self.draw(z), batch.seen())
        return {"colours": loss, "loss": loss}

    def draw(self, z: Float[Tensor, "n latent"]) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """Pictures, colours from 0 to 1, the lowest row of pixels first."""
        x = self.take(z).unflatten(1, (-1, START, START))
        for level, block in enumerate(self.blocks):
            if level:
                x = functional.interpolate(self.narrow[level - 1](x), scale_factor=2)
            x = block(x)
        colours: Tensor = self.give(functional.silu(x)).sigmoid()
        return colours
