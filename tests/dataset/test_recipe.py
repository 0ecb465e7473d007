"""Recipes: what a dataset holds, and which rows are for what."""

from collections import Counter

import pytest

from garmentimage.dataset.recipe import SHARES, SPLITS, load_recipe, parse_recipe, recipe_names
from garmentimage.draft.sampling import sample
from garmentimage.errors import DatasetError

OURS = {"leave-one-out", "wild"}
PAPER = {"vae-topology", "vae-variety", "vae-darts", "text-edit", "d1", "d2"}
GOOD = """
name = "small"
version = 1
doc = "Two types."
bodies = ["mean-female"]
fabrics = ["cotton"]
views = ["front"]
picture = 64
presets = { laptop = 10 }

[[types]]
name = "tank"
kind = "tank"
fixed = { neckline = "v" }

[[types]]
name = "skirt"
kind = "skirt"
seen = false
"""


def test_the_recipes_of_the_paper_and_ours_are_there():
    assert set(recipe_names()) == PAPER | OURS


@pytest.mark.parametrize("name", sorted(PAPER | OURS))
def test_every_recipe_drafts_its_types_and_calls_itself_by_its_file(name):
    found = load_recipe(name)
    assert found.name == name and found.version >= 1 and found.doc.endswith(".")
    assert {"paper", "laptop"} <= found.presets.keys()
    for each in found.types:
        (made,) = sample(each.kind, 1, body=found.bodies[0], fixed=each.fixed)
        assert all(made.parameters[key] == value for key, value in each.fixed.items())


def test_types_of_a_recipe_differ():
    for name in recipe_names():
        kinds = [(each.kind, tuple(each.fixed.items())) for each in load_recipe(name).types]
        assert len(set(kinds)) == len(kinds)


def test_what_is_kept_out_of_the_papers_sets_is_unseen():
    unseen = {n: [t.name for t in load_recipe(n).types if not t.seen] for n in recipe_names()}
    assert unseen["d1"] == unseen["vae-topology"] == ["top + skirt"]
    assert unseen["d2"] == ["top with sleeves + pants"]


def test_rows_keep_their_split_in_a_larger_dataset_and_all_splits_have_their_share():
    small = parse_recipe(GOOD)
    seen, unseen = small.types
    splits = [small.split(seen, k) for k in range(1000)]
    assert {name: n / 1000 for name, n in Counter(splits).items()} == dict(
        zip(SPLITS, SHARES, strict=False)  # unseen has no share
    )
    assert {small.split(unseen, k) for k in range(100)} == {"unseen"}


def test_bodies_for_test_are_never_trained_on():
    wild = load_recipe("wild")
    assert not set(wild.wearers("train")) & set(wild.wearers("test"))
    assert wild.wearers("test") == wild.wearers("unseen")
    assert load_recipe("d2").wearers("test") == load_recipe("d2").wearers("train")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('"tank"\nkind = "tank"', '"tank"\nkind = "tnak"', "no kind 'tnak'; did you mean tank"),
        ("neckline", "neklin", "no parameter 'neklin'"),
        ('"v"', '"heart"', "neckline"),
        ('["cotton"]', '["coton"]', "no fabric 'coton'; did you mean cotton"),
        ('["mean-female"]', '["mean"]', "no body 'mean'"),
        ('["front"]', '["top"]', "no view 'top'"),
        ("picture = 64", "picture = 5", "pictures of 5 pixels; give 16 to 1024"),
        ("version = 1", 'version = "x"', "version of the recipe is 'x'; give a whole number there"),
        ("version = 1", "version = true", "give a whole number"),
        ("version = 1", "version = 0", "version of the recipe is 0; give 1 to"),
        ("version = 1", f"version = {'9' * 5000}", "a number too long"),
        ("picture = 64", "picture = inf", "give a whole number"),
        ('views = ["front"]', 'views = "front"', "give a list there"),
        ('views = ["front"]', "views = [1]", "view of the recipe is '1'; give text"),
        ('doc = "Two types."\n', "", "lacks doc"),
        ("picture = 64", "pictures = 64", "has no 'pictures'; did you mean picture"),
        ('name = "skirt"', 'name = "tank"', "two types of the recipe have one name"),
        ("presets", 'colours = { top = "nope" }\npresets', "is not a colour"),
        ("presets", 'test_bodies = ["mean-female"]\npresets', "must differ from its bodies"),
        ('name = "small"', "name =", "is not TOML"),
    ],
)
def test_an_invalid_recipe_is_refused_in_a_sentence(old, new, sentence):
    assert old in GOOD
    with pytest.raises(DatasetError, match=sentence):
        parse_recipe(GOOD.replace(old, new))


def test_an_unknown_recipe_is_refused_with_a_suggestion():
    with pytest.raises(DatasetError, match="no recipe 'd3'; choose d1, d2"):
        load_recipe("d3")
