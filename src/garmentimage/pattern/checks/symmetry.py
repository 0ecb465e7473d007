"""Where the wearer's middle is in the world of a file: a garment's plane of symmetry.

The format has it at x = 0, but the origin of a file may be elsewhere. A garment that is its own
mirror image about another plane x = c is meant to be worn with that plane in the middle. Most
garments are symmetric but for details; one that is asymmetric on purpose has no such plane.
"""

from itertools import combinations_with_replacement

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from garmentimage.pattern.finding import Finding
from garmentimage.pattern.model import Pattern

SHARES = np.linspace(0, 1, 9)  # where along an edge its points are taken
MIRROR_TOL = 1.0  # a point has a mirror image where another point is within this of it [cm]
SYMMETRIC = 0.7  # share of the points of a symmetric garment that have mirror images
MORE = 0.3
"""By so much a larger share than about x = 0: of 2,800 real garments none has that anywhere."""
NEAR_ORIGIN = 4.0
"""Planes nearer to x = 0 are taken for it [cm]: garments hang over by as much on purpose."""
OFF_CENTRE = 0.5
"""The mean of x over the cloth of a garment, over half its width, is less; real ones: to 0.39."""


def symmetry_plane(pattern: Pattern) -> float | None:
    """Where along x the wearer's middle is [cm]: 0 where the garment is drawn about it.

    None where no plane is one of symmetry, x = 0 included.
    """
    panels = _panel_points(pattern)
    points = np.concatenate(panels)
    tree = KDTree(points)
    about_origin = _mirrored_share(points, tree, 0.0)
    if about_origin >= SYMMETRIC:
        return 0.0
    planes = [x for x in _candidates(panels) if abs(x) >= NEAR_ORIGIN]
    shares = [_mirrored_share(points, tree, x) for x in planes]
    best = max(shares, default=0.0)
    if best >= max(SYMMETRIC, about_origin + MORE):
        return planes[shares.index(best)]
    return None


def off_centre(pattern: Pattern) -> Finding | None:
    """Whether the garment lies beside its wearer, and no symmetry says where its middle is."""
    panels = _panel_points(pattern)
    across = np.array([(p[:, 0].min() + p[:, 0].max()) / 2 for p in panels])
    areas = [abs(panel.outline.area) for panel in pattern.panels]
    middle = float(np.average(across, weights=areas)) if sum(areas) else float(across.mean())
    half_width = float(np.ptp(np.concatenate(panels)[:, 0])) / 2
    if abs(middle) <= OFF_CENTRE * half_width or symmetry_plane(pattern) is not None:
        return None
    message = (
        f"the garment lies {abs(middle):.0f} cm to the {'left' if middle > 0 else 'right'} of its "
        "wearer, and is not symmetric, so its middle is not known; move its panels along x, so "
        "that x = 0 is in the middle of the body"
    )
    return Finding("placement", message, "off-centre")


def _panel_points(pattern: Pattern) -> list[Float[np.ndarray, "_ 3"]]:
    """Points along the edges of every panel, in the world [cm]."""
    return [
        panel.to_world(np.concatenate([curve.at(SHARES) for curve in panel.curves]))
        for panel in pattern.panels
    ]


def _mirrored_share(points: Float[np.ndarray, "n 3"], tree: KDTree, plane: float) -> float:
    """Share of the points that have a mirror image about a plane x = `plane` among them."""
    mirrored = points * (-1, 1, 1) + (2 * plane, 0, 0)
    distances, _ = tree.query(mirrored, distance_upper_bound=MIRROR_TOL)
    return float(np.isfinite(distances).mean())


def _candidates(panels: list[Float[np.ndarray, "_ 3"]]) -> list[float]:
    """Planes about which two panels may be mirror images of each other, or one of itself [cm]."""
    low = np.array([p.min(axis=0) for p in panels])
    high = np.array([p.max(axis=0) for p in panels])
    i, j = np.array(list(combinations_with_replacement(range(len(panels)), 2))).T
    # The same heights and depths, and the same width.
    apart = [(low[i] - low[j])[:, 1:], (high[i] - high[j])[:, 1:]]
    apart.append((high[i] - low[i] - high[j] + low[j])[:, :1])
    alike = np.abs(np.concatenate(apart, axis=1)).max(axis=1) < MIRROR_TOL
    planes = (low[i] + high[j])[alike, 0] / 2
    _, first = np.unique(planes.round(1), return_index=True)
    found: list[float] = planes[first].tolist()
    return found
