"""Score distillation: the gradient, and what drives it."""

import numpy as np
import pytest
import torch

from garmentimage.errors import LearnError
from garmentimage.learn.models.denoiser import Denoiser, DenoiserConfig
from garmentimage.text_edit.guidance import NoiseSchedule, ScoreDistillation, optimise_latent
from garmentimage.text_edit.pixel_diffusion import PixelDiffusion


class Wanting:
    """A diffusion model that knows two pictures: what is said, and grey where nothing is."""

    def __init__(self, scale: float = 1.0) -> None:
        self.said = torch.linspace(-1, 1, 3 * 8 * 8).reshape(1, 3, 8, 8)
        self.scale = scale

    def encode(self, pictures):
        return self.scale * (2 * pictures - 1)

    def alpha_sigma(self, times):
        angle = (0.5 * np.pi * times)[:, None, None, None]
        return angle.cos(), angle.sin()

    def embed_prompt(self, text):
        return text

    def predict_noise(self, noisy, times, prompt):
        alpha, sigma = self.alpha_sigma(times)
        clean = self.scale * self.said if prompt else torch.zeros_like(self.said)
        return (noisy - alpha * clean) / sigma


def test_a_picture_goes_where_the_model_knows_what_is_said():
    model = Wanting()
    guidance = ScoreDistillation(model, scale=1.0)
    z = optimise_latent(
        torch.zeros(3 * 8 * 8),
        lambda z: (0.5 + 0.5 * z).reshape(-1, 3, 8, 8),
        guidance,
        "said",
        steps=300,
        learning_rate=0.02,
        distance_weight=0.0,
    )
    assert torch.allclose(z.reshape(1, 3, 8, 8), model.said, atol=0.05)


def test_a_larger_distance_weight_keeps_a_picture_nearer_to_its_start():
    guidance = ScoreDistillation(Wanting(), scale=1.0)
    ends = [
        optimise_latent(
            torch.zeros(3 * 8 * 8),
            lambda z: (0.5 + 0.5 * z).reshape(-1, 3, 8, 8),
            guidance,
            "said",
            steps=150,
            learning_rate=0.02,
            distance_weight=weight,
        ).norm()
        for weight in (0.0, 0.3, 3.0)
    ]
    assert ends[0] > 1.5 * ends[1] > 2 * ends[2]


def test_the_gradient_of_pictures_is_that_of_half_the_squared_sds_gradient():
    """Against numbers: d/dx of 0.5 |h(x) - stop(h(x) - sds)|^2."""
    model = Wanting(scale=1.7)
    guidance = ScoreDistillation(model, scale=2.0, noise_samples=1, seed=3)
    pictures = torch.rand(1, 3, 8, 8, generator=torch.Generator().manual_seed(0))
    found = guidance.gradient(pictures, "said", 0.5)
    again = ScoreDistillation(model, scale=2.0, noise_samples=1, seed=3)
    times = again.schedule.sample_times(0.5, 1, again.generator)
    noise = torch.randn((1, 3, 8, 8), generator=again.generator)
    encoded = model.encode(pictures)
    target = encoded - again.sds_gradient(encoded, "said", times, noise)

    def loss(x):
        return 0.5 * float(((model.encode(x) - target) ** 2).sum())

    for place in [(0, 0, 0, 0), (0, 1, 3, 4), (0, 2, 7, 7)]:
        step = torch.zeros_like(pictures)
        step[place] = 1e-2
        numeric = (loss(pictures + step) - loss(pictures - step)) / 2e-2
        assert float(found[place]) == pytest.approx(numeric, rel=2e-3, abs=1e-3)


def test_nothing_changes_about_what_is_given_where_the_text_says_what_is_true():
    guidance = ScoreDistillation(Wanting())
    given = torch.rand(2, 3, 8, 8)
    guidance.start(given, "said")
    assert not guidance.gradient(given, "said", 0.0).any()
    assert guidance.gradient(given + 0.1, "said", 0.0).any()


def test_where_nothing_is_known_to_be_true_the_text_is_set_against_no_text():
    guidance = ScoreDistillation(Wanting(), prompt_template="a photo of {}")
    given = torch.rand(1, 3, 8, 8)
    guidance.start(given, "")
    toward = torch.full_like(given, 0.5) - (0.5 + 0.5 * Wanting().said)  # from grey to what is said
    found = guidance.gradient(given, "said", 0.0)
    assert torch.nn.functional.cosine_similarity(found.flatten(), toward.flatten(), 0) > 0.999


def test_the_same_seed_gives_the_same_gradient():
    pictures = torch.rand(2, 3, 8, 8)
    one, two, other = (
        ScoreDistillation(Wanting(), seed=seed).gradient(pictures, "x", 0.2) for seed in (1, 1, 2)
    )
    assert torch.equal(one, two) and not torch.equal(one, other)


def test_times_fall_from_first_to_last():
    schedule = NoiseSchedule(0.8, 0.2, 0.05)
    generator = torch.Generator().manual_seed(0)
    early, late = (schedule.sample_times(done, 100, generator) for done in (0.0, 1.0))
    assert early.min() >= 0.75 and early.max() <= 0.85
    assert late.min() >= 0.15 and late.max() <= 0.25
    with pytest.raises(LearnError, match="times of noise are more than 0"):
        NoiseSchedule(0.2, 0.8)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [({"prompt_template": "a photo"}, "needs one {}"), ({"scale": 0.0}, "the guidance scale is 0")],
)
def test_guidance_that_cannot_be_is_refused(wrong, message):
    with pytest.raises(LearnError, match=message):
        ScoreDistillation(Wanting(), **wrong)


def test_the_pixel_model_predicts_other_noise_for_a_prompt_than_without(tmp_path):
    torch.manual_seed(0)
    config = DenoiserConfig(picture=16, channels=(16, 16))
    made = Denoiser(config)
    for block in (*made.levels.down, *made.levels.up):
        torch.nn.init.normal_(block.conv2.weight, std=0.1)
    made.save_pretrained(tmp_path / "model")
    model = PixelDiffusion(tmp_path / "model")
    times = torch.tensor([0.2, 0.9])
    noisy = torch.randn(2, 3, 16, 16)
    said, unsaid = (
        model.predict_noise(noisy, times, model.embed_prompt(text)) for text in ("long sleeves", "")
    )
    assert said.shape == noisy.shape and not torch.equal(said, unsaid)


def test_a_prompt_template_may_contain_other_braces():
    heard = []

    class Heard:
        def encode(self, pictures):
            return pictures * 1

        def alpha_sigma(self, times):
            ones = torch.ones(len(times), 1, 1, 1)
            return ones, ones

        def embed_prompt(self, text):
            heard.append(text)

        def predict_noise(self, noisy, times, prompt):
            return noisy

    guidance = ScoreDistillation(Heard(), prompt_template="{0} { {} }", negative="no {}")
    guidance.gradient(torch.zeros(1, 3, 4, 4), "a {b}", 0.0)
    assert sorted(heard) == ["no {}", "{0} { a {b} }"]
