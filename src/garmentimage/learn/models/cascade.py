"""Picture to GarmentImage in three steps (paper, Section 4.3, Figure 7).

Three U-Nets, each taught with the truth of what came before it: flags from the picture; edge types
from the picture and flags; edge vectors from the picture, flags and edge types. Used, each is given
what the one before it predicted.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.data import (
    INPUTS,
    LAYERS,
    Pictured,
    Rasters,
    mirrored_flags,
    mirrored_types,
    mirrored_vectors,
    recombined,
    repainted,
)
from garmentimage.learn.models.garment_vae import FLAGS, TYPES, check_channels, to_channels
from garmentimage.learn.models.unet import UNet, folded
from garmentimage.raster import CHANNEL_CONTRACT, EDGE_TYPE_COUNT


@dataclass(frozen=True)
class CascadeConfig:
    """Size of the networks, and how they are taught; `PAPER` is as in the paper."""

    channels_contract: str = CHANNEL_CONTRACT
    grid: int = 16
    picture: int = 128
    """Pixels a side."""
    channels: tuple[int, ...] = (48, 64, 64)
    """Of each level of each network."""
    squares: bool = False
    """Flags and vectors are judged by squares, not by cross-entropy and distance."""
    noise: float = 0.02
    """Share of flags and edge types at boundaries that are wrong in what is taught with."""
    mirror: bool = True
    """Half of the garments are shown with left and right exchanged, and pictures are looked at both
    ways when the network is used."""
    dropout: float = 0.1
    """Share of channels that are left out when flags and edge types are taught."""
    recolour: float = 0.5
    """Share of garments that are shown in other colours than those of the recipe; 0 also leaves
    those that are joined from two as they are (`repainted`)."""
    recombine: float = 0.5
    """Share of garments that are shown with the upper or the lower half of another, where one fits
    (`recombined`)."""
    boundary_weight: float = 3.0
    """Of an edge type that is not NON_BOUNDARY, against one that is."""
    even: bool = True
    """In use, shares of edge types are freed of that weight (`evened`), else there are seams where
    nothing is the likeliest."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))  # JSON has lists
        check_channels(self.channels_contract)


SURE = 20.0
"""Logit of what is certain."""
PAPER = CascadeConfig(
    squares=True,
    noise=0.0,
    boundary_weight=1.0,
    even=False,
    mirror=False,
    dropout=0.0,
    recombine=0.0,
    recolour=0.0,
)
DEPARTURES = {
    "losses": ("squares",),
    "noise": ("noise",),
    "weights": ("boundary_weight",),
    "shares": ("even",),
    "mirror": ("mirror",),
    "dropout": ("dropout",),
    "recombine": ("recombine",),
    "recolour": ("recolour",),
}
"""What of ours may be left out, and the settings that are then as in the paper."""


