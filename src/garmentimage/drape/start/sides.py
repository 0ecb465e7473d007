"""Landmarks of the body, and left and right sides of panels, for starting positions."""

from collections.abc import Mapping

import numpy as np

from garmentimage.body import Vector3
from garmentimage.drape.cloth import Cloth
from garmentimage.pattern import Side

CHEST = 0.7  # where the chest is on the way from the waist to the shoulder joints

Landmarks = Mapping[str, Vector3]  # of a body [cm]


def chest(landmarks: Landmarks) -> float:
    """Height of the chest, over skirts and under the tops of sleeves [cm]."""
    shoulder, waist = landmarks["left_shoulder_joint"][1], landmarks["waist_front"][1]
    return float(waist + CHEST * (shoulder - waist))


def of_side(landmarks: Landmarks, name: str, side: int) -> Vector3:
    """A landmark of the left side, or where it would be on the right (-1)."""
    return landmarks[name] * [side, 1, 1]


def faces_front(cloth: Cloth, of: Side) -> bool:
    """Whether the panel of an edge faces the front."""
    panel = cloth.pattern.by_name[of.panel]
    return bool(panel.matrix[2, 2] * np.sign(panel.outline.area) > 0)
