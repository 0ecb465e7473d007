"""Building: the same rows whoever makes them, nothing twice, nothing half-written."""

import hashlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from garmentimage.cli.app import main
from garmentimage.dataset.building import (
    DATA,
    BuildSettings,
    build_dataset,
    make_shard,
    plan_shards,
)
from garmentimage.dataset.engine import run_tasks
from garmentimage.dataset.overview import read_summary, row_sheet
from garmentimage.dataset.recipe import load_recipe, parse_recipe
from garmentimage.dataset.row import FailedRow
from garmentimage.dataset.shard import parse_metadata, shard_bytes
from garmentimage.errors import DatasetError, OutputError
from garmentimage.system.files import write_atomically
from tests.dataset.test_recipe import GOOD

SMALL = parse_recipe(GOOD.replace('views = ["front"]', "views = []"))
WITH_PICTURES = parse_recipe(GOOD)


def small(folder, count=120, **changes) -> BuildSettings:
    return BuildSettings(SMALL, folder, count, **changes)


def digests(folder: Path) -> dict[str, str]:
    return {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted((folder / DATA).iterdir())
    }


def test_a_plan_holds_every_row_once_in_its_split():
    shards = plan_shards(BuildSettings(load_recipe("d2"), Path("x"), 1000))
    tasks = [task for shard in shards for task in shard.tasks]
    assert len({task.row_id for task in tasks}) == len(tasks) == 4000
    assert all(shard.name.startswith(f"{t.split}-") for shard in shards for t in shard.tasks)
    rows = Counter(task.split for task in tasks)
    assert rows == {"train": 2700, "validation": 150, "test": 150, "unseen": 1000}


def test_types_for_test_only_may_have_fewer_rows():
    many, few = (BuildSettings(load_recipe("d2"), Path("x"), 1000, unseen=n) for n in (None, 40))
    shards = plan_shards(few)
    rows = Counter(task.split for shard in shards for task in shard.tasks)
    assert rows == {"train": 2700, "validation": 150, "test": 150, "unseen": 40}
    seen = [shard.identity() for shard in shards if not shard.name.startswith("unseen")]
    assert seen == [s.identity() for s in plan_shards(many) if not s.name.startswith("unseen")]
    with pytest.raises(DatasetError, match="0 rows a type"):
        plan_shards(BuildSettings(load_recipe("d2"), Path("x"), 1000, unseen=0))


def test_a_folder_with_fewer_unseen_rows_is_another_dataset(tmp_path):
    folder = tmp_path / "set"
    folder.mkdir()
    what = BuildSettings(SMALL, folder, 20, unseen=1)
    (folder / "build.json").write_text(json.dumps(what.identity()))
    with pytest.raises(DatasetError, match="dataset of unseen '1', not None"):
        build_dataset(BuildSettings(SMALL, folder, 20))


def test_a_shard_has_the_same_bytes_every_time_and_tells_what_failed():
    (shard,) = [s for s in plan_shards(small(Path("x"), 20)) if s.name.startswith("validation")]
    assert make_shard(shard) == make_shard(shard)
    failed = FailedRow("id", "drape", "too tight")
    raw = shard_bytes(SMALL, 16, [], [failed], shard.identity())
    facts = parse_metadata(pq.read_schema(BytesIO(raw)))
    assert facts.failed == (failed,) and facts.identity == shard.identity()
    assert facts.types == tuple(each.name for each in SMALL.types)
    with pytest.raises(DatasetError, match="not a shard"):
        parse_metadata(pa.schema([]))


@pytest.mark.slow
def test_one_worker_and_two_make_the_same_dataset_and_a_third_call_makes_nothing(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    build_dataset(small(one), workers=1)
    summary = build_dataset(small(two), workers=2)
    assert digests(one) == digests(two)
    assert summary == read_summary(two)
    assert summary["rows"] + sum(summary["failed"].values()) == 240
    assert {n: s["sha256"] for n, s in summary["shards"].items()} == digests(two)
    fresh = []
    build_dataset(small(two), progress=lambda done, made_now: fresh.append(made_now))
    assert fresh and not any(fresh)


@pytest.mark.slow
def test_workers_of_another_scheduler_make_the_same_rows(tmp_path):
    from distributed import LocalCluster

    build_dataset(small(tmp_path / "here", 40), workers=1)
    with LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        build_dataset(small(tmp_path / "there", 40), scheduler=cluster.scheduler_address)
    assert digests(tmp_path / "here") == digests(tmp_path / "there")


@pytest.mark.slow
def test_a_full_disk_keeps_what_was_finished(tmp_path, monkeypatch):
    written = []

    def full(path, data):
        if written:
            raise OutputError(f"{path}: cannot be written (No space left on device)")
        written.append(path)
        write_atomically(path, data)

    build_dataset(small(tmp_path / "whole", 40), workers=1)
    (tmp_path / "set").mkdir()
    what = small(tmp_path / "set", 40)
    (tmp_path / "set" / "build.json").write_text(json.dumps(what.identity()))
    monkeypatch.setattr("garmentimage.dataset.building.write_atomically", full)
    with pytest.raises(OutputError, match="No space left"):
        build_dataset(what, workers=1)
    monkeypatch.undo()
    assert len(digests(tmp_path / "set")) == 1
    build_dataset(what, workers=1)
    assert digests(tmp_path / "set") == digests(tmp_path / "whole")


@pytest.mark.slow
def test_a_killed_build_is_resumed(tmp_path):
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    build_dataset(small(whole))
    code = f"""
from pathlib import Path
from tests.dataset.test_build import build_dataset, small
if __name__ == "__main__":
    build_dataset(small(Path({str(cut)!r})), workers=1)
"""
    script = tmp_path / "run.py"
    script.write_text(code)
    places = [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, places))}
    driver = subprocess.Popen([sys.executable, str(script)], env=env, start_new_session=True)
    try:
        limit = time.monotonic() + 120
        while not list((cut / DATA).glob("*.parquet")) and driver.poll() is None:
            assert time.monotonic() < limit
            time.sleep(0.05)
    finally:
        if driver.poll() is None:
            os.killpg(driver.pid, signal.SIGKILL)
        driver.wait()
    left = digests(cut)
    assert left.items() <= digests(whole).items(), "only whole shards are there"
    build_dataset(small(cut))
    assert digests(cut) == digests(whole)


