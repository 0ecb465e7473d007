"""Joints: where an outline is so smooth that the raster may draw two edges as one.

Drawings by CAD programs and traced outlines come in hundreds of short edges, more than any grid
has lines. Edges of one fate (free, or sewn to edges that follow each other, too) that meet
smoothly are one edge to the raster; stubs (see `pattern.seam_runs`) are a part of the edge beside
them. No point moves: a joined edge is drawn through all that it was joined from.

Words of this file:

- A **joint** is a vertex between two edges of a loop, named by the edge that starts there.
- A **stretch** is a chain of edges of one fate.
- A garment is **dense** when it has a stretch of many short edges.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np
from jaxtyping import Bool, Float

from garmentimage.geometry import Curve
from garmentimage.pattern import STUB_CM, Pattern, Side, sewn_runs, side_loops, stubs

DENSE_EDGES, DENSE_CM = 5, 6.0
"""A stretch of so many edges, shorter than this [cm] on average, is traced. None of 30,000
stretches of drafted garments and of those by others is."""
CORNER = np.deg2rad(75.0)
"""A turn that is a corner wherever it stands."""
SHARP_TURN = np.deg2rad(12.0)
SHARP_FACTOR = 2.5
"""A turn beyond the first is a corner too if it is this many times what the turns beside it, for
edges of their lengths, lead to expect."""
SHIFT_CM = 0.5
"""Where two sewn sides are not divided alike, joining may bring points this far apart [cm]."""


@dataclass(frozen=True)
class Joints:
    """Where edges are joined."""

    open: frozenset[Side]
    """Edges that continue the edge before them."""
    stubs: frozenset[Side]
    """Edges that are a part of the edge beside them, whatever they are sewn to."""
    kept: tuple[Side, ...]
    """Edges of dense garments whose starts, inside a stretch, decoding restores."""


@dataclass(frozen=True)
class _Stretch:
    """A chain of edges of one fate."""

    sides: tuple[tuple[Side, ...], ...]
    """The edges in loop order; where they are sewn, also what each is sewn to."""
    whole_loop: bool


def find_joints(pattern: Pattern) -> Joints:
    """The joints of a pattern that need no vertex of the raster: most patterns have none."""
    short = stubs(pattern)
    opened = _beside_stubs(pattern, short) if short else set()
    kept: list[Side] = []
    stretches = list(_stretches(pattern, short)) if _may_be_dense(pattern) else []
    if any(_is_dense(pattern, stretch.sides[0]) for stretch in stretches):
        for stretch in stretches:
            for joint, is_smooth in _joints(pattern, stretch):
                if joint not in opened:
                    kept.append(joint)
                    opened |= {joint} if is_smooth else set()
    return Joints(frozenset(opened), short, tuple(kept))


def _beside_stubs(pattern: Pattern, short: frozenset[Side]) -> set[Side]:
    """Joints that make each chain of stubs a part of the longer one of the edges beside it."""
    opened: set[Side] = set()
    for _, ring in side_loops(pattern):
        turn = next((k for k, side in enumerate(ring) if side not in short), 0)
        ring = [*ring[turn:], *ring[: turn + 1]]
        before, chain = ring[0], list[Side]()
        for side in ring[1:]:
            if side in short:
                chain.append(side)
                continue
            if chain:
                longer = pattern.curve(side).length > pattern.curve(before).length
                opened.update([*chain[1:], side] if longer else chain)
            before, chain = side, []
    return opened


def _stretches(pattern: Pattern, short: frozenset[Side]) -> Iterator[_Stretch]:
    """All stretches of more than one edge; each seam once."""
    sizes = {}
    for number, ring in side_loops(pattern):
        ring = [side for side in ring if side not in short]
        sizes[ring[0].panel, number] = len(ring)
        free = [side not in pattern.partners for side in ring]
        if all(free):
            yield _Stretch((tuple(ring),), whole_loop=True)
            continue
        turn = free.index(False)
        for is_sewn, chain in groupby((*ring[turn:], *ring[:turn]), pattern.partners.__contains__):
            if not is_sewn:
                yield _Stretch((tuple(chain),), whole_loop=False)
    runs = sewn_runs(pattern)
    for k, run in enumerate(runs):
        if k < run.partner:
            other = runs[run.partner]
            whole = any(len(r.edges) == sizes[r.panel, r.loop] for r in (run, other))
            facing = tuple(pattern.partners[side] for side in run.sides)
            yield _Stretch((run.sides, facing), whole_loop=whole)


def _may_be_dense(pattern: Pattern) -> bool:
    """Whether a loop has short edges enough; most patterns have none."""
    rings = (ring for _, ring in side_loops(pattern) if len(ring) >= DENSE_EDGES)
    by_length = (sorted(ring, key=lambda side: pattern.curve(side).length) for ring in rings)
    return any(_is_dense(pattern, ring[:DENSE_EDGES]) for ring in by_length)


def _is_dense(pattern: Pattern, edges: Sequence[Side]) -> bool:
    length = sum(pattern.curve(side).length for side in edges)
    return len(edges) >= DENSE_EDGES and length < DENSE_CM * len(edges)


def _joints(pattern: Pattern, stretch: _Stretch) -> Iterator[tuple[Side, bool]]:
    """The joints of a stretch on all its sides, and whether they are smooth on each."""
    starts = [pattern.curve(side).start[::-1] for side in stretch.sides[0]]
    count = len(starts)
    is_closed = stretch.whole_loop and pattern.curve(stretch.sides[0][-1]).end[::-1] == starts[0]
    # A closed stretch begins at its lowest vertex: where its loop begins cannot matter.
    turn = starts.index(min(starts)) if is_closed else 0
    facing = [sides[turn:] + sides[:turn] for sides in stretch.sides]
    walks = [_Walk.along(pattern, sides) for sides in facing]
    parts = _parts([walk.lengths for walk in walks])
    corners = np.zeros(len(parts) - 1, bool)
    for walk in walks:
        corners |= walk.corners(parts)
    ends = {0, count, *(parts[k + 1] for k in np.flatnonzero(corners))}
    if stretch.whole_loop and len(ends) == 2 and count > 1:
        # Every loop keeps two vertices.
        reached = np.cumsum(walks[0].lengths)[:-1]
        ends.add(1 + int(np.argmin(np.abs(reached - walks[0].lengths.sum() / 2))))
    if len(walks) == 2:
        ends |= _uneven([walk.lengths for walk in walks], sorted(ends))
    for k in range(0 if is_closed else 1, count):
        for walk, sides in zip(walks, facing, strict=True):
            # Walked against its loop, a joint lies where the edge before it starts.
            yield (sides[k - 1] if walk.against else sides[k]), k not in ends


@dataclass(frozen=True)
class _Walk:
    """The edges of one side of a stretch, walked in the order of its first side."""

    lengths: Float[np.ndarray, " edge"]
    tips: Float[np.ndarray, "edge 4 2"]
    """Points of each edge at its start, just after it, just before its end, and there."""
    against: bool
    """The walk runs against the loop."""

    @classmethod
    def along(cls, pattern: Pattern, sides: Sequence[Side]) -> "_Walk":
        curves: list[Curve] = [pattern.curve(side) for side in sides]
        against = len(curves) > 1 and curves[0].end != curves[1].start
        if against:
            curves = [curve.reversed() for curve in curves]
        lengths = np.array([curve.length for curve in curves])
        return cls(lengths, np.array([curve.at(_TIPS) for curve in curves]), against)

    def corners(self, parts: Sequence[int]) -> Bool[np.ndarray, " joint"]:
        """Which of the joints between parts are corners."""
        first, last = np.array(parts), np.array([*parts[1:], len(self.lengths)]) - 1
        single = (first == last)[:, None]
        # A part of one edge leaves and arrives as the edge does, others along their chord.
        begin, end = self.tips[first], self.tips[last]
        chord = end[:, 3] - begin[:, 0]
        leave = np.where(single, begin[:, 1] - begin[:, 0], chord)[1:]
        arrive = np.where(single, end[:, 3] - end[:, 2], chord)[:-1]
        cross = arrive[:, 0] * leave[:, 1] - arrive[:, 1] * leave[:, 0]
        turn = np.arctan2(cross, (arrive * leave).sum(axis=1))
        length = np.add.reduceat(self.lengths, first)
        span = (length[:-1] + length[1:]) / 2
        bend = np.concatenate([[0.0], turn / span, [0.0]])
        beside = np.stack([bend[:-2], bend[2:]]) * np.sign(turn)
        expected = np.maximum(beside.max(axis=0), 0.0) * span
        size = np.abs(turn)
        sharp = (size > SHARP_TURN) & (size > SHARP_FACTOR * expected)
        return np.asarray((size > CORNER) | sharp)


_TIPS = np.array([0.0, 0.01, 0.99, 1.0])
"""Parameters at which the directions of a curve's ends are measured."""


def _parts(lengths: Sequence[np.ndarray]) -> list[int]:
    """First edges of parts that are long enough, on any side, to have a direction."""
    parts, reached = [0], 0.0
    for k, length in enumerate(np.max(lengths, axis=0).tolist()):
        if reached >= STUB_CM:
            parts.append(k)
            reached = 0.0
        reached += length
    if reached < STUB_CM and len(parts) > 1:
        parts.pop()
    return parts


def _uneven(lengths: Sequence[np.ndarray], ends: Sequence[int]) -> set[int]:
    """Joints between `ends` that are kept because the two sides are divided too differently."""
    found: set[int] = set()
    waiting = [(a, b) for a, b in pairwise(ends) if b - a > 1]
    while waiting:
        a, b = waiting.pop()
        one, other = (np.cumsum(side[a:b]) for side in lengths)
        shift = np.abs(one / one[-1] - other / other[-1])[:-1] * max(one[-1], other[-1])
        k = a + 1 + int(shift.argmax())
        if shift.max() > SHIFT_CM:
            found.add(k)
            waiting += [(x, y) for x, y in ((a, k), (k, b)) if y - x > 1]
    return found
