"""Guidance: which way a picture should change so that it shows what a text says.

Score distillation (Poole et al. 2023, DreamFusion; paper, Section 4.2): noise is put on the
picture, a diffusion model that is told the text says what noise it sees, and the difference of both
is the gradient. What the model would change about the picture as it was given, told what is true of
it, is taken off (delta denoising score, Hertz et al. 2023): so nothing else changes. The same code
drives every diffusion model; they differ in the space that they work in.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import torch
from jaxtyping import Float
from torch import Tensor

from garmentimage.errors import LearnError

Pictures = Float[Tensor, "n 3 pixel_row pixel_col"]
"""Colours from 0 to 1, the lowest row of pixels first."""
MAX_SCALE, MAX_SEED = 1000.0, 2**63 - 1


class Guidance(Protocol):
    """Pictures and a text to a gradient."""

    def start(self, pictures: Pictures, said: str, further: float) -> None:
        """Be told what is given, before the first gradient.

        Args:
            pictures: of it.
            said: what is true of it, of that which the text will speak of; empty if not known.
            further: how much further than usual the text should push; 1 at the first try.
        """

    def gradient(self, pictures: Pictures, text: str, done: float) -> Pictures:
        """How a loss that is small where pictures show the text changes with the pictures.

        Args:
            pictures: what is shown now.
            text: what should be shown.
            done: how much of the optimisation is done, from 0 to 1.
        """


class Diffusion(Protocol):
    """A diffusion model of pictures."""

    def hidden(self, pictures: Pictures) -> Tensor:
        """Pictures in the space that it works in; differentiable."""

    def shares(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Of picture and of noise at times from 0 to 1, [n, 1, 1, 1]."""

    def told(self, text: str) -> Any:
        """A text as it is told; the empty text says nothing."""

    def noise(self, noisy: Tensor, times: Float[Tensor, " n"], told: Any) -> Tensor:
        """The noise in noisy ones, given a text."""


@dataclass(frozen=True)
class NoiseSchedule:
    """Times of the noise: between `first` and `last` as the optimisation goes on, +- `width`."""

    first: float = 0.7
    last: float = 0.3
    width: float = 0.2

    def __post_init__(self) -> None:
        if not (0 < self.last <= self.first < 1 and 0 <= self.width < 1):
            raise LearnError("times of noise are more than 0 and less than 1, the first the latest")

    def drawn(self, done: float, count: int, generator: torch.Generator) -> Float[Tensor, " n"]:
        """Times for some pictures."""
        middle = self.first + (self.last - self.first) * done
        spread = (2 * torch.rand(count, generator=generator) - 1) * self.width
        return (middle + spread).clamp(0.02, 0.98)


