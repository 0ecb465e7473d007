"""Compiled loops of the solver: cloth moved step by step over a body.

The loops run over vertices and edges in their order on one thread, so sums have the same bits on
every run. All arrays are changed in place; lengths are cm, times s.
"""

# mypy: allow-untyped-defs, allow-untyped-decorators

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float32, Int
from numba import njit

from garmentimage.drape.solver._kernels_field import sample_field

FRAME = 1.0 / 60.0  # [s]
LOOK_AHEAD = 0.1  # forces are taken at the places this share of a step later
BEND_LOOK_AHEAD = 1.0
"""Bending forces are taken at the places this share of their time of use later. At a half they
would neither damp nor drive; forces kept for several steps can then drive the springs (as impulses
do in multiple time stepping), and crumpled cloth never stops to jitter. At one they damp."""
DISTANCE_TRUST = 0.8
"""Share of the distance field's value that is certain far from the body, where the field is too
great by up to an eighth."""
MAX_SKIPPED = 1000
"""Planes far from the body are computed anew after so many refreshes at the latest."""
LIFT_EVERY = 2
"""Frames between two looks for skin that comes through the cloth between vertices."""
SKIN_COVER = 0.15
"""The middles of triangles and of their sides are kept this far outside the skin [cm]; for that,
their corners are kept farther off than the cloth is thick."""
TAUT = 0.15  # cloth that is stretched by this share is not raised
LOWERED = 0.9
"""Lifts shrink to this share each time where the skin is covered by twice `SKIN_COVER`."""
MIN_FACING = 0.5
"""A corner is raised for a place between corners only where both face the body alike, by the cosine
of the angle between their directions: on the two sides of a crotch they do not."""
MIN_LENGTH = 1e-9  # keeps the direction of a spring of no length finite [cm]


class SolverState(NamedTuple):
    """What passes from one span of frames to the next, beside the places."""

    displacement: Float[np.ndarray, "vertex 3"]  # how far each vertex went in the last step [cm]
    planes: Float[np.ndarray, "vertex 4"]
    """Tangent plane of the body for each vertex: unit normal n and offset c [cm]; n . x >= c is
    outside."""
    skipped: Int[np.ndarray, " vertex"]
    """Refreshes for which each plane is still valid, as the body is too far off to be reached."""
    lift: Float[np.ndarray, " vertex"]
    """How far each vertex is kept off the skin beyond the thickness of the cloth [cm]."""


class Triangles(NamedTuple):
    """Triangles of the cloth."""

    faces: Int[np.ndarray, "face 3"]
    max_lift: Float[np.ndarray, " vertex"]  # greatest lift of each vertex [cm]


class Springs(NamedTuple):
    """Resistance to stretch along the edges."""

    ends: Int[np.ndarray, "edge 2"]
    length: Float[np.ndarray, " edge"]  # at rest [cm]
    stiffness: Float[np.ndarray, " edge"]  # [dyn/cm]


class Ties(NamedTuple):
    """Springs from vertices to places over triangles, which give way."""

    vertices: Int[np.ndarray, " tie"]
    triangles: Int[np.ndarray, "tie 3"]  # vertices of the triangle that each is tied to
    shares: Float[np.ndarray, "tie 3"]  # the place on it, as shares of theirs
    heights: Float[np.ndarray, " tie"]  # how far outward of it [cm]
    stiffness: Float[np.ndarray, " tie"]  # [dyn/cm]
    give: float  # distance from its place at which a tie pulls with all its force [cm]


class Bending(NamedTuple):
    """The matrix Q of the bending energy x Q x / 2 in CSR form [dyn/cm]."""

    first: Int[np.ndarray, " row"]
    column: Int[np.ndarray, " entry"]
    value: Float[np.ndarray, " entry"]


class Masses(NamedTuple):
    """Inertia and weight of the vertices."""

    inverse_mass: Float[np.ndarray, " vertex"]  # 1 / inertia [1/g]
    weight_share: Float[np.ndarray, " vertex"]
    """Mass that is weighed over inertia: below 1 where inertia was added for stability."""


