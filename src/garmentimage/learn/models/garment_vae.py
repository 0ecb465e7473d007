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

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError, quoted
from garmentimage.learn.blocks import FiLMBlock
from garmentimage.learn.data import INPUT_CHANNELS, LAYERS, VECTOR_CM, Rasters, rest_vectors
from garmentimage.learn.weights import NetworkConfig
from garmentimage.raster import CHANNEL_CONTRACT, EDGE_TYPE_COUNT, join_channels, split_channels

FLAGS, TYPES = LAYERS, 2 * LAYERS * EDGE_TYPE_COUNT
"""Channels of flags and of edge types in a network's images: flags, edge types, then vectors."""


@dataclass(frozen=True)
class GarmentVAEConfig(NetworkConfig):
    """Size of the network, and weights of its losses."""

    channels_contract: str = CHANNEL_CONTRACT
    """Channel layout that the network was made for."""
    grid: int = 16
    """Cells a side, N."""
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

    def __post_init__(self) -> None:
        super().__post_init__()
        check_channels(self.channels_contract)


def check_channels(contract: str) -> None:
    """Refuse a network that was made for another channel layout than this version's.

    Raises:
        LearnError: it was.
    """
    if contract != CHANNEL_CONTRACT:
        raise LearnError(
            f"the network was made for channels {quoted(contract)}, and this version has "
            f"{CHANNEL_CONTRACT!r}"
        )


LEVELS: Mapping[int, tuple[int, ...]] = {16: (64, 128, 128), 32: (32, 64, 128, 128)}
"""Channels of each level by grid size, down to 4 x 4 cells."""


def vae_config(grid: int, **changes: float) -> GarmentVAEConfig:
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
    return GarmentVAEConfig(grid=grid, channels=LEVELS[grid], **changes)  # type: ignore[arg-type]


class GarmentVAE(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """GarmentImages to latent vectors and back."""

    def __init__(self, config: GarmentVAEConfig) -> None:
        super().__init__()
        self.config = config
        widths, low = config.channels, config.grid >> (len(config.channels) - 1)
        self.to_latent = nn.Linear(INPUT_CHANNELS * config.grid**2, config.latent)
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
        self.head = nn.Conv2d(widths[0], INPUT_CHANNELS, 3, padding=1)

    def encode(self, inputs: Float[Tensor, "n 34 row col"]) -> tuple[Tensor, Tensor]:
        """Mean and log variance of the posterior, each [n, latent]; one variance for all."""
        mean = self.to_latent(inputs.flatten(1))
        return mean, self.log_variance.clamp(-12, 4).expand_as(mean)

    def decode(self, z: Float[Tensor, "n latent"]) -> Float[Tensor, "n 34 row col"]:
        """Logits of flags and types, and vectors, in the order of `Rasters.inputs`."""
        top = len(self.positions) - 1
        x = self.from_latent(z).unflatten(1, tuple(self.positions[top].shape))
        for step in range(top + 1):
            x = x + self.positions[top - step]
            for number in range(step * self.config.blocks, (step + 1) * self.config.blocks):
                x = self.decoder[number](x, z)
            if step < top:
                x = functional.interpolate(self.project[step](x), scale_factor=2)
        return self.head(x)

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
    outputs: Float[Tensor, "n 34 row col"], truth: Rasters, boundary_weight: float
) -> dict[str, Tensor]:
    """Reconstruction losses: cross-entropy of flags and edge types, smooth L1 of vectors inside.

    Returns:
        `flags` [nats per cell], `types` [nats per grid edge, boundaries times `boundary_weight`],
        and `vectors` [mean |difference| in `VECTOR_CM`, quadratic below 1 mm].
    """
    flags, types, vectors = outputs.split([FLAGS, TYPES, INPUT_CHANNELS - FLAGS - TYPES], 1)
    inside = truth.inside.float()
    edge_types = truth.types.long()
    weight = torch.where(edge_types > 0, boundary_weight, 1.0)
    logits = types.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT)).transpose(1, 2)
    cross_entropy = functional.cross_entropy(logits, edge_types, reduction="none")
    is_cloth = inside.repeat_interleave(8, 1)
    differences = functional.smooth_l1_loss(
        vectors * is_cloth, truth.vectors.float(), beta=0.1 / VECTOR_CM, reduction="sum"
    )
    return {
        "flags": functional.binary_cross_entropy_with_logits(flags, inside),
        "types": (weight * cross_entropy).mean(),
        "vectors": differences / is_cloth.sum(),
    }


def from_channels(channels: Float[Tensor, "n 34 row col"]) -> Float[Tensor, "n 34 row col"]:
    """Channels in the order of `GarmentImage.to_channels`, in the order of `Rasters.inputs`."""
    inside, types, edges = split_channels(channels)
    rest = torch.from_numpy(rest_vectors(channels.shape[-1])).to(channels).unflatten(0, (4, 2))
    vectors = (edges - rest) / VECTOR_CM * inside[:, :, None, None]
    return torch.cat([inside, types.flatten(1, 3), vectors.flatten(1, 3)], 1)


def to_channels(outputs: Float[Tensor, "n 34 row col"]) -> Float[Tensor, "n 34 row col"]:
    """Output of a network as channels for `decode`: probabilities, and vectors in cm."""
    grid = outputs.shape[-1]
    flags, types, vectors = outputs.split([FLAGS, TYPES, INPUT_CHANNELS - FLAGS - TYPES], 1)
    probabilities = types.unflatten(1, (LAYERS, 2, EDGE_TYPE_COUNT)).softmax(3)
    rest = torch.from_numpy(rest_vectors(grid)).to(outputs).unflatten(0, (4, 2))
    edges = vectors.unflatten(1, (LAYERS, 4, 2)) * VECTOR_CM + rest
    return join_channels(flags.sigmoid(), probabilities, edges)
