"""A baseline in the way of NeuralTailor (Korosteleva and Lee 2022): recurrent decoders of panels.

The whole picture becomes one vector; a recurrent network unrolls it into a vector for each slot,
and another unrolls each of these into the edges of its panel. As where the GarmentImage paper
compares with it, pictures are encoded, not point clouds. Tags of stitches come with the edges.
"""

from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn

from garmentimage.learn.seer import Whole, seer
from garmentimage.learn.slot_vectors import (
    NUMBERS_A_PLACE,
    NUMBERS_AN_EDGE,
    PicturedSlots,
    SlotConfig,
    SlotOutputs,
    Usual,
    quiet,
    slot_losses,
)


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
        return slot_losses(self.predict(batch.seen()), batch.patterns)

    def predict(self, seen: Float[Tensor, "n 3 pixel_row pixel_col"]) -> SlotOutputs:
        """Patterns of pictures."""
        config = self.config
        whole = self.whole(self.see(seen))
        panels, _ = self.panels(whole[:, None].expand(-1, len(config.names), -1))
        each = panels.flatten(0, 1)[:, None].expand(-1, config.edges, -1)
        edges, _ = self.edges(each)
        numbers = self.to_edge(edges).unflatten(0, panels.shape[:2])
        found: SlotOutputs = self.usual(self.to_place(panels), numbers)
        return found
