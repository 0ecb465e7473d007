"""Lapels and collars begin folded onto the cloth at rest beneath them, pockets lying on it."""

from collections.abc import Sequence
from typing import NamedTuple

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
AHEAD = 2  # a seam's direction is that from so many vertices behind to so many ahead
UP = np.array([0.0, 1.0, 0.0])
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
    `gap` [cm] outside of `field`, which wears it. Where it reaches over the lower edge of a
    collar's stand it lies on what the stand is sewn to. A stand beside turned panels goes on
    straight beyond the seam, but leans outward near them.
    """
    corners, outward = points[cloth.vertex], np.zeros((len(cloth.vertex), 3))
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    for name, (mine, other) in folded.seams.items():
        own, base = (np.flatnonzero(cloth.panel == number[s.panel]) for s in (mine, other))
        opened, laid, *_ = _along_seam(cloth, mine, other, cloth.flat[own])
        corners[own], outward[own] = _carried(cloth, points, base, laid)
        for rows, below, places in _below_stand(cloth, folded.below.get(other.panel, ()), laid):
            corners[own[rows]], outward[own[rows]] = _carried(cloth, points, below, places)
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


def stand_up(
    cloth: Cloth, points: Float[np.ndarray, "vertex 3"], folded: FoldedPanels
) -> Float[np.ndarray, "vertex 3"]:
    """Where the vertices of stands beneath falls begin, the cloth below being at `points` [cm].

    They stand upright on the seam to it; all others begin at `points`.
    """
    corners = points[cloth.vertex]
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    for name, seams in folded.below.items():
        own = np.flatnonzero(cloth.panel == number[name])
        along = [_along_seam(cloth, mine, other, cloth.flat[own]) for mine, other in seams]
        nearest = np.argmin([each.away for each in along], axis=0)
        for k, (mine, _) in enumerate(seams):
            rows, line = nearest == k, points[cloth.vertex[cloth.sides[mine]]]
            feet, upward = _upright(line, along[k])
            corners[own[rows]] = (feet + along[k].inside[:, None] * upward)[rows]
    return cloth.sewn(corners)


def _upright(
    line: Float[np.ndarray, "point 3"], along: "_AlongSeam"
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Places on a seam in space, and the directions at right angles to it that go up most."""
    part, step = along.part, np.diff(line, axis=0)
    feet = line[part] + along.share[:, None] * step[part]
    before, after = np.maximum(part - AHEAD, 0), np.minimum(part + 1 + AHEAD, len(line) - 1)
    tangent = _unit(line[after] - line[before])
    return feet, _unit(UP - (tangent @ UP)[:, None] * tangent)


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


class _AlongSeam(NamedTuple):
    """Places of one panel in the frame of another that it is sewn to [cm].

    Each keeps its place along the seam and its distance from it.
    """

    opened: Float[np.ndarray, "n 2"]  # one panel begins where the other ends
    folded: Float[np.ndarray, "n 2"]  # one panel lies on the other
    part: Int[np.ndarray, " n"]  # which part of the seam is nearest
    share: Float[np.ndarray, " n"]  # at which share of that part
    inside: Float[np.ndarray, " n"]  # how far from the seam on its own panel's side
    away: Float[np.ndarray, " n"]  # how far from the nearest place of the seam


def _along_seam(
    cloth: Cloth, mine: Side, other: Side, place: Float[np.ndarray, "n 2"]
) -> _AlongSeam:
    """Where places in the frame of the panel of `mine` come to lie in that of `other`."""
    own_line, base_line = cloth.sides[mine], cloth.sides[other]
    is_opposite = cloth.vertex[own_line[0]] != cloth.vertex[base_line[0]]
    own, base = cloth.flat[own_line], cloth.flat[base_line[::-1] if is_opposite else base_line]
    # The nearest place of the seam: its part, how far along it, and what is left ahead and beside.
    step = np.diff(own, axis=0)
    off = place[:, None] - own[:-1]
    share = np.clip((off * step).sum(axis=2) / (step**2).sum(axis=1), 0.0, 1.0)
    part = np.linalg.norm(off - share[:, :, None] * step, axis=2).argmin(axis=1)
    n = np.arange(len(place))
    at = share[n, part]
    share = at[:, None]
    left = off[n, part] - share * step[part]
    along = _unit(step)[part]
    ahead, beside = (left * along).sum(axis=1), (left * _to_the_left(along)).sum(axis=1)
    # The same on the other side of the seam. Both panels have their cloth to the left of their
    # outlines, or to the right where these run clockwise.
    base_step = np.diff(base, axis=0)[part]
    foot, base_along = base[part] + share * base_step, _unit(base_step)
    areas = [cloth.pattern.by_name[side.panel].outline.area for side in (mine, other)]
    inside = beside * np.sign(areas[0])
    if (areas[0] * areas[1] > 0) == is_opposite:
        beside = -beside
    foot = foot + ahead[:, None] * base_along
    across = beside[:, None] * _to_the_left(base_along)
    away = np.linalg.norm(left, axis=1)
    return _AlongSeam(foot - across, foot + across, part, at, inside, away)


def _below_stand(
    cloth: Cloth, seams: Sequence[tuple[Side, Side]], places: Float[np.ndarray, "n 2"]
) -> list[tuple[Int[np.ndarray, " k"], Int[np.ndarray, " corner"], Float[np.ndarray, "k 2"]]]:
    """Of places in the frame of a stand those over its lower edge, on the panels sewn to it there.

    For each of its `seams` to them which places they are, the panel's corners, and the places in
    its own frame.
    """
    if not seams:
        return []
    along = [_along_seam(cloth, mine, other, places) for mine, other in seams]
    nearest = np.argmin([each.away for each in along], axis=0)
    number = {panel.name: k for k, panel in enumerate(cloth.pattern.panels)}
    found = []
    for k, (_, other) in enumerate(seams):
        rows = np.flatnonzero((nearest == k) & (along[k].inside < 0))
        below = np.flatnonzero(cloth.panel == number[other.panel])
        found.append((rows, below, along[k].opened[rows]))
    return found


def _unit(vectors: Float[np.ndarray, "n k"]) -> Float[np.ndarray, "n k"]:
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
