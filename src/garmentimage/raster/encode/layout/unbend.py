"""Unbending: a panel cut as a wide sector, as circle skirts are, rests as a narrower one.

And pleats rest as darts: the two edges of a pleat lie in one line, which has no direction into the
cloth along which they could be drawn once they are sewn.

The front of a full-circle skirt is half a ring; laid flat its sides stand level with the waist or
curl up beside it, over whatever is sewn above. On the body it hangs down. Before panels are drawn
together, such a ring sector is bent about its centre to a narrower angle, its inner arc keeping
its length. Only the drawing is bent: the panel's own shape is what the image's deformation holds.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import polyline_length
from garmentimage.raster.encode.layout.samples import ramp
from garmentimage.raster.encode.placement import PlacedPanel

MAX_ANGLE = np.radians(120.0)
"""Sectors up to this angle rest as they are."""
KEPT_BEYOND = 0.15
"""Share of the angle beyond it that a wider sector keeps."""
SMOOTH = np.radians(35.0)
"""Edges that meet at a smaller turn than this are one arc."""
RING = (0.3, 0.5)
"""Shortest side of the sector as a share of its depth, from which on and at which it is a ring
sector; a neckline or an armhole has short shoulders beside a long body."""


@dataclass(frozen=True)
class _AnnularSector:
    """Part of a ring: where its inner arc lies round its centre."""

    first: int
    """Place in the loop of the arc's first edge."""
    count: int
    """Edges of the arc."""
    angle: float
    """[radians]"""
    radius: float
    centre: Float[np.ndarray, " 2"]


