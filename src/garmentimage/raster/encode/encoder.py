"""Encoding: a sewing pattern becomes a GarmentImage (paper, Section 3.2).

The garment is placed and laid out in the plane with every seam coincident, drawn on a fine
lattice with arcs that share no vertex, and compacted to the image's lattice. Each step keeps the
drawing valid, so the image is valid by construction: every panel one disk of cells, both sides of
a seam the same grid edges. That it is the image of *this* pattern is proven by decoding it.
"""

from collections.abc import Iterator
from math import dist
from numbers import Integral

import numpy as np

from garmentimage.compare import StitchGraph, stitch_graph
from garmentimage.errors import EncodeError, check_type, quoted
from garmentimage.geometry import centroid, resample, signed_area
from garmentimage.pattern import Pattern, turned_round
from garmentimage.pattern.checks import unknown_place
from garmentimage.raster.cells import cell_mesh, label_panels
from garmentimage.raster.decode import divisions_on, shares_along
from garmentimage.raster.encode.deform import deform_quad_mesh
from garmentimage.raster.encode.lattice import Path, drawings, lost_shape, trials
from garmentimage.raster.encode.layout import Layout, SeamGraph, build_seam_graph, layouts
from garmentimage.raster.encode.placement import Placed, PlacedPanel, place
from garmentimage.raster.encode.proof import Bows, bowed, disproof
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import Division, EdgeType, GarmentImage, PanelMark

GRIDS = (8, 128)
"""Smallest and largest grid that can be encoded to."""
LARGER_GRIDS = (32, 64)
"""Grids that are tried to say which one would do."""
TUBE_SHARE = 0.5
"""A panel whose sewn sides lie farther apart than this share of its size makes a tube: to bring
them together flat, as those of a ring or a dart, would tear it."""
BOWINGS = 5
"""Rounds in which bends are bowed until their seams come back as long as they should."""


def encode(
    pattern: Pattern, grid: int = 16, *, frame: BodyFrame | None = None, verify: bool = True
) -> GarmentImage:
    """Draw a sewing pattern on the grid.

    The image is decoded and compared before it is given: it brings back the same panels (each with
    an IoU of 0.9 or more), the same stitch graph, and seams as long within 2 % or 0.5 cm. From the
    channels alone the same outlines come back; panels that were cut to lie on both layers then
    stay cut, and names and frames of panels are forgotten.

    Args:
        pattern: the garment; placement decides which layer a panel lies on. One that is drawn
            inside out, all loops clockwise seen from outside the body, is turned over.
        grid: cells along each side, N.
        frame: where the grid lies on the body; default: the standard frame of this grid, which
            is what makes images of different garments comparable.
        verify: without, the image is not decoded, and may bring back another pattern.

    Returns:
        A valid image, the same for the same pattern every time.

    Raises:
        PatternError: the pattern is not sound.
        EncodeError: it does not fit, or would not come back; says what is in the way, and which
            grid would do or what to change in the pattern.
        TypeError: the garment is no Pattern, or the grid no whole number.
    """
    check_type(pattern, Pattern, "load_pattern(path) reads one from a file")
    check_type(grid, Integral, "give the number of cells along each side")
    if not GRIDS[0] <= grid <= GRIDS[1] or grid % 2:
        raise EncodeError(f"grid is {grid}; wanted an even number from {GRIDS[0]} to {GRIDS[1]}")
    try:
        return _encoded(pattern, int(grid), frame, verify=verify)
    except EncodeError:
        unknown = unknown_place(pattern)
        if unknown is None:
            raise
        raise EncodeError(str(unknown), remedy="pattern") from None


