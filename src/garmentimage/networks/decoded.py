"""Output of a network as a garment: channels repaired, decoded and checked."""

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
    """A garment that a network predicted or decoded."""

    z: Latent
    """Its latent vector; empty where it has none."""
    image: GarmentImage | None
    """Repaired; None where the network does not predict images."""
    repairs: RepairReport | None
    """What was repaired; None where nothing was to be repaired."""
    pattern: Pattern | None
    """None where the image cannot be decoded."""
    faults: tuple[str, ...]
    """Why the pattern cannot be cut and sewn; empty where it can."""


def decoded_garment(
    z: Latent, channels: Float32[np.ndarray, "channel row col"], repair_level: RepairLevel
) -> DecodedGarment:
    """Repair, decode and check the output of a network, which may be any image.

    Args:
        z: its latent vector; empty if it has none.
        channels: its flags and edge types as probabilities, its edge vectors in cm.
        repair_level: how much is repaired.
    """
    image, repairs = repair(channels, level=repair_level, kind="shares")
    try:
        pattern = decode(image, repair=repair_level)
    except GarmentImageError as error:
        return DecodedGarment(z, image, repairs, None, (str(error),))
    return DecodedGarment(z, image, repairs, pattern, tuple(pattern_faults(pattern)))


def topology_or_empty(pattern: Pattern | None) -> str:
    """The `topology_hash` of a pattern; empty where there is none, or its structure is invalid."""
    if pattern is None or structure_faults(pattern):
        return ""
    return topology_hash(stitch_graph(pattern))
