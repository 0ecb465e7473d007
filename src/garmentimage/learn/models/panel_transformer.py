"""A baseline after Sewformer (Liu et al. 2023): a transformer with queries for panels and edges.

The feature map of the image goes through a transformer encoder; a learnt query for each slot
attends to it for the panel, and one for each edge of a slot attends to its panel and to the whole
image. Written from the paper's description; slots are fixed by name, as the panels of its datasets
are.
"""

from typing import Any

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Bool, Float
from torch import Tensor, nn

from garmentimage.learn.blocks import zero_init
from garmentimage.learn.data import EDGE_SIZE, PLACEMENT_SIZE, ImagedSlots, SlotConfig, SlotOutputs
from garmentimage.learn.models.image_encoder import make_image_encoder
from garmentimage.learn.models.slot_heads import (
    OutputPrior,
    all_slots,
    sampled_losses,
    scatter_to_slots,
)

ATTENTION_HEADS = 4


class PanelTransformer(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Images to patterns in slots."""

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        width, slots = config.width, len(config.names)
        layer: dict[str, Any] = {
            "d_model": width,
            "nhead": ATTENTION_HEADS,
            "dim_feedforward": 4 * width,
            "batch_first": True,
            "norm_first": True,
            "dropout": 0.0,
            "activation": "gelu",
        }
        self.image_encoder = make_image_encoder(config.resnet)
        self.project = nn.Sequential(
            nn.Conv2d(self.image_encoder.width, width, 1), nn.BatchNorm2d(width)
        )
        cells = config.picture // self.image_encoder.pixels
        self.positions = nn.Parameter(0.1 * torch.randn(cells * cells, width))
        self.encoder = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(**layer), config.layers, enable_nested_tensor=False
        )
        self.panel_queries = nn.Parameter(torch.randn(slots, width))
        self.panels = nn.TransformerDecoder(nn.TransformerDecoderLayer(**layer), config.layers)
        self.edge_queries = nn.Parameter(torch.randn(slots, config.edges, width))
        self.edges = nn.TransformerDecoder(nn.TransformerDecoderLayer(**layer), config.layers)
        self.placement_head = _head(width, PLACEMENT_SIZE)
        self.edge_head = _head(width, EDGE_SIZE)
        self.output_prior = OutputPrior(config)

    def forward(self, batch: ImagedSlots) -> dict[str, Tensor]:
        """Losses, see `sampled_losses`."""
        return sampled_losses(self.predict, batch)

    def predict(
        self,
        images: Float[Tensor, "n 3 pixel_row pixel_col"],
        chosen: Bool[Tensor, "n slot"] | None = None,
    ) -> SlotOutputs:
        """Patterns of images with colours from 0 to 1.

        Args:
            images: the images.
            chosen: slots whose edges are predicted; None for all. Others get the prior's edges.
        """
        if chosen is None:
            chosen = all_slots(images, self.config)
        features = self.project(self.image_encoder(images)).flatten(2).transpose(1, 2)
        memory = self.encoder(features + self.positions)
        panels = self.panels(self.panel_queries.expand(len(images), -1, -1), memory)
        # The keys of an edge's query are its own panel and the mean of the image, not all
        # positions: attention to all of them for every edge would take most of the time.
        queries = (panels[:, :, None] + self.edge_queries)[chosen]
        whole = memory.mean(1)[:, None].expand(-1, panels.shape[1], -1)
        keys = torch.stack([panels, whole], 2)[chosen]
        edges = self.edge_head(self.edges(queries, keys))
        found: SlotOutputs = self.output_prior(
            self.placement_head(panels), scatter_to_slots(edges, chosen)
        )
        return found


def _head(width: int, size: int) -> nn.Module:
    return nn.Sequential(nn.LayerNorm(width), zero_init(nn.Linear(width, size)))