class _Polar(NamedTuple):
    """Polar coordinates: angles are 0 along `axis` and grow to its left."""

    centre: Float[np.ndarray, " 2"]
    axis: Float[np.ndarray, " 2"]
    """Unit direction."""

    def angles(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
        """Angle of each point, from -pi to pi."""
        away, axis = points - self.centre, self.axis
        across = axis[0] * away[:, 1] - axis[1] * away[:, 0]
        return np.asarray(np.arctan2(across, away @ axis))

    def radii(self, points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
        """Distance of each point from the centre."""
        return np.asarray(np.hypot(*(points - self.centre).T))

    def points(
        self, radii: Float[np.ndarray, " n"], angles: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, "n 2"]:
        """Points with these coordinates."""
        left = np.array([-self.axis[1], self.axis[0]])
        unit = np.cos(angles)[:, None] * self.axis + np.sin(angles)[:, None] * left
        return np.asarray(self.centre + radii[:, None] * unit)


def unbent_curves(panel: PlacedPanel) -> tuple[Float[np.ndarray, "_ 2"], ...]:
    """The panel's curves at rest in the drawing: wide sectors narrower, pleats open."""
    curves = list(_narrowed(panel))
    for run in panel.pleats:
        _open_pleat(curves, run, panel.sign)
    return tuple(curves)


def _open_pleat(curves: list[np.ndarray], run: tuple[int, ...], sign: int) -> None:
    """Draw the edges of a pleat as the legs of a dart, its tip as deep as they are long."""
    start, end = curves[run[0]][0], curves[run[-1]][-1]
    across = (end - start) / 2
    # Cloth lies to the left of a counter-clockwise loop.
    inward = sign * np.array([-across[1], across[0]])
    width = across @ across

    def opened(points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        share = np.clip(1 - np.abs((points - start) @ across / width - 1), 0.0, 1.0)
        return np.asarray(points + share[:, None] * inward)

    tips = [k for k, other in pairwise(run) if _turns_back(curves, k, other)]
    creases = {*tips, *(run[run.index(k) + 1] for k in tips)}
    for k in run:
        if k not in creases:
            curves[k] = opened(curves[k])
        else:
            at = 0 if k in tips else -1
            line = curves[k].copy()
            line[at] = opened(line[at : at + 1 or None])[0]
            curves[k] = line


def _turns_back(curves: list[np.ndarray], k: int, following: int) -> bool:
    """Whether an edge is walked back by the one that follows it, as the slit along a crease is."""
    return np.array_equal(curves[k], curves[following][::-1])


def _narrowed(panel: PlacedPanel) -> tuple[Float[np.ndarray, "_ 2"], ...]:
    """The panel's curves as placed, or bent when it is a wide sector.

    In polar coordinates (r, a) round the centre of the inner arc, whose radius is R, a point moves
    to (r + R (1 / share - 1), share a) round a centre that is R (1 / share - 1) farther off: the
    inner arc keeps its length and its place, every radius its length.
    """
    sector = _widest_sector(panel)
    if sector is None:
        return panel.curves
    loop = panel.loops[0]
    order = [loop[(sector.first + k) % len(loop)] for k in range(len(loop))]
    outline = np.concatenate([panel.curves[k][:-1] for k in order])
    inner = sum(len(panel.curves[k]) - 1 for k in order[: sector.count]) + 1
    # The axis runs from the centre through the middle of the inner arc.
    axis = (outline - sector.centre)[:inner].sum(axis=0)
    axis /= np.hypot(*axis) + 1e-9
    polar = _Polar(sector.centre, axis)
    # Angles that grow all along the outline, even beyond half a turn.
    angles = np.unwrap(polar.angles(outline), axis=0)
    angles -= angles[:inner].mean()
    if np.abs(angles).max() > np.pi:
        return panel.curves
    # How much is bent fades with how little of a ring the panel is.
    ring = _ring_share(panel, order[sector.count], order[-1], polar.radii(outline), sector.radius)
    share = 1.0 - ring * (1 - KEPT_BEYOND) * (1 - MAX_ANGLE / sector.angle)
    if share >= 1.0:
        return panel.curves
    farther = _Polar(sector.centre - axis * sector.radius * (1 / share - 1), axis)

    def bent(
        points: Float[np.ndarray, "n 2"], angles: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, "n 2"]:
        radii = polar.radii(points) + sector.radius * (1 / share - 1)
        return farther.points(radii, share * angles)

    curves = list(panel.curves)
    at = 0
    for k in order:
        size = len(panel.curves[k])
        here = np.take(angles, np.arange(at, at + size), mode="wrap")
        curves[k] = bent(panel.curves[k], here)
        at += size - 1
    for hole in panel.loops[1:]:
        for k in hole:
            curves[k] = bent(panel.curves[k], polar.angles(panel.curves[k]))
    return tuple(curves)


def _ring_share(
    panel: PlacedPanel, after: int, before: int, distance: Float[np.ndarray, " n"], radius: float
) -> float:
    """1 for a ring sector, 0 for a panel with a mere bay in its outline, fading between."""
    depth = float(distance.max()) - radius
    if depth <= 0 or distance.min() < radius / 2:
        return 0.0
    side = min(polyline_length(panel.curves[k]) for k in (after, before))
    return float(ramp(side / depth, *RING))


def _widest_sector(panel: PlacedPanel) -> _AnnularSector | None:
    """The run of edges that bends inwards most, when that is more than `MAX_ANGLE`."""
    loop = panel.loops[0]
    count = len(loop)
    # First and last step of every edge.
    ends = [(c[1] - c[0], c[-1] - c[-2]) for c in (panel.curves[k] for k in loop)]
    turns = [_turn(panel.curves[k]) * -panel.sign for k in loop]
    best: _AnnularSector | None = None
    for first in range(count):
        angle, size = turns[first], 1
        while size < count - 2:
            here, there = (first + size - 1) % count, (first + size) % count
            corner = _angle(ends[here][1], ends[there][0])
            if abs(corner) > SMOOTH or turns[there] <= 0:
                break
            angle += turns[there] - panel.sign * corner
            size += 1
        if turns[first] <= 0 or angle <= max(MAX_ANGLE, best.angle if best else 0.0):
            continue
        points = np.concatenate([panel.curves[loop[(first + k) % count]] for k in range(size)])
        radius = polyline_length(points) / angle
        step = np.gradient(points, axis=0)
        step /= np.hypot(*step.T)[:, None] + 1e-9
        # Cloth lies to the left of a counter-clockwise loop; the centre on the other side.
        centre = (points + radius * panel.sign * step[:, ::-1] * (1, -1)).mean(axis=0)
        best = _AnnularSector(first, size, angle, radius, centre)
    return best


def _turn(curve: Float[np.ndarray, "n 2"]) -> float:
    """Total turning to the left along a curve [radians]."""
    step = np.diff(curve, axis=0)
    return float(
        np.arctan2(
            step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0],
            (step[:-1] * step[1:]).sum(axis=1),
        ).sum()
    )


def _angle(a: Float[np.ndarray, " 2"], b: Float[np.ndarray, " 2"]) -> float:
    """Angle from one direction to another, to the left [radians]."""
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))
