"""A U-Net from an image, and maps on the grid, to maps on the grid."""

from collections.abc import Sequence
from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.blocks import ResidualBlock, UNetLevels

PATCH = 4
"""Pixels a side of a patch, which become channels before the first convolution."""


class UNet(nn.Module):
    """Image and maps to maps (see `UNetLevels`).

    Strided convolutions bring the image to the size of the grid. As all garments stand on one body,
    position matters: learnt position maps are added.

    Args:
        maps: input channels on the grid; may be 0.
        out: output channels on the grid.
        grid: cells a side.
        picture: pixels a side of the image; `PATCH` times the grid times a power of two.
        widths: channels of each level, from the grid's own resolution down.
        dropout: share of channels that are left out in training.
    """

    def __init__(
        self,
        maps: int,
        out: int,
        *,
        grid: int,
        picture: int,
        widths: Sequence[int],
        dropout: float = 0.0,
    ) -> None:
        super().__init__()
        halvings = (picture // PATCH // grid).bit_length() - 1
        steps = pairwise([3 * PATCH**2, *[widths[0]] * halvings])
        self.image_stem = nn.ModuleList(nn.Conv2d(a, b, 3, 2, 1) for a, b in steps)
        self.map_stem = nn.Conv2d(maps, widths[0], 3, padding=1) if maps else None
        self.positions = nn.Parameter(0.1 * torch.randn(widths[0], grid, grid))
        self.levels = UNetLevels(widths, lambda width: ResidualBlock(width, dropout))
        self.head = nn.Conv2d(widths[0], out, 3, padding=1)

    def forward(
        self,
        images: Float[Tensor, "n 3 pixel_row pixel_col"],
        *maps: Float[Tensor, "n _ row col"],
    ) -> Float[Tensor, "n out row col"]:
        """Maps of images with colours from 0 to 1, and of further maps."""
        x = functional.pixel_unshuffle(images, PATCH) - 0.5
        for number, layer in enumerate(self.image_stem):
            x = layer(functional.silu(x) if number else x)
        if self.map_stem is not None:
            x = x + self.map_stem(torch.cat(maps, 1))
        found: Tensor = self.head(self.levels(x + self.positions))
        return found
