import importlib.util
from pathlib import Path

import numpy as np
import pytest

from garmentimage.examples import example_names, example_path
from garmentimage.pattern.files.spec import load_pattern, read_pattern

ROOT = Path(__file__).parents[2]
SEAM_TOL_CM = 1e-6


@pytest.mark.parametrize("name", example_names())
def test_examples_can_be_sewn_without_a_word(name):
    pattern, found = read_pattern(example_path(name))
    assert found == ()
    for stitch in pattern.stitches:
        a, b = (pattern.curve(side).length for side in stitch.sides)
        assert a == pytest.approx(b, abs=SEAM_TOL_CM), stitch


@pytest.mark.parametrize("name", example_names())
def test_examples_are_symmetric(name):
    points = np.concatenate([p.to_world(p.outline.polygon) for p in load(name).panels])
    mirrored = points * [-1, 1, 1]
    order, again = (np.lexsort(np.round(p, 6).T) for p in (points, mirrored))
    np.testing.assert_allclose(points[order], mirrored[again], atol=1e-5)


def load(name):
    return load_pattern(example_path(name))


def test_there_is_a_dress_a_darted_shirt_trousers_and_a_hole():
    assert example_names() == ("cutout_top", "darted_shirt", "dress", "trousers")
    darts = [s for s in load("darted_shirt").stitches if s.a.panel == s.b.panel]
    assert len(darts) == 6
    assert len(load("cutout_top").by_name["front"].holes) == 1
    assert all(p.grain == (0.0, 1.0) for p in load("cutout_top").panels)
    assert {"waistband_front", "waistband_back"} <= set(load("trousers").by_name)


def test_an_unknown_example_is_named():
    with pytest.raises(KeyError, match="no example 'tent'"):
        example_path("tent")


def test_examples_are_what_the_script_draws(tmp_path, monkeypatch):
    script = ROOT / "scripts" / "draw_examples.py"
    module_spec = importlib.util.spec_from_file_location("draw_examples", script)
    module = importlib.util.module_from_spec(module_spec)
    monkeypatch.setitem(__import__("sys").modules, "draw_examples", module)
    module_spec.loader.exec_module(module)
    drawn = {p.name: p for p in module.draw_all()}
    assert set(drawn) == set(example_names())
    for name, pattern in drawn.items():
        for ours, theirs in zip(pattern.panels, load(name).panels, strict=True):
            assert ours.name == theirs.name
            np.testing.assert_allclose(ours.outline.polygon, theirs.outline.polygon, atol=1e-6)
