"""Pictures of worn garments, with depth, normals, panels and silhouette from the same call.

    views = picture(surfaces_of(worn), body_camera(worn.body), size=256)
    save_png("front.png", views.colour)

Row 0 of every picture is at the TOP, unlike the rasters of this project. Rendering runs on one CPU
core without a window system and gives the same bits for the same input.
"""

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32, Int, Int16, Int32, UInt8

from garmentimage.body import Body
from garmentimage.errors import RenderError
from garmentimage.render.worn._kernels_shade import (
    find_pixels,
    lit_share,
    nearest,
    open_share,
    shade,
)
from garmentimage.render.worn._kernels_zbuffer import draw_faces, draw_lines
from garmentimage.render.worn.background import PLAIN, filled
from garmentimage.render.worn.camera import Camera, view
from garmentimage.render.worn.light import STUDIO, Light
from garmentimage.render.worn.prints import light_tile
from garmentimage.render.worn.shade import NO_SURFACE, probe_offsets
from garmentimage.render.worn.surface import Surface
from garmentimage.render.worn.tint import encoded
from garmentimage.render.worn.zbuffer import Visible, snapped

SIZE_LIMITS = (16, 2048)
"""Smallest and largest picture [pixel]."""
SUPERSAMPLES = 2
"""Samples of a pixel, each way."""
SURFACE_LIMIT = 250
"""Most surfaces of one picture."""
SEAM_BREADTH, LEAST_BREADTH = 0.5, 0.7
"""Breadth of a drawn seam [cm], and the least it has [pixel]."""
LINE_REACH = 0.8
"""A drawn seam shows through surfaces less than this nearer [cm]."""
HEM_INK = 0.55
"""Ink of a free edge, as a share of a seam's."""
AO_RADIUS = 9.0
"""What is farther away than this takes no light from a point's surroundings [cm]."""
AO_PROBES = (3, 8)
"""Rings and spokes of the probes ..."""
SMALL_AO_PROBES = (2, 6)
"""... and in pictures smaller than `SMALL`."""
SMALL = 128
SHADOW_SOFTNESS = 2.2
"""Over this radius the edge of a cast shadow is softened [cm]."""
SHADOW_PROBES = (2, 6)
SHADOW_SIZES = (128, 512)
"""Smallest and largest picture taken from the light [pixel]."""
SHADOW_WIDENED = 1.25
"""Its extent over that of the picture: what lies beyond casts no shadow."""
KEPT = 6
"""Views of still surfaces that are kept."""


@dataclass(frozen=True, eq=False)
class Views:
    """One view, told in several ways; row 0 at the top."""

    colour: UInt8[np.ndarray, "row col 3"]
    """sRGB."""
    depth: Float32[np.ndarray, "row col"]
    """Distance from the plane of the camera [cm] of what is nearest; inf where nothing is. For an
    orthographic camera the target lies `ORTHOGRAPHIC_DISTANCE` away."""
    normal: Float32[np.ndarray, "row col 3"]
    """Unit normals in the axes of the camera (right, up, towards it), turned to the viewer where
    the inside is seen; 0 where nothing is."""
    panel: Int16[np.ndarray, "row col"]
    """Number of the panel in the pattern + 1; 0 on a body, -1 where nothing is seen."""
    silhouette: Float32[np.ndarray, "row col"]
    """Share of the pixel in which cloth is seen."""


def body_camera(body: Body, name: str = "front") -> Camera:
    """A named view (see `camera.VIEWS`) that holds the whole body."""
    return view(name, body.vertices)


