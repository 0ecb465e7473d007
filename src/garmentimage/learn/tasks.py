"""The training tasks: for each network its data, how it is built, and how it is saved."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import torch

from garmentimage.errors import LearnError
from garmentimage.learn.data import TensorRows
from garmentimage.learn.export import CARD_FILE, export_cascade, export_vae, export_weights
from garmentimage.learn.weights import Network
from garmentimage.networks import channel_layout
from garmentimage.raster import CONTRACTS, Contract
from garmentimage.system import weights_hash, write_atomically

SPLITS = "train", "validation"
FOR_TRAINING = "`model.safetensors` is for training on (`from_pretrained`)"
FOR_USE = "Weights are 16-bit floats:"


@dataclass(frozen=True, kw_only=True)
class TaskOptions:
    """Data and options of a training task; not every network has every option."""

    data: Path
    """Folder of the dataset."""
    beta: float | None = None
    """Weight of the prior; None for the network's default. For VAEs."""
    contract: Contract | None = None
    """Channel contract, None for 1. For the VAE of GarmentImages."""
    layers: int | None = None
    """Layers of its images, None for two; more need contract 2."""
    without: tuple[str, ...] = ()
    """Garment types that are left out. For networks that take images."""
    ablate: tuple[str, ...] = ()
    """Departures from the paper's cascade that are left out, see `ABLATIONS`. For the cascade."""
    resnet: Path | None = None
    """Folder of a pretrained ResNet that encodes images. For the baselines of the cascade."""
    vae: Path | None = None
    """Folder of the VAE whose latent vectors are decoded. For the image decoder."""


@dataclass(frozen=True, kw_only=True)
class TrainingTask:
    """A network, and its training and validation set."""

    title: str
    """Of the model card."""
    summary: str
    """A sentence for the model card on what the network does."""
    usage: str
    """A sentence for the model card on which files are for what."""
    config: Any
    """The network's configuration, a dataclass."""
    build: Callable[[], Network]
    """Makes the network; weights are drawn from torch's global generator."""
    train_set: TensorRows
    held_out: TensorRows
    save: Callable[[Any, Mapping[str, Any], str, Path], None]
    """Writes the trained network: network, facts for `config.json`, model card, folder."""
    facts: Mapping[str, Any] = field(default_factory=dict)
    """Options that tell its runs apart, beside the configuration."""


def vae_task(options: TaskOptions) -> TrainingTask:
    """The VAE of GarmentImages.

    Raises:
        LearnError: contract 1 with more than two layers.
    """
    from garmentimage.learn.data import read_rasters
    from garmentimage.learn.models import GarmentVAE, vae_config

    contract, layers = CONTRACTS[options.contract or 1].name, options.layers or 2
    layout = channel_layout(contract, layers)
    train_set, held_out = (read_rasters(options.data, split, layout) for split in SPLITS)
    config = vae_config(
        train_set.rasters.grid, channels_contract=contract, layers=layers, **_beta(options)
    )
    sheets = "front and back" if layers == 2 else f"{layers} layers"
    return TrainingTask(
        title="GarmentImage VAE",
        summary="A variational autoencoder of GarmentImages, after Section 4.1 of the paper, its "
        f"encoder one linear map: {sheets} of {config.grid} x {config.grid} cells to "
        f"{config.latent} numbers and back.",
        usage=f"{FOR_TRAINING}, the two `.onnx` files for use without torch: `garmentimage "
        "interpolate A.json B.json --space FOLDER -o out`. Their weights are 16-bit floats.",
        config=config,
        build=lambda: _channels_last(GarmentVAE(config)),
        train_set=train_set.rasters,
        held_out=held_out.rasters,
        save=lambda model, *rest: export_vae(model, train_set, *rest),
    )


