"""Rasterizing: the image of a drawing, cell by cell (paper, Section 3.2).

Edge types come straight from the paths of arcs, the cells of a panel are those inside its paths,
and the deformation of the cells is that of the quad mesh over them, pulled onto the panel's
boundary (Eq. 1).
"""

from collections.abc import Iterator, Set
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int, Integer

from garmentimage.errors import EncodeError
from garmentimage.geometry import centroid, resample, signed_area
from garmentimage.pattern import Pattern
from garmentimage.raster.cells import CellMesh, cell_mesh, label_panels
from garmentimage.raster.decode import divisions_on, shares_along
from garmentimage.raster.encode.deform import deform_quad_mesh
from garmentimage.raster.encode.lattice import Path
from garmentimage.raster.encode.layout import SeamGraph
from garmentimage.raster.encode.placement import PlacedPanel
from garmentimage.raster.encode.proof import Bows, bowed
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import (
    Division,
    EdgeType,
    GarmentImage,
    PanelMark,
    default_layer_names,
)

EdgeTypes = Integer[np.ndarray, "layer 2 row col"]
"""`EdgeType` of the bottom and left grid edge of every cell."""


@dataclass(frozen=True)
class _Drawn:
    """A seam graph with a lattice path for each arc."""

    graph: SeamGraph
    paths: list[Path]
    frame: BodyFrame
    bows: Bows
    """Edges that are bent more than they are, see `proof.Bows`."""

    def edges(self, index: int) -> Iterator[tuple[int, Path, Int[np.ndarray, "_ 2"]]]:
        """Edges of a panel, the path of each in its direction, and the cloth's cells beside it."""
        panel = self.graph.placed.panels[index]
        for number, loop in enumerate(panel.loops):
            # Cloth lies inside the outer loop, and outside holes.
            outline = np.concatenate([panel.curves[k][:-1] for k in loop])
            cloth_left = (signed_area(outline) > 0) == (number == 0)
            for k in loop:
                path = self.graph.along(self.paths, index, k)
                yield k, path, _cloth_cells(path, cloth_left)


def rasterize(
    pattern: Pattern,
    graph: SeamGraph,
    paths: list[Path],
    frame: BodyFrame,
    bows: Bows | None = None,
) -> GarmentImage:
    """The image of a drawing.

    Args:
        pattern: the garment, for the marks of its panels.
        graph: its seam graph.
        paths: for each arc a lattice path, vertex-disjoint inside a layer.
        frame: where the grid lies on the body.
        bows: edges to be bent more than they are.

    Raises:
        EncodeError: a panel without cells or not in one piece, or two panels on one cell.
    """
    drawn = _Drawn(graph, paths, frame, bows or {})
    edge_type = _edge_types(drawn)
    owner = _fill_panels(drawn)
    _check_clusters(graph, owner, edge_type)
    layers = graph.placed.layer_count
    deformation = np.zeros((layers, 4, 2, frame.grid, frame.grid), np.float32)
    marks = []
    for i, panel in enumerate(graph.placed.panels):
        if i in graph.placed.whole:
            continue
        mask = owner[panel.layer] == i
        _deform(drawn, i, mask, edge_type[panel.layer], deformation[panel.layer])
        middle = graph.placed.middles.get(panel.source)
        if middle is None or panel.is_part:
            middle = (centroid(panel.outline) - panel.offset) @ panel.matrix
        marks.append(_mark(pattern, panel, mask, middle, _divisions(drawn, i)))
    return GarmentImage(
        inside=owner >= 0,
        edge_type=edge_type,
        deformation=deformation,
        frame=frame,
        layer_names=default_layer_names(layers),
        marks=tuple(marks),
        name=pattern.name,
    )


def with_turned(image: GarmentImage, pattern: Pattern, turned: Set[str]) -> GarmentImage:
    """The image of a garment that was laid open, its turned panels noted.

    Args:
        image: of the garment laid open.
        pattern: as it was before.
        turned: names of the panels whose wrong side is out.
    """
    labels, _ = label_panels(image.inside, image.edge_type)
    flags = np.zeros_like(image.inside)
    marks = []
    for mark in image.marks:
        source = pattern.by_name.get(mark.split_of or mark.name)
        if source is not None and source.name in turned:
            flags |= labels == labels[mark.layer, *mark.cell]
            mark = replace(mark, rotation=source.rotation, translation=source.translation)
        marks.append(mark)
    return replace(image, turned=flags, marks=tuple(marks))


def _edge_types(drawn: _Drawn) -> EdgeTypes:
    """Types of the grid edges, straight from the arcs."""
    grid = drawn.frame.grid
    layers = drawn.graph.placed.layer_count
    types = np.full((layers, 2, grid, grid), EdgeType.NON_BOUNDARY, np.int8)
    for arc, path in zip(drawn.graph.arcs, drawn.paths, strict=True):
        corner = np.minimum(path[:-1], path[1:])
        upright = (path[:-1, 0] == path[1:, 0]).astype(int)
        # Inside a panel the cloth goes on; only the pocket on it has an edge there.
        for layer in arc.layers[1:] if arc.is_inner else arc.layers:
            types[layer, upright, corner[:, 1], corner[:, 0]] = arc.kind
    return types


