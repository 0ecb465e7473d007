"""Relaxation: all panels drawn at once in the picture plane, each keeping its shape as it can.

Every arc carries the same number of samples, spread by arc length and shared by its two sides, so
seams are coincident whatever the lengths of their sides, and nothing jumps when a length changes.

Energy, with displacement d = x - u from the rest position u and sample length s, summed over the
panels with their stiffness:

    sum over neighbours  |d_i - d_j|² / h
  + SPREAD sum over pairs  s_i s_j |d_i - d_j|² / (|u_i - u_j|² + NEAR²)
  + ANCHOR sum  s_i |d_i|²

The second sum is a bending-free membrane measured on the boundary alone: no triangulation, which
would change its edges, and the drawing with them, at the slightest movement. Axes stay aligned
because rest positions are not turned. Paper: the paper aligns panels by hand instead.
"""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int
from numba import njit

from garmentimage.geometry.polygons import centroid, resample
from garmentimage.raster.complex import Arc, SeamComplex
from garmentimage.raster.image import EdgeType
from garmentimage.raster.place import Placed

INNER = 10
"""Samples inside an arc, K."""

SPREAD = 0.2
NEAR = 1.0
"""[cm]"""
ANCHOR = 5e-4
SHORTEST = 0.2
"""Neighbours closer together than this [cm] are no stiffer than at it."""

MEMBRANE = 0.25
"""Stiffness of a panel that is drawn as a membrane: as smooth as it can, its shape forgotten."""
MEMBRANE_ANCHOR = 1e-6

LIMB = 0.5
"""Stiffness of sleeves and hoods: they follow the trunk, not the trunk them."""

TETHER = 0.01
"""How strongly a panel keeps its place on the body, next to 1 for each end of a seam."""


@dataclass(frozen=True)
class Samples:
    """The sampled arcs, and the samples round each panel with their rest positions."""

    arcs: Int[np.ndarray, "arc k"]
    """Sample numbers along each arc; nodes come first and have their own numbers."""
    count: int
    ids: Int[np.ndarray, " r"]
    """Sample numbers round every loop of every panel, one after the other."""
    following: Int[np.ndarray, " r"]
    """Position in `ids` of the next sample of the same loop."""
    start: Int[np.ndarray, " p"]
    """Where each panel begins in `ids`, and the end."""
    rest: Float[np.ndarray, "r 2"]
    """Rest position of every sample [cm]."""

    def panel(self, index: int) -> slice:
        """The part of `ids` that belongs to a panel."""
        return slice(self.start[index], self.start[index + 1])


def sample(complex: SeamComplex) -> Samples:
    """Samples of all arcs; panels at rest in their own layout pose."""
    nodes, count = complex.node_count, len(complex.arcs)
    inner = nodes + np.arange(count * INNER).reshape(count, INNER)
    ends = np.array([(arc.a, arc.b) for arc in complex.arcs])
    arcs = np.concatenate([ends[:, :1], inner, ends[:, 1:]], axis=1)
    shares = np.linspace(0, 1, INNER + 2)
    ids: list[np.ndarray] = []
    rest: list[np.ndarray] = []
    following: list[np.ndarray] = []
    start = [0]
    total = 0
    for i, panel in enumerate(complex.placed.panels):
        for loop in panel.loops:
            for k in loop:
                arc, back = complex.owner[i, k]
                ids.append((arcs[arc, ::-1] if back else arcs[arc])[:-1])
                rest.append(resample(panel.curves[k], shares)[:-1])
            size = len(loop) * (INNER + 1)
            following.append(total + (np.arange(size) + 1) % size)
            total += size
        start.append(total)
    return Samples(
        arcs=arcs,
        count=nodes + count * INNER,
        ids=np.concatenate(ids),
        following=np.concatenate(following),
        start=np.array(start),
        rest=np.concatenate(rest),
    )