class Pins(NamedTuple):
    """Vertices that are pulled to targets, axis by axis."""

    vertices: Int[np.ndarray, " pin"]
    targets: Float[np.ndarray, "pin 3"]  # [cm]
    share: Float[np.ndarray, "pin 3"]  # share of the distance to the target that a step covers
    max_shift: Float[np.ndarray, " pin"]  # farthest that a step pulls along an axis [cm]


class Field(NamedTuple):
    """The body's signed distance at the nodes of a grid."""

    values: Float32[np.ndarray, "x y z"]  # [cm]
    origin: Float[np.ndarray, " 3"]  # place of the first node [cm]
    per_cell: float  # 1 / distance between nodes [1/cm]


class Material(NamedTuple):
    """What the fabric adds to contact and motion; see `Fabric`."""

    thickness: float
    friction: float
    damping: float


class Model(NamedTuple):
    """Everything that stays the same during a simulation."""

    triangles: Triangles
    springs: Springs
    ties: Ties
    bending: Bending
    masses: Masses
    pins: Pins
    has_friction: Bool[np.ndarray, " vertex"]  # vertices with friction while seams close, too
    raised: Float[np.ndarray, " vertex"]
    """How far each vertex is kept off the body for cloth that lies beneath it [cm]."""
    field: Field
    material: Material


class Schedule(NamedTuple):
    """Numbers of frames and steps."""

    gather_frames: int
    min_frames: int
    substeps: int  # steps a frame
    refresh: int  # steps for which bending forces and planes are kept


class Rates(NamedTuple):
    """Speeds and accelerations; see `SolverSettings`."""

    gather_damping: float
    max_speed: float
    push_speed: float
    stop_speed: float
    gravity: float


# What is solved, for the places x of all vertices, with masses M and the step h:
#
#     M x'' = -dE/dx - c M x' - W g + contact,     E = stretch + bending
#
# Symplectic Euler in terms of the displacement u of a step, which is the speed times h; damping is
# exact for a free vertex:
#
#     u <- exp(-c h) u + h^2 M^-1 (f(x + a u) - W g),     x <- x + u
#
# Forces are taken at x + a u, where the vertices are about to be. A small share a (`LOOK_AHEAD`)
# damps the fastest modes only and keeps the step explicit.
@njit(cache=True)
def simulate(points, speeds, span, state, model, schedule, rates):
    """Move `points` [cm] through a span of frames (first, after the last), or until at rest.

    The mean speed in each frame is written to `speeds` [cm/s]. The result does not depend on how
    the frames are divided into spans. Returns the number of the frame after the last one simulated,
    and whether rest was reached.
    """
    # Numba compiles named tuples like plain variables: looking up a field costs nothing.
    material = model.material
    refresh, gather_frames = schedule.refresh, schedule.gather_frames
    step = FRAME / schedule.substeps
    count = len(points)
    # Buffers, made once: places ahead, all forces, and the bending forces that are kept.
    ahead = np.empty((count, 3))
    force = np.empty((count, 3))
    bend_force = np.zeros((count, 3))
    # Farthest that a vertex can get until planes are computed again.
    reach = rates.max_speed * step * refresh
    before = np.empty((count, 3))
    for frame in range(span[0], span[1]):
        before[:] = points
        # At first seams close: without gravity, heavily damped, and almost without friction.
        gathering = frame < gather_frames
        damping = np.exp(-(rates.gather_damping if gathering else material.damping) * step)
        friction = 0.0 if gathering else material.friction
        gravity_step = 0.0 if gathering else -rates.gravity * step * step
        for substep in range(schedule.substeps):
            if substep % refresh == 0:
                _look_ahead(points, state.displacement, BEND_LOOK_AHEAD * refresh, ahead)
                _bend(ahead, model.bending, bend_force)
                _find_planes(points, model.field, material.thickness, model.raised, reach, state)
            # Stretch is stiff, so its forces are computed anew in every step.
            _look_ahead(points, state.displacement, LOOK_AHEAD, ahead)
            force[:] = bend_force
            _stretch(ahead, model.springs, force)
            _tie(ahead, model.ties, force)
            _advance_all(
                points, state.displacement, force, model.masses, damping, gravity_step, step,
                rates.max_speed,
            )  # fmt: skip
            # Constraints on the places come last: pins first, since the body must win.
            _pull_to_pins(points, state.displacement, model.pins)
            _collide(
                points, state, material.friction, friction, model.has_friction,
                rates.push_speed * step,
            )  # fmt: skip
        if not gathering and frame % LIFT_EVERY == 0:
            _lift(points, model.triangles, model.springs, model.field, state)
        # Speeds are measured over a frame: chatter between steps that leads nowhere is not motion.
        speeds[frame] = _mean_distance(points, before) / FRAME
        if frame + 1 >= schedule.min_frames and not gathering and speeds[frame] < rates.stop_speed:
            return frame + 1, True
    return span[1], False


