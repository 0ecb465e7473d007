"""How the panels of a garment are connected, and whether two garments are connected alike.

Words of this file:

- A **seam side** is a run of edges sewn to another run, a **seam** two such sides (merged from
  stitches by `sewn_runs`).
- Of a **gap** between two seam sides only counts whether there is one: how many edges it has and
  how long they are is the business of IoU.
- A **dart** is a seam of a loop with itself whose sides meet at a vertex, the apex.
- Each seam side lies at a **place** of its panel: where its middle is, seen from the panel's
  centroid. The order round a panel cannot tell a rectangle from one turned upside down; this can.

The graph is kept as a combinatorial map: for each seam side the next one round its loop and the
one that it is sewn to. One pair of seam sides that are the same therefore fixes all that hangs
together with them, which is why comparing is quick.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import dist, sqrt

import numpy as np

from garmentimage.compare.matching import MIRRORED, POSES, TURNED
from garmentimage.geometry import (
    Curve,
    Point,
    centroid,
    connected_components,
    signed_area,
    to_point,
)
from garmentimage.pattern import Pattern, SeamRun, sewn_runs

LENGTH_TOL_SHARE = 0.02
"""Stitched lengths agree within this share of the length ..."""

LENGTH_TOL_CM = 0.5
"""... or within this much [cm], whichever is more."""

PLACE_TOL_SHARE = 0.1
"""The middles of seam sides agree within this share of the panel's size (root of its area) ..."""

PLACE_TOL_CM = 2.0
"""... or within this much [cm], whichever is more."""

MAX_SEARCH_STEPS = 500_000  # seam sides visited before the search for a panel assignment gives up


PoseTable = Mapping[tuple[str, str], tuple[int, ...]]
"""For panels (of the first graph, of the second): indices of `POSES` the second may be seen in."""


@dataclass(frozen=True)
class SeamSide(SeamRun):
    """One side of a seam, and what is measured of it."""

    length: float
    """Length along the run [cm]."""
    middle: Point
    """The middle of the run, by arc length, seen from the panel's centroid [cm]."""


@dataclass(frozen=True)
class PanelNode:
    """What the graph knows of a panel."""

    loops: int  # outline and holes
    clockwise: bool  # the outline runs clockwise in panel coordinates
    size: float  # root of the area within the outline [cm]


@dataclass(frozen=True)
class StitchGraph:
    """Panels, and seam sides in order of panel, loop and edge."""

    panels: Mapping[str, PanelNode]
    sides: tuple[SeamSide, ...]

    @cached_property
    def by_panel(self) -> Mapping[str, tuple[int, ...]]:
        """Indices of the seam sides of each panel."""
        found: dict[str, list[int]] = {name: [] for name in self.panels}
        for k, side in enumerate(self.sides):
            found[side.panel].append(k)
        return {name: tuple(ks) for name, ks in found.items()}

    @cached_property
    def seams(self) -> tuple[tuple[int, int], ...]:
        """Each seam once, as the indices of its two sides, the smaller first."""
        return tuple((k, s.partner) for k, s in enumerate(self.sides) if k <= s.partner)

    def is_dart(self, k: int) -> bool:
        """Whether seam side `k` is a leg of a dart."""
        side = self.sides[k]
        if side.same_direction or side.partner == k:
            return False
        other = self.sides[side.partner]
        meets_after = side.next == side.partner and not side.gap_after
        meets_before = other.next == k and not other.gap_after
        return meets_after or meets_before

    @cached_property
    def components(self) -> tuple[tuple[int, ...], ...]:
        """Seam sides that are connected, largest set first."""
        joined = [(k, n) for k, s in enumerate(self.sides) for n in (s.next, s.partner)]
        found = map(tuple, connected_components(len(self.sides), joined))
        return tuple(sorted(found, key=lambda c: (-len(c), c)))


@dataclass(frozen=True)
class GraphMatch:
    """How one stitch graph lies on another: panel by panel, seam side by seam side."""

    panels: Mapping[str, str]
    sides: Mapping[int, int]
    poses: Mapping[str, tuple[int, ...]]
    """For each panel the `POSES` that bring its seam sides to their places."""


def lengths_agree(a: float, b: float) -> bool:
    """Whether two stitched lengths [cm] count as the same; `a` is the one that should be."""
    return abs(a - b) <= max(LENGTH_TOL_CM, LENGTH_TOL_SHARE * a)


def places_agree(a: Point, b: Point, size: float) -> bool:
    """Whether two places on a panel of the given size count as the same [cm]."""
    return dist(a, b) <= max(PLACE_TOL_CM, PLACE_TOL_SHARE * size)


