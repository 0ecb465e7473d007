"""Measurements taken off a body mesh by rule, as a tailor's tape would take them.

A girth cuts the mesh with a plane and goes round one outline of the cut: the arms give outlines of
their own and so never enter a girth of the trunk. A tape is taut: it bridges hollows, so a girth is
the length of the outline's convex hull, and a length over the body that of the hull between two
points. Every rule uses points that the arms do not move, so the pose does not matter.
"""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

from garmentimage.body.body import Body, Points3, Vector3
from garmentimage.body.body_measurements import BodyMeasurements
from garmentimage.geometry import component_labels

HIP_RANGE = (0.25, 0.75)  # share of the way from crotch to waist in which the seat stands out most
BELOW_CROTCH = 0.015
"""How far below the crotch the thigh is measured, as a share of the crotch height."""
ACROMION_OFFSET = 0.1
"""The shoulder point lies this share of the shoulder joint's distance from the middle further out
than the joint: the end of the bone lies over the outer half of the joint's ball."""
ARMHOLE_LEVEL = 0.6
"""Share of the way from armpit to shoulder point up which chest and back are measured across."""
CHEST_PLATE, CHEST_SIDE = 0.9, 1.06
"""A raised arm pulls the skin below it outwards. So the tape round the bust follows the skin only
to the first share of the distance from the middle to the side of the ribs, and goes round the side
at the second, where it lies on a body whose arms hang."""
FRONT_ARMHOLE = 0.96
"""The armhole line runs below the shoulder joint at the back, and this much nearer to the middle
at the front, where the arm swings."""
LEG_SAMPLES = 40
"""Cuts between knee and ankle among which the thickest and the thinnest are chosen."""
CALF_END = 0.6
"""Share of the way from knee to ankle above which the calf lies, and below which the ankle."""
STRIP = 3.0  # half the width of the body over which a tape through the legs lies [cm]
ON_EDGE = 1e-9  # how far outside a triangle, as a share of it, a line still hits it

Flat = Float[np.ndarray, "point 2"]
Vector2 = Float[np.ndarray, " 2"]

ACROSS, UP, FORWARD = np.eye(3)


def measure(body: Body) -> BodyMeasurements:
    """All measurements of a shipped body [cm], to 0.1 cm; the wearer's left side is measured."""
    place = body.landmarks
    shoulder, neck, bust = shoulder_point(body), place["left_neck_point"], place["left_bust_point"]
    waist, cervical = place["waist_front"][1], place["cervical"]
    hip, scye = _hip_height(body), place["scye_back"][1]
    armhole = scye + ARMHOLE_LEVEL * (shoulder[1] - scye)
    values = {
        "stature": np.ptp(body.vertices[:, 1]),
        "cervical_height": cervical[1],
        "neck_point_height": neck[1],
        "shoulder_height": shoulder[1],
        "bust_height": bust[1],
        "waist_height": waist,
        "hip_height": hip,
        "crotch_height": place["crotch"][1],
        "head_girth": _slanted_girth(body, place["forehead"], place["head_back"]),
        "neck_base_girth": _neck_base_girth(body),
        "bust_girth": _bust_girth(body),
        "underbust_girth": _level_girth(body, place["left_underbust"][1]),
        "waist_girth": _level_girth(body, waist),
        "hip_girth": _level_girth(body, hip),
        "shoulder_length": _distance(neck, shoulder),
        "shoulder_width": 2 * shoulder[0],
        "across_back": _across(body, armhole, -1),
        "across_front": _across(body, armhole, 1),
        "bust_point_distance": 2 * bust[0],
        "back_waist_length": back_length(body, cervical[1], waist),
        "front_waist_length": _front_waist_length(body),
        "armscye_depth": back_length(body, cervical[1], scye),
        "total_crotch_length": _crotch_length(body, waist),
        "bust_depth": _depth(body, bust[1]),
        "waist_depth": _depth(body, waist),
        "hip_depth": _depth(body, hip),
    }
    values |= _leg(body) | _arm(body, shoulder)
    return BodyMeasurements(**{name: round(float(value), 1) for name, value in values.items()})


def cut(body: Body, point: Vector3, normal: Vector3) -> list[Points3]:
    """The outlines in which a plane cuts the mesh, each as its points in no particular order."""
    height = (body.vertices - point) @ normal
    above = height > 0
    crossed = body.faces[above[body.faces].any(1) & ~above[body.faces].all(1)]
    sides = np.concatenate([crossed[:, [0, 1]], crossed[:, [1, 2]], crossed[:, [2, 0]]])
    crosses = above[sides[:, 0]] != above[sides[:, 1]]
    ends, face = sides[crosses], np.tile(np.arange(len(crossed)), 3)[crosses]
    # One number for both directions of an edge, as whole rows are slow to compare.
    number = ends.min(1).astype(np.int64) * len(height) + ends.max(1)
    edges, index = np.unique(number, return_inverse=True)
    # Each cut face joins the two of its edges that the plane crosses.
    pair = index[np.argsort(face, kind="stable")].reshape(-1, 2)
    outline = component_labels(len(edges), pair)
    a, b = np.divmod(edges, len(height))
    share = height[a] / (height[a] - height[b])
    points = body.vertices[a] + share[:, None] * (body.vertices[b] - body.vertices[a])
    return [points[outline == k] for k in range(outline.max(initial=-1) + 1)]


