"""Weights on disk: of this version only, and renamed once where they are of the one before."""

import json
import re
import sys
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file, save_file

from garmentimage.errors import LearnError
from garmentimage.learn.models.denoiser import Denoiser, DenoiserConfig
from garmentimage.learn.models.garment_vae import GarmentVAE, GarmentVAEConfig
from garmentimage.learn.models.image_decoder import ImageDecoder, ImageDecoderConfig
from garmentimage.learn.weights import WEIGHTS_CONTRACT, load_weights
from garmentimage.system import weights_hash

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from migrate_weights import migrate

OLD_NAMES = {
    "vae": [(r"^positions\.", "places."), (r"\.film\.", ".steer."), (r"^project\.", "up.")],
    "decoder": [(r"^stem\.", "take."), (r"^project\.", "narrow."), (r"^head\.", "give.")],
    "denoiser": [
        (r"^null_text$", "nothing"),
        (r"^conditioning\.", "told."),
        (r"^stem\.", "take."),
        (r"^head\.", "give."),
        (r"^positions$", "places"),
        (r"^levels\.downsample\.", "halve."),
        (r"^levels\.project\.", "narrow."),
        (r"^levels\.", ""),
    ],
}
"""Names of this version, and of the one before."""


def aged(folder: Path, name: str, fields: dict[str, str]) -> None:
    """Give a network the names of the version before."""
    config = json.loads((folder / "config.json").read_text())
    del config["weights_contract"]
    config = {fields.get(key, key): value for key, value in config.items()}
    (folder / "config.json").write_text(json.dumps(config))
    weights = load_file(folder / "model.safetensors")
    for now, before in [(r"^head\.", "decode_out."), *OLD_NAMES[name]]:
        if name == "vae" or before != "decode_out.":
            weights = {re.sub(now, before, key): value for key, value in weights.items()}
    save_file(weights, folder / "model.safetensors", {"format": "pt"})


@pytest.fixture
def old(tmp_path):
    """A VAE, its image decoder and a denoiser with old names, and their weights."""
    torch.manual_seed(0)
    vae = GarmentVAE(GarmentVAEConfig(channels=(16, 16, 16), latent=4))
    vae.save_pretrained(tmp_path / "vae")
    denoiser = Denoiser(DenoiserConfig(picture=16, text=4, channels=(8, 16), width=8))
    denoiser.save_pretrained(tmp_path / "denoiser")
    aged(tmp_path / "vae", "vae", {})
    aged(tmp_path / "denoiser", "denoiser", {"condition_dropout": "unsaid"})
    config = ImageDecoderConfig(4, 8, (16, 8), vae_sha256=weights_hash(tmp_path / "vae"))
    decoder = ImageDecoder(config)
    decoder.save_pretrained(tmp_path / "decoder")
    aged(tmp_path / "decoder", "decoder", {"latent_noise": "spread"})
    return {"decoder": decoder, "vae": vae, "denoiser": denoiser}


def test_networks_with_old_names_are_refused_in_a_sentence_that_names_the_script(old, tmp_path):
    with pytest.raises(LearnError, match=r"python scripts/migrate_weights\.py .*vae`"):
        load_weights(GarmentVAE, tmp_path / "vae")


def test_migrated_networks_have_the_same_weights_and_know_each_other(old, tmp_path):
    migrate([tmp_path / name for name in old])
    for name, model in old.items():
        again = load_weights(type(model), tmp_path / name)
        for key, value in model.state_dict().items():
            assert torch.equal(value, again.state_dict()[key]), key
        assert again.config.weights_contract == WEIGHTS_CONTRACT
    decoder = load_weights(ImageDecoder, tmp_path / "decoder")
    assert decoder.config.vae_sha256 == weights_hash(tmp_path / "vae")
    before = (tmp_path / "vae" / "model.safetensors").read_bytes()
    assert "already" in migrate([tmp_path / "vae"])[0]
    assert (tmp_path / "vae" / "model.safetensors").read_bytes() == before


def test_a_decoder_is_not_migrated_without_its_vae(old, tmp_path):
    with pytest.raises(LearnError, match="belongs to a VAE that is not among these folders"):
        migrate([tmp_path / "denoiser", tmp_path / "decoder"])
    with pytest.raises(LearnError, match=r"migrate_weights\.py"):
        load_weights(Denoiser, tmp_path / "denoiser")


def test_networks_of_a_later_version_are_refused(tmp_path):
    Denoiser(DenoiserConfig(picture=16, text=4, channels=(8, 16), width=8)).save_pretrained(
        tmp_path
    )
    config = json.loads((tmp_path / "config.json").read_text())
    (tmp_path / "config.json").write_text(json.dumps({**config, "weights_contract": 99}))
    with pytest.raises(LearnError, match="has weights of version 99, and this package reads 2"):
        load_weights(Denoiser, tmp_path)
