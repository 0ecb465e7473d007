"""From a GarmentImage back to the sewing pattern (paper, Section 3.3).

Geometry and stitches come from the channels alone. Marks, where the image has them, only give
panels their names, frames and places back, and join the parts of split panels again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count

import numpy as np
from jaxtyping import Float, Int

from garmentimage.errors import DecodeError
from garmentimage.geometry import centroid, contains, signed_area, touching_sides
from garmentimage.pattern import (
    Loop,
    Panel,
    Pattern,
    Point,
    Side,
    Stitch,
    chord_count,
    euler_angles,
    loop_from_curves,
    polygon_of,
)
from garmentimage.pattern.checks import PANEL_SIZE_LIMIT, SHORTEST_EDGE
from garmentimage.raster.cells import CellMesh, cell_mesh, label_panels
from garmentimage.raster.channel_kind import ChannelKind
from garmentimage.raster.decode._kernels_unfold import normal_equations
from garmentimage.raster.decode.boundary import (
    NONE,
    Boundary,
    Cluster,
    close_slits,
    join_parts,
    trace_boundary,
)
from garmentimage.raster.decode.divisions import with_divisions
from garmentimage.raster.decode.edges import CutLoop, cut_into_edges
from garmentimage.raster.decode.naming import panel_names
from garmentimage.raster.image import GarmentImage, PanelMark
from garmentimage.raster.repair import RepairLevel, repair as repair_image, without_flaps

POSITION_WEIGHT = 1e-6
"""Weight of the position term of Eq. 2; it only fixes where the panel lies."""

DEPTH_CM = 20.0
"""Distance of front and back panels from the plane between them, where no mark says better."""

LAYER_STEP_CM = 3.0
"""How much farther out each further pair of layers is placed."""

ORTHOGONAL_TOL = 1e-3

EFFORTS = (
    # (sew up overlapping slits, pull towards the undeformed grid)
    (False, 0.0),
    (True, 0.0),
    (True, 0.5),
    (True, 1.0),
)
"""What is tried in turn for a panel whose very polyline crosses itself."""

STRAIGHTEN_ROUNDS = 4
"""How often runs that cross are made straight one by one; then all runs of their panels are."""

SMALLEST_PANEL_CM2 = 1e-3

MOST_PANELS = 1000
"""An image in more parts than this is noise; garments have up to 50 panels."""


def decode(
    image: GarmentImage | np.ndarray,
    *,
    repair: RepairLevel = "full",
    kind: ChannelKind | None = None,
) -> Pattern:
    """The sewing pattern that an image shows.

    Deterministic, for any garment. A panel's boundary is refitted to lines and smooth curves; one
    edge of it has one partner. Where curves would cross, the polyline stays; a panel whose very
    polyline crosses itself has overlapping slits sewn up, then is pulled towards the undeformed
    grid; with full repair, cuts that end inside a panel are left out at last.

    Args:
        image: a GarmentImage, or channels [17 L, N, N] as a network gives them.
        repair: how much of an inconsistent image is mended first, see `repair`.
        kind: what the numbers of channels are, see `repair`; default: judged by all of them.

    Raises:
        ImageError: the array has a wrong shape or values that are not finite; there is no such
            level or kind.
        DecodeError: the image is empty or mere noise, or a panel crosses itself whatever is tried.
    """
    image, _ = repair_image(image, level=repair, kind=kind)
    if not image.inside.any():
        raise DecodeError("the image is empty: no cell is inside a panel")
    try:
        return _decoded(image)
    except DecodeError:
        mended, count = without_flaps(image) if repair == "full" else (image, 0)
        if not count:
            raise
        return _decoded(mended)


def _decoded(image: GarmentImage) -> Pattern:
    """The pattern of an image as it stands."""
    labels, panel_count = label_panels(image.inside, image.edge_type)
    if panel_count > MOST_PANELS:
        raise DecodeError(
            f"the image is in {panel_count} parts, and no garment has more than {MOST_PANELS} "
            "panels; check the order of its channels"
        )
    marks = _marks_of_clusters(image, labels, panel_count)
    layer_of = np.empty(panel_count, np.int64)
    layer_of[labels[labels >= 0]] = np.nonzero(labels >= 0)[0]
    meshes = [
        cell_mesh(labels[layer] == k, image.edge_type[layer]) for k, layer in enumerate(layer_of)
    ]
    clusters, boundary = _simple_outlines(image, layer_of.tolist(), meshes)
    return _draw(image, clusters, marks, boundary)


def _simple_outlines(
    image: GarmentImage, layer_of: Sequence[int], meshes: Sequence[CellMesh]
) -> tuple[list[Cluster], Boundary]:
    """Unfold all clusters such that no outline crosses itself.

    Raises:
        DecodeError: one does whatever is tried.
    """
    effort = np.zeros(len(meshes), np.int64)
    clusters = [
        Cluster(layer, mesh, _unfold(image, layer, mesh, 0.0))
        for layer, mesh in zip(layer_of, meshes, strict=True)
    ]
    while True:
        boundary = trace_boundary(image, clusters)
        sewn_up = {k for k, e in enumerate(effort) if EFFORTS[e][0]}
        if sewn_up:
            boundary = close_slits(boundary, clusters, sewn_up)
        outlines: list[list[np.ndarray]] = [[] for _ in clusters]
        for loop in boundary.loops:
            outlines[int(boundary.cluster[loop[0]])].append(boundary.tail[loop])
        faulty = [k for k, polygons in enumerate(outlines) if not _is_outline(polygons)]
        if not faulty:
            return clusters, boundary
        for k in faulty:
            effort[k] += 1
            if effort[k] == len(EFFORTS):
                row, col = meshes[k].cells[0]
                raise DecodeError(
                    f"the panel at row {row}, column {col} of layer "
                    f"{image.layer_names[layer_of[k]]!r} crosses itself: the deformation or the "
                    "edge types there make no outline"
                )
            vertices = _unfold(image, layer_of[k], meshes[k], EFFORTS[effort[k]][1])
            clusters[k] = replace(clusters[k], vertices=vertices)


def unfold_cells(
    mesh: CellMesh,
    vectors: Float[np.ndarray, "cell 4 2"],
    positions: Float[np.ndarray, "vertex 2"],
    weight: float = POSITION_WEIGHT,
) -> Float[np.ndarray, "vertex 2"]:
    """Vertex positions whose edges agree best with the edge vectors of all cells.

    Paper: Eq. 2, sum |(v_j - v_i) - d_ij|² + weight · sum |v_i - position_i|². The paper's weight
    is 1 and pulls the panel to the grid: on correct 16 x 16 images of 72 garments (489 panels)
    their mean IoU is 0.540 with it, 0.990 with 1e-3 and 0.996 with 1e-6, where the term only says
    where the panel lies.

    Args:
        mesh: the quads of one panel.
        vectors: bottom, right, top and left edge vector of each cell [cm].
        positions: where the vertices would lie undeformed [cm].
        weight: of the position term, per vertex.
    """
    from scipy.linalg import solveh_banded

    assert len(positions) == mesh.vertex_count and len(vectors) == len(mesh.cells)
    bottom_left, bottom_right, top_right, top_left = mesh.corner_ids.T
    start = np.concatenate([bottom_left, bottom_right, top_left, bottom_left])
    end = np.concatenate([bottom_right, top_right, top_right, top_left])
    wanted = vectors.transpose(1, 0, 2).reshape(-1, 2)
    band, rhs = normal_equations(start, end, wanted, positions, weight)
    return solveh_banded(band, rhs, lower=True, overwrite_ab=True, check_finite=False)


def _unfold(image: GarmentImage, layer: int, mesh: CellMesh, pull: float) -> np.ndarray:
    """Vertices of one cluster; `pull` = 1 gives the undeformed grid."""
    rows, cols = mesh.cells.T
    positions = image.frame.to_body(mesh.lattice)
    vectors = image.deformation[layer][:, :, rows, cols].transpose(2, 0, 1).astype(np.float64)
    if pull:
        bl, br, tr, tl = (positions[mesh.corner_ids[:, c]] for c in range(4))
        rest = np.stack([br - bl, tr - br, tr - tl, tl - bl], axis=1)
        vectors = (1 - pull) * vectors + pull * rest
    return unfold_cells(mesh, vectors, positions)


def _marks_of_clusters(
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


def _frame_matrix(cluster: Cluster, mark: PanelMark | None) -> Float[np.ndarray, "2 2"]:
    """Raster frame = matrix @ panel frame; a back panel without a mark is seen from outside."""
    if mark is not None:
        matrix = np.array(mark.matrix, float)
        if np.abs(matrix @ matrix.T - np.eye(2)).max() < ORTHOGONAL_TOL:
            return matrix
    return np.diag([float(cluster.outward), 1.0])


def _draw(
    image: GarmentImage,
    clusters: Sequence[Cluster],
    marks: Sequence[PanelMark | None],
    boundary: Boundary,
) -> Pattern:
    """The pattern with the given outlines: parts joined, edges refitted, panels placed."""
    matrices = [_frame_matrix(c, m) for c, m in zip(clusters, marks, strict=True)]
    apart, shifts = _to_panel_frames(boundary, clusters, matrices, marks)
    part_of = [None if m is None else m.split_of for m in marks]
    straight: set[int] = set()
    for turn in count(1):
        boundary, whole = join_parts(apart, part_of)
        loops = boundary.loops
        seams = cut_into_edges(boundary, loops, straight)
        polygons = [polygon_of(loop.curves) for loop in seams.loops]
        members: dict[int, list[int]] = {}
        for index, loop in enumerate(loops):
            members.setdefault(int(whole[boundary.cluster[loop[0]]]), []).append(index)
        for own in members.values():
            if len(own) > 1:
                own.sort(key=lambda i: -abs(signed_area(polygons[i])))
        faulty = [k for k, own in members.items() if not _is_outline([polygons[i] for i in own])]
        if not faulty:
            break
        for k in faulty:
            cut = [seams.loops[i] for i in members[k]]
            curved = _curved_runs(cut, [polygons[i] for i in members[k]], seams.chords)
            if turn > STRAIGHTEN_ROUNDS:
                curved = {run for loop in cut for run in loop.runs}
            if curved <= straight:
                # Only joining can have brought polylines to cross: these parts do not fit.
                part_of = [None if whole[i] == k else name for i, name in enumerate(part_of)]
            straight |= curved

    divided = with_divisions(seams, boundary, image, clusters, marks)
    if divided is not seams:
        corners = [polygon_of(loop.curves) for loop in divided.loops]
        if all(_is_outline([corners[i] for i in own]) for own in members.values()):
            seams, polygons = divided, corners

    names = panel_names(image, clusters, marks, whole)
    panels = []
    place: dict[int, tuple[str, int]] = {}
    for k, own in sorted(members.items()):
        first = 0
        for i in own:
            place[i] = names[k], first
            first += len(seams.loops[i].curves)
        mark, move = marks[k], np.zeros(2)
        if mark is not None and (whole == k).sum() == 1:
            move = np.array(mark.anchor) - centroid(polygons[own[0]])
        drawn = [_moved(loop_from_curves(seams.loops[i].curves), move) for i in own]
        shift = shifts[k] - matrices[k] @ move
        panels.append(_place_panel(names[k], drawn, clusters[k], mark, matrices[k], shift))
    sewn = tuple(Stitch(_side(place, a), _side(place, b)) for a, b in seams.stitches)
    return Pattern(tuple(panels), sewn, image.name)


def _is_outline(polygons: Sequence[np.ndarray]) -> bool:
    """Whether loops bound a panel: an outline and holes in it, none crossing, touching or tiny."""
    if not polygons or any(len(p) < 3 for p in polygons):
        return False
    areas = [signed_area(p) for p in polygons]
    first = int(np.argmax(np.abs(areas)))
    outline = polygons[first]
    steps = np.concatenate([np.diff(p, axis=0, append=p[:1]) for p in polygons])
    if (
        abs(areas[first]) < SMALLEST_PANEL_CM2
        or np.ptp(outline, axis=0).max() > PANEL_SIZE_LIMIT
        or np.abs(steps).max(axis=1).min() < 2 * SHORTEST_EDGE
        or len(touching_sides(polygons))
    ):
        return False
    holes = [k for k in range(len(polygons)) if k != first]
    return all(
        areas[k] * areas[first] < 0
        and contains(outline, polygons[k][0])
        and not any(j != k and contains(polygons[j], polygons[k][0]) for j in holes)
        for k in holes
    )


def _curved_runs(
    loops: Sequence[CutLoop], polygons: Sequence[np.ndarray], chords: Mapping[int, int]
) -> set[int]:
    """Of every two runs that cross, the curved one with fewer points to hold it."""
    run_of = [
        run if not curve.is_straight else NONE
        for loop in loops
        for curve, run in zip(loop.curves, loop.runs, strict=True)
        for _ in range(chord_count(curve))
    ]
    runs = set()
    for pair in touching_sides(polygons).tolist():
        curved = [run_of[i] for i in pair if run_of[i] != NONE]
        if curved:
            runs.add(min(curved, key=lambda run: (chords[run], run)))
    return runs


def _side(place: Mapping[int, tuple[str, int]], edge: tuple[int, int]) -> Side:
    name, first = place[edge[0]]
    return Side(name, first + edge[1])


def _to_panel_frames(
    boundary: Boundary,
    clusters: Sequence[Cluster],
    matrices: Sequence[np.ndarray],
    marks: Sequence[PanelMark | None],
) -> tuple[Boundary, list[Float[np.ndarray, " 2"]]]:
    """Points in each panel's own frame, its centroid at the mark's anchor.

    Returns:
        The boundary, and for each cluster where the raster frame puts the panel's origin.
    """
    tail, head = boundary.tail.copy(), boundary.head.copy()
    # Parts of split panels must find their places exactly; the others are moved once refitted.
    middles = [c.vertices.mean(axis=0) for c in clusters]
    sizes = [0.0] * len(clusters)
    for loop in boundary.loops:
        k = int(boundary.cluster[loop[0]])
        mark = marks[k]
        if mark is not None and mark.split_of is not None:
            size = abs(signed_area(tail[loop]))
            if size > sizes[k]:
                sizes[k], middles[k] = size, centroid(tail[loop])
    shifts = []
    for k, (matrix, mark) in enumerate(zip(matrices, marks, strict=True)):
        anchor = np.zeros(2) if mark is None else np.array(mark.anchor, float)
        shifts.append(middles[k] - matrix @ anchor)
        own = boundary.cluster == k
        tail[own] = (tail[own] - shifts[k]) @ matrix
        head[own] = (head[own] - shifts[k]) @ matrix
    return replace(boundary, tail=tail, head=head), shifts


def _place_panel(
    name: str,
    loops: Sequence[Loop],
    cluster: Cluster,
    mark: PanelMark | None,
    matrix: Float[np.ndarray, "2 2"],
    shift: Float[np.ndarray, " 2"],
) -> Panel:
    """One panel in its frame and its place round the body."""
    turn = np.zeros((3, 3))
    turn[:2, :2], turn[2, 2] = matrix, np.linalg.det(matrix)
    depth = cluster.outward * (DEPTH_CM + LAYER_STEP_CM * (cluster.layer // 2))
    rotation, translation = euler_angles(turn), (float(shift[0]), float(shift[1]), depth)
    return Panel(
        name,
        loops[0],
        tuple(loops[1:]),
        translation if mark is None or mark.translation is None else mark.translation,
        rotation if mark is None or mark.rotation is None else mark.rotation,
        label=None if mark is None else mark.label,
        grain=None if mark is None else mark.grain,
        cloth_layer=cluster.layer // 2,
    )


def _moved(loop: Loop, move: Float[np.ndarray, " 2"]) -> Loop:
    # Curvature is relative to the edge, so only the vertices move.
    vertices: tuple[Point, ...] = tuple(
        (float(x + move[0]), float(y + move[1])) for x, y in loop.vertices
    )
    return Loop(vertices, loop.edges)
