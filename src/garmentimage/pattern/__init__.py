"""Sewing patterns: panels, edges, stitches; reading, checking and writing them."""

from garmentimage.pattern.model import (
    Circle,
    Cubic,
    Edge,
    Loop,
    Notch,
    Panel,
    Pattern,
    Quadratic,
    Side,
    Stitch,
)

__all__ = [
    "Circle",
    "Cubic",
    "Edge",
    "Loop",
    "Notch",
    "Panel",
    "Pattern",
    "Quadratic",
    "Side",
    "Stitch",
]
