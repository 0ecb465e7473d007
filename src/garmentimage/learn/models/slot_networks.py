"""The baselines of the paper's Section 4.3: networks from images to patterns in slots.

`PanelTransformer` is written from the description of Sewformer (Liu et al. 2023); its slots are
fixed by name, as the panels of its datasets are. `PanelRecurrent` has the decoders of NeuralTailor
(Korosteleva and Lee 2022), whose input are point clouds; with images, as where the GarmentImage
paper compares with it. `PanelPool` is the cheapest.
"""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.blocks import transformer_options, zero_init
from garmentimage.learn.data import EDGE_SIZE, PLACEMENT_SIZE, ImagedSlots, SlotConfig, SlotOutputs
from garmentimage.learn.models.image_encoder import GlobalFeatures, make_image_encoder
from garmentimage.learn.models.slot_heads import (
    OutputPrior,
    sample_slots,
    scatter_to_slots,
    slot_losses,
)
from garmentimage.learn.weights import Network

ATTENTION_HEADS = 4


class SlotPredictor(Network):
    """Images to patterns in slots: differences from a prior, see `OutputPrior`."""

    output_prior: OutputPrior

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        self.image_encoder = make_image_encoder(config.resnet)
        self.cells = config.picture // self.image_encoder.pixels

    @abstractmethod
    def predict(self, images: Float[Tensor, "n 3 pixel_row pixel_col"]) -> SlotOutputs:
        """Patterns of images with colours from 0 to 1."""


class ChosenSlotPredictor(SlotPredictor):
    """A network that can predict the edges of chosen slots only, which is quicker."""

    def forward(self, batch: ImagedSlots) -> dict[str, Tensor]:
        """Losses, with the edges of a sample of slots (`sample_slots`)."""
        weights = sample_slots(batch.patterns.is_present[..., 0])
        found = self.predict(batch.images(), weights > 0)
        return slot_losses(found.weighted(weights), batch.patterns)

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
            shape = len(images), len(self.config.names)
            chosen = torch.ones(shape, dtype=torch.bool, device=images.device)
        placements, edges = self.numbers(images, chosen)
        found: SlotOutputs = self.output_prior(placements, scatter_to_slots(edges, chosen))
        return found

    @abstractmethod
    def numbers(self, images: Tensor, chosen: Tensor) -> tuple[Tensor, Tensor]:
        """Placements [n, slot, 7] and edges of chosen slots [chosen, edge, 10]."""


class PanelTransformer(ChosenSlotPredictor):
    """A transformer with queries for panels and edges, after Sewformer.

    The feature map of the image goes through a transformer encoder; a learnt query for each slot
    attends to it for the panel, and one for each edge of a slot attends to its panel and to the
    whole image.
    """

    def __init__(self, config: SlotConfig) -> None:
        super().__init__(config)
        width, slots = config.width, len(config.names)
        layer = transformer_options(width, ATTENTION_HEADS)
        self.project = nn.Sequential(
            nn.Conv2d(self.image_encoder.width, width, 1), nn.BatchNorm2d(width)
        )
        self.positions = nn.Parameter(0.1 * torch.randn(self.cells * self.cells, width))
        self.encoder = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(**layer), config.layers, enable_nested_tensor=False
        )
        self.panel_queries = nn.Parameter(torch.randn(slots, width))
        self.panels = nn.TransformerDecoder(nn.TransformerDecoderLayer(**layer), config.layers)
        self.edge_queries = nn.Parameter(torch.randn(slots, config.edges, width))
        self.edges = nn.TransformerDecoder(nn.TransformerDecoderLayer(**layer), config.layers)
        self.placement_head, self.edge_head = (
            nn.Sequential(nn.LayerNorm(width), zero_init(nn.Linear(width, size)))
            for size in (PLACEMENT_SIZE, EDGE_SIZE)
        )
        self.output_prior = OutputPrior(config)

    def numbers(self, images: Tensor, chosen: Tensor) -> tuple[Tensor, Tensor]:
        """See `ChosenSlotPredictor`."""
        features = self.project(self.image_encoder(images)).flatten(2).transpose(1, 2)
        memory = self.encoder(features + self.positions)
        panels = self.panels(self.panel_queries.expand(len(images), -1, -1), memory)
        # The keys of an edge's query are its own panel and the mean of the image, not all
        # positions: attention to all of them for every edge would take most of the time.
        queries = (panels[:, :, None] + self.edge_queries)[chosen]
        whole = memory.mean(1)[:, None].expand(-1, panels.shape[1], -1)
        keys = torch.stack([panels, whole], 2)[chosen]
        return self.placement_head(panels), self.edge_head(self.edges(queries, keys))


