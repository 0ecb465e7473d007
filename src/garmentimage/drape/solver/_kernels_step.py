"""One step of the cloth after the other, as fast as a machine can: the loops behind `solver`.

All arrays are changed in place. `points` are the vertices [cm] and `moved` is how far each went in
the last step [cm].
"""

# mypy: allow-untyped-defs, allow-untyped-decorators

import numpy as np
from numba import njit

from garmentimage.drape.solver._kernels_field import sample

FRAME = 1.0 / 60.0
"""[s]"""
LOOK_AHEAD = 0.1
"""Forces are taken at the places this share of a step later."""
BEND_LOOK_AHEAD = 1.0
"""Bending forces are taken at the places this share of their time of use later. At a half they
would neither damp nor drive; forces kept for several steps can then drive the springs (as impulses
do in multiple time stepping), and crumpled cloth jitters for ever. At one they damp."""
WARY = 0.8
"""Far from the body, a vertex can count on this share of the distance field's value."""
MOST_REST = 1000
"""A vertex far from the body is looked at again after so many refreshes, at the latest."""
LIFT_EVERY = 2
"""Once in so many frames it is looked whether the body comes through the cloth between vertices."""
SKIN_COVER = 0.15
"""The middles of triangles and of their sides stay this far outside the skin [cm]; so that they
do, their corners stay farther off than the cloth is thick."""
TAUT = 0.15
"""Cloth that is stretched by this share is not raised."""
LOWERED = 0.9
"""Corners come back by this share of the lift each time where the skin is covered by twice that."""
ALIKE = 0.5
"""Only corners that face the body as the place between them does, by the cosine of the angle, can
be of help there: on both sides of a crotch they do not."""
SHORTEST = 1e-9
"""Keeps the direction of a spring of no length finite [cm]."""


@njit(cache=True)
def simulate(
    points, speeds, span, state, triangles, springs, bending, masses, held, rubs, field, cloth,
    counts, rates,
):  # fmt: skip
    """Move `points` through a span of frames, or until at rest.

    Returns the frames taken since the first and whether rest was reached. `state` is what goes on
    from span to span, see `_initial_state` of the solver; how long spans are changes no bit.
    """
    moved, planes, rest, lift = state
    ends, lengths, stiffness = springs
    lightness, weight_share = masses
    thickness, friction, damping = cloth
    gather_frames, least_frames, substeps, refresh = counts
    gather_damping, top_speed, push_speed, stop_speed, gravity = rates
    step = FRAME / substeps
    count = len(points)
    ahead = np.empty((count, 3))
    force = np.empty((count, 3))
    bend_force = np.zeros((count, 3))
    reach = top_speed * step * refresh
    before = np.empty((count, 3))
    for frame in range(span[0], span[1]):
        before[:] = points
        gathering = frame < gather_frames
        keep = np.exp(-(gather_damping if gathering else damping) * step)
        grip = 0.0 if gathering else friction
        fall = 0.0 if gathering else -gravity * step * step
        for substep in range(substeps):
            if substep % refresh == 0:
                _look_ahead(points, moved, BEND_LOOK_AHEAD * refresh, ahead)
                _bend(ahead, bending, bend_force)
                _find_planes(points, field, thickness, lift, reach, planes, rest)
            _look_ahead(points, moved, LOOK_AHEAD, ahead)
            force[:] = bend_force
            _stretch(ahead, ends, lengths, stiffness, force)
            for i in range(count):
                pace = lightness[i] * step * step
                x = moved[i, 0] * keep + force[i, 0] * pace
                y = moved[i, 1] * keep + force[i, 1] * pace + fall * weight_share[i]
                z = moved[i, 2] * keep + force[i, 2] * pace
                _advance(points, moved, i, x, y, z, top_speed * step)
            _hold(points, moved, held)
            _collide(points, moved, planes, friction, grip, rubs, push_speed * step)
        if not gathering and frame % LIFT_EVERY == 0:
            _lift(points, triangles, ends, lengths, field, planes, lift)
        speeds[frame] = _mean_distance(points, before) / FRAME
        if frame + 1 >= least_frames and not gathering and speeds[frame] < stop_speed:
            return frame + 1, True
    return span[1], False


@njit(cache=True)
def _look_ahead(points, moved, share, ahead):
    for i in range(len(points)):
        for k in range(3):
            ahead[i, k] = points[i, k] + share * moved[i, k]


@njit(cache=True)
def _stretch(points, ends, lengths, stiffness, force):
    """Add the forces of the springs."""
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        x = points[b, 0] - points[a, 0]
        y = points[b, 1] - points[a, 1]
        z = points[b, 2] - points[a, 2]
        length = np.sqrt(x * x + y * y + z * z) + SHORTEST
        tension = stiffness[e] * (1.0 - lengths[e] / length)
        x *= tension
        y *= tension
        z *= tension
        force[a, 0] += x
        force[a, 1] += y
        force[a, 2] += z
        force[b, 0] -= x
        force[b, 1] -= y
        force[b, 2] -= z


@njit(cache=True)
def _bend(points, matrix, force):
    """Forces of bending: minus the matrix times the places."""
    first, column, value = matrix
    for i in range(len(points)):
        x = y = z = 0.0
        for n in range(first[i], first[i + 1]):
            j = column[n]
            x -= value[n] * points[j, 0]
            y -= value[n] * points[j, 1]
            z -= value[n] * points[j, 2]
        force[i, 0], force[i, 1], force[i, 2] = x, y, z


