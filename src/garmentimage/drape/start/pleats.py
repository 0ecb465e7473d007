"""Pressed pleats begin folded, and are held so as far as they are pressed.

The cloth of a pleat lies on that of its panel, or beneath it, in strips between its folds: each
place of a strip on a place of the panel, to which it is tied. Farther down the pleat is free to
open.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.mesh import Pressed
from garmentimage.pattern import Pattern, Pleat

START_GAP = 0.3  # strips that lie on each other begin so far apart [cm] ...
PRESSED_STIFFNESS, GIVE = 3e3, 0.33
"""Of the ties [dyn/cm], and how far from its place a tie pulls with all its force [cm], 10 mN:
pleats are pressed, not sewn, and open where cloth is tight."""
FADE = 8.0  # ties weaken over so many cm, or half the length, to where pressing ends
PRESSED_GAP = 0.3  # ... and are so far apart where they are pressed [cm]
TAPER = 4.0  # cloth beside a pleat rises over the strips beneath within so many cm
WITHIN = 1e-6  # share of a triangle by which a place may lie outside of it
EDGE = 0.01  # what lies nearer to a fold than this lies on it [cm]

_SIDES = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True, eq=False)
class _PleatFrame:
    """A pleat's own coordinates: s from A to B, v into the cloth [cm]."""

    pleat: Pleat
    origin: Float[np.ndarray, " 2"]  # A
    along: Float[np.ndarray, " 2"]
    inward: Float[np.ndarray, " 2"]
    """Unit directions of s and v."""
    width: float  # from A to B

    @classmethod
    def of(cls, pattern: Pattern, pleat: Pleat) -> "_PleatFrame":
        first, second = (pattern.curve(side) for side in pleat.sides)
        origin, end = np.array(first.start), np.array(second.end)
        width = float(np.hypot(*(end - origin)))
        along = (end - origin) / width
        left = 1.0 if pattern.by_name[pleat.panel].outline.area > 0 else -1.0
        return cls(pleat, origin, along, left * np.array([-along[1], along[0]]), width)

    def places(self, flat: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """(s, v) of places in the flat panel."""
        return np.asarray((flat - self.origin) @ np.stack([self.along, self.inward], axis=1))

    def folded(
        self, s: Float[np.ndarray, " n"]
    ) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
        """Where strips lie, beside the line on which A and B meet, and on which level.

        The first is towards A where positive [cm]. Levels count outward; the panel itself is 0.
        """
        if self.pleat.fold in _SIDES:
            side = _SIDES[self.pleat.fold]
            # The strip beside the fold that is seen lies over the other.
            beside = s < self.width / 2 if side > 0 else s > self.width / 2
            return side * np.minimum(s, self.width - s), np.where(beside, -1.0, -2.0)
        quarter = self.width / 4
        at_a, at_b = s < quarter, s > self.width - quarter
        place = np.select([at_a, at_b], [s, s - self.width], 2 * quarter - s)
        level = np.where(at_a | at_b, 1.0, 2.0)
        return place, level if self.pleat.fold == "box" else -level


def folded_flat(cloth: Cloth) -> tuple[Float[np.ndarray, "corner 2"], Float[np.ndarray, " corner"]]:
    """Flat panels with all pleats folded: places [cm], and how far outward of the panel [cm]."""
    level = np.zeros(len(cloth.flat))
    if not cloth.pattern.pleats:
        return cloth.flat, level
    flat = cloth.flat.copy()
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    for pleat in cloth.pattern.pleats:
        frame = _PleatFrame.of(cloth.pattern, pleat)
        own = np.flatnonzero(cloth.panel == number[pleat.panel])
        s, _ = frame.places(cloth.flat[own]).T
        place, own_level = frame.folded(s)
        # Both sides of the panel come to meet where the middle of the pleat was.
        shift = np.where(s < 0, frame.width / 2, -frame.width / 2)
        in_pleat = (s >= 0) & (s <= frame.width)
        shift = np.where(in_pleat, frame.width / 2 - place - s, shift)
        flat[own] += shift[:, None] * frame.along
        level[own] += np.where(in_pleat, own_level, 0.0) * START_GAP
    return flat, level


def pressed_pleats(cloth: Cloth, vertices: Int[np.ndarray, " n"]) -> Pressed | None:
    """What holds pleats folded as far as they are pressed.

    Args:
        cloth: the garment.
        vertices: those that are simulated, in rising order, by which those tied are numbered.

    Returns:
        None where nothing is pressed.
    """
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    tied: dict[int, tuple[list[int], list[float], float, float]] = {}
    for pleat in cloth.pattern.pleats:
        tied |= _lying(cloth, number[pleat.panel], _PleatFrame.of(cloth.pattern, pleat))
    own = {v: tie for v, tie in tied.items() if np.isin([v, *tie[0]], vertices).all()}
    if not own:
        return None
    triangles, shares, levels, strength = (list(each) for each in zip(*own.values(), strict=True))
    return Pressed(
        np.searchsorted(vertices, list(own)),
        np.searchsorted(vertices, triangles),
        np.array(shares),
        PRESSED_GAP * np.array(levels),
        PRESSED_STIFFNESS * np.array(strength),
        GIVE,
        PRESSED_GAP * _raised(cloth)[vertices],
    )


def _lying(
    cloth: Cloth, panel: int, frame: _PleatFrame
) -> dict[int, tuple[list[int], list[float], float, float]]:
    """For the vertices of a pleat the triangle that each lies on, its shares, its level, and how
    strongly it is held there.
    """
    own = np.flatnonzero(cloth.panel == panel)
    s, v = frame.places(cloth.flat[own]).T
    strip = (s > EDGE) & (s < frame.width - EDGE) & (v <= frame.pleat.pressed + EDGE)
    place, level = frame.folded(s[strip])
    # Where the panel itself is at that place: before A, or beyond B.
    beneath = np.where(place >= 0, -place, frame.width - place)
    axes = np.stack([frame.along, frame.inward])
    points = frame.origin + np.stack([beneath, v[strip]], axis=1) @ axes
    faces = cloth.faces[cloth.face_panel == panel]
    corners, shares = _triangles_at(cloth.flat, faces, points)
    on = shares.min(axis=1) >= -WITHIN
    left = frame.pleat.pressed - v[strip]
    strength = np.clip(left / min(FADE, frame.pleat.pressed / 2), 0.0, 1.0)
    columns = corners[on], shares[on], level[on].tolist(), strength[on].tolist()
    return {
        int(cloth.vertex[corner]): (cloth.vertex[triangle].tolist(), share.tolist(), *rest)
        for corner, triangle, share, *rest in zip(own[strip][on].tolist(), *columns, strict=True)
    }


def _raised(cloth: Cloth) -> Float[np.ndarray, " vertex"]:
    """How many strips lie beneath every vertex; fewer by and by beside and below a pleat."""
    raised = np.zeros(len(cloth.flat))
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    for pleat in cloth.pattern.pleats:
        if pleat.fold == "box":
            continue
        frame = _PleatFrame.of(cloth.pattern, pleat)
        own = np.flatnonzero(cloth.panel == number[pleat.panel])
        s, v = frame.places(cloth.flat[own]).T
        # As seen from outside, from the line on which A and B meet towards A.
        place = np.select([s < 0, s > frame.width], [-s, frame.width - s], 0.0)
        ends = frame.folded(np.linspace(0.0, frame.width, 9))[0]
        beyond = np.maximum(np.maximum(place - ends.max(), ends.min() - place), 0.0)
        beyond = np.hypot(beyond, np.maximum(v - pleat.pressed, 0.0))
        on_top = (s <= EDGE) | (s >= frame.width - EDGE)
        raised[own] += np.where(on_top, 2.0 * np.clip(1.0 - beyond / TAPER, 0.0, 1.0), 0.0)
    each = np.zeros(cloth.vertex_count)
    np.maximum.at(each, cloth.vertex, raised)
    return each


def _triangles_at(
    flat: Float[np.ndarray, "corner 2"],
    faces: Int[np.ndarray, "face 3"],
    points: Float[np.ndarray, "n 2"],
) -> tuple[Int[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """The triangle that each place lies in, or is nearest to, and its shares of the corners."""
    a, b, c = flat[faces].transpose(1, 0, 2)
    u, v = b - a, c - a
    cross = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    away = points[:, None] - a
    second = (away[..., 0] * v[:, 1] - away[..., 1] * v[:, 0]) / cross
    third = (u[:, 0] * away[..., 1] - u[:, 1] * away[..., 0]) / cross
    shares = np.stack([1 - second - third, second, third], axis=2)
    best = shares.min(axis=2).argmax(axis=1)
    return faces[best], shares[np.arange(len(points)), best]
