"""Continuous layout: the seam graph drawn in the picture plane, every seam one curve.

A drawing is the least of the energy of `relax`, under the gaps of `constraints`, sampled along the
arcs. That is one linear solve and a small complementarity problem per axis; panels that come near
those they share no node with add constraints, for a fixed number of rounds. The step in which
panels are as rigid as possible repeats it with rest shapes rotated to fit the last solution.

A cascade of drawings, from the plainest to the freest; nearly every garment is clean at the
first. Each step is a fixed computation: no search, no randomness, and no choice by file order.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from garmentimage.errors import EncodeError
from garmentimage.geometry import signed_area
from garmentimage.raster.encode.layout._kernels import rotated_load
from garmentimage.raster.encode.layout.constraints import (
    LinearConstraints,
    clearance_constraints,
    gap_constraints,
)
from garmentimage.raster.encode.layout.relax import Constrained, Energy, energy
from garmentimage.raster.encode.layout.samples import (
    REFINED,
    Resting,
    Samples,
    gather,
    sample,
    stiffness_of,
)
from garmentimage.raster.encode.layout.seam_graph import SeamGraph
from garmentimage.raster.encode.layout.unbend import unbent_curves
from garmentimage.raster.encode.placement import FRONT, PlacedSeam

if TYPE_CHECKING:
    import shapely

GAP = 3.0
"""Width of a fully opened gap [cm]."""
FIRST = "rigid"
"""The step that nearly every garment is clean at."""
LAST_RESORT = "neighbours as membranes"
"""The step whose layout is drawn when those of all others cannot be."""
WIDE_GAPS = (("tangent", 9.0), ("chord", 9.0), ("tangent", 15.0))

MAX_ARCS = 400
"""Edges and seams of a garment; real ones have up to 130."""
FOLD_TOL = 4.0
"""Loops of a panel that crosses itself may have this area [cm²]: no more than routing mends."""
OVERLAP_TOL = 12.0
"""Panels may overlap by this area [cm²]: routing sorts out slivers."""
MAX_RIGID_ROUNDS = 40
"""Rounds of rotating rest shapes in the step that is as rigid as possible."""
CONVERGED = 0.02
"""Movement at which they end [cm]."""
CLEARANCE_ROUNDS = 3
"""Rounds of keeping panels apart that share no node; always as many, so that nothing jumps."""


@dataclass(frozen=True)
class Layout:
    """The seam graph drawn in the picture plane."""

    graph: SeamGraph
    curves: tuple[Float[np.ndarray, "_ 2"], ...]
    """Per arc: body cm, from node a to node b; end points are exactly shared."""
    stage: str
    """Which step of the cascade drew it."""
    problems: tuple[str, ...]
    """Folds and overlaps that are left, naming panels; empty when clean."""


@dataclass(frozen=True)
class _Step:
    """One step of the cascade."""

    stage: str
    chord: bool = False
    """Gaps are judged by chords."""
    gap: float = GAP
    """[cm]"""
    as_rigid: bool = False
    """Rest shapes may rotate: as rigid as possible."""
    firm: bool = False
    """Short arcs keep their direction."""
    membranes: frozenset[int] = frozenset()
    """Panels that forget their shape."""


def layouts(graph: SeamGraph, is_placed: Callable[[], bool] = lambda: True) -> Iterator[Layout]:
    """Layouts of a garment, computed one by one.

    First those without fold or overlap, in the order of the cascade; then the others, those with
    the fewest problems first.

    Args:
        graph: the garment.
        is_placed: whether its panels stand round a body; asked after the first step. Without, as
            where they lie flat side by side, the freer steps are left out, which would take long.

    Raises:
        EncodeError: more edges than any grid has room for.
    """
    if len(graph.arcs) > MAX_ARCS:
        panel = max(graph.placed.panels, key=lambda p: (len(p.curves), p.source))
        raise EncodeError(
            f"the pattern has {len(graph.arcs)} edges and seams, {len(panel.curves)} of them "
            f"round panel {panel.source[:80]!r}; an image has room for {MAX_ARCS}: smooth "
            "outlines that turn at every vertex, or leave loose panels out",
            remedy="pattern",
        )
    # Layouts with problems are kept back: a later step may be clean.
    solver = _LayoutSolver(graph)
    faulty: list[Layout] = []
    at_fault: set[int] = set()
    for number, step in enumerate(_cascade(graph, at_fault)):
        if number == 1 and not is_placed():
            break
        layout, found = solver.draw(step)
        at_fault |= found if step.stage == FIRST else set()
        if layout.problems:
            faulty.append(layout)
        else:
            yield layout
    yield from sorted(faulty, key=lambda one: len(one.problems))


def _cascade(graph: SeamGraph, at_fault: set[int]) -> Iterator[_Step]:
    """Steps in order; `at_fault` is read once the first step is drawn."""
    yield _Step(FIRST)
    # Short arcs that were reversed, then gaps that were judged wrongly or are too narrow, ...
    yield _Step("firm", firm=True)
    yield _Step("chord", chord=True)
    for kind, gap in WIDE_GAPS:
        yield _Step(f"{kind} gap {gap:g}", chord=kind == "chord", gap=gap)
    # ... then panels that must rotate to lie beside each other, ...
    yield _Step("as rigid as possible", as_rigid=True)
    yield _Step("as rigid as possible, chord", as_rigid=True, chord=True)
    panels = graph.placed.panels
    # ... and at last panels that cannot keep their shape.
    split = {i for i, p in enumerate(panels) if p.is_part}
    front = {i for i in split if panels[i].layer % 2 == FRONT}
    for stage, soft in (("front", front), ("split", split), ("faulty", at_fault)):
        if soft & at_fault:
            yield _Step(f"{stage} membranes", membranes=frozenset(soft))
    # Those beside them give way, too.
    near = {
        i for seam in graph.placed.seams for i, _ in (seam.a, seam.b) if _touches(seam, at_fault)
    }
    if near - at_fault:
        yield _Step(LAST_RESORT, membranes=frozenset(near | at_fault))


def _touches(seam: PlacedSeam, panels: set[int]) -> bool:
    return bool({seam.a[0], seam.b[0]} & panels)


class _LayoutSolver:
    """Draws one garment; what all its layouts share is computed once."""

    def __init__(self, graph: SeamGraph) -> None:
        self.graph = graph
        self.resting: Resting = tuple(unbent_curves(panel) for panel in graph.placed.panels)
        self.samples = sample(graph, self.resting)
        self.stiffness = stiffness_of(graph.placed)
        self.ground = self._prepared(_Step(FIRST))

    def _prepared(self, step: _Step) -> tuple[Float[np.ndarray, "r 2"], Energy]:
        """Rest positions with the panels brought together, and the energy."""
        shifts = gather(self.graph.placed, self.resting, self.stiffness, step.membranes)
        rest = self.samples.rest + np.repeat(shifts, np.diff(self.samples.start), axis=0)
        return rest, energy(
            self.graph, self.samples, rest, self.stiffness, step.membranes, step.firm
        )

    def draw(self, step: _Step) -> tuple[Layout, set[int]]:
        """A layout, and the panels at fault in it."""
        samples = self.samples
        rest, base = self._prepared(step) if step.membranes or step.firm else self.ground
        # Facing boundaries are known beforehand; what else comes near only shows in a drawing.
        facing = gap_constraints(self.graph, samples, step.gap, step.chord)
        system = Constrained.of(base, facing)
        points = system.minimum(base.load)
        for _ in range(CLEARANCE_ROUNDS):
            near = clearance_constraints(self.graph, samples, points)
            if not len(near.base):
                break
            system = Constrained.of(base, LinearConstraints.joined([facing, near]))
            points = system.minimum(base.load)
        # Alternating minimisation: rotations for these points, points for these rotations.
        for _ in range(MAX_RIGID_ROUNDS if step.as_rigid else 0):
            before = points
            load = rotated_load(
                points, samples.ids, samples.following, samples.start, rest, self.stiffness
            )
            points = system.minimum(load)
            if np.abs(points - before).max() < CONVERGED:
                break
        curves = _refined(self.graph, samples, rest, points)
        problems, at_fault = find_problems(self.graph, curves)
        return Layout(self.graph, curves, step.stage, problems), at_fault


def _refined(
    graph: SeamGraph,
    samples: Samples,
    rest: Float[np.ndarray, "r 2"],
    points: Float[np.ndarray, "n 2"],
) -> tuple[Float[np.ndarray, "_ 2"], ...]:
    """The arcs through all samples, with the curvature of their edges between them.

    Each side's edge is carried along with its samples; an arc is the mean of its two sides.
    """
    places = np.arange(samples.edges.shape[1]) / REFINED
    curves = [np.zeros((len(places), 2)) for _ in graph.arcs]
    edges = iter(samples.edges)
    for i, panel in enumerate(graph.placed.panels):
        first = samples.start[i]
        shift = rest[first] - samples.rest[first]
        for k in (k for loop in panel.loops for k in loop):
            arc, back = graph.owner[i, k]
            own = next(edges) + shift
            # The curve as it is, moved so that it passes through the samples.
            own = own[::-1].copy() if back else own
            moved = points[samples.arcs[arc]] - own[::REFINED]
            for axis in (0, 1):
                own[:, axis] += np.interp(places, places[::REFINED], moved[:, axis])
            curves[arc] += own / len(graph.arcs[arc].sides)
    for curve, chain in zip(curves, samples.arcs, strict=True):
        curve[::REFINED] = points[chain]
    return tuple(curves)


def find_problems(
    graph: SeamGraph, curves: tuple[Float[np.ndarray, "_ 2"], ...]
) -> tuple[tuple[str, ...], set[int]]:
    """Folded panels and overlapping pairs on a layer, in words, and the panels at fault.

    Darts are left out of the outlines: their legs coincide.
    """
    import shapely

    panels = graph.placed.panels
    problems, at_fault = [], set()
    shapes = []
    for i, panel in enumerate(panels):
        # A hole sewn up by itself, a fish-eye dart, leaves nothing out.
        drawn = [[k for k in loop if not graph.arc(i, k).slit] for loop in panel.loops]
        rings = [
            np.concatenate([graph.along(curves, i, k)[:-1] for k in loop]) for loop in drawn if loop
        ]
        shape, folded = _largest_part(shapely.Polygon(rings[0], rings[1:]))
        if folded > FOLD_TOL or signed_area(rings[0]) * panel.sign <= 0:
            problems.append(f"panel {panel.name!r} folds over itself")
            at_fault.add(i)
        shapes.append(shape)
    near = shapely.STRtree(shapes).query(shapes).T.tolist()
    pairs = [(i, j) for i, j in near if i < j and panels[i].layer == panels[j].layer]
    for i, j in pairs:
        area = shapes[i].intersection(shapes[j]).area
        if area > OVERLAP_TOL:
            problems.append(
                f"panels {panels[i].name!r} and {panels[j].name!r} overlap by {area:.0f} cm²"
            )
            at_fault |= {i, j}
    return tuple(problems), at_fault


def _largest_part(shape: "shapely.Polygon") -> tuple["shapely.Geometry", float]:
    """A polygon without the small loops that it makes where it crosses itself, and their area."""
    import shapely

    if shape.is_valid:
        return shape, 0.0
    # Far quicker on tangles than make_valid, which can take minutes.
    try:
        faces = shapely.get_parts(shapely.polygonize([shapely.node(shape.exterior)]))
    except shapely.GEOSException:  # on some tangles its search for crossings does not converge
        return shapely.Polygon(), np.inf
    if not len(faces):
        return shapely.Polygon(), np.inf
    areas = shapely.area(faces)
    whole = faces[int(np.argmax(areas))]
    for hole in shape.interiors:
        whole = whole.difference(shapely.Polygon(hole).buffer(0))
    return whole, float(areas.sum() - areas.max())
