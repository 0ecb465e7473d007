"""Image to GarmentImage in three stages (paper, Section 4.3, Figure 7).

Three U-Nets, each trained with the ground truth of the stages before it (teacher forcing): flags
from the image; edge types from image and flags; edge vectors from image, flags and edge types. In
use, each takes the predictions of the stages before it.

Losses: binary cross-entropy of flags; cross-entropy of edge types, boundaries weighted; smooth L1
of edge vectors in cells inside. The paper (`PAPER_CONFIG`) has squared errors of flags and vectors
and none of the regularisers that `CascadeConfig` adds.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.data import (
    INPUT_CHANNELS,
    LAYERS,
    ImagedGarments,
    Rasters,
    mirrored_flags,
    mirrored_types,
    mirrored_vectors,
    mix_at_waist,
    recolour_cloth,
)
from garmentimage.learn.models.garment_vae import FLAGS, TYPES, check_channels, to_channels
from garmentimage.learn.models.unet import UNet, space_to_depth
from garmentimage.learn.weights import NetworkConfig
from garmentimage.raster import CHANNEL_CONTRACT, EDGE_TYPE_COUNT

VECTORS = INPUT_CHANNELS - FLAGS - TYPES
"""Channels of edge vectors."""


class Stage(StrEnum):
    """What a U-Net of the cascade predicts."""

    FLAGS = "flags"
    TYPES = "types"
    VECTORS = "vectors"


@dataclass(frozen=True)
class CascadeConfig(NetworkConfig):
    """Size of the networks, and how they are trained; `PAPER_CONFIG` is as in the paper."""

    channels_contract: str = CHANNEL_CONTRACT
    """Channel layout that the network was made for."""
    grid: int = 16
    """Cells a side, N."""
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

    def __post_init__(self) -> None:
        super().__post_init__()
        check_channels(self.channels_contract)


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


class Cascade(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
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
        config = self.config
        if config.mirror and self.training:
            batch = batch.mirrored(torch.rand(len(batch), device=batch.pictures.device) < 0.5)
        images = None
        if self.training:
            batch, is_mixed = mix_at_waist(batch, config.waist_mix)
            images = recolour_cloth(batch, is_mixed, config.recolour) if config.recolour else None
        image, truth = space_to_depth(batch.images() if images is None else images), batch.rasters
        maps = truth.inputs()
        flags, types = maps[:, :FLAGS], maps[:, FLAGS : FLAGS + TYPES]
        if config.label_noise and self.training:
            flags, types = (
                flag_noise(flags, config.label_noise),
                type_noise(types, config.label_noise),
            )
        losses = {
            "flags": self._flag_loss(self.to_flags(image), truth.inside.float()),
            "types": self._type_loss(self.to_types(image, flags), truth.types.long()),
            "vectors": self._vector_loss(
                self.to_vectors(image, torch.cat([flags, types], 1)), truth.vectors, truth.inside
            ),
        }
        losses["loss"] = losses["flags"] + losses["types"] + losses["vectors"]
        return losses

    def predict(
        self,
        images: Float[Tensor, "n 3 pixel_row pixel_col"],
        truth: Rasters | None = None,
        teacher: Stage | None = None,
    ) -> Float[Tensor, "n 34 row col"]:
        """Channels of images, as `decode` reads them: probabilities, and vectors in cm.

        Args:
            images: colours from 0 to 1, the lowest row of pixels first.
            truth: the garments in them, where a `teacher` is given.
            teacher: the last stage whose output is taken from the truth, with all before it; None
                for none.
        """
        count = 0 if truth is None or teacher is None else list(Stage).index(teacher) + 1
        logits = None if truth is None or not count else ground_truth_logits(truth)
        flags = (
            self._with_mirror_ensemble(self.to_flags, mirrored_flags, images)
            if logits is None
            else logits[:, :FLAGS]
        )
        inside = (flags > 0).float()
        if logits is None or count < 2:
            types = self._with_mirror_ensemble(self.to_types, mirrored_types, images, inside)
            if self.config.adjust_logits:
                types = adjust_logits(types, self.config.boundary_weight)
        else:
            types = logits[:, FLAGS : FLAGS + TYPES]
        if logits is None or count < 3:
            one_hot = one_hot_types(types)
            vectors = self._with_mirror_ensemble(
                self.to_vectors, mirrored_vectors, images, inside, one_hot
            )
        else:
            vectors = logits[:, FLAGS + TYPES :]
        return to_channels(torch.cat([flags, types, vectors], 1))

    def _with_mirror_ensemble(
        self,
        network: UNet,
        mirrored: Callable[[Tensor], Tensor],
        images: Tensor,
        inside: Tensor | None = None,
        types: Tensor | None = None,
    ) -> Tensor:
        """Output of a network; with `mirror`, the mean over images and mirror images.

        Args:
            network: one of the three.
            mirrored: exchanges left and right of its output.
            images: colours from 0 to 1.
            inside: flags, if it takes them.
            types: edge types, one-hot, if it takes them.
        """
        found: Tensor = network(space_to_depth(images), _stacked(inside, types))
        if not self.config.mirror:
            return found
        turned = _stacked(
            None if inside is None else mirrored_flags(inside),
            None if types is None else mirrored_types(types),
        )
        return (found + mirrored(network(space_to_depth(images.flip(-1)), turned))) / 2

    def _flag_loss(self, logits: Tensor, inside: Tensor) -> Tensor:
        if self.config.squared_losses:
            return functional.mse_loss(logits.sigmoid(), inside)
        return functional.binary_cross_entropy_with_logits(logits, inside)

    def _type_loss(self, logits: Tensor, types: Tensor) -> Tensor:
        weight = torch.where(types > 0, self.config.boundary_weight, 1.0)
        by_type = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT)).transpose(1, 2)
        return (weight * functional.cross_entropy(by_type, types, reduction="none")).mean()

    def _vector_loss(self, found: Tensor, vectors: Tensor, inside: Tensor) -> Tensor:
        """Mean over the cells inside of the summed error of their eight numbers."""
        is_cloth = inside.float().repeat_interleave(8, 1)
        differences = (found - vectors.float()) * is_cloth
        if self.config.squared_losses:
            return (differences**2).sum() / is_cloth.sum()
        zeros = torch.zeros_like(differences)
        return (
            functional.smooth_l1_loss(differences, zeros, beta=0.01, reduction="sum")
            / is_cloth.sum()
        )


def _stacked(inside: Tensor | None, types: Tensor | None) -> Tensor | None:
    maps = [each for each in (inside, types) if each is not None]
    return torch.cat(maps, 1) if maps else None


def adjust_logits(
    logits: Float[Tensor, "n 16 row col"], weight: float
) -> Float[Tensor, "n 16 row col"]:
    """Logits of edge types without the boundary weight of the loss (logit adjustment).

    Trained with a weight w on boundaries, a network gives them w times their true odds; log w is
    subtracted from their logits (Menon et al. 2021).
    """
    is_boundary = torch.arange(EDGE_TYPE_COUNT, device=logits.device) > 0
    by_type = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT))
    return (by_type - math.log(weight) * is_boundary[:, None, None]).flatten(1, 2)


def one_hot_types(logits: Float[Tensor, "n 16 row col"]) -> Float[Tensor, "n 16 row col"]:
    """The likeliest type of every grid edge, one-hot."""
    chosen = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT)).argmax(2, keepdim=True)
    kinds = torch.arange(EDGE_TYPE_COUNT, device=logits.device)[:, None, None]
    return (chosen == kinds).float().flatten(1, 2)


def ground_truth_logits(truth: Rasters) -> Float[Tensor, "n 34 row col"]:
    """Maps of garments as a network would give them: labels as certain logits, vectors."""
    maps = truth.inputs()
    logits = (2 * maps[:, : FLAGS + TYPES] - 1) * CERTAIN_LOGIT
    return torch.cat([logits, maps[:, FLAGS + TYPES :]], 1)


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
