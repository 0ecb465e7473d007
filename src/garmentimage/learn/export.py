"""Trained networks as folders that are used without torch: latent spaces, and cascades."""

import json
import logging
import warnings
from collections.abc import Mapping
from dataclasses import asdict
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors.torch import save
from torch import Tensor, nn

from garmentimage.errors import DatasetError
from garmentimage.latent import DECODER, ENCODER, GARMENTS
from garmentimage.learn.data import INPUTS, Album, Labelled, repainted
from garmentimage.learn.models import Cascade, GarmentVAE, from_channels, to_channels
from garmentimage.networks import CONFIG
from garmentimage.predict import PICTURES, PREDICTOR, Box, distance_from, find_wearer, shrunk
from garmentimage.system import write_together

OPSET = 18
KNOWN_A_TYPE = 300
"""Garments of each type that a space knows by heart."""
WEIGHTS, CARD = "model.safetensors", "README.md"
SEEN, AXES = 1000, 48
"""Pictures by which others are judged, and directions in which they may differ."""
COLOURS_SEED = 43
"""Of the colours in which these are shown."""
USUAL = 0.99
"""Share of held-out pictures that are no further from the others than is usual."""
LEAST = 0.01
"""A picture that is so near to the others is like them, of 1."""


class _Encoder(nn.Module):
    def __init__(self, model: GarmentVAE) -> None:
        super().__init__()
        self.model = model

    def forward(self, channels: Tensor) -> Tensor:
        return self.model.encode(from_channels(channels))[0]


class _Decoder(nn.Module):
    def __init__(self, model: GarmentVAE) -> None:
        super().__init__()
        self.model = model

    def forward(self, z: Tensor) -> Tensor:
        return to_channels(self.model.decode(z))


def export(
    model: GarmentVAE, known: Labelled, facts: Mapping[str, Any], card: str, folder: Path
) -> None:
    """Write a latent space, and the weights beside it for training on (`from_pretrained`).

    Args:
        model: the network.
        known: training garments, of which the first of each type are kept.
        facts: recipe, seed and the like, for `config.json`.
        card: the model card.
        folder: where to.
    """
    model = model.cpu().eval()
    grid, latent = model.config.grid, model.config.latent
    folder.mkdir(parents=True, exist_ok=True)
    write_together(
        {
            folder / CONFIG: json.dumps({**asdict(model.config), **facts}, indent=1) + "\n",
            folder / WEIGHTS: half_bytes(model),
            folder / ENCODER: _onnx(
                _Encoder(model), torch.zeros(2, INPUTS, grid, grid), "channels", "z"
            ),
            folder / DECODER: _onnx(_Decoder(model), torch.zeros(2, latent), "z", "channels"),
            folder / GARMENTS: _garments(model, known),
            folder / CARD: card,
        }
    )


class _Predictor(nn.Module):
    def __init__(self, model: Cascade) -> None:
        super().__init__()
        self.model = model

    def forward(self, picture: Tensor) -> Tensor:
        return self.model.predict(picture)


def export_cascade(
    model: Cascade, known: Album, held_out: Album, facts: Mapping[str, Any], card: str, folder: Path
) -> None:
    """Write a cascade for use (`PatternPredictor`), and its weights for training on.

    Args:
        model: the network.
        known: what it was trained on.
        held_out: pictures by which those like them are told from others.
        facts: recipe, seed and the like, for `config.json`.
        card: the model card.
        folder: where to.
    """
    model = model.cpu().eval()
    size = model.config.picture
    told = {**asdict(model.config), **facts, "wearer": asdict(_wearer(known))}
    folder.mkdir(parents=True, exist_ok=True)
    write_together(
        {
            folder / CONFIG: json.dumps(told, indent=1) + "\n",
            folder / WEIGHTS: half_bytes(model),
            folder / PREDICTOR: _onnx(
                _Predictor(model), torch.zeros(2, 3, size, size), "picture", "channels"
            ),
            folder / PICTURES: _pictures(known, held_out, recolour=model.config.recolour > 0),
            folder / CARD: card,
        }
    )


def half_bytes(model: nn.Module) -> bytes:
    """A network's weights as 16-bit floats, a safetensors file."""
    halves = {name: value.half().contiguous() for name, value in model.state_dict().items()}
    return save(halves, {"format": "pt"})