class Cascade(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Pictures to images."""

    def __init__(self, config: CascadeConfig) -> None:
        super().__init__()
        self.config = config
        size = config.grid, config.picture, config.channels
        self.to_flags = UNet(0, FLAGS, *size, config.dropout)
        self.to_types = UNet(FLAGS, TYPES, *size, config.dropout)
        self.to_vectors = UNet(FLAGS + TYPES, INPUTS - FLAGS - TYPES, *size)

    def forward(self, batch: Pictured) -> dict[str, Tensor]:
        """The whole loss, and those of the three networks, each taught with the truth."""
        config = self.config
        if config.mirror and self.training:
            batch = batch.mirrored(torch.rand(len(batch), device=batch.pictures.device) < 0.5)
        seen = None
        if self.training:
            batch, new = recombined(batch, config.recombine)
            seen = repainted(batch, new, config.recolour) if config.recolour else None
        picture, truth = folded(batch.seen() if seen is None else seen), batch.rasters
        maps = truth.inputs()
        flags, types = maps[:, :FLAGS], maps[:, FLAGS : FLAGS + TYPES]
        if config.noise and self.training:
            flags, types = flipped(flags, config.noise), redrawn(types, config.noise)
        parts = {
            "flags": self._flag_loss(self.to_flags(picture), truth.inside.float()),
            "types": self._type_loss(self.to_types(picture, flags), truth.types.long()),
            "vectors": self._vector_loss(
                self.to_vectors(picture, torch.cat([flags, types], 1)), truth.vectors, truth.inside
            ),
        }
        parts["loss"] = parts["flags"] + parts["types"] + parts["vectors"]
        return parts

    def predict(
        self,
        seen: Float[Tensor, "n 3 pixel_row pixel_col"],
        truth: Rasters | None = None,
        given: int = -1,
    ) -> Float[Tensor, "n 34 row col"]:
        """Channels of pictures, as `decode` reads them: probabilities, and vectors in cm.

        Args:
            seen: pictures.
            truth: what is given instead of being predicted, if anything.
            given: how far it is given: 0 the flags, 1 edge types, too, 2 all.
        """
        known = None if truth is None else sure_maps(truth)
        if known is None or given < 0:
            flags = self._asked(self.to_flags, mirrored_flags, seen)
        else:
            flags = known[:, :FLAGS]
        inside = (flags > 0).float()
        if known is None or given < 1:
            types = self._asked(self.to_types, mirrored_types, seen, inside)
            if self.config.even:
                types = evened(types, self.config.boundary_weight)
        else:
            types = known[:, FLAGS : FLAGS + TYPES]
        if known is None or given < 2:
            one_hot = likeliest_types(types)
            vectors = self._asked(self.to_vectors, mirrored_vectors, seen, inside, one_hot)
        else:
            vectors = known[:, FLAGS + TYPES :]
        return to_channels(torch.cat([flags, types, vectors], 1))

    def _asked(
        self,
        network: UNet,
        mirrored: Callable[[Tensor], Tensor],
        seen: Tensor,
        inside: Tensor | None = None,
        types: Tensor | None = None,
    ) -> Tensor:
        """What a network says, taught with mirror images the mean over both ways of looking.

        Args:
            network: one of the three.
            mirrored: exchanges left and right of what it gives.
            seen: pictures.
            inside: flags, if it takes them.
            types: edge types, one-hot, if it takes them.
        """
        found = network(folded(seen), *_joined(inside, types))
        if not self.config.mirror:
            return found
        turned = _joined(
            None if inside is None else mirrored_flags(inside),
            None if types is None else mirrored_types(types),
        )
        return (found + mirrored(network(folded(seen.flip(-1)), *turned))) / 2

    def _flag_loss(self, logits: Tensor, inside: Tensor) -> Tensor:
        if self.config.squares:
            return functional.mse_loss(logits.sigmoid(), inside)
        return functional.binary_cross_entropy_with_logits(logits, inside)

    def _type_loss(self, logits: Tensor, types: Tensor) -> Tensor:
        weight = torch.where(types > 0, self.config.boundary_weight, 1.0)
        shares = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT)).transpose(1, 2)
        return (weight * functional.cross_entropy(shares, types, reduction="none")).mean()

    def _vector_loss(self, found: Tensor, vectors: Tensor, inside: Tensor) -> Tensor:
        known = inside.float().repeat_interleave(8, 1)
        apart = (found - vectors.float()) * known
        if self.config.squares:
            return (apart**2).sum() / known.sum()
        return (
            functional.smooth_l1_loss(apart, torch.zeros_like(apart), beta=0.01, reduction="sum")
            / known.sum()
        )


def _joined(inside: Tensor | None, types: Tensor | None) -> list[Tensor]:
    known = [each for each in (inside, types) if each is not None]
    return [torch.cat(known, 1)] if known else []


def evened(logits: Float[Tensor, "n 16 row col"], weight: float) -> Float[Tensor, "n 16 row col"]:
    """Logits of edge types of a network that was taught with a weight on boundaries, without it.

    A weight w makes the odds of what it is on w times what they should be.
    """
    is_boundary = torch.arange(EDGE_TYPE_COUNT, device=logits.device) > 0
    each = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT))
    return (each - math.log(weight) * is_boundary[:, None, None]).flatten(1, 2)


def likeliest_types(logits: Float[Tensor, "n 16 row col"]) -> Float[Tensor, "n 16 row col"]:
    """The likeliest type of every grid edge, one-hot."""
    chosen = logits.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT)).argmax(2, keepdim=True)
    kinds = torch.arange(EDGE_TYPE_COUNT, device=logits.device)[:, None, None]
    return (chosen == kinds).float().flatten(1, 2)


def sure_maps(truth: Rasters) -> Float[Tensor, "n 34 row col"]:
    """Maps of true garments, flags and edge types as logits that leave no doubt."""
    maps = truth.inputs()
    logits = (2 * maps[:, : FLAGS + TYPES] - 1) * SURE
    return torch.cat([logits, maps[:, FLAGS + TYPES :]], 1)


def flipped(flags: Float[Tensor, "n 2 row col"], share: float) -> Float[Tensor, "n 2 row col"]:
    """Flags of which a share of those beside the outline are wrong."""
    near = functional.max_pool2d(flags, 3, 1, 1) != -functional.max_pool2d(-flags, 3, 1, 1)
    wrong = near & (torch.rand_like(flags) < share)
    return torch.where(wrong, 1 - flags, flags)


def redrawn(types: Float[Tensor, "n 16 row col"], share: float) -> Float[Tensor, "n 16 row col"]:
    """Edge types of which a share of the boundaries are another type."""
    found = types.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT))
    wrong = (found[:, :, :1] < 0.5) & (torch.rand_like(found[:, :, :1]) < share)
    other = torch.randint(0, EDGE_TYPE_COUNT, wrong.shape, device=types.device)
    kinds = torch.arange(EDGE_TYPE_COUNT, device=types.device)[:, None, None]
    return torch.where(wrong, (other == kinds).to(found), found).flatten(1, 2)
