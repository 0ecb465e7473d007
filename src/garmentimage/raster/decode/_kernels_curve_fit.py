"""Corners of a run, and lines, arcs and Bézier curves fitted to it, in compiled code."""

import numpy as np
from numba import njit

LINE_TOL_CM = 0.1
LINE_TOL_SHARE = 0.003
"""A run this near its chord [cm, or share of its length] is straight."""

CURVE_TOL_CM = 0.25
CURVE_TOL_SHARE = 0.006
"""A curve may miss the points of its run by this much [cm, or share of its length]."""

QUADRATIC_TOL_CM = 0.05
QUADRATIC_TOL_SHARE = 0.0015
"""A quadratic curve this near is taken before a cubic is tried."""

MIN_CORNER_TURN = np.deg2rad(72.0)  # a turn between two chords that is a corner wherever it stands

MIN_SHARP_TURN = np.deg2rad(12.0)
MIN_SHARPNESS = 3.0
"""A turn beyond the first is a corner too if it is this many times the turns beside it."""

EVEN_CHORDS = 0.9
"""Chords of one edge are about equally long. Where two differ more than this, and a seam end leaves
nothing to compare their turn with, two edges meet."""

ARC_CHORDS = 3
ARC_SWEEP = np.deg2rad(60.0)
"""An arc needs so many chords, or a sweep beyond this: fewer points fit a parabola as well."""

MIN_ARC_SWEEP, MAX_ARC_SWEEP = np.deg2rad(0.5), np.deg2rad(354.0)
"""Sweeps of one arc: flatter runs count as lines, those nearer to a full circle as two curves."""

JUMP = 0.8
JUMP_TURN = np.deg2rad(0.5)
"""Where even chords of one length meet even chords of another, by at least this ratio, and the run
turns thereabouts, two edges meet though there is no corner."""

FULL_FIT_CHORDS = 4
"""From this many chords on, a curve through all of them is proof that there is no corner."""

MAX_STRETCH = 1.2
"""A fitted curve longer than this many times its polyline has swung out: it is refused."""

MIN_CHORD_SHARE = 0.2
"""A run that comes back this near to its start, as a share of its length, is two curves or more."""

REFUSED, LINE, QUADRATIC, CUBIC, ARC = -1, 0, 1, 2, 3
"""What a fit may be; of Bézier curves the number of control points."""

_FIT_ROUNDS = 5
_TABLE = 48


# A corner is a turn that is large in itself, or large beside its neighbours, or where lengths of
# chords jump: grid points of one edge are evenly spaced, those of two edges are not. A curve that
# fits all points closely proves that there is none.
@njit(cache=True)
def find_corners(points):
    """How far the polyline turns at each inner point [radians], and whether that is a corner."""
    inner = len(points) - 2
    turns = np.zeros(inner)
    corners = np.zeros(inner, np.bool_)
    chords = np.zeros(inner + 1)
    for k in range(inner + 1):
        chords[k] = np.hypot(points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1])
    for k in range(inner):
        ax, ay = points[k + 1] - points[k]
        bx, by = points[k + 2] - points[k + 1]
        turns[k] = abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
    suspect = False
    for k in range(inner):
        at_end = k == 0 or k == inner - 1
        beside = max(turns[k - 1] if k > 0 else 0.0, turns[k + 1] if k + 1 < inner else 0.0)
        even = min(chords[k], chords[k + 1]) > EVEN_CHORDS * max(chords[k], chords[k + 1])
        sharp = turns[k] > MIN_SHARP_TURN and turns[k] > MIN_SHARPNESS * beside
        corners[k] = turns[k] > MIN_CORNER_TURN or (sharp and not (at_end and even))
        corners[k] = corners[k] or (max(turns[k], beside) > JUMP_TURN and jumps(chords, k))
        suspect = suspect or corners[k]
    if suspect and inner + 1 >= FULL_FIT_CHORDS:
        shares, length = length_shares(points)
        if length > 0.0:
            error = fit_bezier(points, shares, length, 1, np.zeros((2, 2)))
            error = min(error, fit_arc(points)[2])
            if error <= max(QUADRATIC_TOL_CM, QUADRATIC_TOL_SHARE * length):
                corners[:] = False
    return turns, corners


@njit(cache=True)
def jumps(chords, k):
    """Whether even chords of two lengths meet after chord `k`."""
    a, b = chords[k], chords[k + 1]
    if min(a, b) > JUMP * max(a, b):
        return False
    is_clear = False
    if k > 0:
        is_clear = min(chords[k - 1], a) > EVEN_CHORDS * max(chords[k - 1], a)
        if not is_clear:
            return False
    if k + 2 < len(chords):
        return min(chords[k + 2], b) > EVEN_CHORDS * max(chords[k + 2], b)
    return is_clear


