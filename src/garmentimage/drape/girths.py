"""Girths and shoulders of the body that wears a garment; looked up often, so they are kept."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body, back_length, shoulder_point, taut_girth, trunk_outline

BODIES_KEPT, GIRTHS_KEPT = 16, 1024
"""Bodies whose shoulders are kept, and girths of bodies."""
BACK_NECK_RISE = 1.75
"""The inner ends of shoulder seams lie this far over the nape along the back [cm]: as in our
drafts, where that is 2 cm at the neck itself, and necklines are a little wider."""
BUST, OVER_BUST = 0.62, 0.76
"""Heights of the bust points, and of the top edge of strapless clothes, as shares of the way from
the waist to the shoulder joints."""


@lru_cache(maxsize=GIRTHS_KEPT)
def girth(body: Body, height: float) -> float:
    """Girth of the trunk in a level cut [cm]."""
    return taut_girth(trunk_outline(body, height)[:, [0, 2]])


@lru_cache(maxsize=BODIES_KEPT)
def shoulder(body: Body) -> Float[np.ndarray, " 3"]:
    """The left shoulder point."""
    return shoulder_point(body)


@lru_cache(maxsize=BODIES_KEPT)
def shoulder_seam_rise(body: Body) -> float:
    """How far over the neck points shoulder seams begin that are drawn for this body [cm].

    A back that is drawn flat from the waist up ends higher than the body, as its length goes along
    the skin.
    """
    marks = body.landmarks
    waist = float(marks["waist_front"][1])
    up = back_length(body, float(marks["cervical"][1]), waist) + BACK_NECK_RISE
    return waist + up - float(marks["left_neck_point"][1])


def waist_height(body: Body) -> float:
    """Height of the waist [cm]."""
    return float(body.landmarks["waist_front"][1])


def bust_height(body: Body) -> float:
    """Height of the bust points [cm]."""
    return _over_waist(body, BUST)


def chest_level(body: Body) -> float:
    """Height of the top edge of strapless clothes [cm]."""
    return _over_waist(body, OVER_BUST)


def _over_waist(body: Body, share: float) -> float:
    joint, waist = float(body.landmarks["left_shoulder_joint"][1]), waist_height(body)
    return waist + share * (joint - waist)
