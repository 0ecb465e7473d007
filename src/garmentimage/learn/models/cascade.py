"""Image to GarmentImage in three stages (paper, Section 4.3, Figure 7).

Three U-Nets, each trained with the ground truth of the stages before it (teacher forcing): flags
from the image; edge types from image and flags; edge vectors from image, flags and edge types. In
use, each takes the predictions of the stages before it.

Losses: binary cross-entropy of flags; cross-entropy of edge types, boundaries weighted; smooth L1
of edge vectors in cells inside. The paper (`PAPER_CONFIG`) has squared errors of flags and vectors
and none of the regularisers that `CascadeConfig` adds.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from garmentimage.learn.data import (
    LAYERS,
    ImagedGarments,
    Rasters,
    mirrored_flags,
    mirrored_types,
    mirrored_vectors,
    mix_at_waist,
    recolour_cloth,
)
from garmentimage.learn.models.garment_vae import (
    FLAGS,
    MAPS,
    TYPES,
    VECTORS,
    image_losses,
    output_channels,
)
from garmentimage.learn.models.unet import UNet
from garmentimage.learn.weights import ImageNetworkConfig, Network
from garmentimage.raster import EDGE_TYPE_COUNT


class Stage(StrEnum):
    """What a U-Net of the cascade predicts."""

    FLAGS = "flags"
    TYPES = "types"
    VECTORS = "vectors"


@dataclass(frozen=True)
class CascadeConfig(ImageNetworkConfig):
    """Size of the networks, and how they are trained; `PAPER_CONFIG` is as in the paper."""

    picture: int = 128
    """Pixels a side."""
    channels: Sequence[int] = (48, 64, 64)
    """Of each level of each network."""
    squared_losses: bool = False
    """Squared errors of flags and vectors instead of cross-entropy and smooth L1."""
    label_noise: float = 0.02
    """Share of flags and edge types at boundaries that are wrong in the teacher's maps: so a stage
    learns to live with the errors of those before it."""
    mirror: bool = True
    """Mirror half of the garments in training, and average over the image and its mirror image in
    use (test-time augmentation)."""
    dropout: float = 0.1
    """Share of channels that are left out in training, of flags and edge types."""
    recolour: float = 0.5
    """Share of garments whose cloth is recoloured in training; 0 also leaves mixed garments in
    their own colours (`recolour_cloth`)."""
    waist_mix: float = 0.5
    """Share of garments that get the upper or lower half of another in training, where one fits
    (`mix_at_waist`)."""
    boundary_weight: float = 3.0
    """Weight of the cross-entropy at boundaries, relative to grid edges inside (NON_BOUNDARY)."""
    adjust_logits: bool = True
    """Correct logits of edge types for `boundary_weight` in use (`adjust_logits`); otherwise seams
    appear where none is likeliest."""


CERTAIN_LOGIT = 20.0
"""Logit of a certain label."""
PAPER_CONFIG = CascadeConfig(
    squared_losses=True,
    label_noise=0.0,
    boundary_weight=1.0,
    adjust_logits=False,
    mirror=False,
    dropout=0.0,
    waist_mix=0.0,
    recolour=0.0,
)
ABLATIONS = {
    "losses": ("squared_losses",),
    "noise": ("label_noise",),
    "weights": ("boundary_weight",),
    "shares": ("adjust_logits",),
    "mirror": ("mirror",),
    "dropout": ("dropout",),
    "recombine": ("waist_mix",),
    "recolour": ("recolour",),
}
"""Our departures from the paper by name, and the settings that are as in the paper without them."""


class Cascade(Network):
    """Images to GarmentImages."""

    def __init__(self, config: CascadeConfig) -> None:
        super().__init__()
        self.config = config

        def unet(maps: int, out: int, dropout: float = 0.0) -> UNet:
            return UNet(
                maps,
                out,
                grid=config.grid,
                picture=config.picture,
                widths=config.channels,
                dropout=dropout,
            )

        self.to_flags = unet(0, FLAGS, config.dropout)
        self.to_types = unet(FLAGS, TYPES, config.dropout)
        self.to_vectors = unet(FLAGS + TYPES, VECTORS)

    def forward(self, batch: ImagedGarments) -> dict[str, Tensor]:
        """Losses of the three networks, each given the ground truth of the stages before it."""
        config, images = self.config, None
        if config.mirror and self.training:
            batch = batch.mirrored(torch.rand(len(batch), device=batch.pictures.device) < 0.5)
        if self.training:
            batch, is_mixed = mix_at_waist(batch, config.waist_mix)
            images = recolour_cloth(batch, is_mixed, config.recolour) if config.recolour else None
        images, truth = batch.images() if images is None else images, batch.rasters
        flags, types, _ = truth.inputs().split(MAPS, 1)
        if config.label_noise and self.training:
            flags = flag_noise(flags, config.label_noise)
            types = type_noise(types, config.label_noise)
        outputs = torch.cat(
            [self.to_flags(images), self.to_types(images, flags),
             self.to_vectors(images, flags, types)], 1
        )  # fmt: skip
        losses = image_losses(outputs, truth, config.boundary_weight, squared=config.squared_losses)
        return {**losses, "loss": losses["flags"] + losses["types"] + losses["vectors"]}

    def predict(
        self,
        images: Float[Tensor, "n 3 pixel_row pixel_col"],
        truth: Rasters | None = None,
        teacher: Stage | None = None,
    ) -> Float[Tensor, "n 34 row col"]:
        """Channels of images, as `decode` reads them: probabilities, and vectors in cm.

        With `mirror`, outputs are means over the images and their mirror images.

        Args:
            images: colours from 0 to 1, the lowest row of pixels first.
            truth: the garments in them, where a `teacher` is given.
            teacher: the last stage whose output is taken from the truth, with all before it; None
                for none.
        """
        known: tuple[Tensor, ...] = ()
        if truth is not None and teacher is not None:
            count = list(Stage).index(teacher) + 1
            known = ground_truth_logits(truth).split(MAPS, 1)[:count]
        outputs: list[Tensor] = []
        maps: list[Tensor] = []
        mirrored_maps: list[Tensor] = []
        for stage, network, mirrored in (
            (Stage.FLAGS, self.to_flags, mirrored_flags),
            (Stage.TYPES, self.to_types, mirrored_types),
            (Stage.VECTORS, self.to_vectors, mirrored_vectors),
        ):
            if len(outputs) < len(known):
                found = known[len(outputs)]
            else:
                found = network(images, *maps)
                if self.config.mirror:
                    found = (found + mirrored(network(images.flip(-1), *mirrored_maps))) / 2
                if stage == Stage.TYPES and self.config.adjust_logits:
                    found = adjust_logits(found, self.config.boundary_weight)
            outputs.append(found)
            if stage != Stage.VECTORS:
                maps.append((found > 0).float() if stage == Stage.FLAGS else one_hot_types(found))
                mirrored_maps.append(mirrored(maps[-1]))
        return output_channels(torch.cat(outputs, 1))


def adjust_logits(
    logits: Float[Tensor, "n 16 row col"], weight: float
) -> Float[Tensor, "n 16 row col"]:
    """Logits of edge types without the boundary weight of the loss (logit adjustment).

    Trained with a weight w on boundaries, a network gives them w times their true odds; log w is
    subtracted from their logits (Menon et al. 2021).
    """
    is_boundary = torch.arange(EDGE_TYPE_COUNT, device=logits.device) > 0
    by_type: Tensor = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT))
    return (by_type - math.log(weight) * is_boundary[:, None, None]).flatten(1, 2)


def one_hot_types(logits: Float[Tensor, "n 16 row col"]) -> Float[Tensor, "n 16 row col"]:
    """The likeliest type of every grid edge, one-hot."""
    by_type: Tensor = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT))
    kinds = torch.arange(EDGE_TYPE_COUNT, device=logits.device)[:, None, None]
    return (by_type.argmax(2, keepdim=True) == kinds).float().flatten(1, 2)


def ground_truth_logits(truth: Rasters) -> Float[Tensor, "n 34 row col"]:
    """Maps of garments as a network would give them: labels as certain logits, vectors."""
    labels, vectors = truth.inputs().split([FLAGS + TYPES, VECTORS], 1)
    return torch.cat([(2 * labels - 1) * CERTAIN_LOGIT, vectors], 1)


def flag_noise(flags: Float[Tensor, "n 2 row col"], share: float) -> Float[Tensor, "n 2 row col"]:
    """Flags, a share of those beside the outline flipped."""
    beside = functional.max_pool2d(flags, 3, 1, 1) != -functional.max_pool2d(-flags, 3, 1, 1)
    is_wrong = beside & (torch.rand_like(flags) < share)
    return torch.where(is_wrong, 1 - flags, flags)


def type_noise(types: Float[Tensor, "n 16 row col"], share: float) -> Float[Tensor, "n 16 row col"]:
    """One-hot edge types, a share of the boundaries redrawn from all types."""
    one_hot = types.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT))
    is_wrong = (one_hot[:, :, :1] < 0.5) & (torch.rand_like(one_hot[:, :, :1]) < share)
    other = torch.randint(0, EDGE_TYPE_COUNT, is_wrong.shape, device=types.device)
    kinds = torch.arange(EDGE_TYPE_COUNT, device=types.device)[:, None, None]
    return torch.where(is_wrong, (other == kinds).to(one_hot), one_hot).flatten(1, 2)
