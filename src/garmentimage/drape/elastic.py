"""Belts and elastics: a top edge that is drawn together until it fits the waist."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from garmentimage.drape.components import Item
from garmentimage.drape.mesh import Rest


def drawn_together(rest: Rest, items: Sequence[Item]) -> Rest:
    """The cloth with its held edges as long as their belts; what hangs below has to fold."""
    length = rest.length
    for item in items:
        standing = item.standing
        if 0 < standing.drawn_to < standing.length:
            on = np.zeros(len(rest.vertex_area), bool)
            on[item.top] = True
            along = on[rest.edges].all(axis=1)
            length = np.where(along, length * (standing.drawn_to / standing.length), length)
    return rest if length is rest.length else replace(rest, length=length)
