"""Export of trained networks to folders that are used without torch: latent spaces, cascades."""

import json
import logging
import warnings
from collections.abc import Callable, Mapping
from dataclasses import asdict
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import UInt8
from safetensors.torch import save
from torch import Tensor, nn

from garmentimage.errors import DatasetError
from garmentimage.latent import DECODER_FILE, ENCODER_FILE, GARMENTS_FILE
from garmentimage.learn.data import ImageSplit, LabelledRasters, recolour_cloth
from garmentimage.learn.models import Cascade, GarmentVAE, network_inputs, output_channels
from garmentimage.networks import CONFIG_FILE
from garmentimage.predict import (
    PICTURES_FILE,
    PREDICTOR_FILE,
    Box,
    find_wearer,
    plane_distance,
    thumbnail,
)
from garmentimage.system import write_together

MIN_HALVED = 256
"""Weights with fewer numbers stay float32."""
OPSET = 18
"""Of ONNX."""
GARMENTS_PER_TYPE = 300
"""Training garments of each type that a latent space stores."""
WEIGHTS_FILE, CARD_FILE = "model.safetensors", "README.md"
REFERENCE_IMAGES, REFERENCE_AXES = 1000, 48
"""Training images that define the distribution, and dimensions of the plane that they lie near."""
RECOLOUR_SEED = 43
"""Of the colours of these images, where the cascade was trained with recolouring."""
OOD_QUANTILE = 0.99
"""Share of held-out images that lie within the out-of-distribution threshold."""
MIN_OOD_THRESHOLD = 0.01
"""Smallest out-of-distribution threshold, as a root mean square of colours from 0 to 1."""


class _Function(nn.Module):
    """A function of a network as a network, since only these can be exported."""

    def __init__(self, model: nn.Module, function: Callable[[Tensor], Tensor]) -> None:
        super().__init__()
        self.model, self.function = model, function

    def forward(self, x: Tensor) -> Tensor:
        return self.function(x)


def export_vae(
    model: GarmentVAE,
    train_set: LabelledRasters,
    facts: Mapping[str, Any],
    card: str,
    folder: Path,
) -> None:
    """Write a latent space, with the weights for further training (`from_pretrained`).

    Args:
        model: the network.
        train_set: training garments, of which the first of each type are stored.
        facts: recipe, seed and the like, for `config.json`.
        card: the model card.
        folder: where to write.
    """
    model = model.cpu().eval()
    config = model.config
    channels = torch.zeros(2, config.layout.channels, config.grid, config.grid)
    encoder = _Function(model, lambda x: model.encode(network_inputs(x))[0])
    decoder = _Function(model, lambda z: output_channels(model.decode(z)))
    files = {
        ENCODER_FILE: _onnx(encoder, channels, "channels", "z"),
        DECODER_FILE: _onnx(decoder, torch.zeros(2, model.config.latent), "z", "channels"),
        GARMENTS_FILE: _training_garments(model, train_set),
    }
    export_weights(model, facts, card, folder, files)


def export_cascade(
    model: Cascade,
    train_set: ImageSplit,
    held_out: ImageSplit,
    facts: Mapping[str, Any],
    card: str,
    folder: Path,
) -> None:
    """Write a cascade for use (`PatternPredictor`), with the weights for further training.

    Args:
        model: the network.
        train_set: garments that it was trained on.
        held_out: other garments, from which the out-of-distribution threshold is measured.
        facts: recipe, seed and the like, for `config.json`.
        card: the model card.
        folder: where to write.
    """
    model = model.cpu().eval()
    size, recolour = model.config.picture, model.config.recolour > 0
    predictor = _Function(model, model.predict)
    files = {
        PREDICTOR_FILE: _onnx(predictor, torch.zeros(2, 3, size, size), "picture", "channels"),
        PICTURES_FILE: _reference_images(train_set, held_out, recolour),
    }
    wearer = asdict(_median_wearer(train_set))
    export_weights(model, {**facts, "wearer": wearer}, card, folder, files)


def export_weights(
    model: Any,
    facts: Mapping[str, Any],
    card: str,
    folder: Path,
    files: Mapping[str, bytes] | None = None,
) -> None:
    """Write a network with its weights as 16-bit floats, and further files by name."""
    halves = {name: value.half().contiguous() for name, value in model.state_dict().items()}
    content: dict[str, str | bytes] = {
        CONFIG_FILE: json.dumps({**asdict(model.config), **facts}, indent=1) + "\n",
        WEIGHTS_FILE: save(halves, {"format": "pt"}),
        CARD_FILE: card,
        **(files or {}),
    }
    folder.mkdir(parents=True, exist_ok=True)
    write_together({folder / name: each for name, each in content.items()})


