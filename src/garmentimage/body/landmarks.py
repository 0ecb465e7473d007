"""Landmarks of a body that comes without them, from its skin and the proportions of adults.

The crotch is found on the mesh. Other heights are shares of the stature, or of the way from crotch
to neck; their depth comes from the mesh. The shares are means over the shipped bodies, in which
neck points differ by up to 1.5 cm from them, waists by up to 2 cm and shoulder joints by 1 cm.
"""

import numpy as np

from garmentimage.body.body import Body, Points3, Vector3
from garmentimage.body.measure import ACROSS, UP, cut, skin_on_line
from garmentimage.errors import DraftError

NECK_POINT = 0.849  # height of the neck points, as a share of the stature
NECK_WIDTH = 0.042  # distance of the neck points from the middle, as a share of the stature
CERVICAL_ABOVE = 0.011  # the cervical lies this share of the stature over the neck points
WAIST = 0.43  # height of the waist, as a share of the way from crotch to neck points
SHOULDER = 0.101  # distance of the shoulder joints from the middle, as a share of the stature
SHOULDER_DEEP = 0.029
"""Depth of the shoulder joints under the skin above, as a share of the stature."""
ELBOW, WRIST = 0.373, 0.728
"""Where the joints lie on the way from the shoulder joint to the tip of the hand."""
HIP_ABOVE = 0.058  # height of the hip joints over the crotch, as a share of the stature
HIP = 0.065  # distance of the hip joints from the middle, as a share of the stature
KNEE, ANKLE = 0.29, 0.046  # heights of the leg's joints, as shares of the stature


def trunk_section(body: Body) -> Points3:
    """Where the plane of symmetry cuts the skin, as points in no particular order.

    Raises:
        DraftError: it does not cut it.
    """
    rings = cut(body, 0 * ACROSS, ACROSS)
    if not rings:
        raise DraftError("has nothing in its middle (x = 0)")
    return np.concatenate(rings)


def mark(body: Body) -> tuple[dict[str, Vector3], float]:
    """Landmarks of the wearer's middle and left side [cm], and the depth halfway through the waist.

    Args:
        body: y up, feet at y = 0, +z the front; its own landmarks are not used.

    Raises:
        DraftError: the skin is not where a body has it.
    """
    section, stature = trunk_section(body), float(body.vertices[:, 1].max())
    crotch = section[section[:, 1].argmin()]
    neck = NECK_POINT * stature
    waist = crotch[1] + WAIST * (neck - crotch[1])
    back, front = _depths(body, np.array([0.0, waist, 0.0]))
    nape, throat = _depths(body, np.array([0.0, neck, 0.0]))
    hip = np.array([HIP * stature, crotch[1] + HIP_ABOVE * stature, 0.0])
    shoulder = _shoulder(body, stature)
    hand = body.vertices[body.vertices[:, 0].argmax()]
    place = {
        "crown": section[section[:, 1].argmax()],
        "crotch": crotch,
        "waist_front": np.array([0.0, waist, front]),
        "cervical": np.array([0.0, neck + CERVICAL_ABOVE * stature, nape]),
        "neck_joint": np.array([0.0, neck, (nape + throat) / 2]),
        "left_neck_point": np.array([NECK_WIDTH * stature, neck, (nape + throat) / 2]),
        "left_shoulder_joint": shoulder,
        "left_elbow_joint": shoulder + ELBOW * (hand - shoulder),
        "left_wrist_joint": shoulder + WRIST * (hand - shoulder),
        "left_hip_joint": np.array([*hip[:2], np.mean(_depths(body, hip))]),
        "left_knee_joint": _leg_middle(body, KNEE * stature),
        "left_ankle_joint": _leg_middle(body, ANKLE * stature),
    }
    return place, (back + front) / 2


def _depths(body: Body, point: Vector3) -> tuple[float, float]:
    """Where the line from back to front through a point enters the skin and leaves it [cm]."""
    hits = skin_on_line(body, 2, point)
    if len(hits) < 2:
        raise DraftError(
            f"has no body {point[1]:.0f} cm over the floor, {point[0]:.0f} cm from its middle; "
            "it must stand straight, arms out and legs apart"
        )
    return float(hits.min()), float(hits.max())


def _shoulder(body: Body, stature: float) -> Vector3:
    x = SHOULDER * stature
    ring = max(cut(body, x * ACROSS, ACROSS), key=lambda points: points[:, 1].max())
    top = ring[ring[:, 1].argmax()]
    point = np.array([x, top[1] - SHOULDER_DEEP * stature, 0.0])
    point[2] = np.mean(_depths(body, point))
    return point


def _leg_middle(body: Body, height: float) -> Vector3:
    """The middle of the wearer's left leg at a height."""
    rings = [r for r in cut(body, height * UP, UP) if r[:, 0].min() > 0]
    if not rings:
        raise DraftError(f"has no leg of its own at {height:.0f} cm over the floor; stand it apart")
    ring = max(rings, key=len)
    middle: np.ndarray = (ring.min(0) + ring.max(0)) / 2
    return middle
