"""Points sampled along arcs, and panels brought together on the body before the layout.

Every arc carries the same number of samples, spread by arc length and shared by its two sides, so
seams are coincident whatever the lengths of their sides, and nothing jumps when a length changes.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentimage.geometry import centroid, resample
from garmentimage.raster.encode.layout.seam_graph import SeamGraph
from garmentimage.raster.encode.placement import Placed

INNER = 10
"""Samples inside an arc, K."""
REFINED = 2
"""Steps of a finished curve per step between samples."""
LIMB = 0.5
"""Stiffness of sleeves and hoods: they follow the trunk, not the trunk them."""
TETHER = 0.01
"""How strongly a panel keeps its place on the body, next to 1 for each end of a seam."""
LIMB_TETHER = 1e-3
"""Share of it for sleeves and hoods."""


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
    start: Int[np.ndarray, " _"]
    """Where each panel begins in `ids`, and the end."""
    rest: Float[np.ndarray, "r 2"]
    """Rest position of every sample [cm]."""
    edges: Float[np.ndarray, "e f 2"]
    """Every edge of every panel at rest, with `REFINED` steps per step between samples [cm]."""

    def panel(self, index: int) -> slice:
        """The part of `ids` that belongs to a panel."""
        return slice(self.start[index], self.start[index + 1])


Resting = tuple[tuple[Float[np.ndarray, "_ 2"], ...], ...]
"""Per panel its curves at rest in the drawing (see `unbend`)."""


def sample(graph: SeamGraph, resting: Resting) -> Samples:
    """Samples of all arcs; panels at rest in their own layout pose."""
    nodes, count = graph.node_count, len(graph.arcs)
    inner = nodes + np.arange(count * INNER).reshape(count, INNER)
    ends = np.array([(arc.a, arc.b) for arc in graph.arcs])
    arcs = np.concatenate([ends[:, :1], inner, ends[:, 1:]], axis=1)
    shares = np.linspace(0, 1, REFINED * (INNER + 1) + 1)
    edges: list[np.ndarray] = []
    ids: list[np.ndarray] = []
    rest: list[np.ndarray] = []
    following: list[np.ndarray] = []
    start = [0]
    total = 0
    for i, panel in enumerate(graph.placed.panels):
        for loop in panel.loops:
            for k in loop:
                ids.append(graph.along(arcs, i, k)[:-1])
                edges.append(resample(resting[i][k], shares))
                rest.append(edges[-1][:-1:REFINED])
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
        edges=np.stack(edges),
    )


def trunk_share(placed: Placed) -> Float[np.ndarray, " p"]:
    """1 for panels on the trunk and the legs, 0 for sleeves and hoods, fading between.

    A garment takes its place and its shape from the trunk, so that neither changes when a sleeve
    or a hood is added.
    """
    x, y = np.array([centroid(p.outline) for p in placed.panels]).T
    # Centres of sleeves lie beside the trunk and above the hips, those of hoods above the neck.
    sleeve = ramp(np.abs(x), 18.0, 26.0) * ramp(y, 70.0, 90.0)
    hood = ramp(y, 146.0, 156.0)
    return np.asarray(1.0 - np.maximum(sleeve, hood))


def stiffness_of(placed: Placed) -> Float[np.ndarray, " p"]:
    """How strongly each panel keeps its shape, next to the others."""
    return LIMB + (1.0 - LIMB) * trunk_share(placed)


def ramp(
    x: Float[np.ndarray, "*shape"] | float, low: float, high: float
) -> Float[np.ndarray, "*shape"]:
    """0 up to `low`, 1 from `high` on, linear between."""
    return np.asarray(np.clip((x - low) / (high - low), 0.0, 1.0))


def gather(
    placed: Placed, resting: Resting, stiffness: Float[np.ndarray, " p"], free: Collection[int] = ()
) -> Float[np.ndarray, "p 2"]:
    """Shifts that bring the panels together at their seams, near their places on the body.

    Least squares: the shifts t minimise, over the two ends of all seams between panels i and j,
    the sum of w |(p_i + t_i) - (p_j + t_j)|² and of TETHER |t_i|² over the panels, with w the
    smaller stiffness. Seams of panels in `free` do not count. In cm.
    """
    count = len(placed.panels)
    matrix = np.diag(TETHER * np.maximum(trunk_share(placed), LIMB_TETHER))
    wanted = np.zeros((count, 2))
    for seam in placed.seams:
        (i, k), (j, m) = seam.a, seam.b
        if i == j or i in free or j in free:
            continue
        mine = resting[i][k][[0, -1]]
        theirs = resting[j][m][[-1, 0] if seam.crossed else [0, -1]]
        weight = min(stiffness[i], stiffness[j])
        matrix[[i, j], [i, j]] += 2 * weight
        matrix[[i, j], [j, i]] -= 2 * weight
        gap = weight * (theirs - mine).sum(axis=0)
        wanted[i] += gap
        wanted[j] -= gap
    return np.linalg.solve(matrix, wanted)
