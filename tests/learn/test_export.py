"""Networks on disk: the same with torch and without, and a sentence for invalid files."""

from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file

import garmentimage
from garmentimage.errors import LearnError
from garmentimage.latent.space import LatentSpace
from garmentimage.learn.data.rasters import read_rasters
from garmentimage.learn.export import export_vae
from garmentimage.learn.models.garment_vae import (
    GarmentVAE,
    GarmentVAEConfig,
    network_inputs,
    output_channels,
)
from garmentimage.learn.models.vector_vae import VectorVAE
from garmentimage.learn.weights import load_weights


@pytest.fixture(scope="module")
def made(data, tmp_path_factory):
    folder = tmp_path_factory.mktemp("network") / "model"
    torch.manual_seed(3)
    model = GarmentVAE(GarmentVAEConfig(channels=(16, 32, 32), latent=6)).eval()
    model = model.to(memory_format=torch.channels_last)  # as it is trained
    export_vae(
        model, read_rasters(data, "train"), {"recipe": "vae-topology", "seed": 0}, "#", folder
    )
    return model, folder


@pytest.mark.slow
def test_a_network_gives_the_same_with_torch_and_without(made):
    model, folder = made
    space = LatentSpace(folder)
    assert (space.grid, space.latent) == (16, 6)
    random = np.random.default_rng(0)
    channels = random.random((3, 34, 16, 16), np.float32)
    with torch.no_grad():
        z = model.encode(network_inputs(torch.from_numpy(channels)))[0].numpy()
        images = output_channels(model.decode(torch.from_numpy(z))).numpy()
    assert np.allclose(space.encode_channels(channels), z, atol=0.02)
    assert np.allclose(space.decode_channels(z), images, atol=0.05)
    assert np.allclose(space.encode_channels(channels[:1]), z[:1], atol=0.02)


@pytest.mark.slow
def test_a_space_knows_the_first_garments_of_each_type(made):
    _, folder = made
    known = LatentSpace(folder).garments
    assert len(known.ids) == len(set(known.ids)) == 24 and len(set(known.types)) == 3
    assert known.latents.shape == (24, 6) and np.isfinite(known.latents).all()


@pytest.mark.slow
def test_weights_are_read_for_training_on(made):
    model, folder = made
    again = load_weights(GarmentVAE, folder)
    assert again.config == model.config
    for ours, theirs in zip(model.parameters(), again.parameters(), strict=True):
        assert torch.allclose(ours, theirs, atol=1e-3) and theirs.dtype == torch.float32


@pytest.mark.slow
def test_what_is_no_network_is_told(made, tmp_path):
    _, folder = made
    with pytest.raises(LearnError, match="holds no network"):
        load_weights(GarmentVAE, tmp_path)
    with pytest.raises(LearnError, match="holds no VectorVAE that can be read"):
        load_weights(VectorVAE, folder)
    config = (folder / "config.json").read_text()
    (tmp_path / "config.json").write_text(config.replace("garmentimage-1", "other-9"))
    (tmp_path / "model.safetensors").write_bytes((folder / "model.safetensors").read_bytes())
    with pytest.raises(LearnError, match="made for channels 'other-9', and this version has"):
        load_weights(GarmentVAE, tmp_path)
    (tmp_path / "config.json").write_text(config)
    parts = load_file(folder / "model.safetensors")
    some = dict(list(parts.items())[1:])
    save_file(some, tmp_path / "model.safetensors")
    with pytest.raises(LearnError, match="holds no GarmentVAE that can be read"):
        load_weights(GarmentVAE, tmp_path)
    save_file(
        {name: part * torch.nan for name, part in parts.items()}, tmp_path / "model.safetensors"
    )
    with pytest.raises(LearnError, match="has NaN or infinite weights"):
        load_weights(GarmentVAE, tmp_path)
    (tmp_path / "model.safetensors").write_bytes(b"\x00" * 100)
    with pytest.raises(LearnError, match="holds no GarmentVAE that can be read"):
        load_weights(GarmentVAE, tmp_path)


@pytest.mark.slow
def test_exported_networks_tell_nothing_of_the_machine(made):
    _, folder = made
    shipped = Path(garmentimage.__file__).parent / "weights"
    found = [*folder.glob("*.onnx"), *shipped.glob("*/*.onnx")]
    assert len(found) >= 6
    for file in found:
        data = file.read_bytes()
        for path in (b"site-packages", b'.py"', str(Path.cwd()).encode()):
            assert path not in data, file