@pytest.mark.slow
def test_hugging_face_reads_pictures_and_rasters(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_HOME", str(tmp_path / "hf"))
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    code = f"""
import datasets
found = datasets.load_dataset({str(tmp_path / "set")!r}, cache_dir={str(tmp_path / "cache")!r})
row = found["train"].with_format("numpy")[0]
print(sorted(found), row["raster"].shape, row["raster"].dtype, row["picture_front"].shape)
"""
    build_dataset(BuildSettings(WITH_PICTURES, tmp_path / "set", 20), workers=1)
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split("\n")[0] == (
        "['test', 'train', 'unseen', 'validation'] (2, 26, 16, 16) float32 (64, 64, 3)"
    )
    sheet = row_sheet(tmp_path / "set", 4)
    assert sheet.shape[0] > 256 and sheet.std() > 10


def test_a_folder_of_another_dataset_is_left_alone(tmp_path):
    (tmp_path / "build.json").write_text(json.dumps({**small(tmp_path).identity(), "seed": 9}))
    with pytest.raises(DatasetError, match="holds a dataset of seed '9', not 0"):
        build_dataset(small(tmp_path))
    for damage in ("{", "[]", "{}", "[" * 100_000, '{"seed": 0}'):
        (tmp_path / "build.json").write_text(damage)
        with pytest.raises(DatasetError, match=r"build\.json: is damaged"):
            build_dataset(small(tmp_path))
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "README.md").write_text("mine")
    with pytest.raises(DatasetError, match="holds files but no dataset"):
        build_dataset(small(tmp_path / "other"))
    assert (tmp_path / "other" / "README.md").read_text() == "mine"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "set"
    build_dataset(small(folder, 5), workers=1)
    return folder


def damaged_copy(whole: Path, folder: Path) -> tuple[Path, Path]:
    shutil.copytree(whole, folder)
    return folder, next((folder / DATA).glob("train-*"))


def linked(shard: Path) -> None:
    shard.unlink()
    shard.symlink_to(shard.parent / "nowhere")


def of_other_rows(shard: Path) -> None:
    (other,) = [s for s in plan_shards(small(Path("x"), 5, seed=1)) if s.name == shard.name]
    shard.write_bytes(make_shard(other))


def with_fewer_rows(shard: Path) -> None:
    pq.write_table(pq.read_table(shard).slice(0, 2), shard)


def with_a_bit_turned(shard: Path) -> None:
    raw = bytearray(shard.read_bytes())
    raw[len(raw) // 3] ^= 1
    shard.write_bytes(bytes(raw))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (linked, "not a regular file; remove it and build again"),
        (of_other_rows, "has other rows than planned; remove it"),
        (with_fewer_rows, "has other rows than planned; remove it"),
        (with_a_bit_turned, "cannot be read"),
        (lambda shard: shard.write_bytes(b""), "cannot be read"),
        (lambda shard: pq.write_table(pa.table({"a": [1]}), shard), "not a shard of this version"),
        (lambda shard: shutil.copy(shard, shard.parent / "train-9.parquet"), "not a shard of this"),
    ],
)
def test_shards_that_were_changed_are_never_taken_for_whole(whole, tmp_path, damage, sentence):
    folder, shard = damaged_copy(whole, tmp_path / "set")
    before = (folder / "summary.json").read_bytes()
    damage(shard)
    with pytest.raises(DatasetError, match=sentence):
        build_dataset(small(folder, 5), workers=1)
    assert (folder / "summary.json").read_bytes() == before


