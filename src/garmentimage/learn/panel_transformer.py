"""A baseline in the way of Sewformer (Liu et al. 2023): a transformer with queries for panels.

Features of the picture go through a transformer encoder; one learnt query for each slot asks them
for its panel, and one for each edge of it for the edge. Written from the paper's description; the
slots are fixed by name, as the panels of its datasets are.
"""

from dataclasses import dataclass
from typing import Any

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn

from garmentimage.learn.seer import WIDTHS, Seer
from garmentimage.learn.slot_vectors import ROW, TAGS, PicturedSlots, SlotOutputs, slot_losses

PIXELS_A_FEATURE = 16


@dataclass(frozen=True)
class PanelTransformerConfig:
    """Size of the network."""

    slots: int
    edges: int
    picture: int = 128
    width: int = 128
    heads: int = 4
    encoder_layers: int = 3
    decoder_layers: int = 3


class PanelTransformer(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Pictures to patterns in slots."""

    def __init__(self, config: PanelTransformerConfig) -> None:
        super().__init__()
        self.config = config
        width, cells = config.width, config.picture // PIXELS_A_FEATURE
        layer: dict[str, Any] = {
            "batch_first": True,
            "norm_first": True,
            "dropout": 0.0,
            "activation": "gelu",
        }
        sizes = (width, config.heads, 4 * width)
        self.see = Seer()
        self.narrow = nn.Conv2d(WIDTHS[-1], width, 1)
        self.places = nn.Parameter(0.1 * torch.randn(cells * cells, width))
        self.encoder = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(*sizes, **layer),
            config.encoder_layers,
            enable_nested_tensor=False,
        )
        self.panel_queries = nn.Parameter(torch.randn(config.slots, width))
        self.panels = nn.TransformerDecoder(
            nn.TransformerDecoderLayer(*sizes, **layer),
            config.decoder_layers,
        )
        self.edge_queries = nn.Parameter(torch.randn(config.edges, width))
        self.edges = nn.TransformerDecoder(
            nn.TransformerDecoderLayer(*sizes, **layer),
            config.decoder_layers,
        )
        self.to_place = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, 7))
        self.to_edge = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, ROW + TAGS + 1))

    def forward(self, batch: PicturedSlots) -> dict[str, Tensor]:
        """The whole loss, and what it is made of."""
        return slot_losses(self.predict(batch.seen()), batch.patterns)

    def predict(self, seen: Float[Tensor, "n 3 pixel_row pixel_col"]) -> SlotOutputs:
        """Patterns of pictures."""
        config = self.config
        features = self.narrow(self.see(seen)).flatten(2).transpose(1, 2)
        memory = self.encoder(features + self.places)
        panels = self.panels(self.panel_queries.expand(len(seen), -1, -1), memory)
        # Every edge asks the panel that it is of, and knows the panel it starts from.
        asked = (panels[:, :, None] + self.edge_queries).flatten(0, 1)
        own = torch.cat([panels.flatten(0, 1)[:, None], _repeated(memory.mean(1), config)], 1)
        edges = self.to_edge(self.edges(asked, own)).unflatten(0, (len(seen), config.slots))
        return outputs(self.to_place(panels), edges)


def _repeated(whole: Float[Tensor, "n width"], config: PanelTransformerConfig) -> Tensor:
    return whole[:, None].expand(-1, config.slots, -1).flatten(0, 1)[:, None]


def outputs(
    places: Float[Tensor, "n slot 7"], edges: Float[Tensor, "n slot edge 10"]
) -> SlotOutputs:
    """The numbers of panels and edges, by what they mean."""
    rows, tags, free = edges.split([ROW, TAGS, 1], 3)
    return SlotOutputs(rows, places[..., :4], places[..., 4:], tags, free[..., 0])
