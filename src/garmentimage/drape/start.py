"""Where the cloth begins: panels round the body, sleeves along its arms, trousers along its legs.

Patterns are drawn for bodies that hold their arms and legs otherwise than ours: arms stretched out
or 45 degrees down, legs 20 degrees apart or together. A limb that begins outside of its sleeve or
trouser leg would stay outside. So before the panels are sewn,

- panels that lie wholly beyond a shoulder turn and move in the picture plane, until their middle
  line is the arm's;
- what stands out sideways of a wide skirt, which laid flat may reach up to the arms, is bent down
  round the middle of its waist;
- below the crotch, cloth that is sewn round each leg by itself (it has an **inseam**: a seam of a
  front and a back panel, both of which lie outward of it) is shifted sideways to follow the leg.

This moves where the cloth begins, not what it is: at rest it is as long as the flat panels are.
"""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.body.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.pattern.model import Side
from garmentimage.raster.place import FRONTAL

SLEEVE_INNER = 0.2
"""Sleeves stay outside of this share of the shoulder joint's distance from the middle."""
UNDER_TOP = 8.0
"""The arm goes through a wide sleeve this far under its top [cm]."""
SHORTEST_TURNED = 5.0
"""A sleeve shorter than this is moved, but not turned [cm]."""
CHEST = 0.7
"""Where the chest is on the way from the waist to the shoulder joints."""
WIDE, KEPT_BEYOND = np.deg2rad(60.0), 0.15
"""A skirt begins hanging out by this angle at most, and by this share of what is beyond it."""
HALF_ROUND = np.deg2rad(95.0)
"""Half of a circle skirt has a seam that goes on to this angle from straight down, or further."""
STRAIGHT_DOWN = np.deg2rad(30.0)
"""That seam begins within this angle from straight down."""
OUT_OF_ROUND = 0.15
"""Share of its radius by which that seam may leave a circle."""
SEAM_DEPTH = 8.0
"""A panel over a seam ends no deeper than this below the middle of the seam [cm]."""
FARTHEST = 40.0
"""A trouser leg that would have to go farther than this [cm] stands elsewhere on purpose."""
FOOT_ROOM = 2.0
"""Cloth round the feet begins at least so far in front of toes and behind heels [cm]."""
FACING_IN = 0.5
"""Least part towards the middle of the unit direction in which an inseam faces out of its panel."""

Marks = Mapping[str, Float[np.ndarray, " 3"]]


def start_points(cloth: Cloth, body: Body) -> Float[np.ndarray, "vertex 3"]:
    """Where every vertex begins: halfway between the corners that are sewn into it [cm]."""
    corners = np.empty((len(cloth.flat), 3))
    for k, panel in enumerate(cloth.pattern.panels):
        own = cloth.panel == k
        corners[own] = panel.to_world(cloth.flat[own])
    marks = body.landmarks
    if {"left_shoulder_joint", "left_wrist_joint", "waist_front"} <= marks.keys():
        for side in (1, -1):
            _lay_sleeve(cloth, corners, marks, side)
        _hang_skirts(cloth, corners, marks)
    if {"left_knee_joint", "left_ankle_joint"} <= marks.keys():
        _clear_feet(corners, body)
    if {"left_hip_joint", "left_ankle_joint", "crotch"} <= marks.keys():
        for side in (1, -1):
            _shift_leg(cloth, corners, marks, side)
    return cloth.sewn(corners)


def _lay_sleeve(cloth: Cloth, corners: np.ndarray, marks: Marks, side: int) -> None:
    """Lay the sleeve of one side (1: left) along the arm, turned and moved in the picture plane.

    The arm goes through the armhole and through the narrowest line across the sleeve's end, in the
    middle of narrow ones and `UNDER_TOP` under the top of wide ones, which hang down from it.
    """
    shoulder, wrist = (_of_side(marks, f"left_{n}_joint", side)[:2] for n in ("shoulder", "wrist"))
    sleeve = _sleeve(cloth, corners, marks, side)
    armhole = corners[_armhole(cloth, sleeve), :2]
    rings = [corners[ring, :2] for ring in _rings(cloth, sleeve)]
    lowest = (marks["waist_front"][1] + marks["crotch"][1]) / 2 if "crotch" in marks else 0.0
    if not len(armhole) or not rings or armhole[:, 1].mean() < lowest:
        return
    way = rings[0].mean(axis=0) - armhole.mean(axis=0)
    up = side * np.array([-way[1], way[0]])
    into, out = _arms_place(armhole, up), _arms_place(min(rings, key=lambda r: np.ptp(r @ up)), up)
    arm = wrist - shoulder
    long_enough = np.hypot(*(out - into)) > SHORTEST_TURNED
    turn = _angle(arm) - _angle(out - into) if long_enough else 0.0
    cos, sin = np.cos(turn), np.sin(turn)
    turned = (corners[sleeve, :2] - out) @ np.array([[cos, sin], [-sin, cos]])
    across = np.array([-arm[1], arm[0]]) / np.hypot(*arm)
    corners[sleeve, :2] = out + turned + ((shoulder - out) @ across) * across


