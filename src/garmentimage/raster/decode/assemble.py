"""Panels named, turned into their own frames, placed round the body, and their edges sewn."""

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.geometry import centroid, signed_area, to_point
from garmentimage.pattern import (
    Loop,
    Panel,
    Pattern,
    Side,
    Stitch,
    euler_angles,
    fold_over,
    loop_from_curves,
)
from garmentimage.raster.decode.boundary import NONE, Boundary, Cluster, rigid
from garmentimage.raster.decode.fit_edges import FittedPanels
from garmentimage.raster.decode.naming import panel_names
from garmentimage.raster.decode.on_cloth import Frame, pressed_pleats, sewn_onto
from garmentimage.raster.image import GarmentImage, PanelMark

DEPTH_CM = 20.0
"""Distance of front and back panels from the plane between them, where no mark says better."""

LAYER_STEP_CM = 3.0  # how much farther out each further pair of layers is placed

FOLD_LIFT_CM = 1.0
"""How far outward a turned panel is placed from the one that it is folded onto, where no mark says
better."""

ORTHOGONAL_TOL = 1e-3


@dataclass(frozen=True)
class PanelFrames:
    """Each panel in a frame of its own: raster frame = matrix @ panel frame + shift."""

    boundary: Boundary  # half-edges in the frames of their panels [cm]
    matrices: list[Float[np.ndarray, "2 2"]]  # for each cluster, orthogonal
    shifts: list[Float[np.ndarray, " 2"]]
    """For each cluster where the raster frame puts the panel's origin [cm]."""


@dataclass(frozen=True)
class WrappedPlace:
    """Where a panel stands that was joined from parts and has no mark: edge-on, at the side of the
    body or over it, as encoding lays such panels flat (see `raster.encode.placement`).
    """

    turn: Float[np.ndarray, "2 2"]
    """Takes the frame in which it was joined to the one that lies midway."""
    rotation: Float[np.ndarray, "3 3"]
    """Of the panel, in the frame that lies midway."""
    middle: Float[np.ndarray, " 2"]
    """Mean place of its parts in the raster's frame [cm]."""
    cut: Float[np.ndarray, " 2"]
    """The middle of the line between front and back, in the frame that lies midway [cm]."""


def wrapped_place(
    clusters: Sequence[Cluster],
    before: Boundary,
    after: Boundary,
    members: Sequence[int],
    matrix: Float[np.ndarray, "2 2"],
) -> WrappedPlace:
    """The place of a panel that was joined along wraps.

    Args:
        clusters: all.
        before: half-edges in the frames of the clusters.
        after: the same half-edges once joined.
        members: its clusters; the first, in whose frame they were joined, lies in front.
        matrix: raster frame = matrix @ frame of the first.
    """
    weights = np.array([float(len(clusters[k].mesh.cells)) for k in members])
    weights /= weights.sum()
    angle = -sum(w * _turned_by(before, after, k) for w, k in zip(weights, members, strict=True))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    first = before.cluster == members[0]
    gone = first & before.wraps & (after.following == NONE)
    cut = np.concatenate([before.tail[gone], before.head[gone]])
    outward = np.sign(matrix @ (cut.mean(axis=0) - before.tail[first].mean(axis=0)))
    width, height = np.ptp(cut @ matrix.T, axis=0)
    (x, y), none = np.eye(2), np.zeros(2)
    # What the front part has farther inward from the cut stands farther forward.
    upright = [none, y, -outward[0] * x] if height >= width else [x, none, -outward[1] * y]
    axes = np.stack(upright)
    return WrappedPlace(
        turn=turn,
        rotation=np.column_stack([axes, np.cross(axes[:, 0], axes[:, 1])]),
        middle=weights @ np.array([clusters[k].vertices.mean(axis=0) for k in members]),
        cut=turn @ cut.mean(axis=0),
    )


