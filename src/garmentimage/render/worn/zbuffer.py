"""Which triangle is seen at each sample of a picture.

A picture of N pixels has N x k samples a side. Screen points lie on a grid of 1/256 sample, so that
all edge functions are exact and neighbouring triangles leave no gap and no seam.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int32, UInt8

SUBSAMPLE = 256
"""Positions a sample is divided into, each way."""
NOTHING = 0
"""Owner of samples at which nothing is seen."""


@dataclass(frozen=True, eq=False)
class Visible:
    """What is seen at each sample; row 0 at the top."""

    near: Float32[np.ndarray, "row col"]
    """Depth less the lift of the surface [cm]; inf where nothing is seen."""
    owner: UInt8[np.ndarray, "row col"]
    """Number of the surface, from 1; `NOTHING` where nothing is seen."""
    face: Int32[np.ndarray, "row col"]
    """Face f of that surface: f where its outside is seen, -1 - f where its inside is."""
    weight: Float32[np.ndarray, "row col 2"]
    """Share of the face's second and third corner in the point that is seen."""

    @staticmethod
    def empty(samples: int) -> "Visible":
        """Buffers of `samples` x `samples` in which nothing is seen yet."""
        shape = (samples, samples)
        return Visible(
            np.full(shape, np.inf, np.float32),
            np.zeros(shape, np.uint8),
            np.zeros(shape, np.int32),
            np.zeros((*shape, 2), np.float32),
        )

    def overwrite(self, other: "Visible | None") -> None:
        """Take over what another one shows, or nothing."""
        self.near[...] = np.inf if other is None else other.near
        self.owner[...] = NOTHING if other is None else other.owner
        if other is not None:
            self.face[...] = other.face
            self.weight[...] = other.weight


def snapped(across: Float[np.ndarray, " n"], samples: int) -> Float[np.ndarray, " n"]:
    """Coordinates from the middle of the picture, from its edge and on the grid [sample]."""
    return np.rint(across * SUBSAMPLE) / SUBSAMPLE + samples / 2
