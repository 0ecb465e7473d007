"""Relaxation: all panels drawn at once in the picture plane, each keeping its shape as it can.

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

from garmentimage.raster.encode.layout._kernels import assemble_energy
from garmentimage.raster.encode.layout.reversed_seams import short_arcs, turned_seams
from garmentimage.raster.encode.layout.samples import Samples
from garmentimage.raster.encode.layout.seam_graph import SeamGraph

ANCHOR = 5e-4

MEMBRANE = 0.25
"""Stiffness of a panel that is drawn as a membrane: as smooth as it can, its shape forgotten."""
MEMBRANE_ANCHOR = 1e-6


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
    graph: SeamGraph,
    samples: Samples,
    rest: Float[np.ndarray, "r 2"],
    stiffness: Float[np.ndarray, " p"],
    membranes: Collection[int] = (),
    firm: bool = False,
) -> Energy:
    """The energy of the file's head, with the seams that must be turned (see `turned`).

    With `firm`, short arcs keep their direction: among long ones they could be turned over.
    """
    from scipy.linalg import cho_factor

    count = samples.count
    assert len(rest) == len(samples.ids) == len(samples.following) == samples.start[-1]
    assert samples.ids.max() < count and np.isfinite(rest).all()
    matrix, load, anchor_load = np.zeros((count, count)), np.zeros((count, 2)), np.zeros((count, 2))
    soft = np.array([p in membranes for p in range(len(stiffness))])
    weight = np.where(soft, MEMBRANE, stiffness)
    anchor = np.where(soft, MEMBRANE_ANCHOR, ANCHOR * stiffness)
    assemble_energy(
        matrix, load, anchor_load, samples.ids, samples.following, samples.start,
        rest, weight, anchor, soft,
    )  # fmt: skip
    wishes = turned_seams(graph, samples, rest) + (short_arcs(graph) if firm else [])
    for arc, vector, strength in wishes:
        chain = samples.arcs[arc]
        steps = len(chain) - 1
        for u, v in pairwise(chain):
            matrix[[u, v], [u, v]] += strength * steps / 4
            matrix[[u, v], [v, u]] -= strength * steps / 4
            anchor_load[v] += strength / 4 * vector
            anchor_load[u] -= strength / 4 * vector
    return Energy(cho_factor(matrix, lower=True, check_finite=False)[0], load, anchor_load)


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