def stiffness_of(placed: Placed) -> Float[np.ndarray, " p"]:
    """1 for panels on the trunk and the legs, less for sleeves and hoods, fading between.

    So a garment keeps its shape on the trunk when a sleeve or a hood is added.
    """
    x, y = np.array([centroid(p.outline) for p in placed.panels]).T
    sleeve = ramp(np.abs(x), 18.0, 30.0) * ramp(y, 90.0, 104.0)
    hood = ramp(y, 146.0, 156.0)
    return 1.0 - (1.0 - LIMB) * np.maximum(sleeve, hood)


def ramp(x: np.ndarray | float, low: float, high: float) -> np.ndarray:
    """0 up to `low`, 1 from `high` on, linear between."""
    return np.clip((x - low) / (high - low), 0.0, 1.0)


def gather(
    placed: Placed, stiffness: Float[np.ndarray, " p"], free: Collection[int] = ()
) -> Float[np.ndarray, "p 2"]:
    """Shifts that bring the panels together at their seams, near their places on the body.

    Least squares over the ends of all seams; panels in `free` stay where they are.
    """
    count = len(placed.panels)
    matrix = np.diag(TETHER * stiffness)
    wanted = np.zeros((count, 2))
    for seam in placed.seams:
        (i, k), (j, m) = seam.a, seam.b
        if i == j or i in free or j in free:
            continue
        mine = placed.panels[i].curves[k][[0, -1]]
        theirs = placed.panels[j].curves[m][[-1, 0] if seam.crossed else [0, -1]]
        weight = min(stiffness[i], stiffness[j])
        matrix[[i, j], [i, j]] += 2 * weight
        matrix[[i, j], [j, i]] -= 2 * weight
        gap = weight * (theirs - mine).sum(axis=0)
        wanted[i] += gap
        wanted[j] -= gap
    return np.linalg.solve(matrix, wanted)


@dataclass(frozen=True)
class Rows:
    """One-sided wishes: sign (x[first] - x[base]) >= distance, along one axis.

    `first` is a point between two samples, at the share `at` from `second[:, 0]` to the other.
    """

    base: Int[np.ndarray, " m"]
    second: Int[np.ndarray, "m 2"]
    at: Float[np.ndarray, " m"]
    axis: Int[np.ndarray, " m"]
    sign: Float[np.ndarray, " m"]
    distance: Float[np.ndarray, " m"]
    weight: Float[np.ndarray, " m"]

    @classmethod
    def joined(cls, parts: list["Rows"]) -> "Rows":
        """All rows, one after the other."""
        names = ("base", "second", "at", "axis", "sign", "distance", "weight")
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in names))

    @classmethod
    def none(cls) -> "Rows":
        """No rows."""
        whole, real = np.zeros(0, int), np.zeros(0)
        return cls(whole, np.zeros((0, 2), int), real, whole, real, real, real)

    def matrix(self, count: int) -> Float[np.ndarray, "m n"]:
        """One line per row: the coefficients of the samples."""
        lines = np.zeros((len(self.base), count))
        m = np.arange(len(self.base))
        lines[m, self.base] -= self.sign
        lines[m, self.second[:, 0]] += self.sign * (1 - self.at)
        lines[m, self.second[:, 1]] += self.sign * self.at
        return lines


@dataclass(frozen=True)
class Energy:
    """A quadratic energy x·A x - 2 b·x for both axes, factored once."""

    factor: Float[np.ndarray, "n n"]
    load: Float[np.ndarray, "n 2"]
    anchor_load: Float[np.ndarray, "n 2"]


