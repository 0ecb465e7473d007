"""Streaming rows into PyTorch: every row once, on any number of workers."""

import numpy as np
import pytest
import torch

from garmentimage.dataset.building import DATA, BuildSettings, make_shard, plan_shards
from garmentimage.dataset.stream import RowStream
from garmentimage.errors import DatasetError
from tests.dataset.test_build import SMALL, WITH_PICTURES


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("set")
    (place / DATA).mkdir()
    for shard in plan_shards(BuildSettings(SMALL, place, 130)):
        if shard.name.startswith(("train", "unseen")):
            (place / DATA / shard.name).write_bytes(make_shard(shard))
    return place


def ids(stream, **options) -> list[str]:
    loader = torch.utils.data.DataLoader(stream, batch_size=None, **options)
    return [row["id"] for row in loader]


@pytest.mark.slow
def test_every_row_comes_once_on_any_number_of_workers(folder):
    stream = RowStream(folder, columns=["id"])
    alone = ids(stream)
    assert len(set(alone)) == len(alone) == 118
    assert sorted(ids(stream, num_workers=2)) == sorted(alone)


@pytest.mark.slow
def test_a_seed_gives_an_order_and_each_epoch_another(folder):
    stream = RowStream(folder, columns=["id"], seed=3)
    first = ids(stream)
    assert ids(stream) == first != sorted(first)
    stream.set_epoch(1)
    assert ids(stream) != first and sorted(ids(stream)) == sorted(first)


@pytest.mark.slow
def test_rasters_are_tensors_and_types_can_be_left_out(folder):
    row = next(iter(RowStream(folder, columns=["raster", "captions"])))
    assert row["raster"].shape == (2, 26, 16, 16) and row["raster"].dtype == torch.float32
    assert len(row["captions"]) == 3 and set(row) == {"raster", "captions"}
    assert not list(RowStream(folder, without=["tank"]))
    assert len(list(RowStream(folder, "unseen", columns=["id"], only=["skirt"]))) == 130


@pytest.mark.slow
def test_pictures_are_tensors_of_bytes(tmp_path):
    (tmp_path / DATA).mkdir()
    (shard,) = [
        s
        for s in plan_shards(BuildSettings(WITH_PICTURES, tmp_path, 20))
        if s.name.startswith("test")
    ]
    (tmp_path / DATA / shard.name).write_bytes(make_shard(shard))
    row = next(iter(RowStream(tmp_path, "test")))
    assert row["picture_front"].shape == (3, 64, 64) and row["picture_front"].dtype == torch.uint8
    assert row["panels"].shape == (64, 64)
    assert set(np.unique(row["panels"].numpy())) >= {0, 1, 2}


def test_missing_splits_columns_and_types_are_refused(tmp_path, folder):
    with pytest.raises(DatasetError, match="has no split 'train'; `garmentimage build`"):
        RowStream(tmp_path)
    with pytest.raises(DatasetError, match="has no column 'picture'"):
        RowStream(folder, columns=["picture"])


@pytest.mark.wrong_types
def test_invalid_types_and_seeds_are_refused(folder):
    for options, sentence in (
        ({"without": "skirt"}, r"given as a list, \['skirt'\]"),
        ({"without": ["skrit"]}, "has no type 'skrit'"),
        ({"only": [5]}, "has no type 5"),
        ({"seed": -1}, "seed is -1"),
    ):
        with pytest.raises(DatasetError, match=sentence):
            RowStream(folder, **options)
