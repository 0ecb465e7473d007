"""Cloth in motion until it rests: springs, bending, gravity, and a body to rest on.

The state moves by explicit steps (symplectic Euler), short enough to be stable. So at rest every
force is exactly what the fabric says: a finer mesh is not a softer cloth. Forces are taken at the
places where the vertices will be a fraction of a step later, which damps fast jitter and nothing
else. A vertex that so short a step would not keep stable (next to a tiny triangle) is given more
inertia but no more weight, which changes the way to rest and not the rest itself.

The body is met vertex by vertex: out of it along the distance field's slope, with Coulomb friction
that holds still what rests. Where skin would come through between vertices, these are kept a little
farther off.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.fabric import Fabric
from garmentimage.drape.mesh import Rest, bending_matrix
from garmentimage.drape.solver._kernels_step import FRAME, LOOK_AHEAD, SHORTEST, simulate
from garmentimage.drape.solver.distance_field import DistanceField

GRAVITY = 981.0
"""[cm/s2]"""
STABLE = 0.96 * 2.0 / (1.0 + 2.0 * LOOK_AHEAD)
"""Greatest value of (step^2 x sum of spring stiffness / mass) of a vertex. By Gershgorin's theorem
steps are stable below 2 / (1 + 2 LOOK_AHEAD), whatever the shape of the cloth."""
MOST_VERTICES = 75
"""Percentage of the vertices for which steps are made short enough; the others get inertia."""
REFRESH = 6
"""Bending forces and the body's nearness are computed anew once in this many steps, at most."""
MOST_LIFT = 0.2
"""Where skin comes through between vertices, these are kept farther off by up to this share of the
edges' length: a chord of a circle misses it by so much where it is 44 degrees long or less."""
BEND_STABLE = 0.3
"""Greatest value of (time between refreshes^2 x bending stiffness / mass) of a vertex. Bending by
itself is stable below 2; beside stiff springs, drapes began to jitter between 0.5 and 1."""


WATCHED = 5
"""Frames after which it is told how far the simulation is."""

Watch = Callable[[int, int], None]
"""Is called with the frames done and the greatest number of them."""


@dataclass(frozen=True, eq=False)
class Attachment:
    """Vertices held in place, axis by axis."""

    vertices: Int[np.ndarray, " held"]
    targets: Float[np.ndarray, "held 3"]
    """Where they are held [cm]."""
    stiffness: Float[np.ndarray, "held 3"]
    """Force per distance from the target along x, y and z [dyn/cm]: 0 is free, infinite is held
    exactly there."""
    most: float = np.inf
    """Greatest force on a vertex, along each axis [dyn]."""


@dataclass(frozen=True)
class Settings:
    """How long to simulate, and how."""

    frames: int = 300
    """Greatest number of frames, each a sixtieth of a second."""
    gather_frames: int = 15
    """First frames, without gravity and almost without friction, in which seams close."""
    gather_damping: float = 20.0
    """Share of the speed lost while gathering [1/s]."""
    top_speed: float = 300.0
    """No vertex moves faster [cm/s]."""
    push_speed: float = 300.0
    """Speed at which cloth that is inside the body is pushed out [cm/s]."""
    stop_speed: float = 1.0
    """At rest when the mean speed of the vertices is below this [cm/s]."""
    least_frames: int = 30
    """Frames before cloth may count as at rest."""
    most_substeps: int = 32
    """Steps a frame, at most; stiffer or finer cloth gets more inertia."""
    gravity: float = GRAVITY
    """Downwards [cm/s2]."""


@dataclass(frozen=True, eq=False)
class Motion:
    """What came of a simulation."""

    points: Float[np.ndarray, "vertex 3"]
    """Where the vertices ended [cm]."""
    frames: int
    """Frames simulated."""
    speeds: Float[np.ndarray, " frame"]
    """How far the vertices went in each frame, per time, their mean [cm/s]. Chatter within a
    frame that leads nowhere, as between two thighs, is not motion."""
    settled: bool
    """Whether the cloth came to rest."""


