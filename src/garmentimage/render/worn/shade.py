"""Light on what is seen: shadows, lamps and drawn seams, pixel by pixel.

The shading model stands above the compiled loops in `_kernels_shade`.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32, Int, Int32

from garmentimage.render.worn import _kernels_shade as kernels
from garmentimage.render.worn._kernels_zbuffer import Screen, draw_lines
from garmentimage.render.worn.camera import Camera
from garmentimage.render.worn.light import Light
from garmentimage.render.worn.prints import light_tile
from garmentimage.render.worn.surface import Surface
from garmentimage.render.worn.zbuffer import MAX_CACHED, Visible, seen_by

NO_SURFACE = -1  # panel id of pixels in which nothing is seen
SUPERSAMPLES = 2  # samples of a pixel along each axis
SEAM_BREADTH, MIN_SEAM_BREADTH = 0.5, 0.7
"""Breadth of a drawn seam [cm], and the least it has [pixel]."""
LINE_REACH = 0.8  # a drawn seam shows through surfaces less than this nearer [cm]
HEM_INK = 0.55  # ink of a free edge, as a share of a seam's
AO_RADIUS = 9.0
"""What is farther away than this takes no light from a point's surroundings [cm]."""
AO_PROBES, SMALL_AO_PROBES, SMALL = (3, 8), (2, 6), 128
"""Rings and spokes of the probes, and those in pictures smaller than the last number [pixel]."""
SHADOW_SOFTNESS = 2.2  # the edge of a cast shadow is softened over this radius [cm]
SHADOW_PROBES = (2, 6)  # rings and spokes of the probes that soften it
SHADOW_SIZES = (128, 512)  # smallest and largest picture taken from the light [pixel]
SHADOW_WIDENED = 1.25  # its extent over that of the picture: what lies beyond casts no shadow


def shape_of(surface: Surface, camera: Camera) -> kernels.Shape:
    """A surface as a camera sees it."""
    depth, normals = _still_turned(surface, camera) if surface.still else _turned(surface, camera)
    return kernels.Shape(depth, normals, surface.faces, surface.ids)


def _turned(
    surface: Surface, camera: Camera
) -> tuple[Float[np.ndarray, " vertex"], Float[np.ndarray, "vertex 3"]]:
    """Depth of the vertices [cm] and normals in the axes of the camera."""
    depth = camera.stand - (surface.points - np.array(camera.target)) @ camera.axes[2]
    return depth, surface.normals @ camera.axes.T


_still_turned = lru_cache(maxsize=MAX_CACHED)(_turned)


def dye_of(surface: Surface, sample: float) -> kernels.Dye:
    """Colours of a surface, and its print at the size of a sample [cm]; plain where it has none."""
    printed = surface.cloth_print
    if printed is None or surface.flat is None:
        return kernels.Dye(
            surface.light, np.zeros((0, 3, 2)), np.zeros((1, 1, 3), np.float32), 1.0, 1.0
        )
    tile = light_tile(printed, sample)
    return kernels.Dye(surface.light, surface.flat, tile, printed.width, printed.height)


def maps_of(
    shapes: Sequence[kernels.Shape], seen: Visible, pixels: Int32[np.ndarray, "pixel 4"], size: int
) -> kernels.Maps:
    """Depth, normal and panel of what lies nearest in each pixel."""
    maps = kernels.Maps(
        np.full((size, size), np.inf, np.float32),
        np.zeros((size, size, 3), np.float32),
        np.full((size, size), NO_SURFACE, np.int16),
    )
    for number, shape in enumerate(shapes, start=1):
        kernels.map_nearest(number, pixels, seen, shape, maps)
    return maps


def open_share_of(
    pixels: Int32[np.ndarray, "pixel 4"], maps: kernels.Maps, camera: Camera, light: Light
) -> Float32[np.ndarray, "row col"]:
    """Share of the light from all round that reaches each pixel."""
    size = len(maps.depth)
    share = np.ones((size, size), np.float32)
    if light.occlusion > 0:
        pixel = camera.extent / size
        rings, spokes = AO_PROBES if size >= SMALL else SMALL_AO_PROBES
        probes = _pixel_probes(max(1.5, AO_RADIUS / pixel), rings, spokes)
        kernels.find_open_share(pixels, maps, probes, pixel, AO_RADIUS, light.occlusion, share)
    return share


@lru_cache(maxsize=16)
def _pixel_probes(radius: float, rings: int, spokes: int) -> Int[np.ndarray, "probe 2"]:
    """Probes at whole pixels, none at the pixel itself."""
    probes = np.rint(probe_offsets(radius, rings, spokes)).astype(np.int64)
    steps: np.ndarray = probes[(probes != 0).any(axis=1)]
    return steps


def lit_share_of(
    pixels: Int32[np.ndarray, "pixel 4"],
    scene: Sequence[Surface],
    depth: Float32[np.ndarray, "row col"],
    camera: Camera,
    light: Light,
) -> Float32[np.ndarray, "row col"]:
    """Share of the key light that reaches each pixel."""
    size = len(depth)
    share = np.ones((size, size), np.float32)
    if light.shadow == 0 or light.key == 0:
        return share
    lamp = light.key_camera(camera, SHADOW_WIDENED)
    span = int(np.clip(size, *SHADOW_SIZES))
    from_lamp = seen_by(scene, lamp, span, "lamp")
    scale = span / lamp.extent
    slope = 0.0 if camera.distance is None else 1 / camera.distance
    softening = probe_offsets(SHADOW_SOFTNESS * scale, *SHADOW_PROBES)
    kernels.find_lit_share(
        pixels,
        depth,
        kernels.PictureRays(slope, camera.extent, camera.stand),
        kernels.ShadowMap(from_lamp.near, lamp.axes @ camera.axes.T, scale, lamp.stand, softening),
        light.shadow,
        share,
    )
    return share


def ink_of(
    scene: Sequence[Surface], seen: Visible, camera: Camera
) -> Float32[np.ndarray, "row col"]:
    """How much of a drawn seam each sample shows."""
    samples = len(seen.near)
    ink = np.zeros((samples, samples), np.float32)
    breadth = max(SEAM_BREADTH * samples / camera.extent, MIN_SEAM_BREADTH * SUPERSAMPLES)
    for surface in scene:
        x, y, depth = camera.project(surface.points, samples)
        screen = Screen(x + samples / 2, y + samples / 2, depth - surface.lift)
        for lines, shade_of in ((surface.seams, 1.0), (surface.hems, HEM_INK)):
            draw_lines(screen, lines, breadth / 2, LINE_REACH, shade_of, seen.near, ink)
    return ink


def probe_offsets(radius: float, rings: int, spokes: int) -> Float32[np.ndarray, "probe 2"]:
    """Points in a disk about 0, mirrored in both axes so that mirrored scenes look mirrored."""
    angle = np.tile((np.arange(spokes) + 0.5) * 2 * np.pi / spokes, (rings, 1))
    # Every other ring is turned by half a spoke, which keeps the mirrors.
    angle[1::2] += np.pi / spokes
    far = radius * np.sqrt((np.arange(rings) + 0.5) / rings)
    points = far[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    offsets: np.ndarray = points.reshape(-1, 2).astype(np.float32)
    return offsets
