"""Captions and prompts: prompts only where the parameters are clearly so."""

import hashlib

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.dataset.vocabulary import (
    KIND_PHRASES,
    LEVEL_PHRASES,
    NOUNS,
    all_phrases,
    captions,
    phrases,
    random_prompt,
)
from garmentimage.draft.kind import KINDS as DRAFTED
from garmentimage.draft.sampling import sample


def drawn(kind: str, seed: int):
    return next(iter(sample(kind, 1, seed))).record()["parameters"]


@given(st.sampled_from(["one-panel-dress", "top-pants"]), st.integers(0, 40))
def test_every_prompt_is_made_of_phrases_that_are_true_of_the_garment(kind, seed):
    parameters = drawn(kind, seed)
    true = phrases(kind, parameters)
    known = set(all_phrases())
    assert {phrase for words in true.values() for phrase in words} <= known
    prompt = random_prompt(kind, parameters, np.random.default_rng(seed))
    assert any(phrase in prompt for words in true.values() for phrase in words)
    assert ("sleeveless" in true.get("sleeves", ())) == (parameters["sleeves"] == "none")


def test_levels_of_one_aspect_do_not_overlap_and_are_of_parameters_that_exist():
    known = {name for kind in DRAFTED.values() for name in kind.parameters}
    for name, aspects in LEVEL_PHRASES.items():
        assert name in known
        for levels in aspects.values():
            ends = [end for low, high, _ in levels for end in (low, high)]
            assert ends == sorted(ends)
    assert set(KIND_PHRASES) <= set(DRAFTED)


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
def test_a_phrase_is_true_of(parameters, aspect, phrase):
    assert phrase in phrases("top-pants", parameters)[aspect]


def test_a_length_between_long_and_short_has_neither_phrase():
    assert "length" not in phrases("one-panel-dress", {"body_length": 48.0})
    assert (
        phrases("shirt", {}) == {}
        and random_prompt("shirt", {}, np.random.default_rng(0)) == "shirt"
    )


RANGES = {
    "skirt_length": (0.2, 1), "body_length": (30, 90), "leg_length": (0, 1), "flare": (0, 0.5),
    "skirt_flare": (0, 0.5), "leg_flare": (-4, 20), "sleeve_length": (0.2, 1.1),
    "sleeve_taper": (-0.4, 1), "bust_ease": (0, 25),
}  # fmt: skip
CHOICES = {
    "sleeves": ("none", "set-in"), "neckline": ("round", "v", "square", "boat"),
    "cutout": ("none", "back"), "front_darts": ("none", "waist"), "back_darts": ("none", "waist"),
}  # fmt: skip


def test_captions_and_prompts_are_those_of_every_dataset_so_far():
    """Networks are trained on them: raise the version of recipes that use them if they change."""
    random, digest = np.random.default_rng(0), hashlib.sha256()
    later = {"blazer", "coat", "vest", "blouse", "cargo-pants"}
    later |= {
        "pocket-skirt",
        "peplum-top",
        "pleated-skirt",
        "button-shirt",
        "polo-shirt",
        "turtleneck",
    }
    for kind in sorted(NOUNS.keys() - later):
        for _ in range(100):
            parameters = {name: random.uniform(*ends) for name, ends in RANGES.items()}
            parameters |= {n: v[int(random.integers(len(v)))] for n, v in CHOICES.items()}
            for name in [*RANGES, *CHOICES]:
                if random.random() < 0.3 and name != "sleeve_taper":
                    del parameters[name]
            prompt = random_prompt(kind, parameters, random)
            words = captions(kind, parameters), phrases(kind, parameters), prompt
            digest.update(repr(words).encode())
    assert digest.hexdigest() == "015adbfd1bc044b59cc73cb800410202ea08672ed8c624486f4fe6542a553886"
