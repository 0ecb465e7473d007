"""Compiled loops that shade a picture: from what is seen at each sample to the light in each pixel.

Normals are interpolated over each face and in the axes of the camera: z is towards it. Arrays are
`[row col]` with row 0 at the top. A pixel holds `step` x `step` samples.
"""

# mypy: allow-untyped-defs, allow-untyped-decorators

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Int, Int16
from numba import njit

INSIDE = 0.62  # light that the inside of cloth sends back, as a share of its outside's
INK_SHADE = 0.62  # share of the light that a fully inked line takes away
AO_BIAS = 0.12
"""Sine of the angle above a surface below which a neighbour does not darken it: the surface's own
facets would."""
AO_GAIN = 1.9  # darkening by occlusion over the mean of the probes' sines
SHADOW_BIAS = 1.2
"""What is less than this nearer to the light casts no shadow [cm]: thickness of skin and cloth in
the coarse picture from the light."""


class Shape(NamedTuple):
    """One surface as the camera sees it."""

    depth: Float[np.ndarray, " vertex"]  # of the vertices [cm]
    normals: Float[np.ndarray, "vertex 3"]  # in the axes of the camera
    faces: Int[np.ndarray, "face 3"]
    ids: Int[np.ndarray, " face"]  # what the panel picture shows


class Dye(NamedTuple):
    """Colour of a surface: one for each face, times a print where there is one."""

    colour: Float32[np.ndarray, "face 3"]  # linear light
    flat: Float[np.ndarray, "face_or_0 3 2"]
    """Place of the corners on the flat cloth [cm]; empty where there is no print."""
    tile: Float32[np.ndarray, "texel_row texel_col 3"]
    """Linear light of the repeated tile of the print."""
    width: float  # of the tile [cm]
    height: float


class Lamps(NamedTuple):
    """Lights of a scene in the axes of the camera; directions go from the surface to the lamp."""

    key_direction: Float32[np.ndarray, " 3"]
    key: Float32[np.ndarray, " 3"]  # linear light, as for the other lamps
    fill_direction: Float32[np.ndarray, " 3"]
    fill: Float32[np.ndarray, " 3"]
    up: Float32[np.ndarray, " 3"]  # the world's upward direction
    sky: Float32[np.ndarray, " 3"]
    ground: Float32[np.ndarray, " 3"]
    rim: np.float32
    softness: np.float32


class Lighting(NamedTuple):
    """Lamps, and how much of them reaches each pixel."""

    lamps: Lamps
    open_share: Float32[np.ndarray, "row col"]  # share of the light from all round
    lit_share: Float32[np.ndarray, "row col"]  # share of the key light


class Maps(NamedTuple):
    """What lies nearest in each pixel."""

    depth: Float32[np.ndarray, "row col"]
    normal: Float32[np.ndarray, "row col 3"]
    panel: Int16[np.ndarray, "row col"]


class PictureRays(NamedTuple):
    """How pixels of a picture lie in space."""

    slope: float
    """1 / distance of a perspective camera, whose breadth goes with depth; 0 if orthographic."""
    extent: float  # breadth of the picture at the target [cm]
    origin: float  # depth of the target [cm]


class ShadowMap(NamedTuple):
    """A picture taken from the key light, which looks at the same target."""

    near: Float32[np.ndarray, "row col"]  # depth seen from the light [cm]
    turn: Float[np.ndarray, "3 3"]  # rotation from the camera's axes to those of the light
    scale: float  # pixels of the map per cm
    origin: float  # depth of the target in it [cm]
    offsets: Float32[np.ndarray, "probe 2"]
    """Steps over which the shadow's edge is softened [pixel of the map]."""


