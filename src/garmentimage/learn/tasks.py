"""What can be trained: for each network what it is, what it learns from, and how it is kept."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import torch
from torch import nn

from garmentimage.errors import LearnError
from garmentimage.learn.export import CARD, WEIGHTS, export, export_cascade, half_bytes
from garmentimage.learn.training import Examples
from garmentimage.networks import CONFIG
from garmentimage.system import weights_hash, write_atomically, write_together

FOR_TRAINING = "`model.safetensors` is for training on (`from_pretrained`)"
FOR_USE = "Weights are 16-bit floats:"


@dataclass(frozen=True)
class Wanted:
    """What to train with."""

    data: Path
    beta: float | None = None
    """Weight of the prior; None for the network's own."""
    without: tuple[str, ...] = ()
    """Types of garments that are left out."""
    as_paper: tuple[str, ...] = ()
    """Which of our departures from the paper's cascade are left out, see `DEPARTURES`."""
    resnet: Path | None = None
    """Folder of a ResNet that looks at the pictures for a baseline."""
    vae: Path | None = None
    """Folder of the VAE whose latent vectors become pictures."""


@dataclass(frozen=True)
class Lesson:
    """A network, and what it learns from."""

    title: str
    what: str
    """A sentence for its card."""
    use: str
    """Another: which of its files are for what."""
    config: Any
    make: Callable[[], nn.Module]
    """The network, from the seed that is set."""
    known: Examples
    held_out: Examples
    keep: Callable[[Any, Mapping[str, Any], str, Path], None]
    """Write the trained network, given facts of its data and the text of its card."""
    facts: Mapping[str, Any] = field(default_factory=dict)
    """What else tells its runs apart."""


def vae_lesson(wanted: Wanted) -> Lesson:
    """The VAE of GarmentImages."""
    from garmentimage.learn.data import read_rasters
    from garmentimage.learn.models import GarmentVAE, default_config

    known, held_out = (read_rasters(wanted.data, split) for split in ("train", "validation"))
    config = default_config(known.rasters.grid, **_beta(wanted))
    return Lesson(
        "GarmentImage VAE",
        "A variational autoencoder of GarmentImages, after Section 4.1 of the paper, its encoder "
        f"one linear map: front and back of {config.grid} x {config.grid} cells to "
        f"{config.latent} numbers and back.",
        f"{FOR_TRAINING}, the two `.onnx` files for use without torch: `garmentimage interpolate "
        "A.json B.json --space FOLDER -o out`. Their weights are 16-bit floats.",
        config,
        lambda: _channels_last(GarmentVAE(config)),
        known.rasters,
        held_out.rasters,
        lambda model, facts, card, folder: export(model, known, facts, card, folder),
    )


def vector_vae_lesson(wanted: Wanted) -> Lesson:
    """The paper's baseline of the VAE."""
    from garmentimage.learn.data import WORDS, read_patterns, vectors, vocabulary
    from garmentimage.learn.models import VectorVAE, VectorVAEConfig

    known, held_out = (read_patterns(wanted.data, split) for split in ("train", "validation"))
    words = vocabulary(known)
    config = replace(VectorVAEConfig(len(words.panels), words.vertices), **_beta(wanted))

    def keep(model: Any, facts: Mapping[str, Any], card: str, folder: Path) -> None:
        _save_pretrained(model, facts, card, folder)
        write_atomically(folder / WORDS, words.to_json())

    return Lesson(
        "Vector VAE",
        "The baseline of the paper's Section 4.1: a transformer VAE of panels as vectors.",
        f"{FOR_TRAINING}, and for `garmentimage evaluate explore --vectors FOLDER`.",
        config,
        lambda: VectorVAE(config),
        vectors(known, words),
        vectors(held_out, words),
        keep,
    )


def cascade_lesson(wanted: Wanted) -> Lesson:
    """Three U-Nets from pictures to GarmentImages."""
    from garmentimage.learn.data import read_album
    from garmentimage.learn.models import DEPARTURES, PAPER, Cascade, CascadeConfig

    known, held_out = (
        read_album(wanted.data, split, without=wanted.without) for split in ("train", "validation")
    )
    given_up = {name: getattr(PAPER, name) for part in wanted.as_paper for name in DEPARTURES[part]}
    config = replace(
        CascadeConfig(**given_up),
        grid=known.garments.inside.shape[-1],
        picture=known.garments.pictures.shape[-1],
    )
    return Lesson(
        "Picture to GarmentImage",
        "Three U-Nets that turn the picture of a worn garment into a GarmentImage, as in Section "
        f"4.3 of the paper: {config.picture} x {config.picture} pixels to front and back of "
        f"{config.grid} x {config.grid} cells.",
        "`predictor.onnx` is for use without torch: `garmentimage predict PICTURE --network FOLDER "
        f"-o out`. Its weights are 16-bit floats. {FOR_TRAINING}, where it is beside it.",
        config,
        lambda: _channels_last(Cascade(config)),
        known.garments,
        held_out.garments,
        lambda model, facts, card, folder: export_cascade(
            model, known, held_out, facts, card, folder
        ),
        {"without": sorted(wanted.without)},
    )


