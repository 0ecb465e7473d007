"""Continuous layout: the seam complex drawn in the picture plane, every seam one curve.

A cascade of drawings, from the plainest to the freest; nearly every garment is clean at the
first. Each step is a fixed computation: no search, no randomness, and no choice by file order.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float

from garmentimage.geometry.polygons import signed_area
from garmentimage.raster.complex import SeamComplex
from garmentimage.raster.gaps import clearance_rows, facing_rows
from garmentimage.raster.relax import (
    Constrained,
    Energy,
    Rows,
    Samples,
    energy,
    gather,
    sample,
    stiffness_of,
    turned_load,
)

GAP = 3.0
"""Width of a fully opened gap [cm]."""
WIDE_GAPS = (("tangent", 9.0), ("chord", 9.0), ("tangent", 15.0))

OVERLAP_TOL = 12.0
"""Panels may overlap by this area [cm²]: routing sorts out slivers."""

TURNS = 60
"""Most as-rigid-as-possible rounds."""
CLEARANCE_ROUNDS = 4
"""Most rounds of keeping panels apart that share no node."""
SETTLED = 0.02
"""Movement at which such rounds end [cm]."""


@dataclass(frozen=True)
class Layout:
    """The seam complex drawn in the picture plane."""

    complex: SeamComplex
    curves: tuple[np.ndarray, ...]
    """Per arc [K + 2, 2]: body cm, from node a to node b; end points are exactly shared."""
    stage: str
    """Which step of the cascade drew it."""
    problems: tuple[str, ...]
    """Folds and overlaps that are left, naming panels; empty when clean."""


@dataclass(frozen=True)
class _Step:
    """One step of the cascade."""

    stage: str
    chord: bool = False
    gap: float = GAP
    turning: bool = False
    membranes: frozenset[int] = frozenset()


def layouts(complex: SeamComplex) -> Iterator[Layout]:
    """Layouts of a garment, computed as they are asked for.

    First those without fold or overlap, in the order of the cascade: rigid; with gaps judged by
    chords; with wider gaps; as rigid as possible; with split halves, then with the panels at
    fault, as membranes. Then the others, those with the fewest problems first.
    """
    desk = _Desk.of(complex)
    faulty = []
    for step in _cascade(desk, faulty):
        layout, at_fault = desk.draw(step)
        if layout.problems:
            faulty.append((layout, at_fault))
        else:
            yield layout
    yield from sorted((layout for layout, _ in faulty), key=lambda one: len(one.problems))


def _cascade(desk: "_Desk", faulty: list[tuple[Layout, set[int]]]) -> Iterator[_Step]:
    yield _Step("rigid")
    at_fault = faulty[0][1] if faulty else set()
    yield _Step("chord", chord=True)
    for kind, gap in WIDE_GAPS:
        yield _Step(f"{kind} gap {gap:g}", chord=kind == "chord", gap=gap)
    yield _Step("turning", turning=True)
    yield _Step("chord turning", turning=True, chord=True)
    panels = desk.complex.placed.panels
    halves = {i for i, p in enumerate(panels) if p.half}
    if halves & at_fault:
        yield _Step("front membranes", membranes=frozenset(i for i in halves if not panels[i].layer))
        yield _Step("half membranes", membranes=frozenset(halves))
    if at_fault:
        yield _Step("membranes", membranes=frozenset(at_fault))


@dataclass(frozen=True)
class _Desk:
    """What all drawings of one garment share."""

    complex: SeamComplex
    samples: Samples
    stiffness: Float[np.ndarray, " p"]

    @classmethod
    def of(cls, complex: SeamComplex) -> "_Desk":
        return cls(complex, sample(complex), stiffness_of(complex.placed))

    def draw(self, step: _Step) -> tuple[Layout, set[int]]:
        """A layout, and the panels at fault in it."""
        shifts = gather(self.complex.placed, self.stiffness, step.membranes)
        rest = self.samples.rest + np.repeat(shifts, np.diff(self.samples.start), axis=0)
        base = energy(self.complex, self.samples, rest, self.stiffness, step.membranes)
        facing = facing_rows(self.complex, self.samples, step.gap, step.chord)
        soft = np.array([i in step.membranes for i in range(len(self.stiffness))])
        turned = partial(
            turned_load,
            ids=self.samples.ids,
            following=self.samples.following,
            start=self.samples.start,
            rest=rest,
            stiffness=self.stiffness,
            soft=soft,
        )
        turn = turned if step.turning else None
        points = _settle(base, facing, turn)
        for _ in range(CLEARANCE_ROUNDS):
            near = clearance_rows(self.complex, self.samples, points)
            if not len(near.base):
                break
            before, points = points, _settle(base, Rows.joined([facing, near]), turn)
            if np.abs(points - before).max() < SETTLED:
                break
        curves = tuple(points[chain] for chain in self.samples.arcs)
        problems, at_fault = find_problems(self.complex, curves)
        return Layout(self.complex, curves, step.stage, problems), at_fault


def _settle(
    base: Energy, rows: Rows, turned: Callable[[np.ndarray], np.ndarray] | None
) -> Float[np.ndarray, "n 2"]:
    """Positions of least energy; with `turned`, rest shapes turn until nothing moves."""
    system = Constrained.of(base, rows)
    points = system.minimum(base.load)
    for _ in range(TURNS if turned else 0):
        before, points = points, system.minimum(turned(points))  # type: ignore[misc]
        if np.abs(points - before).max() < SETTLED:
            break
    return points


def find_problems(
    complex: SeamComplex, curves: tuple[np.ndarray, ...]
) -> tuple[tuple[str, ...], set[int]]:
    """Folded panels and overlapping pairs on a layer, in words, and the panels at fault.

    Darts are left out of the outlines: their legs coincide.
    """
    import shapely

    panels = complex.placed.panels
    problems, at_fault = [], set()
    shapes = []
    for i, panel in enumerate(panels):
        rings = [_ring(complex, curves, i, loop) for loop in panel.loops]
        shape = shapely.Polygon(rings[0], rings[1:])
        if not shape.is_valid or signed_area(rings[0]) * panel.sign <= 0:
            problems.append(f"panel {panel.name!r} folds over itself")
            at_fault.add(i)
            shape = shape.buffer(0)
        shapes.append(shape)
    near = shapely.STRtree(shapes).query(shapes).T
    pairs = [(i, j) for i, j in near if i < j and panels[i].layer == panels[j].layer]
    for i, j in pairs:
        area = shapes[i].intersection(shapes[j]).area
        if area > OVERLAP_TOL:
            problems.append(
                f"panels {panels[i].name!r} and {panels[j].name!r} overlap by {area:.0f} cm²"
            )
            at_fault |= {i, j}
    return tuple(problems), at_fault


def _ring(
    complex: SeamComplex, curves: tuple[np.ndarray, ...], panel: int, loop: tuple[int, ...]
) -> Float[np.ndarray, "n 2"]:
    parts = []
    for k in loop:
        arc, back = complex.owner[panel, k]
        if not complex.arcs[arc].slit:
            parts.append((curves[arc][::-1] if back else curves[arc])[:-1])
    return np.concatenate(parts)