@njit(cache=True, error_model="numpy")
def find_pixels(step, cloth_from, visible, silhouette, behind, pixels):
    """List the pixels in which something is seen, and how much of each; returns their number.

    A pixel has `step` samples along each axis; surfaces are cloth from number `cloth_from` on. What
    is written: the share of each pixel in which cloth is seen (`silhouette`), in which nothing is
    (`behind`); and [pixel 4] row, column, and row and column of the nearest sample (`pixels`).
    """
    near, owner = visible.near, visible.owner
    count = 0
    part = np.float32(1 / (step * step))
    for row in range(len(silhouette)):
        for col in range(len(silhouette)):
            # Samples that show cloth or anything, and the nearest one, which speaks for the pixel
            # in depth, normal and panel.
            cloth, seen, best, r, c = 0, 0, np.float32(np.inf), 0, 0
            for i in range(row * step, (row + 1) * step):
                for j in range(col * step, (col + 1) * step):
                    cloth += owner[i, j] >= cloth_from
                    seen += owner[i, j] > 0
                    if near[i, j] < best:
                        best, r, c = near[i, j], i, j
            silhouette[row, col] = cloth * part
            behind[row, col] = 1 - seen * part
            if seen > 0:
                pixels[count, 0], pixels[count, 1] = row, col
                pixels[count, 2], pixels[count, 3] = r, c
                count += 1
    return count


@njit(cache=True, error_model="numpy")
def _normal(normals, face, wb, wc, side):
    """Unit normal at a point of a face, towards the viewer: `side` is -1 for its inside."""
    a, b, c = face[0], face[1], face[2]
    wa = 1 - wb - wc
    x = side * (wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0])
    y = side * (wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1])
    z = side * (wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2])
    # Near outlines the smooth normal may turn away from the viewer, which a seen point cannot.
    z = max(z, 0.0)
    length = max(np.sqrt(x * x + y * y + z * z), 1e-9)
    return x / length, y / length, z / length


@njit(cache=True, error_model="numpy")
def map_nearest(number, pixels, visible, shape, maps):
    """Depth, normal and id of the pixels in which surface `number` lies nearest, into `maps`."""
    owner, face, weight = visible.owner, visible.face, visible.weight
    away, faces = shape.depth, shape.faces
    for p in range(len(pixels)):
        row, col, r, c = pixels[p, 0], pixels[p, 1], pixels[p, 2], pixels[p, 3]
        if owner[r, c] != number:
            continue
        f = face[r, c]
        k, side = (f, 1.0) if f >= 0 else (-1 - f, -1.0)
        wb, wc = weight[r, c, 0], weight[r, c, 1]
        a, b, d = faces[k, 0], faces[k, 1], faces[k, 2]
        maps.depth[row, col] = (1 - wb - wc) * away[a] + wb * away[b] + wc * away[d]
        x, y, z = _normal(shape.normals, faces[k], wb, wc, side)
        maps.normal[row, col, 0], maps.normal[row, col, 1], maps.normal[row, col, 2] = x, y, z
        maps.panel[row, col] = shape.ids[k]


# Ambient occlusion: screen-space obscurance by probes above the tangent plane, each weighted by the
# sine of its angle above it and less with distance (McGuire, Osman, Bukowski and Hennessy 2011,
# "The alchemy screen-space ambient obscurance algorithm").
@njit(cache=True, error_model="numpy")
def find_open_share(pixels, maps, probes, pixel, radius, strength, share):
    """Write the share of the light from all round that reaches each pixel: ambient occlusion.

    Args:
        pixels: from `find_pixels`.
        maps: depth and normals of the pixels.
        probes: [probe 2] steps across and down to the neighbours that may hide light [pixel].
        pixel: breadth of a pixel [cm].
        radius: neighbours farther off than this take nothing [cm].
        strength: share of the light that full occlusion takes.
        share: is written to.
    """
    depth, normal = maps.depth, maps.normal
    size = len(depth)
    for p in range(len(pixels)):
        row, col = pixels[p, 0], pixels[p, 1]
        here = depth[row, col]
        nx, ny, nz = normal[row, col, 0], normal[row, col, 1], normal[row, col, 2]
        total = 0.0
        for k in range(len(probes)):
            r, c = row + probes[k, 1], col + probes[k, 0]
            if r < 0 or c < 0 or r >= size or c >= size:
                continue
            z = here - depth[r, c]
            if z > radius or z < -radius:
                continue
            x, y = probes[k, 0] * pixel, -probes[k, 1] * pixel
            # Height over the tangent plane: what lies below it hides nothing.
            above = x * nx + y * ny + z * nz
            if above <= 0:
                continue
            # Sine of the angle above the plane, less with distance; small angles are facets.
            squared = x * x + y * y + z * z
            rise = above / np.sqrt(squared) - AO_BIAS
            total += max(0.0, rise) * max(0.0, 1 - squared / (radius * radius))
        share[row, col] = max(0.0, 1 - strength * AO_GAIN * total / len(probes))


