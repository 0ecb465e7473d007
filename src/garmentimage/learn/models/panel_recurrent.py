"""A baseline in the way of NeuralTailor (Korosteleva and Lee 2022): recurrent decoders of panels.

The whole picture becomes one vector; a recurrent network unrolls it into a vector for each slot,
and another unrolls each of these into the edges of its panel. As where the GarmentImage paper
compares with it, pictures are encoded, not point clouds. Tags of stitches come with the edges.
"""

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Bool, Float
from torch import Tensor, nn

from garmentimage.learn.data import (
    NUMBERS_A_PLACE,
    NUMBERS_AN_EDGE,
    PicturedSlots,
    SlotConfig,
    SlotOutputs,
    Usual,
    asked_losses,
    in_slots,
    quiet,
)
from garmentimage.learn.models.image_encoder import Whole, seer


class PanelRecurrent(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Pictures to patterns in slots."""

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        width = config.width
        self.see = seer(config.resnet)
        self.whole = Whole(self.see.width, config.picture // self.see.pixels, width)
        self.panels = nn.LSTM(width, width, config.layers, batch_first=True)
        self.edges = nn.LSTM(width, width, config.layers, batch_first=True)
        self.to_place = quiet(nn.Linear(width, NUMBERS_A_PLACE))
        self.to_edge = quiet(nn.Linear(width, NUMBERS_AN_EDGE))
        self.usual = Usual(config)

    def forward(self, batch: PicturedSlots) -> dict[str, Tensor]:
        """The whole loss, and what it is made of."""
        return asked_losses(self.predict, batch)

    def predict(
        self,
        seen: Float[Tensor, "n 3 pixel_row pixel_col"],
        which: Bool[Tensor, "n slot"] | None = None,
    ) -> SlotOutputs:
        """Patterns of pictures; edges of slots that are not asked for are as usual."""
        config = self.config
        if which is None:
            which = torch.ones(len(seen), len(config.names), dtype=torch.bool, device=seen.device)
        whole = self.whole(self.see(seen))
        panels, _ = self.panels(whole[:, None].expand(-1, len(config.names), -1))
        edges, _ = self.edges(panels[which][:, None].expand(-1, config.edges, -1))
        found: SlotOutputs = self.usual(self.to_place(panels), in_slots(self.to_edge(edges), which))
        return found
