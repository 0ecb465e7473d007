"""Contact sheets: patterns in rows and columns, one row a kind."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from garmentimage.errors import OutputError
from garmentimage.pattern import Pattern
from garmentimage.render.flat import draw_pattern
from garmentimage.render.showing import SUFFIXES, picture_bytes
from garmentimage.render.style import INK, PAPER, printable, write
from garmentimage.system import shown_path, write_atomically

CELL_IN = (4.6, 2.9)  # width and height of one drawing [inch]
HEAD_IN, SIDE_IN = 0.4, 0.4
SHEET_DPI = 80


def show_sheet(
    rows: Mapping[str, Sequence[Pattern]], *, columns: Sequence[str], out: str | Path
) -> None:
    """Draw patterns in a table and write the picture.

    Args:
        rows: by the name of the row, a pattern for each column.
        columns: names of the columns.
        out: a `.png` or `.svg` file.

    Raises:
        OutputError: the ending is not a known one, or it cannot be written.
    """
    from matplotlib.figure import Figure

    out = Path(out)
    suffix = out.suffix.lower()
    if suffix not in SUFFIXES:
        raise OutputError(f"{shown_path(out)}: pictures end in .png or .svg")
    width = SIDE_IN + CELL_IN[0] * len(columns)
    height = HEAD_IN + CELL_IN[1] * len(rows)
    figure = Figure(figsize=(width, height), facecolor=PAPER)
    for c, name in enumerate(columns):
        x = (SIDE_IN + (c + 0.5) * CELL_IN[0]) / width
        y = 1 - HEAD_IN / 2 / height
        write(figure, x, y, printable(name), fontsize=11, color=INK)
    for r, (kind, patterns) in enumerate(rows.items()):
        bottom = height - HEAD_IN - (r + 1) * CELL_IN[1]
        x, y = SIDE_IN / 2 / width, (bottom + CELL_IN[1] / 2) / height
        write(figure, x, y, printable(kind), rotation=90, fontsize=11, color=INK)
        for c, pattern in enumerate(patterns):
            left, size = SIDE_IN + c * CELL_IN[0], (CELL_IN[0] / width, CELL_IN[1] / height)
            draw_pattern(pattern, figure.add_axes((left / width, bottom / height, *size)))
    write_atomically(out, picture_bytes(figure, suffix[1:], dpi=SHEET_DPI))
