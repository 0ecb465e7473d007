"""Wordings of garments: said only where the parameters are plainly so."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.dataset.wording import KINDS, LEVELS, all_phrases, phrases, random_prompt
from garmentimage.draft.kinds import KINDS as DRAFTED
from garmentimage.draft.sampling import sample


def drawn(kind: str, seed: int):
    return next(iter(sample(kind, 1, seed))).record()["parameters"]


@given(st.sampled_from(["one-panel-dress", "top-pants"]), st.integers(0, 40))
def test_every_wording_is_made_of_phrases_that_are_true_of_the_garment(kind, seed):
    parameters = drawn(kind, seed)
    told = phrases(kind, parameters)
    known = set(all_phrases())
    assert {phrase for words in told.values() for phrase in words} <= known
    said = random_prompt(kind, parameters, np.random.default_rng(seed))
    assert any(phrase in said for words in told.values() for phrase in words)
    assert ("sleeveless" in told.get("sleeves", ())) == (parameters["sleeves"] == "none")


def test_levels_of_one_aspect_do_not_overlap_and_are_of_parameters_that_exist():
    known = {name for kind in DRAFTED.values() for name in kind.parameters}
    for name, aspects in LEVELS.items():
        assert name in known
        for levels in aspects.values():
            ends = [end for low, high, _ in levels for end in (low, high)]
            assert ends == sorted(ends)
    assert set(KINDS) <= set(DRAFTED)


@pytest.mark.parametrize(
    ("parameters", "aspect", "phrase"),
    [
        ({"sleeves": "set-in", "sleeve_length": 1.0}, "sleeves", "long sleeves"),
        ({"sleeves": "set-in", "sleeve_length": 0.5}, "sleeves", "short sleeves"),
        ({"sleeves": "none", "sleeve_length": 1.0}, "sleeves", "sleeveless"),
        ({"body_length": 70}, "length", "long"),
        ({"leg_length": 0.2}, "length", "shorts"),
        ({"leg_flare": 20}, "width", "wide"),
        ({"flare": 0.05}, "width", "narrow"),
    ],
)
def test_a_phrase_is_said_of(parameters, aspect, phrase):
    assert phrase in phrases("top-pants", parameters)[aspect]


def test_a_length_between_long_and_short_is_called_neither():
    assert "length" not in phrases("one-panel-dress", {"body_length": 48.0})
    assert (
        phrases("shirt", {}) == {}
        and random_prompt("shirt", {}, np.random.default_rng(0)) == "shirt"
    )