def energy(
    complex: SeamComplex,
    samples: Samples,
    rest: Float[np.ndarray, "r 2"],
    stiffness: Float[np.ndarray, " p"],
    membranes: Collection[int] = (),
) -> Energy:
    """The energy of the file's head, with the seams that must be turned (`_turned_seams`)."""
    from scipy.linalg import cho_factor

    count = samples.count
    matrix, load, anchor_load = np.zeros((count, count)), np.zeros((count, 2)), np.zeros((count, 2))
    soft = np.array([p in membranes for p in range(len(stiffness))])
    weight = np.where(soft, MEMBRANE, stiffness)
    anchor = np.where(soft, MEMBRANE_ANCHOR, ANCHOR * stiffness)
    _assemble(
        matrix, load, anchor_load, samples.ids, samples.following, samples.start,
        rest, weight, anchor, soft,
    )  # fmt: skip
    for arc, vector, strength in _turned_seams(complex, samples, rest):
        chain = samples.arcs[arc]
        steps = len(chain) - 1
        for u, v in pairwise(chain):
            matrix[[u, v], [u, v]] += strength * steps / 4
            matrix[[u, v], [v, u]] -= strength * steps / 4
            anchor_load[v] += strength / 4 * vector
            anchor_load[u] -= strength / 4 * vector
    return Energy(cho_factor(matrix, lower=True, check_finite=False)[0], load, anchor_load)


@njit(cache=True)
def _sample_lengths(following, rest):  # type: ignore[no-untyped-def]
    """Step to the next sample, and the boundary length that each sample stands for."""
    size = len(following)
    step, length = np.empty(size), np.zeros(size)
    for i in range(size):
        j = following[i]
        step[i] = np.hypot(rest[j, 0] - rest[i, 0], rest[j, 1] - rest[i, 1]) + 1e-6
        length[i] += step[i] / 2
        length[j] += step[i] / 2
    return step, length


@njit(cache=True)
def _pair_weight(i, j, following, rest, step, length):  # type: ignore[no-untyped-def]
    dx, dy = rest[i, 0] - rest[j, 0], rest[i, 1] - rest[j, 1]
    weight = SPREAD * length[i] * length[j] / (dx * dx + dy * dy + NEAR * NEAR)
    if following[i] == j:
        weight += 1 / max(step[i], SHORTEST)
    if following[j] == i:
        weight += 1 / max(step[j], SHORTEST)
    return weight


@njit(cache=True)
def _assemble(  # type: ignore[no-untyped-def]
    matrix, load, anchor_load, ids, following, start, rest, stiffness, anchor, soft
):
    """Add every panel's energy to `matrix`, `load` and `anchor_load`."""
    step, length = _sample_lengths(following, rest)
    for p in range(len(start) - 1):
        for i in range(start[p], start[p + 1]):
            a = ids[i]
            pull = anchor[p] * length[i]
            matrix[a, a] += pull
            anchor_load[a, 0] += pull * rest[i, 0]
            anchor_load[a, 1] += pull * rest[i, 1]
            for j in range(start[p], i):
                c = ids[j]
                if a == c:
                    continue
                w = stiffness[p] * _pair_weight(i, j, following, rest, step, length)
                matrix[a, a] += w
                matrix[c, c] += w
                matrix[a, c] -= w
                matrix[c, a] -= w
                if not soft[p]:
                    for axis in range(2):
                        pull_apart = w * (rest[i, axis] - rest[j, axis])
                        load[a, axis] += pull_apart
                        load[c, axis] -= pull_apart


