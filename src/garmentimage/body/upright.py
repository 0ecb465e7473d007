"""Bodies as files have them, turned to stand: y up, facing +z, on the floor, in cm.

Left and right of a body are alike, and from front to back it is thinner than it is wide or high.
So the plane of symmetry is searched among those that hold the thinnest direction, by reflecting
the body and fitting the plane to the points that then lie nearest. In that plane only the legs
leave the middle empty, which distinguishes up from down; toes distinguish front from back.
"""

import warnings
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body.body import Points3, Vector3
from garmentimage.errors import DraftError

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

STATURES = (0.9, 2.28)
"""Least and greatest stature of a body [m]; outside of it, the unit is another."""
UNITS = {"m": 100.0, "ft": 30.48, "dm": 10.0, "in": 2.54, "cm": 1.0, "mm": 0.1}
"""Units that a file may be in, and their lengths [cm]; no stature is one in two of them."""
ADULT = 135.0  # bodies that are smaller [cm] may have other proportions than adults
FOOT = 0.03
"""Height up to which a foot shows where its toes point, as a share of the stature."""
ANKLE = (0.05, 0.08)
"""Heights between which the leg lies above the heel, as shares of the stature."""
SAMPLE = 1500  # points of the skin, evenly by area, that show how a body stands
PLANES = 12  # planes from which the search for the plane of symmetry starts
FITS, KEPT = 12, 0.9
"""Times that a plane is fitted, and share of the points, the best ones, that it is fitted to."""
MIDDLE = 0.02
"""Points nearer to the plane of symmetry than this share of the body's size are in its middle."""
STRAIGHT, SQUARE = np.deg2rad(4.0), np.deg2rad(2.0)
"""Bodies that lean by less, and that are turned by less about the vertical, are left so."""
MAX_LEANING = np.deg2rad(30.0)  # a body that leans more lies or sits
MIDDLE_OFF = 0.3
"""The middle of the span is x = 0 unless the plane of symmetry lies farther from it [cm]: the hands
may be unlike."""


def upright(points: Points3, faces: Int[np.ndarray, "face 3"]) -> Points3:
    """The points of a file in cm, y up, feet on the floor, facing +z, left and right of x = 0.

    Raises:
        DraftError: no part of it stands, or its size is not that of a body.
    """
    skin = _sample(points, faces)
    across = _symmetry(skin)
    up = _up(skin, across)
    axis = _axis(up)
    lean = _angle(up, axis)
    if lean > MAX_LEANING:
        raise DraftError(
            f"leans by {np.rad2deg(lean):.0f} degrees; stand it upright, arms out and legs apart"
        )
    if lean > STRAIGHT:
        warnings.warn(
            f"the body leans by {np.rad2deg(lean):.0f} degrees; it is put upright", stacklevel=3
        )
    else:
        up = axis
    if up.min() < -0.5:
        warnings.warn("the body stands on its head; it is turned over", stacklevel=3)
    across = _unit_vector(across - (across @ up) * up)
    if _angle(across, _axis(across)) < SQUARE:
        across = _unit_vector(_axis(across) - (_axis(across) @ up) * up)
    frame = np.stack([across, up, np.cross(across, up)])
    points = points @ frame.T
    points = points * _unit(float(np.ptp(points[:, 1])))
    low, high = points.min(0), points.max(0)
    middle = _middle(_sample(points, faces), low[0], high[0])
    points = points - [middle, low[1], (low[2] + high[2]) / 2]
    return points if _toes_forward(points) else points * [-1, 1, -1]


def _sample(points: Points3, faces: Int[np.ndarray, "face 3"]) -> Float[np.ndarray, "sample 3"]:
    """Points of the skin, evenly by area."""
    a, b, c = np.moveaxis(points[faces], 1, 0)
    area = np.cumsum(np.linalg.norm(np.cross(b - a, c - a), axis=1))
    at = np.searchsorted(area, (np.arange(SAMPLE) + 0.5) / SAMPLE * area[-1])
    centre: np.ndarray = ((a + b + c) / 3)[at]
    return centre


