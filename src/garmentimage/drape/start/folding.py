"""Lapels and collars begin folded onto the cloth at rest beneath them, pockets lying on it."""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.folded import FoldedPanels, on_panels
from garmentimage.drape.solver import DistanceField
from garmentimage.pattern import Side

ROLL = 8.0
"""Where turned panel and stand are sewn together the collar rolls over: a stand begins leaning
outward there, over this length [cm]."""
REACH = 3.0  # folded cloth is carried by what of the cloth beneath lies about so near [cm]
LIFT = 0.3  # folded cloth begins this far outside of what it lies on [cm]
OVER, STEP = 6.0, 0.3
"""It begins over cloth that lies up to so far outside of there, found in steps of so many cm."""


def fold_onto(
    cloth: Cloth,
    points: Float[np.ndarray, "vertex 3"],
    folded: FoldedPanels,
    field: DistanceField,
    gap: float,
) -> Float[np.ndarray, "vertex 3"]:
    """Where the vertices of what is folded over begin, the cloth beneath being at `points` [cm].

    A turned panel is laid onto the panel that it is sewn to and carried by its cloth, at least
    `gap` [cm] outside of `field`, which wears it. A stand goes on straight beyond the seam, but
    leans outward near turned panels.
    """
    corners, outward = points[cloth.vertex], np.zeros((len(cloth.vertex), 3))
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    for name, (mine, other) in folded.seams.items():
        own, base = (np.flatnonzero(cloth.panel == number[s.panel]) for s in (mine, other))
        opened, laid = _along_seam(cloth, mine, other, own)
        corners[own], outward[own] = _carried(cloth, points, base, laid)
        if name in folded.stands:
            upright, _ = _carried(cloth, points, base, opened)
            away = from_seams(cloth, name, folded.turned, cloth.flat[own])
            lean = np.clip(1.0 - away / ROLL, 0.0, 1.0)[:, None]
            corners[own] = upright + lean * (corners[own] - upright)
            outward[own] *= lean > 0
    start = _lifted(cloth.sewn(corners), cloth.sewn(outward), field, gap)
    beneath = np.unique(cloth.vertex_faces[~on_panels(cloth, folded.names)])
    start[beneath] = points[beneath]
    return start


def lay_onto(
    cloth: Cloth, points: Float[np.ndarray, "vertex 3"], field: DistanceField, gap: float
) -> Float[np.ndarray, "vertex 3"]:
    """Where the vertices of what is sewn onto cloth begin, that cloth being at `points` [cm].

    Each panel lies where it is sewn on, at least `gap` [cm] outside of `field`, which wears the
    cloth beneath. What is only stitched to such panels begins at `points`.
    """
    corners, outward = points[cloth.vertex], np.zeros((len(cloth.vertex), 3))
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    for sewn in cloth.pattern.onto:
        own, base = (np.flatnonzero(cloth.panel == number[n]) for n in (sewn.panel, sewn.on))
        places = sewn.carried(cloth.flat[own])
        corners[own], outward[own] = _carried(cloth, points, base, places)
    return _lifted(cloth.sewn(corners), cloth.sewn(outward), field, gap)


def lie_over(
    cloth: Cloth,
    points: Float[np.ndarray, "vertex 3"],
    panels: Int[np.ndarray, " k"],
    field: DistanceField,
    gap: float,
) -> Float[np.ndarray, "vertex 3"]:
    """Where the vertices of overlapping panels begin, all cloth being at `points` [cm].

    Each is moved along the panel's own outward direction until it lies at least `gap` [cm] outside
    of `field`, which wears the cloth beneath. Vertices of other panels begin at `points`, too.
    """
    corners, outward = points[cloth.vertex], np.zeros((len(cloth.vertex), 3))
    for k in panels.tolist():
        own = np.flatnonzero(cloth.panel == k)
        _, outward[own] = _carried(cloth, points, own, cloth.flat[own])
    return _lifted(cloth.sewn(corners), cloth.sewn(outward), field, gap)


def from_seams(
    cloth: Cloth, name: str, others: frozenset[str], flat: Float[np.ndarray, "n 2"]
) -> Float[np.ndarray, " n"]:
    """How far places in a panel are from its seams to other panels; infinite without one [cm]."""
    lines = [
        cloth.flat[cloth.sides[mine]]
        for stitch in cloth.pattern.stitches
        for mine, other in (stitch.sides, stitch.sides[::-1])
        if mine.panel == name and other.panel in others
    ]
    if not lines:
        return np.full(len(flat), np.inf)
    return np.asarray(cKDTree(np.concatenate(lines)).query(flat)[0])