def _encoded(pattern: Pattern, grid: int, frame: BodyFrame | None, *, verify: bool) -> GarmentImage:
    """See `encode`; what is in the way is the grid or the garment's shape."""
    placed = place(pattern)
    if all(panel.sign != panel.outward for panel in placed.panels):
        if unknown_place(pattern) is not None:
            raise EncodeError("all its panels face the body", remedy="pattern")
        pattern = turned_round(pattern, [panel.name for panel in pattern.panels])
        placed = place(pattern)
    layouts_ = _Kept(layouts(build_seam_graph(placed)))
    expected = stitch_graph(pattern) if verify else None
    if frame is not None:
        return _encode(pattern, expected, layouts_, frame)
    try:
        return _encode(pattern, expected, layouts_, BodyFrame.standard(grid))
    except EncodeError as error:
        if error.remedy == "pattern" or unknown_place(pattern) is not None:
            raise
        tried = [larger for larger in LARGER_GRIDS if larger > grid]
        for larger in tried:
            try:
                _encode(pattern, expected, layouts_, BodyFrame.standard(larger))
            except EncodeError:
                continue
            raise EncodeError(
                f"{error}; it fits a grid of {larger}: --grid {larger}, or grid={larger} in Python",
                grid=larger,
            ) from None
        raise _final(error, tried, placed, expected or stitch_graph(pattern)) from None


def _final(
    error: EncodeError, tried: list[int], placed: Placed, expected: StitchGraph
) -> EncodeError:
    """The error where no grid will do: it names the cause, which may not be the grid at all."""
    whole = {panel.source for panel in placed.panels if not panel.is_part}
    for side in expected.sides:
        other = expected.sides[side.partner]
        apart = dist(side.middle, other.middle) > TUBE_SHARE * expected.panels[side.panel].size
        if other.panel == side.panel and side.panel in whole and apart:
            return EncodeError(
                f"panel {quoted(side.panel)} is sewn to itself to a tube, which does not lie flat; "
                "cut it into a front and a back panel",
                remedy="pattern",
            )
    if error.remedy == "either" or not tried:
        return error
    return EncodeError(f"{error}; nor does it fit a grid of {' or '.join(map(str, tried))}")


class _Kept:
    """Layouts, drawn when first asked for and kept for the next grid."""

    def __init__(self, source: Iterator[Layout]) -> None:
        self._source = source
        self._drawn: list[Layout] = []

    def __iter__(self) -> Iterator[Layout]:
        yield from self._drawn
        for layout in self._source:
            self._drawn.append(layout)
            yield layout


def _encode(
    pattern: Pattern, expected: StitchGraph | None, layouts_: _Kept, frame: BodyFrame
) -> GarmentImage:
    """The first image that brings the pattern back; without its graph, that keeps its shapes.

    Bends for which the grid has too few edges are bowed, but only where no drawing of the same
    layout has more.
    """
    first: EncodeError | None = None
    for layout, attempts in trials(layouts_):
        drawn: list[list[Path]] = []
        for paths in drawings(layout, frame, attempts):
            try:
                if isinstance(paths, EncodeError):
                    raise paths
                image = _image(pattern, layout.graph, paths, frame)
                drawn.append(paths)
                reason = lost_shape(layout.graph, paths)
                if not reason and expected is not None:
                    reason = disproof(pattern, expected, image).reason
                if not reason:
                    return image
                raise EncodeError(reason)
            except EncodeError as error:
                first = first or error
        if expected is None:
            continue
        for paths in drawn:
            found = _bowed_image(pattern, expected, layout.graph, paths, frame)
            if found is not None:
                return found
    raise first or EncodeError("the pattern has no layout")


def _bowed_image(
    pattern: Pattern,
    expected: StitchGraph,
    graph: SeamGraph,
    paths: list[Path],
    frame: BodyFrame,
) -> GarmentImage | None:
    """The image of a drawing whose bends are bowed until it brings the pattern back, if it does.

    Where an edge has too few grid edges, the chords between its points are shorter than it is.
    Points farther off its chord make up for that: seams keep their lengths, panels lose a little
    of their shape.
    """
    bows: Bows = {}
    for _ in range(BOWINGS):
        image = _image(pattern, graph, paths, frame, bows)
        found = disproof(pattern, expected, image)
        if not found.reason:
            return image
        if not found.bows:
            return None
        bows |= {side: bows.get(side, 1.0) * bow for side, bow in found.bows.items()}
    return None