@njit(cache=True)
def _difference(points, i, others, j):
    """The vector from row j of `others` to row i of `points`."""
    return points[i, 0] - others[j, 0], points[i, 1] - others[j, 1], points[i, 2] - others[j, 2]


@njit(cache=True)
def _add(vectors, i, x, y, z):
    vectors[i, 0] += x
    vectors[i, 1] += y
    vectors[i, 2] += z


@njit(cache=True)
def _look_ahead(points, displacement, share, ahead):
    """Places x + share u: where the vertices will be that share of a step later."""
    for i in range(len(points)):
        for k in range(3):
            ahead[i, k] = points[i, k] + share * displacement[i, k]


# One spring along each edge e, energy k_e (|x_b - x_a| - l_e)^2 / 2, whose stiffness makes a mesh
# an elastic sheet (Van Gelder 1998, "Approximate simulation of elastic membranes by triangulated
# spring meshes").
@njit(cache=True)
def _stretch(points, springs, force):
    """Add the spring forces k (|d| - l) d / |d| along d = x_b - x_a, opposite at both ends."""
    ends, lengths, stiffness = springs
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        x, y, z = _difference(points, b, points, a)
        length = np.sqrt(x * x + y * y + z * z) + MIN_LENGTH
        # Force over length: k (1 - l / |d|), negative where the spring is compressed.
        tension = stiffness[e] * (1.0 - lengths[e] / length)
        _add(force, a, tension * x, tension * y, tension * z)
        _add(force, b, -tension * x, -tension * y, -tension * z)


@njit(cache=True)
def _tie(points, ties, force):
    """Add the forces of ties: k (q - x), of a length of `give` at most, and the opposite.

    The place q is that on the triangle, moved outward by the height of the tie.
    """
    for n in range(len(ties.vertices)):
        i = ties.vertices[n]
        a, b, c = ties.triangles[n]
        ux, uy, uz = _difference(points, b, points, a)
        vx, vy, vz = _difference(points, c, points, a)
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        height = ties.heights[n] / (np.sqrt(x * x + y * y + z * z) + MIN_LENGTH)
        x, y, z = height * x - points[i, 0], height * y - points[i, 1], height * z - points[i, 2]
        for k in range(3):
            j, share = ties.triangles[n, k], ties.shares[n, k]
            x += share * points[j, 0]
            y += share * points[j, 1]
            z += share * points[j, 2]
        away = np.sqrt(x * x + y * y + z * z) + MIN_LENGTH
        pull = ties.stiffness[n] * min(1.0, ties.give / away)
        x, y, z = pull * x, pull * y, pull * z
        _add(force, i, x, y, z)
        for k in range(3):
            j, share = ties.triangles[n, k], ties.shares[n, k]
            _add(force, j, -share * x, -share * y, -share * z)


# The quadratic energy x Q x / 2 of Bergou et al. 2006, see `mesh.bending`. Its force -Q x is
# linear, and is kept for several steps as it changes slowly.
@njit(cache=True)
def _bend(points, matrix, force):
    """Bending forces, a product with a sparse matrix for each axis."""
    first, column, value = matrix
    # Row by row, so that each vertex is written once.
    for i in range(len(points)):
        x = y = z = 0.0
        for n in range(first[i], first[i + 1]):
            j = column[n]
            x -= value[n] * points[j, 0]
            y -= value[n] * points[j, 1]
            z -= value[n] * points[j, 2]
        force[i, 0], force[i, 1], force[i, 2] = x, y, z


