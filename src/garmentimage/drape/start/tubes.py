"""Tubes begin round the body: panels sewn to themselves all round, as a skirt of one rectangle."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from garmentimage.drape.cloth import Cloth
from garmentimage.pattern import tube_sides

DEPTH = 0.75  # depth of the ellipse round which a tube is laid, as a share of its width


def roll_tubes(cloth: Cloth, corners: Float[np.ndarray, "corner 3"], depth: float) -> None:
    """Lay tubes round the body, in place, their seam on the other side of it.

    How far round a corner begins is its distance from one side, over that from both; as far round
    is the ellipse on which it lies, whose middle has this `depth` [cm].
    """
    for k, panel in enumerate(cloth.pattern.panels):
        sides = tube_sides(cloth.pattern, panel)
        if sides is None:
            continue
        own = np.flatnonzero(cloth.panel == k)
        left, right = (np.concatenate([cloth.sides[side] for side in each]) for each in sides)
        flat = corners[own, :2]
        away = [cKDTree(corners[line, :2]).query(flat)[0] for line in (left, right)]
        girth = away[0] + away[1]
        turn = 2 * np.pi * (away[0] / np.maximum(girth, 1e-9) - 0.5)
        half = girth / (2 * np.pi * np.sqrt((1 + DEPTH**2) / 2))
        middle = (corners[left, 0].mean() + corners[right, 0].mean()) / 2
        front = np.sign(panel.matrix[2, 2] * panel.outline.area)
        corners[own, 0] = middle + half * np.sin(turn)
        corners[own, 2] = depth + front * DEPTH * half * np.cos(turn)
