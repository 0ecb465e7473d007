"""The items of clothing of a pattern, and what holds each of them up.

Words of this file:

- An **item** is all cloth that is sewn together. A pattern may hold several: a top, and trousers
  that are not sewn to it.
- An item **hangs** from the shoulders. Otherwise its top edge is **pinned** at the waist or at the
  chest, as by a belt or an elastic, where one could hold it; where none could, nothing holds it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.girths import chest_level
from garmentimage.drape.mesh import Rest
from garmentimage.drape.start import Placement
from garmentimage.drape.support import SupportSite
from garmentimage.drape.world_panels import sewn_on_panels
from garmentimage.geometry import component_labels
from garmentimage.pattern import Side

LAYER = 2.0  # garments whose depths differ by less are drawn on one layer [cm]


@dataclass(frozen=True, eq=False)
class GarmentItem:
    """One item of clothing: all cloth that is sewn together."""

    vertices: Int[np.ndarray, " n"]
    placement: Placement  # where its panels were put
    top: Int[np.ndarray, " t"]  # vertices along its top edge; none where it hangs
    level: Float[np.ndarray, " t"]  # height at which each of them belongs [cm]
    over_shoulders: Int[np.ndarray, " k"]
    """Vertices of an item that hangs that begin over the shoulders."""
    seams: Int[np.ndarray, " s"]
    """Vertices along its shoulder seams; those over the shoulders where it has none."""

    @property
    def pinned(self) -> Int[np.ndarray, " m"]:
        """Vertices that are kept at their height; none where the item hangs or nothing holds it."""
        return self.top if self.placement.is_supported else _NONE


def garment_items(
    cloth: Cloth,
    start: Float[np.ndarray, "vertex 3"],
    body: Body,
    placements: Sequence[Placement],
    *,
    tucked: bool = False,
) -> tuple[GarmentItem, ...]:
    """The items of a garment, in the order in which they are put on; what is sewn on is not one.

    Skirts, trousers and strapless clothes come first and what hangs (tops) over them, or after them
    where the top is `tucked` in. Of two that are alike, the one whose front and back are drawn
    closer together comes first, or the one with less cloth. Vertices begin at `start` [cm].
    """
    faces = cloth.vertex_faces
    label = component_labels(cloth.vertex_count, faces[:, [0, 1, 1, 2]].reshape(-1, 2))
    label_of_face = label[faces[:, 0]]
    names = [panel.name for panel in cloth.pattern.panels]
    sewn_on = sewn_on_panels(cloth.pattern)
    over = _over_shoulders(start, body)
    found = []
    for k in range(label.max() + 1):
        own = label_of_face == k
        name = names[cloth.face_panel[own][0]]
        if name in sewn_on:
            continue
        placement = next(s for s in placements if name in s.panels)
        hangs = placement.site is SupportSite.SHOULDERS
        hangs_only = hangs and not placement.is_supported
        top, level = (_NONE, np.zeros(0)) if hangs_only else _top(cloth, start, placement, body)
        resting = over[label[over] == k] if hangs else _NONE
        seams = _along(cloth, placement.seams) if placement.seams else resting
        item = GarmentItem(np.flatnonzero(label == k), placement, top, level, resting, seams)
        deep = round(float(np.ptp(start[item.vertices, 2])) / LAYER) * LAYER
        found.append((hangs != tucked, deep, int(own.sum()), k, item))
    found.sort(key=lambda entry: entry[:4])
    return tuple(item for *_, item in found)


_NONE = np.zeros(0, np.int64)


def _top(
    cloth: Cloth, start: Float[np.ndarray, "vertex 3"], placement: Placement, body: Body
) -> tuple[Int[np.ndarray, " t"], Float[np.ndarray, " t"]]:
    """The vertices along a top edge, and the height at which each belongs [cm].

    At the waist that is a level line, whatever curve is drawn. A strapless top keeps its own line,
    and so does one with a single strap, but for the strap.
    """
    top = _along(cloth, placement.edges)
    if placement.site is SupportSite.WAIST:
        return top, np.full(len(top), placement.level)
    if placement.site is SupportSite.SHOULDERS:
        top = top[start[top, 1] < chest_level(body)]
    return top, start[top, 1]


def _along(cloth: Cloth, sides: Sequence[Side]) -> Int[np.ndarray, " n"]:
    """The vertices along edges."""
    lines = [cloth.vertex[cloth.sides[side]] for side in sides]
    return np.unique(np.concatenate(lines)) if lines else _NONE


def _over_shoulders(start: np.ndarray, body: Body) -> Int[np.ndarray, " n"]:
    """Vertices over the shoulders, beside the neck."""
    joint, neck = body.landmarks["left_shoulder_joint"], body.landmarks["left_neck_point"]
    aside = np.abs(start[:, 0])
    return np.flatnonzero((start[:, 1] > joint[1]) & (aside < joint[0]) & (aside > neck[0]))


def with_elastics(rest: Rest, items: Sequence[GarmentItem]) -> Rest:
    """The cloth with its top edges as long as their belts or elastics; what hangs below folds."""
    length = rest.length
    for item in items:
        placement = item.placement
        if 0 < placement.drawn_length < placement.length:
            on = np.zeros(len(rest.vertex_area), bool)
            on[item.top] = True
            along = on[rest.edges].all(axis=1)
            length = np.where(along, length * (placement.drawn_length / placement.length), length)
    return replace(rest, length=length)
