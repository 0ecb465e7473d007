"""Tubes begin round the body: panels sewn to themselves all round, as a skirt of one rectangle."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from garmentimage.drape.cloth import Cloth
from garmentimage.pattern import tube_sides

DEPTH = 0.75  # depth of the ellipse round which a skirt is laid, as a share of its width
ACROSS, UP, AHEAD = range(3)
"""Axes of the world."""


def roll_tubes(cloth: Cloth, corners: Float[np.ndarray, "corner 3"], depth: float) -> None:
    """Lay tubes round the body or an arm, in place, their seam on the other side of it.

    How far round a corner begins is its distance from one side, over that from both; as far round
    is the ellipse on which it lies. Tubes in front and behind have their middle at this `depth`
    [cm]; a sleeve that lies over the arm has it beneath.
    """
    for k, panel in enumerate(cloth.pattern.panels):
        sides = tube_sides(cloth.pattern, panel)
        if sides is None:
            continue
        own = np.flatnonzero(cloth.panel == k)
        lines = [np.concatenate([cloth.sides[side] for side in each]) for each in sides]
        ends = np.array([corners[line].mean(axis=0) for line in lines])
        along = int(np.abs(ends[1] - ends[0]).argmax())
        out = AHEAD if abs(panel.matrix[AHEAD, 2]) > abs(panel.matrix[UP, 2]) else UP
        if along == out or (along, out) == (ACROSS, UP):
            continue
        away = [cKDTree(corners[line]).query(corners[own])[0] for line in lines]
        girth = away[0] + away[1]
        turn = 2 * np.pi * (away[0] / np.maximum(girth, 1e-9) - 0.5)
        share = DEPTH if along == ACROSS else 1.0
        half = girth / (2 * np.pi * np.sqrt((1 + share**2) / 2))
        outward = np.sign(panel.matrix[out, 2] * panel.outline.area)
        middle = depth if out == AHEAD else corners[own, UP] - outward * half
        corners[own, along] = ends[:, along].mean() + half * np.sin(turn)
        corners[own, out] = middle + outward * share * half * np.cos(turn)
