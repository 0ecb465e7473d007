"""Images with latent vectors, and images with prompts: the data for editing by text."""

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor

from garmentimage.dataset import parse_patterns, random_prompt, read_tables
from garmentimage.errors import LearnError
from garmentimage.learn.data.images import PICTURE_COLUMN, ImageSplit, read_pixels
from garmentimage.learn.data.pattern_vectors import read_vocabulary, to_vectors
from garmentimage.learn.data.rows import ImageRows
from garmentimage.learn.data.text_encoder import embed_texts
from garmentimage.learn.models import GarmentVAE, VectorVAE
from garmentimage.learn.weights import load_weights
from garmentimage.networks import CONFIG_FILE
from garmentimage.raster import PLAIN_LAYOUT
from garmentimage.system import shown_path

PROMPTS_PER_GARMENT = 8
PROMPT_SEED = 41
"""Of the words that are drawn for prompts."""


@dataclass
class LatentImages(ImageRows):
    """Images of garments, and their latent vectors."""

    latents: Float[Tensor, "n latent"]
    spread: Float[Tensor, "n latent"]
    """Standard deviations of the encoder's posterior."""
    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """RGB from 0 to 255, the lowest row of pixels first."""


def split_encoder(vae: Path) -> Callable[[ImageSplit], LatentImages]:
    """The encoder of a trained VAE, of GarmentImages or of vectors.

    Args:
        vae: folder of the network.

    Raises:
        LearnError: the folder holds no VAE, or one of contract 2.
    """
    try:
        is_vectors = "vertices" in json.loads((vae / CONFIG_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise LearnError(f"{shown_path(vae)}: holds no VAE ({type(error).__name__})") from None
    if is_vectors:
        vector_vae, words = load_weights(VectorVAE, vae), read_vocabulary(vae)
        return lambda split: _latent_images(
            split,
            map(
                vector_vae.encode,
                to_vectors(parse_patterns(split.patterns, "the dataset"), words).parts(),
            ),
        )
    model = load_weights(GarmentVAE, vae)
    if model.config.layout != PLAIN_LAYOUT:
        raise LearnError(
            f"{shown_path(vae)}: is a VAE of contract 2, and latent vectors become pictures with "
            "one of contract 1; train one without --contract"
        )
    return lambda split: _latent_images(
        split, (model.encode(part.inputs()) for part in split.garments.rasters.parts())
    )


@torch.no_grad()
def _latent_images(split: ImageSplit, encoded: Iterable[tuple[Tensor, Tensor]]) -> LatentImages:
    """From batches of means and log variances, which are only computed here."""
    means, logs = (torch.cat(each) for each in zip(*encoded, strict=True))
    return LatentImages(means, (0.5 * logs).exp(), split.garments.pictures)


@dataclass
class CaptionedImages(ImageRows):
    """Images, and prompts that describe them."""

    pictures: UInt8[Tensor, "n 3 pixel_row pixel_col"]
    """RGB from 0 to 255, the lowest row of pixels first."""
    prompts: Int[Tensor, "n prompt"]
    """Rows of `text_embeddings`."""
    text_embeddings: Float[Tensor, "text embedding"]
    """Sentence embeddings of all prompts, each prompt once."""

    def batch(self, numbers: Tensor) -> "CaptionedImages":
        """The rows of these numbers, each with one of its prompts, drawn at random."""
        chosen = torch.randint(self.prompts.shape[1], (len(numbers),))
        prompts = self.prompts[numbers, chosen]
        return CaptionedImages(
            self.pictures[numbers], prompts[:, None], self.text_embeddings[prompts]
        )


def load_captioned(folder: Path, split: str) -> CaptionedImages:
    """Load the images of a split, with prompts written from the parameters of their garments.

    Raises:
        DatasetError: there is no such split, or it has no front views.
        LearnError: the sentence encoder is not installed.
    """
    pictures: list[np.ndarray] = []
    prompts: list[list[str]] = []
    for table in read_tables(folder, split, ["kind", "parameters", PICTURE_COLUMN]):
        pictures += [read_pixels(each["bytes"]) for each in table[PICTURE_COLUMN].to_pylist()]
        for row in table.select(["kind", "parameters"]).to_pylist():
            random = np.random.default_rng([PROMPT_SEED, len(prompts)])
            parameters = json.loads(row["parameters"])
            prompts.append(
                [random_prompt(row["kind"], parameters, random) for _ in range(PROMPTS_PER_GARMENT)]
            )
    distinct = sorted({prompt for each in prompts for prompt in each})
    numbers = {prompt: k for k, prompt in enumerate(distinct)}
    return CaptionedImages(
        torch.from_numpy(np.stack(pictures)),
        torch.tensor([[numbers[prompt] for prompt in each] for each in prompts]),
        torch.from_numpy(embed_texts(distinct)),
    )
