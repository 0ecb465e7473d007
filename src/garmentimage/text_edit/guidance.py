"""Guidance: how a picture should change to match a text.

Score distillation sampling (Poole et al. 2023, DreamFusion; paper, Section 4.2). With x the picture
in the space of the diffusion model, noise e and time t, the model sees

    x_t = alpha_t x + sigma_t e

and predicts the noise, with classifier-free guidance of scale s (Ho and Salimans 2022):

    e' = e(x_t | negative) + s (e(x_t | text) - e(x_t | negative)).

The gradient with respect to x is sigma_t^2 (e' - e); gradients through the denoiser are left out.
From it we subtract the same expression for the original picture and a prompt that is true of it
(delta denoising score, Hertz et al. 2023), with the same noise and time, so that what the model
would change anyway is left alone. The code drives any diffusion model; models differ in the space
they work in.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor

from garmentimage.errors import LearnError

Pictures = Float[Tensor, "n 3 pixel_row pixel_col"]
"""Colours from 0 to 1, the lowest row of pixels first."""
MAX_SCALE, MAX_SEED = 1000.0, 2**63 - 1
TIME_LIMITS = (0.02, 0.98)
"""Diffusion times are kept within these, away from no noise and from pure noise."""


@runtime_checkable
class Guidance(Protocol):
    """A gradient for pictures and a text."""

    def start(self, pictures: Pictures, source_prompt: str, boost: float) -> None:
        """Set the original pictures, before the first gradient.

        Args:
            pictures: of the garment before the edit.
            source_prompt: what is true of them in the aspect of the text; empty if not known.
            boost: factor of the guidance scale; 1 at the first attempt.
        """

    def gradient(self, pictures: Pictures, text: str, progress: float) -> Pictures:
        """Gradient of a loss that is small where pictures match the text.

        Args:
            pictures: as they are now.
            text: what they should show.
            progress: share of the optimisation that is complete, from 0 to 1.
        """


@runtime_checkable
class Diffusion(Protocol):
    """A diffusion model of pictures."""

    def encode(self, pictures: Pictures) -> Tensor:
        """Pictures in the space of the model; differentiable."""

    def alpha_sigma(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Factors of picture and noise at times from 0 to 1, [n, 1, 1, 1]."""

    def embed_prompt(self, text: str) -> Any:
        """The embedding of a prompt; the empty text is the unconditional one."""

    def predict_noise(self, noisy: Tensor, times: Float[Tensor, " n"], prompt: Any) -> Tensor:
        """The noise in noisy pictures, given an embedded prompt."""


@dataclass(frozen=True)
class NoiseSchedule:
    """Diffusion times: from `first` to `last` as the optimisation proceeds, +- `width`."""

    first: float = 0.7
    last: float = 0.3
    width: float = 0.2

    def __post_init__(self) -> None:
        if not (0 < self.last <= self.first < 1 and 0 <= self.width < 1):
            raise LearnError("times of noise are more than 0 and less than 1, the first the latest")

    def sample_times(
        self, progress: float, count: int, generator: torch.Generator
    ) -> Float[Tensor, " n"]:
        """Random times for `count` pictures, uniform around the current middle."""
        middle = self.first + (self.last - self.first) * progress
        spread = (2 * torch.rand(count, generator=generator) - 1) * self.width
        return (middle + spread).clamp(*TIME_LIMITS)