def _shown_images(
    split: ImageSplit, recolour: bool = False
) -> list[UInt8[np.ndarray, "row col 3"]]:
    """Some images as training shows them, the highest row first."""
    count = min(REFERENCE_IMAGES, len(split.ids))
    numbers = np.linspace(0, len(split.ids) - 1, count).astype(int)
    some = split.garments.batch(torch.from_numpy(numbers))
    images = some.pictures
    if recolour:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(RECOLOUR_SEED)
            colours = recolour_cloth(some, torch.zeros(len(some), dtype=torch.bool), 1.0)
        images = (255 * colours).round().to(torch.uint8)
    return [np.ascontiguousarray(each.numpy()[:, ::-1].transpose(1, 2, 0)) for each in images]


def _median_wearer(split: ImageSplit) -> Box:
    """The median bounding box of the wearer in training images."""
    images = _shown_images(split)
    masks = [mask for mask, _ in map(find_wearer, images) if mask is not None]
    if not masks:
        raise DatasetError("the pictures have no plain background; a cascade needs one")
    places = [np.argwhere(mask) for mask in masks]
    boxes = [[*each.min(0), *(each.max(0) + 1)] for each in places]
    top, left, bottom, right = np.median(boxes, axis=0) / len(images[0])
    return Box(float(top), float(bottom), float(left), float(right))


def _reference_images(train_set: ImageSplit, held_out: ImageSplit, recolour: bool) -> bytes:
    """The distribution of training images: their mean, principal axes and distance threshold.

    By principal component analysis of thumbnails. The threshold is the `OOD_QUANTILE` of the
    distances of held-out images from the plane; `PatternPredictor.likeness` compares with it.
    """
    rows, others = (
        np.array([thumbnail(each) for each in _shown_images(split, recolour)])
        for split in (train_set, held_out)
    )
    mean = rows.mean(0)
    _, _, axes = np.linalg.svd(rows - mean, full_matrices=False)
    axes = axes[:REFERENCE_AXES]
    distances = [plane_distance(row, mean, axes) for row in others]
    ood_threshold = max(np.quantile(distances, OOD_QUANTILE), MIN_OOD_THRESHOLD)
    return _npz(
        middle=mean.astype(np.float16),
        axes=axes.astype(np.float16),
        usual=np.float32(ood_threshold),
    )


def _npz(**arrays: Any) -> bytes:
    file = BytesIO()
    np.savez_compressed(file, **arrays)
    return file.getvalue()


@torch.no_grad()
def _training_garments(model: GarmentVAE, train_set: LabelledRasters) -> bytes:
    types = np.array(train_set.types)
    chosen = np.sort(
        np.concatenate(
            [np.flatnonzero(types == name)[:GARMENTS_PER_TYPE] for name in sorted(set(types))]
        )
    )
    parts = train_set.rasters.batch(torch.from_numpy(chosen)).parts()
    latents = torch.cat([model.encode(part.inputs())[0] for part in parts])
    return _npz(
        ids=np.array(train_set.ids)[chosen],
        types=types[chosen],
        latents=latents.numpy().astype(np.float16),
    )


def _onnx(model: nn.Module, example: Tensor, input_name: str, output_name: str) -> bytes:
    """A network as an ONNX file for batches of any size, weights as 16-bit floats."""
    logging.getLogger("torch.onnx").setLevel(logging.ERROR)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # the exporter's own
        program = torch.onnx.export(
            model.eval(),
            (example,),
            dynamo=True,
            input_names=[input_name],
            output_names=[output_name],
            opset_version=OPSET,
            dynamic_shapes=({0: torch.export.Dim("n")},),
            verbose=False,
        )
    assert program is not None
    return _half_precision(program.model_proto)


def _half_precision(model: Any) -> bytes:
    """The same network, its larger weights stored as float16 and cast to float32 when loaded.

    The exporter's notes at each node are left out: they name paths of the machine.
    """
    from onnx import TensorProto, helper, numpy_helper

    graph = model.graph
    casts = []
    for weights in graph.initializer:
        if weights.data_type != TensorProto.FLOAT or np.prod(weights.dims) < MIN_HALVED:
            continue
        name, values = weights.name, numpy_helper.to_array(weights)
        weights.CopyFrom(numpy_helper.from_array(values.astype(np.float16), f"{name}_half"))
        casts.append(helper.make_node("Cast", [f"{name}_half"], [name], to=TensorProto.FLOAT))
    nodes = [*casts, *graph.node]
    for part in (model, graph, *nodes, *graph.value_info, *graph.input, *graph.output):
        part.ClearField("doc_string")
        part.ClearField("metadata_props")
    del graph.node[:]
    graph.node.extend(nodes)
    return bytes(model.SerializeToString())
