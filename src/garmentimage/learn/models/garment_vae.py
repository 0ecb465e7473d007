"""A variational autoencoder of GarmentImages (paper, Section 4.1).

The encoder is one linear map: it overfits less than convolutions, and a difference of two latent
vectors is the difference of two images, whatever garment it is added to. The decoder is
convolutional: the latent vector scales and shifts the channels of every block (FiLM), and each
level adds learnt position maps, since a cell of the grid is a place on the body.

Formulation (beta-VAE, Higgins et al. 2017): with posterior N(mean(x), sigma^2), sigma learnt but
the same for all x, the loss is the reconstruction error of a sampled latent vector (`image_losses`)
plus beta times the Kullback-Leibler divergence from N(0, 1).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.learn.blocks import FiLMBlock
from garmentimage.learn.data import VECTOR_CM, Rasters, rest_vectors
from garmentimage.learn.weights import ImageNetworkConfig, Network
from garmentimage.networks import channel_layout
from garmentimage.raster import (
    PLAIN_LAYOUT,
    ChannelLayout,
    join_channels,
    layout_of,
    split_channels,
)

FLAGS, TYPES, VECTORS = PLAIN_LAYOUT.flags, PLAIN_LAYOUT.types, PLAIN_LAYOUT.vectors
MAPS = [FLAGS, TYPES, VECTORS]
"""Channels of flags, edge types and edge vectors, in this order in the images of a network of
contract 1."""
LEVELS: Mapping[int, tuple[int, ...]] = {16: (64, 128, 128), 32: (32, 64, 128, 128)}
"""Channels of each level by grid size, down to 4 x 4 cells."""


@dataclass(frozen=True)
class GarmentVAEConfig(ImageNetworkConfig):
    """Size of the network, and weights of its losses."""

    latent: int = 32
    """Length of a latent vector."""
    channels: Sequence[int] = (64, 128, 128)
    """Of each level, from the grid's own resolution to 4 x 4 cells at N = 16."""
    blocks: int = 1
    """Blocks of each level."""
    beta: float = 4e-4
    """Weight of the divergence from the prior of a garment [nats]."""
    boundary_weight: float = 3.0
    """Weight of the cross-entropy at boundaries, relative to grid edges inside (NON_BOUNDARY)."""
    vector_weight: float = 2.0
    """Weight of the loss of edge vectors."""
    layers: int = PLAIN_LAYOUT.layers
    """Of its images; garments with fewer have empty ones. Contract 1 has two."""

    @property
    def layout(self) -> ChannelLayout:
        """Contract and layers of its images."""
        return channel_layout(self.channels_contract, self.layers)

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self.layout  # raises where contract and layers do not fit

    def check_channels(self) -> None:
        """Both contracts are known, see `layout`."""


def vae_config(grid: int, **changes: Any) -> GarmentVAEConfig:
    """The configuration of a network for images of this size.

    Args:
        grid: cells a side.
        changes: of other fields.

    Raises:
        LearnError: there is no network for this size.
    """
    if grid not in LEVELS:
        sizes = " or ".join(map(str, LEVELS))
        raise LearnError(f"images of {grid} x {grid} cells; networks are for N = {sizes}")
    return GarmentVAEConfig(grid=grid, channels=LEVELS[grid], **changes)


class GarmentVAE(Network):
    """GarmentImages to latent vectors and back."""

    def __init__(self, config: GarmentVAEConfig) -> None:
        super().__init__()
        self.config = config
        widths, low = config.channels, config.grid >> (len(config.channels) - 1)
        channels = config.layout.channels
        self.to_latent = nn.Linear(channels * config.grid**2, config.latent)
        self.log_variance = nn.Parameter(torch.zeros(config.latent))
        self.positions = nn.ParameterList(
            nn.Parameter(0.1 * torch.randn(width, config.grid >> level, config.grid >> level))
            for level, width in enumerate(widths)
        )
        self.decoder = nn.ModuleList()
        self.project = nn.ModuleList()
        self.from_latent = nn.Linear(config.latent, widths[-1] * low * low)
        for level in range(len(widths) - 1, -1, -1):
            self.decoder.extend(
                FiLMBlock(widths[level], config.latent) for _ in range(config.blocks)
            )
            if level:
                self.project.append(nn.Conv2d(widths[level], widths[level - 1], 1))
        self.head = nn.Conv2d(widths[0], channels, 3, padding=1)

    def encode(self, inputs: Float[Tensor, "n channel row col"]) -> tuple[Tensor, Tensor]:
        """Mean and log variance of the posterior, each [n, latent]; one variance for all."""
        mean = self.to_latent(inputs.flatten(1))
        return mean, self.log_variance.clamp(-12, 4).expand_as(mean)

    def decode(self, z: Float[Tensor, "n latent"]) -> Float[Tensor, "n channel row col"]:
        """Logits of flags and types, and vectors, in the order of `Rasters.inputs`."""
        top = len(self.positions) - 1
        x = self.from_latent(z).unflatten(1, tuple(self.positions[top].shape))
        for step in range(top + 1):
            x = x + self.positions[top - step]
            for number in range(step * self.config.blocks, (step + 1) * self.config.blocks):
                x = self.decoder[number](x, z)
            if step < top:
                x = functional.interpolate(self.project[step](x), scale_factor=2)
        outputs: Tensor = self.head(x)
        return outputs

    def forward(self, batch: Rasters) -> dict[str, Tensor]:
        """Losses of a batch, decoded from latent vectors sampled from its posterior."""
        config = self.config
        mean, log_variance = self.encode(batch.inputs())
        z = mean + torch.randn_like(mean) * (log_variance / 2).exp()
        parts = image_losses(self.decode(z), batch, config.boundary_weight)
        parts["divergence"] = 0.5 * (mean**2 + log_variance.exp() - 1 - log_variance).sum(1).mean()
        parts["loss"] = (
            parts["flags"]
            + parts["types"]
            + config.vector_weight * parts["vectors"]
            + config.beta * parts["divergence"]
        )
        return parts


