"""Stable Diffusion as guidance, as in the paper (Section 4.2), through `diffusers`."""

import re
import warnings
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from garmentimage.errors import LearnError
from garmentimage.system import shown_path
from garmentimage.text_edit.guidance import Pictures

DEFAULT_MODEL = "stable-diffusion-v1-5/stable-diffusion-v1-5"
DEFAULTS: dict[str, Any] = {
    "scale": 30.0,
    "prompt_template": "a photo of a person wearing {}, plain white background",
    "noise_samples": 1,
}
"""Of `ScoreDistillation`."""
HUB_ID = re.compile(r"\w[\w.-]*/\w[\w.-]*")
PREDICTION_TYPES = "epsilon", "v_prediction"
"""Parametrisations of the denoiser: the noise, or v = alpha noise - sigma picture (Salimans and Ho
2022)."""
INCOMPATIBLE = (AttributeError, IndexError, TypeError, ValueError, ArithmeticError, RuntimeError)
"""Raised by parts of a model that do not match each other."""
LOAD_ERROR = "is not a readable Stable Diffusion model, or cannot be downloaded"


class StableDiffusion:
    """A Stable Diffusion pipeline; it works in the latent space of its autoencoder.

    Args:
        model: a folder that `diffusers` saved, or an id on the Hugging Face Hub.
        device: where it runs; half precision on a GPU.

    Raises:
        LearnError: `diffusers` is not installed, or the model does not exist, cannot be downloaded
            or is of another kind.
    """

    def __init__(self, model: str = DEFAULT_MODEL, device: str | None = None) -> None:
        self.device = torch.device(device or ("cuda" if torch.cuda.is_available() else "cpu"))
        self.kind = torch.float32 if self.device.type == "cpu" else torch.float16
        self.pipe: Any = _pipeline(model).to(self.device, self.kind)
        for part in (self.pipe.vae, self.pipe.unet, self.pipe.text_encoder):
            part.requires_grad_(False).eval()
        try:
            self._try_out()
        except LearnError as error:
            raise LearnError(f"{shown_path(model)}: {error}") from None
        except torch.OutOfMemoryError as error:
            raise LearnError(
                f"{shown_path(model)}: needs more memory than {self.device}"
            ) from error
        except INCOMPATIBLE as error:
            raise LearnError(
                f"{shown_path(model)}: is not compatible with Stable Diffusion "
                f"({type(error).__name__}); download {DEFAULT_MODEL} and give its folder"
            ) from error

    @torch.no_grad()
    def _try_out(self) -> None:
        """Run every part once, so that incompatible parts are found before the work."""
        predicted = self.pipe.scheduler.config.prediction_type
        if predicted not in PREDICTION_TYPES:
            raise LearnError(
                f"predicts {predicted}, not {' or '.join(PREDICTION_TYPES)}; download "
                f"{DEFAULT_MODEL} and give its folder"
            )
        self.alpha_bar = self.pipe.scheduler.alphas_cumprod.to(self.device)
        times = torch.full((1,), 0.5)
        encoded = self.encode(torch.zeros(1, 3, 8, 8))
        if self.predict_noise(encoded, times, self.embed_prompt("")).shape != encoded.shape:
            raise ValueError("noise of another shape than the encoded picture")

    @property
    def size(self) -> int:
        """Pixels a side of the pictures that it was trained on."""
        return int(self.pipe.unet.config.sample_size * self.pipe.vae_scale_factor)

    def encode(self, pictures: Pictures) -> Tensor:
        """Latents of pictures, turned upright and enlarged before."""
        upright = pictures.flip(2).to(self.device, self.kind)
        large = functional.interpolate(upright, (self.size, self.size), mode="bilinear")
        latents = self.pipe.vae.encode(2 * large - 1).latent_dist.mean
        scaled: Tensor = latents * self.pipe.vae.config.scaling_factor
        return scaled.float()

    def alpha_sigma(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Factors of picture and noise, at the nearest step of the model's own schedule."""
        alpha_bar = self.alpha_bar[self._steps(times)][:, None, None, None].float()
        return alpha_bar.sqrt(), (1 - alpha_bar).sqrt()

    @torch.no_grad()
    def embed_prompt(self, text: str) -> Tensor:
        """The embedding of a prompt by the model's text encoder.

        Raises:
            LearnError: the prompt is too long.
        """
        most = int(self.pipe.text_encoder.config.max_position_embeddings)
        tokens = self.pipe.tokenizer(
            [text], padding="max_length", max_length=most, return_tensors="pt"
        )
        count = tokens.input_ids.shape[1]
        if count > most:
            raise LearnError(
                f"the prompt has {count} tokens, the model reads {most}; shorten the text or the "
                "prompt template"
            )
        found: Tensor = self.pipe.text_encoder(tokens.input_ids.to(self.device))[0]
        return found

    def predict_noise(self, noisy: Tensor, times: Float[Tensor, " n"], prompt: Tensor) -> Tensor:
        """The noise in noisy latents."""
        text = prompt.expand(len(noisy), -1, -1)
        predicted: Tensor = self.pipe.unet(
            noisy.to(self.kind), self._steps(times), encoder_hidden_states=text
        ).sample
        if self.pipe.scheduler.config.prediction_type == "v_prediction":
            alpha, sigma = self.alpha_sigma(times)
            return alpha * predicted.float() + sigma * noisy
        return predicted.float()

    def _steps(self, times: Float[Tensor, " n"]) -> Tensor:
        last = len(self.alpha_bar) - 1
        return (times.to(self.device) * last).round().long().clamp(0, last)


def _pipeline(model: str) -> Any:
    """The parts of a model, in full precision."""
    pipeline = _pipeline_class()
    is_local = _check_location(model)
    _check_class(pipeline, model, is_local)
    try:
        return pipeline.from_pretrained(
            model,
            safety_checker=None,
            feature_extractor=None,
            requires_safety_checker=False,
            use_safetensors=True,
            local_files_only=is_local,
            low_cpu_mem_usage=False,
        )
    except Exception as error:  # noqa: BLE001 - errors of four libraries and of the network
        raise _load_error(model, error) from None


def _pipeline_class() -> Any:
    """`diffusers.StableDiffusionPipeline`, with its messages and progress bars switched off."""
    try:
        from diffusers.utils import logging as diffusers_logging
        from transformers.utils import logging as transformers_logging
    except ImportError:
        raise LearnError(
            "guidance by Stable Diffusion needs diffusers; `pip install -e '.[sd]'`"
        ) from None
    for logging in (diffusers_logging, transformers_logging):
        logging.set_verbosity_error()
        logging.disable_progress_bar()
    from diffusers import StableDiffusionPipeline

    return StableDiffusionPipeline


def _check_location(model: str) -> bool:
    """Whether a model is a folder; refuse what is neither a model's folder nor an id on the Hub."""
    try:
        is_folder = Path(model).is_dir()
    except OSError as error:
        raise LearnError(f"{shown_path(model)}: cannot be read ({error.strerror})") from None
    if not is_folder and not HUB_ID.fullmatch(model):
        raise LearnError(
            f"{shown_path(model)}: there is no such folder; give one that diffusers saved, or an "
            f"id on the Hugging Face Hub such as {DEFAULT_MODEL}"
        )
    if is_folder and not (Path(model) / "model_index.json").is_file():
        raise LearnError(
            f"{shown_path(model)}: holds no Stable Diffusion model (no model_index.json); give a "
            "folder that diffusers saved"
        )
    return is_folder


def _check_class(pipeline: Any, model: str, is_local: bool) -> None:
    """Refuse pipelines of other classes before their weights are read or downloaded."""
    try:
        with warnings.catch_warnings():  # huggingface_hub warns of how diffusers calls it
            warnings.filterwarnings("ignore", "The `local_dir_use_symlinks` argument")
            found = pipeline.load_config(model, local_files_only=is_local).get("_class_name")
    except Exception as error:  # noqa: BLE001 - errors of four libraries and of the network
        raise _load_error(model, error) from None
    if found != pipeline.__name__:
        raise LearnError(
            f"{shown_path(model)}: is a {found}, not Stable Diffusion 1 or 2; download "
            f"{DEFAULT_MODEL} and give its folder"
        )


def _load_error(model: str, error: Exception) -> LearnError:
    return LearnError(
        f"{shown_path(model)}: {LOAD_ERROR} ({type(error).__name__}); download {DEFAULT_MODEL} and "
        "give its folder"
    )