def picture(
    surfaces: Sequence[Surface],
    camera: Camera,
    *,
    size: int = 512,
    light: Light = STUDIO,
    background: Float32[np.ndarray, "row col 3"] = PLAIN,
    seams: bool = False,
) -> Views:
    """Picture of surfaces.

    Cloth lies within millimetres of the skin, nearer than the chords of their triangles allow; see
    `Surface.lift` for how skin is kept from showing through. What the camera sees of `still`
    surfaces is kept, so further garments on the same body cost little.

    Args:
        surfaces: what to show, at most 250.
        camera: from where.
        size: rows and columns of the picture.
        light: how it is lit.
        background: what is behind, stretched over the picture; see `background`.
        seams: whether sewn and free edges are drawn as lines.

    Raises:
        RenderError: the size is out of range, or the camera stands among the surfaces.
    """
    low, high = SIZE_LIMITS
    if isinstance(size, bool) or not isinstance(size, int | np.integer) or not low <= size <= high:
        raise RenderError(f"a picture of {size} pixels: choose a whole number from {low} to {high}")
    if len(surfaces) > SURFACE_LIMIT:
        raise RenderError(
            f"{len(surfaces)} surfaces are too many for a picture; join them to {SURFACE_LIMIT}"
        )
    size = int(size)
    # Still surfaces first: their numbers, from 1, must not depend on the moving ones.
    scene = (*(s for s in surfaces if s.still), *(s for s in surfaces if not s.still))
    seen = _seen_by(scene, camera, size * SUPERSAMPLES, "camera")
    turned = [_turned(s, camera) for s in scene]
    silhouette, behind = np.empty((2, size, size), np.float32)
    pixels = np.empty((size * size, 4), np.int32)
    cloth_from = 1 + sum(s.still for s in scene)
    count = find_pixels(SUPERSAMPLES, cloth_from, seen.near, seen.owner, silhouette, behind, pixels)
    pixels = pixels[:count]

    depth, normal, panel = _nearest(scene, seen, turned, pixels, size)
    open_sky = _open_sky(pixels, depth, normal, camera, light)
    lit = _lit(pixels, scene, depth, camera, light)
    ink = _ink(scene, seen, camera) if seams else np.zeros((0, 0), np.float32)
    glow = filled(background, size) * behind[..., None]
    lamps = light.lamps(camera)
    for number, (surface, (_, normals)) in enumerate(zip(scene, turned), start=1):
        flat, tile, width, height = _dye(surface, camera.extent / (size * SUPERSAMPLES))
        shade(
            number, SUPERSAMPLES, pixels, seen.owner, seen.face, seen.weight,
            normals, surface.faces, surface.light, flat, tile, width, height,
            ink, lamps, open_sky, lit, glow,
        )  # fmt: skip
    return Views(encoded(glow), depth, normal, panel, silhouette)