@njit(cache=True)
def turned_load(points, ids, following, start, rest, stiffness, soft):  # type: ignore[no-untyped-def]
    """Load of an as-rigid-as-possible step: rest shapes turned as the points are now.

    Source: Sorkine and Alexa, As-Rigid-As-Possible Surface Modeling, 2007; here the
    neighbourhood of a sample is its whole panel, with the weights of the energy.
    """
    step, length = _sample_lengths(following, rest)
    load = np.zeros_like(points)
    size = len(ids)
    cos, sin = np.ones(size), np.zeros(size)
    for p in range(len(start) - 1):
        if soft[p]:
            continue
        for i in range(start[p], start[p + 1]):
            along, across = 0.0, 0.0
            for j in range(start[p], start[p + 1]):
                if i == j:
                    continue
                w = _pair_weight(i, j, following, rest, step, length)
                ux, uy = rest[i, 0] - rest[j, 0], rest[i, 1] - rest[j, 1]
                x = points[ids[i], 0] - points[ids[j], 0]
                y = points[ids[i], 1] - points[ids[j], 1]
                along += w * (x * ux + y * uy)
                across += w * (y * ux - x * uy)
            norm = np.hypot(along, across)
            if norm > 0:
                cos[i], sin[i] = along / norm, across / norm
        for i in range(start[p], start[p + 1]):
            for j in range(start[p], i):
                if ids[i] == ids[j]:
                    continue
                w = stiffness[p] * _pair_weight(i, j, following, rest, step, length)
                c, s = (cos[i] + cos[j]) / 2, (sin[i] + sin[j]) / 2
                ux, uy = rest[i, 0] - rest[j, 0], rest[i, 1] - rest[j, 1]
                load[ids[i], 0] += w * (c * ux - s * uy)
                load[ids[i], 1] += w * (s * ux + c * uy)
                load[ids[j], 0] -= w * (c * ux - s * uy)
                load[ids[j], 1] -= w * (s * ux + c * uy)
    return load