def vector_vae_task(options: TaskOptions) -> TrainingTask:
    """The paper's baseline of the VAE."""
    from garmentimage.learn.data import (
        VOCABULARY_FILE,
        build_vocabulary,
        read_patterns,
        to_vectors,
    )
    from garmentimage.learn.models import VectorVAE, VectorVAEConfig

    train_set, held_out = (read_patterns(options.data, split) for split in SPLITS)
    vocabulary = build_vocabulary(train_set)
    config = VectorVAEConfig(len(vocabulary.panels), vocabulary.vertices)
    config = replace(config, **_beta(options))

    def save(model: Any, facts: Mapping[str, Any], card: str, folder: Path) -> None:
        _save_pretrained(model, facts, card, folder)
        write_atomically(folder / VOCABULARY_FILE, vocabulary.to_json())

    return TrainingTask(
        title="Vector VAE",
        summary="The baseline of the paper's Section 4.1: a transformer VAE of panels as vectors.",
        usage=f"{FOR_TRAINING}, and for `garmentimage evaluate latent --vectors FOLDER`.",
        config=config,
        build=lambda: VectorVAE(config),
        train_set=to_vectors(train_set, vocabulary),
        held_out=to_vectors(held_out, vocabulary),
        save=save,
    )


def cascade_task(options: TaskOptions) -> TrainingTask:
    """Three U-Nets from images to GarmentImages."""
    from garmentimage.learn.data import load_split
    from garmentimage.learn.models import ABLATIONS, PAPER_CONFIG, Cascade, CascadeConfig

    train_set, held_out = (
        load_split(options.data, split, without=options.without) for split in SPLITS
    )
    ablated = [name for part in options.ablate for name in ABLATIONS[part]]
    config = replace(
        CascadeConfig(**{name: getattr(PAPER_CONFIG, name) for name in ablated}),
        grid=train_set.garments.rasters.grid,
        picture=train_set.garments.pictures.shape[-1],
    )
    return TrainingTask(
        title="Picture to GarmentImage",
        summary="Three U-Nets that turn the picture of a worn garment into a GarmentImage, as in "
        f"Section 4.3 of the paper: {config.picture} x {config.picture} pixels to front and back "
        f"of {config.grid} x {config.grid} cells.",
        usage="`predictor.onnx` is for use without torch: `garmentimage predict PICTURE --network "
        f"FOLDER -o out`. Its weights are 16-bit floats. {FOR_TRAINING}, where it is beside it.",
        config=config,
        build=lambda: _channels_last(Cascade(config)),
        train_set=train_set.garments,
        held_out=held_out.garments,
        save=lambda model, *rest: export_cascade(model, train_set, held_out, *rest),
        facts={"without": sorted(options.without)},
    )


def slot_task(options: TaskOptions, name: str) -> TrainingTask:
    """A vector-based baseline of the cascade, by its name in `SLOT_NETWORKS`."""
    from garmentimage.dataset import parse_patterns
    from garmentimage.learn.data import (
        ImagedSlots,
        SlotConfig,
        load_split,
        slot_vocabulary,
        to_slots,
    )
    from garmentimage.learn.models import SLOT_NETWORKS, read_resnet

    splits = [load_split(options.data, split, without=options.without) for split in SPLITS]
    patterns = [parse_patterns(split.patterns, options.data) for split in splits]
    vocabulary = slot_vocabulary(patterns[0])
    resnet = read_resnet(options.resnet) if options.resnet else None
    kind = SLOT_NETWORKS[name]
    config = SlotConfig(
        network=name,
        names=vocabulary.names,
        edges=vocabulary.edges,
        width=kind.width,
        layers=kind.layers,
        picture=splits[0].garments.pictures.shape[-1],
        resnet=resnet.config.to_dict() if resnet else None,
    )
    train_set, held_out = (
        ImagedSlots(split.garments.pictures, to_slots(found, vocabulary))
        for split, found in zip(splits, patterns, strict=True)
    )

    def build() -> Network:
        model = kind.network(config)
        if resnet is not None:
            encoder: Any = model.image_encoder
            encoder.resnet.load_state_dict(resnet.state_dict())
        model.output_prior.set_to_mean(train_set.patterns)
        return model

    encoder = "ResNet that was given" if resnet else "small image encoder"
    return TrainingTask(
        title=kind.title,
        summary=f"{kind.summary}, with a {encoder}: a baseline of the paper's Section 4.3.",
        usage=f"{FOR_TRAINING}, and for `garmentimage evaluate image --network NAME=RUN`.",
        config=config,
        build=build,
        train_set=train_set,
        held_out=held_out,
        save=_save_pretrained,
        facts={"without": sorted(options.without)},
    )