# Cast shadows: a shadow map (Williams 1978, "Casting curved shadows on curved surfaces"), softened
# by the mean over several probes (percentage-closer filtering, Reeves, Salesin and Cook 1987). The
# test is not binary: what is less than 1 cm in front of the limit shadows in part.
@njit(cache=True, error_model="numpy")
def find_lit_share(pixels, depth, rays, shadow_map, strength, share):
    """Write the share of the key light that reaches each pixel; a shadow takes `strength` of it."""
    turn, scale, offsets = shadow_map.turn, shadow_map.scale, shadow_map.offsets
    size, span = len(depth), len(shadow_map.near)
    for p in range(len(pixels)):
        row, col = pixels[p, 0], pixels[p, 1]
        # The point of the pixel in the axes of the camera, from the target.
        z = depth[row, col]
        breadth = rays.extent / size * (z * rays.slope if rays.slope > 0 else 1.0)
        x, y = (col + 0.5 - size / 2) * breadth, (size / 2 - row - 0.5) * breadth
        z = rays.origin - z
        # The same point as the light sees it: place in the shadow map and depth.
        lx = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z
        ly = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z
        lz = shadow_map.origin - (turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z)
        u, v = lx * scale + span / 2, span / 2 - ly * scale
        # Share of the probes round it that something nearer to the light hides.
        dark = 0.0
        for k in range(len(offsets)):
            i, j = int(np.floor(v + offsets[k, 1])), int(np.floor(u + offsets[k, 0]))
            if 0 <= i < span and 0 <= j < span:
                dark += min(1.0, max(0.0, lz - SHADOW_BIAS - shadow_map.near[i, j]))
        share[row, col] = 1 - strength * dark / len(offsets)


@njit(cache=True, error_model="numpy")
def _print_at(dye, k, wb, wc):
    """Light of a print at a point of face `k`, between the four nearest texels."""
    flat, tile, width, height = dye.flat, dye.tile, dye.width, dye.height
    rows, cols = tile.shape[:2]
    wa = 1 - wb - wc
    u = (wa * flat[k, 0, 0] + wb * flat[k, 1, 0] + wc * flat[k, 2, 0]) / width * cols - 0.5
    v = -(wa * flat[k, 0, 1] + wb * flat[k, 1, 1] + wc * flat[k, 2, 1]) / height * rows - 0.5
    # Bilinear look-up; the tile repeats in both directions.
    left, top = np.floor(u), np.floor(v)
    su, sv = u - left, v - top
    c0, r0 = int(left) % cols, int(top) % rows
    c1, r1 = (c0 + 1) % cols, (r0 + 1) % rows
    w00, w01, w10, w11 = (1 - sv) * (1 - su), (1 - sv) * su, sv * (1 - su), sv * su
    red = w00 * tile[r0, c0, 0] + w01 * tile[r0, c1, 0]
    green = w00 * tile[r0, c0, 1] + w01 * tile[r0, c1, 1]
    blue = w00 * tile[r0, c0, 2] + w01 * tile[r0, c1, 2]
    red += w10 * tile[r1, c0, 0] + w11 * tile[r1, c1, 0]
    green += w10 * tile[r1, c0, 1] + w11 * tile[r1, c1, 1]
    blue += w10 * tile[r1, c0, 2] + w11 * tile[r1, c1, 2]
    return red, green, blue


