"""Blocks that several networks are made of: residual blocks, U-Net levels, output heads."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

GROUPS = 8
"""Of every group normalisation."""


class _Convolutions(nn.Module):
    """Two normalised 3 x 3 convolutions, of which the second starts at zero.

    So a new residual block is the identity, and deep networks train from the first step.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.norm1, self.norm2 = nn.GroupNorm(GROUPS, width), nn.GroupNorm(GROUPS, width)
        self.conv1 = nn.Conv2d(width, width, 3, padding=1)
        self.conv2 = nn.Conv2d(width, width, 3, padding=1)
        nn.init.zeros_(self.conv2.weight)


class ResidualBlock(_Convolutions):
    """Two convolutions beside a shortcut, normalised and activated before each (He et al. 2016b).

    Args:
        width: channels.
        dropout: share of channels that are left out in training.
    """

    def __init__(self, width: int, dropout: float = 0.0) -> None:
        super().__init__(width)
        self.drop = nn.Dropout2d(dropout)

    def forward(self, x: Float[Tensor, "n width row col"]) -> Float[Tensor, "n width row col"]:
        """The same shape as `x`."""
        y = self.conv1(functional.silu(self.norm1(x)))
        return x.add(self.conv2(self.drop(functional.silu(self.norm2(y)))))


class FiLMBlock(_Convolutions):
    """A residual block whose channels are scaled and shifted by a condition (Perez et al. 2018).

    Between the convolutions, y becomes y (1 + scale(c)) + shift(c), both linear in the condition c.

    Args:
        width: channels.
        condition: length of the condition.
    """

    def __init__(self, width: int, condition: int) -> None:
        super().__init__(width)
        self.film = nn.Linear(condition, 2 * width)

    def forward(
        self, x: Float[Tensor, "n width row col"], condition: Float[Tensor, "n condition"]
    ) -> Float[Tensor, "n width row col"]:
        """The same shape as `x`."""
        y = self.norm2(self.conv1(functional.silu(self.norm1(x))))
        scale, shift = self.film(condition)[:, :, None, None].chunk(2, 1)
        return x.add(self.conv2(functional.silu(y * (1 + scale) + shift)))


class UNetLevels(nn.Module):
    """The levels of a U-Net (Ronneberger et al. 2015): blocks down, blocks up, skips between.

    Each level halves the resolution of the one above by a strided convolution, and is brought back
    by a 1 x 1 convolution and nearest-neighbour upsampling, to which the skip is added.

    Args:
        widths: channels of each level, the finest first.
        block: makes the block of a level from its width; called level by level, down, then up.
    """

    def __init__(self, widths: Sequence[int], block: Callable[[int], nn.Module]) -> None:
        super().__init__()
        self.down = nn.ModuleList(block(width) for width in widths)
        self.downsample = nn.ModuleList(nn.Conv2d(a, b, 3, 2, 1) for a, b in pairwise(widths))
        self.up = nn.ModuleList(block(width) for width in widths)
        self.project = nn.ModuleList(nn.Conv2d(b, a, 1) for a, b in pairwise(widths))

    def forward(
        self, x: Float[Tensor, "n width row col"], *condition: Float[Tensor, "n condition"]
    ) -> Float[Tensor, "n width row col"]:
        """Maps of the same shape as `x`; the condition, if any, goes to every block."""
        skips = []
        for level, block in enumerate(self.down):
            x = block(self.downsample[level - 1](x) if level else x, *condition)
            skips.append(x)
        for level in range(len(self.up) - 1, -1, -1):
            x = self.up[level](x, *condition)
            if level:
                x = functional.interpolate(self.project[level - 1](x), scale_factor=2)
                x = x + skips[level - 1]
        return x


def transformer_options(width: int, heads: int) -> dict[str, Any]:
    """Options of a transformer layer: normalised before each part, GELU, no dropout."""
    return {
        "d_model": width,
        "nhead": heads,
        "dim_feedforward": 4 * width,
        "batch_first": True,
        "norm_first": True,
        "dropout": 0.0,
        "activation": "gelu",
    }


def zero_init(layer: nn.Linear) -> nn.Linear:
    """The same layer with zero weights: an output head that starts from the output prior alone."""
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    return layer