def _dye(surface: Surface, sample: float) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Place of the corners on the flat cloth, tile of the print and its size; empty where plain."""
    dyed = surface.cloth_print
    if dyed is None or surface.flat is None:
        return np.zeros((0, 3, 2)), np.zeros((1, 1, 3), np.float32), 1.0, 1.0
    return surface.flat, light_tile(dyed, sample), dyed.width, dyed.height


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


def _seen_by(surfaces: Sequence[Surface], camera: Camera, samples: int, role: str) -> Visible:
    """What a camera sees of surfaces, still ones first, numbered from 1."""
    still = tuple(s for s in surfaces if s.still)
    seen = _BUFFERS.take(role, samples)
    seen.overwrite(_still_view(still, camera, samples) if still else None)
    _draw(surfaces[len(still) :], len(still) + 1, camera, seen)
    return seen


@lru_cache(maxsize=KEPT)
def _still_view(still: tuple[Surface, ...], camera: Camera, samples: int) -> Visible:
    seen = Visible.empty(samples)
    _draw(still, 1, camera, seen)
    return seen


def _draw(surfaces: Sequence[Surface], first: int, camera: Camera, seen: Visible) -> None:
    samples = len(seen.near)
    for number, surface in enumerate(surfaces, start=first):
        x, y, depth = camera.project(surface.points, samples)
        draw_faces(
            snapped(x, samples), snapped(y, samples), depth, surface.faces, surface.lift,
            surface.two_sided, camera.distance is not None, number,
            seen.near, seen.owner, seen.face, seen.weight,
        )  # fmt: skip


def _turned(
    surface: Surface, camera: Camera
) -> tuple[Float[np.ndarray, " vertex"], Float[np.ndarray, "vertex 3"]]:
    """Depth of the vertices [cm] and normals in the axes of the camera."""
    return _still_turned(surface, camera) if surface.still else _turn(surface, camera)


@lru_cache(maxsize=KEPT)
def _still_turned(
    surface: Surface, camera: Camera
) -> tuple[Float[np.ndarray, " vertex"], Float[np.ndarray, "vertex 3"]]:
    return _turn(surface, camera)


def _turn(
    surface: Surface, camera: Camera
) -> tuple[Float[np.ndarray, " vertex"], Float[np.ndarray, "vertex 3"]]:
    depth = camera.stand - (surface.points - np.array(camera.target)) @ camera.axes[2]
    return depth, surface.normals @ camera.axes.T


def _nearest(
    scene: Sequence[Surface],
    seen: Visible,
    turned: Sequence[tuple[np.ndarray, np.ndarray]],
    pixels: Int32[np.ndarray, "pixel 4"],
    size: int,
) -> tuple[
    Float32[np.ndarray, "row col"], Float32[np.ndarray, "row col 3"], Int16[np.ndarray, "row col"]
]:
    """Depth, normal and panel of what lies nearest in each pixel."""
    depth = np.full((size, size), np.inf, np.float32)
    normal = np.zeros((size, size, 3), np.float32)
    panel = np.full((size, size), NO_SURFACE, np.int16)
    for number, (surface, (away, normals)) in enumerate(zip(scene, turned), start=1):
        nearest(
            number, pixels, seen.owner, seen.face, seen.weight,
            away, normals, surface.faces, surface.ids, depth, normal, panel,
        )  # fmt: skip
    return depth, normal, panel


def _open_sky(
    pixels: Int32[np.ndarray, "pixel 4"],
    depth: Float32[np.ndarray, "row col"],
    normal: Float32[np.ndarray, "row col 3"],
    camera: Camera,
    light: Light,
) -> Float32[np.ndarray, "row col"]:
    """Share of the light from all round that reaches each pixel."""
    size = len(depth)
    share = np.ones((size, size), np.float32)
    if light.occlusion > 0:
        pixel = camera.extent / size
        rings, spokes = AO_PROBES if size >= SMALL else SMALL_AO_PROBES
        probes = _pixel_probes(max(1.5, AO_RADIUS / pixel), rings, spokes)
        open_share(pixels, depth, normal, probes, pixel, AO_RADIUS, light.occlusion, share)
    return share


@lru_cache(maxsize=16)
def _pixel_probes(radius: float, rings: int, spokes: int) -> Int[np.ndarray, "probe 2"]:
    """Probes at whole pixels, none at the pixel itself."""
    probes = np.rint(probe_offsets(radius, rings, spokes)).astype(np.int64)
    return probes[(probes != 0).any(axis=1)]


def _lit(
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
    from_lamp = _seen_by(scene, lamp, span, "lamp")
    scale = span / lamp.extent
    rays = 0.0 if camera.distance is None else 1 / camera.distance
    softening = probe_offsets(SHADOW_SOFTNESS * scale, *SHADOW_PROBES)
    lit_share(
        pixels, depth, rays, camera.extent, camera.stand, lamp.axes @ camera.axes.T,
        from_lamp.near, scale, lamp.stand, softening, light.shadow, share,
    )  # fmt: skip
    return share


def _ink(scene: Sequence[Surface], seen: Visible, camera: Camera) -> Float32[np.ndarray, "row col"]:
    """How much of a drawn seam each sample shows."""
    samples = len(seen.near)
    ink = np.zeros((samples, samples), np.float32)
    breadth = max(SEAM_BREADTH * samples / camera.extent, LEAST_BREADTH * SUPERSAMPLES)
    for surface in scene:
        x, y, depth = camera.project(surface.points, samples)
        for lines, shade_of in ((surface.seams, 1.0), (surface.hems, HEM_INK)):
            draw_lines(
                x + samples / 2, y + samples / 2, depth - surface.lift, lines,
                breadth / 2, LINE_REACH, shade_of, seen.near, ink,
            )  # fmt: skip
    return ink
