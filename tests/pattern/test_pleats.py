"""Pleats of patterns: what `check` says of them, and what files make of them."""

from dataclasses import replace

import pytest

from garmentimage import PatternError, StitchError, draft_pattern
from garmentimage.pattern import fold_lines
from garmentimage.pattern.checks import check_pattern
from garmentimage.pattern.files import pattern_to_spec, read_spec
from garmentimage.pattern.files.svg import pattern_to_svg


@pytest.fixture(scope="module")
def skirt():
    return draft_pattern("pleated-skirt", pleats="inverted")


def with_first(pattern, **changes):
    first, *others = pattern.pleats
    return replace(pattern, pleats=(replace(first, **changes), *others))


def test_a_drafted_pleat_is_sound(skirt):
    assert check_pattern(skirt) == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"panel": "nothing"}, "there is no such panel"),
        ({"edges": (0, 2)}, "the second after the first"),
        ({"edges": (0, 1)}, "not sewn to each other"),
        ({"pressed": 0.0}, "give a length"),
        ({"pressed": float("nan")}, "give a length"),
    ],
)
def test_a_wrong_pleat_is_an_error_that_says_why(skirt, changes, message):
    with pytest.raises(StitchError, match=message):
        check_pattern(with_first(skirt, **changes))


def test_a_pleat_given_twice_is_an_error(skirt):
    with pytest.raises(StitchError, match="is given twice"):
        check_pattern(replace(skirt, pleats=(*skirt.pleats, skirt.pleats[0])))


def test_a_pleat_pressed_beyond_its_cloth_is_a_finding(skirt):
    (finding,) = check_pattern(with_first(skirt, pressed=200.0))
    assert "beyond its cloth" in str(finding)


def test_folds_of_an_inverted_pleat_meet_and_those_of_a_knife_pleat_lie_on_one_side(skirt):
    folds = fold_lines(skirt, skirt.pleats[0])
    assert [fold.is_seen for fold in folds] == [True, False, False, True]
    xs = [fold.start[0] for fold in folds]
    assert xs == sorted(xs, reverse=True)
    assert all(fold.end[1] == pytest.approx(-skirt.pleats[0].pressed) for fold in folds)
    knife = replace(skirt.pleats[0], fold="left")
    seen, beneath = fold_lines(skirt, knife)
    assert seen.is_seen and not beneath.is_seen
    assert seen.start[0] > beneath.start[0]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fold": "up"}, "garmentimage.pleats, 0, fold"),
        ({"edges": [1, 2, 3]}, "a pleat has two edges, not 3"),
        ({"edges": [1, 99]}, "names edge 99"),
        ({"pressed": "far"}, "pressed: must be a number"),
        ({"panel": "none"}, "which does not exist"),
    ],
)
def test_a_file_with_a_wrong_pleat_is_refused_with_its_place(skirt, changes, message):
    data = pattern_to_spec(skirt)
    data["garmentimage"]["pleats"][0] |= changes
    with pytest.raises(PatternError, match=message):
        read_spec(data)


def test_a_pleat_in_metres_is_read_in_cm(skirt):
    data = pattern_to_spec(skirt)
    found, _ = read_spec(data)
    assert found.pleats == skirt.pleats
    data["properties"]["units_in_meter"] = 1
    scaled, _ = read_spec(data)
    assert scaled.pleats[0].pressed == pytest.approx(100 * skirt.pleats[0].pressed)


def test_a_drawing_has_all_folds(skirt):
    drawing = pattern_to_svg(skirt)
    assert drawing.count('class="fold"') == 8 and drawing.count('class="fold beneath"') == 8
