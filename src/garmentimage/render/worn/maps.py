"""Depth, normals, panels and silhouette of a view, as PNG files that any program reads.

| map | PNG | value |
|---|---|---|
| `depth` | 16-bit grey | distance in tenths of a millimetre; 0 where nothing is |
| `normal` | 8-bit RGB | right, up, towards the camera: -1 to 1 as 0 to 255; 128 for nothing |
| `panels` | 8-bit palette | 0 nothing, 1 body, number of the panel + 2 |
| `silhouette` | 8-bit grey | share of the pixel in which cloth is seen, 0 to 255 |
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import UInt8, UInt16

from garmentimage.errors import RenderError
from garmentimage.render.style import SEAM_COLOURS
from garmentimage.render.worn.photographing import Views

DEPTH_STEP = 0.01
"""Depth that one level of a depth picture stands for [cm]."""
MAX_LEVEL = 65_535
"""Depths beyond this level read as this level."""
NOTHING, BODY = "#ffffff", "#b8b8b8"
"""Colours in which the panel picture shows everything but panels."""
MAX_PANELS = 254
"""A palette has 256 entries, two of which are not panels."""


def depth_levels(views: Views) -> UInt16[np.ndarray, "row col"]:
    """Depth in steps of `DEPTH_STEP`, 0 where nothing is."""
    seen = np.isfinite(views.depth)
    levels = np.rint(np.where(seen, views.depth, 0.0) / DEPTH_STEP)
    return np.where(seen, np.clip(levels, 1, MAX_LEVEL), 0).astype(np.uint16)


def normal_colours(views: Views) -> UInt8[np.ndarray, "row col 3"]:
    """Normals as colours."""
    return np.rint((views.normal + 1) * 127.5).astype(np.uint8)


def panel_numbers(views: Views) -> UInt8[np.ndarray, "row col"]:
    """0 where nothing is, 1 on the body, number of the panel + 2 on cloth.

    Raises:
        RenderError: more panels than a palette has entries for.
    """
    last = int(views.panel.max(initial=0))
    if last > MAX_PANELS:
        raise RenderError(
            f"a picture of panels distinguishes {MAX_PANELS} of them, and this one shows panel "
            f"{last}; read the numbers in Python, from `Views.panel`"
        )
    return (views.panel + 1).astype(np.uint8)


def silhouette_levels(views: Views) -> UInt8[np.ndarray, "row col"]:
    """Share of cloth in each pixel, 255 for all of it."""
    levels: np.ndarray = np.rint(views.silhouette * 255).astype(np.uint8)
    return levels


def _grey(levels: np.ndarray) -> Any:
    from PIL import Image

    return Image.fromarray(np.ascontiguousarray(levels))


def _paletted(numbers: UInt8[np.ndarray, "row col"]) -> Any:
    from PIL import Image, ImageColor

    tints = [NOTHING, BODY]
    tints += [SEAM_COLOURS[k % len(SEAM_COLOURS)] for k in range(MAX_PANELS)]
    image = Image.fromarray(np.ascontiguousarray(numbers)).convert("L")
    image.putpalette([level for tint in tints for level in ImageColor.getrgb(tint)])
    return image


MAPS: Mapping[str, Callable[[Views], Any]] = MappingProxyType(
    {
        "depth": lambda views: _grey(depth_levels(views)),
        "normal": lambda views: _grey(normal_colours(views)),
        "panels": lambda views: _paletted(panel_numbers(views)),
        "silhouette": lambda views: _grey(silhouette_levels(views)),
    }
)
"""What can be written beside the picture."""


def map_bytes(views: Views, name: str) -> bytes:
    """One of `MAPS` as a PNG file: the same bytes for the same view."""
    from io import BytesIO

    stream = BytesIO()
    MAPS[name](views).save(stream, format="png")
    return stream.getvalue()