class ScoreDistillation:
    """Guidance by a diffusion model.

    Args:
        diffusion: the model.
        scale: of classifier-free guidance: weight of the text over the negative prompt.
        negative: what the picture should not show; empty for the unconditional prompt.
        prompt_template: prompt around the text: `"a photo of {}"`.
        schedule: times of the noise.
        noise_samples: noise samples for each picture, each at its own time; gradients are averaged.
        seed: of noise and times.

    Raises:
        LearnError: `prompt_template` has no place for the text, or a number is out of range.
    """

    def __init__(
        self,
        diffusion: Diffusion,
        *,
        scale: float = 7.5,
        negative: str = "",
        prompt_template: str = "{}",
        schedule: NoiseSchedule = NoiseSchedule(),
        noise_samples: int = 4,
        seed: int = 0,
    ) -> None:
        if prompt_template.count("{}") != 1:
            raise LearnError(
                f"the prompt template {prompt_template!r} needs one {{}} where the text goes"
            )
        if not 0 < scale <= MAX_SCALE:
            raise LearnError(
                f"the guidance scale is {scale:g}; give more than 0, up to {MAX_SCALE:g}"
            )
        if not 0 <= seed <= MAX_SEED:
            raise LearnError(f"the seed is {seed}; give 0 to {MAX_SEED}")
        self.diffusion, self.scale, self.prompt_template = diffusion, scale, prompt_template
        self.schedule, self.noise_samples = schedule, noise_samples
        self.generator = torch.Generator().manual_seed(seed)
        self._negative = negative
        self._embeddings: dict[str, Any] = {}
        self._source: tuple[Tensor, str] | None = None
        self._boost = 1.0

    def start(self, pictures: Pictures, source_prompt: str, boost: float = 1.0) -> None:
        """See `Guidance`; if it is not called, nothing is subtracted."""
        self._boost = boost
        with torch.no_grad():
            self._source = self.diffusion.encode(pictures), source_prompt

    def gradient(self, pictures: Pictures, text: str, progress: float) -> Pictures:
        """See `Guidance`; each picture has noise and times of its own."""
        leaf = pictures.detach().requires_grad_()
        encoded = self.diffusion.encode(leaf)
        repeated = encoded.detach().repeat_interleave(self.noise_samples, 0)
        times = self.schedule.sample_times(progress, len(repeated), self.generator)
        times = times.to(encoded.device)
        noise = torch.randn(repeated.shape, generator=self.generator).to(encoded)
        sds = self.sds_gradient(repeated, self._fill(text), times, noise)
        if self._source is not None:
            source, prompt = self._source
            source = source.repeat_interleave(self.noise_samples, 0)
            # The same noise and times, so that what the model would change anyway cancels out.
            sds = sds - self.sds_gradient(
                source, self._fill(prompt) if prompt else "", times, noise
            )
        sds = sds.reshape(-1, self.noise_samples, *sds.shape[1:]).mean(1)
        (gradient,) = torch.autograd.grad(encoded, leaf, sds)
        return gradient

    @torch.no_grad()
    def sds_gradient(
        self, encoded: Tensor, prompt: str, times: Float[Tensor, " n"], noise: Tensor
    ) -> Tensor:
        """sigma^2 (e' - e) in the space of the model (see the top of this file).

        Args:
            encoded: pictures in that space.
            prompt: the whole prompt.
            times: a time for each picture.
            noise: as `encoded`.
        """
        alpha, sigma = (factor.to(encoded) for factor in self.diffusion.alpha_sigma(times))
        noisy = alpha * encoded + sigma * noise
        conditional = self.diffusion.predict_noise(noisy, times, self._embed(prompt))
        negative = self.diffusion.predict_noise(noisy, times, self._embed(self._negative))
        scale = self.scale * self._boost
        return sigma**2 * (negative - noise + scale * (conditional - negative))

    def _fill(self, text: str) -> str:
        """The prompt of a text; `str.format` would fail on other braces."""
        return self.prompt_template.replace("{}", text)

    def _embed(self, prompt: str) -> Any:
        if prompt not in self._embeddings:
            self._embeddings[prompt] = self.diffusion.embed_prompt(prompt)
        return self._embeddings[prompt]


def optimise_latent(  # noqa: PLR0913 - terms of the loss, keyword-only
    start: Float[Tensor, " latent"],
    draw: Callable[[Float[Tensor, "n latent"]], Pictures],
    guidance: Guidance,
    text: str,
    *,
    steps: int,
    learning_rate: float,
    distance_weight: float,
    keep_weight: Float[Tensor, "pixel_row pixel_col"] | None = None,
    progress: Callable[[int, Tensor], None] = lambda *_: None,
) -> Float[Tensor, " latent"]:
    """Optimise a latent vector so that its picture matches a text.

    Minimises, by gradient descent (Adam, Kingma and Ba 2015), with g the gradient of the guidance
    at the current picture,

        <g, draw(z)> + distance_weight |z - start|^2
        + sum over pixels of keep_weight (draw(z) - draw(start))^2.

    Args:
        start: latent vector of the garment before the edit.
        draw: pictures of latent vectors; differentiable.
        guidance: gives g.
        text: what the picture should show.
        steps: of the optimisation.
        learning_rate: of Adam.
        distance_weight: weight of the squared distance from the start.
        keep_weight: weight of the squared change of a colour, by pixel; None for 0.
        progress: called after every step with its number, from 1, and the latent vector.

    Raises:
        LearnError: the optimisation diverges (NaN or infinite values).
    """
    z = start.clone().requires_grad_()
    with torch.no_grad():
        first = draw(start[None])
    optimizer = torch.optim.Adam([z], learning_rate, betas=(0.9, 0.99))
    for step in range(steps):
        picture = draw(z[None])
        gradient = guidance.gradient(picture.detach(), text, step / max(steps - 1, 1))
        loss = (gradient * picture).sum() + distance_weight * ((z - start) ** 2).sum()
        if keep_weight is not None:
            loss = loss + (keep_weight * (picture - first) ** 2).sum()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        if not z.isfinite().all():
            raise LearnError(
                f"the guidance gives NaN or infinite values (step {step + 1}); try a smaller "
                "scale, or another model"
            )
        progress(step + 1, z.detach().clone())
    return z.detach()
