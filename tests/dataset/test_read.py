"""Reading datasets: the rows asked for, and a sentence for what is damaged."""

import numpy as np
import pytest

from garmentimage.dataset.building import DATA, BuildSettings, make_shard, plan_shards
from garmentimage.dataset.read import raster_arrays, read_tables, rows_at, shard_files
from garmentimage.errors import DatasetError
from tests.dataset.test_build import SMALL


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("set")
    (place / DATA).mkdir()
    for shard in plan_shards(BuildSettings(SMALL, place, 21)):
        (place / DATA / shard.name).write_bytes(make_shard(shard))
    return place


def test_rows_are_read_by_number_over_all_shards(folder):
    every = [row for table in read_tables(folder, None, ["id"]) for row in table["id"].to_pylist()]
    numbers = [0, len(every) - 1, len(every) // 2]
    assert [row["id"] for row in rows_at(folder, numbers)] == [every[k] for k in sorted(numbers)]
    with pytest.raises(DatasetError, match=f"has {len(every)} rows"):
        rows_at(folder, [len(every)])


def test_rasters_are_those_of_the_rows(folder):
    for table in read_tables(folder, None, ["raster"]):
        found = [np.array(row, np.float32) for row in table["raster"].to_pylist()]
        assert all(map(np.array_equal, raster_arrays(table["raster"]), found))


def test_what_cannot_be_read_is_named(folder, tmp_path):
    with pytest.raises(DatasetError, match="there is no split 'training'; choose train"):
        shard_files(folder, "training")
    with pytest.raises(DatasetError, match="has no column 'picture'"):
        next(read_tables(folder, "train", ["picture"]))
    (tmp_path / DATA).mkdir()
    with pytest.raises(DatasetError, match="has no shards"):
        shard_files(tmp_path)
    raw = shard_files(folder, "train")[0].read_bytes()
    (tmp_path / DATA / "train-00000-of-00001.parquet").write_bytes(raw[: len(raw) // 2])
    with pytest.raises(DatasetError, match=r"of-00001\.parquet: cannot be read"):
        next(read_tables(tmp_path, "train"))
