"""Networks of contract 2: turned panels, wraps and second sheets are learnt and come back."""

import numpy as np
import pytest
import torch
from hypothesis import given

from garmentimage.draft.kind import draft_pattern
from garmentimage.errors import DatasetError, LearnError
from garmentimage.latent.operations import interpolate
from garmentimage.latent.space import LatentSpace
from garmentimage.learn.data.rasters import (
    LabelledRasters,
    Rasters,
    column_rasters,
    rasters_from_channels,
)
from garmentimage.learn.export import export_vae
from garmentimage.learn.models.garment_vae import (
    GarmentVAE,
    GarmentVAEConfig,
    image_losses,
    network_inputs,
    output_channels,
)
from garmentimage.raster.channels import CONTRACT_2, PLAIN_LAYOUT, ChannelLayout
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.image import GarmentImage, mirrored_channels
from tests.images import images

SURE = 30.0
FOUR = ChannelLayout(CONTRACT_2, 4)
KINDS = {"tee": {}, "vest": {"pockets": "none"}, "pocket-skirt": {}}
"""Plain, with turned panels, with a second sheet."""


def rasters_of(image: GarmentImage, layout: ChannelLayout = FOUR) -> Rasters:
    channels = image.to_channels(2, layers=layout.layers)
    return rasters_from_channels(
        channels.reshape(1, layout.layers, 26, *channels.shape[1:]), layout
    )


def sure(inputs: torch.Tensor, layout: ChannelLayout = FOUR) -> torch.Tensor:
    flags, types, vectors = inputs.split([layout.flags, layout.types, layout.vectors], 1)
    return torch.cat([SURE * (2 * flags - 1), SURE * types, vectors], 1)


@pytest.fixture(scope="module")
def garments():
    return {kind: encode(draft_pattern(kind, **fixed), 16) for kind, fixed in KINDS.items()}


@pytest.fixture(scope="module")
def learnt(garments, tmp_path_factory):
    """A small network that knows three garments by heart, in a folder."""
    parts = [rasters_of(image) for image in garments.values() for _ in range(2)]
    known = Rasters(*(torch.cat(each) for each in zip(*map(_values, parts), strict=True)))
    torch.manual_seed(0)
    config = GarmentVAEConfig(
        channels=(32, 32, 32), latent=8, beta=0.0, channels_contract="garmentimage-2", layers=4
    )
    model = GarmentVAE(config).train()
    optimizer = torch.optim.AdamW(model.parameters(), 4e-3)
    for _ in range(250):
        optimizer.zero_grad()
        model(known)["loss"].backward()
        optimizer.step()
    folder = tmp_path_factory.mktemp("layers") / "model"
    names = tuple(name for name in KINDS for _ in range(2))
    ids = tuple(f"row-{k}" for k in range(6))
    facts = {"recipe": "d2", "seed": 0}
    export_vae(model, LabelledRasters(known, ids, names), facts, "#", folder)
    return folder


def _values(rasters: Rasters) -> list[torch.Tensor]:
    return list(vars(rasters).values())


@given(images(layers=2, grids=(4, 8)))
def test_a_plain_image_among_four_layers_comes_back_with_two_empty_ones(image):
    image = image.without_marks()
    seen = rasters_of(image)
    assert seen.layout == FOUR and seen.inputs().shape[1] == 104
    again = GarmentImage.from_channels(output_channels(sure(seen.inputs()))[0].numpy())
    assert not again.inside[2:].any() and not again.edge_type[2:].any()
    assert np.array_equal(again.inside[:2], image.inside)
    assert np.array_equal(again.edge_type[:2], image.edge_type)


@pytest.mark.parametrize("kind", KINDS)
def test_turned_panels_and_sheets_pass_through_what_networks_see(garments, kind):
    image = garments[kind].without_marks()
    channels = torch.from_numpy(image.to_channels(2, layers=4))[None]
    seen = rasters_of(image)
    assert torch.allclose(network_inputs(channels), seen.inputs(), atol=0.02)
    again = GarmentImage.from_channels(output_channels(sure(seen.inputs()))[0].numpy())
    layers = image.layers
    assert np.array_equal(again.turned[:layers], image.turned)
    assert np.array_equal(again.edge_type[:layers], image.edge_type)
    assert image.turned.any() == (kind == "vest") and (layers == 4) == (kind == "pocket-skirt")
    losses = image_losses(sure(seen.inputs()), seen, 3.0)
    assert all(float(value) < 1e-6 for value in losses.values())


