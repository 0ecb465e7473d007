"""What is true of a garment, of that which a text speaks of."""

import pytest

from garmentimage.draft.kind import draft_pattern
from garmentimage.text_edit.source_prompt import edit_prompts, nearest_phrase

pytestmark = pytest.mark.slow  # the sentence encoder loads for some seconds
DRESS = draft_pattern("one-panel-dress", body_length=55)
SLEEVED = draft_pattern("one-panel-dress", sleeves="set-in", sleeve_length=1.0, body_length=70)
TROUSERS = draft_pattern("top-pants", leg_length=0.3)


@pytest.mark.parametrize(
    ("pattern", "text", "true"),
    [
        (DRESS, "long sleeves", "sleeveless"),
        (SLEEVED, "sleeveless", "long sleeves"),
        (DRESS, "pants", "skirt"),
        (TROUSERS, "a skirt", "pants"),
        (TROUSERS, "dress", "a top and pants"),
        (DRESS, "two pieces", "one piece"),
        (SLEEVED, "a mini dress", "long"),
        (DRESS, "with sleeves", "sleeveless"),
        (DRESS, "V-neck", ""),
        (DRESS, "quarterly tax report of a bank", ""),
        (None, "long sleeves", ""),
    ],
)
def test_a_text_is_set_against_what_is_true_in_its_aspect(pattern, text, true):
    assert edit_prompts(pattern, text) == (text, true)


def test_what_is_said_of_skirts_and_of_legs_alike_is_told_with_what_the_garment_has():
    assert edit_prompts(DRESS, "long") == ("long, skirt", "knee-length, skirt")
    assert edit_prompts(TROUSERS, "longer") == ("longer, pants", "short, pants")


def test_texts_are_near_to_what_is_said_of_garments_or_strange():
    near, phrase = nearest_phrase("with really long sleeves")
    assert near > 0.7 and "long" in phrase
    assert nearest_phrase("quarterly tax report of a bank")[0] < 0.35
