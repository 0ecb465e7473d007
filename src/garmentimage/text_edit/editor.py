"""Editing a garment by text: its latent vector is moved until its picture shows what is said."""

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
from garmentimage.networks import Latent, Step, network_folder, shipped_names
from garmentimage.pattern import Pattern
from garmentimage.raster import GarmentImage
from garmentimage.system import shown_path, weights_hash
from garmentimage.text_edit.best_of import MAX_ATTEMPTS, best_attempt
from garmentimage.text_edit.guidance import Guidance, ScoreDistillation, optimise_latent
from garmentimage.text_edit.keep_mask import keep_mask
from garmentimage.text_edit.source_prompt import edit_prompts, nearest_phrase
from garmentimage.text_edit.vocabulary import check_known

DEFAULT_SPACE, DEFAULT_IMAGE_DECODER, DEFAULT_DENOISER = (
    "text-edit",
    "text-edit-pictures",
    "text-edit-denoiser",
)
"""Networks that come with the package."""
MAX_TEXT_LENGTH = 500
"""Characters of a text."""
STRENGTH_LIMITS, STEP_LIMITS = (0.05, 20.0), (1, 5000)
"""Least and most of what may be asked."""
DISTANCE_WEIGHT = 0.02
"""What the squared distance from the start costs at strength 1."""
KEEP_WEIGHT = 1.0
"""What the squared change of a colour costs where the text should change nothing."""
LEARNING_RATE = 0.1
"""Learning rate."""
DEFAULT_STEPS = 60
FRAME_COUNT = 6
"""Steps that are kept for the strip, with both ends."""
REPROJECTIONS = 1
"""Times that the result is decoded and encoded again."""


@dataclass(frozen=True)
class EditFrame:
    """A moment of an edit."""

    number: int
    """Steps made so far."""
    step: Step
    picture: UInt8[np.ndarray, "row col 3"]
    """What the network thinks that it looks like."""


@dataclass(frozen=True)
class TextEdit:
    """A garment, and what a text made of it."""

    given: Step
    frames: tuple[EditFrame, ...]
    """From the start to the end."""
    result: Step
    tries: int
    """Made to get there."""
    done: bool | None
    """Whether geometry tells that the text is true now; None if it cannot tell."""


class TextEditor:
    """Networks that edit garments by text.

    Args:
        space: latent vectors and garments.
        pictures: latent vectors and pictures of worn garments.

    Raises:
        LearnError: they were not trained together.
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
        """Networks that come with the package, by name, or those in folders.

        Raises:
            LearnError: there are none of those names, and no such folders.
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
        tries: int = MAX_ATTEMPTS,
        progress: Callable[[int, int], None] = lambda done, steps: None,
    ) -> TextEdit:
        """What a text makes of a garment; up to `attempts` times (`best_attempt`).

        Args:
            source: the garment.
            text: what it should be: "long sleeves", "pants".
            guidance: which way its picture should change, such as `small_guidance()`.
            strength: how far it may go from what it was; 1 is usual.
            steps: of the optimisation.
            tries: how often, at the most.
            progress: called after every step, with how many of a try are made and of how many.

        Raises:
            LearnError: a text, strength or number of steps or tries that will not do, or an image
                that the network does not take.
            EncodeError: a pattern that does not fit its grid.
        """
        words = normalised_text(text)
        check_options(strength, steps, tries)
        given = self.space.given(source)
        assert given.image is not None  # `LatentSpace.given` has one
        space = self.space.fit_for(given.image)
        start = torch.from_numpy(given.z).float()
        told, said = edit_prompts(given.pattern, words)
        wanted = set(
            np.linspace(0, steps, min(FRAME_COUNT, steps + 1)).round().astype(int).tolist()
        )
        ways: list[dict[int, torch.Tensor]] = []

        def attempt(further: float, touched: EditedRegion | None) -> Step:
            moments = {0: start}
            ways.append(moments)

            def keep(step: int, z: torch.Tensor) -> None:
                if step in wanted:
                    moments[step] = z
                progress(step, steps)

            z = run_edit(
                start,
                self.pictures,
                guidance,
                told,
                said,
                strength=strength,
                steps=steps,
                further=further,
                touched=touched,
                progress=keep,
            )
            return space.step(space.settled(z.numpy(), REPROJECTIONS))

        best = best_attempt(given.pattern, words, attempt, tries)
        frames = tuple(
            EditFrame(number, space.step(z.numpy()), self.picture(z.numpy()))
            for number, z in sorted(ways[best.number].items())
        )
        return TextEdit(given, frames, best.step, best.count, best.done)

    def picture(self, z: Latent) -> UInt8[np.ndarray, "row col 3"]:
        """What the garment of a latent vector looks like, to the network."""
        with torch.no_grad():
            colours = self.pictures.draw(torch.from_numpy(np.asarray(z, np.float32))[None])[0]
        upright = (colours.flip(1).permute(1, 2, 0) * 255).round().to(torch.uint8)
        return np.ascontiguousarray(upright.numpy())


