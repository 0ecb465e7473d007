"""Runs of grid edges as lines and curves that do not cross; parts of split panels joined."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int

from garmentimage.compare import loop_polygon
from garmentimage.geometry import signed_area, touching_sides
from garmentimage.pattern import chord_count, loop_from_curves
from garmentimage.raster.decode.boundary import NONE, Boundary, Cluster, join_parts
from garmentimage.raster.decode.divisions import with_divisions
from garmentimage.raster.decode.edges import Seams, cut_into_edges
from garmentimage.raster.decode.outlines import Polygons, is_outline, until_simple
from garmentimage.raster.image import GarmentImage

MAX_STRAIGHTEN_ROUNDS = 4
"""How often runs that cross are made straight one by one; then all runs of their panels are."""


@dataclass(frozen=True)
class FittedPanels:
    """Panels whose edges are curves."""

    boundary: Boundary  # half-edges after joining
    whole: Int[np.ndarray, " cluster"]
    """For each cluster the one that it was joined to; itself where none."""
    seams: Seams
    members: dict[int, list[int]]
    """Loops of each panel, by its cluster; the outline first, then holes by their size."""

    @property
    def outlines(self) -> Mapping[int, Polygons]:
        """Polygons by cluster."""
        return {k: [self.seams.polygons[i] for i in own] for k, own in self.members.items()}

    def divided(self, image: GarmentImage, clusters: Sequence[Cluster]) -> "FittedPanels":
        """With the vertices that marks keep; unchanged where an outline would cross itself then."""
        seams = with_divisions(self.seams, self.boundary, image, clusters)
        if seams is self.seams:
            return self
        found = replace(self, seams=seams)
        return found if all(map(is_outline, found.outlines.values())) else self


def fit_edges(boundary: Boundary, clusters: Sequence[Cluster]) -> FittedPanels:
    """Join the parts of split panels and refit all edges such that no outline crosses itself.

    Where curves cross, their runs keep the straight chords of the polyline. Chords of one cluster
    never cross, so what crosses when all are straight was joined wrongly: it is taken apart again.

    Args:
        boundary: of the clusters, in the frames of the panels.
        clusters: as unfolded.
    """
    straight: set[int] = set()
    part_of = [None if c.mark is None else c.mark.split_of for c in clusters]

    apart: set[int] = set()

    def build() -> FittedPanels:
        joined, whole = join_parts(boundary, part_of, apart)
        loops = joined.loops
        seams = cut_into_edges(joined, loops, straight)
        members: dict[int, list[int]] = {}
        for index, loop in enumerate(loops):
            members.setdefault(int(whole[joined.cluster[loop[0]]]), []).append(index)
        for own in members.values():
            own.sort(key=lambda i: -abs(signed_area(seams.polygons[i])))
        return FittedPanels(joined, whole, seams, members)

    def relax(panels: FittedPanels, faulty: list[int], turn: int) -> None:
        for k in faulty:
            runs = _runs_to_straighten(panels, k, every=turn > MAX_STRAIGHTEN_ROUNDS)
            nothing_left_to_straighten = runs <= straight
            if nothing_left_to_straighten:
                apart.update(np.flatnonzero(panels.whole == k).tolist())
            straight.update(runs)

    found = until_simple(build, relax)
    # What networks give can bend so sharply that the polygons above miss a crossing.
    while any(cluster.mark is None for cluster in clusters):
        faulty = [k for k in found.members if not _is_finely_simple(found, k)]
        runs = {run for k in faulty for run in _runs_to_straighten(found, k, every=True)}
        if runs <= straight:
            break
        straight.update(runs)
        found = until_simple(build, relax)
    return found


def _is_finely_simple(panels: FittedPanels, k: int) -> bool:
    """Whether the loops of a panel are simple as they are judged, with many chords to a curve."""
    import shapely

    loops = [[edge.curve for edge in panels.seams.loops[i]] for i in panels.members[k]]
    if all(curve.is_straight for loop in loops for curve in loop):
        return True
    rings = [loop_polygon(loop_from_curves(loop)) for loop in loops]
    alone = all(shapely.Polygon(ring).is_valid for ring in rings)
    return alone and bool(shapely.Polygon(rings[0], rings[1:]).is_valid)


def _runs_to_straighten(panels: FittedPanels, k: int, *, every: bool) -> set[int]:
    """Runs of panel `k`: all, or of every two that cross the curved one with fewer points."""
    loops = [panels.seams.loops[i] for i in panels.members[k]]
    if every:
        return {edge.run for loop in loops for edge in loop}
    # For each side of the polygons its run; `NONE` where the edge is straight.
    run_of = [
        NONE if edge.curve.is_straight else edge.run
        for loop in loops
        for edge in loop
        for _ in range(chord_count(edge.curve))
    ]
    chords = panels.seams.chords
    runs = set()
    for pair in touching_sides(panels.outlines[k]).tolist():
        curved = [run_of[i] for i in pair if run_of[i] != NONE]
        if curved:
            runs.add(min(curved, key=lambda run: (chords[run], run)))
    return runs