# What is computed, for each pixel as the mean over its samples, in linear light:
#
#     light = albedo (K s k + F f + A o (sky u + ground (1 - u))) + rim r^3 o
#
# - Key light K: Lambert's cosine, wrapped round the shape by the softness w of the lamp, k = max(0,
#   (n . l + w) / (1 + w)); s is the share that no shadow takes.
# - Fill light F: Lambert's cosine f without shadows.
# - Sky and ground A: hemisphere lighting, u = (1 + n . up) / 2, times the share o of the
#   surroundings that a point sees.
# - Rim r: one minus the cosine between normal and line of sight.
@njit(cache=True, error_model="numpy")
def shade(number, pixels, visible, shape, dye, ink, lighting, light):
    """Add the linear light of surface `number` to the pixels of `light`, each sample by its share.

    `ink` says how much of a drawn line each sample shows; it is empty where none is drawn.
    """
    owner, face, weight = visible.owner, visible.face, visible.weight
    lamps, open_share, lit_share = lighting
    key, fill, up = lamps.key_direction, lamps.fill_direction, lamps.up
    rim, soft = lamps.rim, lamps.softness
    step = len(owner) // len(light)  # samples of a pixel along each axis
    part = 1 / (step * step)
    for p in range(len(pixels)):
        row, col = pixels[p, 0], pixels[p, 1]
        for i in range(row * step, (row + 1) * step):
            for j in range(col * step, (col + 1) * step):
                if owner[i, j] != number:
                    continue
                f = face[i, j]
                # Negative numbers say that the inside of a face is seen.
                k, side, own = (f, 1.0, part) if f >= 0 else (-1 - f, -1.0, part * INSIDE)
                wb, wc = weight[i, j, 0], weight[i, j, 1]
                x, y, z = _normal(shape.normals, shape.faces[k], wb, wc, side)
                # Wrapped Lambert: a soft lamp reaches round the edge of a shape.
                sun = max(0.0, (x * key[0] + y * key[1] + z * key[2] + soft) / (1 + soft))
                sun *= lit_share[row, col]
                # The fill light is not wrapped and casts no shadow.
                back = max(0.0, x * fill[0] + y * fill[1] + z * fill[2])
                # Sky and ground share the light from all round by the slope of the surface.
                sky = (0.5 + 0.5 * (x * up[0] + y * up[1] + z * up[2])) * open_share[row, col]
                ground = open_share[row, col] - sky
                # The rim light grows with the cube of the turn away from the viewer.
                turned = 1 - z
                edge = rim * turned * turned * turned * open_share[row, col]
                # Drawn seams darken the colour of the cloth, whatever its light.
                if len(ink):
                    own *= 1 - INK_SHADE * ink[i, j]
                tint = (1.0, 1.0, 1.0)
                if len(dye.flat):
                    tint = _print_at(dye, k, wb, wc)
                for c in range(3):
                    power = lamps.key[c] * sun + lamps.fill[c] * back
                    power = power + lamps.sky[c] * sky + lamps.ground[c] * ground
                    light[row, col, c] += own * (dye.colour[k, c] * tint[c] * power + edge)


@njit(cache=True, error_model="numpy")
def encode_srgb(light, table, codes):
    """Write 8-bit sRGB codes of linear light, by a table over its square root."""
    last = np.float32(len(table) - 1)
    for row in range(light.shape[0]):
        for col in range(light.shape[1]):
            for c in range(3):
                # Light beyond white is clipped.
                bright = min(max(light[row, col, c], np.float32(0)), np.float32(1))
                code = int(np.sqrt(bright) * last + np.float32(0.5))
                codes[row, col, c] = table[min(max(code, 0), len(table) - 1)]