def outline_at(body: Body, point: Vector3, normal: Vector3) -> Points3:
    """The outline of a cut whose middle lies nearest to `point`."""
    return min(
        cut(body, point, normal), key=lambda ring: _distance((ring.min(0) + ring.max(0)) / 2, point)
    )


def trunk_outline(body: Body, height: float) -> Points3:
    """The outline of the trunk in a level cut; below the crotch there is none."""
    return outline_at(body, height * UP, UP)


def taut_girth(outline: Flat) -> float:
    """Length of a tape round an outline [cm]."""
    from scipy.spatial import ConvexHull

    return float(ConvexHull(outline).area)


def taut_length(points: Flat, start: Vector2, end: Vector2) -> float:
    """Length of a tape from `start` to `end` [cm] over the points left of the line between them.

    Only points count whose first coordinate lies between those of the ends.

    Example:
        >>> roof = np.array([[1.0, 1.0], [1.0, -5.0], [9.0, 9.0]])
        >>> round(taut_length(roof, np.array([0.0, 0.0]), np.array([2.0, 0.0])), 3)
        2.828
    """
    along = end - start
    chord = float(np.hypot(*along))
    offset = points - start
    left = along[0] * offset[:, 1] - along[1] * offset[:, 0] > ON_EDGE
    between = (points[:, 0] - start[0]) * (points[:, 0] - end[0]) < 0
    over = points[left & between]
    return taut_girth(np.vstack([start, end, over])) - chord if len(over) else chord


def skin_on_line(body: Body, axis: int, point: Vector3) -> Float[np.ndarray, " hit"]:
    """Coordinates [cm] along an axis where the line through `point` in its direction meets skin."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    a, b, c = np.moveaxis(body.vertices[body.faces] - point, 1, 0)
    area = np.stack([p[:, u] * q[:, v] - p[:, v] * q[:, u] for p, q in ((b, c), (c, a), (a, b))])
    total = area.sum(0)
    share = area[:, total != 0] / total[total != 0]
    hit = (share >= -ON_EDGE).all(0)
    height = np.stack([corner[total != 0, axis] for corner in (a, b, c)])
    crossings: np.ndarray = (share * height).sum(0)[hit] + point[axis]
    return crossings


def shoulder_point(body: Body) -> Vector3:
    """The wearer's left shoulder point [cm]: the skin above the outer half of the joint."""
    joint = body.landmarks["left_shoulder_joint"]
    below = joint * [1 + ACROMION_OFFSET, 1, 1]
    return np.array([below[0], skin_on_line(body, 1, below).max(), below[2]])


def _leg(body: Body) -> dict[str, float]:
    place = body.landmarks
    hip, knee, ankle = (place[f"left_{name}_joint"] for name in ("hip", "knee", "ankle"))
    kneecap = place["left_kneecap"][1]
    thigh_level = place["crotch"][1] * (1 - BELOW_CROTCH)
    share = np.linspace(0, 1, LEG_SAMPLES)
    points = knee + share[:, None] * (ankle - knee)
    girths = np.array([_limb_girth(body, point, ankle - knee) for point in points])
    low = share > CALF_END
    thinnest = points[low][girths[low].argmin()]
    return {
        "thigh_girth": _limb_girth(body, _at_height(hip, knee, thigh_level), knee - hip),
        "knee_height": kneecap,
        "knee_girth": _limb_girth(body, _at_height(hip, knee, kneecap), knee - hip),
        "calf_girth": girths[~low].max(),
        "ankle_height": thinnest[1],
        "ankle_girth": girths[low].min(),
    }


def _arm(body: Body, shoulder: Vector3) -> dict[str, float]:
    """The arm as it hangs, when shoulder point, joint, elbow and wrist lie below each other."""
    place = body.landmarks
    joint, elbow, wrist = (place[f"left_{name}_joint"] for name in ("shoulder", "elbow", "wrist"))
    path = (shoulder, joint, elbow, wrist)
    return {
        "upper_arm_girth": _limb_girth(body, (joint + elbow) / 2, elbow - joint),
        "wrist_girth": _limb_girth(body, wrist, wrist - elbow),
        "arm_length": sum(_distance(p, q) for p, q in pairwise(path)),
    }


def _limb_girth(body: Body, point: Vector3, axis: Vector3) -> float:
    """Girth of the limb round `point`, square to its axis."""
    return girth(outline_at(body, point, axis), axis)


