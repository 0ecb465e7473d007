"""A plain U-Net from a picture, and maps on the grid, to maps on the grid."""

from itertools import pairwise

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

FOLD = 4
"""Pixels a side that are taken together, as channels, before the first convolution."""


def folded(
    picture: Float[Tensor, "n 3 pixel_row pixel_col"],
) -> Float[Tensor, "n 48 block_row block_col"]:
    """Colours from 0 to 1 as networks take them: the pixels of a block are channels."""
    return functional.pixel_unshuffle(picture, FOLD) - 0.5


class UNet(nn.Module):
    """Convolutions down to a few cells and up again, with shortcuts between (Ronneberger 2015).

    Convolutions bring the picture to the size of the grid; learnt maps tell where a cell is.

    Args:
        maps: channels of the maps that it takes beside the picture, maybe none.
        out: channels of the maps that it gives.
        grid: cells a side.
        picture: pixels a side; the grid times a power of two.
        widths: channels of each level, from the grid's own down.
        dropout: share of channels that are left out in training.
    """

    def __init__(
        self,
        maps: int,
        out: int,
        grid: int,
        picture: int,
        widths: tuple[int, ...],
        dropout: float = 0.0,
    ) -> None:
        super().__init__()
        halvings = (picture // FOLD // grid).bit_length() - 1
        steps = pairwise([3 * FOLD**2, *[widths[0]] * halvings])
        self.look = nn.ModuleList(nn.Conv2d(a, b, 3, 2, 1) for a, b in steps)
        self.take = nn.Conv2d(maps, widths[0], 3, padding=1) if maps else None
        self.places = nn.Parameter(0.1 * torch.randn(widths[0], grid, grid))
        self.down = nn.ModuleList(Block(width, dropout) for width in widths)
        self.halve = nn.ModuleList(nn.Conv2d(a, b, 3, 2, 1) for a, b in pairwise(widths))
        self.up = nn.ModuleList(Block(width, dropout) for width in widths)
        self.narrow = nn.ModuleList(nn.Conv2d(b, a, 1) for a, b in pairwise(widths))
        self.give = nn.Conv2d(widths[0], out, 3, padding=1)

    def forward(
        self,
        picture: Float[Tensor, "n 48 block_row block_col"],
        maps: Float[Tensor, "n maps row col"] | None = None,
    ) -> Float[Tensor, "n out row col"]:
        """Maps of a picture that is `folded`."""
        x = picture
        for number, layer in enumerate(self.look):
            x = layer(functional.silu(x) if number else x)
        if self.take is not None and maps is not None:
            x = x + self.take(maps)
        x = x + self.places
        kept = []
        for level, block in enumerate(self.down):
            x = block(self.halve[level - 1](x) if level else x)
            kept.append(x)
        for level in range(len(self.up) - 1, -1, -1):
            x = self.up[level](x)
            if level:
                x = functional.interpolate(self.narrow[level - 1](x), scale_factor=2)
                x = x + kept[level - 1]
        return self.give(x)


class Block(nn.Module):
    """Two convolutions beside a shortcut."""

    def __init__(self, width: int, dropout: float = 0.0) -> None:
        super().__init__()
        self.drop = nn.Dropout2d(dropout)
        self.norm1, self.norm2 = nn.GroupNorm(8, width), nn.GroupNorm(8, width)
        self.conv1 = nn.Conv2d(width, width, 3, padding=1)
        self.conv2 = nn.Conv2d(width, width, 3, padding=1)
        nn.init.zeros_(self.conv2.weight)

    def forward(self, x: Tensor) -> Tensor:
        """The same shape as `x`."""
        y = self.conv1(functional.silu(self.norm1(x)))
        return x + self.conv2(self.drop(functional.silu(self.norm2(y))))
