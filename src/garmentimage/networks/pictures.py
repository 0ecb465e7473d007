"""Pictures of a sequence of garments: a strip side by side, and an animation."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import UInt8

from garmentimage.drape import DrapedGarment, drape_pattern
from garmentimage.errors import GarmentImageError
from garmentimage.networks.decoded import DecodedGarment
from garmentimage.render import FAINT, INK, PAPER, picture_bytes, printable
from garmentimage.render.flat import draw_image, draw_pattern, drawn_size
from garmentimage.render.worn import PAPER_COLOURS, Look, photograph

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN_IN, PATTERN_IN, RASTER_IN, WORN_IN, TITLE_IN = 2.5, 2.4, 1.7, 2.5, 0.5
"""Sizes of a frame's drawings [inch]."""
DPI = 100
WORN_PIXELS = 320
FRAME_MS, END_FRAME_MS = 350, 1200
"""How long the animation shows a frame, and the first and last [ms]."""
WARNING_COLOUR = "#b3261e"
ONE_COLOUR = Look(colours=dict.fromkeys(PAPER_COLOURS, "lightblue"))
"""One colour for all panels, so that frames differ in shape only."""


@dataclass(frozen=True)
class StripFrame:
    """A garment of a sequence, and how it is worn."""

    title: str
    """Above its drawings."""
    garment: DecodedGarment
    worn: DrapedGarment | None
    """None where it was not draped."""
    faults: tuple[str, ...]
    """Why it cannot be sewn or worn; empty where it can."""
    picture: UInt8[np.ndarray, "row col 3"] | None = None
    """Drawn where it was not draped."""


def draped_frame(title: str, garment: DecodedGarment) -> StripFrame:
    """A garment, draped on the default body where it is valid."""
    if garment.faults or garment.pattern is None:
        return StripFrame(title, garment, None, garment.faults)
    try:
        worn = drape_pattern(garment.pattern)
    except GarmentImageError as error:
        return StripFrame(title, garment, None, (str(error),))
    return StripFrame(title, garment, worn, worn.report.faults)


def strip(columns: Sequence[StripFrame]) -> UInt8[np.ndarray, "row col 3"]:
    """Frames side by side, at one scale: pattern, raster, and worn; faults in red."""
    from matplotlib.figure import Figure

    raster = RASTER_IN if any(column.garment.image is not None for column in columns) else 0.0
    width, height = COLUMN_IN * len(columns), TITLE_IN + PATTERN_IN + raster + WORN_IN
    figure = Figure(figsize=(width, height), facecolor=PAPER)
    patterns = [column.garment.pattern for column in columns if column.garment.pattern is not None]
    sizes = [drawn_size(pattern) for pattern in patterns]
    room = max((w for w, _ in sizes), default=0.0), max((h for _, h in sizes), default=0.0)
    for number, column in enumerate(columns):
        place = (number / len(columns), 1 / len(columns))
        _draw(figure, column, place, height, height - TITLE_IN - PATTERN_IN, room)
    return figure_pixels(figure, DPI)


def figure_pixels(figure: "Figure", dpi: int) -> UInt8[np.ndarray, "row col 3"]:
    """A figure as pixels."""
    from PIL import Image

    raw = picture_bytes(figure, "png", dpi=dpi)
    return np.asarray(Image.open(io.BytesIO(raw)).convert("RGB"))


def side_by_side(
    picture: UInt8[np.ndarray, "side side 3"], columns: UInt8[np.ndarray, "row col 3"]
) -> UInt8[np.ndarray, "row col_and_frame 3"]:
    """A square picture to the left of a strip, as wide as a frame, beside the worn garments."""
    from PIL import Image

    rows, side = columns.shape[0], int(COLUMN_IN * DPI)
    seen = Image.fromarray(picture).resize((side, side), Image.Resampling.LANCZOS)
    left = np.full((rows, side, 3), 255, np.uint8)
    left[rows - side :] = np.asarray(seen)
    return np.concatenate([left, columns], axis=1)


def animation(columns: Sequence[StripFrame]) -> bytes:
    """The frames one after another and back again, as an animated GIF."""
    from PIL import Image

    frames = [
        Image.fromarray(strip([column])).quantize(128, dither=Image.Dither.NONE)
        for column in columns
    ]
    frames += frames[-2:0:-1]
    times = [FRAME_MS] * len(frames)
    times[0] = times[len(columns) - 1] = END_FRAME_MS
    file = io.BytesIO()
    frames[0].save(
        file, format="gif", save_all=True, append_images=frames[1:], duration=times, loop=0
    )
    return file.getvalue()


def _draw(
    figure: "Figure",
    column: StripFrame,
    place: tuple[float, float],
    height: float,
    floor: float,
    room: tuple[float, float],
) -> None:
    """One column, from `place[0]`, `place[1]` wide; `floor` is where the pattern stands [inch].

    `room` is what every pattern gets [cm].
    """
    colour = WARNING_COLOUR if column.faults else INK
    left, wide = place
    middle, inset = left + wide / 2, 0.03 * wide

    def axes(bottom: float, tall: float) -> "Axes":
        return figure.add_axes((left + inset, bottom / height, wide - 2 * inset, tall / height))

    def write(y: float, text: str, size: float, colour: str) -> None:
        figure.text(
            middle,
            y / height,
            printable(text),
            fontsize=size,
            color=colour,
            ha="center",
            va="center",
            parse_math=False,
        )

    write(height - 0.3 * TITLE_IN, column.title, 9, colour)
    if column.faults:
        write(height - 0.7 * TITLE_IN, column.faults[0][:44], 5.5, WARNING_COLOUR)
    if column.garment.pattern is not None:
        draw_pattern(column.garment.pattern, axes(floor, PATTERN_IN), room=room)
    if column.garment.image is not None:
        draw_image(column.garment.image, axes(WORN_IN, RASTER_IN), legend=False)
    if column.worn is not None:
        pixels = photograph(column.worn, ONE_COLOUR, size=WORN_PIXELS).colour
    elif column.picture is not None:
        pixels = column.picture
    else:
        write(WORN_IN / 2, "cannot be worn", 7, FAINT)
        return
    picture = axes(0.0, WORN_IN)
    picture.imshow(pixels)
    picture.set_axis_off()
