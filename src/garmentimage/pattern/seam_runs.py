"""Seams: stitches that follow each other on both sides, taken as one.

- A **run** is a chain of consecutive edges of one loop that is sewn to another run; the two runs
  are a **seam**. Stitches belong to one seam as long as the next edge on one side is sewn to the
  next edge on the other (the one before it, where ends cross), in the same manner.
- A **gap** is a free (unsewn) stretch between two runs of a loop.
- Where the two sides of a seam meet at a vertex, the apex of a dart, both runs end, or the dart
  would fold away.
- A **closed** run is a whole loop without beginning: where its first edge lies does not count.
- A **stub** is an edge, or a chain of edges all sewn or all free, that is shorter than `STUB_CM`,
  as closing a loop with an extra vertex leaves behind. It is neither a run nor a gap: what lies
  beside it meets.
"""

from collections.abc import Container, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import dist

from garmentimage.pattern.model import Pattern, Side

STUB_CM = 0.2
"""Shorter edges are not meant [cm]. Of 78,000 edges of 1,370 garments by others 324 are shorter,
left over at corners and beside darts."""


@dataclass(frozen=True)
class SeamRun:
    """One side of a seam."""

    panel: str
    loop: int
    """0 for the outline, then the holes."""
    edges: tuple[int, ...]
    """Edge numbers of the panel, in loop order."""
    closed: bool
    """The whole loop, without beginning or end."""
    next: int
    """Index of the next run round the loop (its own where there is no other)."""
    gap_after: bool
    """A free stretch lies between this run and the next."""
    partner: int
    """Index of the run that this one is sewn to."""
    same_direction: bool
    """Start meets start, instead of start meets end."""

    @property
    def sides(self) -> tuple[Side, ...]:
        """The edges as stitches name them."""
        return tuple(Side(self.panel, edge) for edge in self.edges)


def sewn_runs(pattern: Pattern) -> tuple[SeamRun, ...]:
    """All runs of a pattern, in order of panel, loop and edge.

    Stubs are left out: their edges belong to no run. The pattern's stitches must name existing
    edges, each at most once.
    """
    left_out = stubs(pattern)
    loops = [(n, [s for s in ring if s not in left_out]) for n, ring in side_loops(pattern)]
    order = _SeamOrder(pattern, [ring for _, ring in loops], left_out)
    chains = [(number, order.chains(ring)) for number, ring in loops]
    every = [chain for _, own in chains for chain in own]
    index = {side: k for k, chain in enumerate(every) for side in chain}
    return tuple(
        SeamRun(
            panel=chain[0].panel,
            loop=number,
            edges=tuple(side.edge for side in chain),
            closed=order.continues(chain[-1]),
            next=index[following[0]],
            gap_after=order.after[chain[-1]] != following[0],
            partner=index[pattern.partners[chain[0]]],
            same_direction=order.stitch_of[chain[0]].same_direction,
        )
        for number, own in chains
        for chain, following in zip(own, own[1:] + own[:1], strict=True)
    )


class _SeamOrder:
    """Which edges follow each other round the loops, and along seams."""

    def __init__(
        self, pattern: Pattern, rings: Sequence[list[Side]], left_out: Container[Side]
    ) -> None:
        self.partners = pattern.partners
        self.stitch_of = {s: x for x in pattern.stitches for s in x.sides if s not in left_out}
        self.after = {ring[k - 1]: ring[k] for ring in rings for k in range(len(ring))}
        self.before = {n: s for s, n in self.after.items()}

    def continues(self, side: Side) -> bool:
        """Whether the run of `side` has the edge after it, too."""
        follower = self.after[side]
        stitch, following = self.stitch_of.get(side), self.stitch_of.get(follower)
        # One stitch for both is the apex of a dart, whose legs are two runs.
        if stitch is None or following is None or stitch is following:
            return False
        if stitch.same_direction != following.same_direction:
            return False
        step = self.after if stitch.same_direction else self.before
        return self.partners[follower] == step[self.partners[side]]

    def chains(self, ring: list[Side]) -> list[list[Side]]:
        """The runs of one loop, in loop order; a closed run begins at the first edge."""
        starts = [
            k for k, s in enumerate(ring) if s in self.stitch_of and not self.continues(ring[k - 1])
        ]
        if not starts:
            return [ring] if ring[0] in self.stitch_of else []
        chains = []
        for start in starts:
            chain = [ring[start]]
            while self.continues(chain[-1]):
                chain.append(ring[(start + len(chain)) % len(ring)])
            chains.append(chain)
        return chains


def stubs(pattern: Pattern) -> frozenset[Side]:
    """The edges that make up stubs.

    A sewn edge is one only with what it is sewn to, and a loop keeps the edges that bound it.
    """
    short = {
        Side(panel.name, k)
        for panel in pattern.panels
        for k, curve in enumerate(panel.curves)
        if dist(curve.start, curve.end) < STUB_CM and curve.length < STUB_CM
    }
    if not short:
        return frozenset()
    found: set[Side] = set()
    for _, ring in side_loops(pattern):
        own = _short_chains(pattern, ring, short)
        rest = [pattern.curve(side) for side in ring if side not in own]
        if len(rest) >= 3 or (len(rest) == 2 and not all(curve.is_straight for curve in rest)):
            found |= own
    while alone := {side for side in found if pattern.partners.get(side, side) not in found}:
        found -= alone
    return frozenset(found)


def _short_chains(pattern: Pattern, ring: list[Side], short: Container[Side]) -> set[Side]:
    """The edges of a loop in chains of short edges that are short altogether."""

    def kind(side: Side) -> tuple[bool, bool]:
        return side in short, side in pattern.partners

    turn = next((k for k in range(len(ring)) if kind(ring[k]) != kind(ring[k - 1])), 0)
    found: set[Side] = set()
    for (is_short, _), group in groupby((*ring[turn:], *ring[:turn]), key=kind):
        chain = list(group)
        if is_short and sum(pattern.curve(side).length for side in chain) < STUB_CM:
            found.update(chain)
    return found


def side_loops(pattern: Pattern) -> list[tuple[int, list[Side]]]:
    """Every loop of every panel: its number, and its sides in order."""
    return [
        (number, [Side(panel.name, k) for k in edges])
        for panel in pattern.panels
        for number, edges in enumerate(panel.edge_ranges)
    ]
