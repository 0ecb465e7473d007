"""Stable Diffusion as guidance, with a tiny random pipeline that is made here."""

import json
import shutil

import pytest
import torch

from garmentimage.errors import LearnError
from garmentimage.text_edit.guidance import ScoreDistillation
from garmentimage.text_edit.stable_diffusion import StableDiffusion

pytestmark = pytest.mark.slow


def test_pictures_are_coded_upright_and_scaled_up_and_noise_has_their_shape(tiny):
    model = StableDiffusion(str(tiny), device="cpu")
    assert model.size == 32
    pictures = torch.rand(2, 3, 8, 8)
    encoded = model.encode(pictures)
    assert encoded.shape == (2, 4, 16, 16)
    with torch.no_grad():
        upright = torch.nn.functional.interpolate(pictures.flip(2), (32, 32), mode="bilinear")
        coded = model.pipe.vae.encode(2 * upright - 1).latent_dist.mean
    scaled = coded * model.pipe.vae.config.scaling_factor
    assert torch.allclose(encoded, scaled, atol=1e-5)
    times = torch.tensor([0.1, 0.9])
    alpha, sigma = model.alpha_sigma(times)
    assert torch.allclose(alpha**2 + sigma**2, torch.ones_like(alpha)) and alpha[0] > alpha[1]
    assert (
        model.predict_noise(encoded, times, model.embed_prompt("trousers")).shape == encoded.shape
    )


def test_its_gradient_of_pictures_agrees_with_a_numerical_one(tiny):
    model = StableDiffusion(str(tiny), device="cpu")
    pictures = torch.rand(1, 3, 8, 8, generator=torch.Generator().manual_seed(1))
    found = ScoreDistillation(model, scale=5.0, noise_samples=1, seed=2).gradient(
        pictures, "pants", 0.0
    )
    assert found.shape == pictures.shape and found.abs().max() > 0
    again = ScoreDistillation(model, scale=5.0, noise_samples=1, seed=2)
    times = again.schedule.sample_times(0.0, 1, again.generator)
    noise = torch.randn((1, 4, 16, 16), generator=again.generator)
    with torch.no_grad():
        encoded = model.encode(pictures)
        sds = again.sds_gradient(encoded, "pants", times, noise)

        def loss(x):
            return float((sds.double() * model.encode(x).double()).sum())

        for place in [(0, 0, 0, 0), (0, 1, 4, 3), (0, 2, 7, 6)]:
            step = torch.zeros_like(pictures)
            step[place] = 1e-2
            numeric = (loss(pictures + step) - loss(pictures - step)) / 2e-2
            assert float(found[place]) == pytest.approx(numeric, rel=0.03, abs=2e-3)


def test_other_texts_give_other_gradients(tiny):
    model = StableDiffusion(str(tiny), device="cpu")
    pictures = torch.rand(1, 3, 8, 8)
    one, two = (
        ScoreDistillation(model, seed=0).gradient(pictures, text, 0.0) for text in ("a", "zz")
    )
    assert not torch.allclose(one, two)


def test_a_folder_that_is_something_else_is_refused_in_a_sentence(tiny, tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(LearnError, match=r"holds no Stable Diffusion model \(no model_index.json"):
        StableDiffusion(str(tmp_path / "empty"))
    (tmp_path / "empty" / "model_index.json").write_text("[")
    with pytest.raises(LearnError, match="is not a readable Stable Diffusion model"):
        StableDiffusion(str(tmp_path / "empty"))
    with pytest.raises(LearnError, match="cannot be read"):
        StableDiffusion("a" * 5000)
    with pytest.raises(LearnError, match="there is no such folder"):
        StableDiffusion(str(tmp_path / "nowhere"))


@pytest.mark.parametrize(
    ("file", "name", "value", "message"),
    [
        ("model_index.json", "_class_name", "StableDiffusionXLPipeline", "is a StableDiffusionXL"),
        ("scheduler/scheduler_config.json", "prediction_type", "sample", "predicts sample, not"),
        ("unet/config.json", "sample_size", None, "is not compatible with Stable Diffusion"),
        ("vae/config.json", "scaling_factor", "x", "is not compatible with Stable Diffusion"),
    ],
)
def test_a_model_of_another_kind_is_refused_before_the_work(
    file, name, value, message, tiny, tmp_path
):
    shutil.copytree(tiny, tmp_path / "other")
    path = tmp_path / "other" / file
    path.write_text(json.dumps({**json.loads(path.read_text()), name: value}))
    with pytest.raises(LearnError, match=message):
        StableDiffusion(str(tmp_path / "other"), device="cpu")


def test_a_text_that_is_too_long_for_the_model_is_refused(tiny):
    with pytest.raises(LearnError, match="tokens, the model reads 96"):
        StableDiffusion(str(tiny), device="cpu").embed_prompt("a " * 100)