@njit(cache=True)
def _find_planes(points, field, thickness, lift, reach, planes, rest):
    """The plane through the body's nearest place, moved out by thickness and lift, for each vertex.

    A plane is its unit normal n and its offset c: n . x >= c is outside. A vertex too far off to
    get to the body before is left alone for `rest` more calls; it moves at most `reach` a call.
    """
    values, origin, per_cell = field
    for i in range(len(points)):
        if rest[i] > 0:
            rest[i] -= 1
            continue
        p = points[i]
        distance, x, y, z = sample(values, origin, per_cell, p[0], p[1], p[2])
        clear = distance - thickness - lift[i]
        rest[i] = min(max(int(clear * WARY / reach) - 1, 0), MOST_REST)
        if rest[i] > 0:
            planes[i, 3] = -np.inf
            continue
        length = np.sqrt(x * x + y * y + z * z) + SHORTEST
        x /= length
        y /= length
        z /= length
        planes[i, 0], planes[i, 1], planes[i, 2] = x, y, z
        planes[i, 3] = x * p[0] + y * p[1] + z * p[2] - clear


@njit(cache=True)
def _lift(points, triangles, ends, lengths, field, planes, lift):
    """Raise the corners of triangles in which the body comes through, and lower the others.

    Cloth that is taut already is not raised: it would be stretched by its coarse triangles only.
    """
    faces, most = triangles
    taut = np.zeros(len(points))
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        x = points[b, 0] - points[a, 0]
        y = points[b, 1] - points[a, 1]
        z = points[b, 2] - points[a, 2]
        stretch = np.sqrt(x * x + y * y + z * z) / (lengths[e] + SHORTEST) - 1.0
        taut[a] = max(taut[a], stretch)
        taut[b] = max(taut[b], stretch)
    needed = np.full(len(points), -np.inf)
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        if planes[a, 3] == -np.inf and planes[b, 3] == -np.inf and planes[c, 3] == -np.inf:
            continue
        _need(points, field, planes, needed, a, b, c)
        if a < b:
            _need(points, field, planes, needed, a, b, b)
        if b < c:
            _need(points, field, planes, needed, b, c, c)
        if c < a:
            _need(points, field, planes, needed, c, a, a)
    for i in range(len(points)):
        if taut[i] > TAUT:
            lift[i] *= LOWERED
        elif needed[i] > 0.0:
            lift[i] = min(lift[i] + needed[i], most[i])
        elif needed[i] < -SKIN_COVER:
            lift[i] *= LOWERED


@njit(cache=True)
def _need(points, field, planes, needed, a, b, c):
    """How much farther off a place between corners should be; `b` and `c` may be one corner."""
    values, origin, per_cell = field
    share = 0.5 if b == c else 1.0 / 3.0
    rest = 0.0 if b == c else share
    x = share * (points[a, 0] + points[b, 0]) + rest * points[c, 0]
    y = share * (points[a, 1] + points[b, 1]) + rest * points[c, 1]
    z = share * (points[a, 2] + points[b, 2]) + rest * points[c, 2]
    distance, u, v, w = sample(values, origin, per_cell, x, y, z)
    least = ALIKE * np.sqrt(u * u + v * v + w * w)
    for i in (a, b, c):
        if planes[i, 0] * u + planes[i, 1] * v + planes[i, 2] * w > least:
            needed[i] = max(needed[i], SKIN_COVER - distance)


@njit(cache=True)
def _advance(points, moved, i, x, y, z, most):
    """Move a vertex, but no farther than `most`."""
    length = np.sqrt(x * x + y * y + z * z)
    share = most / length if length > most else 1.0
    moved[i, 0], moved[i, 1], moved[i, 2] = x * share, y * share, z * share
    points[i, 0] += moved[i, 0]
    points[i, 1] += moved[i, 1]
    points[i, 2] += moved[i, 2]


@njit(cache=True)
def _hold(points, moved, held):
    """Pull held vertices to their targets, no farther in one step than `most`."""
    vertices, targets, share, most = held
    for n in range(len(vertices)):
        i = vertices[n]
        for k in range(3):
            shift = share[n, k] * (targets[n, k] - points[i, k])
            shift = min(max(shift, -most[n]), most[n])
            points[i, k] += shift
            moved[i, k] += shift


@njit(cache=True)
def _collide(points, moved, planes, resting_friction, friction, rubs, most):
    """Put vertices outside the body, with friction, and stop their motion along its normal.

    A push out of the body is not a motion: it leaves no speed behind.
    """
    for i in range(len(points)):
        x, y, z = planes[i, 0], planes[i, 1], planes[i, 2]
        depth = planes[i, 3] - (x * points[i, 0] + y * points[i, 1] + z * points[i, 2])
        if depth <= 0.0:
            continue
        push = min(depth, most)
        along = x * moved[i, 0] + y * moved[i, 1] + z * moved[i, 2]
        slip_x = moved[i, 0] - along * x
        slip_y = moved[i, 1] - along * y
        slip_z = moved[i, 2] - along * z
        slip = np.sqrt(slip_x * slip_x + slip_y * slip_y + slip_z * slip_z)
        grip = resting_friction if rubs[i] else friction
        kept = max(0.0, 1.0 - grip * push / (slip + SHORTEST))
        moved[i, 0], moved[i, 1], moved[i, 2] = slip_x * kept, slip_y * kept, slip_z * kept
        points[i, 0] += push * x - slip_x * (1.0 - kept)
        points[i, 1] += push * y - slip_y * (1.0 - kept)
        points[i, 2] += push * z - slip_z * (1.0 - kept)


@njit(cache=True)
def _mean_distance(points, others):
    total = 0.0
    for i in range(len(points)):
        x = points[i, 0] - others[i, 0]
        y = points[i, 1] - others[i, 1]
        z = points[i, 2] - others[i, 2]
        total += np.sqrt(x * x + y * y + z * z)
    return total / len(points)
