"""Wide skirts begin hanging.

Laid flat, a wide skirt may reach up to the arms, and a circle skirt goes all round its waist. The
halves of circle skirts, and of round flounces, are laid round the body as a cone; what else stands
out sideways so far is bent down round the middle of its waist. A top edge that is drawn as a curve
begins level, as it is worn.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.start.placement import Placement
from garmentimage.drape.start.sides import Landmarks, chest
from garmentimage.drape.support import SupportSite

WIDE, KEPT_BEYOND = np.deg2rad(60.0), 0.15
"""A skirt begins to hang at this angle from straight down at most, plus this share of the rest."""
HALF_ROUND = np.deg2rad(95.0)
"""Half of a circle skirt has a seam that reaches to this angle from straight down, or further."""
FLARED = np.deg2rad(40.0)  # the same for a free top edge: nothing over it keeps a flared one level
STRAIGHT_DOWN = np.deg2rad(30.0)  # that seam begins within this angle from straight down
OUT_OF_ROUND = 0.15  # share of its radius by which that seam may leave a circle
SEAM_DEPTH = 8.0
"""A panel over a seam ends no deeper than this below the lowest point of the seam [cm]."""


def hang_skirts(
    cloth: Cloth, corners: np.ndarray, landmarks: Landmarks, placements: Sequence[Placement]
) -> None:
    """Bend down the sides of panels that begin at the waist and would reach up to the arms."""
    tops = _tops(cloth, placements)
    reach, waist = landmarks["left_shoulder_joint"][0], landmarks["waist_front"][1]
    high = chest(landmarks)
    for k in range(len(cloth.pattern.panels)):
        own = np.flatnonzero(cloth.panel == k)
        seam = _round_seam(cloth, corners, k, tops)
        if seam is not None:
            corners[own] = _cone(corners[own], seam, reach)
            if k in tops:
                line, level = tops[k]
                corners[own, 1] += level - corners[line, 1].mean()
            continue
        if k in tops:
            # Corners go up or down with the top edge above them, until that is level.
            line, level = tops[k]
            x, y = corners[line[np.argsort(corners[line, 0], kind="stable")], :2].T
            corners[own, 1] += level - np.interp(corners[own, 0], x, y)
        away, height = np.abs(corners[own, 0]), corners[own, 1]
        top = float(height[away <= reach].max(initial=waist))
        if top > high or height.max() < high or height.mean() > waist:
            continue
        bearing, distance = np.arctan2(away, top - height), np.hypot(away, top - height)
        out = (away > reach) & (bearing > WIDE)
        bent = WIDE + (bearing[out] - WIDE) * KEPT_BEYOND
        side = np.sign(corners[own[out], 0])
        corners[own[out], 0] = side * distance[out] * np.sin(bent)
        corners[own[out], 1] = top - distance[out] * np.cos(bent)


def _tops(
    cloth: Cloth, placements: Sequence[Placement]
) -> Mapping[int, tuple[Int[np.ndarray, " _"], float]]:
    """For the panels with a top edge at the waist, its corners and its level."""
    lines: dict[int, tuple[list[np.ndarray], float]] = {}
    for placement in placements:
        for side in placement.edges if placement.site is SupportSite.WAIST else ():
            line = cloth.sides[side]
            lines.setdefault(int(cloth.panel[line[0]]), ([], placement.level))[0].append(line)
    return {k: (np.unique(np.concatenate(found)), level) for k, (found, level) in lines.items()}


@dataclass(frozen=True)
class _RoundSeam:
    """The round seam by which half of a circle skirt hangs from what is over it."""

    middle: float  # height of the centre of its circle [cm]
    radius: float  # [cm]
    end: float  # how far it goes to either side from straight down [rad]


def _round_seam(
    cloth: Cloth,
    corners: np.ndarray,
    panel: int,
    tops: Mapping[int, tuple[Int[np.ndarray, " _"], float]],
) -> _RoundSeam | None:
    """The seam, or the top edge, of a panel that is half of a circle skirt."""
    name, lines = cloth.pattern.panels[panel].name, []
    if panel in tops:
        lines.append(corners[tops[panel][0]])
    for stitch in cloth.pattern.stitches:
        for own, other in (stitch.sides, stitch.sides[::-1]):
            if own.panel == name != other.panel:
                line = corners[cloth.sides[own]]
                height = corners[cloth.panel == cloth.panel[cloth.sides[other][0]], 1]
                level = line[:, 1].min()
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
    hangs = (
        least > (FLARED if panel in tops else HALF_ROUND) and np.abs(bearing).min() < STRAIGHT_DOWN
    )
    if not hangs or off > OUT_OF_ROUND or abs(centre[0] + u) > radius / 2:
        return None
    return _RoundSeam(float(centre[1] + v), radius, most)


def _cone(points: np.ndarray, seam: _RoundSeam, least: float) -> Float[np.ndarray, "corner 3"]:
    """Half of a circle skirt laid round the body, its sides where the wearer's are [cm].

    The seam goes round the body with its own radius, or `least` where that is more.
    """
    x, down = points[:, 0], seam.middle - points[:, 1]
    round_body = np.clip(np.arctan2(x, down) / seam.end, -1.0, 1.0) * np.pi / 2
    along = np.hypot(x, down) - seam.radius
    fullness = 2 * seam.end / np.pi
    slope = min(np.arcsin(min(fullness, 1.0)), WIDE)
    out = max(seam.radius * fullness, least) + along * np.sin(slope)
    height = seam.middle - seam.radius - along * np.cos(slope)
    forward = np.sign(points[:, 2].mean()) * out * np.cos(round_body)
    return np.stack([out * np.sin(round_body), height, forward], axis=1)
