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
SCALE, PROMPT_TEMPLATE = 30.0, "a photo of a person wearing {}, plain white background"
"""How much more a text counts than its absence, and what it is wrapped in."""
HUB_ID = re.compile(r"\w[\w.-]*/\w[\w.-]*")
PREDICTION_TYPES = "epsilon", "v_prediction"
"""What a model may say of a noisy picture."""
INCOMPATIBLE = (AttributeError, IndexError, TypeError, ValueError, ArithmeticError, RuntimeError)
"""What parts raise that do not fit each other."""


class StableDiffusion:
    """A Stable Diffusion pipeline; it works in the space of its own autoencoder.

    Args:
        model: a folder that `diffusers` saved, or an id on the Hugging Face Hub.
        device: where it runs; half precision on a GPU.

    Raises:
        LearnError: `diffusers` is not installed, the model is not there and cannot be had, or is
            of another kind.
    """

    def __init__(self, model: str = DEFAULT_MODEL, device: str | None = None) -> None:
        chosen = device or ("cuda" if torch.cuda.is_available() else "cpu")
        self.device = torch.device(chosen)
        kind = torch.float32 if self.device.type == "cpu" else torch.float16
        pipe = _pipeline(model)
        self.pipe: Any = pipe.to(self.device, kind)
        for part in (self.pipe.vae, self.pipe.unet, self.pipe.text_encoder):
            part.requires_grad_(False).eval()
        self.kind = kind
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
                f"{shown_path(model)}: does not guide as Stable Diffusion does "
                f"({type(error).__name__}); download {DEFAULT_MODEL} and give its folder"
            ) from error

    @torch.no_grad()
    def _try_out(self) -> None:
        """Code, tell and denoise once, so that what does not fit is known before the work."""
        if self.pipe.scheduler.config.prediction_type not in PREDICTION_TYPES:
            raise LearnError(
                f"predicts {self.pipe.scheduler.config.prediction_type}, not "
                f"{' or '.join(PREDICTION_TYPES)}; download {DEFAULT_MODEL} and give its folder"
            )
        self.kept = self.pipe.scheduler.alphas_cumprod.to(self.device)
        times = torch.full((1,), 0.5)
        hidden = self.hidden(torch.zeros(1, 3, 8, 8))
        if self.noise(hidden, times, self.told("")).shape != hidden.shape:
            raise ValueError("noise of another shape than the picture's code")

    @property
    def size(self) -> int:
        """Pixels a side of the pictures that it was trained on."""
        return int(self.pipe.unet.config.sample_size * self.pipe.vae_scale_factor)

    def hidden(self, pictures: Pictures) -> Tensor:
        """Pictures, upright and scaled up, as its autoencoder codes them."""
        upright = pictures.flip(2).to(self.device, self.kind)
        large = functional.interpolate(upright, (self.size, self.size), mode="bilinear")
        coded = self.pipe.vae.encode(2 * large - 1).latent_dist.mean
        return (coded * self.pipe.vae.config.scaling_factor).float()

    def shares(self, times: Float[Tensor, " n"]) -> tuple[Tensor, Tensor]:
        """Of picture and of noise, at the step of its own schedule that is nearest."""
        kept = self.kept[self._steps(times)][:, None, None, None].float()
        return kept.sqrt(), (1 - kept).sqrt()

    @torch.no_grad()
    def told(self, text: str) -> Tensor:
        """What its text encoder makes of a text.

        Raises:
            LearnError: the text is longer than it reads.
        """
        most = int(self.pipe.text_encoder.config.max_position_embeddings)
        tokens = self.pipe.tokenizer(
            [text], padding="max_length", max_length=most, return_tensors="pt"
        )
        count = tokens.input_ids.shape[1]
        if count > most:
            raise LearnError(
                f"the text has {count} tokens with what it is wrapped in, the model reads {most}; "
                "make it shorter"
            )
        found: Tensor = self.pipe.text_encoder(tokens.input_ids.to(self.device))[0]
        return found

    def noise(self, noisy: Tensor, times: Float[Tensor, " n"], told: Tensor) -> Tensor:
        """The noise that it sees."""
        text = told.expand(len(noisy), -1, -1)
        found = self.pipe.unet(
            noisy.to(self.kind), self._steps(times), encoder_hidden_states=text
        ).sample
        if self.pipe.scheduler.config.prediction_type == "v_prediction":
            alpha, sigma = self.shares(times)
            return alpha * found.float() + sigma * noisy
        return found.float()  # type: ignore[no-any-return]

    def _steps(self, times: Float[Tensor, " n"]) -> Tensor:
        last = len(self.kept) - 1
        return (times.to(self.device) * last).round().long().clamp(0, last)


def _pipeline(model: str) -> Any:
    """The parts of a model, in full precision."""
    try:
        from diffusers.utils import logging as of_diffusers
        from transformers.utils import logging as of_transformers
    except ImportError:
        raise LearnError(
            "guidance by Stable Diffusion needs diffusers; `pip install -e '.[sd]'`"
        ) from None
    for logging in (of_diffusers, of_transformers):  # They would tell much that is no matter here.
        logging.set_verbosity_error()
        logging.disable_progress_bar()
    from diffusers import StableDiffusionPipeline

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
    try:
        with warnings.catch_warnings():  # of one library about how another calls it
            warnings.filterwarnings("ignore", "The `local_dir_use_symlinks` argument")
            told = StableDiffusionPipeline.load_config(model, local_files_only=is_folder)
        if told.get("_class_name") != StableDiffusionPipeline.__name__:
            raise LearnError(
                f"{shown_path(model)}: is a {told.get('_class_name')}, no Stable Diffusion 1 or 2; "
                f"download {DEFAULT_MODEL} and give its folder"
            )
        return StableDiffusionPipeline.from_pretrained(
            model,
            safety_checker=None,
            feature_extractor=None,
            requires_safety_checker=False,
            use_safetensors=True,
            local_files_only=is_folder,
            low_cpu_mem_usage=False,
        )
    except LearnError:
        raise
    except Exception as error:  # What may go wrong spans four libraries and the network.
        raise LearnError(
            f"{shown_path(model)}: is no Stable Diffusion model that can be read, or cannot be "
            f"fetched ({type(error).__name__}); download {DEFAULT_MODEL} and give its folder"
        ) from None