@dataclass(frozen=True)
class Constrained:
    """An energy with rows, ready to be solved for any load."""

    energy: Energy
    rows: Rows
    lines: Float[np.ndarray, "m n"]
    """The rows as a matrix."""
    answer: Float[np.ndarray, "n m"]
    """What each row's unit force moves."""

    @classmethod
    def of(cls, energy: Energy, rows: Rows) -> "Constrained":
        """Prepare `energy` with `rows`."""
        lines = rows.matrix(len(energy.factor))
        return cls(energy, rows, lines, _solve(energy, lines.T))

    def minimum(self, load: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """Positions of least energy; every unmet row adds weight x (what is missing)²."""
        points = _solve(self.energy, load + self.energy.anchor_load)
        for axis in (0, 1):
            (k,) = np.nonzero(self.rows.axis == axis)
            if not len(k):
                continue
            missing = self.rows.distance[k] - self.lines[k] @ points[:, axis]
            coupling = self.lines[k] @ self.answer[:, k] + np.diag(1 / self.rows.weight[k])
            points[:, axis] += self.answer[:, k] @ one_sided_forces(coupling, missing)
        return points


def _solve(energy: Energy, right: np.ndarray) -> np.ndarray:
    from scipy.linalg import cho_solve

    return cho_solve((energy.factor, True), right, check_finite=False)


ACTIVE_SET_ROUNDS = 40


def one_sided_forces(
    coupling: Float[np.ndarray, "m m"], missing: Float[np.ndarray, " m"]
) -> Float[np.ndarray, " m"]:
    """Forces f >= 0 with coupling f >= missing, equal where f > 0.

    Primal-dual active sets, which end after a few rounds; should they run in a circle, the
    same problem as non-negative least squares.
    """
    active = missing > 0
    for _ in range(ACTIVE_SET_ROUNDS):
        force = np.zeros(len(missing))
        (k,) = np.nonzero(active)
        force[k] = np.linalg.solve(coupling[np.ix_(k, k)], missing[k])
        wanted = np.where(active, force > 0, coupling @ force < missing - 1e-12)
        if (wanted == active).all():
            return force
        active = wanted
    from scipy.optimize import nnls

    root = np.linalg.cholesky((coupling + coupling.T) / 2)
    return nnls(root.T, np.linalg.solve(root, missing))[0]


TURN_FROM, TURN_FULLY = -0.3, -0.6
"""Cosine of the directions of a seam's two sides, from which on and at which it is turned."""
SHORT_FULLY, SHORT_UP_TO = 6.0, 10.0
"""Lengths [cm] up to which, and from which on no more, a seam of the silhouette is turned."""
SHORT_SPAN = 2.5
"""Length that such a seam is given along the silhouette [cm]."""
LONG_SPAN = 0.5
"""Share of its length that a seam between two panels of one layer is given."""
SHORT_STRENGTH, LONG_STRENGTH = 30.0, 8.0
NEIGHBOUR_REACH = 4 / 15
"""How far along its neighbours, as a share of them, the silhouette is looked at."""


def _turned_seams(
    complex: SeamComplex, samples: Samples, rest: Float[np.ndarray, "r 2"]
) -> list[tuple[int, np.ndarray, float]]:
    """Seams whose two sides point against each other: (arc, wished end - start [cm], strength).

    On one layer (the top of a hood) the seam is laid so that each panel is on its own side.
    Between the layers (where a front yoke reaches over the shoulder seam) it is a short piece of
    the silhouette, and is laid along it.
    """
    wishes = []
    middle: np.ndarray | None = None
    for i, arc in enumerate(complex.arcs):
        strength = turned_share(complex, arc)
        if strength <= 0:
            continue
        if arc.kind == EdgeType.SIDE_BY_SIDE:
            wishes.append((i, _between_panels(complex, i), LONG_STRENGTH * strength))
            continue
        strength *= 1 - float(ramp(arc.length, SHORT_FULLY, SHORT_UP_TO))
        if middle is None:
            middle = _mean_positions(samples, rest)
        vector = _along_silhouette(complex, samples, middle, i)
        if strength > 0 and vector is not None:
            wishes.append((i, vector, SHORT_STRENGTH * strength))
    return wishes


def turned_share(complex: SeamComplex, arc: Arc) -> float:
    """1 for a seam whose two sides point against each other, 0 for others, fading between."""
    if len(arc.sides) < 2 or arc.slit:
        return 0.0
    first, second = (_chord(complex, side) for side in arc.sides)
    cosine = first @ second / (np.hypot(*first) * np.hypot(*second) + 1e-9)
    return float(ramp(-cosine, -TURN_FROM, -TURN_FULLY))


def _chord(complex: SeamComplex, side: tuple[int, int, bool]) -> np.ndarray:
    panel, edge, back = side
    curve = complex.placed.panels[panel].curves[edge]
    return (curve[0] - curve[-1]) if back else (curve[-1] - curve[0])


def _between_panels(complex: SeamComplex, index: int) -> np.ndarray:
    """A vector along which the arc has the first side's panel on its proper hand."""
    arc = complex.arcs[index]
    panels = [complex.placed.panels[panel] for panel, _, _ in arc.sides]
    across = centroid(panels[0].outline) - centroid(panels[1].outline)
    across *= panels[0].sign * (-1 if arc.sides[0][2] else 1) / (np.hypot(*across) + 1e-9)
    return LONG_SPAN * arc.length * np.array([across[1], -across[0]])


def _along_silhouette(
    complex: SeamComplex, samples: Samples, points: np.ndarray, index: int
) -> np.ndarray | None:
    """From the front-to-back seams that go on at one end towards those at the other."""
    arc = complex.arcs[index]
    reach = round(NEIGHBOUR_REACH * (INNER + 1))
    ends = []
    for node in (arc.a, arc.b):
        beyond = [
            points[samples.arcs[j, reach if other.a == node else -1 - reach]]
            for j, other in enumerate(complex.arcs)
            if j != index and other.kind == EdgeType.FRONT_TO_BACK and node in (other.a, other.b)
        ]
        ends.append(np.mean(beyond, axis=0) if beyond else points[node])
    vector = ends[1] - ends[0]
    size = np.hypot(*vector)
    return SHORT_SPAN * vector / size if size > 1e-6 else None


def _mean_positions(samples: Samples, rest: np.ndarray) -> np.ndarray:
    """Rest position of every sample, the mean over the panels that share it."""
    total, times = np.zeros((samples.count, 2)), np.zeros(samples.count)
    np.add.at(total, samples.ids, rest)
    np.add.at(times, samples.ids, 1.0)
    return total / times[:, None]
