"""Latent vectors to images of the worn garment (paper, Section 4.2, Figure 5b).

The encoder of the VAE is frozen; only this decoder is trained, on the mean absolute error of
colours.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.blocks import ResidualBlock
from garmentimage.learn.data import LatentImages
from garmentimage.learn.weights import Network, NetworkConfig

START_PIXELS = 4
"""Pixels a side of the coarsest level, which a linear layer makes of the latent vector."""


@dataclass(frozen=True)
class ImageDecoderConfig(NetworkConfig):
    """Size of the network."""

    latent: int = 32
    """Length of a latent vector."""
    picture: int = 64
    """Pixels a side; `START_PIXELS` times a power of two."""
    channels: Sequence[int] = (128, 96, 64, 48, 32)
    """At 4, 8, 16, 32 and 64 pixels a side."""
    latent_noise: float = 0.5
    """Noise on latent vectors in training, in standard deviations of the encoder's posterior."""
    vae_sha256: str = ""
    """Of the weight files of the VAE whose latent vectors these are (`weights_hash`)."""

    def __post_init__(self) -> None:
        super().__post_init__()
        drawn = START_PIXELS * 2 ** (len(self.channels) - 1)
        if drawn != self.picture:
            raise LearnError(
                f"pictures of {self.picture} pixels a side; this network draws {drawn}, as recipe "
                "text-edit has them"
            )


class ImageDecoder(Network):
    """Latent vectors to images."""

    def __init__(self, config: ImageDecoderConfig) -> None:
        super().__init__()
        self.config = config
        widths = config.channels
        self.stem = nn.Linear(config.latent, widths[0] * START_PIXELS * START_PIXELS)
        self.blocks = nn.ModuleList(ResidualBlock(width) for width in widths)
        self.project = nn.ModuleList(nn.Conv2d(a, b, 1) for a, b in pairwise(widths))
        self.head = nn.Conv2d(widths[-1], 3, 3, padding=1)

    def forward(self, batch: LatentImages) -> dict[str, Tensor]:
        """Losses: the mean absolute error of colours, from 0 to 1."""
        z = batch.latents.float()
        if self.training:
            # Edits move latent vectors off those of the data; noise covers their surroundings.
            z = z + self.config.latent_noise * batch.spread * torch.randn_like(z)
        loss = functional.l1_loss(self.draw(z), batch.images())
        return {"colours": loss, "loss": loss}

    def draw(self, z: Float[Tensor, "n latent"]) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """Images, colours from 0 to 1, the lowest row of pixels first."""
        x = self.stem(z).unflatten(1, (-1, START_PIXELS, START_PIXELS))
        for level, block in enumerate(self.blocks):
            if level:
                x = functional.interpolate(self.project[level - 1](x), scale_factor=2)
            x = block(x)
        colours: Tensor = self.head(functional.silu(x)).sigmoid()
        return colours