def _along_seam(
    cloth: Cloth, mine: Side, other: Side, corners: Int[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "n 2"]]:
    """Places of a panel's corners in the frame of the panel that it is sewn to: open, and folded.

    Each keeps its place along the seam and its distance from it. Open it lies beyond the edge of
    the other panel, folded it lies on that panel.
    """
    own_line, base_line = cloth.sides[mine], cloth.sides[other]
    is_opposite = cloth.vertex[own_line[0]] != cloth.vertex[base_line[0]]
    own, base = cloth.flat[own_line], cloth.flat[base_line[::-1] if is_opposite else base_line]
    # The nearest place of the seam: its part, how far along it, and what is left ahead and beside.
    place, step = cloth.flat[corners], np.diff(own, axis=0)
    off = place[:, None] - own[:-1]
    share = np.clip((off * step).sum(axis=2) / (step**2).sum(axis=1), 0.0, 1.0)
    part = np.linalg.norm(off - share[:, :, None] * step, axis=2).argmin(axis=1)
    n = np.arange(len(place))
    share = share[n, part][:, None]
    left = off[n, part] - share * step[part]
    along = _unit(step)[part]
    ahead, beside = (left * along).sum(axis=1), (left * _to_the_left(along)).sum(axis=1)
    # The same on the other side of the seam. Both panels have their cloth to the left of their
    # outlines, or to the right where these run clockwise.
    base_step = np.diff(base, axis=0)[part]
    foot, base_along = base[part] + share * base_step, _unit(base_step)
    areas = [cloth.pattern.by_name[side.panel].outline.area for side in (mine, other)]
    if (areas[0] * areas[1] > 0) == is_opposite:
        beside = -beside
    foot = foot + ahead[:, None] * base_along
    across = beside[:, None] * _to_the_left(base_along)
    return foot - across, foot + across


def _unit(vectors: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _to_the_left(vectors: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


# Moving least squares (Schaefer, McPhail and Warren 2006, "Image deformation using moving least
# squares"): each place p is carried by the rigid motion x + R (p - m) that fits the cloth about it
# best, with weights that fall off with the distance. R is the nearest frame of the weighted sum of
# products of deviations in space and in the plane, from its singular vectors.
def _carried(
    cloth: Cloth,
    points: Float[np.ndarray, "vertex 3"],
    base: Int[np.ndarray, " corner"],
    places: Float[np.ndarray, "n 2"],
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Places in a flat panel carried to where its cloth lies, and the outward directions there."""
    flat, worn = cloth.flat[base], points[cloth.vertex[base]]
    weight = (((places[:, None] - flat) ** 2).sum(axis=2) + REACH**2) ** -2.0
    weight /= weight.sum(axis=1, keepdims=True)
    middle, worn_middle = weight @ flat, weight @ worn
    products = np.einsum("nk,ki,kj->nij", weight, worn, flat)
    products -= worn_middle[:, :, None] * middle[:, None]
    u, _, vt = np.linalg.svd(products, full_matrices=False)
    frame = u @ vt
    carried = worn_middle + np.einsum("nij,nj->ni", frame, places - middle)
    outline = cloth.pattern.panels[cloth.panel[base[0]]].outline
    return carried, np.cross(frame[:, :, 0], frame[:, :, 1]) * np.sign(outline.area)


def _lifted(
    start: Float[np.ndarray, "vertex 3"],
    outward: Float[np.ndarray, "vertex 3"],
    field: DistanceField,
    gap: float,
) -> Float[np.ndarray, "vertex 3"]:
    """Places moved outward over the outermost cloth there, as may be a puffed sleeve.

    Those without an outward direction stay.
    """
    length = np.linalg.norm(outward, axis=1, keepdims=True)
    outward = outward / np.where(length > 0, length, 1.0)
    start = start + LIFT * outward
    height = np.zeros((len(start), 1))
    for step in np.arange(0.0, OVER, STEP):
        height[field.at(start + step * outward) < gap] = step + STEP
    return start + height * outward