def _fill_panels(drawn: _Drawn) -> Int[np.ndarray, "layer row col"]:
    """The panel of each cell, -1 outside.

    By the even-odd rule: a cell is inside where its row has crossed the panel's upright grid edges
    an odd number of times. Darts, whose legs are one path, leave nothing out.
    """
    graph, grid = drawn.graph, drawn.frame.grid
    owner = np.full((graph.placed.layer_count, grid, grid), -1)
    panels = graph.placed.panels
    for i, panel in enumerate(panels):
        crossed = np.zeros((grid, grid + 1), int)
        for k in range(len(panel.curves)):
            if not graph.arc(i, k).slit:
                path = graph.along(drawn.paths, i, k)
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
                'where one lies on the other\'s cloth, give it "cloth_layer": 1',
                remedy="either",
            )
        owner[panel.layer][mask] = i
    for hidden, base in graph.placed.whole.items():
        owner[owner == hidden] = base
    return owner


def _check_clusters(
    graph: SeamGraph, owner: Int[np.ndarray, "layer row col"], edge_type: EdgeTypes
) -> None:
    """Every panel must be one cluster of its own, as decoding will see it."""
    inside = owner >= 0
    labels, count = label_panels(inside, edge_type)
    pairs = set(zip(owner[inside].tolist(), labels[inside].tolist(), strict=True))
    if not len(pairs) == count == len(graph.placed.panels) - len(graph.placed.whole):
        panels = graph.placed.panels
        parts = [a for a, _ in pairs]
        torn = next((a for a in parts if parts.count(a) > 1), 0)
        raise EncodeError(f"panel {panels[torn].source!r} is not in one piece on the grid")


def _deform(
    drawn: _Drawn,
    index: int,
    mask: Bool[np.ndarray, "row col"],
    edge_type: Integer[np.ndarray, "2 row col"],
    out: Float[np.ndarray, "4 2 row col"],
) -> None:
    """Edge vectors of one panel's cells into `out` (paper, Eq. 1)."""
    mesh = cell_mesh(mask, edge_type)
    target = _boundary_targets(drawn, index, mask, mesh)
    pinned = np.flatnonzero(~np.isnan(target[:, 0]))
    rest = drawn.frame.to_body(mesh.lattice)
    bl, br, tr, tl = mesh.corner_ids.T
    sides = ((bl, br), (br, tr), (tl, tr), (bl, tl))
    edges = np.unique(np.concatenate([np.stack(s, axis=1) for s in sides]), axis=0)
    where = deform_quad_mesh(rest, edges, pinned, target[pinned])
    rows, cols = mesh.cells.T
    for k, (start, end) in enumerate(sides):
        out[k, :, rows, cols] = where[end] - where[start]


def _boundary_targets(
    drawn: _Drawn, index: int, mask: Bool[np.ndarray, "row col"], mesh: CellMesh
) -> Float[np.ndarray, "vertex 2"]:
    """Where the vertices of a panel's mesh must lie on its boundary [cm]; NaN inside.

    The vertices along an edge are spread evenly by length.
    """
    # Numbers of the cells, in a rim of cells off the grid, which are none.
    number = np.full(np.add(mask.shape, 2), -1)
    number[1:-1, 1:-1][mask] = np.arange(len(mesh.cells))
    parts = [index, *(k for k, base in drawn.graph.placed.whole.items() if base == index)]
    corner_of = np.array([[0, 3], [1, 2]])  # [dx, dy] -> bl, tl, br, tr
    target = np.full((mesh.vertex_count, 2), np.nan)
    for number_of_part, (k, path, cell) in ((n, each) for n in parts for each in drawn.edges(n)):
        panel = drawn.graph.placed.panels[number_of_part]
        points = resample(panel.curves[k], np.linspace(0, 1, len(path)))
        if bow := drawn.bows.get((panel.source, panel.origin[k])):
            points = bowed(points, bow)
        beside = number[cell[:, 1] + 1, cell[:, 0] + 1]
        if (beside < 0).any():
            raise EncodeError(f"panel {panel.source!r} is turned inside out on the grid")
        for ends, there in ((path[:-1], points[:-1]), (path[1:], points[1:])):
            dx, dy = (ends - cell).T
            target[mesh.corner_ids[beside, corner_of[dx, dy]]] = there
    return target


def _cloth_cells(path: Path, cloth_left: bool) -> Int[np.ndarray, "step 2"]:
    """(column, row) of the cell on the cloth side of each step of a path."""
    step = path[1:] - path[:-1]
    normal = np.stack([-step[:, 1], step[:, 0]], axis=1) * (1 if cloth_left else -1)
    # Twice the middle of the step plus the normal is twice the cell's centre.
    return np.asarray((path[1:] + path[:-1] + normal - 1) // 2)


def _divisions(drawn: _Drawn, index: int) -> tuple[Division, ...]:
    """Vertices of a panel that lie inside its joined edges."""
    placed = drawn.graph.placed
    panel = placed.panels[index]
    joined = placed.joined.get(panel.source, ())
    if not joined:
        return ()
    vertices = np.array(joined) @ panel.matrix.T + panel.offset
    return tuple(
        division
        for k, path, cells in drawn.edges(index)
        for division in divisions_on(path, cells, shares_along(panel.curves[k], vertices))
    )


def _mark(
    pattern: Pattern,
    panel: PlacedPanel,
    mask: Bool[np.ndarray, "row col"],
    middle: Float[np.ndarray, " 2"],
    divisions: tuple[Division, ...],
) -> PanelMark:
    """The panel's name and own frame, its middle there at `middle` [cm], for decoding."""
    source = pattern.by_name[panel.source]
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