# The simplest curve that is near enough wins: line, arc, quadratic, cubic. What returns to
# its start is an arc or nothing, since a Bézier curve through such points is ill-conditioned.
@njit(cache=True)
def fit_run(points):
    """Kind of the curve, the control points of a Bézier curve, radius and sweep of an arc."""
    controls = np.zeros((2, 2))
    shares, length = length_shares(points)
    near = max(QUADRATIC_TOL_CM, QUADRATIC_TOL_SHARE * length)
    chord = np.hypot(points[-1, 0] - points[0, 0], points[-1, 1] - points[0, 1])
    if chord > 0 and line_error(points) <= max(LINE_TOL_CM, LINE_TOL_SHARE * length):
        return LINE, controls, 0.0, 0.0
    radius, swept, round_error = fit_arc(points)
    returns = chord <= MIN_CHORD_SHARE * length
    error = np.inf if returns else fit_bezier(points, shares, length, QUADRATIC, controls)
    if round_error <= near and round_error <= error:
        return ARC, controls, radius, swept
    if returns:
        return REFUSED, controls, 0.0, 0.0
    if error <= near:
        return QUADRATIC, controls, 0.0, 0.0
    tolerance = max(CURVE_TOL_CM, CURVE_TOL_SHARE * length)
    cubic = np.zeros((2, 2))
    if len(points) > 3 and fit_bezier(points, shares, length, CUBIC, cubic) <= tolerance:
        return CUBIC, cubic, 0.0, 0.0
    if error <= tolerance:
        return QUADRATIC, controls, 0.0, 0.0
    return REFUSED, controls, 0.0, 0.0


# Kåsa's circle (1976): least squares of x² + y² + a x + b y + c. Points lie at even shares of it.
@njit(cache=True)
def fit_arc(points):
    """Radius, sweep (counter-clockwise positive) and largest miss [cm] of a circular arc."""
    count = len(points)
    mx, my = points[:, 0].mean(), points[:, 1].mean()
    sxx, sxy, syy, sxr, syr = 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        x, y = points[j, 0] - mx, points[j, 1] - my
        r = x * x + y * y
        sxx += x * x
        sxy += x * y
        syy += y * y
        sxr += x * r
        syr += y * r
    determinant = sxx * syy - sxy * sxy
    if determinant <= 1e-9 * sxx * syy:
        return 0.0, 0.0, np.inf
    # Centre relative to the mean: the 2 x 2 normal equations by Cramer's rule.
    cx = mx + (sxr * syy - syr * sxy) / (2 * determinant)
    cy = my + (syr * sxx - sxr * sxy) / (2 * determinant)
    angles = np.zeros(count)
    for j in range(1, count):
        ax, ay = points[j - 1, 0] - cx, points[j - 1, 1] - cy
        bx, by = points[j, 0] - cx, points[j, 1] - cy
        angles[j] = angles[j - 1] + np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
    swept = angles[-1]
    is_clear = count > ARC_CHORDS or abs(swept) > ARC_SWEEP
    if not is_clear or not MIN_ARC_SWEEP < abs(swept) < MAX_ARC_SWEEP:
        return 0.0, 0.0, np.inf
    # Through the ends exactly; from the sweep, as the radius hardly tells arcs near a half circle.
    dx, dy = points[-1, 0] - points[0, 0], points[-1, 1] - points[0, 1]
    radius = np.hypot(dx, dy) / (2 * np.sin(abs(swept) / 2))
    away = 1 / (2 * np.tan(swept / 2))
    cx = points[0, 0] + dx / 2 - dy * away
    cy = points[0, 1] + dy / 2 + dx * away
    first = np.arctan2(points[0, 1] - cy, points[0, 0] - cx)
    error = 0.0
    for j in range(1, count - 1):
        angle = first + swept * j / (count - 1)
        x, y = cx + radius * np.cos(angle), cy + radius * np.sin(angle)
        error = max(error, np.hypot(x - points[j, 0], y - points[j, 1]))
    return radius, swept, error


@njit(cache=True)
def length_shares(points):
    """Share of the length at each point, and the length; chords bowed by the turns beside them."""
    count = len(points)
    angle = np.zeros(count)
    for k in range(1, count - 1):
        ax, ay = points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1]
        bx, by = points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1]
        angle[k] = np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
    if count > 2:
        angle[0], angle[-1] = angle[1], angle[-2]
    shares = np.zeros(count)
    for k in range(1, count):
        chord = np.hypot(points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1])
        bend = min(abs(angle[k - 1] + angle[k]) / 2, 1.5)
        # An arc that turns by b is b²/24 longer than its chord.
        shares[k] = shares[k - 1] + chord * (1 + bend * bend / 24)
    length = shares[-1]
    if length > 0:
        shares /= length
    return shares, length