def solve(
    rest: Rest,
    start: Float[np.ndarray, "vertex 3"],
    field: DistanceField,
    fabric: Fabric,
    *,
    attachment: Attachment | None = None,
    resting: Int[np.ndarray, " k"] | None = None,
    settings: Settings | None = None,
    watch: Watch | None = None,
) -> Motion:
    """Let cloth come to rest.

    A spring along each edge has the stiffness (stretch x area / length^2), which makes equilateral
    triangles a sheet of the fabric's stretch and of Poisson's ratio 1/3.

    Args:
        rest: the cloth without strain.
        start: where its vertices begin [cm]; seams may gape, the cloth may cut into the body.
        field: the body.
        fabric: what the cloth is made of.
        attachment: vertices held in place.
        resting: vertices that rub on the body from the start, not only once seams have closed.
        settings: how long to simulate, and how.
        watch: is called every few frames with their number and the greatest there can be.

    Returns:
        The cloth at rest, or where it was after the last frame. The same bits on every run.
    """
    settings = settings or Settings()
    count = len(start)
    assert np.isfinite(start).all() and len(rest.vertex_area) == count
    assert not rest.edges.size or 0 <= rest.edges.min() <= rest.edges.max() < count
    stiffness = fabric.stretch * rest.area / rest.length**2
    weight = np.maximum(fabric.weight * rest.vertex_area, 1e-12)
    pull = np.bincount(rest.edges.ravel(), np.repeat(stiffness, 2), minlength=count)
    substeps = _substeps(pull / weight, settings.most_substeps)
    step = FRAME / substeps
    bending = bending_matrix(rest.faces, _flat(rest), count) * fabric.bend
    bend_pull = np.bincount(bending.indices, np.abs(bending.data), minlength=count)
    refresh = _refresh(bend_pull / weight, step)
    stable = np.maximum(pull / STABLE, refresh**2 * bend_pull / BEND_STABLE)
    inertia = np.maximum(weight, step**2 * stable)

    points = np.array(start, dtype=float, order="C")
    rubs = np.zeros(count, bool)
    rubs[[] if resting is None else resting] = True
    speeds = np.zeros(settings.frames)
    state, settled, frames = _initial_state(count), False, 0
    span = settings.frames if watch is None else WATCHED
    while frames < settings.frames and not settled:
        frames, settled = simulate(
            points,
            speeds,
            (frames, min(frames + span, settings.frames)),
            state,
            (rest.faces.astype(np.int64), MOST_LIFT * _side_lengths(rest, count)),
            (rest.edges.astype(np.int64), rest.length, stiffness),
            (bending.indptr, bending.indices, bending.data),
            (1.0 / inertia, weight / inertia),
            _held(attachment, inertia, step),
            rubs,
            (field.values, field.origin, 1.0 / field.cell),
            (fabric.thickness, fabric.friction, fabric.damping),
            (settings.gather_frames, settings.least_frames, substeps, refresh),
            (
                settings.gather_damping,
                settings.top_speed,
                settings.push_speed,
                settings.stop_speed,
                settings.gravity,
            ),
        )
        if watch is not None:
            watch(frames, settings.frames)
    return Motion(points, frames, speeds[:frames], bool(settled))


def _initial_state(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """How far each vertex went, its plane, how long that is left alone, and its lift."""
    planes = np.zeros((count, 4))
    planes[:, 3] = -np.inf
    return np.zeros((count, 3)), planes, np.zeros(count, np.int64), np.zeros(count)


def _flat(rest: Rest) -> Float[np.ndarray, "face 3 2"]:
    """The flat triangles, each with its first corner at the origin [cm]."""
    sides = np.linalg.inv(rest.inverse).transpose(0, 2, 1)
    return np.concatenate([np.zeros((len(sides), 1, 2)), sides], axis=1)


def _side_lengths(rest: Rest, count: int) -> Float[np.ndarray, " vertex"]:
    """Mean length of the edges that meet in each vertex [cm]."""
    ends, length = rest.edges.ravel(), np.repeat(rest.length, 2)
    total = np.bincount(ends, length, minlength=count)
    return total / np.maximum(np.bincount(ends, minlength=count), 1)


def _substeps(frequency: Float[np.ndarray, " vertex"], most: int) -> int:
    """Steps a frame that keep most vertices stable with no added inertia."""
    needed = FRAME * sqrt(float(np.percentile(frequency, MOST_VERTICES)) / STABLE)
    return min(max(ceil(needed), 2), most)


def _refresh(frequency: Float[np.ndarray, " vertex"], step: float) -> int:
    """Steps for which bending forces may be kept with no added inertia of most vertices."""
    stiffest = float(np.percentile(frequency, MOST_VERTICES))
    return int(min(max(sqrt(BEND_STABLE / max(stiffest, SHORTEST)) / step, 1), REFRESH))


def _held(
    attachment: Attachment | None, inertia: Float[np.ndarray, " vertex"], step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Held vertices, targets, the share of the way there that a step goes, its most [cm]."""
    if attachment is None:
        return np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
    vertices = attachment.vertices.astype(np.int64)
    strength = attachment.stiffness * (step**2 / inertia[vertices])[:, None]
    share = 1.0 - 1.0 / (1.0 + strength)
    most = attachment.most * step**2 / inertia[vertices]
    return vertices, np.ascontiguousarray(attachment.targets, dtype=float), share, most
