"""Measurement records: bodies that cannot be are refused in one sentence, JSON keeps all."""

import json
from dataclasses import asdict, replace

import pytest

from garmentimage.body.body_measurements import (
    NAMES,
    RANGES,
    BodyMeasurements,
    load_measurements,
    measurements,
    presets,
    save_measurements,
)
from garmentimage.errors import DraftError, GarmentImageError

NAMED = {
    "mean-female",
    "mean-male",
    "tall-slim-female",
    "short-round-female",
    "tall-slim-male",
    "short-round-male",
    "slim-female",
}
MEAN = measurements("mean-female")


def refusal(call, *args):
    with pytest.raises(DraftError) as caught:
        call(*args)
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_the_shipped_bodies_are_the_named_ones_and_possible():
    assert set(presets()) == NAMED
    for record in presets().values():
        record.check()


def test_presets_cannot_be_changed():
    with pytest.raises(TypeError):
        presets()["mean-female"] = MEAN


def test_every_measurement_has_a_range():
    assert tuple(RANGES) == NAMES


def test_an_unknown_body_names_near_ones():
    assert "did you mean mean-female" in refusal(measurements, "mean-femal")
    assert "tall-slim-male" in refusal(measurements, "q")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("value", [0.0, -80.0, 500.0, float("nan"), float("inf")])
def test_no_length_beyond_its_range_passes(name, value):
    message = refusal(replace(MEAN, **{name: value}).check)
    low, high = RANGES[name]
    assert message.startswith(f"{name} is ") and f"give {low:g} to {high:g} cm" in message


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"waist_girth": 5.0}, "waist_girth"),
        ({"hip_girth": 62.0, "thigh_girth": 64.0}, "thigh_girth"),
        ({"waist_height": 85.0, "hip_height": 95.0}, "waist_height"),
        ({"knee_height": 46.0, "crotch_height": 45.5}, "knee_height"),
        ({"bust_depth": 46.0}, "bust_depth"),
        ({"across_back": 60.0, "across_front": 60.0}, "across_back"),
    ],
)
def test_measurements_that_contradict_each_other_are_refused(change, named):
    assert named in refusal(replace(MEAN, **change).check)


def test_json_out_and_in_is_exact(tmp_path):
    for record in presets().values():
        assert BodyMeasurements.from_json(record.to_json()) == record
    save_measurements(tmp_path / "me.json", MEAN)
    assert load_measurements(tmp_path / "me.json") == MEAN


def record_with(**change):
    return json.dumps(asdict(MEAN) | change)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not JSON"),
        ("[" * 100_000, "not JSON"),
        ("[]", "one JSON object"),
        ("{}", "lack stature"),
        (record_with(bust_grith=90), "did you mean bust_girth"),
        (record_with(waist_girth="74"), "waist_girth must be a number"),
        (record_with(waist_girth=True), "waist_girth must be a number"),
        (record_with(waist_girth=None), "waist_girth must be a number"),
        (record_with(waist_girth=float("nan")), "waist_girth is nan"),
        (record_with(waist_girth=10**400), "waist_girth is inf"),
        (record_with(waist_girth=5), "give 45 to 190 cm"),
    ],
)
def test_a_fault_of_a_record_is_named(text, says):
    assert says in refusal(BodyMeasurements.from_json, text)


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    assert "cannot be read" in refusal(load_measurements, tmp_path / "none.json")
    assert "cannot be read" in refusal(load_measurements, tmp_path)
    (tmp_path / "bad.json").write_bytes(b"\xff\xfe\xff")
    assert "bad.json" in refusal(load_measurements, tmp_path / "bad.json")


def test_a_draft_error_is_one_of_ours():
    assert issubclass(DraftError, GarmentImageError) and issubclass(DraftError, ValueError)
