"""Cloth in motion until it rests: springs, bending, gravity, and a body to rest on.

The equations of motion and the time step stand above the loops in `_kernels_step`. At rest every
force is exactly what the fabric says: a finer mesh is not a softer cloth. Where skin would come
through between vertices, these are kept a little farther off.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from jaxtyping import Float, Int

from garmentimage.drape.fabric import Fabric
from garmentimage.drape.mesh import Pressed, Rest, bending_matrix
from garmentimage.drape.solver import _kernels_step as kernels
from garmentimage.drape.solver.distance_field import DistanceField

GRAVITY = 981.0  # [cm/s2]
STABLE = 0.96 * 2.0 / (1.0 + 2.0 * kernels.LOOK_AHEAD)
"""Greatest value of (step^2 x sum of spring stiffness / mass) of a vertex: stable is less than
2 / (1 + 2 LOOK_AHEAD), whatever the shape of the cloth; see `_model`."""
STABLE_PERCENT = 75
"""Percentage of the vertices for which steps are made short enough; the others get inertia."""
MAX_REFRESH = 6  # bending forces and planes of contact are kept for this many steps at most
MAX_LIFT = 0.2
"""Where skin comes through between vertices, these are kept farther off by up to this share of the
edges' length: a chord of a circle misses it by so much where it is 44 degrees long or less."""
BEND_STABLE = 0.3
"""Greatest value of (time between refreshes^2 x bending stiffness / mass) of a vertex. Bending by
itself is stable below 2; beside stiff springs, drapes began to jitter between 0.5 and 1."""
WATCHED_FRAMES = 5  # frames between two calls of `watch`

Watch = Callable[[int, int], None]
"""Called with the number of frames done and the greatest number of frames."""


@dataclass(frozen=True, eq=False)
class Attachment:
    """Vertices held in place, axis by axis."""

    vertices: Int[np.ndarray, " held"]
    targets: Float[np.ndarray, "held 3"]  # where they are held [cm]
    stiffness: Float[np.ndarray, "held 3"]
    """Force per distance from the target along x, y and z [dyn/cm]: 0 is free, infinite is held
    exactly there."""
    max_force: float = np.inf  # greatest force on a vertex, along each axis [dyn]


@dataclass(frozen=True)
class SolverSettings:
    """Length, speeds and accuracy of a simulation."""

    max_frames: int = 300
    """Greatest number of frames, each a sixtieth of a second."""
    gather_frames: int = 15
    """First frames, without gravity and almost without friction, in which seams close."""
    gather_damping: float = 20.0
    """Share of the speed lost while gathering [1/s]."""
    max_speed: float = 300.0
    """No vertex moves faster [cm/s]."""
    push_speed: float = 300.0
    """Speed at which cloth that is inside the body is pushed out [cm/s]."""
    stop_speed: float = 1.0
    """At rest when the mean speed of the vertices is below this [cm/s]."""
    min_frames: int = 30
    """Frames before cloth may count as at rest."""
    max_substeps: int = 32
    """Steps a frame, at most; stiffer or finer cloth gets more inertia."""
    gravity: float = GRAVITY
    """Downwards [cm/s2]."""


@dataclass(frozen=True, eq=False)
class Motion:
    """The result of a simulation."""

    points: Float[np.ndarray, "vertex 3"]  # where the vertices ended [cm]
    frames: int  # frames simulated
    speeds: Float[np.ndarray, " frame"]
    """How far the vertices went in each frame, per time, their mean [cm/s]. Chatter within a
    frame that leads nowhere, as between two thighs, is not motion."""
    settled: bool  # whether the cloth came to rest


def solve(
    rest: Rest,
    start: Float[np.ndarray, "vertex 3"],
    field: DistanceField,
    fabric: Fabric,
    *,
    attachment: Attachment | None = None,
    with_friction: Int[np.ndarray, " k"] | None = None,
    settings: SolverSettings | None = None,
    watch: Watch | None = None,
) -> Motion:
    """Let cloth come to rest.

    Args:
        rest: the cloth without strain.
        start: where its vertices begin [cm]; seams may gape, the cloth may cut into the body.
        field: the body.
        fabric: what the cloth is made of.
        attachment: vertices held in place.
        with_friction: vertices with friction from the start, not only once seams have closed.
        settings: length, speeds and accuracy of the simulation.
        watch: called every few frames with their number and the greatest number.

    Returns:
        The cloth at rest, or where it was after the last frame. The same bits on every run.
    """
    settings = settings or SolverSettings()
    count = len(start)
    # The compiled loops do not check indices.
    assert np.isfinite(start).all() and len(rest.vertex_area) == count
    assert not rest.edges.size or 0 <= rest.edges.min() <= rest.edges.max() < count
    model, schedule = _model(rest, field, fabric, attachment, with_friction, settings)
    rates = kernels.Rates(*(getattr(settings, name) for name in kernels.Rates._fields))
    points = np.array(start, dtype=float, order="C")
    speeds = np.zeros(settings.max_frames)
    # No motion, no contact yet (planes at minus infinity), and no lift.
    planes = np.tile([0.0, 0.0, 0.0, -np.inf], (count, 1))
    state = kernels.SolverState(
        np.zeros((count, 3)), planes, np.zeros(count, np.int64), np.zeros(count)
    )
    settled, frames = False, 0
    span = settings.max_frames if watch is None else WATCHED_FRAMES
    while frames < settings.max_frames and not settled:
        ahead = (frames, min(frames + span, settings.max_frames))
        frames, settled = kernels.simulate(points, speeds, ahead, state, model, schedule, rates)
        if watch is not None:
            watch(frames, settings.max_frames)
    return Motion(points, frames, speeds[:frames], bool(settled))


