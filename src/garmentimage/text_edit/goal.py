"""What a text asks of a garment, where geometry can tell: whether it is done, and where.

No network has a say in it but the sentence encoder, which finds the phrase that the text means.
"""

from dataclasses import dataclass

from garmentimage.dataset import all_phrases, aspect_of, bottoms_of, synonyms
from garmentimage.metrics import EditedRegion, ShapeAttributes
from garmentimage.text_edit.source_prompt import describe, nearest_phrase

MIN_SIMILARITY = 0.85
"""Texts that are nearer than this to a phrase mean it."""
CONJUNCTIONS = (",", ";", " and ", " with ", " but ")
"""Texts that have one may mean more than one phrase."""
MIN_LENGTH_CHANGE_CM, MIN_WIDTH_RATIO = 5.0, 1.1
"""Less is no change of length, nor is a width of less than this times the other."""


@dataclass(frozen=True)
class EditGoal:
    """A phrase that a text means."""

    phrase: str

    @property
    def touched(self) -> EditedRegion:
        """Where the garment may change."""
        return "sleeves" if aspect_of(self.phrase).endswith("sleeves") else "below the waist"

    def is_done(self, before: ShapeAttributes, after: ShapeAttributes) -> bool:
        """Whether the second garment is what the phrase makes of the first.

        Lengths and widths are changes: shorter trousers are what "short" makes of long ones.
        """
        aspect, words, said = aspect_of(self.phrase), synonyms(self.phrase), describe(after)
        bottoms = bottoms_of(self.phrase)
        if bottoms and said["bottom"] not in bottoms:
            return False
        changes = {
            "short": after.length <= before.length - MIN_LENGTH_CHANGE_CM,
            "long": after.length >= before.length + MIN_LENGTH_CHANGE_CM,
            "narrow": after.width <= before.width / MIN_WIDTH_RATIO,
            "wide": after.width >= before.width * MIN_WIDTH_RATIO,
        }
        for word, is_so in changes.items():
            if word in words:
                return is_so
        if aspect == "kind" and said["pieces"] != ("two pieces" if after.legs else "one piece"):
            return False
        return said[aspect] in words


def parse_goal(text: str) -> EditGoal | None:
    """The phrase that a text means; None if it means several, or what geometry cannot tell.

    Raises:
        LearnError: the sentence encoder is not installed.
    """
    near, phrase = nearest_phrase(text)
    if near < MIN_SIMILARITY or (
        text not in all_phrases() and any(joint in text for joint in CONJUNCTIONS)
    ):
        return None
    return EditGoal(phrase) if aspect_of(phrase) in JUDGED_ASPECTS else None


JUDGED_ASPECTS = frozenset(
    describe(ShapeAttributes(legs=False, pieces=1, sleeves=None, length=60.0, width=50.0))
)
"""Aspects that geometry can tell."""
