"""Depth, normals, panels and silhouette of a view, as PNG files that any program reads.

| map | PNG | value |
|---|---|---|
| `depth` | 16-bit grey | distance in tenths of a millimetre; 0 where nothing is |
| `normal` | 8-bit RGB | right, up, towards the camera: -1 to 1 as 0 to 255; 128 for nothing |
| `panels` | 8-bit palette | 0 nothing, 1 body, number of the panel + 2 |
| `silhouette` | 8-bit grey | share of the pixel in which cloth is seen, 0 to 255 |
"""

import numpy as np
from jaxtyping import UInt8

from garmentimage.errors import RenderError, quoted
from garmentimage.render.png import png_bytes
from garmentimage.render.style import SEAM_COLOURS
from garmentimage.render.worn.photographing import Views

DEPTH_STEP = 0.01  # depth that one level of a depth picture stands for [cm]
MAX_LEVEL = 65_535  # depths beyond this level read as this level
NOTHING, BODY = "#ffffff", "#b8b8b8"
"""Colours in which the panel picture shows everything but panels."""
MAX_PANELS = 254  # a palette has 256 entries, two of which are not panels


def map_bytes(views: Views, name: str) -> bytes:
    """`depth`, `normal`, `panels` or `silhouette` as a PNG file: the same bytes for the same view.

    Raises:
        RenderError: another name, or more panels than a palette has entries for.
    """
    palette: list[int] = []
    match name:
        case "depth":
            seen = np.isfinite(views.depth)
            levels = np.rint(np.where(seen, views.depth, 0.0) / DEPTH_STEP)
            pixels = np.where(seen, np.clip(levels, 1, MAX_LEVEL), 0).astype(np.uint16)
        case "normal":
            pixels = np.rint((views.normal + 1) * 127.5).astype(np.uint8)
        case "panels":
            pixels, palette = panel_numbers(views), _palette()
        case "silhouette":
            pixels = np.rint(views.silhouette * 255).astype(np.uint8)
        case _:
            raise RenderError(f"there is no map {quoted(name)}")
    return png_bytes(pixels, palette)


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


def _palette() -> list[int]:
    """Red, green and blue of each number in the panel picture."""
    from PIL import ImageColor

    tints = [NOTHING, BODY]
    tints += [SEAM_COLOURS[k % len(SEAM_COLOURS)] for k in range(MAX_PANELS)]
    return [level for tint in tints for level in ImageColor.getrgb(tint)]
