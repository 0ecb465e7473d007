"""What is said to who asks for something that cannot be drafted: one sentence with a way out."""

from dataclasses import dataclass, replace

import pytest

from garmentimage.body.body_measurements import measurements
from garmentimage.draft.kind import DEFAULT_BODY, draft_pattern
from garmentimage.draft.parameters import checked_values, choice, parameter, parameters_of
from garmentimage.errors import DraftError, GarmentImageError

MEAN = measurements(DEFAULT_BODY)


@dataclass(frozen=True)
class Ribbon:
    """A thing with two parameters."""

    ribbon_length: float = parameter(10.0, 5.0, 20.0, "cm", "length")
    ends: str = choice("square", ("square", "pointed"), "shape of the ends")


RIBBON = parameters_of(Ribbon)


def test_fields_become_parameters_in_their_order():
    assert list(RIBBON) == ["ribbon_length", "ends"]
    length, ends = RIBBON.values()
    assert (length.name, length.default, length.low, length.high) == ("ribbon_length", 10, 5, 20)
    assert (length.unit, length.doc) == ("cm", "length")
    assert (ends.default, ends.options) == ("square", ("square", "pointed"))


def test_what_is_not_given_has_its_default():
    assert checked_values(RIBBON, {"ends": "pointed"}, "a ribbon") == {
        "ribbon_length": 10.0,
        "ends": "pointed",
    }


@pytest.mark.parametrize("value", [5, 20, "7.5", 12.25])
def test_numbers_of_the_range_are_taken_as_text_too(value):
    assert RIBBON["ribbon_length"].checked(value) == float(value)


@pytest.mark.parametrize("value", [4.999, 20.001, -1, 1e300])
def test_a_number_out_of_range_is_told_the_range(value):
    with pytest.raises(DraftError, match=r"ribbon_length is .*; give a number from 5 to 20 \[cm\]"):
        RIBBON["ribbon_length"].checked(value)


@pytest.mark.parametrize("value", ["long", None, True, [], float("nan"), float("inf"), ""])
def test_what_is_no_number_is_told_the_range(value):
    with pytest.raises(DraftError, match="give a number from 5 to 20"):
        RIBBON["ribbon_length"].checked(value)


@pytest.mark.parametrize("value", ["round", 1, None, ""])
def test_another_option_is_told_the_options(value):
    with pytest.raises(DraftError, match=r"ends is .*; choose square or pointed"):
        RIBBON["ends"].checked(value)


REFUSED = {
    "there is no kind 'trouser'": ("trouser", {}),
    "there is no kind 'hoody'; did you mean hoodie": ("hoody", {}),
    "kind tee has no parameter 'neckdepth'; did you mean neck_depth": ("tee", {"neckdepth": 3}),
    "kind skirt has no parameter 'bust_ease'; choose gores,": ("skirt", {"bust_ease": 3}),
    "neck_depth is 99; give a number from 9 to 18 [cm]": ("tee", {"neck_depth": 99}),
    "neckline is 'w'; choose round, v, square or boat": ("tee", {"neckline": "w"}),
    "gores is '3'; choose 2, 4, 6 or 8": ("skirt", {"gores": 3}),
    "there is no body 'mean-femal'; did you mean mean-female": ("tee", {"body": "mean-femal"}),
    "waist_girth is 5 cm, which no adult body has": (
        "tee",
        {"body": replace(MEAN, waist_girth=5.0)},
    ),
    "a dart ends 1.7 cm from the bust point, at least 2.0 cm are needed": (
        "shirt",
        {"dart_reach": 0.9, "body_length": 0.0, "dart_place": 0.45, "waist_shaping": 1.0},
    ),
    "the neckline is": (
        "tee",
        {"body": replace(MEAN, head_girth=66.0), "neck_width": 1, "neck_depth": 9},
    ),
    "the sleeve is 38.6 cm round, the arm with 2.0 cm of ease 47.0 cm": (
        "shirt",
        {"body": replace(MEAN, upper_arm_girth=45.0)},
    ),
    "the sleeve is 15.2 cm long and its cap": (
        "shirt",
        {"body": replace(MEAN, arm_length=38.0), "sleeve_length": 0.4, "cap_height": 0.6},
    ),
    "the shoulder seam is 2.1 cm long, at least 2.5 cm hold a garment": (
        "tank",
        {"shoulder_reach": 0.65, "neck_width": 3.5, "neckline": "boat"},
    ),
    "the cut-out leaves": (
        "tank",
        {
            "body": "short-round-female",
            "cutout": "front",
            "cutout_place": 0.6,
            "cutout_height": 13.0,
            "neck_depth": 18.0,
        },
    ),
    "the leg is": ("pants", {"body": replace(MEAN, thigh_girth=75.0)}),
    "the skirt ends": (
        "skirt",
        {"body": replace(MEAN, hip_height=80.0), "skirt_length": 0.35, "skirt_slant": 12.0},
    ),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_what_cannot_be_drafted_gets_one_sentence(sentence):
    kind, asked = REFUSED[sentence]
    with pytest.raises(DraftError) as caught:
        draft_pattern(kind, **asked)
    message = str(caught.value)
    assert message.startswith(sentence)
    assert "\n" not in message
    assert "; " in message


def test_a_draft_error_is_a_value_error_of_ours():
    assert issubclass(DraftError, GarmentImageError)
    assert issubclass(DraftError, ValueError)
