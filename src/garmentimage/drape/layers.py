"""Layers of cloth: what of a garment is simulated at once, and what holds it meanwhile.

Cloth of one layer does not keep cloth of the same layer off. Lapels and collars simulated together
with what they lie on would fall through it, and into the neck opening. Hence they are a layer by
themselves: they begin folded onto the cloth at rest (`start.folding`) and are held along their
seams. They are kept off what lies beneath, and do not press on it. So are pockets, and whatever
else is sewn onto the cloth of a panel, held along the edges that are sewn on. A stand beneath a
fall is put on before the fall, upright.

A front that overlaps another carries its share of the garment, so it cannot be left out at first.
It is simulated with all the rest, and then once more by itself, outside of what it overlaps.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.components import GarmentItem
from garmentimage.drape.fabric import Fabric
from garmentimage.drape.folded import FoldedPanels, on_panels, overlapping_panels
from garmentimage.drape.mesh import Rest
from garmentimage.drape.solver import Attachment
from garmentimage.drape.start import ROLL, from_seams
from garmentimage.drape.world_panels import sewn_on_panels

BELT_STIFFNESS, MAX_BELT_PULL = 1e5, 3e6
"""A belt or an elastic keeps each vertex at its height with this stiffness [dyn/cm], and holds the
garment up with at most this force all round [dyn]: some 3 kg."""
PRESSED, PRESSED_STIFFNESS = 5.0, 3e3
"""A fold is pressed: cloth at it is drawn to where it lies flat on what is beneath, with this force
per distance [dyn/cm]; so many cm away it is not."""
STAND_STIFFNESS = 300.0
"""A stand is drawn to where it stands upright along all its height [dyn/cm]."""
INTERFACING = 10.0
"""Collars and lapels are stiffened: they resist bending so many times as much as their fabric."""


class LayerRole(Enum):
    """What a layer is, which says where it begins and what holds it."""

    PLAIN = "plain"
    OVERLAPPING = "overlapping"
    STANDING = "standing up"
    FOLDED = "folded over"
    SEWN_ON = "sewn on"


@dataclass(frozen=True, eq=False)
class GarmentLayer:
    """Cloth of one item that is simulated at once."""

    item: GarmentItem
    faces: Bool[np.ndarray, " face"]  # its triangles
    vertices: Int[np.ndarray, " n"]  # their vertices, in rising order
    own: Int[np.ndarray, " m"]  # those that it moves: all but the ones stitched to cloth beneath
    role: LayerRole
    lies_on: Bool[np.ndarray, " face"] | None = None
    """The triangles of the same item that it overlaps; None: it is put on over all before it."""


def garment_layers(
    cloth: Cloth, items: Sequence[GarmentItem], folded: FoldedPanels
) -> list[GarmentLayer]:
    """All cloth in the order in which it is put on: first an item's own, then what is over it."""
    layers = []
    is_over = on_panels(cloth, folded.names)
    overlaps = overlapping_panels(cloth.pattern, folded)
    stands = on_panels(cloth, folded.below.keys())
    for item in items:
        faces = np.isin(cloth.vertex_faces[:, 0], item.vertices)
        plain = faces & ~is_over & ~stands
        beneath = np.unique(cloth.vertex_faces[plain])
        layers.append(GarmentLayer(item, plain, beneath, beneath, LayerRole.PLAIN))
        layers += _overlapping(cloth, item, plain, overlaps)
        if (standing := faces & stands).any():
            vertices = np.unique(cloth.vertex_faces[standing])
            own = np.setdiff1d(vertices, beneath)
            layers.append(GarmentLayer(item, standing, vertices, own, LayerRole.STANDING))
            beneath = np.union1d(beneath, vertices)
        if (over := faces & is_over).any():
            vertices = np.unique(cloth.vertex_faces[over])
            own = np.setdiff1d(vertices, beneath)
            layers.append(GarmentLayer(item, over, vertices, own, LayerRole.FOLDED))
        sewn_on = on_panels(cloth, sewn_on_panels(cloth.pattern) & item.placement.panels)
        if sewn_on.any():
            vertices = np.unique(cloth.vertex_faces[sewn_on])
            layers.append(GarmentLayer(item, sewn_on, vertices, vertices, LayerRole.SEWN_ON))
    return layers


