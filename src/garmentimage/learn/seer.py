"""An encoder of pictures for the baselines: as in ResNet, and small."""

from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.unet import FOLD, Block

WIDTHS = (64, 96, 128)
"""Channels at a quarter, an eighth and a sixteenth of the picture's size."""


class Seer(nn.Module):
    """A picture to features of its places: one in sixteen pixels a side, `WIDTHS[-1]` channels."""

    def __init__(self) -> None:
        super().__init__()
        self.take = nn.Conv2d(3 * FOLD**2, WIDTHS[0], 1)
        self.layers = nn.Sequential()
        for level, width in enumerate(WIDTHS):
            if level:
                self.layers.append(nn.Conv2d(WIDTHS[level - 1], width, 3, 2, 1))
            self.layers.append(Block(width))

    def forward(
        self, picture: Float[Tensor, "n 3 pixel_row pixel_col"]
    ) -> Float[Tensor, "n channel row col"]:
        """Features of a picture whose colours are from 0 to 1."""
        return self.layers(self.take(functional.pixel_unshuffle(picture - 0.5, FOLD)))