def _symmetry(skin: Points3) -> Vector3:
    """The direction across the body: square to its plane of symmetry."""
    from scipy.spatial import cKDTree

    tree = cKDTree(skin)
    _, axes = np.linalg.eigh(np.cov(skin.T))
    turns = np.pi / PLANES * np.arange(PLANES)
    planes = [
        _fitted(skin, tree, np.cos(turn) * axes[:, 1] + np.sin(turn) * axes[:, 2]) for turn in turns
    ]
    return min(planes, key=lambda plane: plane[1])[0]


def _fitted(skin: Points3, tree: "cKDTree", normal: Vector3) -> tuple[Vector3, float]:
    """The plane of symmetry nearest to a plane through the middle, and how far it misses.

    Iterated closest points: each point is paired with the nearest to its reflection, and the pairs
    give the plane in closed form. Its normal is the direction in which the two vary least together.
    """
    offset = skin.mean(0) @ normal
    for _ in range(FITS):
        reflected = skin - 2 * (skin @ normal - offset)[:, None] * normal
        gap, near = tree.query(reflected)
        best = np.argsort(gap, kind="stable")[: int(KEPT * len(skin))]
        first, second = skin[best], skin[near[best]]
        both = (first - first.mean(0)).T @ (second - second.mean(0))
        normal = np.linalg.eigh(both + both.T)[1][:, 0]
        offset = (first.mean(0) + second.mean(0)) @ normal / 2
    return normal, float(gap[best].mean())


def _up(skin: Points3, across: Vector3) -> Vector3:
    """The long axis of the body in its plane of symmetry, towards the head."""
    away = skin @ across
    flat = skin - away[:, None] * across
    up = np.linalg.eigh(np.cov(flat.T))[1][:, 2]
    up = _unit_vector(up - (up @ across) * across)
    height = skin @ up
    middle = (away.max() + away.min()) / 2
    inner = height[np.abs(away - middle) < MIDDLE * np.ptp(height)]
    # The end that the middle of the body reaches is the head.
    return up if height.max() - inner.max() < inner.min() - height.min() else -up


def _axis(direction: Vector3) -> Vector3:
    """The axis of the file, or its opposite, nearest to a direction."""
    k = int(np.abs(direction).argmax())
    axis = np.zeros(3)
    axis[k] = np.sign(direction[k])
    return axis


def _angle(a: Vector3, b: Vector3) -> float:
    return float(np.arccos(np.clip(a @ b, -1, 1)))


def _unit_vector(v: Vector3) -> Vector3:
    unit: Vector3 = v / np.linalg.norm(v)
    return unit


def _middle(skin: Points3, low: float, high: float) -> float:
    """Where x = 0 should be: the middle of the span, or the plane of symmetry if that is not it."""
    from scipy.spatial import cKDTree

    offset = middle = (low + high) / 2
    tree = cKDTree(skin)
    for _ in range(FITS):
        gap, near = tree.query(skin * [-1, 1, 1] + 2 * offset * np.array([1.0, 0.0, 0.0]))
        best = np.argsort(gap, kind="stable")[: int(KEPT * len(skin))]
        offset = float(np.mean(skin[best, 0] + skin[near[best], 0])) / 2
    return offset if abs(offset - middle) > MIDDLE_OFF else middle


def _unit(height: float) -> float:
    """The unit of a file in which a body has this height [cm]."""
    low, high = STATURES
    for size in UNITS.values():
        if low * 100 <= height * size <= high * 100:
            return size
    raise DraftError(
        f"is {height:g} units high; a body is {low:g} to {high:g} m in {', '.join(UNITS)}"
    )


def _toes_forward(points: Points3) -> bool:
    height, depth = points[:, 1] / np.ptp(points[:, 1]), points[:, 2]
    foot, leg = depth[height < FOOT], depth[(height > ANKLE[0]) & (height < ANKLE[1])]
    middle = (leg.max() + leg.min()) / 2 if len(leg) else 0.0
    return bool(foot.max() - middle >= middle - foot.min())
