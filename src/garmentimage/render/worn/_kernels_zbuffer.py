"""Compiled loops that find which triangle is seen at each sample: a z-buffer."""

# mypy: allow-untyped-defs, allow-untyped-decorators

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numba import njit


class Screen(NamedTuple):
    """Vertices on the picture."""

    x: Float[np.ndarray, " vertex"]  # column [sample], from the left edge
    y: Float[np.ndarray, " vertex"]  # row [sample], from the top edge
    depth: Float[np.ndarray, " vertex"]  # [cm]


# A triangle is scanned over its bounding box with edge functions (Pineda 1988, "A parallel
# algorithm for polygon rasterization"): twice the signed areas s_a, s_b, s_c of a sample's centre
# with each side, all of one sign inside; their shares of the whole are the barycentric weights. Of
# all triangles over a sample the nearest is kept. In perspective, what is linear over the picture
# is 1 / z, and a weight over z: z = 1 / sum(w_i / z_i), and corrected weights are w_i z / z_i.
@njit(cache=True, error_model="numpy")
def draw_faces(screen, faces, lift, two_sided, perspective, number, visible):
    """Draw the triangles of surface `number` into the buffers of a `Visible`.

    Cloth lies so near to the skin that chords of one cut through the other. So a face is drawn
    `lift` [cm] off its place along the line of sight: towards the viewer where its outside is seen,
    away where its inside is.

    Faces run counter-clockwise seen from outside; their insides are drawn if `two_sided`.
    """
    x, y, depth = screen
    near, owner, face, weight = visible
    rows, cols = near.shape
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        xa, ya, xb, yb, xc, yc = x[a], y[a], x[b], y[b], x[c], y[c]
        # Rows run downwards: a face seen from outside turns clockwise on the screen.
        area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)
        if area == 0 or (area > 0 and not two_sided):
            continue
        # Whichever side is seen, `sign` makes the edge functions positive inside.
        outside = area < 0
        push = lift if outside else -lift
        sign = -1.0 if outside else 1.0
        size = area * sign
        # Samples whose centres lie in the bounding box.
        left = max(0, int(np.ceil(min(xa, xb, xc) - 0.5)))
        right = min(cols - 1, int(np.floor(max(xa, xb, xc) - 0.5)))
        top = max(0, int(np.ceil(min(ya, yb, yc) - 0.5)))
        bottom = min(rows - 1, int(np.floor(max(ya, yb, yc) - 0.5)))
        for row in range(top, bottom + 1):
            py = row + 0.5
            for col in range(left, right + 1):
                px = col + 0.5
                # Edge functions: exact on the grid of 1/256 sample, so that no sample is missed.
                sb = sign * ((px - xa) * (yc - ya) - (xc - xa) * (py - ya))
                sc = sign * ((xb - xa) * (py - ya) - (px - xa) * (yb - ya))
                sa = size - sb - sc
                if sa < 0 or sb < 0 or sc < 0:
                    continue
                wb, wc = sb / size, sc / size
                if perspective:
                    ra, rb, rc = (1 - wb - wc) / depth[a], wb / depth[b], wc / depth[c]
                    z = 1 / (ra + rb + rc)
                    wb, wc = rb * z, rc * z
                else:
                    z = depth[a] + wb * (depth[b] - depth[a]) + wc * (depth[c] - depth[a])
                # Compared as it is kept, so that order does not matter but for exact ties.
                z = np.float32(z - push)
                if z < near[row, col]:
                    near[row, col] = z
                    owner[row, col] = number
                    face[row, col] = f if outside else -1 - f
                    weight[row, col, 0] = wb
                    weight[row, col, 1] = wc


@njit(cache=True, error_model="numpy")
def draw_lines(screen, lines, radius, reach, shade, near, ink):
    """Mark with `shade` the samples within `radius` [sample] of lines that nothing hides.

    A line lies in the surface it is drawn on, and half of its breadth may lie deeper: what is less
    than `reach` [cm] nearer does not hide it. The distance of a sample is that to the nearest point
    of the segment, whose share t along it is clamped to 0 and 1.

    `near` is the depth of what is seen [cm]; `shade`, from 0 to 1, is written to `ink`.
    """
    x, y, depth = screen
    rows, cols = near.shape
    for k in range(len(lines)):
        a, b = lines[k, 0], lines[k, 1]
        dx, dy = x[b] - x[a], y[b] - y[a]
        length = dx * dx + dy * dy
        left = max(0, int(np.ceil(min(x[a], x[b]) - radius - 0.5)))
        right = min(cols - 1, int(np.floor(max(x[a], x[b]) + radius - 0.5)))
        top = max(0, int(np.ceil(min(y[a], y[b]) - radius - 0.5)))
        bottom = min(rows - 1, int(np.floor(max(y[a], y[b]) + radius - 0.5)))
        for row in range(top, bottom + 1):
            for col in range(left, right + 1):
                px, py = col + 0.5 - x[a], row + 0.5 - y[a]
                # The nearest point of the segment; a line may be a point.
                t = 0.0
                if length > 0:
                    t = min(1.0, max(0.0, (px * dx + py * dy) / length))
                gap = (px - t * dx) ** 2 + (py - t * dy) ** 2
                z = depth[a] + t * (depth[b] - depth[a])
                if gap <= radius * radius and z - reach < near[row, col]:
                    ink[row, col] = max(ink[row, col], shade)
