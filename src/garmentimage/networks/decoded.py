"""The garment that a network gives: its channels repaired, decoded and checked."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from garmentimage.compare import pattern_faults, stitch_graph, structure_faults, topology_hash
from garmentimage.errors import GarmentImageError
from garmentimage.pattern import Pattern
from garmentimage.raster import GarmentImage
from garmentimage.raster.decode import decode
from garmentimage.raster.repair import RepairLevel, RepairReport, repair

Latent = Float32[np.ndarray, "latent"]


@dataclass(frozen=True)
class DecodedGarment:
    """A point of a latent space, and what garment it is."""

    z: Latent
    image: GarmentImage | None
    """Repaired; None where the network makes no images."""
    repairs: RepairReport | None
    pattern: Pattern | None
    """None where no garment can be read from the image."""
    faults: tuple[str, ...]
    """Why it cannot be cut and sewn; empty where it can."""


def decoded_garment(
    z: Latent, channels: Float32[np.ndarray, "34 row col"], repair_level: RepairLevel
) -> DecodedGarment:
    """The garment of an image that need not be a garment, repaired, decoded and checked.

    Args:
        z: its latent vector, if it has one.
        channels: its flags and edge types as shares.
        repair_level: how much of it is mended.
    """
    image, repairs = repair(channels, level=repair_level, kind="shares")
    try:
        pattern = decode(image, repair=repair_level)
    except GarmentImageError as error:
        return DecodedGarment(z, image, repairs, None, (str(error),))
    return DecodedGarment(z, image, repairs, pattern, tuple(pattern_faults(pattern)))


def topology_or_empty(pattern: Pattern) -> str:
    """See `topology_hash`; empty where panels or stitches are at fault."""
    return "" if structure_faults(pattern) else topology_hash(stitch_graph(pattern))
