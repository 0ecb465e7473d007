"""Skin that comes through cloth, between its vertices, too."""

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.body import Body
from garmentimage.drape.solver import body_field

PARTS = 3  # triangles are checked at the corners of a grid with so many parts a side
HAND = 25.0  # a hand ends no farther than this from the wrist [cm]


def deepest(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"], body: Body
) -> float:
    """Greatest depth of the cloth under the skin [cm]; 0 where none is.

    On hands only vertices count: fingers are thinner than triangles are long.
    """
    field = body_field(body)
    corners = points[faces]
    corners = corners[~_on_hand(corners.mean(axis=1), body)]
    least = float(field.at(points).min(initial=0.0))
    for i in range(PARTS):
        for j in range(PARTS - i + 1):
            share = np.array([i, j, PARTS - i - j]) / PARTS
            places = np.einsum("k,fkx->fx", share, corners)
            least = min(least, float(field.at(places).min(initial=0.0)))
    return abs(least)


def _on_hand(points: Float[np.ndarray, "n 3"], body: Body) -> Bool[np.ndarray, " n"]:
    """Which places are at a hand; none on a body without landmarks of the arms."""
    elbow, wrist = (body.landmarks.get(f"left_{name}_joint") for name in ("elbow", "wrist"))
    if elbow is None or wrist is None:
        return np.zeros(len(points), bool)
    off = points * np.where(points[:, :1] < 0, [-1.0, 1.0, 1.0], 1.0) - wrist
    at_hand: np.ndarray = (off @ (wrist - elbow) > 0) & (np.linalg.norm(off, axis=1) < HAND)
    return at_hand
