"""The baselines of Section 4.3 by name: networks that give patterns in slots."""

from collections.abc import Mapping
from dataclasses import dataclass

from torch import nn

from garmentimage.learn.models.panel_pool import PanelPool
from garmentimage.learn.models.panel_recurrent import PanelRecurrent
from garmentimage.learn.models.panel_transformer import PanelTransformer


@dataclass(frozen=True)
class SlotNetwork:
    """A baseline."""

    title: str
    what: str
    network: type[nn.Module]
    width: int
    layers: int


SLOT_NETWORKS: Mapping[str, SlotNetwork] = {
    "panel-transformer": SlotNetwork(
        "Panel transformer",
        "A transformer with queries for panels and edges, in the way of Sewformer",
        PanelTransformer,
        width=128,
        layers=3,
    ),
    "panel-recurrent": SlotNetwork(
        "Recurrent panels",
        "Recurrent decoders of panels and edges, in the way of NeuralTailor",
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