def image_losses(
    outputs: Float[Tensor, "n channel row col"],
    truth: Rasters,
    boundary_weight: float,
    *,
    squared: bool = False,
) -> dict[str, Tensor]:
    """Reconstruction losses: cross-entropy of flags and edge types, smooth L1 of vectors inside.

    Flags and types count for as much as they would in two layers of contract 1, so that further
    layers, which are mostly empty, do not make an error in the others count for less.

    Args:
        outputs: logits of flags and types, and vectors, in the order of `Rasters.inputs`.
        truth: the garments.
        boundary_weight: weight of boundaries in the loss of edge types.
        squared: squared errors of flags and vectors instead.

    Returns:
        `flags` [nats per cell of front and back], `types` [nats per grid edge of front and back,
        boundaries times `boundary_weight`],
        and `vectors` [mean |difference| in `VECTOR_CM`, quadratic below 1 mm].
    """
    layout = truth.layout
    flags, types, vectors = outputs.split([layout.flags, layout.types, layout.vectors], 1)
    true_flags, edge_types = truth.flags().float(), truth.types.long()
    weight = torch.where(edge_types > 0, boundary_weight, 1.0)
    by_edge = 2 * layout.layers, layout.contract.edge_type_count
    logits = types.unflatten(1, by_edge).transpose(1, 2)
    cross_entropy = functional.cross_entropy(logits, edge_types, reduction="none")
    is_cloth = truth.inside.float().repeat_interleave(8, 1)
    vectors, true_vectors = vectors * is_cloth, truth.vectors.float()
    if squared:
        flag_loss = functional.mse_loss(flags.sigmoid(), true_flags)
        differences = ((vectors - true_vectors) ** 2).sum()
    else:
        flag_loss = functional.binary_cross_entropy_with_logits(flags, true_flags)
        differences = functional.smooth_l1_loss(
            vectors, true_vectors, beta=0.1 / VECTOR_CM, reduction="sum"
        )
    return {
        "flags": flag_loss * (layout.flags / PLAIN_LAYOUT.flags),
        "types": (weight * cross_entropy).mean() * (layout.layers / PLAIN_LAYOUT.layers),
        "vectors": differences / is_cloth.sum(),
    }


def network_inputs(
    channels: Float[Tensor, "n channel row col"],
) -> Float[Tensor, "n channel row col"]:
    """Channels in the order of `GarmentImage.to_channels`, in the order of `Rasters.inputs`."""
    inside, types, edges, turned = split_channels(channels)
    rest = torch.from_numpy(rest_vectors(channels.shape[-1])).to(channels).unflatten(0, (4, 2))
    vectors = (edges - rest) / VECTOR_CM * inside[:, :, None, None]
    flags = [inside] if turned is None else [inside, turned]
    return torch.cat([*flags, types.flatten(1, 3), vectors.flatten(1, 3)], 1)


def output_channels(
    outputs: Float[Tensor, "n channel row col"],
) -> Float[Tensor, "n channel row col"]:
    """Output of a network as channels for `decode`: probabilities, and vectors in cm."""
    layout = layout_of(outputs.shape[1])
    layers, contract = layout.layers, layout.contract
    flags, types, vectors = outputs.split([layout.flags, layout.types, layout.vectors], 1)
    probabilities: Tensor = types.unflatten(1, (layers, 2, contract.edge_type_count)).softmax(3)
    rest = torch.from_numpy(rest_vectors(outputs.shape[-1])).to(outputs).unflatten(0, (4, 2))
    edges = vectors.unflatten(1, (layers, 4, 2)) * VECTOR_CM + rest
    inside, *turned = flags.sigmoid().split(layers, 1)
    channels: Tensor = join_channels(inside, probabilities, edges, *turned)
    return channels
