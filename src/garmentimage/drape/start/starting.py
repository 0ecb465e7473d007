"""Where the cloth begins: panels round the body, sleeves along its arms, trousers along its legs.

Patterns are drawn for bodies that hold their arms and legs otherwise than ours: arms stretched out
or 45 degrees down, legs 20 degrees apart or together. A limb that begins outside of its sleeve or
trouser leg would remain outside. So before the panels are sewn, sleeves are laid along the arms
(`sleeves`), collars round the neck (`collars`), wide skirts hung (`skirts`), and trousers laid
along the legs (`legs`). What is sewn to itself all round is laid round the body (`tubes`). At rest
the cloth is as long as the flat panels all the same.
"""

from collections.abc import Sequence, Set

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.start.collars import lay_collar
from garmentimage.drape.start.legs import clear_feet, shift_leg
from garmentimage.drape.start.placement import Placement
from garmentimage.drape.start.pleats import folded_flat
from garmentimage.drape.start.skirts import hang_skirts
from garmentimage.drape.start.sleeves import lay_sleeve
from garmentimage.drape.start.tubes import roll_tubes


def start_points(
    cloth: Cloth,
    body: Body,
    placements: Sequence[Placement] = (),
    later: Set[str] = frozenset(),
) -> Float[np.ndarray, "vertex 3"]:
    """Where every vertex of placed panels begins: halfway between the corners sewn into it [cm].

    Panels that are put on `later`, named, do not draw on what they are sewn to.
    """
    corners = np.empty((len(cloth.flat), 3))
    flat, outward = folded_flat(cloth)
    for k, panel in enumerate(cloth.pattern.panels):
        own = cloth.panel == k
        corners[own] = panel.to_world(flat[own])
        if outward[own].any():
            out = panel.matrix[:, 2] * np.sign(panel.outline.area)
            corners[own] += outward[own][:, None] * out
    landmarks = body.landmarks
    roll_tubes(cloth, corners, float(body.vertices[:, 2].mean()))
    if {"left_shoulder_joint", "left_wrist_joint", "waist_front"} <= landmarks.keys():
        for side in (1, -1):
            lay_sleeve(cloth, corners, landmarks, side)
        hang_skirts(cloth, corners, landmarks, placements)
    if {"left_neck_point", "neck_joint"} <= landmarks.keys():
        lay_collar(cloth, corners, landmarks)
    if {"left_knee_joint", "left_ankle_joint"} <= landmarks.keys():
        clear_feet(corners, body)
    if {"left_hip_joint", "left_ankle_joint", "crotch"} <= landmarks.keys():
        for side in (1, -1):
            shift_leg(cloth, corners, landmarks, side)
    if later:
        corners = _without(cloth, corners, later)
    return cloth.sewn(corners)


def _without(cloth: Cloth, corners: np.ndarray, later: Set[str]) -> np.ndarray:
    """Corners of the panels `later` where those of the others are that they are sewn to."""
    names = np.array([panel.name for panel in cloth.pattern.panels])
    others = ~np.isin(names, list(later))[cloth.panel]
    on = np.flatnonzero(others)
    count = np.bincount(cloth.vertex[on], minlength=cloth.vertex_count)
    total = [np.bincount(cloth.vertex[on], c, cloth.vertex_count) for c in corners[on].T]
    middle = np.stack(total, axis=1) / np.maximum(count, 1)[:, None]
    moved = ~others & (count[cloth.vertex] > 0)
    return np.where(moved[:, None], middle[cloth.vertex], corners)
