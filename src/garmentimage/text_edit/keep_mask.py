"""Where a picture of a worn garment should stay as it is while a text changes the rest."""

from functools import cache

import numpy as np
from jaxtyping import Bool

from garmentimage.body import load_body, measurements
from garmentimage.metrics import EditedRegion
from garmentimage.render.worn import body_camera

BODY = "mean-female"
"""Whom the pictures of recipe `text-edit` show, from the front."""


@cache
def keep_mask(touched: EditedRegion, pixels: int) -> Bool[np.ndarray, "pixel_row pixel_col"]:
    """Pixels that a text does not speak of, the lowest row first.

    Sleeves are beside the shoulder points and above the waist.

    Args:
        touched: what may change.
        pixels: of the picture, a side.
    """
    camera, body = body_camera(load_body(BODY)), measurements(BODY)
    along = (np.arange(pixels) + 0.5 - pixels / 2) * camera.extent / pixels
    x, y = np.meshgrid(along + camera.target[0], along + camera.target[1])
    below = y < body.waist_height
    if touched == "below the waist":
        return ~below
    return below | (np.abs(x) < body.shoulder_width / 2)
