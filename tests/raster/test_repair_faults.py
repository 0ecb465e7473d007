"""Channels as networks of others gave them, which repair once made other garments of."""

from pathlib import Path

import numpy as np
import pytest

import garmentimage as gi
from garmentimage.metrics.similarity import likeness
from garmentimage.raster.repair.repairer import LEVELS
from tests.corpus import unpacked

pytestmark = pytest.mark.corpus
FAULTS = "faults/faults.tar.xz"


@pytest.fixture(scope="module")
def faults(tmp_path_factory):
    return unpacked(FAULTS, tmp_path_factory.mktemp("faults"))


def folder(root: Path, kind: str) -> Path:
    return next(path for path in root.rglob(kind) if path.is_dir())


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("kind", [None, "shares"])
def test_shares_of_999_in_1000_are_the_garment_beside_them(faults, level, kind):
    files = sorted(folder(faults, "soft-shares").glob("*_shares999.npy"))
    assert files
    for file in files:
        truth = gi.load_pattern(file.with_name(file.name.replace("_shares999.npy", ".json")))
        found = gi.decode(np.load(file), repair=level, kind=kind)
        told = likeness(truth, found)
        assert len(found.panels) == len(truth.panels)
        assert told.topology
        assert told.panel_iou > 0.9  # bare channels of the second file hold no more


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("kind", [None, "channels"])
def test_outputs_of_squared_errors_are_decided_at_a_half(faults, level, kind):
    (file,) = folder(faults, "mse-outputs").glob("*.npy")
    channels = np.load(file)
    image, report = gi.repair(channels, level, kind=kind)
    assert image.inside.sum() == (channels[[0, 17]] > 0.5).sum() == 118
    assert report.kind == "channels"
    assert len(gi.decode(channels, repair=level, kind=kind).panels) == 6
    assert gi.load_image(file).same_channels(gi.GarmentImage.from_channels(channels))
