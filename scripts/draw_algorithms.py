"""Draw the pictures of the pages on concepts and algorithms, from bundled patterns.

    python scripts/draw_algorithms.py [FOLDER] [--only encode channels frame decode repair drape]

Every picture shows what the package computes, taken from its own functions step by step.
"""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

import garmentimage as gi
from garmentimage.drape.mesh import mesh
from garmentimage.drape.solver import SolverSettings
from garmentimage.drape.start import place_on_body, start_points
from garmentimage.examples import example_path
from garmentimage.pattern import Pattern, without_stubs
from garmentimage.raster import EDGE_TYPE_COUNT, BodyFrame, EdgeType, GarmentImage
from garmentimage.raster.cells import CellMesh, cell_mesh, half_edges, label_panels
from garmentimage.raster.encode.lattice.canonical import canonical
from garmentimage.raster.encode.lattice.drawing import drawing_of, with_links
from garmentimage.raster.encode.lattice.route import route
from garmentimage.raster.encode.layout import Layout, build_seam_graph, layouts
from garmentimage.raster.encode.placement import Placed, place
from garmentimage.render.flat import draw_image, draw_pattern
from garmentimage.render.style import (
    FAINT,
    GRID_LINE,
    INK,
    LAYER_TINTS,
    PAPER,
    SEAM_COLOURS,
    TYPE_COLOURS,
    TYPE_NAMES,
)

OUT = Path(__file__).parents[1] / "docs" / "images"
GRID = 16
FINE = 8
"""Steps of the fine lattice in a cell, as in the first attempt of `encode`."""
CORRIDOR = 5.0
"""How far a path may leave its target in that attempt [fine steps]."""
DPI = 130
PIXELS = 420
"""Rows of a photograph."""
FREE_FRAMES = 8
"""Frames after which the drape is photographed on its way."""
RED = "#cc2222"
FULL = (-5.0, 5.0)
"""Mean logit of the certain numbers of the repaired image."""


def board(ax: Axes, frame: BodyFrame | None = None, grid: int = GRID) -> None:
    """Grid lines: those of the body frame [cm], or one unit each."""
    xs = np.array(frame.columns) if frame else np.arange(grid + 1)
    ys = np.array(frame.rows) if frame else np.arange(grid + 1)
    lines = [[(x, ys[0]), (x, ys[-1])] for x in xs] + [[(xs[0], y), (xs[-1], y)] for y in ys]
    ax.add_collection(LineCollection(lines, colors=GRID_LINE, linewidths=0.7, zorder=0))


def two_layers(title: str, size: tuple[float, float] = (9.4, 5.0)) -> tuple[Figure, list[Axes]]:
    """A figure with axes for the front and the back layer."""
    figure = Figure(figsize=size, facecolor=PAPER)
    axes = list(figure.subplots(1, 2))
    for ax, name in zip(axes, ("front", "back"), strict=True):
        ax.set_aspect("equal")
        ax.set_axis_off()
        ax.set_title(name, fontsize=9, color=FAINT)
    figure.suptitle(title, fontsize=11, color=INK, fontweight="bold")
    figure.subplots_adjust(0.01, 0.02, 0.99, 0.88, wspace=0.03)
    return figure, axes


def near_garment(ax: Axes) -> None:
    """Limits in which the dress is large [cm]."""
    ax.set_xlim(-75, 75)
    ax.set_ylim(45, 165)


def save(figure: Figure, out: Path) -> None:
    """Write a figure as PNG, without a date, so that the same picture has the same bytes."""
    figure.savefig(out, dpi=DPI, metadata={"Software": None})
    print(out)


PLAIN_TYPES = EdgeType.NON_STITCH, EdgeType.FRONT_TO_BACK, EdgeType.SIDE_BY_SIDE


