"""What the shading of a picture needs beside its compiled loops."""

import numpy as np
from jaxtyping import Float32

NO_SURFACE = -1
"""Panel id of pixels in which nothing is seen."""


def probe_offsets(radius: float, rings: int, spokes: int) -> Float32[np.ndarray, "probe 2"]:
    """Points in a disk about 0, mirrored in both axes so that mirrored scenes look mirrored."""
    angle = (np.arange(spokes) + 0.5) * 2 * np.pi / spokes
    far = radius * np.sqrt((np.arange(rings) + 0.5) / rings)
    points = far[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    # Every other ring is turned by half a spoke, which keeps the mirrors.
    between = angle + np.pi / spokes
    points[1::2] = far[1::2, None, None] * np.stack([np.cos(between), np.sin(between)], axis=-1)
    return points.reshape(-1, 2).astype(np.float32)
