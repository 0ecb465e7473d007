"""Which panel of one pattern is which panel of another, and how alike the two are.

Panels are compared with their centres of area on each other ("centroid-aligned", paper, Table 1),
as they lie in their own panel coordinates. Where the frame of a panel is not known, `any_pose`
compares them in the eight poses that mirroring and quarter turns give.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import Curve, resample
from garmentimage.pattern import Loop, Panel, Pattern

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

CHORDS_PER_ROOT_CM = 8.0
"""A curve of length L stands as this x sqrt(L) chords: no half circle is off by 0.01 cm then.

Ruffles are strips of a few cm and a few metres: coarser chords would be most of their IoU."""

MAX_CHORDS = 1000

BOUNDARY_POINTS = 128  # points on each boundary when boundaries are compared

STARTS_BETWEEN = 8  # starts that are tried between two of these points

MIN_IOU = 0.3
"""While matching, pairs whose areas alone forbid this much IoU count as 0 (saves the work)."""

PLACEMENT_WEIGHT = 0.05
"""What equal placement is worth beside IoU: enough to tell left from right, not more."""

PLACEMENT_RANGE_CM = 30.0
"""Distance on the body over which the worth of placement falls to 1/e [cm]."""

POSES = tuple(
    np.array([[c, -s], [s, c]]) @ np.diag([flip, 1.0])
    for flip, (c, s) in product((1.0, -1.0), ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)))
)
"""Quarter turns of the panel as it is, then of its mirror image; the first is the identity."""

TURNED, MIRRORED = (0, 1, 2, 3), (4, 5, 6, 7)  # indices of `POSES`: without and with mirroring


@dataclass(frozen=True)
class PanelPair:
    """Two panels that stand for each other, and how alike they are."""

    a: str
    b: str
    iou: float
    """Centroid-aligned intersection over union, holes counted."""
    boundary_distance: float
    """Mean distance of boundary points at equal arc length, best start and direction [cm]."""


@dataclass(frozen=True)
class Matching:
    """The panels of two patterns, paired as well as can be."""

    pairs: tuple[PanelPair, ...]
    """In the order of the first pattern's panels."""
    missing: tuple[str, ...]
    """Panels of the first pattern without a counterpart."""
    extra: tuple[str, ...]
    """Panels of the second pattern without a counterpart."""

    @property
    def panel_map(self) -> Mapping[str, str]:
        """Names of the first pattern's panels -> names of the second's."""
        return {p.a: p.b for p in self.pairs}

    @property
    def ious(self) -> tuple[float, ...]:
        """IoU of every pair; missing and extra panels count as 0."""
        return tuple(p.iou for p in self.pairs) + (0.0,) * (len(self.missing) + len(self.extra))

    @property
    def mean_iou(self) -> float:
        """Mean of `ious`."""
        return float(np.mean(self.ious)) if self.ious else 0.0


def match_panels(
    a: Pattern, b: Pattern, *, by_name: bool = False, any_pose: bool = False
) -> Matching:
    """Pair the panels of two patterns by shape and placement (Hungarian method).

    With `by_name`, panels of equal names are paired first, whatever their shape; with `any_pose`,
    each panel may be mirrored and turned by quarters.
    """
    from scipy.optimize import linear_sum_assignment

    score = iou_matrix(a.panels, b.panels, any_pose=any_pose)
    score = score + PLACEMENT_WEIGHT * nearness(a.panels, b.panels)
    if by_name:
        names = np.array([[p.name == q.name for q in b.panels] for p in a.panels], float)
        # One shared name outweighs all that shape and placement can say together.
        score = score + names.reshape(score.shape) * 2 * max(score.shape, default=1)
    rows, columns = linear_sum_assignment(score, maximize=True)
    paired = {a.panels[i].name: b.panels[j].name for i, j in zip(rows, columns, strict=True)}
    return matching_from(a, b, paired, any_pose=any_pose)


