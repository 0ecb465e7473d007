"""Gaps: what keeps panels of one layer apart where they are not sewn together.

Two kinds of soft one-sided constraints (`LinearConstraints`): **facing** boundaries that leave a
common node (the legs of trousers, a sleeve and a side seam) open like a wedge, and panels that
share no node (the two fronts of an open jacket) keep a distance. Weights fade smoothly with the
geometry, so that a small movement of the pattern is a small movement of the layout.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.geometry import centroid, lengths_along
from garmentimage.raster.encode.layout.reversed_seams import reversal
from garmentimage.raster.encode.layout.samples import INNER, Samples, ramp
from garmentimage.raster.encode.layout.seam_graph import SeamGraph

WEDGE = 0.2 / 3.0
"""Opening of a gap of 1 cm, per cm from the node; other gaps in proportion."""
CONSTRAINT_WEIGHT = 0.375
"""Strength of a constraint per cm of boundary; each pair of boundaries has some both ways."""
BEHIND, FAR_BEHIND = (-6.0, -2.0), (-20.0, -10.0)
"""Boundaries this far [cm] on the wrong side of each other near their node do not face each other,
fading; the second pair away from reversed seams (trouser legs may lie crossed)."""
TOGETHER = (-0.3, -0.1)
"""Cosine between the directions of boundaries that run together, fading."""
NEAR_NODE = (10.0, 14.0)
"""What counts as near the node, fading [cm]."""
CHORD_START = (2.0, 6.0)
"""Chord directions are trusted from here on, fading [cm]."""
END_TAPER = 0.15
"""Share of the shorter boundary over which a gap fades out at its end."""
AXIS_BLEND = 0.2
"""How far from the diagonal a direction is pulled along both axes."""
MIN_WEIGHT = 1e-6
"""Constraints of less weight are left out."""
FACING, FACING_CHORDS = -0.4, -0.1
"""Cosine between the outward normals of boundaries that face each other, by tangents and by chords;
it fades over 0.1 to both sides."""
CLEARANCE = 1.8
"""Distance that panels keep which share no node [cm]."""
WATCHED = 3.0
"""Pairs of boundary points up to this much farther apart are watched [cm]."""
DEEP = (-45.0, -35.0)
"""Panels that overlap deeper than this are not pushed apart, fading [cm]."""
MAX_CONSTRAINTS = 1500
"""Panels that are near in more places than this lie on each other: they are not pushed apart."""
REACH = 1.0
"""A boundary that ends this far [cm] above or below a point no more keeps it away."""


@dataclass(frozen=True)
class LinearConstraints:
    """Soft one-sided constraints: sign (x[first] - x[base]) >= distance, along one axis.

    `first` is a point between two samples, at the share `at` from `second[:, 0]` to the other. What
    is missing to the distance costs weight x (missing)². All arrays have one row per constraint.
    """

    base: Int[np.ndarray, " m"]
    """Sample."""
    second: Int[np.ndarray, "m 2"]
    """The two samples between which `first` lies."""
    at: Float[np.ndarray, " m"]
    axis: Int[np.ndarray, " m"]
    sign: Float[np.ndarray, " m"]
    distance: Float[np.ndarray, " m"]
    """[cm]"""
    weight: Float[np.ndarray, " m"]

    @classmethod
    def joined(cls, parts: list["LinearConstraints"]) -> "LinearConstraints":
        """All constraints, one after the other; there may be none."""
        whole, real = np.zeros(0, int), np.zeros(0)
        none = cls(whole, np.zeros((0, 2), int), real, whole, real, real, real)
        names = [field.name for field in fields(cls)]
        return cls(*(np.concatenate([getattr(p, name) for p in (none, *parts)]) for name in names))

    def matrix(self, count: int) -> Float[np.ndarray, "m n"]:
        """One line per constraint: the coefficients of the samples."""
        lines = np.zeros((len(self.base), count))
        m = np.arange(len(self.base))
        lines[m, self.base] -= self.sign
        lines[m, self.second[:, 0]] += self.sign * (1 - self.at)
        lines[m, self.second[:, 1]] += self.sign * self.at
        return lines


@dataclass(frozen=True)
class _BoundaryRun:
    """A run of boundary that leaves a node and has no neighbour on its own layer."""

    key: tuple[int, int, int]
    """Panel, first edge, and 1 where the run follows the loop or -1 where it runs against it."""
    ids: Int[np.ndarray, " n"]
    points: Float[np.ndarray, "n 2"]
    along: Float[np.ndarray, " n"]
    """Distance from the node [cm]."""
    hand: float
    """Side of the outside: normal = hand x (direction turned to the right)."""
    directions: Float[np.ndarray, "n 2"]
    """Unit direction at every sample: of the step that ends there, or of the chord to it."""


def gap_constraints(
    graph: SeamGraph, samples: Samples, gap: float, chord: bool
) -> LinearConstraints:
    """Constraints that facing boundaries open up to `gap` [cm].

    Two boundaries face each other where the cloth lies on their far sides. That is judged where
    the panels hang on the body, before they are brought together: only there a boundary on the
    wrong side of another (the outer sides of a hood's parts) shows. With `chord`, directions are
    those of chords from the node instead of tangents.
    """
    meeting: dict[tuple[int, int], list[tuple[int, int, int]]] = {}
    for i, panel in enumerate(graph.placed.panels):
        for k in range(len(panel.curves)):
            if _is_alone(graph, i, k):
                arc, back = graph.owner[i, k]
                ends = graph.arcs[arc].a, graph.arcs[arc].b
                for step, node in ((1, ends[back]), (-1, ends[not back])):
                    meeting.setdefault((panel.layer, node), []).append((i, k, step))
    # Runs of different panels that leave one node on one layer may face each other.
    parts: list[LinearConstraints] = []
    for keys in meeting.values():
        if len({panel for panel, _, _ in keys}) < 2:
            continue
        runs = [_boundary_run(graph, samples, key, chord) for key in keys]
        for a, b in itertools.permutations(runs, 2):
            if a.key[0] != b.key[0]:
                parts.extend(_wedge(a, b, _crossing_share(graph, a, b), gap, chord))
    return LinearConstraints.joined(parts)


def _boundary_run(
    graph: SeamGraph, samples: Samples, key: tuple[int, int, int], chord: bool
) -> _BoundaryRun:
    """The run of boundary that begins with one edge, up to the next that has a neighbour."""
    i, edge, step = key
    panel = graph.placed.panels[i]
    first = int(samples.start[i])
    for loop in panel.loops:
        here = slice(first, first + len(loop) * (INNER + 1))
        if edge in loop:
            break
        first = here.stop
    count, k, run = len(loop), loop.index(edge), 1
    while run < count and _is_alone(graph, i, loop[(k + step * run) % count]):
        run += 1
    begin = (k if step > 0 else k + 1) * (INNER + 1)
    at = (begin + step * np.arange(run * (INNER + 1) + 1)) % (count * (INNER + 1))
    points = samples.rest[here][at]
    return _BoundaryRun(
        key=key,
        ids=samples.ids[here][at],
        points=points,
        along=lengths_along(points),
        hand=float(panel.sign * step),
        directions=_directions(points, chord),
    )


def _is_alone(graph: SeamGraph, panel: int, edge: int) -> bool:
    """Whether an edge is sewn to none of its own layer."""
    layers = [graph.placed.panels[p].layer for p, _, _ in graph.arc(panel, edge).sides]
    return layers.count(graph.placed.panels[panel].layer) == 1


class _Pairs(NamedTuple):
    """Samples of one run, and the points of another at the same distance from their node."""

    along: Float[np.ndarray, " n"]
    """That distance [cm]."""
    mine: Int[np.ndarray, " n"]
    """Samples of the first run."""
    k: Int[np.ndarray, " n"]
    """The points lie between samples `k - 1` and `k` of the second run ..."""
    at: Float[np.ndarray, " n"]
    """... at this share from one to the other."""


def _wedge(
    a: _BoundaryRun, b: _BoundaryRun, crossing: float, gap: float, chord: bool
) -> Iterator[LinearConstraints]:
    """Constraints from the samples of `a` to the points of `b` as far from their node.

    `crossing` is how far they may face each other from the wrong side, see `_crossing_share`.
    """
    reach = min(a.along[-1], b.along[-1])
    pairs = _pairs(a, b, reach)
    if not len(pairs.along):
        return
    apart, facing = _facing(a, b, pairs, chord)
    if not facing[0]:
        return
    s, q, k, at = pairs
    offset = _between(b.points, k, at) - a.points[q]
    strength = _strength(a, pairs, reach, chord)
    # A gap opens along the axes, of which one that lies near the normals counts alone.
    size = np.abs(apart)
    lean = (size[:, 0] - size[:, 1]) / np.maximum(size.sum(axis=1), 1e-9)
    sideways = ramp(lean, -AXIS_BLEND, AXIS_BLEND)
    for axis, share in ((0, sideways), (1, 1 - sideways)):
        sign = np.where(apart[:, axis] >= 0, 1.0, -1.0)
        # Boundaries far on the wrong side of each other are crossed, not facing: near the node
        # that counts, farther off it may be a curl.
        behind = sign * offset[:, axis]
        sane = np.maximum(ramp(behind, *BEHIND), crossing * ramp(behind, *FAR_BEHIND))
        sane = np.where(share > 0, np.maximum(sane, ramp(s, *NEAR_NODE)), 1.0)
        # What ends the facing of two runs ends it for all that is farther from the node.
        weight = strength * share * np.minimum.accumulate(np.minimum(facing, sane))
        (use,) = np.nonzero(weight > MIN_WEIGHT)
        yield LinearConstraints(
            base=a.ids[q][use],
            second=np.stack([b.ids[k - 1], b.ids[k]], axis=1)[use],
            at=at[use],
            axis=np.full(len(use), axis),
            sign=sign[use],
            distance=np.minimum(gap, WEDGE * gap * s)[use],
            weight=weight[use],
        )


def _pairs(a: _BoundaryRun, b: _BoundaryRun, reach: float) -> _Pairs:
    """The samples of `a` up to a distance from its node, and the points of `b` beside them."""
    s = a.along[(a.along > 0) & (a.along <= reach)]
    k = np.clip(np.searchsorted(b.along, s), 1, len(b.along) - 1)
    step = np.maximum(b.along[k] - b.along[k - 1], 1e-9)
    return _Pairs(s, np.arange(1, len(s) + 1), k, np.clip((s - b.along[k - 1]) / step, 0, 1))


def _facing(
    a: _BoundaryRun, b: _BoundaryRun, pairs: _Pairs, chord: bool
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, " n"]]:
    """In which direction pairs are to be parted, and how far they face each other (0..1).

    They do where their outward normals oppose each other and their directions agree, and not
    where they are the same samples.
    """
    _, q, k, at = pairs
    tangent_a = a.directions[q]
    tangent_b = _between(b.directions, k, at)
    normal_a, normal_b = a.hand * _right(tangent_a), b.hand * _right(tangent_b)
    bound = FACING_CHORDS if chord else FACING
    facing = 1 - ramp((normal_a * normal_b).sum(axis=1), bound - 0.1, bound + 0.1)
    together = ramp((tangent_a * tangent_b).sum(axis=1), *TOGETHER)
    meets: Bool[np.ndarray, " n"] = (a.ids[q] == b.ids[k]) | (a.ids[q] == b.ids[k - 1])
    return normal_a - normal_b, np.minimum(facing, together) * ~meets


def _strength(a: _BoundaryRun, pairs: _Pairs, reach: float, chord: bool) -> Float[np.ndarray, " n"]:
    """Weight of each pair where it faces fully: by the boundary that its sample stands for."""
    s, q = pairs.along, pairs.mine
    # A gap ends with the shorter boundary, but not at once.
    taper = np.minimum(1.0, (reach - s) / (END_TAPER * reach))
    if chord:
        taper = taper * ramp(s, *CHORD_START)
    span = (a.along[np.minimum(q + 1, len(a.along) - 1)] - a.along[q - 1]) / 2
    return np.asarray(CONSTRAINT_WEIGHT * span * taper)


def _crossing_share(graph: SeamGraph, a: _BoundaryRun, b: _BoundaryRun) -> float:
    """How far two runs that lie on the wrong side of each other may still face each other.

    1 where the cloth round their node is sewn from one to the other, as between trouser legs; 0
    where it is not, or by a reversed seam: one end of that seam has the panels on their
    far sides, the other has them crossed whatever is done.
    """
    panel, edge, step = a.key
    while True:
        loop = next(loop for loop in graph.placed.panels[panel].loops if edge in loop)
        edge, step = loop[(loop.index(edge) - step) % len(loop)], -step
        if _is_alone(graph, panel, edge):
            return float((panel, edge, step) == b.key)
        arc = graph.arc(panel, edge)
        reversed_share = reversal(graph, arc)
        if reversed_share > 0 or (panel, edge, step) == a.key:
            return 1.0 - reversed_share
        mine = next(side for side in arc.sides if side[:2] == (panel, edge))
        other = next(side for side in arc.sides if side[:2] != (panel, edge))
        panel, edge, step = other[0], other[1], step if mine[2] == other[2] else -step


def _directions(points: Float[np.ndarray, "n 2"], chord: bool) -> Float[np.ndarray, "n 2"]:
    """Unit direction at every point: of the step that ends there, or of the chord to it."""
    steps = points[1:] - (points[0] if chord else points[:-1])
    steps = np.concatenate([steps[:1], steps])
    return np.asarray(steps / (np.hypot(*steps.T)[:, None] + 1e-9))


def _right(directions: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
    """Directions turned a quarter to the right."""
    return np.stack([directions[:, 1], -directions[:, 0]], axis=1)


def _between(
    values: Float[np.ndarray, "m 2"], k: Int[np.ndarray, " n"], at: Float[np.ndarray, " n"]
) -> Float[np.ndarray, "n 2"]:
    """Values between those numbered `k - 1` and `k`, at a share from the first to the second."""
    return np.asarray((1 - at[:, None]) * values[k - 1] + at[:, None] * values[k])


def clearance_constraints(
    graph: SeamGraph, samples: Samples, points: Float[np.ndarray, "n 2"]
) -> LinearConstraints:
    """Constraints that keep panels of one layer apart that share no node, where they come near.

    Points are compared along the axis on which the panels' rest positions lie farther apart,
    with what stands at the same place on the other axis.
    """
    panels = graph.placed.panels
    rings = [samples.ids[samples.panel(i)] for i in range(len(panels))]
    low = np.array([points[r].min(axis=0) for r in rings]) - CLEARANCE
    high = np.array([points[r].max(axis=0) for r in rings]) + CLEARANCE
    centres = np.array([centroid(p.outline) for p in panels])
    parts: list[LinearConstraints] = []
    for i, j in itertools.permutations(range(len(panels)), 2):
        is_near = (low[i] <= high[j]).all() and (low[j] <= high[i]).all()
        is_apart = is_near and not np.intersect1d(rings[i], rings[j]).size
        if is_apart and panels[i].layer == panels[j].layer:
            parts.append(_apart(graph, samples, points, i, j, centres[j] - centres[i]))
    is_heap = sum(len(part.base) for part in parts) > MAX_CONSTRAINTS
    return LinearConstraints.joined([] if is_heap else parts)


def _apart(
    graph: SeamGraph,
    samples: Samples,
    points: Float[np.ndarray, "n 2"],
    i: int,
    j: int,
    towards: Float[np.ndarray, " 2"],
) -> LinearConstraints:
    """Constraints from the samples of panel `i` to the boundary of panel `j`, which lies `towards`.

    Each constraint weighs as much as the two boundaries face each other, so none appears or
    vanishes at once.
    """
    axis = int(abs(towards[1]) > abs(towards[0]))
    sign = 1.0 if towards[axis] >= 0 else -1.0
    # Samples round the outer loops, and the steps between them.
    sizes = [len(graph.placed.panels[panel].loops[0]) * (INNER + 1) for panel in (i, j)]
    mine, start = (samples.ids[samples.panel(k)][:n] for k, n in zip((i, j), sizes, strict=True))
    end = np.roll(start, -1)
    step = points[end] - points[start]
    ahead = points[np.roll(mine, -1)] - points[mine]
    behind = np.roll(ahead, 1, axis=0)
    # The outward side of a boundary lies to the right of its direction.
    outward = graph.placed.panels[i].sign * (1 if axis == 0 else -1) * sign
    # Boundaries keep their distance as far as they lie across the axis and towards each other.
    facing = np.maximum(outward * (ahead + behind)[:, 1 - axis] / 2, 0.0)
    inward = -graph.placed.panels[j].sign * (1 if axis == 0 else -1) * sign
    faced = np.maximum(inward * step[:, 1 - axis] / (np.hypot(*step.T) + 1e-9), 0.0)
    rise = np.where(np.abs(step[:, 1 - axis]) > 1e-9, step[:, 1 - axis], 1e-9)
    unbounded = (points[mine, 1 - axis][:, None] - points[start, 1 - axis]) / rise
    at = np.clip(unbounded, 0.0, 1.0)
    present = 1.0 - ramp(np.abs(unbounded - at) * np.abs(rise), 0.0, REACH)
    place = points[start, axis] + at * step[:, axis]
    distance = sign * (place - points[mine, axis][:, None])
    # Deeper overlaps are two panels on each other, which pushing would tear.
    shallow = ramp(distance, *DEEP)
    weight = CONSTRAINT_WEIGHT * present * facing[:, None] * faced * shallow
    row, k = np.nonzero((distance < CLEARANCE + WATCHED) & (weight > MIN_WEIGHT))
    return LinearConstraints(
        base=mine[row],
        second=np.stack([start[k], end[k]], axis=1),
        at=at[row, k],
        axis=np.full(len(row), axis),
        sign=np.full(len(row), sign),
        distance=np.full(len(row), CLEARANCE),
        weight=weight[row, k],
    )