def stitch_graph(pattern: Pattern) -> StitchGraph:
    """The stitch graph of a pattern.

    The pattern's stitches must name existing edges, each at most once (see `pattern_faults`).
    """
    outlines = {p.name: p.outline.fine_polygon for p in pattern.panels}
    centres = {name: centroid(outline) for name, outline in outlines.items()}
    sides = []
    for run in sewn_runs(pattern):
        curves = [pattern.curve(side) for side in run.sides]
        length = sum(curve.length for curve in curves)
        sides.append(
            SeamSide(**vars(run), length=length, middle=_middle(curves, centres[run.panel]))
        )
    areas = {name: signed_area(outline) for name, outline in outlines.items()}
    nodes = {
        p.name: PanelNode(len(p.loops), areas[p.name] < 0, sqrt(abs(areas[p.name])))
        for p in pattern.panels
    }
    return StitchGraph(nodes, tuple(sides))


def _middle(curves: Sequence[Curve], centre: np.ndarray) -> Point:
    """The point halfway along a run of curves, seen from `centre` [cm]."""
    if len(curves) == 1 and curves[0].is_straight:
        (x0, y0), (x1, y1) = curves[0].start, curves[0].end
        return float((x0 + x1) / 2 - centre[0]), float((y0 + y1) / 2 - centre[1])
    left = sum(curve.length for curve in curves) / 2
    for curve in curves[:-1]:
        if left <= curve.length:
            break
        left -= curve.length
    else:
        curve = curves[-1]
    share = min(left / curve.length, 1.0) if curve.length > 0 else 0.0
    return to_point(curve.at(np.array([curve.parameter(share)]))[0] - centre)


def match_graphs(
    a: StitchGraph,
    b: StitchGraph,
    candidates: Mapping[str, Sequence[str]],
    *,
    poses: PoseTable | None = None,
    check_lengths: bool = True,
    check_places: bool = True,
) -> GraphMatch | None:
    """Lay one stitch graph on another, each panel on one of its candidates.

    Args:
        a: the graph that should be.
        b: the graph that is.
        candidates: for each panel of `a` the panels of `b` that it may be, the best first.
        poses: how panels may lie in their own coordinates; default: as they are.
        check_lengths: demand that stitched lengths agree (`lengths_agree`).
        check_places: demand that seams lie at the same places of a panel (`places_agree`).

    Returns:
        The first way found in the order of `candidates`, or None where there is none (or none
        within `MAX_SEARCH_STEPS`).
    """
    if len(a.sides) != len(b.sides) or len(a.panels) != len(b.panels):
        return None
    fitting = {
        p: {
            q: _poses(a, p, b, q, poses)
            for q in candidates.get(p, ())
            if _same_counts(a, p, b, q) and (not check_places or _poses(a, p, b, q, poses))
        }
        for p in a.panels
    }
    loose = _match_loose(a, b, fitting)
    if loose is None:
        return None
    laying = _Laying(a, b, fitting, check_lengths, check_places)
    # Depth-first: choices[k] runs through the ways to lay component k - 1 on top of those before.
    choices = [iter([GraphMatch({}, {}, {})])]
    while choices:
        match = next(choices[-1], None)
        if match is None:
            choices.pop()
        elif len(choices) > len(a.components):
            return replace(match, panels={**match.panels, **loose})
        else:
            choices.append(laying.ways(a.components[len(choices) - 1], match))
    return None


def _same_counts(a: StitchGraph, p: str, b: StitchGraph, q: str) -> bool:
    return a.panels[p].loops == b.panels[q].loops and len(a.by_panel[p]) == len(b.by_panel[q])


def _poses(
    a: StitchGraph, p: str, b: StitchGraph, q: str, poses: PoseTable | None
) -> tuple[int, ...]:
    """The poses that keep the outer face outside: mirrored where the outlines run differently."""
    allowed = TURNED[:1] if poses is None else poses.get((p, q), ())
    kept = MIRRORED if a.panels[p].clockwise != b.panels[q].clockwise else TURNED
    return tuple(k for k in allowed if k in kept)


def _match_loose(
    a: StitchGraph, b: StitchGraph, candidates: Mapping[str, Iterable[str]]
) -> dict[str, str] | None:
    """A counterpart for every panel that nothing is sewn to, the best candidates preferred."""
    from scipy.optimize import linear_sum_assignment

    loose_a = [p for p in a.panels if not a.by_panel[p]]
    loose_b = [q for q in b.panels if not b.by_panel[q]]
    if len(loose_a) != len(loose_b):
        return None
    forbidden = float(len(loose_b) ** 2 + 1)
    column = {q: k for k, q in enumerate(loose_b)}
    cost = np.full((len(loose_a), len(loose_b)), forbidden)
    for i, p in enumerate(loose_a):
        for rank, q in enumerate(candidates[p]):
            cost[i, column[q]] = rank
    rows, columns = linear_sum_assignment(cost)
    if len(rows) and cost[rows, columns].max() >= forbidden:
        return None
    return {loose_a[i]: loose_b[j] for i, j in zip(rows, columns, strict=True)}


