"""Which triangle is seen at each sample of a picture.

A picture of N pixels has N x k samples a side. Screen points lie on a grid of 1/256 sample, so that
all edge functions are exact and neighbouring triangles leave no gap and no seam.
"""

import threading
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Int32, UInt8

from garmentimage.render.worn._kernels_zbuffer import Screen, draw_faces
from garmentimage.render.worn.camera import Camera
from garmentimage.render.worn.surface import Surface

SUBSAMPLE = 256  # positions a sample is divided into along each axis
NOTHING = 0  # owner of samples at which nothing is seen
MAX_CACHED = 6  # views of still surfaces that are kept


class Visible(NamedTuple):
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
    places: np.ndarray = np.rint(across * SUBSAMPLE) / SUBSAMPLE + samples / 2
    return places


class _Buffers(threading.local):
    """Large arrays of one thread, used again for each picture: new memory costs more than drawing.

    Each call of `picture` fills them afresh and returns none of them.
    """

    def __init__(self) -> None:
        self.visible: dict[str, Visible] = {}

    def take(self, role: str, samples: int) -> Visible:
        """Buffers of a size for one of the roles "camera" and "lamp"."""
        kept = self.visible.get(role)
        if kept is None or len(kept.near) != samples:
            kept = self.visible[role] = Visible.empty(samples)
        return kept


_BUFFERS = _Buffers()


def seen_by(surfaces: Sequence[Surface], camera: Camera, samples: int, role: str) -> Visible:
    """What a camera sees of surfaces, still ones first, numbered from 1."""
    still = tuple(s for s in surfaces if s.still)
    seen = _BUFFERS.take(role, samples)
    seen.overwrite(_still_view(still, camera, samples) if still else None)
    _draw(surfaces[len(still) :], len(still) + 1, camera, seen)
    return seen


@lru_cache(maxsize=MAX_CACHED)
def _still_view(still: tuple[Surface, ...], camera: Camera, samples: int) -> Visible:
    """What a camera sees of still surfaces."""
    seen = Visible.empty(samples)
    _draw(still, 1, camera, seen)
    return seen


def _draw(surfaces: Sequence[Surface], first: int, camera: Camera, seen: Visible) -> None:
    """Draw surfaces, numbered from `first`, over what is seen already."""
    samples = len(seen.near)
    for number, surface in enumerate(surfaces, start=first):
        x, y, depth = camera.project(surface.points, samples)
        draw_faces(
            Screen(snapped(x, samples), snapped(y, samples), depth),
            surface.faces,
            surface.lift,
            surface.two_sided,
            camera.distance is not None,
            number,
            seen,
        )
