"""Edits that look at what they made: what a text asks for, and which try is kept."""

import pytest

from garmentimage.draft.kinds import draft_pattern
from garmentimage.metrics.shape_attributes import measure_shape
from garmentimage.text_edit.best_of import GUIDANCE_BOOSTS, MAX_ATTEMPTS, best_attempt
from garmentimage.text_edit.goal import EditGoal, parse_goal
from tests.text_edit.fakes import decoded

DRESS = draft_pattern("one-panel-dress", body_length=55)
LONGER = draft_pattern("one-panel-dress", body_length=75)
SLEEVED = draft_pattern("one-panel-dress", sleeves="set-in", sleeve_length=1.0)
TROUSERS = draft_pattern("top-pants", leg_length=0.5)
LONG_TROUSERS = draft_pattern("top-pants", leg_length=1.0)


@pytest.mark.parametrize(
    ("phrase", "before", "after", "is_done"),
    [
        ("pants", DRESS, TROUSERS, True),
        ("pants", DRESS, LONGER, False),
        ("a top and pants", DRESS, TROUSERS, True),
        ("dress", TROUSERS, DRESS, True),
        ("two pieces", DRESS, TROUSERS, True),
        ("long sleeves", DRESS, SLEEVED, True),
        ("with sleeves", DRESS, SLEEVED, True),
        ("sleeveless", SLEEVED, DRESS, True),
        ("short sleeves", DRESS, SLEEVED, False),
        ("long", DRESS, LONGER, True),
        ("short", LONGER, DRESS, True),
        ("short", DRESS, LONGER, False),
        ("a long dress", DRESS, LONGER, True),
        ("a long dress", TROUSERS, LONG_TROUSERS, False),
        ("long pants", TROUSERS, LONG_TROUSERS, True),
    ],
)
def test_geometry_tells_whether_what_a_phrase_asks_for_is_done(phrase, before, after, is_done):
    assert EditGoal(phrase).is_done(measure_shape(before), measure_shape(after)) is is_done


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "phrase"),
    [
        ("a wider skirt", "a wide skirt"),
        ("a top and pants", "a top and pants"),
        ("long sleeves and pants", None),
        ("short sleeves, wide", None),
        ("V-neck", None),
        ("quarterly tax report of a bank", None),
    ],
)
def test_texts_that_mean_one_phrase_that_geometry_can_tell_are_looked_at(text, phrase):
    found = parse_goal(text)
    assert (found.phrase if found else None) == phrase


@pytest.fixture
def attempts(monkeypatch):
    """Edits that come out as they are told to; the text is "long sleeves"."""
    monkeypatch.setattr(
        "garmentimage.text_edit.best_of.parse_goal", lambda text: EditGoal("long sleeves")
    )
    seen = []

    def trying(*results, tries=MAX_ATTEMPTS):
        left = iter(results)

        def attempt(further, touched):
            assert touched == "sleeves"
            seen.append(further)
            return next(left)

        return best_attempt(DRESS, "long sleeves", attempt, tries), seen

    return trying


# The body of the garment as given, with sleeves; and of another, much longer one.
GOOD = draft_pattern("one-panel-dress", body_length=55, sleeves="set-in", sleeve_length=1.0)
TOO_MUCH = draft_pattern("one-panel-dress", body_length=80, sleeves="set-in", sleeve_length=1.0)


def test_the_first_good_try_is_kept_and_the_text_pushes_further_until_there_is_one(attempts):
    best, seen = attempts(decoded(DRESS), decoded(GOOD))
    assert (best.number, best.count, best.done) == (1, 2, True)
    assert seen == list(GUIDANCE_BOOSTS[:2])


def test_a_garment_that_cannot_be_sewn_is_made_anew(attempts):
    best, _ = attempts(decoded(GOOD, ("a seam is open",)), decoded(None), decoded(GOOD))
    assert (best.number, best.count) == (2, 3)


def test_where_too_little_is_kept_the_best_of_all_tries_is_taken(attempts):
    best, _ = attempts(decoded(TOO_MUCH), decoded(DRESS), decoded(TOO_MUCH), decoded(None))
    assert (best.number, best.count, best.done) == (0, 4, True)


def test_what_was_never_done_is_said_to_be_so_and_stays_most_as_it_was(attempts):
    best, _ = attempts(decoded(LONGER), decoded(DRESS), tries=2)
    assert (best.number, best.count, best.done) == (1, 2, False)


def test_what_geometry_cannot_tell_is_tried_once_and_pushed_as_usual(monkeypatch):
    monkeypatch.setattr("garmentimage.text_edit.best_of.parse_goal", lambda text: None)
    seen = []

    def attempt(further, touched):
        assert touched is None
        seen.append(further)
        return decoded(GOOD)

    best = best_attempt(DRESS, "V-neck", attempt, MAX_ATTEMPTS)
    assert (best.count, best.done) == (1, None)
    assert seen == [1.0]