def _rows(album: Album, most: int, *, recolour: bool = False) -> list[np.ndarray]:
    """Some pictures as they are shown in training, the highest row first."""
    numbers = np.linspace(0, len(album.ids) - 1, min(most, len(album.ids))).astype(int)
    some = album.garments.batch(torch.from_numpy(numbers))
    shown = some.pictures
    if recolour:
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(COLOURS_SEED)
            seen = repainted(some, torch.zeros(len(some), dtype=torch.bool), 1.0)
        shown = (255 * seen).round().to(torch.uint8)
    return [np.ascontiguousarray(each.numpy()[:, ::-1].transpose(1, 2, 0)) for each in shown]


def _wearer(album: Album) -> Box:
    """Where the wearer is in most pictures."""
    boxes = []
    for pixels in _rows(album, SEEN):
        mask, _ = find_wearer(pixels)
        if mask is not None:
            at = np.argwhere(mask)
            boxes.append([*at.min(0), *(at.max(0) + 1)])
    if not boxes:
        raise DatasetError("the pictures have no plain background; a cascade needs one")
    top, left, bottom, right = np.median(boxes, axis=0) / len(pixels)
    return Box(float(top), float(bottom), float(left), float(right))


def _pictures(known: Album, held_out: Album, *, recolour: bool) -> bytes:
    """The plane that pictures lie near to, and how far held-out ones are from it."""
    rows = np.array([shrunk(pixels) for pixels in _rows(known, SEEN, recolour=recolour)])
    middle = rows.mean(0)
    _, _, axes = np.linalg.svd(rows - middle, full_matrices=False)
    axes = axes[:AXES]
    apart = [
        distance_from(shrunk(pixels), middle, axes)
        for pixels in _rows(held_out, SEEN, recolour=recolour)
    ]
    file = BytesIO()
    np.savez_compressed(
        file,
        middle=middle.astype(np.float16),
        axes=axes.astype(np.float16),
        usual=np.float32(max(np.quantile(apart, USUAL), LEAST)),
    )
    return file.getvalue()


@torch.no_grad()
def _garments(model: GarmentVAE, known: Labelled) -> bytes:
    types = np.array(known.types)
    chosen = np.sort(
        np.concatenate(
            [np.flatnonzero(types == name)[:KNOWN_A_TYPE] for name in sorted(set(types))]
        )
    )
    parts = torch.from_numpy(chosen).split(256)
    latents = torch.cat([model.encode(known.rasters.batch(part).inputs())[0] for part in parts])
    file = BytesIO()
    np.savez_compressed(
        file,
        ids=np.array(known.ids)[chosen],
        types=types[chosen],
        latents=latents.numpy().astype(np.float16),
    )
    return file.getvalue()


def _onnx(model: nn.Module, example: Tensor, taken: str, given: str) -> bytes:
    """A network as an ONNX file for any number of examples, weights as 16-bit floats."""
    logging.getLogger("torch.onnx").setLevel(logging.ERROR)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # the exporter's own
        program = torch.onnx.export(
            model.eval(),
            (example,),
            dynamo=True,
            input_names=[taken],
            output_names=[given],
            opset_version=OPSET,
            dynamic_shapes=({0: torch.export.Dim("n")},),
            verbose=False,
        )
    assert program is not None
    return _halved(program.model_proto)


def _halved(model: Any) -> bytes:
    """The same network, its larger weights stored as float16 and cast when it is loaded.

    What the exporter notes at each node, such as paths of this machine, is left out.
    """
    from onnx import TensorProto, helper, numpy_helper

    graph = model.graph
    casts = []
    for weights in graph.initializer:
        if weights.data_type != TensorProto.FLOAT or np.prod(weights.dims) < 256:
            continue
        name, values = weights.name, numpy_helper.to_array(weights)
        weights.CopyFrom(numpy_helper.from_array(values.astype(np.float16), f"{name}_half"))
        casts.append(helper.make_node("Cast", [f"{name}_half"], [name], to=TensorProto.FLOAT))
    nodes = [*casts, *graph.node]
    for noted in (model, graph, *nodes, *graph.value_info, *graph.input, *graph.output):
        noted.ClearField("doc_string")
        noted.ClearField("metadata_props")
    del graph.node[:]
    graph.node.extend(nodes)
    return bytes(model.SerializeToString())