def test_a_mirrored_raster_is_that_of_the_mirrored_channels(garments):
    channels = garments["vest"].to_channels(2, layers=4)
    found = rasters_of(GarmentImage.from_channels(mirrored_channels(channels[None])[0]))
    expected = rasters_of(garments["vest"]).mirrored()
    assert torch.equal(found.turned, expected.turned)
    assert torch.equal(found.inputs()[..., 1:], expected.inputs()[..., 1:])


def test_an_error_counts_the_same_whether_further_layers_are_empty_or_not_there(garments):
    two = ChannelLayout(CONTRACT_2, 2)
    losses = []
    for layout in (two, FOUR):
        truth = rasters_of(garments["vest"], layout)
        outputs = sure(truth.inputs(), layout)
        outputs[:, :2, 8] *= -1  # wrong in a row of cells, front and back
        losses.append(float(image_losses(outputs, truth, 3.0)["flags"]))
    assert losses[0] > 0.1 and losses[0] == pytest.approx(losses[1])


@pytest.mark.slow
def test_a_space_of_four_layers_gives_back_what_it_learnt(garments, learnt):
    space = LatentSpace(learnt)
    for image in garments.values():
        z = space.encode(image)
        found = GarmentImage.from_channels(space.decode_channels(z[None])[0])
        layers = image.layers
        assert (found.inside[:layers] == image.inside).mean() > 0.99
        assert (found.turned[:layers] == image.turned).mean() > 0.99
        assert (found.edge_type[:layers] == image.edge_type).mean() > 0.98
    way = interpolate(space, garments["tee"], garments["pocket-skirt"], 3)
    assert all(step.image is not None and step.image.layers == 4 for step in way)
    assert way[0].pattern is not None and way[-1].pattern is not None


def test_what_a_network_has_no_layers_for_is_told_with_the_remedy(garments):
    with pytest.raises(LearnError, match="contract 1 has two layers, not 4"):
        GarmentVAEConfig(layers=4)
    with pytest.raises(LearnError, match="has '3' layers"):
        GarmentVAEConfig(layers=3, channels_contract="garmentimage-2")
    bundled = LatentSpace.load()
    with pytest.raises(LearnError, match=r"second sheet of cloth \(4 layers\) and the network 2"):
        bundled.encode(garments["pocket-skirt"])
    with pytest.raises(LearnError, match=r"right side to wrong side.*--contract 2"):
        bundled.encode(garments["vest"])


@pytest.mark.slow
def test_a_configuration_with_other_layers_is_refused(tmp_path, learnt):
    text = (learnt / "config.json").read_text()
    for wrong, told in (('"layers": 3', "has '3' layers"), ('"layers": "x"', "has 'x' layers")):
        (tmp_path / "config.json").write_text(text.replace('"layers": 4', wrong))
        with pytest.raises(LearnError, match=f"config.json: {told}"):
            LatentSpace(tmp_path)


def test_garments_of_two_and_of_four_layers_are_read_from_one_dataset(garments):
    import pyarrow as pa

    rows = [
        image.to_channels(2).reshape(image.layers, 26, 16, 16).tolist()
        for image in garments.values()
    ]
    kind = pa.list_(pa.list_(pa.list_(pa.list_(pa.float32()))))
    column = pa.chunked_array([pa.array(rows, kind)])
    found = column_rasters(column, "data", FOUR)
    assert len(found) == 3 and found.layout == FOUR
    for number, image in enumerate(garments.values()):
        for one, other in zip(
            _values(found.batch(torch.tensor([number]))), _values(rasters_of(image)), strict=True
        ):
            assert torch.equal(one, other)
    with pytest.raises(DatasetError, match=r"second sheet of cloth .*--contract 2 --layers 4"):
        column_rasters(column, "data", PLAIN_LAYOUT)
    turned = column.slice(1, 1)
    with pytest.raises(DatasetError, match=r"panels that are turned.*--contract 2"):
        column_rasters(turned, "data", PLAIN_LAYOUT)
