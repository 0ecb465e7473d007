"""Shape attributes, measured on patterns."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import garmentimage as gi
from garmentimage.draft.kind import draft_pattern
from garmentimage.draft.sampling import sample
from garmentimage.metrics.shape_attributes import measure_shape


@settings(max_examples=20, deadline=None)
@given(
    st.sampled_from(["one-panel-dress", "top-pants"]),
    st.sampled_from(["none", "set-in"]),
    st.integers(0, 200),
)
def test_legs_pieces_and_sleeves_are_told_before_and_after_a_raster(kind, sleeves, seed):
    garment = next(iter(sample(kind, 1, seed, fixed={"sleeves": sleeves}))).pattern
    for pattern in (garment, gi.decode(gi.encode(garment))):
        told = measure_shape(pattern)
        assert told.legs == (kind == "top-pants")
        assert told.pieces == (2 if kind == "top-pants" else 1)
        assert (told.sleeves is None) == (sleeves == "none")


@pytest.mark.parametrize(
    ("kind", "parameter", "trait", "slope"),
    [
        ("one-panel-dress", "body_length", "length", (0.8, 1.1)),
        ("top-pants", "leg_length", "length", (55, 68)),
        ("one-panel-dress", "sleeve_length", "sleeves", (48, 60)),
    ],
)
def test_lengths_follow_the_parameters_that_they_are_drafted_with(kind, parameter, trait, slope):
    made = list(sample(kind, 12, 7, fixed={"sleeves": "set-in"}))
    given_ = [each.record()["parameters"][parameter] for each in made]
    told = [getattr(measure_shape(each.pattern), trait) for each in made]
    assert np.corrcoef(given_, told)[0, 1] > 0.95
    assert slope[0] < np.polyfit(given_, told, 1)[0] < slope[1]


@pytest.mark.parametrize(
    ("kind", "parameter", "values"),
    [("one-panel-dress", "flare", (0.05, 0.2, 0.45)), ("top-pants", "leg_flare", (-4, 6, 20))],
)
def test_a_wider_hem_is_wider(kind, parameter, values):
    widths = [measure_shape(draft_pattern(kind, **{parameter: value})).width for value in values]
    assert widths[0] * 1.1 < widths[1] and widths[1] * 1.1 < widths[2]


def test_nothing_in_front_has_no_traits():
    assert measure_shape(None) is None
    assert measure_shape(gi.Pattern(())) is None
