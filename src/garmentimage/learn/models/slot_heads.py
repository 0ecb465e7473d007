"""Heads and losses that all baselines share: networks from images to patterns in slots.

Formulation of the loss (`slot_losses`): squared errors of edges, of the sum of every panel's edges
(a closed loop has sum 0), of placements and of stitch tags, and binary cross-entropy of free edges,
with weights `LOSS_WEIGHTS`. As in NeuralTailor (Korosteleva and Lee 2022, Section 4.3).
"""

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.data import (
    EDGE_SIZE,
    PLACEMENT_SIZE,
    ROW,
    TAGS,
    SlotConfig,
    SlotOutputs,
    SlotVectors,
)

SLOTS_PER_STEP = 10
"""Slots whose edges are predicted in a training step, of a garment on average."""
LOSS_WEIGHTS = {"shapes": 10.0, "loops": 0.1, "free": 0.5}
"""Of the losses whose weight is not 1."""


class OutputPrior(nn.Module):
    """Learnt output of an untrained network, initialised to the mean of the training set.

    Networks predict the difference from it; otherwise learning the mean takes a transformer most of
    a small budget.
    """

    def __init__(self, config: SlotConfig) -> None:
        super().__init__()
        slots = len(config.names)
        self.placements = nn.Parameter(torch.zeros(slots, PLACEMENT_SIZE))
        self.edges = nn.Parameter(torch.zeros(slots, config.edges, EDGE_SIZE))

    @torch.no_grad()
    def set_to_mean(self, train_set: SlotVectors) -> None:
        """Start from the mean of these garments."""
        means = torch.cat([train_set.rotations, train_set.translations], 2).mean(0)
        self.placements.copy_(means)
        free = torch.logit(1 - train_set.sewn.float().mean(0), 0.01)[..., None]
        self.edges.copy_(torch.cat([train_set.edges.mean(0), train_set.tags.mean(0), free], 2))

    def forward(
        self, placements: Float[Tensor, "n slot 7"], edges: Float[Tensor, "n slot edge 10"]
    ) -> SlotOutputs:
        """Sum of the prior and a network's numbers, by what they are."""
        rotations, translations = (self.placements + placements).split([4, 3], 2)
        rows, tags, free = (self.edges + edges).split([ROW, TAGS, 1], 3)
        return SlotOutputs(rows, rotations, translations, tags, free[..., 0])


def sample_slots(is_present: Bool[Tensor, "n slot"]) -> Float[Tensor, "n slot"]:
    """Draw the slots whose edges are predicted in a training step, with weights of their edges.

    Most slots of a garment are empty, and their edges 0. So all slots with a panel are chosen, and
    a share p of the empty ones such that `SLOTS_PER_STEP` are chosen on average. Chosen empty slots
    weigh 1 / sqrt(p): their squared errors, times 1 / p, are unbiased estimates of those of all.

    Args:
        is_present: slots that have a panel.

    Returns:
        Weights; 0 for slots that are not chosen.
    """
    empty = (~is_present).sum()
    budget = SLOTS_PER_STEP * len(is_present) - is_present.sum()
    share = (budget / empty.clamp(min=1)).clamp(1 / SLOTS_PER_STEP, 1)
    chosen = torch.rand(is_present.shape, device=is_present.device) < share
    return torch.where(is_present, 1.0, chosen * share.rsqrt())


def scatter_to_slots(
    values: Float[Tensor, "chosen edge k"], chosen: Bool[Tensor, "n slot"]
) -> Float[Tensor, "n slot edge k"]:
    """Values of the chosen slots in their slots, 0 elsewhere."""
    return values.new_zeros(*chosen.shape, *values.shape[1:]).masked_scatter(
        chosen[..., None, None], values
    )


def slot_losses(found: SlotOutputs, truth: SlotVectors) -> dict[str, Tensor]:
    """Losses of predicted garments (see above), and `loss`, their weighted sum."""
    panels, sewn = truth.is_present[..., 0], truth.sewn
    gaps = found.edges[..., :2].sum(2)[panels]
    losses = {
        "shapes": functional.mse_loss(found.edges, truth.edges),
        "loops": (gaps**2).mean(),
        "rotations": functional.mse_loss(found.rotations[panels], truth.rotations[panels]),
        "translations": functional.mse_loss(found.translations[panels], truth.translations[panels]),
        "tags": functional.mse_loss(found.tags[sewn], truth.tags[sewn]),
        "free": functional.binary_cross_entropy_with_logits(
            found.free[truth.is_present], 1 - sewn[truth.is_present].float()
        ),
    }
    weighted = [LOSS_WEIGHTS.get(name, 1.0) * value for name, value in losses.items()]
    return {**losses, "loss": torch.stack(weighted).sum()}
