"""A variational autoencoder of vectors: the paper's baseline, a transformer after Motionformer.

Two learnt tokens beside those of the panels become mean and log variance (Petrovich et al. 2021);
the decoder asks the latent vector with one learnt query a panel. It tells no stitches.
"""

from dataclasses import dataclass

import torch
from huggingface_hub import PyTorchModelHubMixin
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.data import NUMBERS, Vectors


@dataclass(frozen=True)
class VectorVAEConfig:
    """Size of the network, and weights of its losses."""

    panels: int
    vertices: int
    latent: int = 32
    width: int = 128
    heads: int = 4
    layers: int = 4
    beta: float = 2e-4
    """Weight of the divergence from the prior, of a whole garment [nats]."""
    number_weight: float = 10.0
    """Of coordinates, against whether vertices are there."""


class VectorVAE(nn.Module, PyTorchModelHubMixin, library_name="garmentimage", license="mit"):
    """Vectors to latent vectors and back."""

    def __init__(self, config: VectorVAEConfig) -> None:
        super().__init__()
        self.config = config
        width, values = config.width, config.vertices * (NUMBERS + 1)
        self.embed = nn.Linear(values, width)
        self.kinds = nn.Parameter(torch.randn(config.panels, width) * 0.1)
        self.asked = nn.Parameter(torch.randn(2, width) * 0.1)
        self.encoder = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(
                width, config.heads, 4 * width, 0.0, "gelu", batch_first=True, norm_first=True
            ),
            config.layers,
            enable_nested_tensor=False,
        )
        self.to_mean, self.to_log_variance = (nn.Linear(width, config.latent) for _ in range(2))
        self.from_latent = nn.Linear(config.latent, width)
        self.queries = nn.Parameter(torch.randn(config.panels, width) * 0.1)
        self.decoder = nn.TransformerDecoder(
            nn.TransformerDecoderLayer(
                width, config.heads, 4 * width, 0.0, "gelu", batch_first=True, norm_first=True
            ),
            config.layers,
        )
        self.out = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, values))

    def encode(self, batch: Vectors) -> tuple[Tensor, Tensor]:
        """Mean and log variance of the latent vectors, each [n, latent]."""
        flags = batch.there[..., None].float()
        values = torch.cat([batch.numbers, flags], 3).flatten(2)
        tokens = self.embed(values) + self.kinds
        asked = self.asked.expand(len(tokens), -1, -1)
        made = self.encoder(torch.cat([asked, tokens], 1))
        return self.to_mean(made[:, 0]), self.to_log_variance(made[:, 1]).clamp(-12, 4)

    def decode(
        self, z: Float[Tensor, "n latent"]
    ) -> tuple[Float[Tensor, "n panel vertex 4"], Float[Tensor, "n panel vertex"]]:
        """Numbers, and logits of whether each vertex is there."""
        memory = self.from_latent(z)[:, None]
        queries = self.queries.expand(len(z), -1, -1) + memory
        values = self.out(self.decoder(queries, memory))
        values = values.unflatten(2, (self.config.vertices, NUMBERS + 1))
        return values[..., :NUMBERS], values[..., NUMBERS]

    def forward(self, batch: Vectors) -> dict[str, Tensor]:
        """The whole loss, and what it is made of, of a batch with noise on its latent vectors."""
        mean, log_variance = self.encode(batch)
        z = mean + torch.randn_like(mean) * (log_variance / 2).exp()
        numbers, there = self.decode(z)
        known = batch.there[..., None].float()
        apart = functional.smooth_l1_loss(
            numbers * known, batch.numbers * known, beta=0.01, reduction="sum"
        )
        parts = {
            "numbers": apart / known.sum() / NUMBERS,
            "there": functional.binary_cross_entropy_with_logits(there, batch.there.float()),
            "divergence": 0.5 * (mean**2 + log_variance.exp() - 1 - log_variance).sum(1).mean(),
        }
        parts["loss"] = (
            self.config.number_weight * parts["numbers"]
            + parts["there"]
            + self.config.beta * parts["divergence"]
        )
        return parts
