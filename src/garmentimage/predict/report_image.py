"""A prediction drawn as one image."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, UInt8

from garmentimage.networks import (
    ONE_COLOUR,
    WARNING_COLOUR,
    WORN_PIXELS,
    StripFrame,
    figure_pixels,
)
from garmentimage.predict.predictor import Prediction
from garmentimage.render import FAINT, INK, NAME_LIMIT, PAPER, printable
from garmentimage.render.flat import draw_image, draw_pattern
from garmentimage.render.worn import photograph

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMN_IN, HEIGHT_IN, TITLE_IN = 3.4, 3.8, 0.4
"""Sizes of the picture's four columns [inch]."""
DPI = 110
LAYER_NAMES = "front", "back"


def draw_report(prediction: Prediction, frame: StripFrame) -> UInt8[np.ndarray, "row col 3"]:
    """Draw a prediction: the network's input, the GarmentImage with maps of uncertainty, the
    pattern, and the draped garment; faults in red.

    Args:
        prediction: of a picture.
        frame: its garment, draped.
    """
    from matplotlib.figure import Figure

    garment = prediction.garment
    figure = Figure(figsize=(4 * COLUMN_IN, HEIGHT_IN), facecolor=PAPER)
    rest = 1 - TITLE_IN / HEIGHT_IN

    def axes(column: int, low: float = 0.0, high: float = 1.0) -> "Axes":
        """Part of a column, as shares of its height below the title."""
        return figure.add_axes(
            ((column + 0.03) / 4, (0.02 + 0.98 * low) * rest, 0.94 / 4, 0.98 * (high - low) * rest)
        )

    low = "" if prediction.is_sure else "LOW "
    titles = (
        "picture",
        f"GarmentImage; {low}confidence {prediction.confidence:.2f}",
        "pattern",
        "draped",
    )
    for column, title in enumerate(titles):
        is_bad = (column == 1 and not prediction.is_sure) or (column > 1 and bool(frame.faults))
        figure.text(
            (column + 0.5) / 4,
            1 - 0.5 * TITLE_IN / HEIGHT_IN,
            title,
            fontsize=10,
            color=WARNING_COLOUR if is_bad else INK,
            ha="center",
            va="center",
        )
    _draw_picture(prediction.photo.pixels, axes(0))
    if garment.image is not None:
        draw_image(garment.image, axes(1, 0.44))
    _draw_doubts(prediction.doubts, axes(1, 0.0, 0.42))
    if garment.pattern is not None:
        draw_pattern(garment.pattern, axes(2))
    if frame.worn is not None:
        _draw_picture(photograph(frame.worn, ONE_COLOUR, size=WORN_PIXELS).colour, axes(3))
    if frame.faults:
        _write_fault(frame.faults[0], axes(3))
    return figure_pixels(figure, DPI)


def _draw_picture(pixels: UInt8[np.ndarray, "row col 3"], ax: "Axes") -> None:
    ax.imshow(pixels)
    ax.set_axis_off()


def _draw_doubts(doubts: Float[np.ndarray, "layer row col"], ax: "Axes") -> None:
    """Maps of uncertainty, front and back side by side, dark where it is high."""
    side = doubts.shape[-1]
    for layer, (name, values) in enumerate(zip(LAYER_NAMES, doubts, strict=True)):
        left = layer * (side + 1)
        ax.imshow(
            values, origin="lower", cmap="Reds", vmin=0, vmax=1, extent=(left, left + side, 0, side)
        )
        ax.text(left + side / 2, side + 0.4, f"doubt, {name}", fontsize=7, color=FAINT, ha="center")
        ax.plot(
            [left, left + side, left + side, left, left], [0, 0, side, side, 0], color=FAINT, lw=0.8
        )
    ax.set(xlim=(-0.5, 2 * side + 1.5), ylim=(-0.5, side + 2))
    ax.set_axis_off()


def _write_fault(fault: str, ax: "Axes") -> None:
    import textwrap

    ax.set_axis_off()
    ax.text(
        0.5,
        0.02,
        "\n".join(printable(line) for line in textwrap.wrap(fault, NAME_LIMIT)),
        fontsize=7,
        color=WARNING_COLOUR,
        ha="center",
        va="bottom",
        transform=ax.transAxes,
        parse_math=False,
        bbox={"facecolor": PAPER, "edgecolor": "none", "alpha": 0.85},
    )
