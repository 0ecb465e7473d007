"""How a scene is lit.

A **key** light from one side casts soft shadows, a **fill** light opposite lifts them, the **sky**
lights from above and the **ground** from below, and a **rim** brightens what turns away from the
viewer. Directions go with the camera, as a photographer's lamps do.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from garmentimage.errors import RenderError
from garmentimage.render.worn._kernels_shade import Lamps
from garmentimage.render.worn.camera import Camera
from garmentimage.render.worn.tint import Tint, linear, rgb


@dataclass(frozen=True)
class Light:
    """Lamps and surroundings. Strengths add up to about 1.3 for cloth that faces the key light."""

    azimuth: float = -0.65
    """Where the key light stands: 0 at the camera, positive to the right of the picture [rad]."""
    elevation: float = 0.7
    """How high it stands [rad]."""
    key: float = 0.78
    """Strength of the key light."""
    key_tint: Tint = "#fff6ea"
    fill: float = 0.16
    """Strength of the fill light."""
    ambient: float = 0.52
    """Strength of sky and ground together."""
    sky_tint: Tint = "#f2f6ff"
    ground_tint: Tint = "#a89a8e"
    rim: float = 0.10
    """Strength of the rim light."""
    softness: float = 0.3
    """How far the key light reaches round an edge: 0 a point, 1 a wall of light."""
    shadow: float = 0.75
    """Share of the key light that cast shadows take away; 0 casts none, which is quicker."""
    occlusion: float = 0.85
    """Share of the light from all round that folds and contacts lose; 0 is quicker."""

    def __post_init__(self) -> None:
        shares = (self.softness, self.shadow, self.occlusion)
        strengths = (self.key, self.fill, self.ambient, self.rim)
        if not (all(0 <= s <= 1 for s in shares) and all(0 <= s < np.inf for s in strengths)):
            raise RenderError(
                "the strengths of a light must not be negative, and its softness, shadow and "
                "occlusion must lie from 0 to 1"
            )

    def lamps(self, camera: Camera) -> Lamps:
        """The light as the shading reads it, in the axes of the camera."""
        cool = linear(rgb(self.sky_tint))

        def row(values: np.ndarray) -> Float32[np.ndarray, " 3"]:
            return np.asarray(values, np.float32)

        return Lamps(
            key_direction=row(direction(self.azimuth, self.elevation)),
            key=row(self.key * linear(rgb(self.key_tint))),
            fill_direction=row(direction(-self.azimuth, 0.3 * self.elevation)),
            fill=row(self.fill * cool),
            up=row(camera.axes[:, 1]),
            sky=row(self.ambient * cool),
            ground=row(self.ambient * linear(rgb(self.ground_tint))),
            rim=np.float32(self.rim),
            softness=np.float32(self.softness),
        )

    def key_camera(self, camera: Camera, widened: float) -> Camera:
        """An orthographic camera at the key light, with the target of the picture's camera."""
        x, y, z = camera.axes.T @ direction(self.azimuth, self.elevation)
        return Camera(
            camera.target,
            camera.extent * widened,
            float(np.arctan2(x, z)),
            float(np.arcsin(np.clip(y, -1, 1))),
        )


STUDIO = Light()  # soft light from the upper left
FLAT = Light(0.0, 0.5, 0.5, "white", 0.1, 0.62, "white", "white", 0.0, 0.5, 0.0, 0.0)
"""Even light without shadows, for pictures that a network learns from."""


def direction(azimuth: float, elevation: float) -> np.ndarray:
    """Unit vector in the axes of the camera, from what is lit to the lamp."""
    level = np.cos(elevation)
    return np.array([np.sin(azimuth) * level, np.sin(elevation), np.cos(azimuth) * level])