def legend(figure: Figure, y: float = 0.035, kinds: Sequence[EdgeType] = PLAIN_TYPES) -> None:
    """Name the colours of edge types along the lower edge."""
    step = min(0.2, 0.9 / len(kinds))
    for k, kind in enumerate(kinds):
        x = 0.56 + step * (k - len(kinds) / 2)
        figure.add_artist(_stroke_of(figure, x, y, TYPE_COLOURS[kind]))
        figure.text(x + 0.05, y, TYPE_NAMES[kind], fontsize=8, color=INK, va="center")


def _stroke_of(figure: Figure, x: float, y: float, colour: str):
    from matplotlib.lines import Line2D

    return Line2D([x, x + 0.04], [y, y], color=colour, linewidth=2.5, transform=figure.transFigure)


def draw_arcs(
    ax: Axes,
    layout: Layout,
    curves: Sequence[Float[np.ndarray, "_ 2"]],
    layer: int,
    *,
    nodes: bool = True,
) -> None:
    """Arcs of one layer, coloured by what they become, and the nodes where they meet."""
    for arc, curve in zip(layout.graph.arcs, curves, strict=True):
        if layer not in arc.layers:
            continue
        sewn = arc.kind != EdgeType.NON_STITCH
        ax.plot(
            curve[:, 0],
            curve[:, 1],
            color=TYPE_COLOURS[arc.kind],
            linewidth=2.2 if sewn else 1.5,
            solid_capstyle="round",
            zorder=3,
        )
        if nodes:
            ends = curve[[0, -1]]
            ax.plot(ends[:, 0], ends[:, 1], "o", color=INK, markersize=3.2, zorder=4)


def encode_pictures(folder: Path) -> None:
    """Six steps from the pattern to the image."""
    pattern = gi.load_pattern(example_path("dress"))
    frame = BodyFrame.standard(GRID)
    figure = Figure(figsize=(8.6, 4.8), facecolor=PAPER)
    draw_pattern(pattern, figure.add_axes((0.01, 0.01, 0.98, 0.88)))
    figure.suptitle("1. The pattern", fontsize=11, color=INK, fontweight="bold")
    save(figure, folder / "encode-1-pattern.png")

    placed = place(pattern)
    save(_placement(placed, frame), folder / "encode-2-placement.png")

    layout = next(iter(layouts(build_seam_graph(placed))))
    figure, axes = two_layers("3. Layout: every seam is one curve")
    for layer, ax in enumerate(axes):
        board(ax, frame)
        draw_arcs(ax, layout, layout.curves, layer)
        near_garment(ax)
    legend(figure)
    save(figure, folder / "encode-3-layout.png")

    drawing = canonical(drawing_of(layout, frame))
    routed = route(with_links(drawing.drawing), FINE, CORRIDOR).paths
    paths = drawing.restore(list(routed[: len(drawing.drawing.arcs)]))
    figure, axes = two_layers(
        f"4. Routing on a lattice {FINE} times as fine: paths meet only in nodes"
    )
    for layer, ax in enumerate(axes):
        board(ax)
        fine = [np.asarray(path, float) / FINE for path in paths]
        draw_arcs(ax, layout, fine, layer, nodes=False)
    legend(figure)
    save(figure, folder / "encode-4-routing.png")

    image = gi.encode(pattern, grid=GRID)
    figure = Figure(figsize=(9.4, 5.6), facecolor=PAPER)
    draw_image(image, figure.add_axes((0.01, 0.01, 0.98, 0.88)))
    figure.suptitle(
        "5. Compaction to the grid of the image: flags and edge types",
        fontsize=11,
        color=INK,
        fontweight="bold",
    )
    save(figure, folder / "encode-5-compaction.png")
    save(_deformation(pattern, image), folder / "encode-6-deformation.png")