@pytest.mark.slow
def test_a_dataset_is_described_only_where_its_shards_are_there(whole, tmp_path, capsys):
    folder, shard = damaged_copy(whole, tmp_path / "set")
    assert main(["dataset", str(folder)]) == 0
    assert "rows of 10 drawn" in capsys.readouterr().out
    for damage in ('{"rows": "3"}', "[]", "[" * 100_000, '{"rows":1,"splits":[],"failed":{}}'):
        (folder / "summary.json").write_text(damage)
        with pytest.raises(DatasetError, match=r"summary\.json: is damaged"):
            read_summary(folder)
    shutil.copy(whole / "summary.json", folder)
    shard.unlink()
    with pytest.raises(DatasetError, match=r"do not have the|is incomplete"):
        read_summary(folder)


def test_invalid_counts_and_folders_are_refused(tmp_path):
    with pytest.raises(DatasetError, match="0 rows a type; give 1 to"):
        plan_shards(small(tmp_path, 0))
    (tmp_path / "file").write_text("")
    with pytest.raises(DatasetError, match="cannot be used"):
        build_dataset(small(tmp_path / "file" / "set"))
    with pytest.raises(DatasetError, match="holds no finished dataset"):
        read_summary(tmp_path)


def test_a_scheduler_that_does_not_answer_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("garmentimage.dataset.engine.TIMEOUT_S", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        port = silent.getsockname()[1]
        for address in (f"tcp://127.0.0.1:{port}", "tcp://127.0.0.1:1", "foo", "http://x"):
            with pytest.raises(DatasetError, match="no scheduler answers at"):
                build_dataset(small(tmp_path / "set", 5), scheduler=address)
    assert not (tmp_path / "set").exists()


@pytest.mark.slow
def test_a_scheduler_without_workers_is_refused(tmp_path):
    from distributed import LocalCluster

    with (
        LocalCluster(n_workers=0, dashboard_address=None, host="127.0.0.1") as cluster,
        pytest.raises(DatasetError, match="has no workers; start some"),
    ):
        build_dataset(small(tmp_path, 5), scheduler=cluster.scheduler_address)


def die(piece: int) -> None:
    os._exit(piece)


@pytest.mark.slow
def test_work_that_kills_its_workers_ends_in_a_sentence():
    with pytest.raises(DatasetError, match="workers died repeatedly"):
        list(run_tasks(die, [1], None, 1))


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("d3", "-o", "x"), "there is no recipe 'd3'"),
        (("d2",), "--out is missing"),
        (("d2", "-o", "x", "--preset", "huge"), "--preset is 'huge'; choose laptop or paper"),
        (("d2", "-o", "x", "--count", "0"), "--count is 0; give 1 or more"),
        (("d2", "-o", "x", "--workers", "0"), "--workers is 0"),
        (("d2", "-o", "x", "--grid", "6"), "grid is 6; give an even number from 8 to 128"),
        (("d2", "-o", "x", "--grid", "15"), "grid is 15; give an even number"),
    ],
)
def test_a_wrong_build_is_one_sentence(capsys, tmp_path, monkeypatch, words, sentence):
    monkeypatch.chdir(tmp_path)
    assert main(["build", *words]) == 2
    assert sentence in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def fails(task):
    return FailedRow(task.row_id, "encode", "the pattern has no layout; try another")


@pytest.mark.slow
def test_a_build_without_any_row_ends_with_the_cause(tmp_path, monkeypatch):
    def all_failed(do, pieces, scheduler, workers):
        for piece in pieces:
            failed = [fails(task) for task in piece.tasks]
            yield piece, shard_bytes(SMALL, 16, [], failed, piece.identity())

    monkeypatch.setattr("garmentimage.dataset.building.run_tasks", all_failed)
    with pytest.raises(DatasetError, match="no row could be made; 6 failed because of encode: the"):
        build_dataset(small(tmp_path / "set", count=3))
    assert not (tmp_path / "set" / "summary.json").exists()


def test_the_command_lists_recipes_and_describes_datasets(capsys, tmp_path):
    assert main(["recipes"]) == 0
    assert "d2" in capsys.readouterr().out
    assert main(["dataset", str(tmp_path)]) == 2


@pytest.mark.slow
def test_the_command_builds_and_goes_on(capsys, tmp_path):
    words = ["build", "vae-topology", "--count", "5", "--workers", "1", "-o", str(tmp_path / "set")]
    assert main(words) == 0
    first = digests(tmp_path / "set")
    (tmp_path / "set" / DATA / next(iter(first))).unlink()
    assert main(words) == 0
    assert digests(tmp_path / "set") == first
    assert capsys.readouterr().out.count("20 rows of 20 drawn") == 2


def test_rasters_keep_their_numbers(tmp_path):
    import pyarrow.parquet as pq

    (shard,) = [s for s in plan_shards(small(Path("x"), 20)) if s.name.startswith("test")]
    (tmp_path / shard.name).write_bytes(make_shard(shard))
    row = pq.read_table(tmp_path / shard.name).to_pylist()[0]
    from garmentimage.dataset.row import make_row

    made = make_row(replace(shard.tasks[0]))
    np.testing.assert_array_equal(np.array(row["raster"], np.float32), made["raster"])
