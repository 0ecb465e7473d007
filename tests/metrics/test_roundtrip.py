import json
import os
import time
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.compare.comparison import RoundtripResult, compare_patterns
from garmentimage.errors import EncodeError
from garmentimage.examples import example_path
from garmentimage.metrics.report import report_to_json
from garmentimage.metrics.roundtrip import (
    FileReport,
    RoundTrip,
    garment_kind,
    roundtrip_file,
    roundtrip_many,
    summarise,
    summary_table,
)
from garmentimage.pattern.files.spec import read_pattern, save_pattern
from garmentimage.pattern.model import Pattern, Side, Stitch
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode
from garmentimage.system.processes import TimedOut, map_in_processes
from tests.compare.garments import (
    GARMENTS,
    darted_skirt,
    renamed_panels,
    reordered,
    shifted_loops,
    sleeve_with_cuff,
    split_edges,
    transformed_panel,
    turned_stitch,
    without_stitch,
)

garments = st.sampled_from(GARMENTS).map(lambda draw: draw())
QUARTER_TURN = [[0, -1], [1, 0]]
MIRROR = [[-1, 0], [0, 1]]


@given(garments, st.integers(0, 2**32 - 1), st.integers(0, 5), st.floats(0.1, 0.9))
def test_a_garment_written_otherwise_is_the_same_garment(garment, seed, shift, share):
    rng = np.random.default_rng(seed)
    cut_up = split_edges(garment, {stitch.a: share for stitch in garment.stitches})
    again = renamed_panels(reordered(shifted_loops(cut_up, shift), rng), str.upper)
    result = compare_patterns(garment, again)
    assert result.success, result.reasons
    assert result.seam_agreement == 1
    assert result.seam_length_deviation < 0.05
    assert min(result.iou.values()) > 0.999


@pytest.mark.slow
@given(garments, st.data())
def test_a_damaged_garment_is_another_one(garment, data):
    number = data.draw(st.integers(0, len(garment.stitches) - 1))
    panel = data.draw(st.sampled_from(garment.panels)).name
    damaged = data.draw(
        st.sampled_from(
            [
                without_stitch(garment, number),
                turned_stitch(garment, number),
                transformed_panel(garment, panel, np.eye(2) * 0.9),
                Pattern(garment.panels[1:]),
                Pattern((*garment.panels, replace(garment.panels[0], name="more"))),
            ]
        )
    )
    result = compare_patterns(garment, damaged)
    assert not result.success
    assert result.reasons


def test_names_that_changed_places_do_not_matter():
    sleeve = sleeve_with_cuff()
    other = {"sleeve_front": "sleeve_back", "sleeve_back": "cuff", "cuff": "sleeve_front"}
    assert compare_patterns(sleeve, renamed_panels(sleeve, other.get)).success


def test_an_edge_sewn_twice_is_no_success():
    skirt = darted_skirt()
    twice = replace(skirt, stitches=(*skirt.stitches, Stitch(Side("front", 0), Side("back", 2))))
    assert compare_patterns(skirt, twice).reasons == ("edge 0 of panel 'front' is sewn 2 times",)


def test_a_turned_panel_is_the_same_in_any_pose_only():
    skirt = darted_skirt()
    turned = transformed_panel(skirt, "back", QUARTER_TURN)
    assert not compare_patterns(skirt, turned).success
    assert compare_patterns(skirt, turned, any_pose=True).success


def test_a_panel_seen_from_the_other_face_is_the_same_in_any_pose_only():
    """Its outline then runs the other way in panel coordinates, and nothing else changes."""
    skirt = darted_skirt()
    mirrored = transformed_panel(skirt, "front", MIRROR)
    assert "panel 'front' is inside out" in compare_patterns(skirt, mirrored).reasons
    assert compare_patterns(skirt, mirrored, any_pose=True).success


def test_a_panel_upside_down_is_another_garment_in_any_pose():
    skirt = darted_skirt()
    stitches = (
        Stitch(Side("front", 0), Side("back", 1)),
        Stitch(Side("front", 8), Side("back", 3)),
        *skirt.stitches[2:],
    )
    assert not compare_patterns(skirt, replace(skirt, stitches=stitches), any_pose=True).success


def test_seam_lengths_are_compared_between_the_same_seams():
    """Shoulders and side seams of a sleeveless top are alike but for their lengths."""
    top, _ = read_pattern(example_path("cutout_top"))
    assert compare_patterns(top, decode(encode(top))).seam_length_deviation < 0.2


@pytest.fixture
def skirt_file(tmp_path):
    folder = tmp_path / "skirts"
    folder.mkdir()
    save_pattern(darted_skirt(), folder / "skirt.json")
    return folder / "skirt.json"


def test_a_skirt_goes_there_and_back(skirt_file):
    report = roundtrip_file(skirt_file, 16)
    assert (report.file, report.kind) == ("skirts/skirt.json", "skirts")
    for trip in (report.with_marks, report.without_marks):
        assert trip.success, (trip.message, trip.result and trip.result.reasons)
    assert {"load", "encode", "decode", "judge"} <= report.with_marks.times.keys()


