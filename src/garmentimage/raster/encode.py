"""Encoding: a sewing pattern becomes a GarmentImage (paper, Section 3.2).

The garment is placed and laid out in the plane with every seam coincident, drawn on a fine
lattice with arcs that share no vertex, and compacted to the image's lattice. Each step keeps the
drawing valid, so the image is valid by construction: every panel one disk of cells, both sides of
a seam the same grid edges.
"""

from collections.abc import Iterator
from itertools import islice
from numbers import Integral

import numpy as np

from garmentimage.errors import EncodeError, check_type, quoted
from garmentimage.geometry.polygons import centroid, resample, signed_area
from garmentimage.pattern.model import Pattern
from garmentimage.raster.canonical import canonical
from garmentimage.raster.cells import cell_mesh, label_panels
from garmentimage.raster.compact import compact
from garmentimage.raster.complex import SeamComplex, seam_complex
from garmentimage.raster.deform import deform_quad_mesh
from garmentimage.raster.divisions import divisions_on, shares_along
from garmentimage.raster.drawing import (
    MOST_NEEDED,
    Drawing,
    Path,
    drawing_of,
    joined_links,
    with_bends,
    with_links,
)
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import Division, EdgeType, GarmentImage, PanelMark
from garmentimage.raster.layout import Layout, layouts
from garmentimage.raster.place import PlacedPanel, place
from garmentimage.raster.polish import polish
from garmentimage.raster.route import FinePaths, route
from garmentimage.raster.shapes import check_shapes
from garmentimage.raster.symmetry import find_mirror, halve

GRIDS = (8, 128)
"""Smallest and largest grid that can be encoded to."""
FINE_CELLS = 128
"""Fine lattice steps across the grid in the first attempt."""
Attempts = tuple[tuple[float, float, bool], ...]
ATTEMPTS: Attempts = ((1.0, 5.0, True), (1.5, 9.0, True), (2.0, 16.0, True))
"""(factor on the fine lattice, corridor in fine steps, arcs leave their nodes in the order that
their targets have), tried in turn."""
LAST_ATTEMPTS: Attempts = ((1.5, 9.0, False),)
"""What is left to try when all layouts have failed ..."""
LAST_LAYOUTS = 3
"""... on so many of them."""
PASSES = 3
"""Rounds of compaction along x, then y; the limits of the grid must hold in the last."""
SLIT_CM = 1.0
"""Free edges shorter than this [cm] are pointed out where a garment cannot be drawn."""
LARGER_GRIDS = (32, 64)
"""Grids that are tried to say which one would do."""


def encode(pattern: Pattern, grid: int = 16, *, frame: BodyFrame | None = None) -> GarmentImage:
    """Draw a sewing pattern on the grid.

    Args:
        pattern: the garment; placement decides which layer a panel lies on.
        grid: cells along each side, N.
        frame: where the grid lies on the body; default: the standard frame of this grid, which
            is what makes images of different garments comparable.

    Returns:
        A valid image, the same for the same pattern every time.

    Raises:
        PatternError: the pattern is not sound.
        EncodeError: it does not fit; says what is in the way and which grid would do.
        TypeError: the garment is no Pattern, or the grid no whole number.
    """
    check_type(pattern, Pattern, "load_pattern(path) reads one from a file")
    check_type(grid, Integral, "give the number of cells along each side")
    if not GRIDS[0] <= grid <= GRIDS[1] or grid % 2:
        raise EncodeError(f"grid is {grid}; wanted an even number from {GRIDS[0]} to {GRIDS[1]}")
    layouts_ = _Kept(layouts(seam_complex(place(pattern))))
    if frame is not None:
        return _encode(pattern, layouts_, frame)
    try:
        return _encode(pattern, layouts_, BodyFrame.standard(grid))
    except EncodeError as error:
        tried = [larger for larger in LARGER_GRIDS if larger > grid]
        for larger in tried:
            try:
                _encode(pattern, layouts_, BodyFrame.standard(larger))
            except EncodeError:
                continue
            raise EncodeError(
                f"{error}; it fits a grid of {larger}: --grid {larger}, or grid={larger} in Python",
                grid=larger,
            ) from None
        if not tried:
            raise
        raise EncodeError(
            f"{error}; nor does it fit a grid of {' or '.join(map(str, tried))}"
        ) from None


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


def _encode(pattern: Pattern, layouts_: _Kept, frame: BodyFrame) -> GarmentImage:
    first: EncodeError | None = None
    for layout, attempts in _trials(layouts_):
        for paths in _drawings(layout, frame, attempts):
            if isinstance(paths, EncodeError):
                first = first or paths
                continue
            try:
                return _image(pattern, layout.complex, paths, frame)
            except EncodeError as error:
                first = first or error
    raise first or EncodeError("the pattern has no layout")


