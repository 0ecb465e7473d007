"""Items: the connected pieces of clothing of a pattern, and what each hangs from.

Words of this file:

- An **item** is all cloth that is sewn together. A pattern may hold several: a top, and trousers
  that are not sewn to it.
- An item **hangs** where some of it lies on a shoulder: an arm leaves it through another opening
  than the head does. Else it is **held**: the line of its topmost opening, a waistband or the edge
  of a strapless bodice, keeps its height, as a belt or an elastic would do.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from garmentimage.body.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.openings import bones, openings, turns

SHOULDER_SHARE, BREADTH_SHARE = 0.785, 0.1
"""Height of the shoulders and half their breadth as shares of the stature, where a body has no
landmark for them."""

BELT = 6.0
"""Only what lies less than this below the top of an opening is held [cm]."""


ARMS = 2
"""Limbs that come first in the turns of an opening."""


@dataclass(frozen=True, eq=False)
class Item:
    """One connected piece of clothing."""

    vertices: Int[np.ndarray, " n"]
    held: Int[np.ndarray, " m"]
    """Vertices that keep their height; none where the item hangs."""
    resting: Int[np.ndarray, " k"]
    """Vertices of an item that hangs that begin over the shoulders."""


def items(
    cloth: Cloth, start: Float[np.ndarray, "vertex 3"], body: Body, *, tucked: bool = False
) -> tuple[Item, ...]:
    """The items of a garment, in the order in which they are put on.

    Held items (skirts, trousers) come first and hanging ones (tops) over them, or after them
    where the top is `tucked` in; of two that hang, the one with less cloth comes first.

    Args:
        cloth: the sewn garment.
        start: where its vertices start, round the body [cm].
        body: who wears it.
        tucked: tops are worn under skirts and trousers.
    """
    faces = cloth.vertex_faces
    count = cloth.vertex_count
    links = coo_array(
        (np.ones(2 * len(faces)), (faces[:, [0, 1]].T.ravel(), faces[:, [1, 2]].T.ravel())),
        shape=(count, count),
    )
    number, label = connected_components(links, directed=False)
    label_of_face = label[faces[:, 0]]
    found = []
    for k in range(number):
        own = faces[label_of_face == k]
        held = _NONE if _hangs(own, start, body) else _held(own, start)
        found.append((bool(len(held)) == tucked, len(own), k, held))
    found.sort(key=lambda item: item[:3])
    over = _over_shoulders(start, body)
    return tuple(
        Item(np.flatnonzero(label == k), held, _NONE if len(held) else over[label[over] == k])
        for _, _, k, held in found
    )


_NONE = np.zeros(0, np.int64)


def _shoulder_height(body: Body) -> float:
    """Height of the shoulder joints [cm]."""
    joint = body.landmarks.get("left_shoulder_joint")
    if joint is not None:
        return float(joint[1])
    return SHOULDER_SHARE * float(body.vertices[:, 1].max())


def _hangs(faces: np.ndarray, start: np.ndarray, body: Body) -> bool:
    """Whether an opening goes round arms alone, neither the head nor the legs."""
    lines = bones(body)
    if lines is None:
        return bool(start[faces, 1].max() >= _shoulder_height(body))
    found = [turns(start[line], lines) for line in openings(faces)]
    return any(any(t[:ARMS]) and not any(t[ARMS:]) for t in found)


def _held(faces: np.ndarray, start: np.ndarray) -> Int[np.ndarray, " m"]:
    lines = openings(faces)
    if not lines:
        return _NONE
    top = max(lines, key=lambda line: float(start[line, 1].mean()))
    heights = start[top, 1]
    return np.unique(top[heights > heights.max() - BELT])


def _over_shoulders(start: np.ndarray, body: Body) -> Int[np.ndarray, " n"]:
    """Vertices over the shoulders, beside the neck."""
    joint = body.landmarks.get("left_shoulder_joint")
    reach = BREADTH_SHARE * np.ptp(body.vertices[:, 1]) if joint is None else abs(joint[0])
    neck = body.landmarks.get("left_neck_point")
    inner = 0.0 if neck is None else abs(neck[0])
    aside = np.abs(start[:, 0])
    over = (start[:, 1] > _shoulder_height(body)) & (aside < reach) & (aside > inner)
    return np.flatnonzero(over)