def _overlapping(
    cloth: Cloth,
    item: GarmentItem,
    faces: Bool[np.ndarray, " face"],
    overlaps: Mapping[str, frozenset[str]],
) -> list[GarmentLayer]:
    """Of the triangles of an item those that overlap others, the lowest cloth layer first."""
    layers = []
    sheets = {name: cloth.pattern.by_name[name].cloth_layer for name in overlaps}
    for sheet in sorted(set(sheets.values())):
        names = frozenset(name for name in sheets if sheets[name] == sheet)
        over = faces & on_panels(cloth, names)
        if not over.any():
            continue
        vertices = np.unique(cloth.vertex_faces[over])
        own = np.setdiff1d(vertices, cloth.vertex_faces[faces & ~over])
        lies_on = on_panels(cloth, frozenset().union(*(overlaps[name] for name in names)))
        role = LayerRole.OVERLAPPING
        layers.append(GarmentLayer(item, over, vertices, own, role, faces & lies_on))
    return layers


def held_at_seams(layer: GarmentLayer, start: Float[np.ndarray, "vertex 3"]) -> Attachment:
    """Holds what overlaps along its seams to cloth beneath, and a pinned edge at its height.

    `start` as below.
    """
    pinned = np.isin(layer.vertices, layer.item.pinned)
    sewn = ~np.isin(layer.vertices, layer.own)
    stiffness = np.where(sewn, np.inf, 0.0)[:, None].repeat(3, axis=1)
    stiffness[pinned, 1] = np.inf
    held = np.flatnonzero(pinned | sewn)
    return Attachment(held, start[layer.vertices[held]], stiffness[held])


def belt(layer: GarmentLayer) -> Attachment | None:
    """Holds an item up where nothing else does; free to move sideways."""
    item = layer.item
    on = np.isin(item.pinned, layer.vertices)
    if not on.any():
        return None
    own = np.searchsorted(layer.vertices, item.pinned[on])
    targets, stiffness = np.zeros((2, len(own), 3))
    targets[:, 1], stiffness[:, 1] = item.level[on], BELT_STIFFNESS
    return Attachment(own, targets, stiffness, MAX_BELT_PULL / len(own))


def pressed_fold(
    cloth: Cloth,
    layer: GarmentLayer,
    folded: FoldedPanels,
    start: Float[np.ndarray, "vertex 3"],
) -> Attachment:
    """Holds what is folded over where it is sewn on, and near its fold where it begins.

    `start` [cm] are the places of all vertices of the garment at its beginning.
    """
    stiffness = np.zeros(cloth.vertex_count)
    for k, panel in enumerate(cloth.pattern.panels):
        if panel.name in folded.turned and panel.name in folded.seams:
            own = np.flatnonzero(cloth.panel == k)
            flat, fold = cloth.flat[own], cloth.sides[folded.seams[panel.name][0]]
            away, _ = cKDTree(cloth.flat[fold]).query(flat)
            # Where the collar rolls over it is not pressed.
            rolls = from_seams(cloth, panel.name, folded.stands, flat) / ROLL
            pressed = np.clip(1.0 - away / PRESSED, 0.0, 1.0) * np.clip(rolls, 0.0, 1.0)
            np.maximum.at(stiffness, cloth.vertex[own], PRESSED_STIFFNESS * pressed)
    stiffness[np.setdiff1d(layer.vertices, layer.own)] = np.inf
    held = np.flatnonzero(stiffness[layer.vertices])
    vertices = layer.vertices[held]
    return Attachment(held, start[vertices], np.tile(stiffness[vertices], (3, 1)).T)


def pressed_stand(layer: GarmentLayer, start: Float[np.ndarray, "vertex 3"]) -> Attachment:
    """Holds a stand where it is sewn on, and draws it to where it begins: it is pressed upright.

    `start` [cm] are the places of all vertices of the garment at its beginning.
    """
    own = np.isin(layer.vertices, layer.own)
    stiffness = np.where(own, STAND_STIFFNESS, np.inf)
    return Attachment(
        np.arange(len(layer.vertices)), start[layer.vertices], np.tile(stiffness, (3, 1)).T
    )


def without_falls(part: Rest) -> Rest:
    """Stands that carry their own weight only: a fall lies on the shoulders."""
    own = np.bincount(part.faces.ravel(), np.repeat(part.face_area / 3, 3), len(part.vertex_area))
    return replace(part, vertex_area=own)


def sewn_lines(
    cloth: Cloth, layer: GarmentLayer, start: Float[np.ndarray, "vertex 3"]
) -> Attachment:
    """Holds what is sewn on along the edges that are, where they begin; `start` as above."""
    sides = [side for sewn in cloth.pattern.onto for side in sewn.sides]
    lines = [cloth.vertex[cloth.sides[side]] for side in sides]
    held = np.flatnonzero(np.isin(layer.vertices, np.concatenate(lines)))
    targets = start[layer.vertices[held]]
    return Attachment(held, targets, np.full(targets.shape, np.inf))


def interfaced(fabric: Fabric) -> Fabric:
    """The fabric of collars and lapels, which are stiffened."""
    return replace(fabric, bend=INTERFACING * fabric.bend)
