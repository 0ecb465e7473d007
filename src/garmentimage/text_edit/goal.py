"""The goal of a text: whether an edit reaches it, and where the garment may change.

Both are decided by geometry; the only network involved is the sentence encoder, which finds the
training phrase that a text means.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Bool

from garmentimage.body import load_body, measurements
from garmentimage.dataset import all_phrases, aspect_of, bottoms_of, synonyms
from garmentimage.metrics import EditedRegion, ShapeAttributes
from garmentimage.render.worn import body_camera
from garmentimage.text_edit.source_prompt import describe, nearest_phrase

MIN_SIMILARITY = 0.85
"""A text means the nearest phrase if their embeddings have at least this cosine similarity."""
CONJUNCTIONS = (",", ";", " and ", " with ", " but ")
"""Texts that contain one may mean several phrases."""
MIN_LENGTH_CHANGE_CM, MIN_WIDTH_RATIO = 5.0, 1.1
"""A garment is longer or wider than another by at least this difference [cm] or ratio."""
BODY = "mean-female"
"""The body in the pictures of recipe `text-edit`, seen from the front."""


@dataclass(frozen=True)
class EditGoal:
    """The phrase that a text means."""

    phrase: str

    @property
    def region(self) -> EditedRegion:
        """Where the garment may change."""
        return "sleeves" if aspect_of(self.phrase).endswith("sleeves") else "below the waist"

    def is_achieved(self, before: ShapeAttributes, after: ShapeAttributes) -> bool:
        """Whether an edit reached the goal.

        Lengths and widths are relative: "short" asks for shorter trousers than before.
        """
        aspect, words, found = aspect_of(self.phrase), synonyms(self.phrase), describe(after)
        bottoms = bottoms_of(self.phrase)
        if bottoms and found["bottom"] not in bottoms:
            return False
        changes = {
            "short": after.length <= before.length - MIN_LENGTH_CHANGE_CM,
            "long": after.length >= before.length + MIN_LENGTH_CHANGE_CM,
            "narrow": after.width <= before.width / MIN_WIDTH_RATIO,
            "wide": after.width >= before.width * MIN_WIDTH_RATIO,
        }
        for word, is_changed in changes.items():
            if word in words:
                return is_changed
        if aspect == "kind" and found["pieces"] != ("two pieces" if after.legs else "one piece"):
            return False
        return found[aspect] in words


def parse_goal(text: str) -> EditGoal | None:
    """The goal of a text; None if it has several, or one that geometry cannot check.

    Raises:
        LearnError: the sentence encoder is not installed.
    """
    similarity, phrase = nearest_phrase(text)
    if similarity < MIN_SIMILARITY or (
        text not in all_phrases() and any(joint in text for joint in CONJUNCTIONS)
    ):
        return None
    return EditGoal(phrase) if aspect_of(phrase) in CHECKABLE_ASPECTS else None


CHECKABLE_ASPECTS = frozenset(
    describe(ShapeAttributes(legs=False, pieces=1, sleeves=None, length=60.0, width=50.0))
)
"""Aspects that geometry can check."""


@cache
def keep_mask(region: EditedRegion, pixels: int) -> Bool[np.ndarray, "pixel_row pixel_col"]:
    """Pixels that an edit should not change, the lowest row first.

    Sleeves lie beside the shoulder points and above the waist.

    Args:
        region: where the garment may change.
        pixels: rows and columns of the picture.
    """
    camera, body = body_camera(load_body(BODY)), measurements(BODY)
    along = (np.arange(pixels) + 0.5 - pixels / 2) * camera.extent / pixels
    x, y = np.meshgrid(along + camera.target[0], along + camera.target[1])
    below = y < body.waist_height
    if region == "below the waist":
        return ~below
    return below | (np.abs(x) < body.shoulder_width / 2)