@njit(cache=True)
def line_error(points):
    """Largest distance of a point from the chord; infinite where the run walks backwards."""
    dx, dy = points[-1, 0] - points[0, 0], points[-1, 1] - points[0, 1]
    chord = np.hypot(dx, dy)
    if chord <= 0.0:
        return np.inf
    worst, behind = 0.0, 0.0
    for k in range(1, len(points)):
        px, py = points[k, 0] - points[0, 0], points[k, 1] - points[0, 1]
        along = (px * dx + py * dy) / chord
        if along <= behind:
            return np.inf
        behind = along
        worst = max(worst, abs(px * dy - py * dx) / chord)
    return worst


# Points q_0 .. q_n of a run lie at known shares s_j of the *length* of the curve sought, since the
# encoder placed them so. A Bézier curve B with fixed ends minimises
#
#     sum over inner points |B(t_j) - q_j|²
#
# over its one or two control points (linear least squares by normal equations) for given parameters
# t_j; then each t_j is set to where B has the share s_j of its length, and both steps are repeated.
# This is the alternation of Plass and Stone 1983 ("Curve-fitting with piecewise parametric cubics")
# with shares of the length in place of nearest points.
@njit(cache=True)
def fit_bezier(points, shares, length, order, controls):
    """Fit `order` control points by least squares; returns the largest miss [cm]."""
    count = len(points)
    t = shares.copy()
    table = np.zeros(_TABLE + 1)
    error = np.inf
    for _ in range(_FIT_ROUNDS):
        if not solve_controls(points, t, order, controls):
            return np.inf
        x, y = points[0, 0], points[0, 1]
        for k in range(1, _TABLE + 1):
            px, py = bezier_point(points, controls, order, k / _TABLE)
            table[k] = table[k - 1] + np.hypot(px - x, py - y)
            x, y = px, py
        if not 0.0 < table[-1] <= MAX_STRETCH * length:
            return np.inf
        error = 0.0
        k = 0
        for j in range(1, count - 1):
            target = shares[j] * table[-1]
            while k + 1 < _TABLE and table[k + 1] < target:
                k += 1
            step = table[k + 1] - table[k]
            t[j] = (k + ((target - table[k]) / step if step > 0.0 else 0.0)) / _TABLE
            px, py = bezier_point(points, controls, order, t[j])
            error = max(error, np.hypot(px - points[j, 0], py - points[j, 1]))
    return error


@njit(cache=True)
def bernstein(order, t):
    """Weights at parameter `t` of start, first and second control point (of two), and end."""
    u = 1 - t
    if order == 1:
        return u * u, 2 * u * t, 0.0, t * t
    return u * u * u, 3 * u * u * t, 3 * u * t * t, t * t * t


@njit(cache=True)
def bezier_point(points, controls, order, t):
    a, b, c, d = bernstein(order, t)
    x = a * points[0, 0] + b * controls[0, 0] + c * controls[1, 0] + d * points[-1, 0]
    y = a * points[0, 1] + b * controls[0, 1] + c * controls[1, 1] + d * points[-1, 1]
    return x, y


@njit(cache=True)
def solve_controls(points, t, order, controls):
    """Control points that bring the curve nearest to the points at parameters `t`."""
    m00, m01, m11 = 0.0, 0.0, 0.0
    rhs = np.zeros((2, 2))
    for j in range(1, len(points) - 1):
        a, b, c, d = bernstein(order, t[j])
        m00 += b * b
        m01 += b * c
        m11 += c * c
        for axis in range(2):
            rest = points[j, axis] - a * points[0, axis] - d * points[-1, axis]
            rhs[0, axis] += b * rest
            rhs[1, axis] += c * rest
    if order == 1:
        if m00 < 1e-12:
            return False
        controls[0] = rhs[0] / m00
        return True
    # Two control points: a 2 x 2 system for each axis, the matrix shared.
    determinant = m00 * m11 - m01 * m01
    if determinant < 1e-12:
        return False
    for axis in range(2):
        controls[0, axis] = (m11 * rhs[0, axis] - m01 * rhs[1, axis]) / determinant
        controls[1, axis] = (m00 * rhs[1, axis] - m01 * rhs[0, axis]) / determinant
    return True
