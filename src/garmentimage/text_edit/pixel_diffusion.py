"""The small diffusion model that comes with the package, as guidance."""

from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor

from garmentimage.errors import LearnError
from garmentimage.learn import load_weights
from garmentimage.learn.data import SIZE, embedded
from garmentimage.learn.models import Denoiser, shares
from garmentimage.system import shown_path
from garmentimage.text_edit.guidance import NoiseSchedule, Pictures

SCALE = 6.0
"""How much more a text counts than its absence."""
NOISE_SAMPLES = 2
"""Put on each picture in a step."""
SCHEDULE = NoiseSchedule(0.9, 0.5)
"""Of their times: much noise, so that legs may become a skirt."""


class PixelDiffusion:
    """The model in a folder; it works on pictures as they are.

    Raises:
        LearnError: the folder holds none, or the sentence encoder is not installed.
    """

    def __init__(self, folder: str | Path) -> None:
        self.model = load_weights(Denoiser, folder)
        if self.model.config.text != SIZE:
            raise LearnError(
                f"{shown_path(folder)}: is told texts of {self.model.config.text} numbers, the "
                f"sentence encoder gives {SIZE}; get it again"
            )

    def hidden(self, pictures: Pictures) -> Tensor:
        """Colours from -1 to 1.

        Raises:
            LearnError: pictures of another size than it was trained on.
        """
        wanted, side = self.model.config.picture, pictures.shape[-1]
        if side != wanted:
            raise LearnError(
                f"the denoiser is for pictures of {wanted} pixels, the picture network draws "
                f"{side}; name two that were trained on one dataset"
            )
        return 2 * pictures - 1

    def shares(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Of picture and of noise."""
        return shares(times)

    def told(self, text: str) -> Tensor | None:
        """The meaning of a text; None of the empty one."""
        return torch.from_numpy(embedded([text])) if text else None

    def noise(self, noisy: Tensor, times: Float[Tensor, " n"], told: Tensor | None) -> Tensor:
        """The noise that it sees."""
        text = None if told is None else told.to(noisy).expand(len(noisy), -1)
        return self.model.noise(noisy, times, text)