def _trials(layouts_: _Kept) -> Iterator[tuple[Layout, Attempts]]:
    """Layouts with the attempts to draw each, most promising first."""
    for number, layout in enumerate(layouts_):
        yield layout, ATTEMPTS if number == 0 else ATTEMPTS[:2]
    for layout in islice(layouts_, LAST_LAYOUTS):
        yield layout, LAST_ATTEMPTS


def _drawings(
    layout: Layout, frame: BodyFrame, attempts: Attempts
) -> Iterator[list[Path] | EncodeError]:
    """Lattice paths of the arcs, best attempt first; failures as they come."""
    whole = drawing_of(layout, frame)
    mirror = find_mirror(layout) if frame.is_symmetric else None
    half = halve(whole, mirror) if mirror is not None else None
    for part in (half, None) if half is not None else (None,):
        for factor, radius, in_order in attempts:
            fine = max(int(FINE_CELLS * factor) // frame.grid, 2)
            try:
                drawing = whole if part is None else part.drawing
                paths = joined_links(drawing, lattice_paths(drawing, fine, radius, in_order))
                yield paths if part is None else part.unfold(paths)
            except EncodeError as error:
                yield EncodeError(f"{error}{_crossing(layout)}")


def _crossing(layout: Layout) -> str:
    """For a message: the panels of two seams that cross when the garment is laid flat, if any."""
    import shapely

    arcs, panels = layout.complex.arcs, layout.complex.placed.panels
    lines = [shapely.LineString(curve) for curve in layout.curves]
    pairs = shapely.STRtree(lines).query(lines, predicate="intersects").T
    for i, j in sorted(map(tuple, pairs.tolist())):
        a, b = arcs[i], arcs[j]
        if i < j and set(a.layers) & set(b.layers) and not {a.a, a.b} & {b.a, b.b}:
            names = sorted({panels[side[0]].source for side in (*a.sides, *b.sides)})
            return (
                f" (laid flat, seams of panels {', '.join(map(quoted, names))} cross; leave a "
                "panel out or check where it is placed)"
            )
    return _slit(layout.complex)


def _slit(complex_: SeamComplex) -> str:
    """For a message: the shortest free edge, where it is too short to be meant for an opening."""
    lengths: dict[tuple[int, frozenset[int]], float] = {}
    for arc in complex_.arcs:
        if arc.kind == EdgeType.NON_STITCH:
            # The halves of an edge that closes on itself are one opening.
            opening = arc.sides[0][0], frozenset((arc.a, arc.b))
            lengths[opening] = lengths.get(opening, 0.0) + arc.length
    length, panel = min(
        ((size, panel) for (panel, _), size in lengths.items()), default=(SLIT_CM, 0)
    )
    if length >= SLIT_CM:
        return ""
    return (
        f" (panel {quoted(complex_.placed.panels[panel].source)} has a free edge of only "
        f"{length:.2g} cm; a grid has no room for so small an opening: sew it, or leave it out)"
    )


def lattice_paths(drawing: Drawing, fine: int, radius: float, in_order: bool = True) -> list[Path]:
    """Paths of the arcs on the image's lattice, grid lines 1 to N - 1, disjoint inside a layer.

    Raises:
        EncodeError: the drawing is too crowded for this lattice.
    """
    seen = canonical(drawing)
    plain = with_links(seen.drawing)
    drawn = route(plain, fine, radius, in_order)
    for most in MOST_NEEDED:
        linked = with_bends(plain, most)
        state = _compacted(linked, drawn)
        if state is not None:
            paths = polish(linked, state, 1, drawing.grid - 1)
            return seen.restore(joined_links(linked, paths))
    raise EncodeError(f"its panels do not all fit on a grid of {drawing.grid}")


def _compacted(drawing: Drawing, drawn: FinePaths) -> list[Path] | None:
    """The fine paths on the image's lattice, or None when there is no room."""
    low, high = 1, drawing.grid - 1
    state = drawn.paths, drawn.wanted
    for turn in range(PASSES):
        for along in (0, 1):
            moved = compact(drawing, *state, along, low, high)
            if moved is None and turn < PASSES - 1:
                moved = compact(drawing, *state, along, low, high, bounded=False)
            if moved is None:
                return None
            state = moved
    return state[0]


def _image(
    pattern: Pattern, complex_: SeamComplex, paths: list[Path], frame: BodyFrame
) -> GarmentImage:
    panels = complex_.placed.panels
    edge_type = _edge_types(complex_, paths, frame.grid)
    check_shapes(complex_, paths)
    owner = _fill_panels(complex_, paths, frame.grid)
    _check_clusters(complex_, owner, edge_type)
    deformation = np.zeros((2, 4, 2, frame.grid, frame.grid), np.float32)
    marks = []
    for i, panel in enumerate(panels):
        mask = owner[panel.layer] == i
        _deform(complex_, i, paths, mask, edge_type[panel.layer], frame, deformation[panel.layer])
        marks.append(_mark(pattern, panel, mask, _divisions(complex_, i, paths)))
    return GarmentImage(
        inside=owner >= 0,
        edge_type=edge_type,
        deformation=deformation,
        frame=frame,
        marks=tuple(marks),
        name=pattern.name,
    )


def _edge_types(complex_: SeamComplex, paths: list[Path], grid: int) -> np.ndarray:
    """Types of the grid edges, straight from the arcs; [layer, bottom or left, row, col]."""
    types = np.full((2, 2, grid, grid), EdgeType.NON_BOUNDARY, np.int8)
    for arc, path in zip(complex_.arcs, paths):
        corner = np.minimum(path[:-1], path[1:])
        upright = (path[:-1, 0] == path[1:, 0]).astype(int)
        for layer in arc.layers:
            types[layer, upright, corner[:, 1], corner[:, 0]] = arc.kind
    return types


def _fill_panels(complex_: SeamComplex, paths: list[Path], grid: int) -> np.ndarray:
    """The panel of each cell, -1 outside; [layer, row, col].

    Raises:
        EncodeError: a panel without cells, or two panels on one cell.
    """
    owner = np.full((2, grid, grid), -1)
    panels = complex_.placed.panels
    for i, panel in enumerate(panels):
        crossed = np.zeros((grid, grid + 1), int)
        for k in range(len(panel.curves)):
            arc, _ = complex_.owner[i, k]
            if complex_.arcs[arc].slit:
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
                "one of them needs a second cloth layer"
            )
        owner[panel.layer][mask] = i
    return owner