def test_errors_are_told_in_the_report(skirt_file, monkeypatch):
    def too_small(pattern, grid):
        raise EncodeError("does not fit", grid=24)

    monkeypatch.setattr("garmentimage.raster.encode.encode", too_small)
    trip = roundtrip_file(skirt_file).with_marks
    assert (trip.stage, trip.error, trip.grid) == ("encode", "EncodeError", 24)
    assert not trip.success


def test_a_file_that_is_no_pattern_is_told_without_its_way(tmp_path):
    path = tmp_path / "broken.json"
    path.write_text("{")
    trip = roundtrip_file(path).with_marks
    assert trip.stage == "load"
    assert trip.error == "PatternFileError"
    assert str(tmp_path) not in trip.message


def test_reports_come_in_the_order_of_the_files(skirt_file):
    missing = skirt_file.with_name("missing.json")
    seen = []
    reports = roundtrip_many([missing, skirt_file], workers=0, progress=seen.append)
    assert [r.file for r in reports] == ["skirts/missing.json", "skirts/skirt.json"]
    assert seen == reports
    assert [r.is_first for r in reports] == [True, False]


def test_a_manifest_tells_designs_with_a_collar(tmp_path):
    folder = tmp_path / "designs"
    folder.mkdir()
    made_of = [{"id": "tee", "collar_panels": 0}, {"id": "polo", "collar_panels": 2}]
    (tmp_path / "designs_manifest.json").write_text(json.dumps(made_of))
    assert garment_kind(folder / "tee.json") == "designs"
    assert garment_kind(folder / "polo.json") == "designs, collar or lapel"


def result_with(*, success, iou):
    reasons = () if success else ("why",)
    return RoundtripResult(success, reasons, (1, 1), iou, 0.1, 0.3, 1.0, 0.0)


@pytest.fixture
def reports():
    good = RoundTrip(result_with(success=True, iou={"a": 1.0, "b": 0.98}), times={"encode": 0.05})
    poor = RoundTrip(result_with(success=False, iou={"a": 0.6}), times={"encode": 0.15})
    error = RoundTrip(stage="encode", error="EncodeError", message="does not fit", grid=24)
    return [
        FileReport("x/1.json", "x", good, poor, wrapped_panels=1),
        FileReport("x/2.json", "x", poor, poor),
        FileReport("y/1.json", "y", error, error),
    ]


def test_a_summary_has_a_row_for_each_kind_and_one_for_all(reports):
    x, y, everything = summarise(reports)
    assert (x.kind, x.files, x.successes, x.successes_without_marks) == ("x", 2, 1, 0)
    assert x.iou_mean == pytest.approx(0.86)
    assert (x.iou_min, x.boundary_gap, x.wrapped_files) == (0.6, 0.3, 1)
    assert x.encode_ms == pytest.approx(100)
    assert (y.successes, y.errors, y.iou_mean) == (0, {"EncodeError": 1}, None)
    assert (everything.kind, everything.files, everything.successes) == ("all", 3, 1)


def test_median_times_leave_out_the_first_file_of_a_process(reports):
    one, other, _ = reports
    (row,) = summarise([replace(one, is_first=True), other])
    assert row.encode_ms == pytest.approx(150)
    (row,) = summarise([replace(one, is_first=True)])
    assert row.encode_ms is None


def test_the_table_has_a_line_for_each_row(reports):
    head, x, y, everything = summary_table(summarise(reports)).splitlines()
    assert head.startswith("kind") and "success" in head
    assert "50.0" in x and "1 EncodeError" in y and everything.startswith("all")


def test_a_report_is_plain_json_without_paths(reports):
    data = json.loads(json.dumps(report_to_json(reports, 16)))
    assert data["grid"] == 16
    assert data["versions"]["garmentimage"]
    assert [f["file"] for f in data["files"]] == ["x/1.json", "x/2.json", "y/1.json"]
    assert data["files"][2]["with_marks"]["smallest_grid"] == 24


def hang_or_die(item):
    if item == "hang":
        time.sleep(600)
    if item == "die":
        os._exit(3)
    return item.upper()


@pytest.mark.slow
def test_an_item_that_hangs_or_dies_costs_only_itself():
    items = ["a", "b", "hang", "die", "c"]
    outcomes = list(map_in_processes(hang_or_die, items, workers=2, time_limit=2.0))
    found = {outcome.number: outcome.result for outcome in outcomes}
    assert {k: v for k, v in found.items() if isinstance(v, str)} == {0: "A", 1: "B", 4: "C"}
    # Two workers, and one in the place of each that was lost.
    assert sum(outcome.is_first for outcome in outcomes) in (3, 4)
    assert found[2] == TimedOut("took longer than 2 s and was stopped")
    assert found[3] == TimedOut("the process died (exit code 3)")


@pytest.mark.slow
def test_many_files_in_processes_are_as_many_files_in_this_one(skirt_file):
    paths = [skirt_file, skirt_file.with_name("missing.json"), skirt_file]
    here, there = (partial(roundtrip_many, paths, workers=count)() for count in (0, 2))
    for one, other in zip(here, there, strict=True):
        assert one.with_marks.result == other.with_marks.result
        assert one.with_marks.message == other.with_marks.message
