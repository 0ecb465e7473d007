"""Stand-up collars begin as a ring round the neck, as the chin would hold up a flat front."""

import numpy as np

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.start.sides import Landmarks
from garmentimage.pattern import FRONTAL

MAX_COLLAR_HEIGHT = 12.0  # height of a collar, at most [cm]; what is higher is a hood
MIN_RADIUS = 9.0  # least radius of the ring [cm]


def lay_collar(cloth: Cloth, corners: np.ndarray, landmarks: Landmarks) -> None:
    """Bend level strips over the shoulders, in front and behind, to a ring round the neck."""
    over, neck = landmarks["left_neck_point"][1], landmarks["neck_joint"][2]
    strips: dict[int, list[int]] = {1: [], -1: []}
    for k, panel in enumerate(cloth.pattern.panels):
        x, y, z = corners[cloth.panel == k].T
        level = abs(panel.matrix[2, 2]) > FRONTAL and np.ptp(y) < min(np.ptp(x), MAX_COLLAR_HEIGHT)
        # What lies on an outer cloth layer, as the fall of a collar, is put on later.
        if level and y.min() > over and not panel.cloth_layer:
            strips[1 if z.mean() > neck else -1].append(k)
    own = {side: np.isin(cloth.panel, numbers) for side, numbers in strips.items()}
    if not all(half.any() for half in own.values()):
        return
    ends = {side: np.abs(corners[half, 0]).max() for side, half in own.items()}
    radius = max(sum(ends.values()) / np.pi, MIN_RADIUS)
    down = min(float(corners[half, 1].min()) for half in own.values()) - over
    for side, half in own.items():
        angle = corners[half, 0] / ends[side] * np.pi / 2
        corners[half, 0] = radius * np.sin(angle)
        corners[half, 1] -= down
        corners[half, 2] = neck + side * radius * np.cos(angle)
