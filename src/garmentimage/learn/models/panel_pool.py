"""The cheapest baseline: which panels of a fixed pool are present, and all their numbers, at once.

One vector of the whole image is mapped to the numbers of all slots by linear heads; panels do not
depend on each other.
"""

from dataclasses import replace

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.blocks import zero_init
from garmentimage.learn.data import EDGE_SIZE, PLACEMENT_SIZE, ImagedSlots, SlotConfig, SlotOutputs
from garmentimage.learn.models.image_encoder import GlobalFeatures, make_image_encoder
from garmentimage.learn.models.slot_heads import OutputPrior, slot_losses


class PanelPool(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Images to patterns in slots."""

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        width, slots = config.width, len(config.names)
        self.image_encoder = make_image_encoder(config.resnet)
        cells = config.picture // self.image_encoder.pixels
        self.global_features = nn.Sequential(
            GlobalFeatures(self.image_encoder.width, cells, width), nn.SiLU()
        )
        self.presence_head = nn.Linear(width, slots)
        self.placement_head = zero_init(nn.Linear(width, slots * PLACEMENT_SIZE))
        self.edge_head = zero_init(nn.Linear(width, slots * config.edges * EDGE_SIZE))
        self.output_prior = OutputPrior(config)

    def forward(self, batch: ImagedSlots) -> dict[str, Tensor]:
        """Losses: `slot_losses`, and binary cross-entropy of which panels are present."""
        found, logits = self._outputs(batch.images())
        is_present = batch.patterns.is_present[..., 0]
        # Edges of absent panels are cut off in `predict`; so they bear no loss here.
        found = replace(found, edges=torch.where(is_present[..., None, None], found.edges, 0))
        losses = slot_losses(found, batch.patterns)
        losses["panels"] = functional.binary_cross_entropy_with_logits(logits, is_present.float())
        losses["loss"] = losses["loss"] + losses["panels"]
        return losses

    def predict(self, images: Float[Tensor, "n 3 pixel_row pixel_col"]) -> SlotOutputs:
        """Patterns of images with colours from 0 to 1."""
        found, logits = self._outputs(images)
        return replace(found, edges=torch.where(logits[..., None, None] > 0, found.edges, 0))

    def _outputs(
        self, images: Float[Tensor, "n 3 pixel_row pixel_col"]
    ) -> tuple[SlotOutputs, Float[Tensor, "n slot"]]:
        """All slots, and logits of whether their panels are present."""
        whole, slots = self.global_features(self.image_encoder(images)), len(self.config.names)
        placements = self.placement_head(whole).unflatten(1, (slots, PLACEMENT_SIZE))
        edges = self.edge_head(whole).unflatten(1, (slots, self.config.edges, EDGE_SIZE))
        return self.output_prior(placements, edges), self.presence_head(whole)
