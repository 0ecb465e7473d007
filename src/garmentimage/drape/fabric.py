"""What a garment is made of: how cloth stretches, bends, weighs and slides."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, get_type_hints

from garmentimage.errors import DrapeError, quoted
from garmentimage.system import did_you_mean


@dataclass(frozen=True)
class Fabric:
    """A woven or knitted cloth, the same in all directions.

    Beside each field stand its bounds, far beyond any real cloth, and their unit.
    """

    stretch: Annotated[float, 1e3, 1e7, "dyn/cm"]
    """Tension per width at which it would double its length (Young's modulus times thickness)
    [dyn/cm]."""
    bend: Annotated[float, 0.0, 1e5, "dyn cm"]
    """Moment per width for a curvature of 1/cm [dyn cm]; 1 gf cm of a KES test is 981."""
    weight: Annotated[float, 1e-3, 1.0, "g/cm2"]
    """[g/cm2]; 0.01 is 100 g/m2."""
    friction: Annotated[float, 0.0, 10.0, ""]
    """Coefficient of friction on skin: tangent of the steepest slope on which it does not slide."""
    thickness: Annotated[float, 0.05, 2.0, "cm"]
    """Least distance between the middle of the cloth and the skin [cm]."""
    damping: Annotated[float, 0.0, 100.0, "1/s"] = 6.0
    """Share of the speed lost in air [1/s]."""

    def __post_init__(self) -> None:
        for name, hint in get_type_hints(Fabric, include_extras=True).items():
            value, (low, high, unit) = getattr(self, name), hint.__metadata__
            if not low <= value <= high:
                raise DrapeError(
                    f"a fabric's {name} is {value:g} {unit}; give {low:g} to {high:g} {unit}"
                )


FABRICS: Mapping[str, Fabric] = MappingProxyType(
    {
        "cotton": Fabric(stretch=6.0e4, bend=60.0, weight=0.015, friction=0.4, thickness=0.4),
        "denim": Fabric(stretch=1.5e5, bend=500.0, weight=0.038, friction=0.5, thickness=0.45),
        "jersey": Fabric(stretch=4.0e4, bend=20.0, weight=0.018, friction=0.45, thickness=0.4),
        "silk": Fabric(stretch=3.0e4, bend=20.0, weight=0.007, friction=0.25, thickness=0.35),
        "wool": Fabric(stretch=1.0e5, bend=150.0, weight=0.025, friction=0.45, thickness=0.45),
    }
)
"""Everyday fabrics. Weight and bending are textbook values (Kawabata's measurements: 0.02 to 0.05
gf cm for silk and jersey, some 0.5 for denim). Stretch is that of the first per cents of strain and
softened for woven cloth by up to ten times: cloth so stiff would look the same and take longer.
Friction is that on skin and underwear. Thickness is more than that of the cloth itself, which keeps
the triangles between the vertices out of a curved body."""


def load_fabric(name: str) -> Fabric:
    """A fabric by name.

    Raises:
        DrapeError: there is no such fabric.

    Example:
        >>> load_fabric("silk").weight
        0.007
    """
    if name not in FABRICS:
        raise DrapeError(f"there is no fabric {quoted(name)}; {did_you_mean(name, FABRICS)}")
    return FABRICS[name]
