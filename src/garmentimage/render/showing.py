"""Patterns, GarmentImages and pictures of them worn beside each other, as PNG or SVG files.

Pictures are drawn with matplotlib's own canvases, never through pyplot, so nothing global changes
and no display is needed. The same sources give the same bytes.
"""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import UInt8

from garmentimage.errors import OutputError
from garmentimage.pattern import Pattern
from garmentimage.raster import GarmentImage
from garmentimage.render.flat import (
    CELLS_HEIGHT,
    TYPES_HEIGHT,
    arrange,
    bounds,
    draw_cells,
    draw_image,
    draw_pattern,
)
from garmentimage.render.style import FAINT, INK, PAPER, printable, write
from garmentimage.system import shown_path, write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Source = Pattern | GarmentImage | UInt8[np.ndarray, "row col 3"]
"""What is drawn; an array is a picture, row 0 at the top."""

SUFFIXES = (".png", ".svg")
HEIGHT_IN = 4.4  # most height of a drawing [inch]
WIDTH_LIMITS_IN = (2.4, 5.2)  # narrowest and widest drawing [inch]
TITLE_IN, MARGIN_IN, GAP_IN = 0.42, 0.15, 0.5
DPI = 170


def show(
    *sources: Source,
    out: str | Path,
    titles: Sequence[str] | None = None,
    steps: Sequence[str] = (),
) -> None:
    """Draw sources beside each other and write the picture.

    Args:
        sources: patterns, images and pictures, left to right.
        out: a `.png` or `.svg` file.
        titles: one for each source; default: its name, none for a picture.
        steps: words over the arrows from each source to the next; none, no arrows.

    Raises:
        OutputError: the ending is not a known one, or it cannot be written.
    """
    out = Path(out)
    suffix = out.suffix.lower()
    if suffix not in SUFFIXES:
        raise OutputError(
            f"{shown_path(out)}: pictures end in .png or .svg, not {suffix or 'without one'}"
        )
    figure = compose(sources, titles=titles, steps=steps)
    write_atomically(out, picture_bytes(figure, suffix[1:]))


def compose(
    sources: Sequence[Source], *, titles: Sequence[str] | None = None, steps: Sequence[str] = ()
) -> "Figure":
    """The matplotlib figure that `show` writes; same arguments."""
    from matplotlib.figure import Figure

    names = titles if titles is not None else [_title(s) for s in sources]
    ratios = [_ratio(s) for s in sources]
    low, high = WIDTH_LIMITS_IN
    widths = [min(max(r * HEIGHT_IN, low), high) for r in ratios]
    total = sum(widths) + GAP_IN * (len(widths) - 1) + 2 * MARGIN_IN
    tallest = max(min(w / r, HEIGHT_IN) for w, r in zip(widths, ratios, strict=True))
    height = tallest + TITLE_IN + MARGIN_IN
    figure = Figure(figsize=(total, height), facecolor=PAPER)
    x = MARGIN_IN
    for k, (source, name, width) in enumerate(zip(sources, names, widths, strict=False)):
        _draw(source, figure, (x / total, width / total), height)
        middle, top = (x + width / 2) / total, 1 - 0.55 * TITLE_IN / height
        write(figure, middle, top, printable(name), fontsize=10, color=INK, fontweight="bold")
        if k < len(steps):
            _draw_step(figure, (x + width + GAP_IN / 2) / total, 0.36 / total, steps[k])
        x += width + GAP_IN
    return figure


def picture_bytes(figure: "Figure", kind: str, *, dpi: int = DPI) -> bytes:
    """A figure as the bytes of a "png" or "svg" file, without dates or random names."""
    from matplotlib import rc_context

    stream = io.BytesIO()
    metadata = {"Software": None} if kind == "png" else {"Date": None, "Creator": None}
    with rc_context({"svg.hashsalt": "garmentimage"}):
        figure.savefig(stream, format=kind, dpi=dpi, metadata=metadata)
    return stream.getvalue()


def _title(source: Source) -> str:
    if isinstance(source, Pattern):
        return source.name or "pattern"
    if isinstance(source, np.ndarray):
        return ""
    return f"{source.name or 'GarmentImage'}, {source.grid} x {source.grid}"


def _ratio(source: Source) -> float:
    """Width of a source's drawing over its height."""
    if isinstance(source, Pattern):
        low, high = bounds(arrange(source))
        width, height = np.maximum(high - low, 1e-6)
        size = max(width, height)
        return float((width + 0.06 * size) / (height + 0.18 * size))
    if isinstance(source, np.ndarray):
        return float(source.shape[1] / source.shape[0])
    return 0.46 * source.layers


def _draw(source: Source, figure: "Figure", x: tuple[float, float], height: float) -> None:
    bottom, tall = MARGIN_IN / height, 1 - (MARGIN_IN + TITLE_IN) / height
    if isinstance(source, GarmentImage):
        lower = tall * CELLS_HEIGHT / (CELLS_HEIGHT + TYPES_HEIGHT)
        draw_image(source, figure.add_axes((x[0], bottom + lower, x[1], tall - lower)))
        draw_cells(source, figure.add_axes((x[0], bottom, x[1], lower)))
        return
    axes = figure.add_axes((x[0], bottom, x[1], tall))
    if isinstance(source, Pattern):
        draw_pattern(source, axes)
    else:
        axes.imshow(source, interpolation="antialiased")
        axes.set_axis_off()


def _draw_step(figure: "Figure", x: float, width: float, word: str) -> None:
    from matplotlib.patches import FancyArrowPatch

    start, end = (x - width / 2, 0.5), (x + width / 2, 0.5)
    arrow = FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=12)
    arrow.set(color=FAINT, linewidth=1.4, transform=figure.transFigure)
    figure.add_artist(arrow)
    write(figure, x, 0.525, word, va="bottom", fontsize=7.5)
