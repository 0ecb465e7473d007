"""The cheapest baseline: which panels of a fixed pool are there, and their numbers, in one step.

The whole picture becomes one vector, and that all numbers of all slots; no panel knows of another.
"""

from dataclasses import replace

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.data import (
    NUMBERS_A_PLACE,
    NUMBERS_AN_EDGE,
    PicturedSlots,
    SlotConfig,
    SlotOutputs,
    Usual,
    quiet,
    slot_losses,
)
from garmentimage.learn.models.image_encoder import Whole, seer


class PanelPool(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Pictures to patterns in slots."""

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        self.see = seer(config.resnet)
        cells, slots = config.picture // self.see.pixels, len(config.names)
        self.whole = nn.Sequential(Whole(self.see.width, cells, config.width), nn.SiLU())
        self.to_there = nn.Linear(config.width, slots)
        self.to_place = quiet(nn.Linear(config.width, slots * NUMBERS_A_PLACE))
        self.to_edge = quiet(nn.Linear(config.width, slots * config.edges * NUMBERS_AN_EDGE))
        self.usual = Usual(config)

    def forward(self, batch: PicturedSlots) -> dict[str, Tensor]:
        """The whole loss, and what it is made of."""
        found, logits = self._found(batch.seen())
        there = batch.patterns.there[..., 0]
        known = replace(found, edges=torch.where(there[..., None, None], found.edges, 0))
        losses = slot_losses(known, batch.patterns)
        losses["panels"] = functional.binary_cross_entropy_with_logits(logits, there.float())
        losses["loss"] = losses["loss"] + losses["panels"]
        return losses

    def predict(self, seen: Float[Tensor, "n 3 pixel_row pixel_col"]) -> SlotOutputs:
        """Patterns of pictures."""
        found, logits = self._found(seen)
        return replace(found, edges=torch.where(logits[..., None, None] > 0, found.edges, 0))

    def _found(self, seen: Tensor) -> tuple[SlotOutputs, Float[Tensor, "n slot"]]:
        whole, slots = self.whole(self.see(seen)), len(self.config.names)
        places = self.to_place(whole).unflatten(1, (slots, NUMBERS_A_PLACE))
        edges = self.to_edge(whole).unflatten(1, (slots, self.config.edges, NUMBERS_AN_EDGE))
        return self.usual(places, edges), self.to_there(whole)
