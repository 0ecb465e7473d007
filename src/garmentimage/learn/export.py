"""A trained network as a latent space: what is used without torch."""

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

from garmentimage.explore.space import CONFIG, DECODER, ENCODER, GARMENTS
from garmentimage.files import write_together
from garmentimage.learn.garment_vae import GarmentVAE, from_channels, to_channels
from garmentimage.learn.rasters import INPUTS, Labelled

OPSET = 18
KNOWN_A_TYPE = 300
"""Garments of each type that a space knows by heart."""
WEIGHTS, CARD = "model.safetensors", "README.md"


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
    halves = {name: value.half().contiguous() for name, value in model.state_dict().items()}
    folder.mkdir(parents=True, exist_ok=True)
    write_together(
        {
            folder / CONFIG: json.dumps({**asdict(model.config), **facts}, indent=1) + "\n",
            folder / WEIGHTS: save(halves, {"format": "pt"}),
            folder / ENCODER: _onnx(
                _Encoder(model), torch.zeros(2, INPUTS, grid, grid), "channels", "z"
            ),
            folder / DECODER: _onnx(_Decoder(model), torch.zeros(2, latent), "z", "channels"),
            folder / GARMENTS: _garments(model, known),
            folder / CARD: card,
        }
    )


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
    """The same network with its larger weights stored as float16, cast when it is loaded."""
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
    del graph.node[:]
    graph.node.extend(nodes)
    return bytes(model.SerializeToString())