def _sleeve(
    cloth: Cloth, corners: np.ndarray, marks: Marks, side: int
) -> Bool[np.ndarray, " corner"]:
    """Corners of the panels round the arm of one side: sleeves, and cuffs sewn to them.

    Panels of a wide skirt lie as far out, but begin no higher than the waist. The halves of a wide
    jacket's front do begin there, but no panel beside them is their back.
    """
    panels = cloth.pattern.panels
    reach = marks["left_shoulder_joint"][0]
    chest = _chest(marks)
    outer, high = set(), set()
    for k, panel in enumerate(panels):
        x, y = side * corners[cloth.panel == k, 0], corners[cloth.panel == k, 1]
        if x.min() > SLEEVE_INNER * reach and x.mean() > reach:
            outer.add(panel.name)
            if y.max() > chest:
                high.add(panel.name)
    halves = {
        side.panel
        for stitch in cloth.pattern.stitches
        if {s.panel for s in stitch.sides} <= outer
        and _faces_front(cloth, stitch.a) != _faces_front(cloth, stitch.b)
        for side in stitch.sides
    }
    found = halves & high
    joined = [{s.panel for s in stitch.sides} for stitch in cloth.pattern.stitches]
    growing = True
    while growing:
        more = {n for pair in joined if pair & found for n in pair & halves} - found
        found |= more
        growing = bool(more)
    return np.isin(cloth.panel, [k for k, panel in enumerate(panels) if panel.name in found])


def _armhole(cloth: Cloth, sleeve: Bool[np.ndarray, " corner"]) -> Bool[np.ndarray, " corner"]:
    """Corners along which a sleeve is sewn to the trunk."""
    trunk = np.zeros(cloth.vertex_count, bool)
    trunk[cloth.vertex[~sleeve]] = True
    return sleeve & trunk[cloth.vertex]


def _rings(cloth: Cloth, sleeve: Bool[np.ndarray, " corner"]) -> list[Int[np.ndarray, " n"]]:
    """Corners on lines across a sleeve: its free edges, and the seams of a cuff."""
    pattern, rings = cloth.pattern, []
    free = [
        line
        for side, line in cloth.sides.items()
        if side not in pattern.partners and sleeve[line[0]]
    ]
    if free:
        rings.append(np.concatenate(free))
    for stitch in pattern.stitches:
        a, b = (cloth.sides[side] for side in stitch.sides)
        across = _faces_front(cloth, stitch.a) == _faces_front(cloth, stitch.b)
        if across and stitch.a.panel != stitch.b.panel and sleeve[a[0]] and sleeve[b[0]]:
            rings.append(a)
    return rings


def _arms_place(
    opening: Float[np.ndarray, "n 2"], up: Float[np.ndarray, " 2"]
) -> Float[np.ndarray, " 2"]:
    """Where the arm goes through an opening of a sleeve."""
    height = opening @ up
    top, bottom = opening[height.argmax()], opening[height.argmin()]
    width = float(np.hypot(*(bottom - top)))
    return top + (bottom - top) * (min(width / 2, UNDER_TOP) / max(width, 1e-9))


def _hang_skirts(cloth: Cloth, corners: np.ndarray, marks: Marks) -> None:
    """Bend down the sides of panels that begin at the waist and would reach up to the arms."""
    reach, waist, chest = marks["left_shoulder_joint"][0], marks["waist_front"][1], _chest(marks)
    for k in range(len(cloth.pattern.panels)):
        own = np.flatnonzero(cloth.panel == k)
        seam = _round_seam(cloth, corners, k)
        if seam is not None:
            corners[own] = _cone(corners[own], *seam, least=reach)
            continue
        away, height = np.abs(corners[own, 0]), corners[own, 1]
        top = float(height[away <= reach].max(initial=waist))
        if top > chest or height.max() < chest or height.mean() > waist:
            continue
        bearing, distance = np.arctan2(away, top - height), np.hypot(away, top - height)
        out = (away > reach) & (bearing > WIDE)
        bent = WIDE + (bearing[out] - WIDE) * KEPT_BEYOND
        side = np.sign(corners[own[out], 0])
        corners[own[out], 0] = side * distance[out] * np.sin(bent)
        corners[own[out], 1] = top - distance[out] * np.cos(bent)


