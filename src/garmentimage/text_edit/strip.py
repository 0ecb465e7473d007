"""An edit as a strip of pictures: the source garment, steps of the optimisation, and the result."""

from garmentimage.networks import StripFrame, draped_frame
from garmentimage.text_edit.editor import TextEdit

MAX_TITLE_LENGTH = 40
"""Characters of a title."""


def strip_columns(edit: TextEdit, text: str) -> list[StripFrame]:
    """Columns of the strip, for `networks.strip`: first the source, last the result, both worn."""
    steps = [
        StripFrame(f"step {each.number}", each.step, None, each.step.faults, each.picture)
        for each in edit.frames
    ]
    title = f"edited: {text}"[:MAX_TITLE_LENGTH]
    return [draped_frame("as given", edit.source), *steps, draped_frame(title, edit.result)]
