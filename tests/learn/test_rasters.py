"""Rasters for networks: nothing is lost on the way there and back."""

import numpy as np
import pytest
import torch
from hypothesis import given

from garmentimage.compare import match_panels
from garmentimage.draft.sampling import sample
from garmentimage.errors import DatasetError
from garmentimage.learn.data.rasters import (
    Rasters,
    mirrored_flags,
    mirrored_types,
    mirrored_vectors,
    rasters_from_channels,
    read_rasters,
)
from garmentimage.learn.models.garment_vae import (
    FLAGS,
    TYPES,
    image_losses,
    network_inputs,
    output_channels,
)
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.image import GarmentImage, mirrored_channels
from tests.images import images

SURE = 30.0


def rasters_of(image: GarmentImage) -> Rasters:
    channels = image.to_channels()
    return rasters_from_channels(channels.reshape(1, 2, 17, image.grid, image.grid))


def sure(inputs: torch.Tensor) -> torch.Tensor:
    """What a network gives that is sure of an image."""
    flags, types, vectors = inputs.split([FLAGS, TYPES, inputs.shape[1] - FLAGS - TYPES], 1)
    return torch.cat([SURE * (2 * flags - 1), SURE * types, vectors], 1)


@given(images(layers=2, grids=(4, 8, 16)))
def test_what_a_network_is_sure_of_is_the_image_it_saw(image):
    image = image.without_marks()
    seen = rasters_of(image).inputs()
    channels = torch.from_numpy(image.to_channels())[None]
    assert torch.allclose(network_inputs(channels), seen, atol=0.02)
    told = output_channels(sure(network_inputs(channels)))[0].numpy()
    again = GarmentImage.from_channels(told)
    assert np.array_equal(again.inside, image.inside)
    assert np.array_equal(again.edge_type, image.edge_type)
    assert np.allclose(again.deformation, image.deformation, atol=1e-3)


@given(images(layers=2, grids=(4, 8, 16)))
def test_a_network_that_is_sure_and_right_loses_nothing(image):
    truth = rasters_of(image.without_marks())
    losses = image_losses(sure(truth.inputs()), truth, 3.0)
    assert all(float(value) < 1e-6 for value in losses.values())


def test_rasters_of_a_split_are_those_of_its_rows(data):
    found = read_rasters(data, "train")
    assert len(found.ids) == len(found.types) == len(found.rasters) == 24
    assert found.rasters.grid == 16 and found.rasters.vectors.dtype == torch.float16
    part = found.rasters.batch(torch.tensor([3]))
    assert torch.equal(part.inside[0], found.rasters.inside[3])
    with pytest.raises(DatasetError, match="there is no split 'tests'"):
        read_rasters(data, "tests")


@given(images(layers=2, grids=(4, 8, 16)))
def test_mirrored_maps_are_those_of_the_mirrored_raster(image):
    truth = rasters_of(image.without_marks())
    flags, types, vectors = truth.inputs().split([FLAGS, TYPES, 16], 1)
    found = torch.cat([mirrored_flags(flags), mirrored_types(types), mirrored_vectors(vectors)], 1)
    expected = truth.mirrored().inputs()
    assert torch.equal(found[..., 1:], expected[..., 1:])  # nothing tells the first left edges


@given(images(layers=2, grids=(4, 8, 16)))
def test_mirrored_channels_are_those_of_the_mirrored_raster(image):
    image = image.without_marks()
    channels = mirrored_channels(image.to_channels()[None])[0]
    found = rasters_of(GarmentImage.from_channels(channels)).inputs()
    assert torch.equal(found[..., 1:], rasters_of(image).mirrored().inputs()[..., 1:])


@pytest.mark.parametrize("kind", ["one-panel-dress", "top-pants"])
def test_a_mirrored_raster_is_that_of_the_mirrored_garment(kind):
    for made in sample(kind, 3, 3):
        image = encode(made.pattern)
        raster = rasters_of(image)
        mirrored = raster.mirrored()
        twice = mirrored.mirrored()
        assert all(
            torch.equal(a, b)
            for a, b in zip(vars(twice).values(), vars(raster).values(), strict=True)
        )
        found = decode(output_channels(sure(mirrored.inputs()))[0].numpy())
        there = decode(output_channels(sure(raster.inputs()))[0].numpy())
        assert match_panels(there, found, any_pose=True).mean_iou > 0.998
        wide = [[p.to_world(np.array(p.outline.vertices))[:, 0] for p in g.panels]
                for g in (there, found)]  # fmt: skip
        left, right = (np.concatenate(each) for each in wide)
        assert left.min() == pytest.approx(-right.max(), abs=1.5)
