"""Relaxation: all panels drawn at once in the picture plane, each keeping its shape as it can.

Minimised over the positions x of all samples, one per node of the seam graph and `INNER` per arc,
so that seams are coincident: with displacement d = x - u from the rest position u and the boundary
length s that a sample stands for, the sum over the panels, times their stiffness, of

    sum over neighbours  |d_i - d_j|² / h
  + SPREAD sum over pairs  s_i s_j |d_i - d_j|² / (|u_i - u_j|² + NEAR²)
  + ANCHOR sum  s_i |d_i|²

and, for every constraint of `constraints`, weight x max(distance - sign (x_first - x_base), 0)².
Without those it is one linear system A x = b with a positive definite A, factored once (Cholesky).
With them it is its dual, a linear complementarity problem in the forces f >= 0 of the constraints
(`one_sided_forces`), which has one row per constraint and uses the same factor.

The second sum is a bending-free membrane measured on the boundary alone: no triangulation, which
would change its edges, and the drawing with them, at the slightest movement. Axes stay aligned
because rest positions are not rotated. Paper: the paper aligns panels by hand instead.
"""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.linalg import cho_factor, cho_solve

from garmentimage.raster.encode.layout._kernels import assemble_energy
from garmentimage.raster.encode.layout.constraints import LinearConstraints
from garmentimage.raster.encode.layout.reversed_seams import (
    reversed_seam_targets,
    short_arc_targets,
)
from garmentimage.raster.encode.layout.samples import Samples
from garmentimage.raster.encode.layout.seam_graph import SeamGraph

ANCHOR = 5e-4
"""Strength with which a sample keeps its place on the body, per cm of boundary."""
MEMBRANE = 0.25
"""Stiffness of a panel that is drawn as a membrane: as smooth as it can, its shape forgotten."""
MEMBRANE_ANCHOR = 1e-6
"""The same as `ANCHOR` for a membrane."""
MAX_ACTIVE_SETS = 40
"""Rounds of active sets before non-negative least squares solves the problem."""


@dataclass(frozen=True)
class Energy:
    """A quadratic energy x·A x - 2 b·x for both axes, factored once."""

    factor: Float[np.ndarray, "n n"]
    """Lower Cholesky factor of A; what is above its diagonal is not used."""
    load: Float[np.ndarray, "n 2"]
    """The part of b that keeps shapes; other shapes give another (see `rotated_load`)."""
    anchor_load: Float[np.ndarray, "n 2"]
    """The part of b that keeps places and directions."""


def energy(
    graph: SeamGraph,
    samples: Samples,
    rest: Float[np.ndarray, "r 2"],
    stiffness: Float[np.ndarray, " p"],
    membranes: Collection[int] = (),
    firm: bool = False,
) -> Energy:
    """The energy of the file's head, and the directions of reversed seams (see `reversed_seams`).

    With `firm`, short arcs keep their direction: among long ones they could be reversed.
    """
    count = samples.count
    assert len(rest) == len(samples.ids) == len(samples.following) == samples.start[-1]
    assert samples.ids.max() < count and np.isfinite(rest).all()
    # One matrix for both axes: only their loads differ.
    matrix, load, anchor_load = np.zeros((count, count)), np.zeros((count, 2)), np.zeros((count, 2))
    # A membrane is weak, so that others keep their shape, and hardly tied to its place.
    soft = np.array([p in membranes for p in range(len(stiffness))])
    weight = np.where(soft, MEMBRANE, stiffness)
    anchor = np.where(soft, MEMBRANE_ANCHOR, ANCHOR * stiffness)
    assemble_energy(
        matrix, load, anchor_load, samples.ids, samples.following, samples.start,
        rest, weight, anchor, soft,
    )  # fmt: skip
    targets = reversed_seam_targets(graph, samples, rest)
    targets += short_arc_targets(graph) if firm else []
    # An arc that is given a vector pulls all its steps towards even parts of it.
    for arc, vector, strength in targets:
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
    """An energy with constraints, ready to be solved for any load."""

    energy: Energy
    constraints: LinearConstraints
    matrix: Float[np.ndarray, "m n"]
    """The coefficients C of the constraints."""
    response: Float[np.ndarray, "n m"]
    """What the unit force of each constraint moves: A⁻¹ Cᵀ."""

    @classmethod
    def of(cls, energy: Energy, constraints: LinearConstraints) -> "Constrained":
        """Prepare `energy` with `constraints`."""
        matrix = constraints.matrix(len(energy.factor))
        return cls(energy, constraints, matrix, _solve(energy, matrix.T))

    def minimum(self, load: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """Positions of least energy under a load.

        With x = A⁻¹ b + A⁻¹ Cᵀ f and W the weights, the forces solve f >= 0,
        (C A⁻¹ Cᵀ + W⁻¹) f >= distance - C A⁻¹ b, with equality where f > 0. Axes are independent.
        """
        # First as if there were no constraints ...
        points = _solve(self.energy, load + self.energy.anchor_load)
        for axis in (0, 1):
            # ... then what their forces add, in the space of those of one axis.
            (k,) = np.nonzero(self.constraints.axis == axis)
            if not len(k):
                continue
            missing = self.constraints.distance[k] - self.matrix[k] @ points[:, axis]
            # Soft: a force of 1 yields by 1 / weight.
            slack = np.diag(1 / self.constraints.weight[k])
            coupling = self.matrix[k] @ self.response[:, k] + slack
            points[:, axis] += self.response[:, k] @ one_sided_forces(coupling, missing)
        return points


def _solve(energy: Energy, right: Float[np.ndarray, "n k"]) -> Float[np.ndarray, "n k"]:
    """A⁻¹ times the columns of `right`."""
    return np.asarray(cho_solve((energy.factor, True), right, check_finite=False))


def one_sided_forces(
    coupling: Float[np.ndarray, "m m"], missing: Float[np.ndarray, " m"]
) -> Float[np.ndarray, " m"]:
    """Forces f >= 0 with coupling f >= missing, equal where f > 0.

    Primal-dual active sets (Hintermüller, Ito and Kunisch 2003), which end after a few rounds;
    should they cycle, the same problem as non-negative least squares (Lawson and Hanson 1974).
    """
    active = missing > 0
    for _ in range(MAX_ACTIVE_SETS):
        # The active constraints as equations, the others without force.
        force = np.zeros(len(missing))
        (k,) = np.nonzero(active)
        force[k] = np.linalg.solve(coupling[np.ix_(k, k)], missing[k])
        # Those that pull are let go, those that are broken are added.
        wanted = np.where(active, force > 0, coupling @ force < missing - 1e-12)
        if (wanted == active).all():
            return force
        active = wanted
    from scipy.optimize import nnls

    # With coupling = R Rᵀ: minimise |Rᵀ f - R⁻¹ missing|² over f >= 0.
    root = np.linalg.cholesky((coupling + coupling.T) / 2)
    return np.asarray(nnls(root.T, np.linalg.solve(root, missing))[0])