def _image(
    pattern: Pattern,
    graph: SeamGraph,
    paths: list[Path],
    frame: BodyFrame,
    bows: Bows | None = None,
) -> GarmentImage:
    panels = graph.placed.panels
    edge_type = _edge_types(graph, paths, frame.grid)
    owner = _fill_panels(graph, paths, frame.grid)
    _check_clusters(graph, owner, edge_type)
    deformation = np.zeros((2, 4, 2, frame.grid, frame.grid), np.float32)
    marks = []
    for i, panel in enumerate(panels):
        mask = owner[panel.layer] == i
        target = deformation[panel.layer]
        _deform(graph, i, paths, mask, edge_type[panel.layer], frame, target, bows or {})
        marks.append(_mark(pattern, panel, mask, _divisions(graph, i, paths)))
    return GarmentImage(
        inside=owner >= 0,
        edge_type=edge_type,
        deformation=deformation,
        frame=frame,
        marks=tuple(marks),
        name=pattern.name,
    )


def _edge_types(graph: SeamGraph, paths: list[Path], grid: int) -> np.ndarray:
    """Types of the grid edges, straight from the arcs; [layer, bottom or left, row, col]."""
    types = np.full((2, 2, grid, grid), EdgeType.NON_BOUNDARY, np.int8)
    for arc, path in zip(graph.arcs, paths, strict=True):
        corner = np.minimum(path[:-1], path[1:])
        upright = (path[:-1, 0] == path[1:, 0]).astype(int)
        for layer in arc.layers:
            types[layer, upright, corner[:, 1], corner[:, 0]] = arc.kind
    return types


def _fill_panels(graph: SeamGraph, paths: list[Path], grid: int) -> np.ndarray:
    """The panel of each cell, -1 outside; [layer, row, col].

    Raises:
        EncodeError: a panel without cells, or two panels on one cell.
    """
    owner = np.full((2, grid, grid), -1)
    panels = graph.placed.panels
    for i, panel in enumerate(panels):
        crossed = np.zeros((grid, grid + 1), int)
        for k in range(len(panel.curves)):
            arc, _ = graph.owner[i, k]
            if graph.arcs[arc].slit:
                continue
            path = paths[arc]
            upright = path[:-1, 0] == path[1:, 0]
            rows = np.minimum(path[:-1, 1], path[1:, 1])[upright]
            np.add.at(crossed, (rows, path[:-1, 0][upright]), 1)
        mask = (np.cumsum(crossed, axis=1) % 2)[:, :grid].astype(bool)
        if not mask.any():
            raise EncodeError(f"panel {panel.source!r} is too small for the grid")
        taken = owner[panel.layer][mask]
        if (taken >= 0).any():
            other = panels[int(taken.max())].source
            raise EncodeError(
                f"panels {panel.source!r} and {other!r} lie on top of each other; "
                "one of them needs a second cloth layer",
                remedy="either",
            )
        owner[panel.layer][mask] = i
    return owner


def _check_clusters(graph: SeamGraph, owner: np.ndarray, edge_type: np.ndarray) -> None:
    """Every panel must be one cluster of its own, as decoding will see it."""
    labels, count = label_panels(owner >= 0, edge_type)
    pairs = {(int(a), int(b)) for a, b in zip(owner[owner >= 0], labels[owner >= 0], strict=True)}
    if not len(pairs) == count == len(graph.placed.panels):
        panels = graph.placed.panels
        parts = [a for a, _ in pairs]
        torn = next((a for a in parts if parts.count(a) > 1), 0)
        raise EncodeError(f"panel {panels[torn].source!r} does not stay in one piece on the grid")


