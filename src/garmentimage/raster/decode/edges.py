"""Boundary loops cut into edges, each sewn to one edge or to none, and their stitches."""

from collections.abc import Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from garmentimage.geometry import Curve
from garmentimage.pattern import polygon_of
from garmentimage.raster.decode.boundary import NONE, Boundary
from garmentimage.raster.decode.curve_fit import Part, cut_run


class CutEdge(NamedTuple):
    """An edge of a boundary loop."""

    curve: Curve
    run: int  # the half-edge at which its run starts
    halves: list[int]  # the half-edges that it stands for


@dataclass(frozen=True)
class Seams:
    """All loops cut into edges, and which edges are sewn together."""

    loops: list[list[CutEdge]]  # in the order of `Boundary.loops`
    stitches: list[tuple[tuple[int, int], tuple[int, int]]]  # pairs of (loop, edge)
    chords: dict[int, int]  # how many half-edges each run has, by the half-edge at which it starts

    @cached_property
    def polygons(self) -> list[Float[np.ndarray, "_ 2"]]:
        """Each loop as the polygon of its curves [cm]."""
        return [polygon_of([edge.curve for edge in loop]) for loop in self.loops]


def cut_into_edges(boundary: Boundary, loops: Sequence[Sequence[int]], straight: Set[int]) -> Seams:
    """Cut every loop into edges, both sides of a seam at the same grid points.

    The runs that start at the half-edges in `straight` keep their chords.
    """
    runs, order = _runs(boundary, loops)
    parts: dict[int, list[Part]] = {}
    sewn_to: dict[int, int] = {}
    for k, run in runs.items():
        if k in parts:
            continue
        points = np.concatenate([boundary.tail[run], boundary.head[run[-1:]]])
        if boundary.partner[k] == NONE:
            parts[k] = cut_run((points,), chords=k in straight)
            continue
        other = boundary.partner[run]
        partner = int(other[-1])
        facing = np.concatenate([boundary.head[other], boundary.tail[other[-1:]]])
        both = cut_run((points, facing), chords=k in straight or partner in straight)
        parts[k] = both
        last = len(run)
        parts[partner] = [
            Part(last - p.last, last - p.first, (p.curves[1].reversed(),)) for p in reversed(both)
        ]
        sewn_to[k] = partner

    place: dict[int, tuple[int, int]] = {}
    cut: list[list[CutEdge]] = []
    for index, starts in enumerate(order):
        cut.append([])
        for k in starts:
            place[k] = (index, len(cut[-1]))
            cut[-1] += (CutEdge(p.curves[0], k, runs[k][p.first : p.last]) for p in parts[k])
    stitches = []
    for k, partner in sewn_to.items():
        (loop_a, a), (loop_b, b) = place[k], place[partner]
        last = b + len(parts[k]) - 1
        stitches += [((loop_a, a + i), (loop_b, last - i)) for i in range(len(parts[k]))]
    return Seams(cut, stitches, {k: len(run) for k, run in runs.items()})


def _runs(
    boundary: Boundary, loops: Sequence[Sequence[int]]
) -> tuple[dict[int, list[int]], list[list[int]]]:
    """Runs by their first half-edge, and for each loop the first half-edges in order."""
    starts = _run_starts(boundary, loops).tolist()
    runs: dict[int, list[int]] = {}
    order: list[list[int]] = []
    for loop in loops:
        turn = next(i for i, k in enumerate(loop) if starts[k])
        order.append([])
        for k in (*loop[turn:], *loop[:turn]):
            if starts[k]:
                order[-1].append(k)
                runs[k] = []
            runs[order[-1][-1]].append(k)
    return runs, order


def _run_starts(boundary: Boundary, loops: Sequence[Sequence[int]]) -> Bool[np.ndarray, " half"]:
    """Where runs begin; a loop with one fate all round begins where it turns most."""
    starts = boundary.seam_starts
    for loop in loops:
        if starts[loop].any():
            continue
        d = boundary.head[loop] - boundary.tail[loop]
        before = np.roll(d, 1, axis=0)
        cross = before[:, 0] * d[:, 1] - before[:, 1] * d[:, 0]
        k = loop[int(np.argmax(np.abs(np.arctan2(cross, (before * d).sum(axis=1)))))]
        starts[k] = True
        partner = boundary.partner[boundary.preceding[k]]
        if partner != NONE:
            starts[partner] = True
    return starts
