"""Networks and guidance that do something simple, so that a test knows what must come out."""

import numpy as np
import torch

from garmentimage.learn.models.image_decoder import ImageDecoder, ImageDecoderConfig
from garmentimage.networks import DecodedGarment
from garmentimage.pattern.model import Pattern


def decoded(pattern: Pattern | None, faults: tuple[str, ...] = ()) -> DecodedGarment:
    """The result of an edit, without a latent vector or image."""
    return DecodedGarment(np.zeros(1, np.float32), None, None, pattern, faults)


class PixelDecoder(ImageDecoder):
    """Latent numbers are the pixels: 0 is grey, 1 white, -1 black."""

    def __init__(self, picture: int = 8) -> None:
        size = 3 * picture**2
        super().__init__(ImageDecoderConfig(latent=size, picture=picture, channels=(8, 8)))

    def draw(self, z: torch.Tensor) -> torch.Tensor:
        side = self.config.picture
        return (0.5 + 0.5 * z).reshape(-1, 3, side, side)


class TowardsWhite:
    """A guidance to which all should be white."""

    def start(self, pictures: torch.Tensor, source_prompt: str, boost: float) -> None:
        pass

    def gradient(self, pictures: torch.Tensor, text: str, progress: float) -> torch.Tensor:
        return pictures - 1
