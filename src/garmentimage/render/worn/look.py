"""How a photograph of a draped garment varies: light, colours, prints, skin, background, camera."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from jaxtyping import Float32

from garmentimage.drape import DrapedGarment
from garmentimage.errors import RenderError, check_type
from garmentimage.render.worn.background import PLAIN, gradient, plain
from garmentimage.render.worn.camera import Camera
from garmentimage.render.worn.light import STUDIO, Light
from garmentimage.render.worn.photographing import Views, body_camera, picture
from garmentimage.render.worn.prints import Print, checks, dots, noise, stripes
from garmentimage.render.worn.surface import PAPER_COLOURS, SKIN, surfaces_of
from garmentimage.render.worn.tint import Tint

SKIN_TONES = (
    "#3d241a", "#5a3825", "#7d5138", "#a06d4b", "#c08d68", "#d8ab87", "#e8c4a6", "#f3d8c4"
)  # fmt: skip
"""From dark to light; a random tone lies between two neighbours."""
PLAIN_SHARE = 0.45  # how often a garment has no print
STRIPE_PERIODS, CHECK_PERIODS, DOT_PERIODS = (1.5, 9.0), (2.0, 12.0), (1.8, 7.0)
"""Least and greatest period of random prints [cm]."""


@dataclass(frozen=True)
class Look:
    """One way to photograph a garment. The camera's fields say how it differs from a given one."""

    light: Light = STUDIO
    """Lamps and surroundings."""
    skin: Tint = SKIN
    """Colour of the body."""
    colours: Mapping[str, Tint] = field(default_factory=lambda: PAPER_COLOURS)
    """Colours of the cloth by panel, label or group; see `surfaces_of`."""
    prints: Mapping[str, Print] = field(default_factory=lambda: MappingProxyType({}))
    """Prints by panel, label or group; a print's colours replace the cloth's."""
    background: Float32[np.ndarray, "row col 3"] = field(default_factory=lambda: PLAIN)
    """What stands behind; see `background`."""
    azimuth: float = 0.0
    """How far the camera goes round, towards the wearer's left [rad]."""
    elevation: float = 0.0
    """How far it rises [rad]."""
    roll: float = 0.0
    """How far it is turned about its line of sight, clockwise [rad]."""
    zoom: float = 1.0
    """How many times larger everything appears."""
    shift: tuple[float, float] = (0.0, 0.0)
    """How far the middle of the picture moves right and up, as shares of its breadth."""
    lens_mm: float | None = None
    """Focal length on 35 mm film; None for an orthographic picture."""

    def __post_init__(self) -> None:
        if not 0 < self.zoom < np.inf:
            raise RenderError(f"a zoom of {self.zoom}: choose a number above 0, as 1.0")

    def camera(self, camera: Camera) -> Camera:
        """A camera as this look changes it."""
        turned = replace(
            camera,
            extent=camera.extent / self.zoom,
            azimuth=camera.azimuth + self.azimuth,
            elevation=camera.elevation + self.elevation,
            roll=camera.roll + self.roll,
        )
        right, up, _ = turned.axes * turned.extent
        x, y, z = np.array(camera.target) + self.shift[0] * right + self.shift[1] * up
        turned = replace(turned, target=(float(x), float(y), float(z)))
        return turned if self.lens_mm is None else turned.through_lens(self.lens_mm)

    @staticmethod
    def random(rng: np.random.Generator) -> "Look":
        """A look as photographs vary; the same for the same state of the generator."""
        first, second, third = (random_tint(rng) for _ in range(3))
        prints = {}
        if rng.random() > PLAIN_SHARE:
            groups = [("top", "dress"), ("bottom",), ("top", "bottom", "dress")][rng.integers(3)]
            prints = dict.fromkeys(groups, random_print(rng))
        return Look(
            light=_random_light(rng),
            skin=_random_skin(rng),
            colours=MappingProxyType({"top": first, "bottom": second, "dress": third}),
            prints=MappingProxyType(prints),
            background=_random_background(rng),
            azimuth=float(rng.normal(0, 0.12)),
            elevation=float(rng.uniform(-0.05, 0.18)),
            roll=float(rng.normal(0, 0.015)),
            zoom=float(rng.uniform(0.88, 1.04)),
            shift=(float(rng.normal(0, 0.012)), float(rng.normal(0, 0.012))),
            lens_mm=float(rng.choice([35.0, 50.0, 85.0, 135.0])),
        )


