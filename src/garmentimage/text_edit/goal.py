"""What a text asks of a garment, where geometry can tell: whether it is done, and where.

No network has a say in it but the sentence encoder, which finds the phrase that the text means.
"""

from dataclasses import dataclass

from garmentimage.dataset import alike, aspect_of, bottoms_of, every_phrase
from garmentimage.metrics import Touched, Traits
from garmentimage.text_edit.source_prompt import nearest_phrase, said_of

CLEAR = 0.85
"""Texts that are nearer than this to a phrase mean it."""
JOINTS = (",", ";", " and ", " with ", " but ")
"""Texts that have one may mean more than one phrase."""
LONGER_CM, WIDER = 5.0, 1.1
"""Less is no change of length, nor is a width of less than this times the other."""


@dataclass(frozen=True)
class Asked:
    """A phrase that a text means."""

    phrase: str

    @property
    def touched(self) -> Touched:
        """Where the garment may change."""
        return "sleeves" if aspect_of(self.phrase).endswith("sleeves") else "below the waist"

    def is_done(self, before: Traits, after: Traits) -> bool:
        """Whether the second garment is what the phrase makes of the first.

        Lengths and widths are changes: shorter trousers are what "short" makes of long ones.
        """
        aspect, words, said = aspect_of(self.phrase), alike(self.phrase), said_of(after)
        bottoms = bottoms_of(self.phrase)
        if bottoms and said["bottom"] not in bottoms:
            return False
        changes = {
            "short": after.length <= before.length - LONGER_CM,
            "long": after.length >= before.length + LONGER_CM,
            "narrow": after.width <= before.width / WIDER,
            "wide": after.width >= before.width * WIDER,
        }
        for word, is_so in changes.items():
            if word in words:
                return is_so
        if aspect == "kind" and said["pieces"] != ("two pieces" if after.legs else "one piece"):
            return False
        return said[aspect] in words


def asked(text: str) -> Asked | None:
    """The phrase that a text means; None if it means several, or what geometry cannot tell.

    Raises:
        LearnError: the sentence encoder is not installed.
    """
    near, phrase = nearest_phrase(text)
    if near < CLEAR or (text not in every_phrase() and any(joint in text for joint in JOINTS)):
        return None
    return Asked(phrase) if aspect_of(phrase) in TOLD else None


TOLD = frozenset(said_of(Traits(legs=False, pieces=1, sleeves=None, length=60.0, width=50.0)))
"""Aspects that geometry can tell."""
