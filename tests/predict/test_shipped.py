"""The bundled networks."""

import pytest

from garmentimage.examples import example_picture
from garmentimage.predict.predictor import PatternPredictor, predictor_names

MOST_BYTES = 10_000_000


@pytest.mark.parametrize("name", predictor_names())
def test_a_shipped_network_makes_a_garment_of_the_bundled_picture(name):
    found = PatternPredictor.load(name).predict(example_picture())
    assert found.garment.pattern is not None and not found.garment.faults


def test_the_usual_network_finds_the_panels_and_seams_of_the_bundled_picture():
    found = PatternPredictor.load().predict(example_picture())
    assert found.is_sure and not found.photo.notes
    names = {panel.name for panel in found.garment.pattern.panels}
    parts = {f"{side}_{part}" for part in ("front", "back") for side in ("bodice", "skirt")}
    sleeves = {f"{side}_sleeve_{part}" for part in ("front", "back") for side in ("left", "right")}
    assert names == parts | sleeves


def test_shipped_networks_are_small():
    folders = [PatternPredictor.load(name).folder for name in predictor_names()]
    files = [file for folder in folders for file in folder.iterdir()]
    assert sum(file.stat().st_size for file in files) <= MOST_BYTES
    assert not any(file.suffix == ".safetensors" for file in files)
