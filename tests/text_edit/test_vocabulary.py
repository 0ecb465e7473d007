"""Words that the networks know are told from those that they have never met."""

import pytest

from garmentimage.dataset.vocabulary import all_phrases
from garmentimage.errors import LearnError
from garmentimage.evaluate.prompts import PROMPTS
from garmentimage.text_edit.vocabulary import check_known, split_words


@pytest.mark.parametrize("text", [*all_phrases(), *(prompt.text for prompt in PROMPTS)])
def test_all_that_was_said_in_training_is_known(text):
    assert split_words(text).known and not split_words(text).unknown


@pytest.mark.parametrize(
    "text", ["make it wider", "slimmer trousers, please", "Tighter!", "add a sleeve", "shortest"]
)
def test_other_forms_of_known_words_are_known(text):
    assert split_words(text).known and not split_words(text).unknown


@pytest.mark.parametrize("text", ["pockets", "a red one", "remove the buttons", "zipper", "poches"])
def test_texts_without_a_known_word_are_refused(text):
    with pytest.raises(LearnError, match="the networks do not know"):
        check_known(text)
