"""A baseline in the way of Sewformer (Liu et al. 2023): a transformer with queries for panels.

Features of the picture go through a transformer encoder; one learnt query for each slot asks them
for its panel, and one for each edge of it for the edge. Written from the paper's description; the
slots are fixed by name, as the panels of its datasets are.
"""

from typing import Any

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
from garmentimage.learn.models.image_encoder import seer

HEADS = 4


class PanelTransformer(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Pictures to patterns in slots."""

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        width = config.width
        layer: dict[str, Any] = {
            "batch_first": True,
            "norm_first": True,
            "dropout": 0.0,
            "activation": "gelu",
        }
        sizes = (width, HEADS, 4 * width)
        self.see = seer(config.resnet)
        self.narrow = nn.Sequential(nn.Conv2d(self.see.width, width, 1), nn.BatchNorm2d(width))
        cells = config.picture // self.see.pixels
        self.places = nn.Parameter(0.1 * torch.randn(cells * cells, width))
        self.encoder = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(*sizes, **layer), config.layers, enable_nested_tensor=False
        )
        self.panel_queries = nn.Parameter(torch.randn(len(config.names), width))
        self.panels = nn.TransformerDecoder(
            nn.TransformerDecoderLayer(*sizes, **layer), config.layers
        )
        self.edge_queries = nn.Parameter(torch.randn(len(config.names), config.edges, width))
        self.edges = nn.TransformerDecoder(
            nn.TransformerDecoderLayer(*sizes, **layer), config.layers
        )
        self.to_place = nn.Sequential(nn.LayerNorm(width), quiet(nn.Linear(width, NUMBERS_A_PLACE)))
        self.to_edge = nn.Sequential(nn.LayerNorm(width), quiet(nn.Linear(width, NUMBERS_AN_EDGE)))
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
        slots = len(self.config.names)
        if which is None:
            which = torch.ones(len(seen), slots, dtype=torch.bool, device=seen.device)
        features = self.narrow(self.see(seen)).flatten(2).transpose(1, 2)
        memory = self.encoder(features + self.places)
        panels = self.panels(self.panel_queries.expand(len(seen), -1, -1), memory)
        # Every edge asks the panel that it is of, and the whole picture.
        queries = (panels[:, :, None] + self.edge_queries)[which]
        whole = memory.mean(1)[:, None].expand(-1, slots, -1)
        own = torch.stack([panels, whole], 2)[which]
        found: SlotOutputs = self.usual(
            self.to_place(panels), in_slots(self.to_edge(self.edges(queries, own)), which)
        )
        return found