def _turned_by(before: Boundary, after: Boundary, cluster: int) -> float:
    """Angle by which a cluster was turned when it was joined [rad]."""
    own = (before.cluster == cluster) & (after.following != NONE)
    rotation, _ = rigid(before.tail[own], after.tail[own])
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


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
    flat: dict[int, Frame] = {}
    for k, own in sorted(fitted.members.items()):
        edges = [(i, number) for i in own for number in range(len(loops[i]))]
        side_of |= {edge: Side(names[k], number) for number, edge in enumerate(edges)}
        drawn = [loop_from_curves([edge.curve for edge in loops[i]]) for i in own]
        outline = fitted.seams.polygons[own[0]]
        members = np.flatnonzero(fitted.whole == k).tolist()
        mark = clusters[k].mark
        if mark is None and len(members) > 1:
            parts = clusters, frames.boundary, fitted.boundary, members, frames.matrices[k]
            place = wrapped_place(*parts)
            panels.append(_standing(names[k], drawn, clusters[k], place, centroid(outline)))
            continue
        is_whole = mark is not None and len(members) == 1
        move = np.array(mark.anchor) - centroid(outline) if mark and is_whole else np.zeros(2)
        drawn = [_posed(loop, np.eye(2), move) for loop in drawn]
        shift = frames.shifts[k] - frames.matrices[k] @ move
        panels.append(_flat(names[k], drawn, clusters[k], frames.matrices[k], shift))
        if len(members) == 1:
            flat[k] = frames.matrices[k], shift
    sewn = tuple(Stitch(side_of[a], side_of[b]) for a, b in fitted.seams.stitches)
    onto = sewn_onto(image, clusters, fitted, flat, names)
    pattern = Pattern(tuple(panels), sewn, image.name, onto)
    pleats = pressed_pleats(image, clusters, fitted, flat, pattern)
    pattern = replace(pattern, pleats=pleats)
    turned = {names[k] for k in fitted.members if _is_turned(clusters, fitted.whole == k)}
    if not turned:
        return pattern
    unplaced = {names[k] for k in fitted.members if clusters[k].mark is None}
    return _on_top(fold_over(pattern, turned, unplaced, FOLD_LIFT_CM), turned)


def _is_turned(clusters: Sequence[Cluster], members: Bool[np.ndarray, " cluster"]) -> bool:
    """Whether most cells of a panel say that its wrong side is out."""
    chosen = [clusters[k] for k in np.flatnonzero(members).tolist()]
    votes = sum(cluster.turned_cells for cluster in chosen)
    return 2 * votes > sum(len(cluster.mesh.cells) for cluster in chosen)


def _on_top(pattern: Pattern, names: Set[str]) -> Pattern:
    """The pattern, these panels on the next cloth layer."""
    panels = (
        replace(p, cloth_layer=p.cloth_layer + 1) if p.name in names else p for p in pattern.panels
    )
    return replace(pattern, panels=tuple(panels))


def _flat(
    name: str,
    loops: Sequence[Loop],
    cluster: Cluster,
    matrix: Float[np.ndarray, "2 2"],
    shift: Float[np.ndarray, " 2"],
) -> Panel:
    """A panel in front of the body or behind it, or where its mark says."""
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


def _standing(
    name: str,
    loops: Sequence[Loop],
    cluster: Cluster,
    place: WrappedPlace,
    centre: Float[np.ndarray, " 2"],
) -> Panel:
    """A panel that wraps round the body, edge-on at its side; the cut stands midway in depth."""
    outline, *holes = (_posed(loop, place.turn, np.zeros(2)) for loop in loops)
    x, y, _ = -place.rotation[:, :2] @ (place.turn @ centre)
    z = -place.rotation[2, :2] @ place.cut
    middle_x, middle_y = place.middle
    return Panel(
        name,
        outline,
        tuple(holes),
        (float(middle_x + x), float(middle_y + y), float(z)),
        euler_angles(place.rotation),
        cloth_layer=cluster.layer // 2,
    )


def _posed(loop: Loop, matrix: Float[np.ndarray, "2 2"], move: Float[np.ndarray, " 2"]) -> Loop:
    # Curvature is relative to the edge, so only the vertices move.
    points = np.array(loop.vertices) @ matrix.T + move
    return Loop(tuple(map(to_point, points)), loop.edges)