def matching_from(
    a: Pattern, b: Pattern, panel_map: Mapping[str, str], *, any_pose: bool = False
) -> Matching:
    """The figures of a pairing that is already known."""
    pairs = tuple(
        PanelPair(
            p.name,
            panel_map[p.name],
            panel_iou(p, b.by_name[panel_map[p.name]], any_pose=any_pose),
            boundary_distance(p, b.by_name[panel_map[p.name]], any_pose=any_pose),
        )
        for p in a.panels
        if p.name in panel_map
    )
    found = set(panel_map.values())
    return Matching(
        pairs,
        missing=tuple(p.name for p in a.panels if p.name not in panel_map),
        extra=tuple(p.name for p in b.panels if p.name not in found),
    )


def panel_iou(a: Panel, b: Panel, *, any_pose: bool = False) -> float:
    """Centroid-aligned intersection over union of two panels, holes counted."""
    return float(iou_matrix([a], [b], any_pose=any_pose, floor=0.0)[0, 0])


def iou_matrix(
    a: Sequence[Panel], b: Sequence[Panel], *, any_pose: bool = False, floor: float = MIN_IOU
) -> Float[np.ndarray, "a b"]:
    """Centroid-aligned IoU of every panel of `a` with every panel of `b`, in any pose in the best.

    Pairs whose areas forbid an IoU of `floor` are not compared and count as 0.
    """
    poses = TURNED + MIRRORED if any_pose else TURNED[:1]
    best: Float[np.ndarray, "a b"] = iou_by_pose(a, b, poses, floor=floor).max(axis=0)
    return best


def iou_by_pose(
    a: Sequence[Panel], b: Sequence[Panel], poses: Sequence[int], *, floor: float = MIN_IOU
) -> Float[np.ndarray, "pose a b"]:
    """As `iou_matrix`, for each of the given `POSES` of the panels of `b`."""
    import shapely

    regions_a, regions_b = (np.array([panel_region(p) for p in ps], object) for ps in (a, b))
    area_a, area_b = shapely.area(regions_a), shapely.area(regions_b)
    smaller = np.minimum(area_a[:, None], area_b[None])
    larger = np.maximum(area_a[:, None], area_b[None])
    rows, columns = np.nonzero((larger > 0) & (smaller >= floor * larger))
    iou = np.zeros((len(poses), len(a), len(b)))
    for k, pose in enumerate(poses):
        posed = shapely.transform(regions_b, lambda xy, m=POSES[pose]: xy @ m.T)
        shared = shapely.area(shapely.intersection(regions_a[rows], posed[columns]))
        iou[k, rows, columns] = shared / (area_a[rows] + area_b[columns] - shared)
    return iou


def panel_region(panel: Panel) -> "BaseGeometry":
    """The cloth of a panel as a shapely area, its centroid at the origin [cm].

    A boundary that crosses itself is read by the even-odd rule.
    """
    import shapely

    holes = [loop_polygon(h) for h in panel.holes]
    region: Any = shapely.Polygon(loop_polygon(panel.outline), holes)
    if not region.is_valid:
        parts = shapely.get_parts(shapely.make_valid(region))
        region = shapely.union_all([g for g in parts if g.area > 0])
    if region.is_empty:
        return region
    centre = np.array([region.centroid.x, region.centroid.y])
    return shapely.transform(region, lambda xy: xy - centre)


def loop_polygon(loop: Loop) -> Float[np.ndarray, "n 2"]:
    """A loop as a fine polygon, not closed [cm]."""
    return np.concatenate([c.sample(_chords(c))[:-1] for c in loop.curves])


def _chords(curve: Curve) -> int:
    if curve.is_straight:
        return 1
    return int(np.clip(np.ceil(CHORDS_PER_ROOT_CM * np.sqrt(curve.length)), 2, MAX_CHORDS))


