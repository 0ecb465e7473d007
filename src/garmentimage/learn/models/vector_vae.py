"""A variational autoencoder of vectors: the baseline of the paper's Section 4.1, a transformer
after Motionformer.

As in ACTOR (Petrovich et al. 2021), two learnt tokens beside those of the panels become mean and
log variance; in the decoder, a learnt query for each panel attends to the latent vector. Stitches
are not encoded.

Formulation (beta-VAE, Higgins et al. 2017): smooth L1 of the numbers of present vertices, binary
cross-entropy of their presence, and beta times the Kullback-Leibler divergence from N(0, 1).
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from garmentimage.learn.blocks import transformer_options
from garmentimage.learn.data import VERTEX_SIZE, PatternVectors
from garmentimage.learn.weights import Network, NetworkConfig


@dataclass(frozen=True)
class VectorVAEConfig(NetworkConfig):
    """Size of the network, and weights of its losses."""

    panels: int
    """Panel kinds of the vocabulary."""
    vertices: int
    """Most vertices of a panel."""
    latent: int = 32
    """Length of a latent vector."""
    width: int = 128
    """Of the transformer's tokens."""
    heads: int = 4
    """Of its attention."""
    layers: int = 4
    """Of the encoder and of the decoder."""
    beta: float = 2e-4
    """Weight of the divergence from the prior of a garment [nats]."""
    number_weight: float = 10.0
    """Weight of the loss of vertices, relative to that of their presence."""


class VectorVAE(Network):
    """Vectors of patterns to latent vectors and back."""

    def __init__(self, config: VectorVAEConfig) -> None:
        super().__init__()
        self.config = config
        width, values = config.width, config.vertices * (VERTEX_SIZE + 1)
        layer = transformer_options(width, config.heads)
        self.embed = nn.Linear(values, width)
        self.panel_embedding = nn.Parameter(torch.randn(config.panels, width) * 0.1)
        self.distribution_tokens = nn.Parameter(torch.randn(2, width) * 0.1)
        self.encoder = nn.TransformerEncoder(
            nn.TransformerEncoderLayer(**layer), config.layers, enable_nested_tensor=False
        )
        self.to_mean, self.to_log_variance = (nn.Linear(width, config.latent) for _ in range(2))
        self.from_latent = nn.Linear(config.latent, width)
        self.queries = nn.Parameter(torch.randn(config.panels, width) * 0.1)
        self.decoder = nn.TransformerDecoder(nn.TransformerDecoderLayer(**layer), config.layers)
        self.head = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, values))

    def encode(self, batch: PatternVectors) -> tuple[Tensor, Tensor]:
        """Mean and log variance of the posterior, each [n, latent]."""
        flags = batch.is_present[..., None].float()
        values = torch.cat([batch.numbers, flags], 3).flatten(2)
        tokens = self.embed(values) + self.panel_embedding
        distribution = self.distribution_tokens.expand(len(tokens), -1, -1)
        outputs = self.encoder(torch.cat([distribution, tokens], 1))
        return self.to_mean(outputs[:, 0]), self.to_log_variance(outputs[:, 1]).clamp(-12, 4)

    def decode(
        self, z: Float[Tensor, "n latent"]
    ) -> tuple[Float[Tensor, "n panel vertex 4"], Float[Tensor, "n panel vertex"]]:
        """Numbers of vertices, and logits of their presence."""
        memory = self.from_latent(z)[:, None]
        queries = self.queries.expand(len(z), -1, -1) + memory
        values = self.head(self.decoder(queries, memory))
        values = values.unflatten(2, (self.config.vertices, VERTEX_SIZE + 1))
        return values[..., :VERTEX_SIZE], values[..., VERTEX_SIZE]

    def forward(self, batch: PatternVectors) -> dict[str, Tensor]:
        """Losses of a batch, decoded from latent vectors sampled from its posterior."""
        mean, log_variance = self.encode(batch)
        z = mean + torch.randn_like(mean) * (log_variance / 2).exp()
        numbers, presence = self.decode(z)
        mask = batch.is_present[..., None].float()
        differences = functional.smooth_l1_loss(
            numbers * mask, batch.numbers * mask, beta=0.01, reduction="sum"
        )
        parts = {
            "numbers": differences / mask.sum() / VERTEX_SIZE,
            "presence": functional.binary_cross_entropy_with_logits(
                presence, batch.is_present.float()
            ),
            "divergence": 0.5 * (mean**2 + log_variance.exp() - 1 - log_variance).sum(1).mean(),
        }
        parts["loss"] = (
            self.config.number_weight * parts["numbers"]
            + parts["presence"]
            + self.config.beta * parts["divergence"]
        )
        return parts
