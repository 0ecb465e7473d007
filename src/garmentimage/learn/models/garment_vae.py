"""A variational autoencoder of GarmentImages (paper, Section 4.1).

The encoder is one linear map. It learns less by heart than convolutions do, and a difference of two
latent vectors is one of two images, whatever garment it is added to. The decoder is plain
convolutions: the latent vector steers every block by the scale and the shift of its channels, and
each level starts from learnt maps of its places: what a garment is acts on the whole grid, and a
place of the grid is one on the body.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.errors import LearnError, quoted
from garmentimage.learn.data import INPUTS, LAYERS, VECTOR_CM, Rasters, rest_vectors
from garmentimage.raster import CHANNEL_CONTRACT, EDGE_TYPE_COUNT, join_channels, split_channels

FLAGS, TYPES = LAYERS, 2 * LAYERS * EDGE_TYPE_COUNT
"""Channels of a network's images: flags, then edge types, then vectors."""


@dataclass(frozen=True)
class GarmentVAEConfig:
    """Size of the network, and weights of its losses."""

    channels_contract: str = CHANNEL_CONTRACT
    grid: int = 16
    latent: int = 32
    channels: tuple[int, ...] = (64, 128, 128)
    """Of each level, from the grid's own to that of 4 x 4 cells at N = 16."""
    blocks: int = 1
    """Of each level."""
    beta: float = 4e-4
    """Weight of the divergence from the prior, of a whole garment [nats]."""
    boundary_weight: float = 3.0
    """Of an edge type that is not NON_BOUNDARY, against one that is."""
    vector_weight: float = 2.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "channels", tuple(self.channels))  # JSON has lists
        check_channels(self.channels_contract)


def check_channels(contract: str) -> None:
    """Refuse a network that was made for other channels than this version has.

    Raises:
        LearnError: says so.
    """
    if contract != CHANNEL_CONTRACT:
        raise LearnError(
            f"the network was made for channels {quoted(contract)}, and this version has "
            f"{CHANNEL_CONTRACT!r}"
        )


LEVELS: Mapping[int, tuple[int, ...]] = {16: (64, 128, 128), 32: (32, 64, 128, 128)}
"""Channels of each level by grid size: down to 4 x 4 cells."""


def default_config(grid: int, **changes: float) -> GarmentVAEConfig:
    """A network for images of this size.

    Raises:
        LearnError: there is none for it.
    """
    if grid not in LEVELS:
        sizes = " or ".join(map(str, LEVELS))
        raise LearnError(f"images of {grid} x {grid} cells; networks are for N = {sizes}")
    return GarmentVAEConfig(grid=grid, channels=LEVELS[grid], **changes)  # type: ignore[arg-type]