def _deform(
    graph: SeamGraph,
    index: int,
    paths: list[Path],
    mask: np.ndarray,
    edge_type: np.ndarray,
    frame: BodyFrame,
    out: np.ndarray,
    bows: Bows,
) -> None:
    """Edge vectors of one panel's cells into `out` [4, 2, row, col] (paper, Eq. 1)."""
    panel = graph.placed.panels[index]
    mesh = cell_mesh(mask, edge_type)
    number = np.full(mask.shape, -1)
    number[mesh.cells[:, 0], mesh.cells[:, 1]] = np.arange(len(mesh.cells))
    target = np.full((mesh.vertex_count, 2), np.nan)
    for loop_number, loop in enumerate(panel.loops):
        outline = np.concatenate([panel.curves[k][:-1] for k in loop])
        cloth_left = (signed_area(outline) > 0) == (loop_number == 0)
        for k in loop:
            arc, back = graph.owner[index, k]
            path = paths[arc][::-1] if back else paths[arc]
            points = resample(panel.curves[k], np.linspace(0, 1, len(path)))
            if bow := bows.get((panel.source, panel.origin[k])):
                points = bowed(points, bow)
            vertices = _boundary_vertices(path, cloth_left, number, mesh.corner_ids)
            if vertices is None:
                raise EncodeError(f"panel {panel.source!r} is turned inside out on the grid")
            target[vertices[:, 0]] = points[:-1]
            target[vertices[:, 1]] = points[1:]
    pinned = np.flatnonzero(~np.isnan(target[:, 0]))
    rest = frame.to_body(mesh.lattice)
    bl, br, tr, tl = mesh.corner_ids.T
    sides = ((bl, br), (br, tr), (tl, tr), (bl, tl))
    edges = np.unique(np.concatenate([np.stack(s, axis=1) for s in sides]), axis=0)
    where = deform_quad_mesh(rest, edges, pinned, target[pinned])
    rows, cols = mesh.cells.T
    for k, (start, end) in enumerate(sides):
        out[k, :, rows, cols] = where[end] - where[start]


def _boundary_vertices(
    path: Path, cloth_left: bool, number: np.ndarray, corner_ids: np.ndarray
) -> np.ndarray | None:
    """Mesh vertices [step, 2] at both ends of each step of a path, on its cloth side."""
    cell = _cloth_cells(path, cloth_left)
    if (cell < 0).any() or (cell >= len(number)).any():
        return None
    index = number[cell[:, 1], cell[:, 0]]
    if (index < 0).any():
        return None
    corner_of = np.array([[0, 3], [1, 2]])  # [dx, dy] -> bl, tl, br, tr
    ends = []
    for at in (path[:-1], path[1:]):
        offset = at - cell
        ends.append(corner_ids[index, corner_of[offset[:, 0], offset[:, 1]]])
    return np.stack(ends, axis=1)


def _cloth_cells(path: Path, cloth_left: bool) -> np.ndarray:
    """(column, row) of the cell on the cloth side of each step of a path."""
    step = path[1:] - path[:-1]
    normal = np.stack([-step[:, 1], step[:, 0]], axis=1) * (1 if cloth_left else -1)
    # Twice the middle of the step plus the normal is twice the cell's centre.
    return np.asarray((path[1:] + path[:-1] + normal - 1) // 2)


def _divisions(graph: SeamGraph, index: int, paths: list[Path]) -> tuple[Division, ...]:
    """Vertices of a panel that lie inside its joined edges."""
    panel = graph.placed.panels[index]
    joined = graph.placed.joined.get(panel.source, ())
    if not joined:
        return ()
    vertices = np.array(joined) @ panel.matrix.T + panel.offset
    found = []
    for loop_number, loop in enumerate(panel.loops):
        outline = np.concatenate([panel.curves[k][:-1] for k in loop])
        cloth_left = (signed_area(outline) > 0) == (loop_number == 0)
        for k in loop:
            shares = shares_along(panel.curves[k], vertices)
            arc, back = graph.owner[index, k]
            path = paths[arc][::-1] if back else paths[arc]
            found += divisions_on(path, _cloth_cells(path, cloth_left), shares)
    return tuple(found)


def _mark(
    pattern: Pattern, panel: PlacedPanel, mask: np.ndarray, divisions: tuple[Division, ...]
) -> PanelMark:
    """What decoding may know of the panel's name and own frame."""
    source = pattern.by_name[panel.source]
    middle = (centroid(panel.outline) - panel.offset) @ panel.matrix
    row, col = np.argwhere(mask)[0]
    (a, b), (c, d) = panel.matrix.tolist()
    return PanelMark(
        name=panel.name,
        layer=panel.layer,
        cell=(int(row), int(col)),
        matrix=((a, b), (c, d)),
        anchor=(float(middle[0]), float(middle[1])),
        rotation=source.rotation,
        translation=source.translation,
        split_of=panel.source if panel.is_part else None,
        label=source.label,
        grain=source.grain,
        divisions=divisions,
    )
