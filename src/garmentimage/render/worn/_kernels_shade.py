"""From what is seen at each sample to the light in each pixel: compiled loops.

Arrays are `[row col]` with row 0 at the top. A pixel holds `step` x `step` samples.
"""

# mypy: allow-untyped-defs, allow-untyped-decorators

import numpy as np
from numba import njit

INSIDE = 0.62
"""Light that the inside of cloth sends back, as a share of its outside's."""
INK_SHADE = 0.62
"""Share of the light that a fully inked line takes away."""
AO_BIAS = 0.12
"""Sine of the angle above a surface below which a neighbour does not darken it: the surface's own
facets would."""
AO_GAIN = 1.9
"""Darkening by occlusion over the mean of the probes' sines."""
SHADOW_BIAS = 1.2
"""What is less than this nearer to the light casts no shadow [cm]: thickness of skin and cloth in
the coarse picture from the light."""


@njit(cache=True, error_model="numpy")
def find_pixels(step, cloth_from, near, owner, silhouette, behind, pixels):
    """List the pixels in which something is seen, and how much of each; returns their number.

    Args:
        step: samples of a pixel, each way.
        cloth_from: number of the first surface that counts for `silhouette`.
        near: see `Visible`.
        owner: see `Visible`.
        silhouette: share of each pixel in which cloth is seen; is written to.
        behind: share in which nothing is; is written to.
        pixels: [pixel 4] row, column, and row and column of the nearest sample; is written to.
    """
    count = 0
    part = np.float32(1 / (step * step))
    for row in range(len(silhouette)):
        for col in range(len(silhouette)):
            cloth, body = 0, 0
            for i in range(row * step, (row + 1) * step):
                for j in range(col * step, (col + 1) * step):
                    if owner[i, j] >= cloth_from:
                        cloth += 1
                    elif owner[i, j] > 0:
                        body += 1
            silhouette[row, col] = cloth * part
            behind[row, col] = 1 - (cloth + body) * part
            if cloth + body == 0:
                continue
            best, r, c = np.float32(np.inf), 0, 0
            for i in range(row * step, (row + 1) * step):
                for j in range(col * step, (col + 1) * step):
                    if near[i, j] < best:
                        best, r, c = near[i, j], i, j
            pixels[count, 0], pixels[count, 1] = row, col
            pixels[count, 2], pixels[count, 3] = r, c
            count += 1
    return count


@njit(cache=True, error_model="numpy")
def _normal(normals, a, b, c, wb, wc, side):
    """Unit normal at a point of a face, towards the viewer: `side` is -1 for its inside."""
    wa = 1 - wb - wc
    x = side * (wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0])
    y = side * (wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1])
    z = side * (wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2])
    # Near outlines the smooth normal may turn away from the viewer, which a seen point cannot.
    z = max(z, 0.0)
    length = max(np.sqrt(x * x + y * y + z * z), 1e-9)
    return x / length, y / length, z / length


@njit(cache=True, error_model="numpy")
def nearest(
    number, pixels, owner, face, weight, vertex_depth, normals, faces, ids, depth, normal, panel
):
    """Depth, normal and id of the pixels in which surface `number` lies nearest."""
    for p in range(len(pixels)):
        row, col, r, c = pixels[p, 0], pixels[p, 1], pixels[p, 2], pixels[p, 3]
        if owner[r, c] != number:
            continue
        f = face[r, c]
        k, side = (f, 1.0) if f >= 0 else (-1 - f, -1.0)
        wb, wc = weight[r, c, 0], weight[r, c, 1]
        a, b, d = faces[k, 0], faces[k, 1], faces[k, 2]
        depth[row, col] = (
            (1 - wb - wc) * vertex_depth[a] + wb * vertex_depth[b] + wc * vertex_depth[d]
        )
        x, y, z = _normal(normals, a, b, d, wb, wc, side)
        normal[row, col, 0], normal[row, col, 1], normal[row, col, 2] = x, y, z
        panel[row, col] = ids[k]


@njit(cache=True, error_model="numpy")
def open_share(pixels, depth, normal, probes, pixel, radius, strength, share):
    """Share of the light from all round that reaches each pixel.

    Ambient obscurance in screen space: each probe, a pixel offset, that lies above the tangent
    plane and within `radius` [cm] takes light away by the sine of its angle above the plane.
    """
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
            above = x * nx + y * ny + z * nz
            if above <= 0:
                continue
            squared = x * x + y * y + z * z
            rise = above / np.sqrt(squared) - AO_BIAS
            total += max(0.0, rise) * max(0.0, 1 - squared / (radius * radius))
        share[row, col] = max(0.0, 1 - strength * AO_GAIN * total / len(probes))


