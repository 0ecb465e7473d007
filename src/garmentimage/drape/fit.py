"""Fit: how long the cloth is round the body, against the body there.

A tape lies round trunk, arm or leg in a plane. The cloth that goes round the same limb in that
plane is as long as its flat panels are there, whether it has been draped or only begun. Cloth that
does not go round the limb, as an open jacket, has no girth.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body import Body, Vector3, girth, load_body, outline_at, stand_straight
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.mesh import mesh
from garmentimage.drape.start import place_on_body, start_points
from garmentimage.drape.support import SupportSite
from garmentimage.errors import DrapeError, quoted
from garmentimage.geometry import component_labels
from garmentimage.pattern import Pattern, without_stubs

AUTO = "auto"  # stands for the shipped body on which a garment fits best
CHEST, HIP = 0.46, 0.33
"""Where the chest lies from waist to neck, and the hip from crotch to waist, as shares."""
LIMBS = {
    "upper arm": ("left_shoulder_joint", "left_elbow_joint", 0.5),
    "lower arm": ("left_elbow_joint", "left_wrist_joint", 0.5),
    "wrist": ("left_elbow_joint", "left_wrist_joint", 1.0),
    "thigh": ("left_hip_joint", "left_knee_joint", 0.35),
    "knee": ("left_hip_joint", "left_knee_joint", 1.0),
    "calf": ("left_knee_joint", "left_ankle_joint", 0.3),
}
"""Two landmarks of each limb, and where it is measured between them, as a share from the first."""
CHEST_SIDE = 0.9
"""Round the chest the tape goes no farther out than this share of the shoulder joint's distance
from the middle: lifted arms pull the skin there outwards."""
ORDER = (
    "mean-female", "slim-female", "tall-slim-female", "short-round-female",
    "mean-male", "tall-slim-male", "short-round-male",
)  # fmt: skip
"""Shipped bodies in the order in which they are tried: the templates of others are drawn for
women."""
STRETCH_ALLOWANCE = 0.03
"""Cloth may be shorter than the body by this share: it stretches without being felt."""
SUPPORT_ALLOWANCE = 0.12
"""What is held by waist or chest may be longer than the body by this share there."""


@dataclass(frozen=True, eq=False)
class Tape:
    """A plane in which a limb is measured."""

    point: Vector3  # in the middle of the limb [cm]
    normal: Vector3  # along the limb
    girth: float  # of the body there [cm]


@dataclass(frozen=True)
class Girth:
    """Cloth round a limb."""

    place: str
    cloth: float  # its length at rest [cm]
    body: float  # girth of the body there [cm]

    @property
    def missing(self) -> float:
        """Share of the body's girth by which the cloth is shorter; negative where it is longer."""
        return 1 - self.cloth / self.body

    def __str__(self) -> str:
        return f"{self.place} {self.cloth:.1f} cm of cloth on {self.body:.1f}"


@dataclass(frozen=True)
class Fit:
    """How a garment fits a shipped body."""

    body: str
    girths: tuple[Girth, ...]
    tight: float  # shares of girths that are missing, added up, less what cloth gives
    loose: float  # share of its girth by which what holds the garment is too long

    def __str__(self) -> str:
        trunk = [str(g) for g in self.girths if g.place not in LIMBS]
        return f"{self.body}" + (f" ({', '.join(trunk)})" if trunk else "")


@lru_cache(maxsize=16)
def tapes(body: Body) -> Mapping[str, Tape]:
    """Where a body is measured: chest, waist, hip and what it has of `LIMBS`."""
    marks = body.landmarks
    found = {}
    if {"waist_front", "crotch", "left_neck_point", "left_shoulder_joint"} <= marks.keys():
        waist, crotch, neck = (
            float(marks[name][1]) for name in ("waist_front", "crotch", "left_neck_point")
        )
        side = CHEST_SIDE * float(marks["left_shoulder_joint"][0])
        for place, height, limit in (
            ("chest", waist + CHEST * (neck - waist), side),
            ("waist", waist, np.inf),
            ("hip", crotch + HIP * (waist - crotch), np.inf),
        ):
            point, up = np.array([0.0, height, 0.0]), np.array([0.0, 1.0, 0.0])
            found[place] = _tape(body, point, up, limit)
    for place, (start, end, share) in LIMBS.items():
        if start in marks and end in marks:
            along = marks[end] - marks[start]
            found[place] = _tape(body, marks[start] + share * along, along, np.inf)
    return found