# A backtracking search, as for isomorphisms of graphs, but with next to no choices: one seam side
# laid on another fixes all of its component, by `next` and `partner` (see the top of this file).
@dataclass
class _Laying:
    """Lays components of one graph on another, counting its steps."""

    a: StitchGraph
    b: StitchGraph
    candidates: Mapping[str, Mapping[str, tuple[int, ...]]]
    check_lengths: bool
    check_places: bool
    steps: int = 0

    def ways(self, component: tuple[int, ...], so_far: GraphMatch) -> Iterator[GraphMatch]:
        """Every way to lay one component, given how others lie."""
        a, b = self.a, self.b
        root = min(component, key=lambda k: (len(self.candidates[a.sides[k].panel]), k))
        for q in self.candidates[a.sides[root].panel]:
            # The seam side of the most similar length is the likeliest one.
            by_length = sorted(
                b.by_panel[q], key=lambda k: abs(b.sides[k].length - a.sides[root].length)
            )
            for image in by_length:
                way = self._lay(root, image, so_far)
                if way is not None:
                    yield way

    def _lay(self, root: int, image: int, so_far: GraphMatch) -> GraphMatch | None:
        """Follow `next` and `partner` from one pair of seam sides; None where they disagree."""
        panels, sides, poses = dict(so_far.panels), dict(so_far.sides), dict(so_far.poses)
        taken_panels, taken_sides = set(panels.values()), set(sides.values())
        waiting = [(root, image)]
        while waiting:
            k, m = waiting.pop()
            if k in sides or m in taken_sides:
                if sides.get(k) != m:
                    return None
                continue
            self.steps += 1
            if self.steps > MAX_SEARCH_STEPS:
                return None
            x, y = self.a.sides[k], self.b.sides[m]
            if not self._alike(x, y):
                return None
            if x.panel in panels or y.panel in taken_panels:
                if panels.get(x.panel) != y.panel:
                    return None
            elif y.panel not in self.candidates[x.panel]:
                return None
            if self.check_places:
                known = poses.get(x.panel, self.candidates[x.panel][y.panel])
                poses[x.panel] = self._fitting_poses(x, y, known)
                if not poses[x.panel]:
                    return None
            panels[x.panel] = y.panel
            taken_panels.add(y.panel)
            sides[k] = m
            taken_sides.add(m)
            waiting += [(x.next, y.next), (x.partner, y.partner)]
        return GraphMatch(panels, sides, poses)

    def _fitting_poses(self, x: SeamSide, y: SeamSide, known: tuple[int, ...]) -> tuple[int, ...]:
        """The poses of a panel that bring `y` to the place of `x`; a closed run has no middle."""
        if x.closed:
            return known
        size = self.a.panels[x.panel].size
        return tuple(
            k for k in known if places_agree(x.middle, to_point(POSES[k] @ y.middle), size)
        )

    def _alike(self, x: SeamSide, y: SeamSide) -> bool:
        return (
            (x.closed, x.gap_after, x.same_direction, x.loop > 0)
            == (y.closed, y.gap_after, y.same_direction, y.loop > 0)
        ) and (not self.check_lengths or lengths_agree(x.length, y.length))


def same_stitch_graph(
    a: StitchGraph,
    b: StitchGraph,
    panel_map: Mapping[str, str],
    *,
    poses: PoseTable | None = None,
) -> list[str]:
    """Why two stitch graphs differ under a given assignment of panels; empty where they agree.

    `panel_map` has the panels of `a`, the graph that should be, whose names the reasons use, with
    those of `b`; `poses` are as in `match_graphs`.
    """
    lonely = [f"panel {p!r} has no counterpart" for p in a.panels if p not in panel_map]
    found = set(panel_map.values())
    lonely += [f"panel {q!r} is extra" for q in b.panels if q not in found]
    if lonely:
        return lonely
    fixed = {p: (q,) for p, q in panel_map.items()}
    if match_graphs(a, b, fixed, poses=poses) is not None:
        return []
    placed = match_graphs(a, b, fixed, poses=poses, check_lengths=False)
    if placed is not None:
        return _length_reasons(a, b, placed)
    if match_graphs(a, b, fixed, poses=poses, check_lengths=False, check_places=False):
        return _place_reasons(a, b, panel_map, poses)
    return _topology_reasons(a, b, panel_map)


def _length_reasons(a: StitchGraph, b: StitchGraph, match: GraphMatch) -> list[str]:
    reasons = []
    for k, m in sorted(match.sides.items()):
        x, y = a.sides[k], b.sides[m]
        if not lengths_agree(x.length, y.length):
            reasons.append(
                f"panel {x.panel!r}, edges {list(x.edges)}: sewn over {y.length:.2f} cm "
                f"instead of {x.length:.2f} cm"
            )
    return reasons


