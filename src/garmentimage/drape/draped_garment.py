"""A draped garment: its cloth at rest on a body, and a report."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth


@dataclass(frozen=True)
class DrapeReport:
    """How well a drape succeeded. Lengths in cm; shares from 0 to 1."""

    settled: bool
    """Whether the cloth came to rest before the last frame."""
    frames: int
    """Simulated frames, each a sixtieth of a second; of several items, the most."""
    speed: float
    """Mean speed of the vertices at the end [cm/s]."""
    penetration: float
    """Greatest depth of the cloth under the skin [cm], between vertices, too; 0 where none is."""
    strain: float
    """Largest stretch of a direction in the panel that all but a hundredth of the cloth, by area,
    keeps below."""
    slid: Mapping[str, float]
    """How far the cloth lies from where the body wears it [cm], by place: `shoulders`, `waist` and
    `chest`."""
    crossings: int
    """Triangles of cloth that pass through other cloth."""
    held: float
    """Share of the vertices that were held at their height, as by a belt."""
    items: int
    """Items of clothing."""
    faults: tuple[str, ...]
    """Reasons why the drape failed, a sentence each; none for a good drape."""
    seconds: float
    """Time for mesh and simulation [s]."""
    notes: tuple[str, ...] = ()
    """How the garment was put on, where that is not obvious; a sentence each."""


@dataclass(frozen=True, eq=False)
class DrapedGarment:
    """A garment on a body."""

    cloth: Cloth
    points: Float[np.ndarray, "vertex 3"]
    """Where each vertex came to rest [cm], in the world of the body."""
    body: Body
    report: DrapeReport
