"""An edit to look at: the garment as given, moments of the way, and the result, worn."""

import numpy as np
from jaxtyping import UInt8

from garmentimage.networks import Shown, shown, strip
from garmentimage.text_edit.editor import TextEdit

TITLE = 40
"""Characters of a text that are shown."""


def way(found: TextEdit, text: str) -> list[Shown]:
    """Columns of a strip: first the garment as given, last what the text made of it."""
    moments = [
        Shown(f"step {each.number}", each.step, None, each.step.faults, each.picture)
        for each in found.frames
    ]
    ends = shown("as given", found.given), shown(f"edited: {text}"[:TITLE], found.result)
    return [ends[0], *moments, ends[1]]


def way_picture(found: TextEdit, text: str) -> UInt8[np.ndarray, "row col 3"]:
    """The same as one picture."""
    return strip(way(found, text))