# The body is a signed distance field. Near a vertex it is replaced by the half-space n . x < c
# under the tangent plane of its nearest place.
@njit(cache=True)
def _find_planes(points, field, thickness, raised, reach, state):
    """The tangent plane of the body for each vertex, moved out by thickness, lift and `raised`.

    A vertex that cannot reach the body before keeps no plane for `skipped` more calls; it moves at
    most `reach` between calls.
    """
    # With the distance d at p and its direction n, the body's nearest place is p - d n.
    values, origin, per_cell = field
    planes, skipped, lift = state.planes, state.skipped, state.lift
    for i in range(len(points)):
        if skipped[i] > 0:
            skipped[i] -= 1
            continue
        # How far the vertex is outside of its own offset surface.
        p = points[i]
        distance, x, y, z = sample_field(values, origin, per_cell, p[0], p[1], p[2])
        clear = distance - thickness - lift[i] - raised[i]
        skipped[i] = min(max(int(clear * DISTANCE_TRUST / reach) - 1, 0), MAX_SKIPPED)
        if skipped[i] > 0:
            # An offset of minus infinity: everything is outside.
            planes[i, 3] = -np.inf
            continue
        length = np.sqrt(x * x + y * y + z * z) + MIN_LENGTH
        x, y, z = x / length, y / length, z / length
        # n . q = c for the nearest place q = p - clear n.
        planes[i, 0], planes[i, 1], planes[i, 2] = x, y, z
        planes[i, 3] = x * p[0] + y * p[1] + z * p[2] - clear


@njit(cache=True)
def _lift(points, triangles, springs, field, state):
    """Raise the corners of triangles through which the body comes, and lower the others.

    Contact is found at vertices only, and a chord of a round body runs through it. So the middles
    of triangles and of their sides are checked as well, and where they lie under the skin the
    corners are kept farther off, up to `max_lift`. Cloth that is taut already is not raised: the
    coarse triangles alone would stretch it.
    """
    faces, max_lift = triangles
    ends, lengths, _ = springs
    planes, lift = state.planes, state.lift
    # Greatest stretch of the edges that meet in each vertex.
    taut = np.zeros(len(points))
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        x, y, z = _difference(points, b, points, a)
        stretch = np.sqrt(x * x + y * y + z * z) / (lengths[e] + MIN_LENGTH) - 1.0
        taut[a] = max(taut[a], stretch)
        taut[b] = max(taut[b], stretch)
    needed = np.full(len(points), -np.inf)
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        # Without a plane at any corner the body is too far off.
        if planes[a, 3] == -np.inf and planes[b, 3] == -np.inf and planes[c, 3] == -np.inf:
            continue
        _needed_lift(points, field, planes, needed, a, b, c)
        # Neighbouring triangles run along a shared side in opposite directions: one looks at it.
        if a < b:
            _needed_lift(points, field, planes, needed, a, b, b)
        if b < c:
            _needed_lift(points, field, planes, needed, b, c, c)
        if c < a:
            _needed_lift(points, field, planes, needed, c, a, a)
    for i in range(len(points)):
        # Between the two limits of cover a lift is left as it is, so that it does not oscillate.
        if taut[i] > TAUT:
            lift[i] *= LOWERED
        elif needed[i] > 0.0:
            lift[i] = min(lift[i] + needed[i], max_lift[i])
        elif needed[i] < -SKIN_COVER:
            lift[i] *= LOWERED


@njit(cache=True)
def _needed_lift(points, field, planes, needed, a, b, c):
    """How much farther off a place between corners should be; `b` and `c` may be one corner."""
    # The middle of a side has two corners, that of a triangle three.
    values, origin, per_cell = field
    share = 0.5 if b == c else 1.0 / 3.0
    rest = 0.0 if b == c else share
    x = share * (points[a, 0] + points[b, 0]) + rest * points[c, 0]
    y = share * (points[a, 1] + points[b, 1]) + rest * points[c, 1]
    z = share * (points[a, 2] + points[b, 2]) + rest * points[c, 2]
    distance, u, v, w = sample_field(values, origin, per_cell, x, y, z)
    min_dot = MIN_FACING * np.sqrt(u * u + v * v + w * w)
    # Raising a corner helps only where its plane faces the same way as the body here.
    for i in (a, b, c):
        if planes[i, 0] * u + planes[i, 1] * v + planes[i, 2] * w > min_dot:
            needed[i] = max(needed[i], SKIN_COVER - distance)


