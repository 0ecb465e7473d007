"""Rows: the same for ever, and true to what they were drafted from."""

import json
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from garmentimage.dataset.recipe import load_recipe, recipe_names
from garmentimage.dataset.row import FailedRow, RowTask, make_row
from garmentimage.dataset.vocabulary import captions
from garmentimage.draft.kind import KINDS, draft_pattern
from garmentimage.draft.sampling import sample
from garmentimage.pattern.files.spec import pattern_from_spec
from garmentimage.raster.encode.encoder import encode

GRID = 16


def task(name="d2", type_number=0, index=0, seed=0):
    return RowTask(load_recipe(name), seed, GRID, type_number, index)


def good_row(name="d2", type_number=0, seed=0):
    rows = (make_row(task(name, type_number, k, seed)) for k in range(5))
    return next(row for row in rows if not isinstance(row, FailedRow))


def same(one, other) -> bool:
    raster = np.array_equal(one["raster"], other["raster"])
    plain = ({k: v for k, v in row.items() if k != "raster"} for row in (one, other))
    return raster and next(plain) == next(plain)


@pytest.mark.slow
def test_a_row_is_the_same_whatever_was_made_before():
    first = good_row("text-edit", 1)
    good_row("text-edit", 0)
    good_row("wild", 5)
    assert same(first, good_row("text-edit", 1))


def test_other_seeds_types_and_numbers_give_other_garments():
    rows = [good_row(), good_row(seed=1), good_row(type_number=1)]
    shapes = [json.loads(row["parameters"])["body_length"] for row in rows]
    assert len(set(shapes)) == 3
    seeds = {task(name, k).garment_seed for name in recipe_names() for k in range(3)}
    assert len(seeds) == 3 * len(recipe_names())
    assert all(0 <= seed < 2**63 for seed in seeds)


def test_the_pattern_of_a_row_encodes_to_its_raster():
    row = good_row("vae-darts", 2)
    image = encode(pattern_from_spec(json.loads(row["pattern"])), GRID)
    np.testing.assert_array_equal(row["raster"].reshape(-1, GRID, GRID), image.to_channels(2))
    assert row["raster"].shape == (2, 26, GRID, GRID) and row["raster"].dtype == np.float32


def test_the_parameters_of_a_row_draft_its_pattern():
    row = good_row()
    again = draft_pattern(row["kind"], row["body"], **json.loads(row["parameters"]))
    found = pattern_from_spec(json.loads(row["pattern"]))
    for one, other in zip(again.panels, found.panels, strict=True):
        np.testing.assert_allclose(one.outline.vertices, other.outline.vertices, atol=1e-6)
    assert load_recipe("d2").types[0].fixed.items() <= json.loads(row["parameters"]).items()


def test_pictures_have_the_colours_and_the_size_of_the_recipe():
    row = good_row("d2", 2)
    picture = np.asarray(Image.open(BytesIO(row["pictures"]["front"])).convert("RGB")).astype(int)
    mask = np.asarray(Image.open(BytesIO(row["panels"])))
    assert picture.shape == (128, 128, 3) and mask.shape == (128, 128)
    garment = pattern_from_spec(json.loads(row["pattern"]))
    assert set(np.unique(mask)) <= set(range(len(garment.panels) + 2))
    is_bottom = [p.name for p in garment.panels if "trouser" in p.name]
    bottom = [2 + k for k, p in enumerate(garment.panels) if p.name in is_bottom]
    inside = np.isin(mask, bottom)
    assert inside.sum() > 200
    red, _, blue = picture[inside].mean(axis=0)
    assert blue > red, "trousers of this recipe are light blue"
    top = (mask > 1) & ~inside
    red, _, blue = picture[top].mean(axis=0)
    assert red > blue, "tops of this recipe are brown"


def test_recipes_without_views_drape_nothing():
    assert not {"pictures", "panels", "report"} & good_row("vae-topology").keys()
    report = json.loads(good_row()["report"])
    assert report["settled"] and report["faults"] == [] and "seconds" not in report


def test_a_row_that_cannot_be_made_says_at_which_stage_and_why():
    fails = make_row(replace(task(), grid=4))
    assert isinstance(fails, FailedRow)
    assert (fails.row_id, fails.stage) == ("d2-00-0000000", "encode") and "grid" in fails.reason


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_captions_for_all_its_parameters(kind):
    for made in sample(kind, 30, 4):
        found = captions(kind, made.parameters)
        assert len(found) == 3
        assert all(text and text == text.strip() and "  " not in text for text in found)
        assert len(found[0]) >= len(found[1]) >= len(found[2])


def test_captions_say_what_the_parameters_are():
    drawn = {"sleeves": "set-in", "sleeve_length": 1.0, "sleeve_taper": -0.1, "neckline": "v",
             "body_length": 78.0, "flare": 0.4, "cutout": "back"}  # fmt: skip
    assert captions("one-panel-dress", drawn)[0] == (
        "a maxi wide dress with long flared sleeves, a V-neckline and a hole in the back"
    )
    assert captions("pants", {"leg_length": 0.2, "leg_flare": 2.0}) == (
        "short-legged straight-legged trousers", "short-legged trousers", "trousers",
    )  # fmt: skip