class PanelRecurrent(ChosenSlotPredictor):
    """Recurrent decoders of panels and edges, after NeuralTailor.

    One vector of the whole image is unrolled by an LSTM into a vector for each slot, and each of
    these by another LSTM into the edges of its panel, with their stitch tags.
    """

    def __init__(self, config: SlotConfig) -> None:
        super().__init__(config)
        width = config.width
        self.global_features = GlobalFeatures(self.image_encoder.width, self.cells, width)
        self.panels = nn.LSTM(width, width, config.layers, batch_first=True)
        self.edges = nn.LSTM(width, width, config.layers, batch_first=True)
        self.placement_head = zero_init(nn.Linear(width, PLACEMENT_SIZE))
        self.edge_head = zero_init(nn.Linear(width, EDGE_SIZE))
        self.output_prior = OutputPrior(config)

    def numbers(self, images: Tensor, chosen: Tensor) -> tuple[Tensor, Tensor]:
        """See `ChosenSlotPredictor`."""
        whole = self.global_features(self.image_encoder(images))
        panels, _ = self.panels(whole[:, None].expand(-1, len(self.config.names), -1))
        edges, _ = self.edges(panels[chosen][:, None].expand(-1, self.config.edges, -1))
        return self.placement_head(panels), self.edge_head(edges)


class PanelPool(SlotPredictor):
    """All numbers of a fixed pool of panels, and which of them are present, in one step.

    One vector of the whole image is mapped to them by linear heads; panels do not depend on each
    other.
    """

    def __init__(self, config: SlotConfig) -> None:
        super().__init__(config)
        width, slots = config.width, len(config.names)
        self.global_features = nn.Sequential(
            GlobalFeatures(self.image_encoder.width, self.cells, width), nn.SiLU()
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
        """See `SlotPredictor`."""
        found, logits = self._outputs(images)
        return replace(found, edges=torch.where(logits[..., None, None] > 0, found.edges, 0))

    def _outputs(self, images: Tensor) -> tuple[SlotOutputs, Float[Tensor, "n slot"]]:
        """All slots, and logits of whether their panels are present."""
        whole, slots = self.global_features(self.image_encoder(images)), len(self.config.names)
        placements = self.placement_head(whole).unflatten(1, (slots, PLACEMENT_SIZE))
        edges = self.edge_head(whole).unflatten(1, (slots, self.config.edges, EDGE_SIZE))
        return self.output_prior(placements, edges), self.presence_head(whole)


@dataclass(frozen=True)
class SlotNetwork:
    """A baseline, and its default size."""

    title: str
    """Of its model card."""
    summary: str
    """The start of a sentence for its model card."""
    network: type[SlotPredictor]
    width: int
    """Of its layers."""
    layers: int
    """Of the encoder and of each decoder."""


SLOT_NETWORKS: Mapping[str, SlotNetwork] = {
    "panel-transformer": SlotNetwork(
        "Panel transformer",
        "A transformer with queries for panels and edges, after Sewformer",
        PanelTransformer,
        width=128,
        layers=3,
    ),
    "panel-recurrent": SlotNetwork(
        "Recurrent panels",
        "Recurrent decoders of panels and edges, after NeuralTailor",
        PanelRecurrent,
        width=192,
        layers=2,
    ),
    "panel-pool": SlotNetwork(
        "Panel pool",
        "All numbers of a fixed pool of panels in one step",
        PanelPool,
        width=256,
        layers=1,
    ),
}
