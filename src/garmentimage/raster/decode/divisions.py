"""Divisions: the vertices of a dense outline, kept in the marks and put back when decoding.

The raster draws the edges of a traced outline as a few long ones (see `joints`). A **division** is
a vertex inside such an edge. The mark of its panel says on which grid edge it lies and where along
it, so it finds its place on whatever curve is decoded there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from garmentimage.geometry import Curve, Line, lengths_along
from garmentimage.raster.cells import half_edges
from garmentimage.raster.decode.boundary import Boundary, Cluster
from garmentimage.raster.decode.edges import CutEdge, Seams
from garmentimage.raster.image import Division, GarmentImage

FOUND_CM = 1e-6  # a vertex lies on an edge that comes this near
DECIMALS = 6  # of the share of a grid edge
STRAIGHT_CM = 0.02
"""A part this near to its chord is a straight edge, as those of traced outlines are."""
SNAP_CM = 0.5
"""Where a run was cut in two curves, the nearest vertex within this distance is the cut."""
END_CM = 1e-3  # a vertex this near to the end of an edge is that end


def shares_along(
    curve: Float[np.ndarray, "n 2"], vertices: Float[np.ndarray, "m 2"]
) -> list[float]:
    """Shares of the length of a polyline at which `vertices` lie on it before its end, in order."""
    from scipy.spatial import cKDTree

    distance, at = cKDTree(curve).query(vertices)
    at = np.unique(at[(distance < FOUND_CM) & (at < len(curve) - 1)])
    lengths = lengths_along(curve)
    return list(map(float, lengths[at] / lengths[-1]))


def divisions_on(
    path: Int[np.ndarray, "n 2"], cells: Int[np.ndarray, "k 2"], shares: Sequence[float]
) -> list[Division]:
    """Divisions of an edge drawn as a lattice path.

    Args:
        path: lattice points (x, y) in the edge's direction.
        cells: (column, row) of the cell on the cloth side of each step.
        shares: where the vertices lie along the edge, increasing.
    """
    found: dict[tuple[int, int, int], list[float]] = {}
    count = len(path) - 1
    for share in shares:
        k = min(int(share * count), count - 1)
        (x, y), (u, v), (col, row) = path[k].tolist(), path[k + 1].tolist(), cells[k].tolist()
        side = (0 if y == row else 2) if y == v else (3 if x == col else 1)
        along = share * count - k
        along = round(along if u + v > x + y else 1 - along, DECIMALS)
        found.setdefault((row, col, side), []).append(along)
    return [(*place, tuple(sorted(along))) for place, along in found.items()]


def with_divisions(
    seams: Seams, boundary: Boundary, image: GarmentImage, clusters: Sequence[Cluster]
) -> Seams:
    """Edges divided at the vertices that the marks keep; both sides of a seam into as many parts.

    The clusters are in the order in which `trace_boundary` had them.
    """
    if not any(cluster.mark and cluster.mark.divisions for cluster in clusters):
        return seams
    along = _along_half_edges(image, clusters)
    lengths = np.hypot(*(boundary.head - boundary.tail).T)
    cuts = [_cuts(loop, along, lengths) for loop in seams.loops]
    for (i, a), (j, b) in seams.stitches:
        mine, theirs = cuts[i][a], cuts[j][b]
        if mine and len(mine) != len(theirs):
            cuts[j][b] = [1 - share for share in reversed(mine)]
        elif theirs and not mine:
            cuts[i][a] = [1 - share for share in reversed(theirs)]
    loops, first = [], []
    for loop, own in zip(seams.loops, cuts, strict=True):
        first.append(np.cumsum([0, *(len(c) + 1 for c in own)]).tolist())
        # What half-edges a part stands for is of no use any more.
        loops.append(
            [
                CutEdge(part, edge.run, [])
                for edge, shares in zip(loop, own, strict=True)
                for part in _parted(edge.curve, shares)
            ]
        )
    stitches = [
        ((i, first[i][a] + k), (j, first[j][b + 1] - 1 - k))
        for (i, a), (j, b) in seams.stitches
        for k in range(len(cuts[i][a]) + 1)
    ]
    return replace(seams, loops=loops, stitches=stitches)


def _along_half_edges(
    image: GarmentImage, clusters: Sequence[Cluster]
) -> Mapping[int, list[float]]:
    """Shares of the divisions on each half-edge that has some, in the direction of its loop."""
    found: dict[int, list[float]] = {}
    first = 0
    for cluster in clusters:
        half = half_edges(cluster.mesh, image.edge_type[cluster.layer])
        if cluster.mark is not None and cluster.mark.divisions:
            cells = cluster.mesh.cells[half.cell]
            keys = zip(cells[:, 0].tolist(), cells[:, 1].tolist(), half.side.tolist(), strict=True)
            number = {key: first + k for k, key in enumerate(keys)}
            for row, col, side, shares in cluster.mark.divisions:
                if (row, col, side) in number:
                    forward = (side in (0, 1)) == (cluster.outward > 0)
                    shares = shares if forward else tuple(1 - s for s in reversed(shares))
                    found[number[row, col, side]] = list(shares)
        first += len(half.cell)
    return found


def _cuts(
    loop: Sequence[CutEdge], along: Mapping[int, list[float]], lengths: Float[np.ndarray, " half"]
) -> list[list[float]]:
    """For each edge of a loop the shares of its length at which it is divided, increasing."""
    cuts = []
    for edge in loop:
        reached = np.cumsum(lengths[edge.halves])
        cuts.append(
            [
                float((reached[k] - (1 - share) * lengths[half]) / reached[-1])
                for k, half in enumerate(edge.halves)
                for share in along.get(half, ())
            ]
        )
    sizes = [edge.curve.length for edge in loop]
    for k, edge in enumerate(loop):
        # Where one curve does not fit there is a vertex already: it stands for the nearest one.
        if edge.run == loop[k - 1].run and len(loop) > 1:
            before = (1 - cuts[k - 1][-1]) * sizes[k - 1] if cuts[k - 1] else np.inf
            after = cuts[k][0] * sizes[k] if cuts[k] else np.inf
            if min(before, after) < SNAP_CM:
                (cuts[k - 1] if before < after else cuts[k]).pop(-1 if before < after else 0)
    return [
        [share for share in own if END_CM < share * size < size - END_CM]
        for own, size in zip(cuts, sizes, strict=True)
    ]


def _parted(curve: Curve, cuts: Sequence[float]) -> list[Curve]:
    """A curve in parts, split at shares of its length; straight where they nearly are."""
    if not cuts:
        return [curve]
    parts, rest, done = [], curve, 0.0
    for t in map(curve.parameter, cuts):
        part, rest = rest.split((t - done) / (1 - done))
        parts.append(part)
        done = t
    return [_straightened(part) for part in (*parts, rest)]


def _straightened(curve: Curve) -> Curve:
    inner = curve.at(np.array([0.25, 0.5, 0.75]))
    start, end = np.array(curve.start), np.array(curve.end)
    dx, dy = end - start
    away = (inner[:, 0] - start[0]) * dy - (inner[:, 1] - start[1]) * dx
    near = np.abs(away).max() <= STRAIGHT_CM * np.hypot(dx, dy)
    return Line(curve.start, curve.end) if near else curve
