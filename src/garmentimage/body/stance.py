"""Stance: how far apart a body holds its legs.

Shipped bodies stand with their legs well apart, so that each can be measured by itself. Whoever
wears a narrow skirt stands otherwise, and so do the bodies that published patterns are drawn for.
"""

from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from garmentimage.body.body import Body, Vector3, load_body
from garmentimage.errors import check_type

WORN_LEG_ANGLE = np.deg2rad(2.5)  # how far each leg stands out on a body that wears something
TURNED_BELOW_CROTCH = 6.0
"""From the hip joint to this far under the crotch, skin turns more and more with the leg [cm]."""
HANDS = 35.0  # skin farther than this from the middle does not belong to a leg [cm]
BETWEEN = 3.0
"""Skin nearer to the middle than this turns less, in the middle not at all [cm]."""


@lru_cache(maxsize=16)
def stand_straight(body: Body) -> Body:
    """The body with its legs turned in about the hip joints until nearly upright.

    Above the crotch the skin follows little by little. A body that stands so already, or that has
    no landmark at its hips and ankles, is returned as it is.
    """
    marks = body.landmarks
    if not {"left_hip_joint", "left_ankle_joint", "crotch"} <= marks.keys():
        return body
    hip, ankle = marks["left_hip_joint"], marks["left_ankle_joint"]
    turn = np.arctan2(ankle[0] - hip[0], hip[1] - ankle[1]) - WORN_LEG_ANGLE
    if turn <= 0:
        return body
    depth = hip[1] - marks["crotch"][1] + TURNED_BELOW_CROTCH
    vertices = _turned(body.vertices, hip, turn, depth)
    lifted = np.array([0.0, vertices[:, 1].min(), 0.0])
    names = list(marks)
    places = _turned(np.array([marks[name] for name in names]), hip, turn, depth) - lifted
    vertices -= lifted
    for array in (vertices, places):
        array.setflags(write=False)
    landmarks = MappingProxyType(dict(zip(names, places, strict=True)))
    return replace(body, vertices=vertices, landmarks=landmarks)


def _turned(
    points: Float[np.ndarray, "point 3"], hip: Vector3, turn: float, depth: float
) -> Float[np.ndarray, "point 3"]:
    """Points of both legs [cm] turned towards the middle [rad] about the hip joints.

    They turn more and more from the hip joints to `depth` [cm] under them, and fully from there on.
    """
    share = np.clip((hip[1] - points[:, 1]) / depth, 0.0, 1.0)
    away = np.abs(points[:, 0])
    share = np.where(away < HANDS, share * share * (3 - 2 * share), 0.0)
    share *= np.clip(away / BETWEEN, 0.0, 1.0)
    side = np.where(points[:, 0] < 0, -1.0, 1.0)
    cos, sin = np.cos(turn * share), np.sin(turn * share)
    out, up = side * points[:, 0] - hip[0], points[:, 1] - hip[1]
    turned = points.copy()
    turned[:, 0] = side * (hip[0] + cos * out + sin * up)
    turned[:, 1] = hip[1] - sin * out + cos * up
    return turned


def wearer(body: str | Body) -> Body:
    """Who wears a garment: a shipped body with its arms stretched out and its legs upright, or the
    body that is given, as it stands.

    Raises:
        DraftError: there is no body of that name.
        TypeError: it is neither a name nor a Body.
    """
    if isinstance(body, str):
        return stand_straight(load_body(body))
    check_type(body, Body, "name a shipped one, or read one with garmentimage.load_body_file")
    return body