def run_edit(
    z: Float[Tensor, " latent"],
    pictures: ImageDecoder,
    guidance: Guidance,
    text: str,
    said: str,
    *,
    strength: float,
    steps: int,
    further: float = 1.0,
    touched: EditedRegion | None = None,
    progress: Callable[[int, Tensor], None] = lambda step, z: None,
) -> Float[Tensor, " latent"]:
    """The latent vector that a text makes of another.

    Args:
        z: of the garment as it is.
        pictures: what garments look like.
        guidance: which way pictures should change.
        text: what they should show.
        said: what of it is true of the garment as it is, see `edit_prompts`.
        strength: how far it may go.
        steps: of the optimisation.
        further: how much further than usual the guidance should push.
        touched: where the garment may change; None if the text does not tell.
        progress: called after every step.
    """
    with torch.no_grad():
        guidance.start(pictures.draw(z[None]), said, further)
    held = None
    if touched is not None:
        held = (
            KEEP_WEIGHT
            / strength
            * torch.from_numpy(keep_mask(touched, pictures.config.picture)).float()
        )
    return optimise_latent(
        z,
        pictures.draw,
        guidance,
        text,
        steps=steps,
        rate=LEARNING_RATE,
        pull=DISTANCE_WEIGHT / strength,
        held=held,
        progress=progress,
    )


def denoiser_guidance(
    name: str | Path | None, text: str, **told: Any
) -> tuple[ScoreDistillation, tuple[float, str]]:
    """Guidance by a small diffusion model: one that comes with the package, or one in a folder.

    Args:
        name: of the model; None for the usual one.
        text: what will be said.
        told: as `ScoreDistillation` takes.

    Returns:
        The guidance, how near the text is to what the model was told in training (1 the same, 0
        strange), and the phrase that is nearest.

    Raises:
        LearnError: there is none of that name, and no such folder; or the text has no word that
            the networks were told of garments.
    """
    check_known(text)
    from garmentimage.text_edit.pixel_diffusion import (
        NOISE_SAMPLES,
        SCALE,
        SCHEDULE,
        PixelDiffusion,
    )

    folder = network_folder(
        DEFAULT_DENOISER if name is None else name, denoiser_names(), "denoiser"
    )
    model = PixelDiffusion(folder)
    guidance = ScoreDistillation(
        model, **{"scale": SCALE, "noises": NOISE_SAMPLES, "schedule": SCHEDULE, **told}
    )
    return guidance, nearest_phrase(text)


def stable_guidance(model: str | None, **told: Any) -> ScoreDistillation:
    """Guidance by Stable Diffusion.

    Args:
        model: a folder, or an id on the Hugging Face Hub; None for that of the paper.
        told: as `ScoreDistillation` takes.

    Raises:
        LearnError: it is not there and cannot be had, or `diffusers` is not installed.
    """
    from garmentimage.text_edit.stable_diffusion import (
        DEFAULT_MODEL,
        PROMPT_TEMPLATE,
        SCALE,
        StableDiffusion,
    )

    usual = {"scale": SCALE, "wrapped": PROMPT_TEMPLATE, "noises": 1}
    return ScoreDistillation(
        StableDiffusion(DEFAULT_MODEL if model is None else model), **{**usual, **told}
    )


def normalised_text(text: str) -> str:
    """A text in one line without spaces around it.

    Raises:
        LearnError: it says nothing, or too much, or is no text.
    """
    words = " ".join(text.split())
    if any("\ud800" <= character <= "\udfff" for character in words):
        raise LearnError(f"the text {quoted(words)} has bytes that are no UTF-8; type it anew")
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
    of = pictures.config.vae_sha256
    if of and of != weights_hash(space):
        raise LearnError(
            f"the picture network was trained with another latent space than {shown_path(space)}; "
            "name two that were trained together"
        )


def check_options(strength: float, steps: int, tries: int) -> None:
    """Refuse a strength or a number of steps or tries that will not do.

    Raises:
        LearnError: says what may be given.
    """
    _check("strength", strength, STRENGTH_LIMITS)
    _check("number of steps", steps, STEP_LIMITS)
    _check("number of tries", tries, (1, MAX_ATTEMPTS))


def image_decoder_names() -> tuple[str, ...]:
    """Networks of pictures that come with the package."""
    return tuple(name for name in shipped_names("model.safetensors") if name.endswith("-pictures"))


def denoiser_names() -> tuple[str, ...]:
    """Small diffusion models that come with the package."""
    return tuple(name for name in shipped_names("model.safetensors") if name.endswith("-denoiser"))


def _check(what: str, value: float, limits: tuple[float, float]) -> None:
    low, high = limits
    if not low <= value <= high:
        raise LearnError(f"the {what} is {value:g}; give {low:g} to {high:g}")