def _check_clusters(complex_: SeamComplex, owner: np.ndarray, edge_type: np.ndarray) -> None:
    """Every panel must be one cluster of its own, as decoding will see it."""
    labels, count = label_panels(owner >= 0, edge_type)
    pairs = {(int(a), int(b)) for a, b in zip(owner[owner >= 0], labels[owner >= 0])}
    if not len(pairs) == count == len(complex_.placed.panels):
        panels = complex_.placed.panels
        parts = [a for a, _ in pairs]
        torn = next((a for a in parts if parts.count(a) > 1), 0)
        raise EncodeError(f"panel {panels[torn].source!r} does not stay in one piece on the grid")


def _deform(
    complex_: SeamComplex,
    index: int,
    paths: list[Path],
    mask: np.ndarray,
    edge_type: np.ndarray,
    frame: BodyFrame,
    out: np.ndarray,
) -> None:
    """Edge vectors of one panel's cells into `out` [4, 2, row, col] (paper, Eq. 1)."""
    panel = complex_.placed.panels[index]
    mesh = cell_mesh(mask, edge_type)
    number = np.full(mask.shape, -1)
    number[mesh.cells[:, 0], mesh.cells[:, 1]] = np.arange(len(mesh.cells))
    target = np.full((mesh.vertex_count, 2), np.nan)
    for loop_number, loop in enumerate(panel.loops):
        outline = np.concatenate([panel.curves[k][:-1] for k in loop])
        cloth_left = (signed_area(outline) > 0) == (loop_number == 0)
        for k in loop:
            arc, back = complex_.owner[index, k]
            path = paths[arc][::-1] if back else paths[arc]
            points = resample(panel.curves[k], np.linspace(0, 1, len(path)))
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
    return (path[1:] + path[:-1] + normal - 1) // 2


def _divisions(complex_: SeamComplex, index: int, paths: list[Path]) -> tuple[Division, ...]:
    """Vertices of a panel that lie inside its joined edges."""
    panel = complex_.placed.panels[index]
    joined = complex_.placed.joined.get(panel.source, ())
    if not joined:
        return ()
    vertices = np.array(joined) @ panel.matrix.T + panel.offset
    found = []
    for loop_number, loop in enumerate(panel.loops):
        outline = np.concatenate([panel.curves[k][:-1] for k in loop])
        cloth_left = (signed_area(outline) > 0) == (loop_number == 0)
        for k in loop:
            shares = shares_along(panel.curves[k], vertices)
            arc, back = complex_.owner[index, k]
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
        split_of=panel.source if panel.half else None,
        label=source.label,
        grain=source.grain,
        divisions=divisions,
    )