def _tape(body: Body, point: Vector3, normal: Vector3, side: float) -> Tape:
    """The tape round the limb at a point that goes no farther out than `side`."""
    normal = normal / np.linalg.norm(normal)
    outline = outline_at(body, point, normal)
    outline = np.clip(outline, [-side, -np.inf, -np.inf], [side, np.inf, np.inf])
    return Tape((outline.min(0) + outline.max(0)) / 2, normal, girth(outline, normal))


def girths(cloth: Cloth, points: Float[np.ndarray, "vertex 3"], body: Body) -> tuple[Girth, ...]:
    """The cloth round every limb that it goes round; vertices at `points` [cm], draped or not."""
    lengths = {place: _length_round(cloth, points, tape) for place, tape in tapes(body).items()}
    return tuple(
        Girth(place, length, tapes(body)[place].girth)
        for place, length in lengths.items()
        if length is not None
    )


def _length_round(cloth: Cloth, points: Float[np.ndarray, "vertex 3"], tape: Tape) -> float | None:
    """Length at rest of the shortest closed line of cloth round a tape [cm]."""
    height = (points - tape.point) @ tape.normal
    faces = cloth.vertex_faces
    above = height[faces] > 0
    cut = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    if not len(cut):
        return None
    ends, where, flat = _crossed_sides(cloth, points, height, cut)
    edges, index, uses = np.unique(
        ends.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True
    )
    pair = index.reshape(-1, 2)
    label = component_labels(len(edges), pair)
    closed = np.bincount(label, uses != 2) == 0
    line = label[pair[:, 0]]
    lengths = np.bincount(line, np.linalg.norm(flat[:, 1] - flat[:, 0], axis=1))
    rings = [k for k in np.flatnonzero(closed) if _goes_round(where[line == k], tape)]
    return min((float(lengths[k]) for k in rings), default=None)


def _crossed_sides(
    cloth: Cloth,
    points: Float[np.ndarray, "vertex 3"],
    height: Float[np.ndarray, " vertex"],
    cut: Int[np.ndarray, " face"],
) -> tuple[
    Int[np.ndarray, "face 2 2"], Float[np.ndarray, "face 2 3"], Float[np.ndarray, "face 2 2"]
]:
    """The two sides of each cut triangle that a plane crosses: their ends, and where it does.

    Ends are vertices, the lower number first; places are those worn [cm], and those in the panel.
    """
    corners, vertices = cloth.faces[cut], cloth.vertex_faces[cut]
    above = height[vertices] > 0
    crosses = above != np.roll(above, -1, axis=1)
    first = np.argsort(~crosses, axis=1, kind="stable")[:, :2]
    rows = np.arange(len(cut))[:, None]
    a, b = corners[rows, first], corners[rows, (first + 1) % 3]
    p, q = cloth.vertex[a], cloth.vertex[b]
    share = (height[p] / (height[p] - height[q]))[..., None]
    ends = np.sort(np.stack([p, q], axis=-1), axis=-1)
    where = points[p] + share * (points[q] - points[p])
    flat = cloth.flat[a] + share * (cloth.flat[b] - cloth.flat[a])
    return ends, where, flat