def _level_girth(body: Body, height: float) -> float:
    return girth(trunk_outline(body, height), UP)


def _bust_girth(body: Body) -> float:
    outline = trunk_outline(body, body.landmarks["left_bust_point"][1])
    side = body.landmarks["left_side"] * [CHEST_SIDE, 1, 1]
    limit = np.array([body.landmarks["left_side"][0] * CHEST_PLATE, np.inf, np.inf])
    tape = np.vstack([np.clip(outline, -limit, limit), side, side * [-1, 1, 1]])
    return girth(tape, UP)


def _slanted_girth(body: Body, front: Vector3, back: Vector3) -> float:
    """Girth in the plane through two points of the middle, front and back, level sideways."""
    normal = np.cross(ACROSS, back - front)
    return girth(outline_at(body, (front + back) / 2, normal), normal)


def _neck_base_girth(body: Body) -> float:
    """Round the ellipse through cervical, neck points and the pit of the neck.

    A cut would follow the shoulders where they slope little. The length of the ellipse is
    Ramanujan's first approximation.
    """
    place = body.landmarks
    a, b = place["left_neck_point"][0], _distance(place["cervical"], place["neck_front"]) / 2
    return float(np.pi * (3 * (a + b) - np.sqrt((3 * a + b) * (a + 3 * b))))


def girth(outline: Points3, normal: Vector3) -> float:
    """Tape round an outline that lies in a plane of the given normal."""
    first = np.cross(normal, FORWARD if abs(normal[2]) < abs(normal[1]) else UP)
    first /= np.linalg.norm(first)
    second = np.cross(normal, first) / np.linalg.norm(normal)
    return taut_girth(outline @ np.stack([first, second], axis=1))


def _depth(body: Body, height: float) -> float:
    return float(np.ptp(trunk_outline(body, height)[:, 2]))


def _hip_height(body: Body) -> float:
    crotch, waist = body.landmarks["crotch"][1], body.landmarks["waist_front"][1]
    low, high = (crotch + share * (waist - crotch) for share in HIP_RANGE)
    seat = body.vertices[(body.vertices[:, 1] > low) & (body.vertices[:, 1] < high)]
    return float(seat[seat[:, 2].argmin(), 1])


def _across(body: Body, height: float, side: int) -> float:
    """Tape over the back (`side` -1) or the chest (+1) between the armhole lines."""
    x = body.landmarks["left_shoulder_joint"][0] * (FRONT_ARMHOLE if side > 0 else 1)
    hits = skin_on_line(body, 2, np.array([x, height, 0.0]))
    z = (hits * side).max()
    level = np.concatenate(cut(body, height * UP, UP))[:, [0, 2]] * [1, side]
    return taut_length(level, np.array([-x, z]), np.array([x, z]))


def back_length(body: Body, top: float, bottom: float) -> float:
    """Tape down the middle of the back between two heights."""
    middle = np.concatenate(cut(body, 0 * ACROSS, ACROSS))[:, [1, 2]]
    start, end = (np.array([y, skin_on_line(body, 2, y * UP).min()]) for y in (top, bottom))
    return taut_length(middle, start, end)


def _front_waist_length(body: Body) -> float:
    """Tape from the neck point to the bust point, then straight down to the waist."""
    neck, bust = body.landmarks["left_neck_point"], body.landmarks["left_bust_point"]
    waist = bust * [1, 0, 0] + body.landmarks["waist_front"] * [0, 1, 0]
    waist[2] = skin_on_line(body, 2, waist).max()
    return _front_length(body, neck, bust) + _front_length(body, bust, waist)


def _front_length(body: Body, start: Vector3, end: Vector3) -> float:
    """Tape over the front, in the plane that holds both ends and the forward direction."""
    along = (end - start) * [1, 1, 0]
    along /= np.linalg.norm(along)
    section = np.concatenate(cut(body, start, np.cross(along, FORWARD)))
    flat = np.stack([along, FORWARD], axis=1)
    return taut_length(section @ flat, start @ flat, end @ flat)


def _crotch_length(body: Body, waist: float) -> float:
    """Tape from the front waist between the legs to the back waist."""
    strip = body.vertices[np.abs(body.vertices[:, 0]) < STRIP][:, [2, 1]]
    trunk = strip[(strip[:, 1] >= body.landmarks["crotch"][1]) & (strip[:, 1] <= waist)]
    hits = skin_on_line(body, 2, waist * UP)
    ends = [[hits.max(), waist], [hits.min(), waist]]
    return taut_girth(np.vstack([trunk, ends])) - float(np.ptp(hits))


def _at_height(start: Vector3, end: Vector3, height: float) -> Vector3:
    place: np.ndarray = start + (height - start[1]) / (end[1] - start[1]) * (end - start)
    return place


def _distance(a: Vector3, b: Vector3) -> float:
    return float(np.linalg.norm(b - a))