@njit(cache=True)
def _advance_all(
    points, displacement, force, masses, damping, gravity_step, step, max_speed
):  # fmt: skip
    """One step of symplectic Euler."""
    max_shift = max_speed * step
    for i in range(len(points)):
        step_scale = masses.inverse_mass[i] * step * step
        x = displacement[i, 0] * damping + force[i, 0] * step_scale
        y = displacement[i, 1] * damping + force[i, 1] * step_scale
        y += gravity_step * masses.weight_share[i]
        z = displacement[i, 2] * damping + force[i, 2] * step_scale
        # A limit on speed keeps a vertex from jumping through an arm within one refresh.
        length = np.sqrt(x * x + y * y + z * z)
        share = max_shift / length if length > max_shift else 1.0
        x, y, z = x * share, y * share, z * share
        displacement[i, 0], displacement[i, 1], displacement[i, 2] = x, y, z
        _add(points, i, x, y, z)


# Held vertices are pulled by springs that are solved implicitly, vertex by vertex, which is stable
# for any stiffness.
@njit(cache=True)
def _pull_to_pins(points, displacement, pins):
    """Pull held vertices to their targets, each axis by its share and at most by `max_shift`."""
    vertices, targets, share, max_shift = pins
    for n in range(len(vertices)):
        i = vertices[n]
        for k in range(3):
            # A limited force: a belt gives way before it tears the cloth.
            shift = share[n, k] * (targets[n, k] - points[i, k])
            shift = min(max(shift, -max_shift[n]), max_shift[n])
            points[i, k] += shift
            displacement[i, k] += shift


# A vertex inside is projected onto the plane and loses its normal motion; Coulomb friction takes at
# most the share of the tangential motion that the push allows (Bridson, Fedkiw and Anderson 2002,
# "Robust treatment of collisions, contact and friction for cloth animation", Eq. 1).
@njit(cache=True)
def _collide(points, state, full_friction, friction, has_friction, max_push):
    """Put vertices outside the body, with friction, and stop their motion along its normal.

    A push of length p takes min(mu p, |t|) from the tangential displacement t. The push itself
    leaves no speed behind: it corrects the place only.
    """
    planes, displacement = state.planes, state.displacement
    for i in range(len(points)):
        x, y, z = planes[i, 0], planes[i, 1], planes[i, 2]
        depth = planes[i, 3] - (x * points[i, 0] + y * points[i, 1] + z * points[i, 2])
        if depth <= 0.0:
            continue
        # Deep cloth comes out at a limited speed, which keeps its springs from bursting.
        push = min(depth, max_push)
        # Split the displacement into normal and tangential parts; the normal part is dropped.
        u = displacement[i]
        along = x * u[0] + y * u[1] + z * u[2]
        slip_x, slip_y, slip_z = u[0] - along * x, u[1] - along * y, u[2] - along * z
        slip = np.sqrt(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z)
        mu = full_friction if has_friction[i] else friction
        kept = max(0.0, 1.0 - mu * push / (slip + MIN_LENGTH))
        u[0], u[1], u[2] = slip_x * kept, slip_y * kept, slip_z * kept
        # The vertex has already moved by the whole slip, so what friction takes is undone here.
        lost = 1.0 - kept
        _add(
            points, i, push * x - slip_x * lost, push * y - slip_y * lost, push * z - slip_z * lost
        )


@njit(cache=True)
def _mean_distance(points, others):
    """Mean distance between rows."""
    total = 0.0
    for i in range(len(points)):
        x, y, z = _difference(points, i, others, i)
        total += np.sqrt(x * x + y * y + z * z)
    return total / len(points)
