"""From a GarmentImage back to the sewing pattern (paper, Section 3.3).

Geometry and stitches come from the channels alone. Marks, where the image has them, only give
panels their names, frames and places back, and join the parts of split panels again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int
from numba import njit

from garmentimage.errors import DecodeError
from garmentimage.geometry.curves import Curve
from garmentimage.geometry.polygons import centroid, signed_area
from garmentimage.pattern.model import (
    Loop,
    Panel,
    Pattern,
    Point,
    Side,
    Stitch,
    euler_angles,
    loop_from_curves,
)
from garmentimage.raster.cells import CellMesh, cell_mesh, label_panels
from garmentimage.raster.image import GarmentImage, PanelMark
from garmentimage.raster.naming import panel_names
from garmentimage.raster.outlines import (
    NONE,
    Boundary,
    Cluster,
    close_slits,
    join_parts,
    trace_boundary,
)
from garmentimage.raster.refit import Part, cut_run
from garmentimage.raster.repair import RepairLevel
from garmentimage.raster.repair import repair as repair_image

POSITION_WEIGHT = 1e-6
"""Weight of the position term of Eq. 2; it only fixes where the panel lies."""

DEPTH_CM = 20.0
"""Distance of front and back panels from the plane between them, where no mark says better."""

LAYER_STEP_CM = 3.0
"""How much farther out each further pair of layers is placed."""

ORTHOGONAL_TOL = 1e-3

_SAMPLES = np.arange(16) / 16

EFFORTS = (
    # (keep chords, sew up overlapping slits, pull towards the undeformed grid)
    (False, False, 0.0),
    (True, False, 0.0),
    (True, True, 0.0),
    (True, True, 0.5),
    (True, True, 1.0),
)
"""What is tried in turn for a panel whose outline would cross itself."""


def decode(image: GarmentImage | np.ndarray, *, repair: RepairLevel = "full") -> Pattern:
    """The sewing pattern that an image shows.

    Deterministic, for any garment. A panel's boundary is refitted to lines and smooth curves; one
    edge of it has one partner. A panel that would cross itself keeps its polyline, then has
    overlapping slits sewn up, then is pulled towards the undeformed grid.

    Args:
        image: a GarmentImage, or channels [17 L, N, N] as a network gives them.
        repair: how much of an inconsistent image is mended first, see `repair`.

    Raises:
        ImageError: the array has a wrong shape or values that are not finite.
        DecodeError: the image is empty, or a panel crosses itself whatever is tried.
    """
    image, _ = repair_image(image, level=repair)
    if not image.inside.any():
        raise DecodeError("the image is empty: no cell is inside a panel")
    labels, count = label_panels(image.inside, image.edge_type)
    marks = _marks_of_clusters(image, labels, count)
    layer_of = np.empty(count, np.int64)
    layer_of[labels[labels >= 0]] = np.nonzero(labels >= 0)[0]
    meshes = [
        cell_mesh(labels[layer] == k, image.edge_type[layer]) for k, layer in enumerate(layer_of)
    ]
    effort = np.zeros(count, np.int64)
    while True:
        clusters = [
            Cluster(int(layer), mesh, _unfold(image, int(layer), mesh, EFFORTS[e][2]))
            for layer, mesh, e in zip(layer_of, meshes, effort, strict=True)
        ]
        pattern, crossing = _assemble(image, clusters, marks, effort)
        if not crossing.any():
            return pattern
        if (effort[crossing] == len(EFFORTS) - 1).any():
            row, col = meshes[int(np.flatnonzero(crossing)[0])].cells[0]
            raise DecodeError(
                f"{crossing.sum()} panel(s) cross themselves, the first at row {row}, column {col} "
                f"of layer {image.layer_names[layer_of[np.flatnonzero(crossing)[0]]]!r}: the "
                "deformation or the edge types there make no outline"
            )
        effort[crossing] += 1


def unfold_cells(
    mesh: CellMesh,
    vectors: Float[np.ndarray, "cell 4 2"],
    positions: Float[np.ndarray, "vertex 2"],
    weight: float = POSITION_WEIGHT,
) -> Float[np.ndarray, "vertex 2"]:
    """Vertex positions whose edges agree best with the edge vectors of all cells.

    Paper: Eq. 2, sum |(v_j - v_i) - d_ij|² + weight · sum |v_i - position_i|². The paper's weight
    is 1 and pulls the panel to the grid: on correct images of 75 garments the panels' mean IoU
    is then WEIGHT_ONE_IOU instead of TINY_IOU. With 1e-6 the term only says where the panel lies.

    Args:
        mesh: the quads of one panel.
        vectors: bottom, right, top and left edge vector of each cell [cm].
        positions: where the vertices would lie undeformed [cm].
        weight: of the position term, per vertex.
    """
    from scipy.linalg import solveh_banded

    bottom_left, bottom_right, top_right, top_left = mesh.corner_ids.T
    start = np.concatenate([bottom_left, bottom_right, top_left, bottom_left])
    end = np.concatenate([bottom_right, top_right, top_right, top_left])
    wanted = vectors.transpose(1, 0, 2).reshape(-1, 2)
    band, rhs = _normal_equations(start, end, wanted, positions, weight)
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


@njit(cache=True)
def _normal_equations(start, end, wanted, positions, weight):  # type: ignore[no-untyped-def]
    """Lower band of the normal matrix of Eq. 2, and its right-hand side."""
    width = 0
    for k in range(len(start)):
        width = max(width, abs(start[k] - end[k]))
    count = len(positions)
    band = np.zeros((width + 1, count))
    rhs = weight * positions
    band[0] += weight
    for k in range(len(start)):
        i, j = start[k], end[k]
        band[0, i] += 1
        band[0, j] += 1
        band[abs(i - j), min(i, j)] -= 1
        for axis in range(2):
            rhs[i, axis] -= wanted[k, axis]
            rhs[j, axis] += wanted[k, axis]
    return band, rhs


def _marks_of_clusters(
    image: GarmentImage, labels: Int[np.ndarray, "layer row col"], count: int
) -> list[PanelMark | None]:
    """The mark of each cluster, found by its cell; the first where several name one cluster."""
    marks: list[PanelMark | None] = [None] * count
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
        if np.allclose(matrix @ matrix.T, np.eye(2), atol=ORTHOGONAL_TOL):
            return matrix
    return np.diag([float(cluster.outward), 1.0])


def _assemble(
    image: GarmentImage,
    clusters: Sequence[Cluster],
    marks: Sequence[PanelMark | None],
    effort: Int[np.ndarray, " cluster"],
) -> tuple[Pattern, Bool[np.ndarray, " cluster"]]:
    """The pattern, and which clusters have an outline that crosses itself."""
    boundary = trace_boundary(image, clusters)
    sewn_up = {k for k, e in enumerate(effort) if EFFORTS[e][1]}
    if sewn_up:
        boundary = close_slits(boundary, clusters, sewn_up)
    matrices = [_frame_matrix(c, m) for c, m in zip(clusters, marks, strict=True)]
    boundary, shifts = _to_panel_frames(boundary, matrices, marks)
    boundary, whole = join_parts(boundary, [None if m is None else m.split_of for m in marks])

    chords = np.array([EFFORTS[e][0] for e in effort])
    loops, stitches = _cut_edges(boundary, chords)
    polygons = [_polygon(edges) for edges in loops]
    areas = [abs(signed_area(p)) for p in polygons]
    members: dict[int, list[int]] = {}
    for index, loop in enumerate(boundary.loops):
        members.setdefault(int(whole[boundary.cluster[loop[0]]]), []).append(index)
    names = panel_names(image, clusters, marks, whole)
    panels, crossing = [], np.zeros(len(clusters), bool)
    edge_place: dict[int, tuple[str, int]] = {}
    for k in sorted(members):
        order = sorted(members[k], key=lambda i: -areas[i])
        crossing[whole == k] = _is_crossing([polygons[i] for i in order])
        first = 0
        for i in order:
            edge_place[i] = names[k], first
            first += len(loops[i])
        outline = polygons[order[0]]
        mark, joined = marks[k], bool((whole == k).sum() > 1)
        move = np.zeros(2)
        if mark is not None and not joined:
            move = np.array(mark.anchor) - centroid(outline)
        panels.append(
            _place_panel(
                names[k],
                [_moved(loop_from_curves(loops[i]), move) for i in order],
                clusters[k],
                mark,
                matrices[k],
                shifts[k] - matrices[k] @ move,
            )
        )
    if crossing.any():
        return Pattern(()), crossing
    sewn = tuple(Stitch(_side(edge_place, a), _side(edge_place, b)) for a, b in stitches)
    return Pattern(tuple(panels), sewn, image.name), crossing


def _side(place: Mapping[int, tuple[str, int]], edge: tuple[int, int]) -> Side:
    name, first = place[edge[0]]
    return Side(name, first + edge[1])


def _to_panel_frames(
    boundary: Boundary,
    matrices: Sequence[np.ndarray],
    marks: Sequence[PanelMark | None],
) -> tuple[Boundary, list[Float[np.ndarray, " 2"]]]:
    """Points in each panel's own frame, its centroid at the mark's anchor.

    Returns:
        The boundary, and for each cluster where the raster frame puts the panel's origin.
    """
    tail, head = boundary.tail.copy(), boundary.head.copy()
    shifts: list[np.ndarray] = [np.zeros(2)] * len(matrices)
    outlines: dict[int, list[int]] = {}
    for loop in boundary.loops:
        k = int(boundary.cluster[loop[0]])
        if k not in outlines or abs(signed_area(tail[loop])) > abs(signed_area(tail[outlines[k]])):
            outlines[k] = loop
    for k, (matrix, mark) in enumerate(zip(matrices, marks, strict=True)):
        anchor = np.zeros(2) if mark is None else np.array(mark.anchor, float)
        own = boundary.cluster == k
        middle = centroid(tail[outlines[k]])
        shifts[k] = middle - matrix @ anchor
        tail[own] = (tail[own] - shifts[k]) @ matrix
        head[own] = (head[own] - shifts[k]) @ matrix
    return replace(boundary, tail=tail, head=head), shifts


def _cut_edges(
    boundary: Boundary, chords: Bool[np.ndarray, " cluster"]
) -> tuple[list[list[Curve]], list[tuple[tuple[int, int], tuple[int, int]]]]:
    """Every loop as edges, and which edges are sewn together, as (loop, edge) pairs."""
    loops = boundary.loops
    starts = _run_starts(boundary, loops)
    runs: dict[int, list[int]] = {}
    order: list[list[int]] = []
    for loop in loops:
        turn = next(i for i, k in enumerate(loop) if starts[k])
        loop = loop[turn:] + loop[:turn]
        order.append([])
        for k in loop:
            if starts[k]:
                order[-1].append(k)
                runs[k] = []
            runs[order[-1][-1]].append(k)

    cut: dict[int, list[Part]] = {}
    sewn_to: dict[int, int] = {}
    for k, run in runs.items():
        if k in cut:
            continue
        points = np.concatenate([boundary.tail[run], boundary.head[run[-1:]]])
        keep = bool(chords[boundary.cluster[run]].any())
        if boundary.partner[k] == NONE:
            cut[k] = cut_run((points,), chords=keep)
            continue
        other = boundary.partner[run]
        partner = int(other[-1])
        facing = np.concatenate([boundary.head[other], boundary.tail[other[-1:]]])
        keep |= bool(chords[boundary.cluster[other]].any())
        parts = cut_run((points, facing), chords=keep)
        cut[k] = [Part(p.first, p.last, p.curves[:1]) for p in parts]
        cut[partner] = [Part(p.first, p.last, (p.curves[1].reversed(),)) for p in reversed(parts)]
        sewn_to[k] = partner

    place: dict[int, tuple[int, int]] = {}
    edges: list[list[Curve]] = []
    for index, heads in enumerate(order):
        curves: list[Curve] = []
        for k in heads:
            place[k] = (index, len(curves))
            curves.extend(p.curves[0] for p in cut[k])
        edges.append(curves)
    stitches: list[tuple[tuple[int, int], tuple[int, int]]] = []
    for k, partner in sewn_to.items():
        (loop_a, a), (loop_b, b) = place[k], place[partner]
        count = len(cut[k])
        stitches.extend(((loop_a, a + i), (loop_b, b + count - 1 - i)) for i in range(count))
    return edges, stitches


def _run_starts(boundary: Boundary, loops: Sequence[Sequence[int]]) -> Bool[np.ndarray, " half"]:
    """Where runs begin; a loop with one fate all round begins where it turns most."""
    starts = boundary.seam_starts
    for loop in loops:
        if starts[loop].any():
            continue
        d = boundary.head[loop] - boundary.tail[loop]
        before = np.roll(d, 1, axis=0)
        turn = np.abs(
            np.arctan2(before[:, 0] * d[:, 1] - before[:, 1] * d[:, 0], (before * d).sum(1))
        )
        k = loop[int(np.argmax(turn))]
        starts[k] = True
        partner = boundary.partner[boundary.preceding[k]]
        if partner != NONE:
            starts[partner] = True
    return starts


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


def _polygon(curves: Sequence[Curve]) -> Float[np.ndarray, "n 2"]:
    return np.concatenate(
        [np.array([c.start]) if c.is_straight else c.at(_SAMPLES) for c in curves]
    )


def _is_crossing(polygons: Sequence[np.ndarray]) -> bool:
    """Whether an outline with its holes touches itself, or has no area, or a hole lies outside."""
    if any(len(p) < 3 for p in polygons):
        return True
    points = np.concatenate(polygons)
    onward = np.arange(1, len(points) + 1)
    ends = np.cumsum([len(p) for p in polygons])
    onward[ends - 1] = ends - [len(p) for p in polygons]
    outer = polygons[0]
    return bool(
        abs(signed_area(outer)) < 1e-3
        or any(not _contains(outer, hole[0]) for hole in polygons[1:])
        or _touches(points, onward)
    )


def _contains(polygon: np.ndarray, point: np.ndarray) -> bool:
    """Even-odd test."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((x > point[0]).sum() % 2)


@njit(cache=True)
def _touches(points, onward):  # type: ignore[no-untyped-def]
    """Whether two sides of closed polygons, not neighbours, have a point in common."""
    count = len(points)
    for i in range(count):
        ax, ay = points[i]
        bx, by = points[onward[i]]
        low_x, high_x = min(ax, bx), max(ax, bx)
        low_y, high_y = min(ay, by), max(ay, by)
        for j in range(i + 1, count):
            cx, cy = points[j]
            dx, dy = points[onward[j]]
            if max(cx, dx) < low_x or min(cx, dx) > high_x:
                continue
            if max(cy, dy) < low_y or min(cy, dy) > high_y:
                continue
            if onward[i] == j or onward[j] == i:
                # Neighbours share a point; they touch elsewhere only where one folds back.
                ux, uy, vx, vy = bx - ax, by - ay, dx - cx, dy - cy
                if (
                    abs(ux * vy - uy * vx) < 1e-9 * (abs(ux * vx + uy * vy))
                    and ux * vx + uy * vy < 0
                ):
                    return True
                continue
            s1 = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
            s2 = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
            s3 = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
            s4 = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
            if s1 * s2 <= 0 and s3 * s4 <= 0:
                return True
    return False
