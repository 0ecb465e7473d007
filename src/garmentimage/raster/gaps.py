"""Gaps: what keeps panels of one layer apart where they are not sewn together.

Two kinds of one-sided wishes (`Rows`): **facing** boundaries that leave a common node (the legs
of trousers, a sleeve and a side seam) open like a wedge, and panels that share nothing (the two
fronts of an open jacket) keep a distance. Weights fade smoothly with the geometry, so that a
small movement of the pattern is a small movement of the layout.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentimage.geometry.polygons import centroid
from garmentimage.raster.complex import SeamComplex
from garmentimage.raster.relax import INNER, Rows, Samples, ramp

WEDGE = 0.2 / 3.0
"""Opening of a gap of 1 cm, per cm from the node; other gaps in proportion."""
ROW_WEIGHT = 0.375
"""Strength of a row per cm of boundary; each pair of boundaries has rows both ways."""
SURELY_BEHIND, NOT_BEHIND = -20.0, -10.0
"""Boundaries this far [cm] on the wrong side of each other near the node do not face each other."""
NEAR_NODE = (10.0, 14.0)
"""What counts as near the node, fading [cm]."""
CHORD_START = (2.0, 6.0)
"""Chord directions are trusted from here on, fading [cm]."""
END_TAPER = 0.15
"""Share of the shorter boundary over which the wish fades out at its end."""
AXIS_BLEND = 0.2
"""How far from the diagonal a direction is pulled along both axes."""
LEAST_WEIGHT = 1e-6


@dataclass(frozen=True)
class _Chain:
    """A run of boundary that leaves a node and has no neighbour on its own layer."""

    panel: int
    ids: Int[np.ndarray, " n"]
    points: Float[np.ndarray, "n 2"]
    along: Float[np.ndarray, " n"]
    """Distance from the node [cm]."""
    hand: float
    """Side of the outside: normal = hand x (direction turned to the right)."""


def facing_rows(
    complex: SeamComplex, samples: Samples, gap: float, chord: bool
) -> Rows:
    """Wishes that facing boundaries open up to `gap` [cm].

    Two boundaries face each other where the cloth lies on their far sides. That is judged where
    the panels hang on the body, before they are brought together: only there a boundary on the
    wrong side of another (the outer sides of a hood's halves) shows.

    Args:
        complex: the garment.
        samples: its samples.
        gap: width of a fully opened gap [cm].
        chord: judge directions by chords from the node instead of tangents.
    """
    meeting: dict[tuple[int, int], list[_Chain]] = {}
    for layer, chain in _chains(complex, samples):
        meeting.setdefault((layer, int(chain.ids[0])), []).append(chain)
    parts = [
        rows
        for chains in meeting.values()
        for a in chains
        for b in chains
        if a.panel != b.panel
        for rows in _wedge(a, b, gap, chord)
    ]
    return Rows.joined(parts) if parts else Rows.none()


def _chains(complex: SeamComplex, samples: Samples) -> Iterator[tuple[int, _Chain]]:
    """Every chain, with its layer."""
    per_edge = INNER + 1
    for i, panel in enumerate(complex.placed.panels):
        first = samples.start[i]
        for loop in panel.loops:
            count = len(loop)
            here = slice(first, first + count * per_edge)
            first = here.stop
            alone = [_is_alone(complex, i, k, panel.layer) for k in loop]
            for k in range(count):
                for step in (1, -1):
                    if not alone[k]:
                        continue
                    run = 1
                    while run < count and alone[(k + step * run) % count]:
                        run += 1
                    begin = k if step > 0 else k + 1
                    at = (begin * per_edge + step * np.arange(run * per_edge + 1)) % (
                        count * per_edge
                    )
                    points = samples.rest[here][at]
                    steps = np.hypot(*np.diff(points, axis=0).T)
                    yield panel.layer, _Chain(
                        panel=i,
                        ids=samples.ids[here][at],
                        points=points,
                        along=np.concatenate([[0.0], np.cumsum(steps)]),
                        hand=float(panel.sign * step),
                    )


def _is_alone(complex: SeamComplex, panel: int, edge: int, layer: int) -> bool:
    arc = complex.arcs[complex.owner[panel, edge][0]]
    return sum(complex.placed.panels[p].layer == layer for p, _, _ in arc.sides) == 1


def _wedge(a: _Chain, b: _Chain, gap: float, chord: bool) -> Iterator[Rows]:
    """Rows from the samples of `a` to the points of `b` at the same distance from the node."""
    reach = min(a.along[-1], b.along[-1])
    s = a.along[(a.along > 0) & (a.along <= reach)]
    if not len(s):
        return
    q = np.arange(1, len(s) + 1)
    k = np.clip(np.searchsorted(b.along, s), 1, len(b.along) - 1)
    at = np.clip((s - b.along[k - 1]) / np.maximum(b.along[k] - b.along[k - 1], 1e-9), 0, 1)
    tangent_a = _directions(a, chord)[q]
    tangent_b = _between(_directions(b, chord), k, at)
    normal_a, normal_b = a.hand * _right(tangent_a), b.hand * _right(tangent_b)
    apart = normal_a - normal_b
    offset = _between(b.points, k, at) - a.points[q]
    bound = -0.1 if chord else -0.4
    facing = 1 - ramp((normal_a * normal_b).sum(axis=1), bound - 0.1, bound + 0.1)
    together = ramp((tangent_a * tangent_b).sum(axis=1), -0.3, -0.1)
    meets = (a.ids[q] == b.ids[k]) | (a.ids[q] == b.ids[k - 1])
    reached = np.minimum(facing, together) * ~meets
    taper = np.minimum(1.0, (reach - s) / (END_TAPER * reach))
    if chord:
        taper = taper * ramp(s, *CHORD_START)
    span = (a.along[np.minimum(q + 1, len(a.along) - 1)] - a.along[q - 1]) / 2
    size = np.abs(apart)
    lean = (size[:, 0] - size[:, 1]) / np.maximum(size.sum(axis=1), 1e-9)
    for axis, share in ((0, ramp(lean, -AXIS_BLEND, AXIS_BLEND)), (1, 1 - ramp(lean, -AXIS_BLEND, AXIS_BLEND))):
        sign = np.where(apart[:, axis] >= 0, 1.0, -1.0)
            behind = sign * offset[:, axis]
        sane = ramp(behind, *(NARROW_BEHIND if narrow else BEHIND)) 
        sane = np.maximum(sane, ramp(s, *NEAR_NODE))
        weight = ROW_WEIGHT * span * taper * share
        weight = weight * np.minimum.accumulate(np.minimum(reached, np.where(share > 0, sane, 1.0)))
        (use,) = np.nonzero(weight > LEAST_WEIGHT)
        yield Rows(
            base=a.ids[q][use],
            second=np.stack([b.ids[k - 1], b.ids[k]], axis=1)[use],
            at=at[use],
            axis=np.full(len(use), axis),
            sign=sign[use],
            distance=np.minimum(gap, WEDGE * gap * s)[use],
            weight=weight[use],
        )


def _directions(chain: _Chain, chord: bool) -> np.ndarray:
    """Unit direction at every sample: of the step that ends there, or of the chord to it."""
    steps = chain.points[1:] - (chain.points[0] if chord else chain.points[:-1])
    steps = np.concatenate([steps[:1], steps])
    return steps / (np.hypot(*steps.T)[:, None] + 1e-9)


def _right(directions: np.ndarray) -> np.ndarray:
    return np.stack([directions[:, 1], -directions[:, 0]], axis=1)


def _between(values: np.ndarray, k: np.ndarray, at: np.ndarray) -> np.ndarray:
    return (1 - at[:, None]) * values[k - 1] + at[:, None] * values[k]


CLEARANCE = 1.8
"""Distance that panels keep which share no node [cm]."""
WATCHED = 3.0
"""Pairs of boundary points up to this much farther apart are watched [cm]."""


def clearance_rows(
    complex: SeamComplex, samples: Samples, points: Float[np.ndarray, "n 2"]
) -> Rows:
    """Wishes that keep panels of one layer apart that share no node, where they come near.

    Points are compared along the axis on which the panels' rest positions lie farther apart,
    with what stands at the same place on the other axis.
    """
    panels = complex.placed.panels
    rings = [samples.ids[samples.panel(i)] for i in range(len(panels))]
    low = np.array([points[r].min(axis=0) for r in rings]) - CLEARANCE
    high = np.array([points[r].max(axis=0) for r in rings]) + CLEARANCE
    centres = np.array([centroid(p.outline) for p in panels])
    parts = []
    for i in range(len(panels)):
        for j in range(len(panels)):
            if i == j or panels[i].layer != panels[j].layer:
                continue
            if (low[i] > high[j]).any() or (low[j] > high[i]).any():
                continue
            if np.intersect1d(rings[i], rings[j]).size:
                continue
            parts.append(_apart(samples, points, i, j, centres[j] - centres[i]))
    return Rows.joined(parts) if parts else Rows.none()


def _apart(
    samples: Samples, points: np.ndarray, i: int, j: int, towards: np.ndarray
) -> Rows:
    """Rows from the samples of panel `i` to the boundary of panel `j`, which lies `towards`."""
    axis = int(abs(towards[1]) > abs(towards[0]))
    sign = 1.0 if towards[axis] >= 0 else -1.0
    mine, part = samples.ids[samples.panel(i)], samples.panel(j)
    start, end = samples.ids[part], samples.ids[samples.following[part]]
    level = points[mine][:, None, 1 - axis]
    a, b = points[start, 1 - axis], points[end, 1 - axis]
    rise = np.where(np.abs(b - a) > 1e-9, b - a, 1e-9)
    at = (level - a) / rise
    place = points[start, axis] + at * (points[end, axis] - points[start, axis])
    distance = np.where((at >= 0) & (at <= 1), sign * (place - points[mine][:, None, axis]), np.inf)
    nearest = distance.argmin(axis=1)
    rows = np.arange(len(mine))
    (use,) = np.nonzero(distance[rows, nearest] < CLEARANCE + WATCHED)
    k = nearest[use]
    steps = points[mine] - points[np.roll(mine, 1)]
    spans = np.hypot(*steps.T)
    return Rows(
        base=mine[use],
        second=np.stack([start[k], end[k]], axis=1),
        at=at[use, k],
        axis=np.full(len(use), axis),
        sign=np.full(len(use), sign),
        distance=np.full(len(use), CLEARANCE),
        weight=ROW_WEIGHT * np.maximum(spans[use], LEAST_WEIGHT),
    )
