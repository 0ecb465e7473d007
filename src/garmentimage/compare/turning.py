"""Panels turned freely in their own coordinates, where quarter turns do not make them alike.

The frame of a panel says nothing of its shape. Without marks a decoded panel has one of its own:
that of the grid, or midway between those of two parts that were joined.
"""

import numpy as np
from jaxtyping import Complex, Float

from garmentimage.compare.matching import BOUNDARY_POINTS, loop_polygon, panel_iou
from garmentimage.compare.pairing import posed, posed_panel
from garmentimage.geometry import resample
from garmentimage.pattern import Panel, Pattern

MIN_AREA_RATIO = 0.8  # of two panels that may be each other's counterpart
GAIN = 0.02  # IoU that a turn must be worth


def turned_freely(truth: Pattern, found: Pattern) -> Pattern:
    """`found`, each panel turned as its likeliest counterpart is, where that makes them more alike.

    The panels stay in their places; only their own coordinates turn.
    """
    boundaries = {panel.name: _boundary(panel) for panel in truth.panels}

    def turn(panel: Panel) -> Float[np.ndarray, "2 2"] | None:
        area = abs(panel.outline.area)
        likely = [
            other
            for other in truth.panels
            if MIN_AREA_RATIO * area <= abs(other.outline.area) <= area / MIN_AREA_RATIO
        ]
        if not likely:
            return None
        own = _boundary(panel)
        fits = []
        for other in likely:
            wanted = boundaries[other.name]
            if (panel.outline.area > 0) != (other.outline.area > 0):
                wanted = -wanted.conj()[::-1]  # seen from the other side
            fits.append(_best_turn(wanted, own))
        best = max(range(len(likely)), key=lambda k: fits[k][0])
        cos, sin = np.cos(fits[best][1]), np.sin(fits[best][1])
        pose = np.array([[cos, -sin], [sin, cos]])
        candidate = posed_panel(panel, pose)
        before, after = (
            panel_iou(likely[best], each, any_pose=True) for each in (panel, candidate)
        )
        return pose if after > before + GAIN else None

    turns = {panel.name: turn(panel) for panel in found.panels}
    return posed(found, {name: pose for name, pose in turns.items() if pose is not None})


def _boundary(panel: Panel) -> Complex[np.ndarray, " point"]:
    """Points at equal distances round the outline, counter-clockwise, about their middle."""
    polygon = loop_polygon(panel.outline)
    if panel.outline.area < 0:
        polygon = polygon[::-1]
    shares = np.arange(BOUNDARY_POINTS) / BOUNDARY_POINTS
    points = resample(np.concatenate([polygon, polygon[:1]]), shares) @ np.array([1, 1j])
    return np.asarray(points - points.mean())


# Over all rotations by a and cyclic shifts s, sum |exp(i a) q_(k + s) - p_k|² is least where the
# modulus of c_s = sum conj(q_(k + s)) p_k is largest, and a is its argument (Procrustes). All c_s
# are one cross-correlation, by FFT.
def _best_turn(
    wanted: Complex[np.ndarray, " point"], given: Complex[np.ndarray, " point"]
) -> tuple[float, float]:
    """How well `given` fits `wanted` once turned, -1 to 1 (the same), and the angle [rad]."""
    products = np.fft.ifft(np.fft.fft(wanted) * np.fft.fft(given).conj())
    best = products[np.abs(products).argmax()]
    size = (np.abs(wanted) ** 2).mean() + (np.abs(given) ** 2).mean()
    return float(2 * np.abs(best) / size), float(np.angle(best))
