"""Panels named, turned into their own frames, placed round the body, and their edges sewn."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from garmentimage.geometry import centroid, signed_area, to_point
from garmentimage.pattern import (
    Loop,
    Panel,
    Pattern,
    Side,
    Stitch,
    euler_angles,
    loop_from_curves,
)
from garmentimage.raster.decode.boundary import Boundary, Cluster
from garmentimage.raster.decode.fit_edges import FittedPanels
from garmentimage.raster.decode.naming import panel_names
from garmentimage.raster.image import GarmentImage, PanelMark

DEPTH_CM = 20.0
"""Distance of front and back panels from the plane between them, where no mark says better."""

LAYER_STEP_CM = 3.0  # how much farther out each further pair of layers is placed

ORTHOGONAL_TOL = 1e-3


@dataclass(frozen=True)
class PanelFrames:
    """Each panel in a frame of its own: raster frame = matrix @ panel frame + shift."""

    boundary: Boundary  # half-edges in the frames of their panels [cm]
    matrices: list[Float[np.ndarray, "2 2"]]  # for each cluster, orthogonal
    shifts: list[Float[np.ndarray, " 2"]]
    """For each cluster where the raster frame puts the panel's origin [cm]."""


def marks_of_clusters(
    image: GarmentImage, labels: Int[np.ndarray, "layer row col"], panel_count: int
) -> list[PanelMark | None]:
    """The mark of each cluster, found by its cell; the first where several name one cluster."""
    marks: list[PanelMark | None] = [None] * panel_count
    for mark in image.marks:
        row, col = mark.cell
        if not (0 <= mark.layer < image.layers and 0 <= row < image.grid and 0 <= col < image.grid):
            continue
        k = int(labels[mark.layer, row, col])
        if k >= 0 and marks[k] is None:
            marks[k] = mark
    return marks


def panel_frames(boundary: Boundary, clusters: Sequence[Cluster]) -> PanelFrames:
    """Points in each panel's own frame, its centroid at the mark's anchor."""
    matrices = [_frame_matrix(cluster) for cluster in clusters]
    tail, head = boundary.tail.copy(), boundary.head.copy()
    # Parts of split panels must find their places exactly; the others are moved once refitted.
    middles = [c.vertices.mean(axis=0) for c in clusters]
    sizes = [0.0] * len(clusters)
    for loop in boundary.loops:
        k = int(boundary.cluster[loop[0]])
        mark = clusters[k].mark
        if mark is not None and mark.split_of is not None:
            size = abs(signed_area(tail[loop]))
            if size > sizes[k]:
                sizes[k], middles[k] = size, centroid(tail[loop])
    shifts = []
    for k, matrix in enumerate(matrices):
        mark = clusters[k].mark
        anchor = np.zeros(2) if mark is None else np.array(mark.anchor, float)
        shifts.append(middles[k] - matrix @ anchor)
        own = boundary.cluster == k
        tail[own] = (tail[own] - shifts[k]) @ matrix
        head[own] = (head[own] - shifts[k]) @ matrix
    return PanelFrames(replace(boundary, tail=tail, head=head), matrices, shifts)


def _frame_matrix(cluster: Cluster) -> Float[np.ndarray, "2 2"]:
    """Raster frame = matrix @ panel frame; a back panel without a mark is seen from outside."""
    if cluster.mark is not None:
        matrix = np.array(cluster.mark.matrix, float)
        if np.abs(matrix @ matrix.T - np.eye(2)).max() < ORTHOGONAL_TOL:
            return matrix
    return np.diag([float(cluster.outward), 1.0])


def assemble(
    image: GarmentImage, clusters: Sequence[Cluster], frames: PanelFrames, fitted: FittedPanels
) -> Pattern:
    """The pattern: panels with names and places, stitches between their edges."""
    names = panel_names(image, clusters, fitted.whole)
    loops = fitted.seams.loops
    panels = []
    side_of: dict[tuple[int, int], Side] = {}
    for k, own in sorted(fitted.members.items()):
        edges = [(i, number) for i in own for number in range(len(loops[i]))]
        side_of |= {edge: Side(names[k], number) for number, edge in enumerate(edges)}
        mark, move = clusters[k].mark, np.zeros(2)
        is_unsplit = (fitted.whole == k).sum() == 1
        if mark is not None and is_unsplit:
            move = np.array(mark.anchor) - centroid(fitted.seams.polygons[own[0]])
        drawn = [_moved(loop_from_curves([edge.curve for edge in loops[i]]), move) for i in own]
        matrix = frames.matrices[k]
        shift = frames.shifts[k] - matrix @ move
        panels.append(_place_panel(names[k], drawn, clusters[k], matrix, shift))
    sewn = tuple(Stitch(side_of[a], side_of[b]) for a, b in fitted.seams.stitches)
    return Pattern(tuple(panels), sewn, image.name)


def _place_panel(
    name: str,
    loops: Sequence[Loop],
    cluster: Cluster,
    matrix: Float[np.ndarray, "2 2"],
    shift: Float[np.ndarray, " 2"],
) -> Panel:
    """One panel in its frame and its place round the body."""
    turn = np.zeros((3, 3))
    turn[:2, :2], turn[2, 2] = matrix, np.linalg.det(matrix)
    depth = cluster.outward * (DEPTH_CM + LAYER_STEP_CM * (cluster.layer // 2))
    known = cluster.mark or PanelMark(name, cluster.layer, (0, 0))
    return Panel(
        name,
        loops[0],
        tuple(loops[1:]),
        known.translation or (float(shift[0]), float(shift[1]), depth),
        known.rotation or euler_angles(turn),
        label=known.label,
        grain=known.grain,
        cloth_layer=cluster.layer // 2,
    )


def _moved(loop: Loop, move: Float[np.ndarray, " 2"]) -> Loop:
    # Curvature is relative to the edge, so only the vertices move.
    return Loop(tuple(to_point(np.array(v) + move) for v in loop.vertices), loop.edges)
