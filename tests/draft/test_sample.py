"""Laws of sampling: the same garment for ever, on any number of workers."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import DraftError
from garmentimage.body.body_measurements import measurements, presets
from garmentimage.draft.kind import KINDS, Kind
from garmentimage.draft.parameters import Parameter
from garmentimage.draft.sampling import at_level, drafted, drawn_value, sample
from garmentimage.draft.templates.template import Template
from garmentimage.pattern.files.spec import load_pattern, save_pattern

TEMPLATE = Path(__file__).parent / "templates" / "flared_skirt.json"
LENGTH = Parameter("length", 50.0, "", low=40.0, high=60.0, unit="cm")
COLLAR = Parameter("collar", "none", "", options=("none", "stand", "shirt"))
DRAWN = {
    "shirt": "96c38ac8401cee20",
    "jacket": "e43f841894dba1f6",
    "hoodie": "6d9d56e2562b4880",
    "blazer": "ad7deae3858b9434",
    "coat": "fa2e3e6cc43996bb",
    "vest": "cb60ff328a5d2717",
    "blouse": "9f2922a66dfe63f6",
}
"""Of kinds, a hash of the parameters of five garments."""


def records(*arguments, **options):
    return [(s.record(), s.pattern) for s in sample(*arguments, **options)]


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(["skirt", "pants"]), st.integers(0, 1000), st.integers(1, 5))
def test_a_garment_depends_on_its_seed_and_index_alone(kind, seed, count):
    together = records(kind, count, seed)
    apart = [records(kind, 1, seed, first=k)[0] for k in range(count)]
    assert together == apart


@pytest.mark.slow
@pytest.mark.parametrize("source", ["skirt", TEMPLATE])
def test_workers_change_nothing(source):
    source = Template.read(source) if isinstance(source, Path) else source
    assert records(source, 70, 5) == records(source, 70, 5, workers=2)


def test_fixed_parameters_are_not_drawn_and_the_others_are_drawn_as_without():
    free = [record for record, _ in records("tank", 5, 3)]
    fixed = [record for record, _ in records("tank", 5, 3, fixed={"neckline": "v"})]
    for one, other in zip(free, fixed, strict=True):
        if not one["rejected"] and not other["rejected"]:
            assert one["parameters"] | {"neckline": "v"} == other["parameters"]
    assert {record["parameters"]["neckline"] for record in fixed} == {"v"}
    with pytest.raises(DraftError, match="has no parameter 'neklin'"):
        sample("tank", 1, fixed={"neklin": "v"})
    with pytest.raises(DraftError, match="cannot be fixed"):
        sample(Template.read(TEMPLATE), 1, fixed={"neckline": "v"})


def test_other_seeds_and_kinds_give_other_values():
    one, other = (records("skirt", 1, seed)[0][0]["parameters"] for seed in (1, 2))
    assert one != other


@given(st.integers(0, 10**6))
def test_a_value_is_within_its_range(seed):
    random = np.random.default_rng(seed)
    assert LENGTH.low <= drawn_value(LENGTH, random) <= LENGTH.high
    assert drawn_value(COLLAR, random) in COLLAR.options


def test_ends_of_a_range_and_all_options_occur_and_the_rest_is_even():
    random = np.random.default_rng(0)
    values = np.array([drawn_value(LENGTH, random) for _ in range(4000)])
    for end in (LENGTH.low, LENGTH.high):
        assert 0.02 < np.mean(values == end) < 0.04
    inner = values[(values > LENGTH.low) & (values < LENGTH.high)]
    counts, _ = np.histogram(inner, bins=4, range=(LENGTH.low, LENGTH.high))
    assert counts.min() > 0.9 * counts.mean()
    chosen = [drawn_value(COLLAR, random) for _ in range(900)]
    assert all(chosen.count(option) > 250 for option in COLLAR.options)


def test_kinds_that_had_cuffs_or_collars_draw_what_they_drew_before_there_were_more():
    for kind, expected in DRAWN.items():
        text = json.dumps([record["parameters"] for record, _ in records(kind, 5, 7)])
        assert hashlib.sha256(text.encode()).hexdigest()[:16] == expected, kind


def test_any_body_draws_all_bodies():
    bodies = {record["body"] for record, _ in records("skirt", 60, 0, body="any")}
    assert bodies == set(presets())


def test_a_template_is_sampled_like_a_kind():
    template = Template.read(TEMPLATE)
    first, again = (records(template, 4, 7) for _ in range(2))
    assert first == again
    assert len({str(record["parameters"]) for record, _ in first}) == 4


def test_a_saved_sample_still_tells_how_it_was_made(tmp_path):
    (one,) = sample("pants", 1, 11)
    save_pattern(one.pattern, tmp_path / "a.json")
    again = load_pattern(tmp_path / "a.json")
    assert again.extra["ours"]["draft"] == one.record()


class MoodyKind(Kind):
    """A skirt that refuses its first drafts."""

    def draft(self, body, given):
        if self.refusals:
            self.refusals.pop()
            raise DraftError("it cannot be worn")
        return super().draft(body, given)


def moody(fails):
    kind = MoodyKind(**vars(KINDS["skirt"]))
    object.__setattr__(kind, "refusals", [1] * fails)
    return kind


def test_a_rejected_draw_is_counted_with_its_reason_and_drawn_again():
    (one,) = sample(moody(3), 1, 0)
    assert one.rejected == ("it cannot be worn",) * 3


def test_a_source_that_never_gives_a_garment_is_given_up():
    with pytest.raises(DraftError, match="rejected 100 times"):
        list(sample(moody(10**6), 1, 0))


@pytest.mark.parametrize(
    ("arguments", "options", "sentence"),
    [
        (("skrit", 1), {}, "did you mean skirt"),
        (("skirt", -1), {}, "count is -1"),
        (("skirt", 1, -5), {}, "seed is -5"),
        (("skirt", 1), {"body": "mean-femal"}, "mean-female"),
    ],
)
def test_what_cannot_be_sampled_is_told(arguments, options, sentence):
    with pytest.raises(DraftError, match=sentence):
        list(sample(*arguments, **options))


@pytest.mark.parametrize("level", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("kind", list(KINDS))
def test_every_kind_drafts_at_low_middle_and_high_values(kind, level):
    assert drafted(KINDS[kind], measurements("mean-female"), level).panels
    values = at_level(KINDS[kind], level)
    assert values.keys() == KINDS[kind].parameters.keys()
