"""Pictures as files, and many pictures on one sheet."""

import io
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np
from jaxtyping import UInt8, UInt16

from garmentimage.errors import OutputError, RenderError
from garmentimage.render.style import FAINT
from garmentimage.system import shown_path, write_atomically

GAP = 6  # space round each picture of a sheet [pixel]
LETTERING, LABEL_HEIGHT = 13, 18
"""Height of the labels' letters, and of the line that they stand in [pixel]."""


def png_bytes(
    pixels: UInt8[np.ndarray, "row col *rgb"] | UInt16[np.ndarray, "row col"],
    palette: Sequence[int] = (),
) -> bytes:
    """A picture as a PNG file: the same bytes for the same pixels.

    A `palette` gives red, green and blue of each number in an image of one channel.
    """
    from PIL import Image

    stream, image = io.BytesIO(), Image.fromarray(np.ascontiguousarray(pixels))
    if palette:
        image.putpalette(palette)
    image.save(stream, format="png")
    return stream.getvalue()


def save_png(path: str | PathLike[str], colour: UInt8[np.ndarray, "row col 3"]) -> None:
    """Write a picture, row 0 at the top, whole or not at all.

    Raises:
        OutputError: the name does not end in .png, or the file cannot be written.
    """
    if Path(path).suffix.lower() != ".png":
        raise OutputError(f"{shown_path(path)}: pictures of worn garments end in .png")
    write_atomically(path, png_bytes(colour))


def contact_sheet(
    pictures: Sequence[UInt8[np.ndarray, "_ _ 3"]], labels: Sequence[str] = (), *, columns: int = 4
) -> UInt8[np.ndarray, "row col 3"]:
    """Pictures in rows from the top left, with a label under each.

    Args:
        pictures: of any sizes; cells are as large as the largest.
        labels: one for each picture, or none at all.
        columns: pictures in a row.

    Raises:
        RenderError: there is no picture, no column, or not one label for each picture.
    """
    from PIL import Image, ImageDraw, ImageFont

    if not len(pictures) or columns < 1 or (len(labels) and len(labels) != len(pictures)):
        raise RenderError(
            f"a sheet of {len(pictures)} pictures with {len(labels)} labels in {columns} columns: "
            "it needs a picture and a column at least, and a label for each picture or none"
        )
    height = max(len(p) for p in pictures) + GAP + (LABEL_HEIGHT if len(labels) else 0)
    width = max(p.shape[1] for p in pictures) + GAP
    rows, cols = -(-len(pictures) // columns), min(columns, len(pictures))
    sheet = Image.new("RGB", (cols * width + GAP, rows * height + GAP), "white")
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(LETTERING)
    for k, colour in enumerate(pictures):
        left, top = GAP + k % columns * width, GAP + k // columns * height
        sheet.paste(Image.fromarray(np.ascontiguousarray(colour)), (left, top))
        if len(labels):
            middle = (left + (width - GAP) / 2, top + height - GAP - LABEL_HEIGHT / 2)
            label = "".join(c if c.isprintable() else "?" for c in labels[k])
            pen.text(middle, label, fill=FAINT, font=font, anchor="mm")
    return np.asarray(sheet)
