"""Where a picture of a worn garment is taken from.

A camera looks at a target; its own axes are x to the right of the picture, y up in it, and z from
the target towards the camera. Pictures are square.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from garmentimage.errors import RenderError, quoted
from garmentimage.pattern import Vector

VIEWS: Mapping[str, float] = MappingProxyType(
    {"front": 0.0, "back": np.pi, "side": np.pi / 2, "turned": np.pi / 5}
)
"""Azimuth of the named views [rad]; "side" shows the wearer's left."""
ORTHOGRAPHIC_DISTANCE = 400.0
"""An orthographic picture measures depths from this far in front of the target [cm]."""
FILM_HEIGHT_MM = 24.0  # height of a 35 mm frame, by which photographers name focal lengths
MIN_DISTANCE = 5.0  # nothing may be nearer to a perspective camera than this [cm]
MARGIN = 1.06  # size of a fitted picture over the size of what it shows


@dataclass(frozen=True)
class Camera:
    """A view of the world [cm, rad]: orthographic, or in perspective from a distance."""

    target: Vector = (0.0, 85.0, 0.0)
    """The world point in the middle of the picture [cm]."""
    extent: float = 180.0
    """Width and height of the picture at the target [cm]."""
    azimuth: float = 0.0
    """0 looks at the front of the body; the camera goes to the wearer's left [rad]."""
    elevation: float = 0.0
    """How far above the target's level the camera stands [rad]."""
    roll: float = 0.0
    """How far the camera is turned clockwise, as who holds it sees it [rad]."""
    distance: float | None = None
    """From camera to target [cm]; None for an orthographic picture."""

    def __post_init__(self) -> None:
        numbers = (*self.target, self.extent, self.azimuth, self.elevation, self.roll)
        if not np.isfinite(numbers).all() or self.extent <= 0:
            raise RenderError(
                "a camera needs finite numbers and an extent above 0 cm; "
                f"target {self.target}, extent {self.extent} cm"
            )
        if self.distance is not None and not self.distance > MIN_DISTANCE:
            raise RenderError(
                f"a camera {self.distance} cm from its target is too near; "
                f"choose more than {MIN_DISTANCE:.0f} cm"
            )

    @property
    def axes(self) -> Float[np.ndarray, "3 3"]:
        """Rows: right, up and towards the camera, as unit vectors of the world."""
        (ca, ce, cr) = np.cos([self.azimuth, self.elevation, self.roll])
        (sa, se, sr) = np.sin([self.azimuth, self.elevation, self.roll])
        right = np.array([ca, 0.0, -sa])
        up = np.array([-sa * se, ce, -ca * se])
        towards = np.array([sa * ce, se, ca * ce])
        return np.stack([cr * right - sr * up, sr * right + cr * up, towards])

    @property
    def stand(self) -> float:
        """Distance of the plane from which depth is measured [cm]."""
        return ORTHOGRAPHIC_DISTANCE if self.distance is None else self.distance

    @property
    def focal_mm(self) -> float:
        """Focal length that gives this perspective on 35 mm film; infinite when orthographic."""
        return np.inf if self.distance is None else FILM_HEIGHT_MM * self.distance / self.extent

    def through_lens(self, focal_mm: float) -> "Camera":
        """The same extent in the perspective of a lens, named by its focal length on 35 mm film."""
        return replace(self, distance=focal_mm * self.extent / FILM_HEIGHT_MM)

    def project(
        self, points: Float[np.ndarray, "n 3"], samples: int
    ) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
        """Column and row [sample] and depth [cm] of world points; row 0 at the top.

        Raises:
            RenderError: a point lies behind a perspective camera or at it.
        """
        x, y, z = self.axes @ (points - np.array(self.target)).T
        depth = self.stand - z
        scale: float | np.ndarray = samples / self.extent
        if self.distance is not None:
            if len(depth) and depth.min() < MIN_DISTANCE:
                raise RenderError(
                    f"the camera, {self.distance:.0f} cm from its target, stands inside what it "
                    "shows; move it away or choose a longer lens"
                )
            scale = scale * self.distance / depth
        return x * scale, -y * scale, depth


def view(name: str, points: Float[np.ndarray, "n 3"]) -> Camera:
    """An orthographic camera that shows all `points` from a named view, whatever their turn.

    The picture is as large for every view, so that views of one body can stand beside each other.

    Raises:
        RenderError: there is no view of that name.
    """
    if name not in VIEWS:
        raise RenderError(f"there is no view {quoted(name)}; choose {', '.join(VIEWS)}")
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    width = 2 * float(np.hypot(points[:, 0], points[:, 2]).max())
    extent = MARGIN * max(width, float(high[1] - low[1]))
    return Camera((0.0, float(middle[1]), 0.0), extent, VIEWS[name])
