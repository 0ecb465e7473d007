"""Pictures with their latent vectors, and pictures with wordings: what editing by text learns."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor

from garmentimage.dataset import parse_patterns, random_prompt, read_tables
from garmentimage.errors import LearnError
from garmentimage.learn.data.images import PICTURE, Album, pixels
from garmentimage.learn.data.pattern_vectors import Vocabulary, read_vocabulary, vectors
from garmentimage.learn.data.text_encoder import embedded
from garmentimage.learn.models import GarmentVAE, VectorVAE
from garmentimage.learn.weights import load_weights
from garmentimage.system import shown_path

Encode = Callable[[Album], tuple[Tensor, Tensor]]
"""An album's latent vectors, and the encoder's standard deviations."""
WORDINGS = 8
"""Of each garment."""
SEED = 41


@dataclass  # not frozen: Fabric casts its fields where precision is mixed
class Worn:
    """Pictures of garments, and their latent vectors."""

    latents: Float[Tensor, "n latent"]
    spread: Float[Tensor, "n latent"]
    """Standard deviation of the encoder."""
    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """The lowest row first."""

    def __len__(self) -> int:
        return len(self.pictures)

    def batch(self, numbers: Tensor) -> "Worn":
        """Some of them."""
        return Worn(self.latents[numbers], self.spread[numbers], self.pictures[numbers])

    def to(self, device: torch.device) -> "Worn":
        """The same on another device."""
        return Worn(self.latents.to(device), self.spread.to(device), self.pictures.to(device))

    def seen(self) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """Colours from 0 to 1."""
        return self.pictures.float() / 255


def worn(album: Album, encode: Encode) -> Worn:
    """The garments of an album in a latent space."""
    latents, spread = encode(album)
    return Worn(latents, spread, album.garments.pictures)


def latents_of(vae: Path) -> Encode:
    """How a trained VAE, of GarmentImages or of vectors, encodes garments.

    Args:
        vae: folder of the network.

    Raises:
        LearnError: the folder holds neither.
    """
    try:
        is_vectors = "vertices" in json.loads((vae / "config.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise LearnError(f"{shown_path(vae)}: holds no VAE ({type(error).__name__})") from None
    if is_vectors:
        return _of_vectors(load_weights(VectorVAE, vae), read_vocabulary(vae))
    return _of_rasters(load_weights(GarmentVAE, vae))


def _of_rasters(model: GarmentVAE) -> Encode:
    @torch.no_grad()
    def encode(album: Album) -> tuple[Tensor, Tensor]:
        rasters = album.garments.rasters
        parts = torch.arange(len(rasters)).split(256)
        return _joined([model.encode(rasters.batch(part).inputs()) for part in parts])

    return encode


def _of_vectors(model: VectorVAE, words: Vocabulary) -> Encode:
    @torch.no_grad()
    def encode(album: Album) -> tuple[Tensor, Tensor]:
        found = vectors(parse_patterns(album.patterns, "the dataset"), words)
        parts = torch.arange(len(found)).split(256)
        return _joined([model.encode(found.batch(part)) for part in parts])

    return encode


def _joined(parts: list[tuple[Tensor, Tensor]]) -> tuple[Tensor, Tensor]:
    """Means and standard deviations, from means and log variances."""
    means, logs = (torch.cat(each) for each in zip(*parts))
    return means, (0.5 * logs).exp()


@dataclass  # not frozen either
class Captioned:
    """Pictures, and numbers of what may be said of them."""

    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """The lowest row first."""
    wordings: Int[Tensor, "n wording"]
    meanings: Float[Tensor, "meaning text"]
    """Sentence vectors of all wordings."""

    def __len__(self) -> int:
        return len(self.pictures)

    def batch(self, numbers: Tensor) -> "Captioned":
        """Some of them, each with one of its wordings."""
        chosen = torch.randint(self.wordings.shape[1], (len(numbers),))
        said = self.wordings[numbers, chosen]
        return Captioned(self.pictures[numbers], said[:, None], self.meanings[said])

    def to(self, device: torch.device) -> "Captioned":
        """The same on another device."""
        return Captioned(
            self.pictures.to(device), self.wordings.to(device), self.meanings.to(device)
        )

    def seen(self) -> Float[Tensor, "n 3 pixel_row pixel_col"]:
        """Colours from 0 to 1."""
        return self.pictures.float() / 255


def read_captioned(folder: Path, split: str) -> Captioned:
    """All pictures of a split, with wordings drawn from the parameters of their garments.

    Raises:
        DatasetError: there is no such split, or it has no pictures from the front.
        LearnError: the sentence encoder is not installed.
    """
    pictures: list[np.ndarray] = []
    said: list[list[str]] = []
    for table in read_tables(folder, split, ["kind", "parameters", PICTURE]):
        pictures += [pixels(each["bytes"]) for each in table[PICTURE].to_pylist()]
        for kind, text in zip(table["kind"].to_pylist(), table["parameters"].to_pylist()):
            random = np.random.default_rng([SEED, len(said)])
            given = json.loads(text)
            said.append([random_prompt(kind, given, random) for _ in range(WORDINGS)])
    every = sorted({wording for wordings in said for wording in wordings})
    numbers = {wording: k for k, wording in enumerate(every)}
    return Captioned(
        torch.from_numpy(np.stack(pictures)),
        torch.tensor([[numbers[wording] for wording in wordings] for wordings in said]),
        torch.from_numpy(embedded(every)),
    )
