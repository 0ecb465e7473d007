"""Belts and elastics: a top edge that is drawn together until it fits the waist."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from garmentimage.drape.components import GarmentItem
from garmentimage.drape.mesh import Rest


def with_elastics(rest: Rest, items: Sequence[GarmentItem]) -> Rest:
    """The cloth with its pinned edges as long as their belts; what hangs below has to fold."""
    length = rest.length
    for item in items:
        placement = item.placement
        if 0 < placement.drawn_length < placement.length:
            on = np.zeros(len(rest.vertex_area), bool)
            on[item.top] = True
            along = on[rest.edges].all(axis=1)
            length = np.where(along, length * (placement.drawn_length / placement.length), length)
    return rest if length is rest.length else replace(rest, length=length)
