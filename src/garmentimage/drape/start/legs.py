"""Trousers begin along the legs, and all hems over the feet.

Below the crotch, cloth that is sewn round each leg by itself (it has an **inseam**: a seam of a
front and a back panel, both of which lie outward of it) is shifted sideways to follow the leg.
"""

import numpy as np

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.start.sides import Landmarks, faces_front, of_side
from garmentimage.pattern import FRONTAL, Side

MAX_SHIFT = 40.0
"""A trouser leg that would have to go farther than this [cm] stands elsewhere on purpose."""
FOOT_ROOM = 2.0  # hems begin at least so far over the ankle joints [cm]
FACING_IN = 0.5
"""Least part towards the middle of the unit direction in which an inseam faces out of its panel."""


def shift_leg(cloth: Cloth, corners: np.ndarray, landmarks: Landmarks, side: int) -> None:
    """Shift the trouser leg of one side (1: left) sideways until it follows the leg.

    The inseams of wide legs go no further than to the middle: the other leg is beyond it.
    """
    hip, ankle = (of_side(landmarks, f"left_{n}_joint", side) for n in ("hip", "ankle"))
    crotch = float(landmarks["crotch"][1])
    inseams = [
        s
        for stitch in cloth.pattern.stitches
        if all(_is_inseam(cloth, corners, s, side, crotch) for s in stitch.sides)
        and faces_front(cloth, stitch.a) != faces_front(cloth, stitch.b)
        for s in stitch.sides
    ]
    panels = {s.panel for s in inseams}
    numbers = [k for k, p in enumerate(cloth.pattern.panels) if p.name in panels]
    own = np.isin(cloth.panel, numbers) & (side * corners[:, 0] > 0)
    leg = own & (corners[:, 1] < crotch)
    if leg.sum() < 3 or np.ptp(corners[leg, 1]) < 1.0:
        return
    slope, offset = np.polyfit(corners[leg, 1], corners[leg, 0], 1)
    inseam = corners[np.concatenate([cloth.sides[s] for s in inseams])]
    inner = np.polyfit(inseam[:, 1], inseam[:, 0], 1)
    slope_of_leg = (ankle[0] - hip[0]) / (ankle[1] - hip[1])
    height = corners[own, 1]
    low = np.minimum(height, crotch)
    shift = hip[0] + slope_of_leg * (low - hip[1]) - (offset + slope * low)
    shift = side * np.maximum(side * shift, -np.maximum(side * np.polyval(inner, low), 0.0))
    if np.abs(shift).max() > MAX_SHIFT:
        return
    top = max(float(height.max()), crotch + 1.0)
    corners[own, 0] += shift * np.clip((top - height) / (top - crotch), 0.0, 1.0)


def _is_inseam(cloth: Cloth, corners: np.ndarray, of: Side, side: int, crotch: float) -> bool:
    """Whether an edge lies below the crotch, on one side, and its panel outward of it."""
    line = cloth.sides[of]
    middle = corners[line].mean(axis=0)
    panel = cloth.pattern.by_name[of.panel]
    if middle[1] > crotch or side * middle[0] < 0 or abs(panel.matrix[2, 2]) < FRONTAL:
        return False
    along = cloth.flat[line[-1]] - cloth.flat[line[0]]
    turn = 1.0 if panel.outline.area > 0 else -1.0
    outward = panel.matrix[:, :2] @ (turn * np.array([along[1], -along[0]]))
    return bool(-side * outward[0] > FACING_IN * np.linalg.norm(along))


def clear_feet(corners: np.ndarray, body: Body) -> None:
    """Shorten what hangs below the knees until it ends over the feet, on which it then falls."""
    knee, ankle = (body.landmarks[f"left_{name}_joint"][1] for name in ("knee", "ankle"))
    end, lowest = ankle + FOOT_ROOM, float(corners[:, 1].min())
    if lowest < end:
        low = corners[:, 1] < knee
        corners[low, 1] = knee - (knee - corners[low, 1]) * (knee - end) / (knee - lowest)