def _goes_round(segments: Float[np.ndarray, "segment 2 3"], tape: Tape) -> bool:
    """Whether a closed line has the middle of the limb inside, seen along it.

    A ray from the middle crosses such a line an odd number of times.
    """
    across = np.cross(tape.normal, np.array([0.0, 0.0, 1.0]))
    if np.linalg.norm(across) < 0.5:
        across = np.cross(tape.normal, np.array([0.0, 1.0, 0.0]))
    second = np.cross(tape.normal, across)
    off = segments - tape.point
    u, v = off @ across, off @ second
    crosses = (v[:, 0] > 0) != (v[:, 1] > 0)
    at = u[:, 0] - v[:, 0] * (u[:, 1] - u[:, 0]) / np.where(crosses, v[:, 1] - v[:, 0], 1.0)
    return int((crosses & (at > 0)).sum()) % 2 == 1


# --- Which body ----------------------------------------------------------------------------------


def _fit_on(clothes: Sequence[Cloth], name: str, made_for: float | None, pose: str) -> Fit:
    """How garments fit a shipped body, without being draped."""
    body = stand_straight(load_body(name, pose))
    every: list[Girth] = []
    tight = loose = 0.0
    for cloth in clothes:
        placed, placements = place_on_body(cloth.pattern, body, made_for=made_for)
        found = girths(cloth, start_points(replace(cloth, pattern=placed), body, placements), body)
        edges = [s.length for s in placements if s.site is SupportSite.WAIST and s.length > 0]
        if edges:
            # A band may begin just over the tape or just under it.
            waist = Girth("waist", min(edges), tapes(body)["waist"].girth)
            found = (waist, *(g for g in found if g.place != "waist"))
        # Without a girth nothing is known of how wide it is where it should hold.
        held = [s for s in placements if s.site is not SupportSite.SHOULDERS and s.girth > 0]
        every += found
        tight += sum(max(g.missing - STRETCH_ALLOWANCE, 0.0) for g in found)
        loose += sum(max(s.length / s.girth - 1 - SUPPORT_ALLOWANCE, 0.0) for s in held)
    return Fit(name, tuple(every), tight, loose)


def best_fit(patterns: Sequence[Pattern], *, made_for: float | None = None, pose: str = "t") -> Fit:
    """The shipped body on which garments fit best: the first of `ORDER` on which they fit, else
    the one on which least is missing or too much.

    What is too wide for all of them is meant to be drawn together, and fits in that respect.

    Args:
        patterns: garments that are worn together.
        made_for: stature that they were made for [cm]; see `place_on_body`.
        pose: of the bodies.

    Raises:
        DrapeError: there is no garment, or a panel cannot be cut into triangles.
        DraftError: `made_for` is out of range.
    """
    if not patterns:
        raise DrapeError("there is no garment to choose a body for")
    clothes = [mesh(without_stubs(pattern)) for pattern in patterns]
    fits = []
    for name in ORDER:
        fits.append(_fit_on(clothes, name, made_for, pose))
        if fits[-1].tight == fits[-1].loose == 0:
            break
    drawn_together = min(fit.loose for fit in fits) > 0
    return min(fits, key=lambda fit: fit.tight + (0.0 if drawn_together else fit.loose))


def tight_places(
    cloth: Cloth,
    stretch: Float[np.ndarray, " face"],
    points: Float[np.ndarray, "vertex 3"],
    body: Body,
) -> str:
    """What is too short where cloth is too tight, and who could wear it: the end of a sentence.

    `stretch` is that of each triangle, and `points` are the vertices at rest [cm].
    """
    missing = [g for g in girths(cloth, points, body) if g.missing > 0]
    if missing:
        where = str(max(missing, key=lambda g: g.missing))
    else:
        weight = np.bincount(cloth.face_panel, np.maximum(stretch, 0.0))
        mean = weight / np.maximum(np.bincount(cloth.face_panel), 1)
        where = f"most of all panel {quoted(cloth.pattern.panels[int(mean.argmax())].name)}"
    best = best_fit([cloth.pattern])
    if best.body != body.name:
        fits = "on which it fits" if best.tight == 0 else "which comes nearest"
        return f"{where}; take the body {best.body}, {fits}, or a larger size"
    return f"{where}; choose a larger size, or a pose in which its sleeves are drawn"