def boundary_distance(a: Panel, b: Panel, *, any_pose: bool = False) -> float:
    """Mean distance between two outlines, centred, at equal shares of arc length [cm].

    It does not depend on where the loops start nor which way they run: the better direction and
    the best start of `b` are taken, to a share 1 / (`BOUNDARY_POINTS` x `STARTS_BETWEEN`) of its
    length.
    """
    ours, theirs = _boundaries(a, b)
    ours, theirs = ours - ours.mean(axis=0), theirs - theirs.mean(axis=0)
    poses = POSES if any_pose else POSES[:1]
    return min(
        _best_start(ours, order)[0]
        for pose in poses
        for order in (theirs @ pose.T, theirs[::-1] @ pose.T)
    )


def aligned_points(a: Panel, b: Panel) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "n 2"]]:
    """Points at equal shares of both outlines, from where `boundary_distance` takes them [cm]."""
    ours, theirs = _boundaries(a, b)
    centred = ours - ours.mean(axis=0)
    fits = [
        (*_best_start(centred, order - order.mean(axis=0)), order)
        for order in (theirs, theirs[::-1])
    ]
    _, start, order = min(fits, key=lambda fit: fit[0])
    return ours, order[(start + np.arange(len(ours)) * STARTS_BETWEEN) % len(order)]


def boundary_gap(a: Panel, b: Panel, *, any_pose: bool = False) -> float:
    """Largest distance of a boundary point of one panel from the boundary of the other [cm].

    Holes count; the panels lie with their centres of area on each other.
    """
    import shapely

    ours, theirs = panel_region(a).boundary, panel_region(b).boundary
    poses = POSES if any_pose else POSES[:1]
    return min(
        float(ours.hausdorff_distance(shapely.transform(theirs, lambda xy, m=pose: xy @ m.T)))
        for pose in poses
    )


def _boundaries(a: Panel, b: Panel) -> tuple[np.ndarray, np.ndarray]:
    """Points evenly along two outlines, those of the second one finer [cm]."""
    counts = BOUNDARY_POINTS, BOUNDARY_POINTS * STARTS_BETWEEN
    polygons = [loop_polygon(panel.outline) for panel in (a, b)]
    ours, theirs = (
        resample(np.concatenate([polygon, polygon[:1]]), np.arange(count) / count)
        for polygon, count in zip(polygons, counts, strict=True)
    )
    return ours, theirs


def _best_start(ours: np.ndarray, theirs: np.ndarray) -> tuple[float, int]:
    """Least mean distance over all starts of the finer `theirs`, and that start."""
    # Brute force over all cyclic shifts, 128 of them, then over 15 finer ones beside the best.
    count = len(ours)
    index = np.arange(count)
    coarse = theirs[::STARTS_BETWEEN]
    gaps = np.hypot(*(ours[:, None] - coarse[None]).transpose(2, 0, 1))
    means = gaps[index, (index[:, None] + index[None]) % count].mean(axis=1)
    middle = int(means.argmin()) * STARTS_BETWEEN
    starts = middle + np.arange(1 - STARTS_BETWEEN, STARTS_BETWEEN)
    moved = theirs[(starts[:, None] + index[None] * STARTS_BETWEEN) % len(theirs)]
    apart = np.hypot(*(moved - ours).transpose(2, 0, 1)).mean(axis=1)
    return float(apart.min()), int(starts[apart.argmin()])


def nearness(a: Sequence[Panel], b: Sequence[Panel]) -> Float[np.ndarray, "a b"]:
    """1 where two panels stand at the same place of their garments, falling to 0."""
    places = [_places(a), _places(b)]
    gaps = np.linalg.norm(places[0][:, None] - places[1][None], axis=2)
    return np.asarray(np.exp(-gaps / PLACEMENT_RANGE_CM))


def _places(panels: Sequence[Panel]) -> Float[np.ndarray, "n 3"]:
    """World positions of the panels' middles, relative to the mean of the garment [cm]."""
    if not panels:
        return np.zeros((0, 3))
    middles = [p.to_world(loop_polygon(p.outline).mean(axis=0)[None])[0] for p in panels]
    return np.asarray(np.array(middles) - np.mean(middles, axis=0))
