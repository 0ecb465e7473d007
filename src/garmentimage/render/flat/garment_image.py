"""A GarmentImage as in the paper's figures: flags, edge types, deformed cells (Figure 2c)."""

from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from garmentimage.raster import BOTTOM, LEFT, EdgeType, GarmentImage
from garmentimage.render.style import (
    FAINT,
    GRID_LINE,
    INK,
    PAPER,
    TURNED_HATCH,
    TYPE_COLOURS,
    TYPE_NAMES,
    layer_tint,
    printable,
    write,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LAYER_GAP = 0.09  # space between two layers, in grids
TITLE_SHARE, LEGEND_SHARE, CAPTION_SHARE, EDGE_SHARE = 0.09, 0.19, 0.08, 0.02
"""Room above, for the legend below, for a caption below, and below without either, in grids."""
ROW_SHARE = 0.07  # room for each further row of a legend, in grids of an image of two layers
TYPES_HEIGHT = 1 + TITLE_SHARE + LEGEND_SHARE
CELLS_HEIGHT = 1 + TITLE_SHARE + CAPTION_SHARE
"""Heights of the drawings of `draw_image` and `draw_cells`, in grids."""
LEGEND_NOTE = "Colour is the type of a grid edge here; in patterns, with a number, it is the seam."
CELLS_CAPTION = (
    "Deformation: each cell's cloth, all in one scale. On the body, grid cells are unequal."
)
QUAD_SHARE = 0.8  # how much of its cell a deformed quadrilateral of middling size fills
_SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
_STEP = {BOTTOM: np.array([1, 0]), LEFT: np.array([0, 1])}


def draw_image(image: GarmentImage, ax: "Axes", *, legend: bool = True) -> None:
    """Draw flags (tinted cells) and edge types (coloured grid edges), all layers side by side.

    Args:
        image: what to draw.
        ax: where; its limits, aspect and frame are set; one unit is one cell.
        legend: name the colours of the edge types below the grid.
    """
    for layer in range(image.layers):
        _draw_board(image, layer, ax)
        _draw_flags(image, layer, ax)
        _draw_types(image, layer, ax)
    _frame(image, ax, below=_draw_legend(image, ax) if legend else EDGE_SHARE)


def draw_cells(image: GarmentImage, ax: "Axes") -> None:
    """Draw the deformation: in every cell the quadrilateral that its four edge vectors make.

    One scale serves the whole image, so a large quadrilateral is a large piece of cloth; a caption
    below says so.
    """
    from matplotlib.collections import PolyCollection

    quads = {k: _quads(image, k) for k in range(image.layers)}
    sizes = np.concatenate([np.ptp(q, axis=1).max(axis=1) for q in quads.values()])
    scale = QUAD_SHARE / float(np.median(np.maximum(sizes, 1e-6))) if len(sizes) else 1.0
    for layer, shapes in quads.items():
        _draw_board(image, layer, ax)
        rows, cols = np.nonzero(image.inside[layer])
        middle = np.stack([cols + 0.5, rows + 0.5], axis=1) + _origin(image, layer)
        placed, tint = list(shapes * scale + middle[:, None]), layer_tint(layer)
        width = 0.5 * _stroke(image)
        ax.add_collection(
            PolyCollection(placed, facecolors=tint, edgecolors=INK, linewidths=width, zorder=2)
        )
    _write_below(image, ax, 0.05, CELLS_CAPTION)
    _frame(image, ax, below=CAPTION_SHARE)


def _quads(image: GarmentImage, layer: int) -> Float[np.ndarray, "cell 4 2"]:
    """Corners of each inside cell's quadrilateral about its centre [cm], in raster order.

    Where the four vectors do not close, the misfit is shared between the two paths to the corner
    opposite the origin.
    """
    rows, cols = np.nonzero(image.inside[layer])
    bottom, right, top, left = np.moveaxis(
        image.deformation[layer][:, :, rows, cols].astype(float), 2, 1
    )
    corners = np.stack([np.zeros_like(bottom), bottom, (bottom + right + left + top) / 2, left], 1)
    centred: np.ndarray = corners - corners.mean(axis=1, keepdims=True)
    return centred


def _origin(image: GarmentImage, layer: int) -> Float[np.ndarray, " 2"]:
    return np.array([layer * image.grid * (1 + LAYER_GAP), 0.0])


def _stroke(image: GarmentImage) -> float:
    """Line widths shrink on finer grids."""
    return float(min(1.0, 16 / image.grid) ** 0.5)


def _draw_board(image: GarmentImage, layer: int, ax: "Axes") -> None:
    from matplotlib.collections import LineCollection

    n = image.grid
    x, y = _origin(image, layer)
    lines = [[(x + k, y), (x + k, y + n)] for k in range(n + 1)]
    lines += [[(x, y + k), (x + n, y + k)] for k in range(n + 1)]
    width = 0.6 * _stroke(image)
    ax.add_collection(LineCollection(lines, colors=GRID_LINE, linewidths=width, zorder=0))
    name = printable(image.layer_names[layer])
    write(ax, x + n / 2, y + n * 1.015, name, fontsize=7, va="bottom")


def _draw_flags(image: GarmentImage, layer: int, ax: "Axes") -> None:
    from matplotlib.collections import PolyCollection

    rows, cols = np.nonzero(image.inside[layer])
    corner = np.stack([cols, rows], axis=1) + _origin(image, layer)
    cells, tint, width = corner[:, None] + _SQUARE, layer_tint(layer), 0.5 * _stroke(image)
    ax.add_collection(
        PolyCollection(list(cells), facecolors=tint, edgecolors=PAPER, linewidths=width, zorder=1)
    )
    turned = list(cells[image.turned[layer][rows, cols]])
    if turned:
        ax.add_collection(
            PolyCollection(
                turned, facecolors="none", edgecolors=FAINT, hatch=TURNED_HATCH, lw=0, zorder=1.5
            )
        )


def _draw_types(image: GarmentImage, layer: int, ax: "Axes") -> None:
    from matplotlib.collections import LineCollection

    for edge_type, colour in TYPE_COLOURS.items():
        lines = []
        for side in (BOTTOM, LEFT):
            rows, cols = np.nonzero(image.edge_type[layer, side] == edge_type)
            start = np.stack([cols, rows], axis=1) + _origin(image, layer)
            lines += [(a, a + _STEP[side]) for a in start]
        width, zorder = (1.5, 2.5) if edge_type == EdgeType.NON_STITCH else (2.3, 3)
        width *= _stroke(image)
        ax.add_collection(
            LineCollection(lines, colors=colour, linewidths=width, capstyle="round", zorder=zorder)
        )


def _draw_legend(image: GarmentImage, ax: "Axes") -> float:
    """Draw the legend in as many rows as it needs; the room for it, in grids."""
    width = float(_origin(image, image.layers - 1)[0]) + image.grid
    always = (EdgeType.NON_STITCH, EdgeType.FRONT_TO_BACK, EdgeType.SIDE_BY_SIDE)
    shown = [k for k in TYPE_COLOURS if k in always or (image.edge_type == k).any()]
    entries = [*shown, None] if image.turned.any() else shown
    # The lettering is as large however many grids are beside each other.
    scale = max(image.layers / 2, 1)
    step = (0.62 if len(entries) == 3 else 0.5) * scale * image.grid
    rows = ceil(len(entries) * step / width)
    a_row = ceil(len(entries) / rows)
    for k, kind in enumerate(entries):
        row, column = divmod(k, a_row)
        in_row = min(a_row, len(entries) - row * a_row)
        x = width / 2 + (column - (in_row - 1) / 2) * step - step / 2
        y = -(0.07 + row * ROW_SHARE * scale) * image.grid
        length = 0.07 * image.grid
        if kind is None:
            half = 0.02 * image.grid
            sample = ax.fill_between([x, x + length], y - half, y + half)
            sample.set(facecolor="none", edgecolor=FAINT, hatch=TURNED_HATCH, linewidth=0)
        else:
            ax.plot([x, x + length], [y, y], color=TYPE_COLOURS[kind], linewidth=2.3)
        name = "wrong side out" if kind is None else TYPE_NAMES[kind]
        write(ax, x + 0.1 * image.grid, y, name, color=INK, fontsize=6.5, ha="left")
    more = (rows - 1) * ROW_SHARE * scale
    _write_below(image, ax, 0.14 + more, LEGEND_NOTE)
    return LEGEND_SHARE + more


def _write_below(image: GarmentImage, ax: "Axes", depth: float, text: str) -> None:
    """A line of small print in the middle below the grids, `depth` grids down."""
    middle = (float(_origin(image, image.layers - 1)[0]) + image.grid) / 2
    write(ax, middle, -depth * image.grid, text, fontsize=5.5)


def _frame(image: GarmentImage, ax: "Axes", below: float) -> None:
    n = image.grid
    ax.set_xlim(-EDGE_SHARE * n, float(_origin(image, image.layers - 1)[0]) + (1 + EDGE_SHARE) * n)
    ax.set_ylim(-below * n, (1 + TITLE_SHARE) * n)
    ax.set_aspect("equal")
    ax.set_axis_off()