def _round_seam(cloth: Cloth, corners: np.ndarray, panel: int) -> tuple[float, float, float] | None:
    """The seam by which half of a circle skirt hangs from what is over it, if it has one.

    Returns:
        Height of its middle [cm], its radius [cm], and the angle to which it goes on either side
        from straight down [rad].
    """
    name, lines = cloth.pattern.panels[panel].name, []
    for stitch in cloth.pattern.stitches:
        for own, other in (stitch.sides, stitch.sides[::-1]):
            if own.panel == name != other.panel:
                line = corners[cloth.sides[own]]
                height = corners[cloth.panel == cloth.panel[cloth.sides[other][0]], 1]
                level = line[:, 1].mean()
                if height.mean() > level < height.min() + SEAM_DEPTH:
                    lines.append(line)
    if not lines:
        return None
    points = np.concatenate(lines)[:, :2]
    centre = points.mean(axis=0)
    x, y = (points - centre).T
    # A circle round (u, v): x^2 + y^2 = 2 u x + 2 v y + c; v = 0 where the seam is straight.
    matrix = np.stack([2 * x, 2 * y, np.ones(len(x))], axis=1)
    (u, v, c), *_ = np.linalg.lstsq(matrix, x * x + y * y)
    radius = float(np.sqrt(c + u * u + v * v))
    off = np.abs(np.hypot(x - u, y - v) - radius).max() / radius
    bearing = np.arctan2(x - u, v - y)
    least, most = float(min(-bearing.min(), bearing.max())), float(np.abs(bearing).max())
    hangs = least > HALF_ROUND and np.abs(bearing).min() < STRAIGHT_DOWN
    if not hangs or off > OUT_OF_ROUND or abs(centre[0] + u) > radius / 2:
        return None
    return float(centre[1] + v), radius, most


def _cone(points: np.ndarray, middle: float, radius: float, end: float, *, least: float) -> np.ndarray:
    """Half of a circle skirt laid round the body, its sides where the wearer's are [cm].

    Args:
        points: the flat half in front of the body or behind it.
        middle, radius, end: of the seam by which it hangs.
        least: least radius of that seam round the body [cm].
    """
    x, down = points[:, 0], middle - points[:, 1]
    round_body = np.clip(np.arctan2(x, down) / end, -1.0, 1.0) * np.pi / 2
    along = np.hypot(x, down) - radius
    slope = min(np.arcsin(min(2 * end / np.pi, 1.0)), WIDE)
    out = max(radius * 2 * end / np.pi, least) + along * np.sin(slope)
    side = np.sign(points[:, 2].mean())
    return np.stack(
        [
            out * np.sin(round_body),
            middle - radius - along * np.cos(slope),
            side * out * np.cos(round_body),
        ],
        axis=1,
    )


def _shift_leg(cloth: Cloth, corners: np.ndarray, marks: Marks, side: int) -> None:
    """Shift the trouser leg of one side (1: left) sideways until it follows the leg.

    The inseams of wide legs go no further than to the middle: the other leg is beyond it.
    """
    hip, ankle = (_of_side(marks, f"left_{n}_joint", side) for n in ("hip", "ankle"))
    crotch = float(marks["crotch"][1])
    inseams = [
        s
        for stitch in cloth.pattern.stitches
        if all(_is_inseam(cloth, corners, s, side, crotch) for s in stitch.sides)
        and _faces_front(cloth, stitch.a) != _faces_front(cloth, stitch.b)
        for s in stitch.sides
    ]
    panels = {s.panel for s in inseams}
    numbers = [k for k, p in enumerate(cloth.pattern.panels) if p.name in panels]
    own = np.isin(cloth.panel, numbers) & (side * corners[:, 0] > 0)
    leg = own & (corners[:, 1] < crotch)
    if leg.sum() < 3 or np.ptp(corners[leg, 1]) < 1.0:
        return
    slope, offset = np.polyfit(corners[leg, 1], corners[leg, 0], 1)
    inner = np.polyfit(*corners[np.concatenate([cloth.sides[s] for s in inseams])][:, [1, 0]].T, 1)
    slope_of_leg = (ankle[0] - hip[0]) / (ankle[1] - hip[1])
    height = corners[own, 1]
    low = np.minimum(height, crotch)
    shift = hip[0] + slope_of_leg * (low - hip[1]) - (offset + slope * low)
    shift = side * np.maximum(side * shift, -np.maximum(side * np.polyval(inner, low), 0.0))
    if np.abs(shift).max() > FARTHEST:
        return
    top = max(float(height.max()), crotch + 1.0)
    corners[own, 0] += shift * np.clip((top - height) / (top - crotch), 0.0, 1.0)


def _clear_feet(corners: np.ndarray, body: Body) -> None:
    """Shorten what hangs below the knees until it ends over the feet, on which it then falls."""
    knee, ankle = (body.landmarks[f"left_{name}_joint"][1] for name in ("knee", "ankle"))
    lowest = float(corners[:, 1].min())
    if lowest < ankle + FOOT_ROOM:
        low = corners[:, 1] < knee
        corners[low, 1] = knee - (knee - corners[low, 1]) * (knee - ankle - FOOT_ROOM) / (knee - lowest)


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


def _chest(marks: Marks) -> float:
    """Height of the chest, over skirts and under the tops of sleeves [cm]."""
    shoulder, waist = marks["left_shoulder_joint"][1], marks["waist_front"][1]
    return float(waist + CHEST * (shoulder - waist))


def _faces_front(cloth: Cloth, of: Side) -> bool:
    """Whether the panel of an edge faces the front."""
    panel = cloth.pattern.by_name[of.panel]
    return bool(panel.matrix[2, 2] * np.sign(panel.outline.area) > 0)


def _of_side(marks: Marks, name: str, side: int) -> Float[np.ndarray, " 3"]:
    return marks[name] * [side, 1, 1]


def _angle(way: Float[np.ndarray, " 2"]) -> float:
    return float(np.arctan2(way[1], way[0]))