def _placement(placed: Placed, frame: BodyFrame) -> Figure:
    figure, axes = two_layers("2. Placement: layers and poses, arms stretched to the sides")
    for layer, ax in enumerate(axes):
        board(ax, frame)
        for k, panel in enumerate(placed.panels):
            if panel.layer != layer:
                continue
            outline = panel.outline
            ax.fill(*outline.T, color=LAYER_TINTS[layer], zorder=1)
            closed = np.concatenate([outline, outline[:1]])
            ax.plot(*closed.T, color=SEAM_COLOURS[k % len(SEAM_COLOURS)], linewidth=1.6, zorder=2)
            outer = np.sign(outline[:, 0].mean().round(3)) * 6.0
            x, y = outline.mean(axis=0) + np.array([outer, -12.0 if outer else 0.0])
            ax.text(x, y, panel.source, fontsize=6.5, color=INK, ha="center", va="center")
        near_garment(ax)
    return figure


def _deformation(pattern: Pattern, image: GarmentImage) -> Figure:
    """The quad mesh of each panel, deformed onto the panel's own outline."""
    labels, count = label_panels(image.inside, image.edge_type)
    figure = Figure(figsize=(9.4, 4.6), facecolor=PAPER)
    names = {}
    for mark in image.marks:
        names[int(labels[mark.layer, mark.cell[0], mark.cell[1]])] = mark
    shown = sorted(names, key=lambda k: (names[k].layer, names[k].name))[:count]
    for k, own in enumerate(shown):
        mark, layer = names[own], names[own].layer
        ax = figure.add_subplot(2, (count + 1) // 2, k + 1)
        cells = cell_mesh(labels[layer] == own, image.edge_type[layer])
        points = unfolded(image, layer, cells)
        quads = points[cells.corner_ids]
        ax.add_collection(
            PolyCollection(
                list(quads), facecolors=LAYER_TINTS[layer], edgecolors=FAINT, linewidths=0.6
            )
        )
        outline = pattern.by_name[mark.name].outline.polygon @ np.array(mark.matrix).T
        outline = outline - outline.mean(axis=0)
        shift = _middle_of(cells, image, layer, points) - _area_middle(outline)
        closed = np.concatenate([outline, outline[:1]]) + shift
        ax.plot(*closed.T, color=TYPE_COLOURS[EdgeType.FRONT_TO_BACK], linewidth=1.2)
        ax.set_title(mark.name, fontsize=8, color=INK)
        ax.set_aspect("equal")
        ax.autoscale_view()
        ax.set_axis_off()
    figure.suptitle(
        "6. Deformation: each panel's cells moved onto its outline (orange) with least change",
        fontsize=11,
        color=INK,
        fontweight="bold",
    )
    figure.subplots_adjust(0.01, 0.02, 0.99, 0.86)
    return figure


def _area_middle(polygon: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " 2"]:
    import shapely

    return np.array(shapely.Polygon(polygon).centroid.coords[0])


def _middle_of(
    cells: CellMesh, image: GarmentImage, layer: int, points: Float[np.ndarray, "vertex 2"]
) -> Float[np.ndarray, " 2"]:
    return _area_middle(outlines(cells, image, layer, points)[0])


def unfolded(image: GarmentImage, layer: int, cells: CellMesh) -> Float[np.ndarray, "vertex 2"]:
    """Vertices of a panel whose edges are the image's vectors, by least squares [cm]."""
    bl, br, tr, tl = cells.corner_ids.T
    rows, cols = cells.cells.T
    ends = [(bl, br), (br, tr), (tl, tr), (bl, tl)]
    count = 4 * len(rows)
    matrix = np.zeros((count + 1, cells.vertex_count))
    wanted = np.zeros((count + 1, 2))
    for side, (start, end) in enumerate(ends):
        at = np.arange(len(rows)) + side * len(rows)
        matrix[at, end] += 1
        matrix[at, start] -= 1
        wanted[at] = image.deformation[layer, side][:, rows, cols].T
    matrix[-1] = 1.0
    wanted[-1] = image.frame.to_body(cells.lattice.astype(float)).sum(axis=0)
    return np.linalg.lstsq(matrix, wanted, rcond=None)[0]


def outlines(
    cells: CellMesh, image: GarmentImage, layer: int, points: Float[np.ndarray, "vertex 2"]
) -> list[Float[np.ndarray, "_ 2"]]:
    """Boundary loops of a mesh, the longest first."""
    border = half_edges(cells, image.edge_type[layer])
    following = border.following.tolist()
    unseen = {k for k, after in enumerate(following) if after >= 0}
    found = []
    while unseen:
        chain = [min(unseen)]
        while following[chain[-1]] != chain[0]:
            chain.append(following[chain[-1]])
        unseen -= set(chain)
        found.append(points[border.start[chain]])
    return sorted(found, key=lambda loop: -len(loop))


def channel_pictures(folder: Path) -> None:
    """Channel by channel, of the front layer."""
    image = gi.encode(gi.load_pattern(example_path("dress")), grid=GRID)
    front = image.to_channels()[:17]
    names = [
        "0 inside",
        *(f"{k + 1} bottom: {name}" for k, name in enumerate(_short_types())),
        *(f"{k + 5} left: {name}" for k, name in enumerate(_short_types())),
        *(
            f"{9 + 2 * k + axis} {side} {'dx' if axis == 0 else 'dy'} [cm]"
            for k, side in enumerate(("bottom", "right", "top", "left"))
            for axis in (0, 1)
        ),
    ]
    figure = Figure(figsize=(9.4, 7.6), facecolor=PAPER)
    axes = figure.subplots(4, 5).ravel()
    for ax in axes:
        ax.set_axis_off()
    spots = [0, *range(1, 5), *range(6, 10), *range(10, 14), *range(15, 19)]
    limit = float(np.abs(front[9:]).max())
    for k, (channel, name) in enumerate(zip(front, names, strict=True)):
        ax = axes[spots[k]]
        plain = k < 9
        shown = ax.imshow(
            channel,
            origin="lower",
            cmap="Greys" if plain else "RdBu",
            vmin=0 if plain else -limit,
            vmax=1 if plain else limit,
        )
        ax.set_title(name, fontsize=7.5, color=INK)
        ax.add_patch(_border())
    bar = figure.colorbar(shown, ax=[axes[14], axes[19]], shrink=0.8)
    bar.set_label("edge vectors [cm]", fontsize=7.5)
    bar.ax.tick_params(labelsize=7)
    figure.suptitle(
        "The 17 channels of the front layer of a dress", fontsize=11, color=INK, fontweight="bold"
    )
    save(figure, folder / "channels.png")


def _short_types() -> list[str]:
    """Names of the edge types of contract 1."""
    return ["none", *(TYPE_NAMES[EdgeType(k)] for k in range(1, EDGE_TYPE_COUNT))]


def _border():
    from matplotlib.patches import Rectangle

    return Rectangle((-0.5, -0.5), GRID, GRID, fill=False, edgecolor=FAINT, linewidth=0.6)


def frame_picture(folder: Path) -> None:
    """The grid on the body."""
    frame = BodyFrame.standard(GRID)
    body = gi.load_body("mean-female")
    figure = Figure(figsize=(6.6, 6.2), facecolor=PAPER)
    ax = figure.add_axes((0.09, 0.06, 0.89, 0.88))
    board(ax, frame)
    triangles = body.vertices[body.faces][:, :, :2]
    ax.add_collection(PolyCollection(list(triangles), facecolors="#d9d2c6", edgecolors="#d9d2c6"))
    ax.set_xlim(frame.columns[0], frame.columns[-1])
    ax.set_ylim(frame.rows[0], frame.rows[-1])
    ax.set_aspect("equal")
    landmarks = {"ankle": 1, "crotch": 6, "waist": 8, "shoulder": 12, "top of a hood": 15}
    for name, row in landmarks.items():
        y = frame.rows[row]
        ax.axhline(y, color=TYPE_COLOURS[EdgeType.FRONT_TO_BACK], linewidth=1)
        ax.text(frame.columns[-1] - 1, y + 1, name, fontsize=7.5, color=INK, ha="right")
    for name, column in {"neck": 9, "armpit": 11, "wrist": 15}.items():
        x = frame.columns[column]
        ax.axvline(x, color=TYPE_COLOURS[EdgeType.SIDE_BY_SIDE], linewidth=1)
        ax.text(x + 1, frame.rows[0] + 2, name, fontsize=7.5, color=INK, rotation=90)
    ax.set_xlabel("x [cm]", fontsize=8)
    ax.set_ylabel("y [cm]", fontsize=8)
    ax.tick_params(labelsize=7)
    ax.set_title("The body frame at N = 16", fontsize=11, color=INK, fontweight="bold")
    save(figure, folder / "body-frame.png")


def decode_pictures(folder: Path) -> None:
    """Four steps from the image to the pattern."""
    image = gi.encode(gi.load_pattern(example_path("dress")), grid=GRID).without_marks()
    labels, count = label_panels(image.inside, image.edge_type)
    figure, axes = two_layers("1. Connected cells are one panel")
    for layer, ax in enumerate(axes):
        board(ax)
        rows, cols = np.nonzero(labels[layer] >= 0)
        squares = np.stack([cols, rows], axis=1)[:, None] + [(0, 0), (1, 0), (1, 1), (0, 1)]
        colours = [SEAM_COLOURS[k % len(SEAM_COLOURS)] for k in labels[layer][rows, cols]]
        ax.add_collection(
            PolyCollection(list(squares), facecolors=colours, edgecolors=PAPER, alpha=0.55)
        )
        ax.autoscale_view()
    save(figure, folder / "decode-1-panels.png")

    meshes = []
    for k in range(count):
        layer = int(np.nonzero(labels == k)[0][0])
        cells = cell_mesh(labels[layer] == k, image.edge_type[layer])
        meshes.append((layer, cells, unfolded(image, layer, cells)))
    figure, axes = two_layers("2. Edge vectors unfold each panel to its true shape")
    for layer, cells, points in meshes:
        quads = points[cells.corner_ids]
        axes[layer].add_collection(
            PolyCollection(
                list(quads), facecolors=LAYER_TINTS[layer], edgecolors=FAINT, linewidths=0.7
            )
        )
        axes[layer].autoscale_view()
    save(figure, folder / "decode-2-unfolding.png")

    pattern = gi.decode(image)
    figure, axes = two_layers("3. Lines and curves are fitted to the corners of the boundary")
    for (layer, cells, points), panel in zip(meshes, pattern.panels, strict=True):
        ax = axes[layer]
        loop = outlines(cells, image, layer, points)[0]
        ax.plot(*loop.T, "o", color=TYPE_COLOURS[EdgeType.FRONT_TO_BACK], markersize=3.4, zorder=3)
        world = [panel.to_world(curve.sample(24))[:, :2] for curve in panel.curves]
        whole = np.concatenate([line[:-1] for line in world])
        shift = _area_middle(loop) - _area_middle(whole)
        for line in world:
            moved = line + shift
            ax.plot(*moved.T, color=INK, linewidth=1.1)
            ax.plot(*moved[0], "s", color=TYPE_COLOURS[EdgeType.SIDE_BY_SIDE], markersize=4)
    for ax in axes:
        ax.autoscale_view()
    figure.text(
        0.5,
        0.03,
        "orange: corners of cells; black: fitted edges; blue squares: ends of edges",
        fontsize=8,
        color=INK,
        ha="center",
    )
    save(figure, folder / "decode-3-edges.png")

    figure = Figure(figsize=(8.6, 4.8), facecolor=PAPER)
    draw_pattern(pattern, figure.add_axes((0.01, 0.01, 0.98, 0.88)))
    figure.suptitle(
        "4. Edge types become seams: the decoded pattern", fontsize=11, color=INK, fontweight="bold"
    )
    save(figure, folder / "decode-4-pattern.png")


def damaged_channels() -> Float[np.ndarray, "channel row col"]:
    """Logits such as a network gives: two broken seams, a lone cell and a wrong flag."""
    image = gi.encode(gi.load_pattern(example_path("dress")), grid=GRID)
    logits = np.where(image.to_channels() > 0.5, FULL[1], FULL[0]).astype(np.float32)
    plain = image.to_channels()
    for layer in (0, 1):
        logits[17 * layer + 9 : 17 * (layer + 1)] = plain[17 * layer + 9 : 17 * (layer + 1)]
    gaps = (
        (inner_edge(image, EdgeType.FRONT_TO_BACK), EdgeType.NON_STITCH),
        (inner_edge(image, EdgeType.SIDE_BY_SIDE), EdgeType.NON_BOUNDARY),
    )
    for (side, row, col), wrong in gaps:
        types = logits[1 + 4 * side : 5 + 4 * side, row, col]
        types[:] = -3.0
        types[wrong] = 0.5
        types[int(image.edge_type[0, side, row, col])] = 0.0
    inner = np.argwhere(image.inside[0])
    row, col = inner[len(inner) // 2]
    logits[0, row, col] = -0.4
    row = int(np.nonzero(image.inside[1].any(axis=1))[0][0]) - 1
    logits[17, row, 3] = 0.3
    return logits


def inner_edge(image: GarmentImage, kind: EdgeType) -> tuple[int, int, int]:
    """A grid edge of the front layer within a seam: others of its kind go on at both its ends.

    Returns:
        Side (0 bottom, 1 left), row and column.
    """
    edges = [tuple(map(int, e)) for e in np.argwhere(image.edge_type[0] == kind)]

    def ends(edge: tuple[int, int, int]) -> tuple[tuple[int, int], tuple[int, int]]:
        side, row, col = edge
        return (row, col), (row + side, col + 1 - side)

    at = [end for edge in edges for end in ends(edge)]
    inner = [edge for edge in edges if all(at.count(end) == 2 for end in ends(edge))]
    return inner[len(inner) // 2]


def repair_pictures(folder: Path) -> None:
    """The same doubtful channels at the three levels of repair."""
    logits = damaged_channels()
    known, _ = gi.repair(logits, "none", kind="logits")
    for number, (level, title) in enumerate(
        (
            ("none", "1. The likeliest value of everything: it does not fit together"),
            ("paper", "2. Level paper: gaps in seams are closed"),
            ("full", "3. Level full: everything fits together"),
        ),
        start=1,
    ):
        image, report = gi.repair(logits, level, kind="logits")
        figure = Figure(figsize=(9.4, 5.6), facecolor=PAPER)
        ax = figure.add_axes((0.01, 0.01, 0.98, 0.86))
        draw_image(image, ax)
        _circle_faults(ax, known if level == "none" else image)
        told = ", ".join(f"{rule}: {n}" for rule, n in report.counts.items()) or "nothing changed"
        figure.suptitle(title, fontsize=11, color=INK, fontweight="bold")
        figure.text(0.5, 0.895, told, fontsize=8, color=FAINT, ha="center")
        save(figure, folder / f"repair-{number}-{level}.png")


def _circle_faults(ax: Axes, image: GarmentImage) -> None:
    """Circles where the image differs from its full repair."""
    whole, _ = gi.repair(damaged_channels(), "full", kind="logits")
    for layer in range(image.layers):
        shift = layer * GRID * 1.09
        spots = [
            (c + 0.5, r + 0.5) for r, c in np.argwhere(image.inside[layer] != whole.inside[layer])
        ]
        for side, row, col in np.argwhere(image.edge_type[layer] != whole.edge_type[layer]):
            spots.append((col + 0.5, row) if side == 0 else (col, row + 0.5))
        for x, y in spots:
            ax.plot(x + shift, y, "o", color=RED, markersize=12, fillstyle="none", zorder=9)


def drape_pictures(folder: Path) -> None:
    """Four steps from the pattern to the garment at rest."""
    pattern = without_stubs(gi.load_pattern(example_path("dress")))
    worn = gi.drape_pattern(pattern)
    placed, standings = place_on_body(pattern, worn.body, made_for=None)
    cloth = mesh(placed, vertices=2000)
    flat = np.concatenate(
        [placed.panels[k].to_world(cloth.flat[cloth.panel == k]) for k in range(len(placed.panels))]
    )
    corners = np.empty((len(cloth.flat), 3))
    order = np.concatenate([np.flatnonzero(cloth.panel == k) for k in range(len(placed.panels))])
    corners[order] = flat
    apart = replace(cloth, vertex=np.arange(len(cloth.flat)))
    begun = start_points(cloth, worn.body, standings)
    soon = gi.drape_pattern(pattern, settings=SolverSettings(max_frames=FREE_FRAMES))
    views = (
        ("1. Stand: panels placed round the body", replace(worn, cloth=apart, points=corners)),
        ("3. Lay: sewn, sleeves along the arms", replace(worn, cloth=cloth, points=begun)),
        (f"4. Simulate: after {FREE_FRAMES} frames", soon),
        (f"5. At rest: after {worn.report.frames} frames", worn),
    )
    for name, shown in zip(("1-stand", "3-lay", "4-simulate", "5-rest"), views, strict=True):
        title, garment = shown
        save(_photographs(title, garment), folder / f"drape-{name}.png")
    save(_triangles(cloth), folder / "drape-2-mesh.png")


def _photographs(title: str, worn: gi.DrapedGarment) -> Figure:
    figure = Figure(figsize=(8.6, 4.6), facecolor=PAPER)
    for k, view in enumerate(("front", "turned")):
        picture: UInt8[np.ndarray, "row col 3"] = gi.photograph(
            worn, view=view, size=PIXELS, seams=True
        ).colour
        ax = figure.add_axes((0.01 + 0.5 * k, 0.01, 0.48, 0.88))
        ax.imshow(picture)
        ax.set_axis_off()
    figure.suptitle(title, fontsize=11, color=INK, fontweight="bold")
    return figure


def _triangles(cloth) -> Figure:
    figure = Figure(figsize=(8.6, 4.6), facecolor=PAPER)
    panels = cloth.pattern.panels
    sizes = [np.ptp(cloth.flat[cloth.panel == k], axis=0) for k in range(len(panels))]
    tallest = max(float(size[1]) for size in sizes)
    axes = figure.subplots(1, len(panels), width_ratios=[float(size[0]) for size in sizes])
    for k, (panel, ax) in enumerate(zip(panels, axes, strict=True)):
        own = cloth.faces[cloth.face_panel == k]
        ax.triplot(*cloth.flat.T, own, color=FAINT, linewidth=0.4)
        low, high = (edge(cloth.flat[cloth.panel == k], axis=0) for edge in (np.min, np.max))
        ax.set_xlim(low[0] - 1, high[0] + 1)
        middle = (low[1] + high[1]) / 2
        ax.set_ylim(middle - tallest / 2 - 1, middle + tallest / 2 + 1)
        name = panel.name.replace("_sleeve_", "\nsleeve, ")
        ax.set_title(name, fontsize=7.5, color=INK)
        ax.set_aspect("equal")
        ax.set_axis_off()
    figure.suptitle(
        f"2. Mesh: {len(cloth.faces):,} triangles, both sides of a seam divided alike",
        fontsize=11,
        color=INK,
        fontweight="bold",
    )
    figure.subplots_adjust(0.02, 0.02, 0.98, 0.82)
    return figure


PICTURES: dict[str, Callable[[Path], None]] = {
    "encode": encode_pictures,
    "channels": channel_pictures,
    "frame": frame_picture,
    "decode": decode_pictures,
    "repair": repair_pictures,
    "drape": drape_pictures,
}


def main() -> None:
    """Draw what is named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=OUT)
    parser.add_argument("--only", nargs="+", choices=tuple(PICTURES), default=tuple(PICTURES))
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for name in options.only:
        PICTURES[name](options.folder)


if __name__ == "__main__":
    main()
