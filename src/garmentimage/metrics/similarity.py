"""Similarity of a predicted pattern to the true one, for one garment and over many.

Panels are paired by shape, place and seams (`pair_garments`), in whatever frames they are drawn;
missing and extra ones count as an IoU of 0.
Placement and stitches are compared on paired panels by points of their outlines, so that nothing
depends on names, on the start of a loop, or on the division into edges, which a raster changes.
The figures of published codes are in `published_figures`.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass

import numpy as np
from jaxtyping import Float, Int

from garmentimage.compare import (
    aligned_points,
    drawing_faults,
    loop_polygon,
    pair_garments,
    ratio_faults,
    stitch_faults,
    structure_faults,
)
from garmentimage.errors import PatternError, check_type
from garmentimage.geometry import resample
from garmentimage.metrics.intervals import Interval, interval
from garmentimage.pattern import Panel, Pattern, Side

MIN_SHARE = 0.5
"""Edges and stitches are equal if more than this share of their length agrees."""
EDGE_POINTS, FINE_POINTS, CHORDS = 16, 64, 32
"""Sample points of an edge to match, those of the edges to match it to, and chords of a curve."""


@dataclass(frozen=True)
class Scores:
    """Counts of correct stitches, for precision and recall."""

    right_found: int
    """Found stitches that are true."""
    found: int
    right_true: int
    """True stitches that were found."""
    true: int

    @property
    def precision(self) -> float:
        """If there are no stitches found: 1 if there are no true ones, else 0."""
        return self.right_found / self.found if self.found else float(not self.true)

    @property
    def recall(self) -> float:
        """1 if there are no true stitches."""
        return self.right_true / self.true if self.true else 1.0

    @property
    def f1(self) -> float:
        """Harmonic mean of both."""
        total = self.precision + self.recall
        return 2 * self.precision * self.recall / total if total else 0.0


@dataclass(frozen=True)
class Likeness:
    """Figures of one predicted garment."""

    panel_iou: float
    """Mean over panels, centroids aligned; missing and extra ones count 0."""
    panel_l2: float | None
    """Mean distance of outlines at equal arc length [cm]; None if no panel has a counterpart."""
    panels: bool
    """The number of panels is right."""
    edges: float
    """Share of the true panels whose counterpart has the same number of edges."""
    rotation: float | None
    """Mean angle between panels placed at the body [degree]."""
    translation: float | None
    """Mean distance of the centres of panels placed at the body [cm]."""
    by_edge: Scores
    """Stitches as pairs of edges, each matched to an edge of the other outline."""
    by_length: Scores
    """Stitches that are right over at least half of their length."""
    topology: bool
    """The same panels sewn together in the same order; lengths may differ."""
    valid: bool
    """Can be cut and sewn, see `pattern_faults`."""

    def figures(self) -> dict[str, float | None]:
        """All figures by name, as numbers from 0 to 1, centimetres or degrees."""
        figures: dict[str, float | None] = {}
        for name, value in vars(self).items():
            if isinstance(value, Scores):
                for score in ("precision", "recall", "f1"):
                    figures[f"stitch_{score}_{name}"] = getattr(value, score)
            else:
                figures[name] = None if value is None else float(value)
        return figures


def likeness(truth: Pattern, found: Pattern | None) -> Likeness:
    """Compare a predicted pattern with the true one, which must be valid.

    Panels that cross themselves are read by the even-odd rule, so that they are not all wrong.

    Args:
        truth: the true pattern.
        found: the predicted pattern; None, or one with panels that cannot be drawn or stitches
            that refer to missing edges, scores 0.

    Raises:
        PatternError: the true pattern has no panels, or stitches that refer to missing edges.
        TypeError: an argument is not a pattern.
    """
    for pattern in (truth,) if found is None else (truth, found):
        check_type(pattern, Pattern, "load_pattern(path) reads one")
    if not truth.panels or stitch_faults(truth):
        raise PatternError(
            "a true pattern without panels, or with stitches that refer to missing edges"
        )
    missed = Scores(0, 0, 0, max(len(truth.stitches), 1))  # one, so that nothing is right
    if (
        found is None
        or not found.panels
        or any(drawing_faults(panel) for panel in found.panels)
        or stitch_faults(found)
    ):
        return Likeness(0.0, None, False, 0.0, None, None, missed, missed, False, False)
    pairing = pair_garments(truth, found)
    matching, seen = pairing.matching, pairing.found
    pairs = [(truth.by_name[p.a], seen.by_name[p.b]) for p in matching.pairs]
    counts = [len(a.edges) == len(b.edges) for a, b in pairs]
    turns, moves = zip(*(_displacement(a, b) for a, b in pairs), strict=True)
    is_valid = not structure_faults(found) and not ratio_faults(pairing.graphs[1])
    by_edge, by_length = _stitch_scores(truth, seen, matching.panel_map)
    return Likeness(
        panel_iou=matching.mean_iou,
        panel_l2=float(np.mean([pair.boundary_distance for pair in matching.pairs])),
        panels=len(truth.panels) == len(found.panels),
        edges=sum(counts) / len(truth.panels),
        rotation=float(np.mean(turns)),
        translation=float(np.mean(moves)),
        by_edge=by_edge,
        by_length=by_length,
        topology=pairing.same_topology,
        valid=is_valid,
    )


def likeness_summary(
    found: Sequence[Likeness], *, draped: Sequence[bool] | None = None, seed: int = 0
) -> dict[str, Interval | float]:
    """Figures over many garments, with 95 % intervals (bootstrap over garments).

    Args:
        found: of each garment.
        draped: for each, whether it could be draped.
        seed: of the bootstrap.

    Returns:
        Means of every figure; precision, recall and F1 of stitches per garment, and F1 over all
        stitches together ("micro"). Distances and angles are averaged over the garments with a
        paired panel; `n` is their number.

    Raises:
        ValueError: there are no garments, or `draped` has another length.
    """
    if not found or (draped is not None and len(draped) != len(found)):
        values = "" if draped is None else f" and {len(draped)} values of draped"
        raise ValueError(f"{len(found)} garments{values}; give one or more, and a value for each")
    summary: dict[str, Interval | float] = {}
    rows = [each.figures() for each in found]
    for name in rows[0]:
        known = [value for value in (row[name] for row in rows) if value is not None]
        if known:
            summary[name] = interval(known, seed=seed)
    for how in ("by_edge", "by_length"):
        counts = zip(*(astuple(getattr(each, how)) for each in found), strict=True)
        summary[f"stitch_f1_{how}_micro"] = Scores(*map(sum, counts)).f1
    if draped is not None:
        summary["draped"] = interval([float(each) for each in draped], seed=seed)
    return summary


# --- Placement -----------------------------------------------------------------------------------


def _displacement(a: Panel, b: Panel) -> tuple[float, float]:
    """Angle [degree] and distance of centres [cm] between two panels placed at a body.

    The angle is that of the rotation which best aligns the outline of `a` to that of `b` (Kabsch).
    """
    from scipy.spatial.transform import Rotation

    ours, theirs = (
        panel.to_world(points) for panel, points in zip((a, b), aligned_points(a, b), strict=True)
    )
    apart = float(np.linalg.norm(ours.mean(0) - theirs.mean(0)))
    ours, theirs = ours - ours.mean(0), theirs - theirs.mean(0)
    if np.abs(theirs).max() < 1e-6:  # a panel of no size has no direction
        return 0.0, apart
    turn, _ = Rotation.align_vectors(theirs, ours)
    return float(np.degrees(turn.magnitude())), apart


# --- Stitches ---------------------------------------------------------------------------------


def _stitch_scores(
    truth: Pattern, found: Pattern, panel_map: Mapping[str, str]
) -> tuple[Scores, Scores]:
    """By edge and by length."""
    back = {b: a for a, b in panel_map.items()}
    there, home = _shares(truth, found, panel_map), _shares(found, truth, back)
    same = {
        side: other
        for side, shares in there.items()
        for other, share in shares.items()
        if share > MIN_SHARE and home[other].get(side, 0.0) > MIN_SHARE
    }
    mapped = {frozenset(same.get(side, side) for side in s.sides)
              for s in truth.stitches if all(side in same for side in s.sides)}  # fmt: skip
    right = len(mapped & {frozenset(s.sides) for s in found.stitches})
    totals = len(found.stitches), len(truth.stitches)
    by_edge = Scores(right, totals[0], right, totals[1])
    by_length = Scores(_count_joined(found, truth, home), totals[0],
                       _count_joined(truth, found, there), totals[1])  # fmt: skip
    return by_edge, by_length


def _count_joined(one: Pattern, other: Pattern, shares: Mapping[Side, Mapping[Side, float]]) -> int:
    """Stitches of one pattern of which at least half is sewn in the other, too."""
    count = 0
    for stitch in one.stitches:
        a, b = (shares.get(side, {}) for side in stitch.sides)
        whole = sum(
            min(a.get(x, 0.0), b.get(y, 0.0))
            for sewn in other.stitches
            for x, y in (sewn.sides, sewn.sides[::-1])
        )
        count += whole >= MIN_SHARE
    return count


def _shares(
    one: Pattern, other: Pattern, panel_map: Mapping[str, str]
) -> dict[Side, dict[Side, float]]:
    """For each edge of paired panels, shares of its length by nearest edge of the counterpart."""
    shares: dict[Side, dict[Side, float]] = {}
    for name, counterpart in panel_map.items():
        near = _nearest_edges(one.by_name[name], other.by_name[counterpart])
        for edge, labels in enumerate(near):
            counts = Counter(labels.tolist())
            shares[Side(name, edge)] = {
                Side(counterpart, label): n / len(labels) for label, n in counts.items()
            }
    return shares


def _nearest_edges(a: Panel, b: Panel) -> Int[np.ndarray, "edge point"]:
    """For points along each edge of `a`, the nearest edge of `b`, in coordinates of the boxes."""
    from scipy.spatial import cKDTree

    ours, theirs = _edge_points(a, EDGE_POINTS), _edge_points(b, FINE_POINTS)
    tree = cKDTree(_in_a_box(theirs, b).reshape(-1, 2))
    _, nearest = tree.query(_in_a_box(ours, a))
    return np.asarray(nearest // FINE_POINTS)


def _edge_points(panel: Panel, count: int) -> Float[np.ndarray, "edge point 2"]:
    """Points at equal distances along each edge, without its ends [cm]."""
    at = (np.arange(count) + 0.5) / count
    return np.stack([resample(curve.sample(CHORDS), at) for curve in panel.curves])


def _in_a_box(points: np.ndarray, panel: Panel) -> np.ndarray:
    """Points in coordinates of the bounding box of a panel's outline, from 0 to 1."""
    corners = loop_polygon(panel.outline)
    low, high = corners.min(axis=0), corners.max(axis=0)
    return np.asarray((points - low) / np.maximum(high - low, 1e-9))
