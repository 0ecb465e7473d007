"""Image encoders of the baselines: a small one, or a pretrained ResNet from disk."""

from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.blocks import ResidualBlock
from garmentimage.learn.models.unet import PATCH
from garmentimage.system import shown_path

WIDTHS = (64, 96, 128)
"""Channels at a quarter, an eighth and a sixteenth of the image's resolution."""
GLOBAL_CHANNELS = 32
"""Channels of the feature map before it is flattened to one vector."""


class ImageEncoder(nn.Module):
    """An image to a feature map with a position for 16 x 16 pixels."""

    width, pixels = WIDTHS[-1], 16

    def __init__(self) -> None:
        super().__init__()
        self.stem = nn.Conv2d(3 * PATCH**2, WIDTHS[0], 1)
        self.layers = nn.Sequential()
        for level, width in enumerate(WIDTHS):
            if level:
                self.layers.append(nn.Conv2d(WIDTHS[level - 1], width, 3, 2, 1))
            self.layers.append(ResidualBlock(width))

    def forward(
        self, image: Float[Tensor, "n 3 pixel_row pixel_col"]
    ) -> Float[Tensor, "n channel row col"]:
        """The feature map of an image with colours from 0 to 1."""
        found: Tensor = self.layers(self.stem(functional.pixel_unshuffle(image - 0.5, PATCH)))
        return found


class GlobalFeatures(nn.Sequential):
    """A feature map to one vector of the whole image.

    Batch normalisation standardises the vector: images of worn garments are nearly the same, and
    networks on raw features learn the mean garment and little else.

    Args:
        channels: of the feature map.
        cells: positions a side.
        width: length of the vector.
    """

    def __init__(self, channels: int, cells: int, width: int) -> None:
        super().__init__(
            nn.Conv2d(channels, GLOBAL_CHANNELS, 1),
            nn.Flatten(),
            nn.Linear(GLOBAL_CHANNELS * cells * cells, width),
            nn.BatchNorm1d(width),
        )


class ResNetEncoder(nn.Module):
    """A ResNet (He et al. 2016): an image to a feature map with a position for 32 x 32 pixels.

    Args:
        config: as `transformers` saves it.
    """

    pixels = 32
    mean: Tensor
    std: Tensor

    def __init__(self, config: dict[str, Any]) -> None:
        from transformers import ResNetConfig, ResNetModel

        super().__init__()
        resnet_config = ResNetConfig.from_dict(config)
        self.resnet = ResNetModel(resnet_config)
        self.width = int((resnet_config.hidden_sizes or [0])[-1])
        # Mean and standard deviation of ImageNet, by which its networks standardise images.
        self.register_buffer("mean", torch.tensor([0.485, 0.456, 0.406])[:, None, None])
        self.register_buffer("std", torch.tensor([0.229, 0.224, 0.225])[:, None, None])

    def forward(
        self, image: Float[Tensor, "n 3 pixel_row pixel_col"]
    ) -> Float[Tensor, "n channel row col"]:
        """The feature map of an image with colours from 0 to 1, the lowest row first."""
        upright = (image.flip(2) - self.mean) / self.std
        found: Tensor = self.resnet(pixel_values=upright).last_hidden_state
        return found.flip(2)


def make_image_encoder(resnet: dict[str, Any] | None) -> ImageEncoder | ResNetEncoder:
    """A new encoder: a ResNet of this configuration, or the small one for None."""
    return ImageEncoder() if resnet is None else ResNetEncoder(resnet)


def read_resnet(folder: Path) -> Any:
    """A ResNet that `transformers` saved, such as `microsoft/resnet-50`.

    Raises:
        LearnError: `transformers` is not installed, or the folder holds no ResNet.
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
    except Exception as error:  # noqa: BLE001  three libraries have errors of their own
        raise LearnError(
            f"{shown_path(folder)}: holds no ResNet that can be read ({type(error).__name__})"
        ) from None