class ScoreDistillation:
    """Guidance by a diffusion model.

    Args:
        diffusion: the model.
        scale: how much more the text counts than its absence (classifier-free guidance).
        negative: what the picture should not show; empty for nothing.
        wrapped: what a text is wrapped in: `"a photo of {}"`.
        schedule: times of the noise.
        noises: how many are put on each picture, each at a time of its own; the gradient is their
            mean.
        seed: of noise and times.

    Raises:
        LearnError: `wrapped` has no place for the text, or a number is out of range.
    """

    def __init__(
        self,
        diffusion: Diffusion,
        *,
        scale: float = 7.5,
        negative: str = "",
        wrapped: str = "{}",
        schedule: NoiseSchedule = NoiseSchedule(),
        noises: int = 4,
        seed: int = 0,
    ) -> None:
        if wrapped.count("{}") != 1:
            raise LearnError(f"the wrapping {wrapped!r} needs one {{}} where the text goes")
        if not 0 < scale <= MAX_SCALE:
            raise LearnError(
                f"the guidance scale is {scale:g}; give more than 0, up to {MAX_SCALE:g}"
            )
        if not 0 <= seed <= MAX_SEED:
            raise LearnError(f"the seed is {seed}; give 0 to {MAX_SEED}")
        self.diffusion, self.scale, self.wrapped = diffusion, scale, wrapped
        self.schedule, self.noises = schedule, noises
        self.generator = torch.Generator().manual_seed(seed)
        self._negative = negative
        self._known: dict[str, Any] = {}
        self._given: tuple[Tensor, str] | None = None
        self._further = 1.0

    def start(self, pictures: Pictures, said: str, further: float = 1.0) -> None:
        """See `Guidance`; without it nothing is taken off."""
        self._further = further
        with torch.no_grad():
            self._given = self.diffusion.hidden(pictures), said

    def gradient(self, pictures: Pictures, text: str, done: float) -> Pictures:
        """See `Guidance`; noise and times are drawn for each picture on its own."""
        shown = pictures.detach().requires_grad_()
        hidden = self.diffusion.hidden(shown)
        many = hidden.detach().repeat_interleave(self.noises, 0)
        times = self.schedule.drawn(done, len(many), self.generator).to(hidden.device)
        noise = torch.randn(many.shape, generator=self.generator).to(hidden)
        push = self.push(many, self.wrapped.replace("{}", text), times, noise)
        if self._given is not None:
            given, said = self._given
            true = self.wrapped.replace("{}", said) if said else ""
            push = push - self.push(given.repeat_interleave(self.noises, 0), true, times, noise)
        push = push.unflatten(0, (-1, self.noises)).mean(1)
        (gradient,) = torch.autograd.grad(hidden, shown, push)
        return gradient

    @torch.no_grad()
    def push(self, hidden: Tensor, text: str, times: Float[Tensor, " n"], noise: Tensor) -> Tensor:
        """The gradient in the model's own space, for given times and noise, of a whole text."""
        alpha, sigma = (share.to(hidden) for share in self.diffusion.shares(times))
        noisy = alpha * hidden + sigma * noise
        said = self.diffusion.noise(noisy, times, self._told(text))
        unsaid = self.diffusion.noise(noisy, times, self._told(self._negative))
        return sigma**2 * (unsaid - noise + self.scale * self._further * (said - unsaid))

    def _told(self, text: str) -> Any:
        if text not in self._known:
            self._known[text] = self.diffusion.told(text)
        return self._known[text]


def optimise_latent(
    start: Float[Tensor, " latent"],
    draw: Callable[[Float[Tensor, "n latent"]], Pictures],
    guidance: Guidance,
    text: str,
    *,
    steps: int,
    rate: float,
    pull: float,
    held: Float[Tensor, "pixel_row pixel_col"] | None = None,
    progress: Callable[[int, Tensor], None] = lambda step, z: None,
) -> Float[Tensor, " latent"]:
    """The latent vector that a text makes of another, by gradient descent (Adam).

    Args:
        start: the latent vector of the garment as it is.
        draw: pictures of latent vectors; differentiable.
        guidance: which way pictures should change.
        text: what they should show.
        steps: how many.
        rate: of Adam.
        pull: how much the squared distance from the start costs.
        held: how much the squared change of a colour costs, by pixel; None if it costs nothing.
        progress: called after every step.

    Raises:
        LearnError: the guidance gives what is no number.
    """
    z = start.clone().requires_grad_()
    with torch.no_grad():
        first = draw(start[None])
    optimizer = torch.optim.Adam([z], rate, betas=(0.9, 0.99))
    for step in range(steps):
        picture = draw(z[None])
        push = guidance.gradient(picture.detach(), text, step / max(steps - 1, 1))
        loss = (push * picture).sum() + pull * ((z - start) ** 2).sum()
        if held is not None:
            loss = loss + (held * (picture - first) ** 2).sum()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        if not z.isfinite().all():
            raise LearnError(
                f"the guidance gives no numbers any more (step {step + 1}); try a smaller scale, "
                "or another model"
            )
        progress(step + 1, z.detach().clone())
    return z.detach()
