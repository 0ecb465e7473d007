"""The channel contract: what each of the 17 channels of a layer holds."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from garmentimage.compare import compare_patterns
from garmentimage.draft import draft_pattern
from garmentimage.errors import ImageError
from garmentimage.raster.decode import decode
from garmentimage.raster.encode import encode
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType, GarmentImage
from tests.images import images


def one_cell(grid=16):
    """Cell (row 2, column 5) of the back, with a side-by-side left and an open bottom edge."""
    inside = np.zeros((2, grid, grid), bool)
    inside[1, 2, 5] = True
    edge_type = np.zeros((2, 2, grid, grid), np.int8)
    edge_type[1, 0, 2, 5] = EdgeType.NON_STITCH
    edge_type[1, 1, 2, 5] = EdgeType.SIDE_BY_SIDE
    deformation = np.zeros((2, 4, 2, grid, grid), np.float32)
    deformation[1, :, :, 2, 5] = [[10, 1], [2, 11], [12, 3], [4, 13]]  # bottom, right, top, left
    return GarmentImage(inside, edge_type, deformation, BodyFrame.standard(grid))


def test_channels_are_flag_then_types_then_vectors_front_first():
    channels = one_cell().to_channels()
    assert channels.shape == (34, 16, 16)
    assert channels.dtype == np.float32
    cell = [1, 0, 1, 0, 0, 0, 0, 0, 1, 10, 1, 2, 11, 12, 3, 4, 13]
    assert channels[17:, 2, 5].tolist() == cell
    elsewhere = [0, 1, 0, 0, 0, 1, 0, 0, 0] + [0] * 8
    assert channels[17:, 3, 5].tolist() == elsewhere
    assert channels[:17, 2, 5].tolist() == elsewhere


def test_an_image_is_printed_in_one_short_line():
    shown = repr(replace(one_cell(), name="dress"))
    assert shown == "GarmentImage('dress', 16 x 16, 2 layers, 1 cells inside)"


@given(images())
def test_channels_out_and_in_give_the_same_image(image):
    assert GarmentImage.from_channels(image.to_channels(), like=image) == image
    assert GarmentImage.from_channels(image.to_channels()).same_channels(image)


@given(images())
def test_probabilities_and_logits_of_the_types_are_decided_as_the_types(image):
    channels = image.to_channels().astype(float)
    block = channels.reshape(image.layers, 17, image.grid, image.grid)
    soft, logits = block.copy(), block.copy()
    soft[:, 1:9] = 0.1 + 0.6 * soft[:, 1:9]
    soft[:, 0] = 0.2 + 0.6 * soft[:, 0]
    logits[:, 1:9] = -7 + 3 * logits[:, 1:9]
    for values in (soft, logits):
        again = GarmentImage.from_channels(values.reshape(channels.shape))
        assert again.same_channels(image)


def test_deformation_outside_is_forgotten():
    channels = one_cell().to_channels()
    channels[9:17] = 5
    assert GarmentImage.from_channels(channels).same_channels(one_cell())


@given(images())
def test_an_image_without_marks_has_the_same_channels_and_nothing_else(image):
    bare = image.without_marks()
    assert bare.same_channels(image)
    assert (bare.marks, bare.name) == ((), "")
    assert bare.frame == BodyFrame.standard(image.grid)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros((33, 16, 16)), "33 channels"),
        (np.zeros((0, 16, 16)), "0 channels"),
        (np.zeros((34, 16, 15)), "(34, 16, 15)"),
        (np.zeros((34, 2, 2)), "grid of 2"),
        (np.zeros((34, 16)), "(34, 16)"),
        (np.full((34, 16, 16), np.nan), "not finite"),
        ([["a"]], "not an array of numbers"),
    ],
)
@pytest.mark.wrong_types
def test_what_are_no_channels_is_refused_with_the_reason(array, words):
    with pytest.raises(ImageError) as caught:
        GarmentImage.from_channels(array)
    assert words in str(caught.value)


def test_a_template_of_another_size_is_refused():
    with pytest.raises(ImageError, match="`like`"):
        GarmentImage.from_channels(one_cell(16).to_channels(), like=one_cell(8))


def test_arrays_that_do_not_fit_each_other_are_refused():
    image = one_cell()
    with pytest.raises(ImageError, match="shapes"):
        GarmentImage(image.inside, image.edge_type, image.deformation, BodyFrame.standard(8))
    with pytest.raises(ImageError, match="layer names"):
        GarmentImage(image.inside, image.edge_type, image.deformation, image.frame, ("front",))


def test_channels_may_come_layer_by_layer():
    image = one_cell()
    layers = image.to_channels().reshape(2, 17, 16, 16)
    assert GarmentImage.from_channels(layers).same_channels(image)
    with pytest.raises(ImageError, match=r"channels have shape \(2, 16, 16, 16\)"):
        GarmentImage.from_channels(layers[:, :16])


@pytest.mark.parametrize("name", ["one-panel-dress", "hoodie", "blazer"])
def test_arrays_of_all_garments_are_alike_with_two_sheets(name):
    image = encode(draft_pattern(name), 16)
    channels = image.to_channels(2, layers=4)
    assert channels.shape == (104, 16, 16)
    size = len(image.to_channels(2))
    assert (channels[:size] == image.to_channels(2)).all()
    assert GarmentImage.from_channels(channels).inside[image.layers :].sum() == 0
    result = compare_patterns(decode(image.without_marks()), decode(channels), any_pose=True)
    assert result.success, result.reasons


def test_an_array_of_fewer_layers_than_the_image_is_refused():
    image = encode(draft_pattern("blazer"), 16)
    with pytest.raises(ImageError, match="an array of 2 does not hold it"):
        image.to_channels(2, layers=2)
