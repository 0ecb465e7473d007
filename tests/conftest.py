import os
from dataclasses import replace

# Every process of the tests has a core; more threads than cores only wait for each other.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import pytest
from hypothesis import HealthCheck, settings

from tests.shape_checks import check_annotations, set_checks

# They take up to half as long again where a test is all small Python calls; 0 leaves them out.
if os.environ.get("GARMENTIMAGE_SHAPE_CHECKS", "1") != "0":
    check_annotations()

# Deadlines measure the machine, not the code, and so does the time that examples take to draw; the
# same examples on every run make failures repeat.
settings.register_profile(
    "garmentimage",
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("garmentimage")


SHARED = {"pictured", "trained"}
"""Fixtures that take minutes."""


def pytest_addoption(parser):
    parser.addoption("--regold", action="store_true", help="write the golden files anew")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """One process has all tests of a shared fixture, which is made there only."""
    for item in items:
        for name in SHARED.intersection(item.fixturenames):
            item.add_marker(pytest.mark.xdist_group(name))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """Annotations are not checked in tests marked `wrong_types` or `timed`."""
    set_checks(not any(item.get_closest_marker(name) for name in ("wrong_types", "timed")))
    try:
        return (yield)
    finally:
        set_checks(True)


def build_small(folder, recipe, *, train_rows, **settings):
    """A dataset with so many rows for training only, made in this process."""
    from garmentimage.dataset import building

    def few_shards(what):
        return tuple(
            replace(shard, places=shard.places[:train_rows]) if shard.split == "train" else shard
            for shard in plan_shards(what)
        )

    plan_shards = building.plan_shards
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(building, "plan_shards", few_shards)
        patch.setattr(
            building, "run_tasks", lambda do, tasks, *_: ((task, do(task)) for task in tasks)
        )
        building.build_dataset(building.BuildSettings(recipe, folder, 20, **settings))
    return folder


@pytest.fixture(scope="session")
def pictured(tmp_path_factory):
    """A small dataset of `d2`: pictures and patterns, some of a type not seen in training."""
    from garmentimage.dataset.recipe import load_recipe

    folder = tmp_path_factory.mktemp("d2")
    return build_small(folder, load_recipe("d2"), train_rows=36, unseen=4)


@pytest.fixture(scope="session")
def trained(tmp_path_factory):
    """A dataset of three types of `text-edit`, and its networks, trained for an epoch."""
    from garmentimage.cli.app import main
    from garmentimage.dataset.recipe import load_recipe

    folder = tmp_path_factory.mktemp("text-edit")
    recipe = load_recipe("text-edit")
    data = build_small(folder / "data", replace(recipe, types=recipe.types[:3]), train_rows=24)
    for name, words in {
        "vae": [],
        "pictures": ["--vae", folder / "vae" / "model"],
        "denoiser": [],
        "vector-vae": [],
        "vector-pictures": ["--vae", folder / "vector-vae" / "model"],
    }.items():
        network = "image-decoder" if name.endswith("pictures") else name
        words = [network, "--data", data, *words, "--epochs", 1, "--batch", 8, "-o", folder / name]
        assert main(["train", *map(str, words)]) == 0
    return folder
