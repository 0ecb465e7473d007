from dataclasses import replace

import pytest

from garmentimage.dataset.building import DATA, BuildSettings, make_shard, plan_shards
from garmentimage.dataset.recipe import load_recipe


@pytest.fixture(scope="session")
def data(tmp_path_factory):
    """A small dataset of `vae-topology`, without its summary."""
    folder = tmp_path_factory.mktemp("topology")
    (folder / DATA).mkdir()
    for shard in plan_shards(BuildSettings(load_recipe("vae-topology"), folder, 20)):
        few = replace(shard, places=shard.places[:24])
        (folder / DATA / shard.name).write_bytes(make_shard(few))
    return folder
