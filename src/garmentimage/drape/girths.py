"""Girths and shoulders of the body that wears a garment; looked up often, so they are kept."""

from functools import lru_cache

from garmentimage.body import Body, Vector3, back_length, shoulder_point, taut_girth, trunk_outline

BACK_NECK_RISE = 1.75
"""The inner ends of shoulder seams lie this far over the nape along the back [cm]: as in our
drafts, where that is 2 cm at the neck itself, and necklines are a little wider."""
BUST, OVER_BUST = 0.62, 0.76
"""Heights of the bust points, and of the top edge of strapless clothes, as shares of the way from
the waist to the shoulder joints."""


@lru_cache(maxsize=1024)
def trunk_girth(body: Body, height: float) -> float:
    """Girth of the trunk in a level cut [cm]."""
    return taut_girth(trunk_outline(body, height)[:, [0, 2]])


@lru_cache(maxsize=16)
def shoulder(body: Body) -> Vector3:
    """The left shoulder point."""
    return shoulder_point(body)


@lru_cache(maxsize=16)
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


def bust_height(body: Body, share: float = BUST) -> float:
    """Height of the bust points [cm], or of another share from the waist to the shoulder joints."""
    joint, waist = float(body.landmarks["left_shoulder_joint"][1]), waist_height(body)
    return waist + share * (joint - waist)


def chest_level(body: Body) -> float:
    """Height of the top edge of strapless clothes [cm]."""
    return bust_height(body, OVER_BUST)
