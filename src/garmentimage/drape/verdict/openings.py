"""Openings of a garment, and the limbs that go through them.

Words of this file:

- An **opening** is a closed line of cloth edges with cloth on one side only: a neckline, a hem,
  an armhole without a sleeve.
- A **bone** is a line from the middle of the chest through a limb and on beyond it: head, arms,
  legs.
- An opening **turns** round a bone as often as it goes round it. Cloth that is moved without
  passing through the body keeps its turns, so they distinguish a garment that is still worn from
  one that a limb has gone through.
"""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body import Body, agreeing

BONES: Mapping[str, tuple[str, ...]] = {
    "head": ("neck_joint", "face"),
    "left arm": ("left_shoulder_joint", "left_elbow_joint", "left_wrist_joint"),
    "right arm": ("right_shoulder_joint", "right_elbow_joint", "right_wrist_joint"),
    "left leg": ("left_hip_joint", "left_knee_joint", "left_ankle_joint"),
    "right leg": ("right_hip_joint", "right_knee_joint", "right_ankle_joint"),
}
"""Landmarks along each bone, from the chest outward. `face` is halfway from the neck to the crown;
there the bone turns to the front, since a hood closes over the crown."""

BEYOND = 500.0  # how far a bone extends beyond its last landmark [cm]

BESIDE = np.array([0.0137, 0.0071, 0.0113])
"""Bones lie this far beside their landmarks [cm]: a symmetric garment has vertices in the middle
plane, and a bone that hits an edge of an opening's fan would go through two of its triangles."""

HAND = 12.0
"""An opening that lies farther than this beyond the last landmark of a limb [cm] need not go round
it: long sleeves hang down from the hand."""

SOLE, KNEE = 3.0, 30.0
"""Nor need one round a leg that lies lower than this over the floor [cm], as feet point forward; a
limb that ends lower than a knee and points down is a leg."""

CHEST = 0.7  # height of the middle of the chest between the hips (0) and the neck (1)


def bones(body: Body) -> dict[str, Float[np.ndarray, "_ 3"]] | None:
    """Every bone as a line of points [cm]; None where the body lacks a landmark."""
    marks = {
        **{name.replace("left", "right"): p * [-1, 1, 1] for name, p in body.landmarks.items()},
        **body.landmarks,
    }
    if "neck_joint" in marks and "crown" in marks:
        marks["face"] = (marks["neck_joint"] + marks["crown"]) / 2
    if any(name not in marks for names in BONES.values() for name in names):
        return None
    hips = (marks["left_hip_joint"] + marks["right_hip_joint"]) / 2
    chest = hips + CHEST * (marks["neck_joint"] - hips)
    lines = {}
    for name, names in BONES.items():
        line = np.array([chest, *(marks[n] for n in names)])
        along = np.array([0.0, 0.0, 1.0]) if name == "head" else line[-1] - line[-2]
        end = line[-1] + BEYOND * along / np.linalg.norm(along)
        lines[name] = np.vstack([line, end]) + BESIDE
    return lines


def openings(faces: Int[np.ndarray, "face 3"]) -> list[Int[np.ndarray, " _"]]:
    """The closed lines of vertices round every opening, longest first.

    Where openings meet in one vertex, lines end there and continue arbitrarily but alike on
    every run; their turns add up all the same.
    """
    # Lapels are sewn on with the same side of the cloth down.
    directed = agreeing(faces)[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    low, high = directed.min(axis=1), directed.max(axis=1)
    key = low.astype(np.int64) * (high.max() + 1) + high
    _, edge, uses = np.unique(key, return_inverse=True, return_counts=True)
    free = directed[uses[edge] == 1]
    following: dict[int, list[int]] = {}
    for a, b in free.tolist():
        following.setdefault(a, []).append(b)
    lines = []
    while following:
        line = [next(iter(following))]
        while line[-1] in following:
            ahead = following[line[-1]]
            line.append(ahead.pop())
            if not ahead:
                del following[line[-2]]
            if line[-1] == line[0]:
                break
        if line[-1] == line[0]:
            lines.append(np.array(line[:-1]))
    return sorted(lines, key=len, reverse=True)


def turns(
    line: Float[np.ndarray, "n 3"], bones: Mapping[str, Float[np.ndarray, "_ 3"]]
) -> tuple[int, ...]:
    """How often a closed line goes round each bone, in the order of `BONES`, head taken off.

    A line that is lifted over the middle of the chest goes round every bone once more; taking
    off the turns round the head makes the result independent of where the chest is.
    """
    counts = _signed_crossings(line, [bones[name] for name in BONES])
    return tuple(c - counts[0] for c in counts[1:])


def is_beyond(line: Float[np.ndarray, "n 3"], bone: Float[np.ndarray, "m 3"]) -> bool:
    """Whether an opening lies beyond the end of a limb."""
    outward, middle = (bone[-1] - bone[-2]) / BEYOND, line.mean(axis=0)
    points_down = -outward[1] > abs(outward[0])
    at_feet = points_down and bone[-2, 1] < KNEE and middle[1] < SOLE
    return bool(at_feet or (middle - bone[-2]) @ outward > HAND)


def _signed_crossings(line: np.ndarray, bones: list[np.ndarray]) -> list[int]:
    """Signed number of times that each bone goes through the fan spanned by a closed line."""
    a = np.broadcast_to(line.mean(axis=0), line.shape)[:, None]
    b, c = line[:, None], np.roll(line, -1, axis=0)[:, None]
    p = np.concatenate([bone[:-1] for bone in bones])[None]
    q = np.concatenate([bone[1:] for bone in bones])[None]
    above, below = _volumes(a, b, c, p) > 0, _volumes(a, b, c, q) > 0
    sides = np.stack([_volumes(p, q, u, v) > 0 for u, v in ((a, b), (b, c), (c, a))])
    through = (above != below) & (sides == sides[0]).all(axis=0)
    counts = (through * np.where(above, 1, -1)).sum(axis=0)
    first = np.cumsum([0, *(len(bone) - 1 for bone in bones[:-1])])
    return [int(n) for n in np.add.reduceat(counts, first)]


def _volumes(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Six times the signed volumes of tetrahedra, coordinate by coordinate as numpy is fast at."""
    ux, uy, uz = np.moveaxis(b - a, -1, 0)
    vx, vy, vz = np.moveaxis(c - a, -1, 0)
    wx, wy, wz = np.moveaxis(d - a, -1, 0)
    volumes: np.ndarray = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz)
    volumes += wz * (ux * vy - uy * vx)
    return volumes