@njit(cache=True, error_model="numpy")
def lit_share(
    pixels,
    depth,
    rays,
    extent,
    origin,
    turn,
    lamp_near,
    scale,
    lamp_stand,
    offsets,
    strength,
    share,
):
    """Share of the key light that reaches each pixel, by a picture taken from the light.

    Args:
        pixels: from `find_pixels`.
        depth: of the pixels [cm].
        rays: 0 for an orthographic camera, else 1 / its distance: breadth goes with depth.
        extent: breadth of the picture at the target [cm].
        origin: depth of the target [cm].
        turn: rotation from the camera's axes to those of the light.
        lamp_near: depth seen from the light [cm], which looks at the same target.
        scale: pixels of that picture per cm.
        lamp_stand: depth of the target in it [cm].
        offsets: [probe 2], steps over which the shadow's edge is softened [pixel of the light].
        strength: share of the light that a shadow takes.
        share: is written to.
    """
    size, span = len(depth), len(lamp_near)
    for p in range(len(pixels)):
        row, col = pixels[p, 0], pixels[p, 1]
        z = depth[row, col]
        breadth = extent / size * (z * rays if rays > 0 else 1.0)
        x, y = (col + 0.5 - size / 2) * breadth, (size / 2 - row - 0.5) * breadth
        z = origin - z
        lx = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z
        ly = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z
        lz = lamp_stand - (turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z)
        u, v = lx * scale + span / 2, span / 2 - ly * scale
        dark = 0.0
        for k in range(len(offsets)):
            i, j = int(np.floor(v + offsets[k, 1])), int(np.floor(u + offsets[k, 0]))
            if 0 <= i < span and 0 <= j < span:
                dark += min(1.0, max(0.0, lz - SHADOW_BIAS - lamp_near[i, j]))
        share[row, col] = 1 - strength * dark / len(offsets)


@njit(cache=True, error_model="numpy")
def _printed(flat, k, wb, wc, tile, width, height):
    """Light of a print at a point of face `k`, between the four nearest texels."""
    rows, cols = tile.shape[:2]
    wa = 1 - wb - wc
    u = (wa * flat[k, 0, 0] + wb * flat[k, 1, 0] + wc * flat[k, 2, 0]) / width * cols - 0.5
    v = -(wa * flat[k, 0, 1] + wb * flat[k, 1, 1] + wc * flat[k, 2, 1]) / height * rows - 0.5
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


@njit(cache=True, error_model="numpy")
def shade(
    number,
    step,
    pixels,
    owner,
    face,
    weight,
    normals,
    faces,
    colour,
    flat,
    tile,
    width,
    height,
    ink,
    lamps,
    open_sky,
    lit,
    light,
):
    """Add the light of surface `number` to the pixels, each sample by its share.

    Diffuse light of the key (wrapped round by its softness) and the fill, sky and ground by the
    slope, and a rim that grows with the cube of the turn away from the viewer.
    """
    part = 1 / (step * step)
    key, fill, up = lamps[0], lamps[2], lamps[4]
    rim, soft = lamps[7, 0], lamps[7, 1]
    for p in range(len(pixels)):
        row, col = pixels[p, 0], pixels[p, 1]
        for i in range(row * step, (row + 1) * step):
            for j in range(col * step, (col + 1) * step):
                if owner[i, j] != number:
                    continue
                f = face[i, j]
                k, side, own = (f, 1.0, part) if f >= 0 else (-1 - f, -1.0, part * INSIDE)
                wb, wc = weight[i, j, 0], weight[i, j, 1]
                x, y, z = _normal(normals, faces[k, 0], faces[k, 1], faces[k, 2], wb, wc, side)
                sun = max(0.0, (x * key[0] + y * key[1] + z * key[2] + soft) / (1 + soft))
                sun *= lit[row, col]
                back = max(0.0, x * fill[0] + y * fill[1] + z * fill[2])
                sky = (0.5 + 0.5 * (x * up[0] + y * up[1] + z * up[2])) * open_sky[row, col]
                ground = open_sky[row, col] - sky
                turned = 1 - z
                edge = rim * turned * turned * turned * open_sky[row, col]
                if len(ink):
                    own *= 1 - INK_SHADE * ink[i, j]
                red, green, blue = colour[k, 0], colour[k, 1], colour[k, 2]
                if len(flat):
                    dye = _printed(flat, k, wb, wc, tile, width, height)
                    red, green, blue = red * dye[0], green * dye[1], blue * dye[2]
                for c in range(3):
                    albedo = red if c == 0 else green if c == 1 else blue
                    power = (
                        lamps[1, c] * sun
                        + lamps[3, c] * back
                        + lamps[5, c] * sky
                        + lamps[6, c] * ground
                    )
                    light[row, col, c] += own * (albedo * power + edge)


@njit(cache=True, error_model="numpy")
def encode_srgb(light, table, codes):
    """Write 8-bit sRGB codes of linear light, by a table over its square root."""
    last = np.float32(len(table) - 1)
    for row in range(light.shape[0]):
        for col in range(light.shape[1]):
            for c in range(3):
                bright = min(max(light[row, col, c], np.float32(0)), np.float32(1))
                code = int(np.sqrt(bright) * last + np.float32(0.5))
                codes[row, col, c] = table[min(max(code, 0), len(table) - 1)]
