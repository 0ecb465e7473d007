"""Golden files: what bundled patterns become, so that no change of it goes unseen.

`make golden` writes them anew. Look at the difference, and say in the commit why it is right.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from garmentimage import decode, encode, load_pattern, save_pattern
from garmentimage.examples import example_path
from garmentimage.pattern.files.svg import pattern_to_svg
from garmentimage.raster.channels import CHANNELS_PER_LAYER

GOLDEN = Path(__file__).parent / "golden"
TOLERANCE_CM = 1e-4
"""Of lengths that a solver finds, which differ in their last digits between machines."""


@pytest.fixture(scope="module")
def image():
    return encode(load_pattern(example_path("dress")), grid=16)


def assert_alike(found, expected, place="pattern"):
    """Equal JSON, with numbers to within the tolerance."""
    assert type(found) is type(expected), place
    if isinstance(expected, dict):
        assert list(found) == list(expected), place
        for key, value in expected.items():
            assert_alike(found[key], value, f"{place}.{key}")
    elif isinstance(expected, list):
        assert len(found) == len(expected), place
        for number, (one, other) in enumerate(zip(found, expected, strict=True)):
            assert_alike(one, other, f"{place}[{number}]")
    elif isinstance(expected, float):
        assert math.isclose(found, expected, abs_tol=TOLERANCE_CM), place
    else:
        assert found == expected, place


def test_the_raster_of_the_dress_is_the_golden_one(image, request):
    path, channels = GOLDEN / "dress_16.npz", image.to_channels()
    if request.config.getoption("--regold"):
        np.savez_compressed(path, channels=channels)
    with np.load(path) as archive:
        golden = archive["channels"]
    assert channels.shape == golden.shape and channels.dtype == golden.dtype
    found, expected = (c.reshape(2, CHANNELS_PER_LAYER, 16, 16) for c in (channels, golden))
    assert np.array_equal(found[:, :9], expected[:, :9])  # flags and types of grid edges
    np.testing.assert_allclose(found[:, 9:], expected[:, 9:], rtol=0, atol=TOLERANCE_CM)


def test_the_pattern_decoded_from_the_dress_is_the_golden_one(image, request, tmp_path):
    path = GOLDEN / "dress_16_decoded.json"
    save_pattern(decode(image), tmp_path / path.name)
    if request.config.getoption("--regold"):
        path.write_bytes((tmp_path / path.name).read_bytes())
    found, expected = (json.loads(file.read_text()) for file in (tmp_path / path.name, path))
    assert_alike(found, expected)


def test_the_svg_of_the_top_is_the_golden_one(request):
    path, svg = GOLDEN / "cutout_top.svg", pattern_to_svg(load_pattern(example_path("cutout_top")))
    if request.config.getoption("--regold"):
        path.write_text(svg, encoding="utf-8")
    assert svg == path.read_text(encoding="utf-8")
