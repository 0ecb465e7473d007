"""Pictures of draped garments, with depth, normals, panels and silhouette from the same call.

    views = picture(surfaces_of(garment), body_camera(garment.body), size=256)
    save_png("front.png", views.colour)

Row 0 of every picture is at the TOP, unlike the rasters of this project. Rendering runs on one CPU
core without a window system and gives the same bits for the same input.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int16, UInt8

from garmentimage.body import Body
from garmentimage.errors import RenderError
from garmentimage.render.worn._kernels_shade import Lighting, find_pixels, shade
from garmentimage.render.worn.background import PLAIN, filled
from garmentimage.render.worn.camera import Camera, view
from garmentimage.render.worn.light import STUDIO, Light
from garmentimage.render.worn.shade import (
    SUPERSAMPLES,
    dye_of,
    ink_of,
    lit_share_of,
    maps_of,
    open_share_of,
    shape_of,
)
from garmentimage.render.worn.surface import Surface
from garmentimage.render.worn.tint import encoded
from garmentimage.render.worn.zbuffer import seen_by

SIZE_LIMITS = (16, 2048)  # smallest and largest picture [pixel]
MAX_SURFACES = 250  # most surfaces of one picture


@dataclass(frozen=True, eq=False)
class Views:
    """One view as several pictures; row 0 at the top."""

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
    if len(surfaces) > MAX_SURFACES:
        raise RenderError(
            f"{len(surfaces)} surfaces are too many for a picture; join them to {MAX_SURFACES}"
        )
    size = int(size)
    # Still surfaces first: their numbers, from 1, must not depend on the moving ones.
    scene = (*(s for s in surfaces if s.still), *(s for s in surfaces if not s.still))
    seen = seen_by(scene, camera, size * SUPERSAMPLES, "camera")
    silhouette, behind = np.empty((2, size, size), np.float32)
    pixels = np.empty((size * size, 4), np.int32)
    cloth_from = 1 + sum(s.still for s in scene)
    count = find_pixels(SUPERSAMPLES, cloth_from, seen, silhouette, behind, pixels)
    pixels = pixels[:count]

    shapes = [shape_of(s, camera) for s in scene]
    maps = maps_of(shapes, seen, pixels, size)
    lighting = Lighting(
        light.lamps(camera),
        open_share_of(pixels, maps, camera, light),
        lit_share_of(pixels, scene, maps.depth, camera, light),
    )
    ink = ink_of(scene, seen, camera) if seams else np.zeros((0, 0), np.float32)
    glow = filled(background, size) * behind[..., None]
    sample = camera.extent / (size * SUPERSAMPLES)
    for number, (surface, shape) in enumerate(zip(scene, shapes, strict=True), start=1):
        shade(number, pixels, seen, shape, dye_of(surface, sample), ink, lighting, glow)
    return Views(encoded(glow), maps.depth, maps.normal, maps.panel, silhouette)