def photograph(
    garment: DrapedGarment,
    look: Look | None = None,
    *,
    view: str = "front",
    size: int = 512,
    seams: bool = False,
) -> Views:
    """Picture of a garment on its body.

    Args:
        garment: the garment on its body.
        look: light, colours and the like; by default plain colours in a studio.
        view: one of `camera.VIEWS`.
        size: rows and columns of the picture, 16 to 2048.
        seams: whether sewn and free edges are drawn as lines.

    Raises:
        RenderError: there is no such view, or the size is out of range.
        TypeError: it is not a DrapedGarment.
    """
    check_type(garment, DrapedGarment, "garmentimage.drape_pattern makes one, load_drape reads one")
    look = look or Look()
    surfaces = surfaces_of(garment, skin=look.skin, colours=look.colours, prints=look.prints)
    camera = look.camera(body_camera(garment.body, view))
    return picture(
        surfaces, camera, size=size, light=look.light, background=look.background, seams=seams
    )


def random_tint(rng: np.random.Generator) -> Tint:
    """A colour that cloth may have: greys, dark and pale shades are as common as bright ones."""
    from colorsys import hsv_to_rgb

    grey = rng.random() < 0.2
    hue, strength = rng.random(), 0.04 if grey else rng.beta(2.0, 2.4)
    return hsv_to_rgb(float(hue), float(strength), float(rng.uniform(0.18, 0.96)))


def random_print(rng: np.random.Generator) -> Print:
    """Stripes, checks, dots or mottle in two random colours."""
    first, second = random_tint(rng), random_tint(rng)
    kind = rng.integers(4)
    if kind == 0:
        along = bool(rng.random() < 0.5)
        return stripes(first, second, period=float(rng.uniform(*STRIPE_PERIODS)), along=along)
    if kind == 1:
        return checks(first, second, period=float(rng.uniform(*CHECK_PERIODS)))
    if kind == 2:
        period, size = rng.uniform(*DOT_PERIODS), rng.uniform(0.2, 0.5)
        return dots(first, second, period=float(period), size=float(size))
    return noise(first, second, rng, period=float(rng.uniform(10, 40)))


def _random_skin(rng: np.random.Generator) -> Tint:
    """Between two neighbours of `SKIN_TONES`."""
    from PIL import ImageColor

    place = rng.uniform(0, len(SKIN_TONES) - 1)
    low = min(int(place), len(SKIN_TONES) - 2)
    dark, pale = (np.array(ImageColor.getrgb(SKIN_TONES[k])) / 255 for k in (low, low + 1))
    red, green, blue = dark + (place - low) * (pale - dark)
    return float(red), float(green), float(blue)


def _random_light(rng: np.random.Generator) -> Light:
    """A key light from either side, warm or cool, hard or soft."""
    warm = rng.uniform(-1, 1)
    key_tint = (1.0, 1 - 0.06 * abs(warm), 1 - 0.14 * warm) if warm > 0 else (
        1 + 0.1 * warm, 1 + 0.03 * warm, 1.0
    )  # fmt: skip
    key = rng.uniform(0.45, 0.95)
    return Light(
        azimuth=float(rng.uniform(-1.2, 1.2)),
        elevation=float(rng.uniform(0.25, 1.1)),
        key=float(key),
        key_tint=tuple(float(v) for v in key_tint),  # type: ignore[arg-type]
        fill=float(rng.uniform(0.05, 0.3)),
        # A dim key light goes with bright surroundings, as outdoors in the shade.
        ambient=float(1.25 - key - rng.uniform(0, 0.15)),
        rim=float(rng.uniform(0.03, 0.18)),
        softness=float(rng.uniform(0.1, 0.6)),
        shadow=float(rng.uniform(0.5, 0.9)),
    )


def _random_background(rng: np.random.Generator) -> Float32[np.ndarray, "row col 3"]:
    """Plain or a gradient, more often pale than dark."""
    tints = []
    for _ in range(2):
        level, cast = rng.beta(3, 1.5), rng.normal(0, 0.035, 3)
        red, green, blue = np.clip(level + cast, 0, 1)
        tints.append((float(red), float(green), float(blue)))
    return plain(tints[0]) if rng.random() < 0.4 else gradient(tints[0], tints[1])
