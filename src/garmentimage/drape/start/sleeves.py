"""Sleeves begin along the arms: panels that lie wholly beyond a shoulder."""

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.start.sides import Landmarks, chest, faces_front, of_side
from garmentimage.pattern import tube_sides

SLEEVE_INNER = 0.2
"""Sleeves lie outside of this share of the shoulder joint's distance from the middle."""
UNDER_TOP = 8.0  # the arm goes through a wide sleeve this far under its top [cm]
MIN_TURNED_LENGTH = 5.0  # a sleeve shorter than this is moved, but not turned [cm]


def lay_sleeve(cloth: Cloth, corners: np.ndarray, landmarks: Landmarks, side: int) -> None:
    """Lay the sleeve of one side (1: left) along the arm, turned and moved in the picture plane.

    The arm goes through the armhole and through the narrowest line across the sleeve's end, in the
    middle of narrow ones and `UNDER_TOP` under the top of wide ones, which hang down from it.
    """
    shoulder, wrist = (
        of_side(landmarks, f"left_{n}_joint", side)[:2] for n in ("shoulder", "wrist")
    )
    sleeve = _sleeve(cloth, corners, landmarks, side)
    on_trunk = np.zeros(cloth.vertex_count, bool)
    on_trunk[cloth.vertex[~sleeve]] = True
    armhole = corners[sleeve & on_trunk[cloth.vertex], :2]
    rings = [corners[ring, :2] for ring in _rings(cloth, sleeve)]
    if not len(armhole) or not rings:
        return
    along = rings[0].mean(axis=0) - armhole.mean(axis=0)
    up = side * np.array([-along[1], along[0]])
    into, out = _arms_place(armhole, up), _arms_place(min(rings, key=lambda r: np.ptp(r @ up)), up)
    arm = wrist - shoulder
    long_enough = np.hypot(*(out - into)) > MIN_TURNED_LENGTH
    turn = _angle(arm) - _angle(out - into) if long_enough else 0.0
    cos, sin = np.cos(turn), np.sin(turn)
    turned = (corners[sleeve, :2] - out) @ np.array([[cos, sin], [-sin, cos]])
    across = np.array([-arm[1], arm[0]]) / np.hypot(*arm)
    corners[sleeve, :2] = out + turned + ((shoulder - out) @ across) * across


def _sleeve(
    cloth: Cloth, corners: np.ndarray, landmarks: Landmarks, side: int
) -> Bool[np.ndarray, " corner"]:
    """Corners of the panels round the arm of one side: sleeves, and cuffs sewn to them.

    Panels of a wide skirt lie as far out, but begin no higher than the waist. The halves of a wide
    jacket's front do begin there, but no panel beside them is their back.
    """
    panels = cloth.pattern.panels
    reach = landmarks["left_shoulder_joint"][0]
    least = chest(landmarks)
    outer, high = set(), set()
    for k, panel in enumerate(panels):
        x, y = side * corners[cloth.panel == k, 0], corners[cloth.panel == k, 1]
        if x.min() > SLEEVE_INNER * reach and x.mean() > reach:
            outer.add(panel.name)
            if y.max() > least:
                high.add(panel.name)
    halves = {
        half.panel
        for stitch in cloth.pattern.stitches
        if {s.panel for s in stitch.sides} <= outer
        and faces_front(cloth, stitch.a) != faces_front(cloth, stitch.b)
        for half in stitch.sides
    }
    # A sleeve of one panel has no halves.
    halves |= {n for n in outer if tube_sides(cloth.pattern, cloth.pattern.by_name[n])}
    found = halves & high
    joined = [{s.panel for s in stitch.sides} for stitch in cloth.pattern.stitches]
    growing = True
    while growing:
        more = {n for pair in joined if pair & found for n in pair & halves} - found
        found |= more
        growing = bool(more)
    return np.isin(cloth.panel, [k for k, panel in enumerate(panels) if panel.name in found])


def _rings(cloth: Cloth, sleeve: Bool[np.ndarray, " corner"]) -> list[Int[np.ndarray, " _"]]:
    """Corners on lines across a sleeve: its free edges, and the seams of a cuff.

    Stitches between the same two panels are one seam, whose edges are divided.
    """
    pattern = cloth.pattern
    free = [
        line
        for side, line in cloth.sides.items()
        if side not in pattern.partners and sleeve[line[0]]
    ]
    seams: dict[frozenset[str], list[Int[np.ndarray, " _"]]] = {}
    for stitch in pattern.stitches:
        a, b = (cloth.sides[side] for side in stitch.sides)
        across = faces_front(cloth, stitch.a) == faces_front(cloth, stitch.b)
        if across and stitch.a.panel != stitch.b.panel and sleeve[a[0]] and sleeve[b[0]]:
            seams.setdefault(frozenset({stitch.a.panel, stitch.b.panel}), []).append(a)
    return [np.concatenate(lines) for lines in (free, *seams.values()) if lines]


def _arms_place(
    opening: Float[np.ndarray, "n 2"], up: Float[np.ndarray, " 2"]
) -> Float[np.ndarray, " 2"]:
    """Where the arm goes through an opening of a sleeve."""
    height = opening @ up
    top, bottom = opening[height.argmax()], opening[height.argmin()]
    width = float(np.hypot(*(bottom - top)))
    place: np.ndarray = top + (bottom - top) * (min(width / 2, UNDER_TOP) / max(width, 1e-9))
    return place


def _angle(v: Float[np.ndarray, " 2"]) -> float:
    return float(np.arctan2(v[1], v[0]))
