"""Codecs: networks from garments to latent vectors and back, under one protocol."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from garmentimage.compare import pattern_faults
from garmentimage.errors import DecodeError
from garmentimage.latent import LatentSpace
from garmentimage.networks import DecodedGarment, Latent, decoded_garment
from garmentimage.pattern import Pattern
from garmentimage.raster import join_channels, split_channels
from garmentimage.raster.encode import encode
from garmentimage.raster.repair import RepairLevel


class Codec(ABC):
    """Garments to latent vectors and back."""

    @abstractmethod
    def latents(self, patterns: Sequence[Pattern]) -> Float32[np.ndarray, "n latent"]:
        """Latent vectors of some garments."""

    def symmetrised_for(self, pattern: Pattern) -> "Codec":  # noqa: ARG002 - of those that use it
        """The codec for edits of a garment: itself if it has no notion of symmetry."""
        return self

    def reproject(self, z: Latent, times: int) -> Latent:  # noqa: ARG002 - of those that use it
        """A latent vector decoded and encoded again so many times: itself without a network."""
        return z

    @abstractmethod
    def decode(self, z: Latent) -> DecodedGarment:
        """The garment of any latent vector."""


@dataclass(frozen=True)
class RasterCodec(Codec):
    """The GarmentImage VAE, at one level of repair."""

    space: LatentSpace
    level: RepairLevel = "full"

    def latents(self, patterns: Sequence[Pattern]) -> Float32[np.ndarray, "n latent"]:
        """Latent vectors of some garments."""
        images = [self.space.channels(self.space.image(pattern)) for pattern in patterns]
        return self.space.encode_channels(np.stack(images))

    def symmetrised_for(self, pattern: Pattern) -> "RasterCodec":
        """A codec that keeps a symmetric garment symmetric."""
        return replace(self, space=self.space.symmetrised_for(self.space.image(pattern)))

    def reproject(self, z: Latent, times: int) -> Latent:
        """A latent vector decoded and encoded again so many times."""
        return self.space.reproject(z, times)

    def decode(self, z: Latent) -> DecodedGarment:
        """The garment of a latent vector."""
        return self.space.decode(z, repair_level=self.level)


@dataclass(frozen=True)
class PlainCodec(Codec):
    """GarmentImages without a network: the vector of a garment is its channels."""

    grid: int

    def latents(self, patterns: Sequence[Pattern]) -> Float32[np.ndarray, "n latent"]:
        """All channels of some garments."""
        return np.stack([encode(each, self.grid).to_channels(2).ravel() for each in patterns])

    def decode(self, z: Latent) -> DecodedGarment:
        """The garment of a linear combination of channels.

        Flags and edge types are shares; if several garments have cloth in a cell, its edge vectors
        are their mean.
        """
        flags, types, vectors, turned = split_channels(z.reshape(-1, self.grid, self.grid))
        vectors = vectors / np.maximum(flags, 0.5)[:, None, None]
        shares = types.clip(0)
        shares = shares / shares.sum(axis=2, keepdims=True)
        assert turned is not None  # of contract 2
        joined = join_channels(flags.clip(0, 1), shares, vectors, turned.clip(0, 1))
        return decoded_garment(z, joined, "full")


class VectorCodec(Codec):
    """The vector VAE; stitches and placement are those of the nearest topology in training.

    Args:
        folder: the network.
    """

    def __init__(self, folder: Path) -> None:
        import torch

        from garmentimage.learn import load_weights
        from garmentimage.learn.data import read_vocabulary
        from garmentimage.learn.models import VectorVAE

        torch.set_num_threads(1)
        self.words = read_vocabulary(folder)
        self.model = load_weights(VectorVAE, folder)

    def latents(self, patterns: Sequence[Pattern]) -> Float32[np.ndarray, "n latent"]:
        """Latent vectors of some garments."""
        import torch

        from garmentimage.learn.data import to_vectors

        with torch.no_grad():
            return self.model.encode(to_vectors(patterns, self.words))[0].numpy()

    def reproject(self, z: Latent, times: int) -> Latent:
        """A latent vector decoded and encoded again so many times."""
        import torch

        from garmentimage.learn.data import PatternVectors

        at = torch.from_numpy(np.asarray(z, np.float32))[None]
        with torch.no_grad():
            for _ in range(times):
                numbers, logits = self.model.decode(at)
                there = logits > 0
                at = self.model.encode(PatternVectors(numbers * there[..., None], there))[0]
        return at[0].numpy()

    def decode(self, z: Latent) -> DecodedGarment:
        """The garment of a latent vector."""
        import torch

        with torch.no_grad():
            numbers, there = self.model.decode(torch.from_numpy(np.asarray(z, np.float32))[None])
        try:
            pattern = self.words.pattern(numbers[0].numpy(), there[0].numpy() > 0)
        except DecodeError as error:
            return DecodedGarment(z, None, None, None, (str(error),))
        return DecodedGarment(z, None, None, pattern, tuple(pattern_faults(pattern)))
