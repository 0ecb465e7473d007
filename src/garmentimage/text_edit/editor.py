"""Editing a garment by text: its latent vector is optimised until its picture matches the text."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, UInt8
from torch import Tensor

from garmentimage.errors import LearnError, quoted
from garmentimage.latent import LatentSpace, space_names
from garmentimage.learn import load_weights
from garmentimage.learn.models import ImageDecoder
from garmentimage.metrics import EditedRegion
from garmentimage.networks import (
    DecodedGarment,
    Latent,
    StripFrame,
    bundled_names,
    draped_frame,
    network_folder,
)
from garmentimage.pattern import Pattern
from garmentimage.raster import GarmentImage
from garmentimage.system import shown_path, weights_hash
from garmentimage.text_edit.attempts import MAX_ATTEMPTS, best_attempt
from garmentimage.text_edit.goal import keep_mask
from garmentimage.text_edit.guidance import Guidance, ScoreDistillation, optimise_latent
from garmentimage.text_edit.pixel_diffusion import DEFAULTS as PIXEL_DEFAULTS, PixelDiffusion
from garmentimage.text_edit.source_prompt import edit_prompts, nearest_phrase
from garmentimage.text_edit.stable_diffusion import (
    DEFAULT_MODEL,
    DEFAULTS as SD_DEFAULTS,
    StableDiffusion,
)
from garmentimage.text_edit.vocabulary import check_known

DEFAULT_SPACE = "text-edit"
DEFAULT_IMAGE_DECODER, DEFAULT_DENOISER = "text-edit-pictures", "text-edit-denoiser"
"""Bundled networks."""
MAX_TEXT_LENGTH = 500
"""Characters of a text."""
STRENGTH_LIMITS, STEP_LIMITS = (0.05, 20.0), (1, 5000)
DISTANCE_WEIGHT = 0.02
"""Weight of the squared distance from the source in latent space, at strength 1."""
KEEP_WEIGHT = 1.0
"""Weight of the squared change of a colour where the text should change nothing, at strength 1."""
LEARNING_RATE = 0.1
DEFAULT_STEPS = 60
FRAME_COUNT = 6
"""Steps of the optimisation that are kept for the strip, including both ends."""
MAX_TITLE_LENGTH = 40
"""Characters of a title in the strip."""
REPROJECTIONS = 1
"""Times that the result is decoded and encoded again, which moves it nearer to the training data.
"""


@dataclass(frozen=True)
class EditFrame:
    """The garment at one step of the optimisation."""

    number: int
    """Steps of the optimisation before it."""
    step: DecodedGarment
    picture: UInt8[np.ndarray, "row col 3"]
    """By the picture network."""


@dataclass(frozen=True)
class TextEdit:
    """A garment before and after an edit."""

    source: DecodedGarment
    frames: tuple[EditFrame, ...]
    """From the source to the end of the optimisation."""
    result: DecodedGarment
    attempts: int
    """Attempts made."""
    achieved: bool | None
    """Whether the text is true of the result, by geometry; None if geometry cannot decide."""


class TextEditor:
    """Networks that edit garments by text.

    Args:
        space: latent vectors and garments.
        pictures: network from latent vectors to pictures of worn garments.

    Raises:
        LearnError: the two were not trained together.
    """

    def __init__(self, space: LatentSpace, pictures: ImageDecoder) -> None:
        if space.latent != pictures.config.latent:
            raise LearnError(
                f"{space.folder.name} has latent vectors of {space.latent} numbers, the picture "
                f"network takes {pictures.config.latent}; name two that were trained together"
            )
        check_pair(space.folder, pictures)
        self.space, self.pictures = space, pictures.eval()

    @classmethod
    def load(
        cls, space: str | Path = DEFAULT_SPACE, pictures: str | Path = DEFAULT_IMAGE_DECODER
    ) -> "TextEditor":
        """Bundled networks by name, or others by folder.

        Raises:
            LearnError: there are no networks of those names, and no such folders.
        """
        folder = network_folder(pictures, image_decoder_names(), "picture network")
        return cls(
            LatentSpace(network_folder(space, space_names(), "latent space")),
            load_weights(ImageDecoder, folder),
        )

    def edit(
        self,
        source: Pattern | GarmentImage,
        text: str,
        guidance: Guidance,
        *,
        strength: float = 1.0,
        steps: int = DEFAULT_STEPS,
        max_attempts: int = MAX_ATTEMPTS,
        progress: Callable[[int, int], None] = lambda *_: None,
    ) -> TextEdit:
        """Edit a garment; geometry checks the result and may start another attempt.

        Args:
            source: the garment.
            text: what it should become: "long sleeves", "pants".
            guidance: how its picture should change, such as `denoiser_guidance(None, text)[0]`.
            strength: how far it may change; weights of the penalties are divided by it.
            steps: of the optimisation, in each attempt.
            max_attempts: see `best_attempt`.
            progress: called after every step with its number and the number of steps.

        Raises:
            LearnError: an invalid text, strength or number of steps or attempts, or an image of
                another grid than the network's.
            EncodeError: a pattern that does not fit the network's grid.
        """
        prompt = normalised_text(text)
        check_options(strength, steps, max_attempts)
        given = self.space.locate(source)
        assert given.image is not None  # `LatentSpace.locate` has one
        space = self.space.symmetrised_for(given.image)
        start = torch.from_numpy(given.z).float()
        target_prompt, source_prompt = edit_prompts(given.pattern, prompt)
        kept_steps = np.linspace(0, steps, min(FRAME_COUNT, steps + 1)).round().astype(int).tolist()
        latents: list[dict[int, Tensor]] = []

        def keep(step: int, z: Tensor) -> None:
            if step in kept_steps:
                latents[-1][step] = z
            progress(step, steps)

        def attempt(boost: float, region: EditedRegion | None) -> DecodedGarment:
            latents.append({0: start})

            z = run_edit(
                start,
                self.pictures,
                guidance,
                target_prompt,
                source_prompt,
                strength=strength,
                steps=steps,
                boost=boost,
                region=region,
                progress=keep,
            )
            return space.decode(space.reproject(z.numpy(), REPROJECTIONS))

        best = best_attempt(given.pattern, prompt, attempt, max_attempts)
        frames = tuple(
            EditFrame(number, space.decode(z.numpy()), self.picture(z.numpy()))
            for number, z in sorted(latents[best.number].items())
        )
        return TextEdit(given, frames, best.step, best.count, best.achieved)

    def picture(self, z: Latent) -> UInt8[np.ndarray, "row col 3"]:
        """The picture of a latent vector by the picture network, upright."""
        with torch.no_grad():
            colours = self.pictures.draw(torch.from_numpy(np.asarray(z, np.float32))[None])[0]
        upright = (colours.flip(1).permute(1, 2, 0) * 255).round().to(torch.uint8)
        return np.ascontiguousarray(upright.numpy())


def strip_columns(edit: TextEdit, text: str) -> list[StripFrame]:
    """Columns of a strip for `networks.strip`: the source, steps of the edit, the result."""
    steps = [
        StripFrame(f"step {each.number}", each.step, None, each.step.faults, each.picture)
        for each in edit.frames
    ]
    title = f"edited: {text}"[:MAX_TITLE_LENGTH]
    return [draped_frame("as given", edit.source), *steps, draped_frame(title, edit.result)]


def run_edit(  # noqa: PLR0913 - the settings of an edit, keyword-only
    z: Float[Tensor, " latent"],
    pictures: ImageDecoder,
    guidance: Guidance,
    text: str,
    source_prompt: str,
    *,
    strength: float,
    steps: int,
    boost: float = 1.0,
    region: EditedRegion | None = None,
    progress: Callable[[int, Tensor], None] = lambda *_: None,
) -> Float[Tensor, " latent"]:
    """Edit a latent vector once, without checks.

    Args:
        z: latent vector of the source.
        pictures: draws pictures of latent vectors.
        guidance: how pictures should change.
        text: the target prompt.
        source_prompt: see `edit_prompts`.
        strength: how far the garment may change.
        steps: of the optimisation.
        boost: factor of the guidance scale.
        region: where the garment may change; None for anywhere.
        progress: called after every step with its number and the latent vector.

    Raises:
        LearnError: the optimisation diverges.
    """
    with torch.no_grad():
        guidance.start(pictures.draw(z[None]), source_prompt, boost)
    keep_weight = None
    if region is not None:
        mask = torch.from_numpy(keep_mask(region, pictures.config.picture)).float()
        keep_weight = KEEP_WEIGHT / strength * mask
    return optimise_latent(
        z,
        pictures.draw,
        guidance,
        text,
        steps=steps,
        learning_rate=LEARNING_RATE,
        distance_weight=DISTANCE_WEIGHT / strength,
        keep_weight=keep_weight,
        progress=progress,
    )


def denoiser_guidance(
    name: str | Path | None, text: str, **options: Any
) -> tuple[ScoreDistillation, tuple[float, str]]:
    """Guidance by a small diffusion model: a bundled one, or one in a folder.

    Args:
        name: of the model; None for the default.
        text: of the edit.
        options: keyword arguments of `ScoreDistillation`.

    Returns:
        The guidance, and the nearest training phrase of the text after its cosine similarity.

    Raises:
        LearnError: there is no model of that name, and no such folder; or no word of the text is in
            the vocabulary.
    """
    check_known(text)
    folder = network_folder(
        DEFAULT_DENOISER if name is None else name, denoiser_names(), "denoiser"
    )
    guidance = ScoreDistillation(PixelDiffusion(folder), **{**PIXEL_DEFAULTS, **options})
    return guidance, nearest_phrase(text)


def stable_guidance(model: str | None, **options: Any) -> ScoreDistillation:
    """Guidance by Stable Diffusion.

    Args:
        model: a folder, or an id on the Hugging Face Hub; None for the paper's.
        options: keyword arguments of `ScoreDistillation`.

    Raises:
        LearnError: it does not exist or cannot be downloaded, or `diffusers` is not installed.
    """
    diffusion = StableDiffusion(DEFAULT_MODEL if model is None else model)
    return ScoreDistillation(diffusion, **{**SD_DEFAULTS, **options})


def normalised_text(text: str) -> str:
    """A text in one line without spaces around it.

    Raises:
        LearnError: it is empty or too long, or not valid Unicode.
    """
    words = " ".join(text.split())
    if any("\ud800" <= character <= "\udfff" for character in words):
        raise LearnError(f"the text {quoted(words)} is not valid UTF-8; type it again")
    if not any(character.isalnum() for character in words):
        raise LearnError(f"the text {quoted(words)} says nothing; say what the garment should be")
    if len(words) > MAX_TEXT_LENGTH:
        raise LearnError(f"the text has {len(words):,} characters; give {MAX_TEXT_LENGTH} or fewer")
    return words


def check_pair(space: Path, pictures: ImageDecoder) -> None:
    """Refuse a picture network that was trained with another latent space.

    Raises:
        LearnError: it was.
    """
    trained_with = pictures.config.vae_sha256
    if trained_with and trained_with != weights_hash(space):
        raise LearnError(
            f"the picture network was trained with another latent space than {shown_path(space)}; "
            "name two that were trained together"
        )


def check_options(strength: float, steps: int, max_attempts: int) -> None:
    """Check the options of an edit.

    Raises:
        LearnError: one is out of range.
    """
    for name, value, (low, high) in (
        ("strength", strength, STRENGTH_LIMITS),
        ("number of steps", steps, STEP_LIMITS),
        ("number of attempts", max_attempts, (1, MAX_ATTEMPTS)),
    ):
        if not low <= value <= high:
            raise LearnError(f"the {name} is {value:g}; give {low:g} to {high:g}")


def image_decoder_names() -> tuple[str, ...]:
    """Bundled networks from latent vectors to pictures."""
    return tuple(name for name in bundled_names("model.safetensors") if name.endswith("-pictures"))


def denoiser_names() -> tuple[str, ...]:
    """Bundled diffusion models."""
    return tuple(name for name in bundled_names("model.safetensors") if name.endswith("-denoiser"))
