"""The vocabulary of editing by text: words that describe garments in the training data.

A sentence encoder finds a nearest phrase for any text: that of "with pockets" is "with pants". So
every word of a text is looked up.
"""

import re
from dataclasses import dataclass
from functools import cache

from garmentimage.dataset import all_phrases
from garmentimage.errors import LearnError, quoted

_WORD = re.compile(r"[^\W\d_]+")
_ENDINGS = ("ening", "ened", "est", "ing", "en", "er", "ed", "es", "ly", "s", "e")
_MIN_STEM_LENGTH = 3
_MAX_LISTED = 5
_STOP_WORD_TEXT = """
a about above add all also an and ankle ankles are arms as at be below bit but by can change could
cut do down end ends ever every extend extra fairly floor for from garment get give given go goes
going great ground half have hem hers his how i if in instead into is it its just keep kind less
let like little lot lower make makes making maybe me more most much must my need nice no not now
of off on one only or out over part please put quite rather reach reaches reaching really remove
replace shall should side size slightly so some something sort still style such take than that the
their them then these they thing this those three to too turn two under up upper us very want
wanted was way we wear well which will wish with without would wrist you your
"""
_STOP_WORDS = frozenset(_STOP_WORD_TEXT.split())
"""Words without a meaning of their own for garments."""


@dataclass(frozen=True)
class Words:
    """The words of a text that are not stop words, in their order."""

    known: tuple[str, ...]
    unknown: tuple[str, ...]


def split_words(text: str) -> Words:
    """Split the words of a text into those of the vocabulary and others.

    Example:
        >>> split_words("make it a longer dress with pockets")
        Words(known=('longer', 'dress'), unknown=('pockets',))
    """
    known: dict[str, None] = {}
    unknown: dict[str, None] = {}
    for word in _WORD.findall(text.lower()):
        if _stem(word) in _vocabulary():
            known[word] = None
        elif word not in _STOP_WORDS:
            unknown[word] = None
    return Words(tuple(known), tuple(unknown))


def check_known(text: str) -> None:
    """Refuse a text without any word of the vocabulary: its result would be arbitrary.

    Raises:
        LearnError: lists the unknown words.
    """
    words = split_words(text)
    if not words.known:
        unknown = list_words(words.unknown) if words.unknown else quoted(text)
        raise LearnError(
            f"the networks do not know {unknown}; they know the kind of garment, sleeves, lengths, "
            'widths, necklines and fit, in English: "pants", "long sleeves", "wide"'
        )


def list_words(words: tuple[str, ...]) -> str:
    """The first few words, for a message."""
    more = len(words) - _MAX_LISTED
    shown = ", ".join(quoted(word) for word in words[:_MAX_LISTED])
    return f"{shown} and {more} more" if more > 0 else shown


@cache
def _vocabulary() -> frozenset[str]:
    """Stems of the words of all training phrases."""
    words = {word for phrase in all_phrases() for word in _WORD.findall(phrase.lower())}
    return frozenset(_stem(word) for word in words - _STOP_WORDS)


def _stem(word: str) -> str:
    """A word without the ending of a plural, comparative or verb: "slimmer" becomes "slim"."""
    for ending in _ENDINGS:
        if word.endswith(ending) and len(word) - len(ending) >= _MIN_STEM_LENGTH:
            word = word.removesuffix(ending)
            return word[:-1] if word[-1] == word[-2] and ending != "e" else word
    return word
