"""Colours, strokes and lettering that all pictures share."""

import unicodedata
from typing import Any

from garmentimage.raster import EdgeType

INK = "#2b2d33"
FAINT = "#8a8f98"
PAPER = "white"
GRID_LINE = "#e4e6ea"

LAYER_TINTS = ("#fbe9cf", "#d9e8f2")
"""Cloth of the front and of the back layer; further cloth layers take turns."""

TYPE_COLOURS = {
    EdgeType.NON_STITCH: INK,
    EdgeType.FRONT_TO_BACK: "#d55e00",
    EdgeType.SIDE_BY_SIDE: "#0072b2",
    EdgeType.WRAP: "#009e73",
    EdgeType.SHEET: "#cc79a7",
    EdgeType.ONTO: "#e69f00",
    EdgeType.CREASE: "#56b4e9",
}
"""Grid edges by type (Okabe and Ito: distinct for any colour vision)."""

TYPE_NAMES = {
    EdgeType.NON_STITCH: "not sewn",
    EdgeType.FRONT_TO_BACK: "front to back",
    EdgeType.SIDE_BY_SIDE: "side by side",
    EdgeType.WRAP: "cloth goes on",
    EdgeType.SHEET: "other sheet",
    EdgeType.ONTO: "onto cloth",
    EdgeType.CREASE: "pleat's fold",
}

SEAM_COLOURS = (
    "#0072b2", "#d55e00", "#009e73", "#aa4499", "#e69f00", "#332288",
    "#44aa99", "#882255", "#56b4e9", "#999933", "#cc6677", "#117733",
)  # fmt: skip
"""Seams in turn (Okabe and Ito, Tol); the number beside a seam settles what colour cannot."""

SEWN_ON = TYPE_COLOURS[EdgeType.ONTO]
"""Lines along which panels are sewn onto others."""

NAME_LIMIT = 28  # longest name that is written out


TURNED_HATCH = "////"
"""Over cloth whose wrong side is out."""


def layer_tint(layer: int) -> str:
    """Fill colour of a layer's cloth."""
    return LAYER_TINTS[layer % len(LAYER_TINTS)]


def write(on: Any, x: float, y: float, text: str, **style: Any) -> None:
    """Write text on matplotlib axes or a figure, centred and in `FAINT` unless `style` differs."""
    default = {"ha": "center", "va": "center", "color": FAINT, "parse_math": False}
    on.text(x, y, text, **(default | style))


def printable(text: str) -> str:
    """`text` on one line, shortened, with a sign for what the font of the pictures lacks."""
    from matplotlib.font_manager import findfont, get_font

    font = get_font(findfont("DejaVu Sans"))
    shown = "".join(
        c
        if c == " " or (unicodedata.category(c)[0] not in "CZM" and font.get_char_index(ord(c)))
        else "\N{REPLACEMENT CHARACTER}"
        for c in text[:NAME_LIMIT]
    )
    return shown + "\N{HORIZONTAL ELLIPSIS}" if len(text) > NAME_LIMIT else shown
