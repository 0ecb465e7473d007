"""Attempts at an edit: the goal of a text, and which attempt is the best."""

import pytest

from garmentimage.draft.kind import draft_pattern
from garmentimage.metrics.shape_attributes import measure_shape
from garmentimage.text_edit.attempts import GUIDANCE_BOOSTS, MAX_ATTEMPTS, best_attempt
from garmentimage.text_edit.goal import EditGoal, parse_goal
from tests.text_edit.fakes import decoded

DRESS = draft_pattern("one-panel-dress", body_length=55)
LONGER = draft_pattern("one-panel-dress", body_length=75)
SLEEVED = draft_pattern("one-panel-dress", sleeves="set-in", sleeve_length=1.0)
TROUSERS = draft_pattern("top-pants", leg_length=0.5)
LONG_TROUSERS = draft_pattern("top-pants", leg_length=1.0)


@pytest.mark.parametrize(
    ("phrase", "before", "after", "is_achieved"),
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
def test_geometry_decides_whether_the_goal_of_a_phrase_is_achieved(
    phrase, before, after, is_achieved
):
    assert EditGoal(phrase).is_achieved(measure_shape(before), measure_shape(after)) is is_achieved


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
    """Attempts with given results; the text is "long sleeves"."""
    monkeypatch.setattr(
        "garmentimage.text_edit.attempts.parse_goal", lambda text: EditGoal("long sleeves")
    )
    seen = []

    def trying(*results, max_attempts=MAX_ATTEMPTS):
        left = iter(results)

        def attempt(boost, region):
            assert region == "sleeves"
            seen.append(boost)
            return next(left)

        return best_attempt(DRESS, "long sleeves", attempt, max_attempts), seen

    return trying


# The body of the garment as given, with sleeves; and of another, much longer one.
GOOD = draft_pattern("one-panel-dress", body_length=55, sleeves="set-in", sleeve_length=1.0)
TOO_MUCH = draft_pattern("one-panel-dress", body_length=80, sleeves="set-in", sleeve_length=1.0)


def test_the_first_successful_attempt_is_returned_and_guidance_is_boosted_until_then(attempts):
    best, seen = attempts(decoded(DRESS), decoded(GOOD))
    assert (best.number, best.count, best.achieved) == (1, 2, True)
    assert seen == list(GUIDANCE_BOOSTS[:2])


def test_a_garment_that_cannot_be_sewn_starts_another_attempt(attempts):
    best, _ = attempts(decoded(GOOD, ("a seam is open",)), decoded(None), decoded(GOOD))
    assert (best.number, best.count) == (2, 3)


def test_where_too_little_is_preserved_the_best_of_all_attempts_is_returned(attempts):
    best, _ = attempts(decoded(TOO_MUCH), decoded(DRESS), decoded(TOO_MUCH), decoded(None))
    assert (best.number, best.count, best.achieved) == (0, 4, True)


def test_a_goal_never_achieved_is_reported_and_the_best_preserved_garment_returned(attempts):
    best, _ = attempts(decoded(LONGER), decoded(DRESS), max_attempts=2)
    assert (best.number, best.count, best.achieved) == (1, 2, False)


def test_a_goal_that_geometry_cannot_check_gets_one_attempt_without_boost(monkeypatch):
    monkeypatch.setattr("garmentimage.text_edit.attempts.parse_goal", lambda text: None)
    seen = []

    def attempt(boost, region):
        assert region is None
        seen.append(boost)
        return decoded(GOOD)

    best = best_attempt(DRESS, "V-neck", attempt, MAX_ATTEMPTS)
    assert (best.count, best.achieved) == (1, None)
    assert seen == [1.0]