class GarmentVAE(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Images to latent vectors and back."""

    def __init__(self, config: GarmentVAEConfig) -> None:
        super().__init__()
        self.config = config
        widths, low = config.channels, config.grid >> (len(config.channels) - 1)
        self.to_latent = nn.Linear(INPUTS * config.grid**2, config.latent)
        self.log_variance = nn.Parameter(torch.zeros(config.latent))
        self.places = nn.ParameterList(
            nn.Parameter(0.1 * torch.randn(width, config.grid >> level, config.grid >> level))
            for level, width in enumerate(widths)
        )
        self.decoder = nn.ModuleList()
        self.up = nn.ModuleList()
        self.from_latent = nn.Linear(config.latent, widths[-1] * low * low)
        for level in range(len(widths) - 1, -1, -1):
            self.decoder.extend(Block(widths[level], config.latent) for _ in range(config.blocks))
            if level:
                self.up.append(nn.Conv2d(widths[level], widths[level - 1], 1))
        self.decode_out = nn.Conv2d(widths[0], INPUTS, 3, padding=1)

    def encode(self, inputs: Float[Tensor, "n 34 row col"]) -> tuple[Tensor, Tensor]:
        """Mean and log variance of the latent vectors, each [n, latent]; the variance is fixed."""
        mean = self.to_latent(inputs.flatten(1))
        return mean, self.log_variance.clamp(-12, 4).expand_as(mean)

    def decode(self, z: Float[Tensor, "n latent"]) -> Float[Tensor, "n 34 row col"]:
        """Logits of flags and types, and vectors, in the order of `Rasters.inputs`."""
        top = len(self.places) - 1
        x = self.from_latent(z).unflatten(1, tuple(self.places[top].shape))
        for step in range(top + 1):
            x = x + self.places[top - step]
            for number in range(step * self.config.blocks, (step + 1) * self.config.blocks):
                x = self.decoder[number](x, z)
            if step < top:
                x = functional.interpolate(self.up[step](x), scale_factor=2)
        return self.decode_out(x)

    def forward(self, batch: Rasters) -> dict[str, Tensor]:
        """The whole loss, and what it is made of, of a batch with noise on its latent vectors."""
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


class Block(nn.Module):
    """Two convolutions beside a shortcut, with a latent vector's scale and shift between."""

    def __init__(self, width: int, latent: int) -> None:
        super().__init__()
        self.norm1, self.norm2 = nn.GroupNorm(8, width), nn.GroupNorm(8, width)
        self.conv1 = nn.Conv2d(width, width, 3, padding=1)
        self.conv2 = nn.Conv2d(width, width, 3, padding=1)
        self.steer = nn.Linear(latent, 2 * width)
        nn.init.zeros_(self.conv2.weight)

    def forward(self, x: Tensor, z: Tensor) -> Tensor:
        """The same shape as `x`."""
        y = self.norm2(self.conv1(functional.silu(self.norm1(x))))
        scale, shift = self.steer(z)[:, :, None, None].chunk(2, 1)
        y = y * (1 + scale) + shift
        return x + self.conv2(functional.silu(y))


def image_losses(
    outputs: Float[Tensor, "n 34 row col"], truth: Rasters, boundary_weight: float
) -> dict[str, Tensor]:
    """What each channel is judged by: flags and types by cross-entropy, vectors where inside.

    Returns:
        `flags` [nats a cell], `types` [nats a grid edge], `vectors` [mean of |difference|, in
        `VECTOR_CM`, smooth below 1 mm].
    """
    flags, types, vectors = outputs.split([FLAGS, TYPES, INPUTS - FLAGS - TYPES], 1)
    inside = truth.inside.float()
    edge_types = truth.types.long()
    weight = torch.where(edge_types > 0, boundary_weight, 1.0)
    logits = types.unflatten(1, (2 * LAYERS, EDGE_TYPE_COUNT)).transpose(1, 2)
    cross = functional.cross_entropy(logits, edge_types, reduction="none")
    known = inside.repeat_interleave(8, 1)
    apart = functional.smooth_l1_loss(
        vectors * known, truth.vectors.float(), beta=0.1 / VECTOR_CM, reduction="sum"
    )
    return {
        "flags": functional.binary_cross_entropy_with_logits(flags, inside),
        "types": (weight * cross).mean(),
        "vectors": apart / known.sum(),
    }


def from_channels(channels: Float[Tensor, "n 34 row col"]) -> Float[Tensor, "n 34 row col"]:
    """Channels, as `GarmentImage.to_channels` gives them, in the order of `Rasters.inputs`."""
    inside, types, edges = split_channels(channels)
    rest = torch.from_numpy(rest_vectors(channels.shape[-1])).to(channels).unflatten(0, (4, 2))
    vectors = (edges - rest) / VECTOR_CM * inside[:, :, None, None]
    return torch.cat([inside, types.flatten(1, 3), vectors.flatten(1, 3)], 1)


def to_channels(outputs: Float[Tensor, "n 34 row col"]) -> Float[Tensor, "n 34 row col"]:
    """A network's images as channels that `decode` reads: probabilities, and vectors in cm."""
    grid = outputs.shape[-1]
    flags, types, vectors = outputs.split([FLAGS, TYPES, INPUTS - FLAGS - TYPES], 1)
    shares = types.unflatten(1, (LAYERS, 2, EDGE_TYPE_COUNT)).softmax(3)
    rest = torch.from_numpy(rest_vectors(grid)).to(outputs).unflatten(0, (4, 2))
    edges = vectors.unflatten(1, (LAYERS, 4, 2)) * VECTOR_CM + rest
    return join_channels(flags.sigmoid(), shares, edges)