def image_decoder_task(options: TaskOptions) -> TrainingTask:
    """Latent vectors of a trained VAE to images.

    Raises:
        LearnError: no VAE is given, or its folder holds none.
    """
    from garmentimage.learn.data import load_split, split_encoder
    from garmentimage.learn.models import ImageDecoder, ImageDecoderConfig

    if options.vae is None:
        raise LearnError("name the VAE whose latent vectors become pictures with --vae")
    encode = split_encoder(options.vae)
    train_set, held_out = (encode(load_split(options.data, split)) for split in SPLITS)
    config = ImageDecoderConfig(
        latent=train_set.latents.shape[1],
        picture=train_set.pictures.shape[-1],
        vae_sha256=weights_hash(options.vae),
    )
    return TrainingTask(
        title="Latent vectors to pictures",
        summary=f"{config.latent} numbers of a GarmentImage VAE to a picture of the worn garment, "
        f"{config.picture} x {config.picture} pixels, as in Section 4.2 of the paper.",
        usage=f"{FOR_USE} `garmentimage edit PATTERN TEXT --image-decoder FOLDER -o out`.",
        config=config,
        build=lambda: _channels_last(ImageDecoder(config)),
        train_set=train_set,
        held_out=held_out,
        save=export_weights,
    )


def denoiser_task(options: TaskOptions) -> TrainingTask:
    """A small diffusion model of captioned images."""
    from garmentimage.learn.data import load_captioned
    from garmentimage.learn.models import Denoiser, DenoiserConfig

    train_set, held_out = (load_captioned(options.data, split) for split in SPLITS)
    config = DenoiserConfig(
        picture=train_set.pictures.shape[-1], text=train_set.text_embeddings.shape[1]
    )
    return TrainingTask(
        title="Denoiser",
        summary=f"A diffusion model of pictures of worn garments, {config.picture} x "
        f"{config.picture} pixels, conditioned on sentence embeddings of all-MiniLM-L6-v2.",
        usage=f"{FOR_USE} `garmentimage edit PATTERN TEXT --model FOLDER -o out`.",
        config=config,
        build=lambda: _channels_last(Denoiser(config)),
        train_set=train_set,
        held_out=held_out,
        save=export_weights,
    )


def task_for(network: str, options: TaskOptions) -> TrainingTask:
    """The training task of a network, by name.

    Raises:
        LearnError: there is no network of that name, or an option does not fit it.
        DatasetError: the dataset cannot be read, or lacks what the network needs.
    """
    from garmentimage.learn.models import SLOT_NETWORKS

    tasks = {
        "vae": vae_task,
        "vector-vae": vector_vae_task,
        "cascade": cascade_task,
        "image-decoder": image_decoder_task,
        "denoiser": denoiser_task,
    }
    if network in SLOT_NETWORKS:
        return slot_task(options, network)
    if network not in tasks:
        raise LearnError(f"there is no network {network!r}")
    return tasks[network](options)


def _beta(options: TaskOptions) -> dict[str, Any]:
    return {} if options.beta is None else {"beta": options.beta}


def _channels_last(model: Network) -> Network:
    # Convolutions on processors are faster with channels last; results are those of this layout.
    return model.to(memory_format=torch.channels_last)  # type: ignore[call-overload,no-any-return]


def _save_pretrained(model: Any, facts: Mapping[str, Any], card: str, folder: Path) -> None:
    del facts  # the configuration alone identifies these
    model.save_pretrained(folder)
    write_atomically(folder / CARD_FILE, card)
