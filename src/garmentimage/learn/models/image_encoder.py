"""What looks at the pictures for the baselines: a small encoder, or a ResNet from disk."""

from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.models.unet import FOLD, Block
from garmentimage.system import shown_path

WIDTHS = (64, 96, 128)
"""Channels at a quarter, an eighth and a sixteenth of the picture's size."""
NARROW = 32
"""Channels of the picture's places that become one vector."""


class Seer(nn.Module):
    """A picture to features of its places: one in sixteen pixels a side."""

    width, pixels = WIDTHS[-1], 16

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


class Whole(nn.Sequential):
    """Features of places to one vector of the whole picture.

    Each of its numbers is standardised over a batch: pictures of worn garments are nearly the same,
    and a network that is given features as they come learns the mean garment and little else.

    Args:
        channels: of the features.
        cells: places a side.
        width: numbers of the vector.
    """

    def __init__(self, channels: int, cells: int, width: int) -> None:
        super().__init__(
            nn.Conv2d(channels, NARROW, 1),
            nn.Flatten(),
            nn.Linear(NARROW * cells * cells, width),
            nn.BatchNorm1d(width),
        )


class ResNetSeer(nn.Module):
    """The same of a ResNet (He et al. 2016), one in 32 pixels a side.

    Args:
        config: as `transformers` keeps it.
    """

    pixels = 32
    mean: Tensor
    spread: Tensor

    def __init__(self, config: dict[str, Any]) -> None:
        from transformers import ResNetConfig, ResNetModel

        super().__init__()
        made = ResNetConfig.from_dict(config)
        self.net = ResNetModel(made)
        self.width = int((made.hidden_sizes or [0])[-1])
        # What pictures of ImageNet were standardised by.
        self.register_buffer("mean", torch.tensor([0.485, 0.456, 0.406])[:, None, None])
        self.register_buffer("spread", torch.tensor([0.229, 0.224, 0.225])[:, None, None])

    def forward(
        self, picture: Float[Tensor, "n 3 pixel_row pixel_col"]
    ) -> Float[Tensor, "n channel row col"]:
        """Features of a picture whose colours are from 0 to 1, its lowest row first."""
        upright = (picture.flip(2) - self.mean) / self.spread
        found: Tensor = self.net(pixel_values=upright).last_hidden_state
        return found.flip(2)


def seer(resnet: dict[str, Any] | None) -> Seer | ResNetSeer:
    """A new one: a ResNet of this configuration, or the small one."""
    return Seer() if resnet is None else ResNetSeer(resnet)


def read_resnet(folder: Path) -> Any:
    """A ResNet that `transformers` saved, such as `microsoft/resnet-50`.

    Raises:
        LearnError: `transformers` is not installed, or the folder holds none.
    """
    try:
        from transformers import ResNetModel
    except ImportError:
        raise LearnError("--resnet needs transformers; `pip install transformers`") from None
    if not (folder / "config.json").is_file():
        raise LearnError(
            f"{shown_path(folder)}: holds no ResNet; give a folder with config.json and "
            "model.safetensors, as of microsoft/resnet-50"
        )
    try:
        return ResNetModel.from_pretrained(folder, local_files_only=True, use_safetensors=True)
    except Exception as error:  # What may go wrong spans three libraries.
        raise LearnError(
            f"{shown_path(folder)}: holds no ResNet that can be read ({type(error).__name__})"
        ) from None
