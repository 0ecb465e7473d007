"""A baseline after NeuralTailor (Korosteleva and Lee 2022): recurrent decoders of panels.

One vector of the whole image is unrolled by an LSTM into a vector for each slot, and each of these
by another LSTM into the edges of its panel, with their stitch tags. Input are images, not point
clouds, as where the GarmentImage paper compares with NeuralTailor.
"""

from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Bool, Float
from torch import Tensor, nn

from garmentimage.learn.blocks import zero_init
from garmentimage.learn.data import EDGE_SIZE, PLACEMENT_SIZE, ImagedSlots, SlotConfig, SlotOutputs
from garmentimage.learn.models.image_encoder import GlobalFeatures, make_image_encoder
from garmentimage.learn.models.slot_heads import (
    OutputPrior,
    all_slots,
    sampled_losses,
    scatter_to_slots,
)


class PanelRecurrent(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Images to patterns in slots."""

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        self.config = config
        width = config.width
        self.image_encoder = make_image_encoder(config.resnet)
        cells = config.picture // self.image_encoder.pixels
        self.global_features = GlobalFeatures(self.image_encoder.width, cells, width)
        self.panels = nn.LSTM(width, width, config.layers, batch_first=True)
        self.edges = nn.LSTM(width, width, config.layers, batch_first=True)
        self.placement_head = zero_init(nn.Linear(width, PLACEMENT_SIZE))
        self.edge_head = zero_init(nn.Linear(width, EDGE_SIZE))
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
        config = self.config
        if chosen is None:
            chosen = all_slots(images, config)
        whole = self.global_features(self.image_encoder(images))
        panels, _ = self.panels(whole[:, None].expand(-1, len(config.names), -1))
        edges, _ = self.edges(panels[chosen][:, None].expand(-1, config.edges, -1))
        found: SlotOutputs = self.output_prior(
            self.placement_head(panels), scatter_to_slots(self.edge_head(edges), chosen)
        )
        return found
