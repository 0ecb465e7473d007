"""Where a pattern stands in the world: its origin, and which panels face front or back."""

from garmentimage.pattern.model import Pattern

PELVIS_HEIGHT = 110.0
"""Height above the floor of the origin of patterns that sit round the pelvis [cm]."""

HANGING_HEIGHT = 93.0
"""No garment hangs lower than this from its highest point [cm above the floor]."""

FRONTAL = 0.7
"""A panel faces front or back where the z axis of its plane has a z component above this."""


def floor_shift(pattern: Pattern) -> float:
    """How far the pattern must be lifted to stand on the floor [cm].

    Two world conventions occur: feet on the floor at y = 0 (GarmentCode), and the origin near
    the pelvis (Korosteleva and Lee, 2021). A garment hangs from the waist (about 100 cm) or
    higher, so its highest point tells: of thousands of real files the first kind tops at 104 cm
    or more, the second at 83 cm or less, and below 35 cm without a hood.
    """
    top = max(float(p.to_world(p.outline.polygon)[:, 1].max()) for p in pattern.panels)
    return 0.0 if top > HANGING_HEIGHT else PELVIS_HEIGHT