def _place_reasons(
    a: StitchGraph, b: StitchGraph, panel_map: Mapping[str, str], poses: PoseTable | None
) -> list[str]:
    inside_out = [
        f"panel {p!r} is inside out" for p, q in panel_map.items() if not _poses(a, p, b, q, poses)
    ]
    return inside_out or ["seams lie at other places of their panels"]


def _topology_reasons(a: StitchGraph, b: StitchGraph, panel_map: Mapping[str, str]) -> list[str]:
    """What differs, from the coarse to the fine: loops, seams between panels, order round them."""
    reasons = [
        f"panel {p!r} has {b.panels[q].loops} loops instead of {a.panels[p].loops}"
        for p, q in panel_map.items()
        if a.panels[p].loops != b.panels[q].loops
    ]
    wanted = Counter(_seam_kind(a, seam, {p: p for p in a.panels}) for seam in a.seams)
    back = {q: p for p, q in panel_map.items()}
    given = Counter(_seam_kind(b, seam, back) for seam in b.seams)
    for kind in sorted(wanted.keys() | given.keys()):
        if wanted[kind] != given[kind]:
            (one, other), word = kind
            reasons.append(
                f"{given[kind]} {word} between {one!r} and {other!r} instead of {wanted[kind]}"
            )
    if reasons:
        return reasons
    for p, q in panel_map.items():
        if _cycles(a, p, {n: n for n in a.panels}) != _cycles(b, q, back):
            reasons.append(f"panel {p!r}: seams and gaps follow each other in another order")
    return reasons or ["seams between the same panels are interchanged"]


def _seam_kind(
    graph: StitchGraph, seam: tuple[int, int], names: Mapping[str, str]
) -> tuple[tuple[str, ...], str]:
    """Which panels a seam joins, and how."""
    first, second = (graph.sides[k] for k in seam)
    word = "darts" if graph.is_dart(seam[0]) else "seams"
    if first.closed:
        word = "closed " + word
    if first.same_direction:
        word += " (start to start)"
    return tuple(sorted((names[first.panel], names[second.panel]))), word


_Letter = tuple[str, bool, bool, bool, bool]
"""Of a seam side: the panel it is sewn to, whether a dart is, start meets start, it is closed, and
a gap follows."""


def _cycles(graph: StitchGraph, panel: str, names: Mapping[str, str]) -> list[list[_Letter]]:
    """What follows what round each loop of a panel, the same for every start of the loop."""
    letters = {
        k: (
            names[graph.sides[side.partner].panel],
            graph.is_dart(k),
            side.same_direction,
            side.closed,
            side.gap_after,
        )
        for k, side in ((k, graph.sides[k]) for k in graph.by_panel[panel])
    }
    cycles, seen = [], set[int]()
    for start in letters:
        if start in seen:
            continue
        cycle = [start]
        while graph.sides[cycle[-1]].next != start:
            cycle.append(graph.sides[cycle[-1]].next)
        seen.update(cycle)
        word = [letters[k] for k in cycle]
        cycles.append(min(word[k:] + word[:k] for k in range(len(word))))
    return sorted(cycles)


def seam_agreement(a: StitchGraph, b: StitchGraph, panel_map: Mapping[str, str]) -> float:
    """Share of the seams of `a` that `b` has too: same panels, manner and lengths; 1 if none.

    A measure for patterns that are not the same: the order round the panels does not count.
    """
    back = {q: p for p, q in panel_map.items()}
    left: dict[tuple[object, ...], list[tuple[int, int]]] = {}
    for seam in b.seams:
        if all(b.sides[k].panel in back for k in seam):
            left.setdefault(_seam_kind(b, seam, back), []).append(seam)
    names = {p: p for p in a.panels}
    agreeing = 0
    for seam in a.seams:
        rivals = left.get(_seam_kind(a, seam, names), [])
        match = next((r for r in rivals if _seams_agree(a, seam, b, r, back)), None)
        if match is not None:
            rivals.remove(match)
            agreeing += 1
    return agreeing / len(a.seams) if a.seams else 1.0


def _seams_agree(
    a: StitchGraph,
    seam: tuple[int, int],
    b: StitchGraph,
    rival: tuple[int, int],
    back: Mapping[str, str],
) -> bool:
    """Whether the sides of two seams agree in panel and length, in this order or the other."""
    return any(
        all(
            a.sides[k].panel == back[b.sides[m].panel]
            and lengths_agree(a.sides[k].length, b.sides[m].length)
            for k, m in zip(seam, order, strict=True)
        )
        for order in (rival, rival[::-1])
    )