# The numbers that make the explicit steps stable. A step h of symplectic Euler with forces taken
# `LOOK_AHEAD` = a of a step later is stable for h^2 K / m < 4 / (1 + 2 a), where K is the greatest
# stiffness. By Gershgorin's theorem K is at most twice the sum of the stiffnesses of the springs
# that meet in a vertex.
# - Substeps are short enough for most vertices. Each of the others (next to a tiny triangle) is
#   given more inertia but no more weight, which changes the motion and not the state of rest.
# - Bending is weak beside stretch, so its forces are kept for several steps (multiple time
#   stepping).
def _model(
    rest: Rest,
    field: DistanceField,
    fabric: Fabric,
    attachment: Attachment | None,
    with_friction: Int[np.ndarray, " k"] | None,
    settings: SolverSettings,
) -> tuple[kernels.Model, kernels.Schedule]:
    """Springs, masses and steps of a cloth, its inertia raised where a step would be unstable."""
    count = len(rest.vertex_area)
    pressed = rest.pressed or Pressed.nothing(count)
    # So equilateral triangles are a sheet of the fabric's stretch and of Poisson's ratio 1/3.
    stiffness = fabric.stretch * rest.area / rest.length**2
    weight = np.maximum(fabric.weight * rest.vertex_area, 1e-12)
    pull = np.bincount(rest.edges.ravel(), np.repeat(stiffness, 2), minlength=count)
    pull = pull + pressed.pull()
    substeps = _substeps(pull / weight, settings.max_substeps)
    step = kernels.FRAME / substeps
    # The flat triangles, each with its first corner at the origin.
    sides = np.linalg.inv(rest.inverse).transpose(0, 2, 1)
    flat = np.concatenate([np.zeros((len(sides), 1, 2)), sides], axis=1)
    bending = bending_matrix(rest.faces, flat, count, rest.folds) * fabric.bend
    bend_pull = np.bincount(bending.indices, np.abs(bending.data), minlength=count)
    refresh = _refresh(bend_pull / weight, step)
    # Least inertia for which a step is stable: h^2 pull / m <= STABLE, and the same for bending.
    stable = np.maximum(pull / STABLE, refresh**2 * bend_pull / BEND_STABLE)
    inertia = np.maximum(weight, step**2 * stable)
    has_friction = np.zeros(count, bool)
    has_friction[[] if with_friction is None else with_friction] = True
    model = kernels.Model(
        kernels.Triangles(rest.faces.astype(np.int64), MAX_LIFT * _side_lengths(rest, count)),
        kernels.Springs(rest.edges.astype(np.int64), rest.length, stiffness),
        _ties(pressed),
        kernels.Bending(bending.indptr, bending.indices, bending.data),
        kernels.Masses(1.0 / inertia, weight / inertia),
        _pins(attachment, inertia, step),
        has_friction,
        np.ascontiguousarray(pressed.raised, dtype=float),
        kernels.Field(field.values, field.origin, 1.0 / field.cell),
        kernels.Material(fabric.thickness, fabric.friction, fabric.damping),
    )
    return model, kernels.Schedule(settings.gather_frames, settings.min_frames, substeps, refresh)


def _side_lengths(rest: Rest, count: int) -> Float[np.ndarray, " vertex"]:
    """Mean length of the edges that meet in each vertex [cm]."""
    ends, length = rest.edges.ravel(), np.repeat(rest.length, 2)
    total = np.bincount(ends, length, minlength=count)
    return total / np.maximum(np.bincount(ends, minlength=count), 1)


def _substeps(frequency: Float[np.ndarray, " vertex"], max_substeps: int) -> int:
    """Steps a frame that keep most vertices stable with no added inertia."""
    needed = kernels.FRAME * sqrt(float(np.percentile(frequency, STABLE_PERCENT)) / STABLE)
    return min(max(ceil(needed), 2), max_substeps)


def _refresh(frequency: Float[np.ndarray, " vertex"], step: float) -> int:
    """Steps for which bending forces may be kept with no added inertia of most vertices."""
    stiffest = float(np.percentile(frequency, STABLE_PERCENT))
    return int(
        min(max(sqrt(BEND_STABLE / max(stiffest, kernels.MIN_LENGTH)) / step, 1), MAX_REFRESH)
    )


def _pins(
    attachment: Attachment | None, inertia: Float[np.ndarray, " vertex"], step: float
) -> kernels.Pins:
    """Springs to the targets as an implicit step solves them: h^2 k / m over one more than that."""
    if attachment is None:
        attachment = Attachment(np.zeros(0, int), np.zeros((0, 3)), np.zeros((0, 3)))
    vertices = attachment.vertices.astype(np.int64)
    strength = attachment.stiffness * (step**2 / inertia[vertices])[:, None]
    share = 1.0 - 1.0 / (1.0 + strength)
    max_shift = attachment.max_force * step**2 / inertia[vertices]
    targets = np.ascontiguousarray(attachment.targets, dtype=float)
    return kernels.Pins(vertices, targets, share, max_shift)


def _ties(pressed: Pressed) -> kernels.Ties:
    return kernels.Ties(
        np.ascontiguousarray(pressed.vertices, dtype=np.int64),
        np.ascontiguousarray(pressed.triangles, dtype=np.int64),
        np.ascontiguousarray(pressed.shares, dtype=float),
        np.ascontiguousarray(pressed.heights, dtype=float),
        np.ascontiguousarray(pressed.stiffness, dtype=float),
        float(pressed.give),
    )
