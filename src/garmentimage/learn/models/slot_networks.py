"""The baselines of the paper's Section 4.3 by name: networks that predict patterns in slots."""

from collections.abc import Mapping
from dataclasses import dataclass

from torch import nn

from garmentimage.learn.models.panel_pool import PanelPool
from garmentimage.learn.models.panel_recurrent import PanelRecurrent
from garmentimage.learn.models.panel_transformer import PanelTransformer


@dataclass(frozen=True)
class SlotNetwork:
    """A baseline, and its default size."""

    title: str
    """Of its model card."""
    summary: str
    """The start of a sentence for its model card."""
    network: type[nn.Module]
    """Takes a `SlotConfig`."""
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