def slot_lesson(wanted: Wanted, name: str) -> Lesson:
    """A vector-based baseline of the cascade."""
    from garmentimage.dataset import parse_patterns
    from garmentimage.learn.data import SlotConfig, pictured_slots, read_album, slot_words
    from garmentimage.learn.models import SLOT_NETWORKS, read_resnet

    albums = [
        read_album(wanted.data, split, without=wanted.without) for split in ("train", "validation")
    ]
    patterns = [parse_patterns(album.patterns, wanted.data) for album in albums]
    words = slot_words(patterns[0])
    resnet = read_resnet(wanted.resnet) if wanted.resnet else None
    kind = SLOT_NETWORKS[name]
    config = SlotConfig(
        name,
        words.names,
        words.edges,
        kind.width,
        kind.layers,
        picture=albums[0].garments.pictures.shape[-1],
        resnet=resnet.config.to_dict() if resnet else None,
    )

    def make() -> Any:
        model: Any = kind.network(config)
        if resnet is not None:
            model.see.net.load_state_dict(resnet.state_dict())
        model.usual.set_to_mean(known.patterns)
        return model

    seen_by = "ResNet that was given" if resnet else "small encoder of pictures"
    known, held_out = (
        pictured_slots(album, found, words) for album, found in zip(albums, patterns)
    )
    return Lesson(
        kind.title,
        f"{kind.what}, with a {seen_by}: a baseline of the paper's Section 4.3.",
        f"{FOR_TRAINING}, and for `garmentimage evaluate image --network NAME=RUN`.",
        config,
        make,
        known,
        held_out,
        _save_pretrained,
        {"without": sorted(wanted.without)},
    )


def image_decoder_lesson(wanted: Wanted) -> Lesson:
    """Latent vectors of a trained VAE to pictures."""
    from garmentimage.learn.data import latents_of, read_album, worn
    from garmentimage.learn.models import ImageDecoder, ImageDecoderConfig

    if wanted.vae is None:
        raise LearnError("name the VAE whose latent vectors become pictures with --vae")
    albums = [read_album(wanted.data, split) for split in ("train", "validation")]
    encode = latents_of(wanted.vae)
    known, held_out = (worn(album, encode) for album in albums)
    latent, side = known.latents.shape[1], known.pictures.shape[-1]
    config = ImageDecoderConfig(latent, side, vae_sha256=weights_hash(wanted.vae))
    return Lesson(
        "Latent vectors to pictures",
        f"{config.latent} numbers of a GarmentImage VAE to a picture of the worn garment, "
        f"{config.picture} x {config.picture} pixels, as in Section 4.2 of the paper.",
        f"{FOR_USE} `garmentimage edit PATTERN TEXT --pictures FOLDER -o out`.",
        config,
        lambda: _channels_last(ImageDecoder(config)),
        known,
        held_out,
        _save_halves,
    )


def denoiser_lesson(wanted: Wanted) -> Lesson:
    """A small diffusion model of captioned pictures."""
    from garmentimage.learn.data import read_captioned
    from garmentimage.learn.models import Denoiser, DenoiserConfig

    known, held_out = (read_captioned(wanted.data, split) for split in ("train", "validation"))
    config = DenoiserConfig(known.pictures.shape[-1], known.meanings.shape[1])
    return Lesson(
        "Denoiser",
        f"A diffusion model of pictures of worn garments, {config.picture} x {config.picture} "
        "pixels, told what they show by a sentence vector of all-MiniLM-L6-v2.",
        f"{FOR_USE} `garmentimage edit PATTERN TEXT --model FOLDER -o out`.",
        config,
        lambda: _channels_last(Denoiser(config)),
        known,
        held_out,
        _save_halves,
    )


def lesson(network: str, wanted: Wanted) -> Lesson:
    """What a network learns.

    Raises:
        LearnError: there is no network of that name.
        DatasetError: the data cannot be read, or are not for that network.
    """
    from garmentimage.learn.models import SLOT_NETWORKS

    lessons = {
        "vae": vae_lesson,
        "vector-vae": vector_vae_lesson,
        "cascade": cascade_lesson,
        "image-decoder": image_decoder_lesson,
        "denoiser": denoiser_lesson,
    }
    if network in SLOT_NETWORKS:
        return slot_lesson(wanted, network)
    if network not in lessons:
        raise LearnError(f"there is no network {network!r}")
    return lessons[network](wanted)


def _beta(wanted: Wanted) -> dict[str, Any]:
    return {} if wanted.beta is None else {"beta": wanted.beta}


def _channels_last(model: nn.Module) -> nn.Module:
    return model.to(memory_format=torch.channels_last)  # type: ignore[no-any-return,call-overload]


def _save_pretrained(model: Any, facts: Mapping[str, Any], card: str, folder: Path) -> None:
    model.save_pretrained(folder)
    write_atomically(folder / CARD, card)


def _save_halves(model: Any, facts: Mapping[str, Any], card: str, folder: Path) -> None:
    """Weights as 16-bit floats: for use, and small."""
    folder.mkdir(parents=True, exist_ok=True)
    write_together(
        {
            folder / CONFIG: json.dumps({**asdict(model.config), **facts}, indent=1) + "\n",
            folder / WEIGHTS: half_bytes(model),
            folder / CARD: card,
        }
    )
