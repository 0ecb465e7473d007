"""The figures of published codes, reproduced exactly: equal names mean different formulas there.

Terms:

- A **slot** is a position in a fixed list of panels, addressed by the name of the panel; empty
  slots and missing edges are zeros ("padding").
- A row of an edge is (dx, dy, cx, cy): the vector to its end [cm], and its control point along the
  edge and to its left, relative to its length. A straight edge has control point (0, 0).
- Rotations are quaternions (x, y, z, w); a translation is the world position of the midpoint of the
  highest side of the panel's bounding box [cm] ("universal" in those codes).

Modes: `neuraltailor` (Korosteleva and Lee 2022), `sewformer` (Liu et al. 2023), `aipparel`
(Nakayama et al. 2025).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import atan2, hypot

import numpy as np
from jaxtyping import Bool, Float

from garmentimage.compare import pair_garments, stitch_faults
from garmentimage.errors import PatternError, quoted
from garmentimage.geometry import centroid
from garmentimage.pattern import Edge, Loop, Panel, Pattern, Quadratic, Side

MAX_SLOT_EDGES = 14
"""Most edges of a panel in those codes."""
PADDING_ATOL = 0.07
"""Rows of smaller magnitude count as padding [standardised units]."""
CLOSED_CM = 3.0
"""An open loop with a larger gap, in x or y, has one more edge [cm]."""
MIN_EDGES = 3
"""Slots with fewer edges are not panels."""
EMPTY_ROW = 1e-6
"""Rows of smaller magnitude are missing edges."""

SlotStitch = frozenset[tuple[int, int]]
"""Two sides (slot, edge)."""


@dataclass(frozen=True)
class Slots:
    """A pattern in slots."""

    edges: Float[np.ndarray, "slot edge 4"]
    rotations: Float[np.ndarray, "slot 4"]
    translations: Float[np.ndarray, "slot 3"]
    stitches: frozenset[SlotStitch]

    @property
    def counts(self) -> tuple[int, ...]:
        """Edges of each slot: rows that are not padding."""
        return tuple(int(n) for n in np.any(np.abs(self.edges) > EMPTY_ROW, axis=2).sum(1))


def slots_of(
    pattern: Pattern,
    names: Sequence[str],
    edges: int = MAX_SLOT_EDGES,
    *,
    like: Pattern | None = None,
) -> Slots:
    """A pattern in slots of these names.

    Args:
        pattern: the garment.
        names: a name for each slot.
        edges: rows of a slot.
        like: the true garment, whose panels have the names of the slots. The panels of `pattern`
            may then have any names, frames and first edges, as those of a decoded image have: each
            takes the slot, frame and start of its counterpart (`pair_garments`), and those without
            one the first slots that are left.

    Raises:
        PatternError: a panel has no slot, holes, or too many edges; or a stitch refers to a
            missing edge.
        ValueError: names of slots repeat, or there are too few edges.
    """
    if len(set(names)) != len(names) or edges < MIN_EDGES:
        raise ValueError(f"slots need names of their own, and {MIN_EDGES} edges or more")
    if faults := stitch_faults(pattern):
        raise PatternError(faults[0])
    if like is not None:
        pattern = _drawn_like(pattern, like, names)
    rows = np.zeros((len(names), edges, 4))
    rotations, translations = np.zeros((len(names), 4)), np.zeros((len(names), 3))
    for panel in pattern.panels:
        if panel.name not in names:
            raise PatternError(
                f"panel {quoted(panel.name)}: is in none of the slots; rename it, or give the true "
                "garment as like= to find the slots by shape, place and seams"
            )
        if panel.holes or len(panel.outline.edges) > edges:
            raise PatternError(
                f"panel {quoted(panel.name)}: has holes, or more than {edges} edges; slots "
                "have neither"
            )
        k = list(names).index(panel.name)
        rows[k, : len(panel.outline.edges)] = [
            _row(panel.outline, number) for number in range(len(panel.outline.edges))
        ]
        rotations[k] = quaternion(panel)
        translations[k] = universal_translation(panel)
    number = {name: k for k, name in enumerate(names)}
    stitches = frozenset(
        frozenset((number[side.panel], side.edge) for side in (stitch.a, stitch.b))
        for stitch in pattern.stitches
    )
    return Slots(rows, rotations, translations, stitches)


def _drawn_like(pattern: Pattern, like: Pattern, names: Sequence[str]) -> Pattern:
    """The same garment with names, frames and first edges of its counterparts in `like`."""
    pairing = pair_garments(like, pattern)
    name = {other: one for one, other in pairing.matching.panel_map.items()}
    left = [slot for slot in names if slot not in pairing.matching.panel_map]
    for extra in pairing.matching.extra:
        name[extra] = left.pop(0) if left else extra
    first = {
        p.b: _first_edge(pairing.found.by_name[p.b], like.by_name[p.a])
        for p in pairing.matching.pairs
    }

    def side(old: Side) -> Side:
        count = len(pattern.by_name[old.panel].outline.edges)
        if old.edge >= count:
            return Side(name[old.panel], old.edge)
        return Side(name[old.panel], (old.edge - first.get(old.panel, 0)) % count)

    panels = []
    for panel in pairing.found.panels:
        at = first.get(panel.name, 0)
        turned = replace(panel.outline, edges=panel.outline.edges[at:] + panel.outline.edges[:at])
        panels.append(replace(panel, name=name[panel.name], outline=turned))
    stitches = tuple(replace(s, a=side(s.a), b=side(s.b)) for s in pattern.stitches)
    return replace(pattern, panels=tuple(panels), stitches=stitches)


def _first_edge(panel: Panel, like: Panel) -> int:
    """The edge that starts nearest to the start of the outline of `like`, centroids aligned."""
    wanted = like.outline.curves[0].start - centroid(like.outline.fine_polygon)
    starts = np.array([curve.start for curve in panel.outline.curves])
    gaps = starts - centroid(panel.outline.fine_polygon) - wanted
    return int(np.hypot(*gaps.T).argmin())


def universal_translation(panel: Panel) -> Float[np.ndarray, "3"]:
    """World position of the midpoint of the highest side of the panel's bounding box [cm]."""
    corners = np.array(panel.outline.vertices)
    low, high = corners.min(0), corners.max(0)
    middle = (low + high) / 2
    sides = np.array(
        [(middle[0], high[1]), (middle[0], low[1]), (low[0], middle[1]), (high[0], middle[1])]
    )
    world = panel.to_world(sides)
    return np.asarray(world[int(np.argmax(world[:, 1]))], float)


def quaternion(panel: Panel) -> Float[np.ndarray, "4"]:
    """Its rotation, (x, y, z, w)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler("xyz", panel.rotation, degrees=True).as_quat(), float)


def tag_stitches(
    tags: Float[np.ndarray, "slot edge tag"],
    free: Float[np.ndarray, "slot edge"],
    there: Bool[np.ndarray, "slot edge"],
) -> frozenset[SlotStitch]:
    """Stitches from tags of edges: the closest pair first, each edge once.

    Args:
        tags: of every edge.
        free: probability that it is not sewn; above 0.5 it is left out.
        there: which edges are not padding.

    Raises:
        ValueError: tags that are not finite.
    """
    if not (np.isfinite(tags).all() and np.isfinite(free).all()):
        raise ValueError("tags of stitches that are not finite")
    from scipy.spatial.distance import cdist

    sides = [(int(slot), int(edge)) for slot, edge in np.argwhere(there & (free <= 0.5))]
    if len(sides) < 2:
        return frozenset()
    points = np.array([tags[side] for side in sides])
    apart = cdist(points, points)
    first, second = np.triu_indices(len(sides), 1)
    left = set(range(len(sides)))
    found: set[SlotStitch] = set()
    for k in np.argsort(apart[first, second], kind="stable"):
        i, j = int(first[k]), int(second[k])
        if i in left and j in left:
            left -= {i, j}
            found.add(frozenset((sides[i], sides[j])))
    return frozenset(found)


def published_figures(
    truths: Sequence[Slots], found: Sequence[Slots], mode: str, *, scale: np.ndarray | None = None
) -> dict[str, float]:
    """The figures of a published code over some patterns, as one batch.

    Args:
        truths: true patterns.
        found: predicted ones, in the same slots.
        mode: `neuraltailor`, `sewformer` or `aipparel`.
        scale: of the rows of edges in training, [4]; 1 cm by default.

    Returns:
        `panel_l2`, `panels`, `edges`, `rotation_l2`, `translation_l2`, `stitch_precision`,
        `stitch_recall`, and `stitch_f1` or `accuracy` where the code has them. NaN where
        nothing counts.

    Raises:
        ValueError: there is no such mode, or the patterns are not of the same slots, as many, and
            all true ones with panels.
    """
    units = np.ones(4) if scale is None else np.asarray(scale, float)
    modes: Mapping[str, Callable[[], dict[str, float]]] = {
        "neuraltailor": lambda: _slotwise(truths, found, units, 4),
        "sewformer": lambda: _slotwise(truths, found, units, 2),
        "aipparel": lambda: _by_order(truths, found),
    }
    if mode not in modes:
        raise ValueError(f"there is no mode {mode!r}; choose {', '.join(modes)}")
    if units.shape != (4,) or not (np.isfinite(units).all() and units.all()):
        raise ValueError("a scale is four numbers, none of them 0")
    if not truths or len(truths) != len(found):
        raise ValueError(f"{len(truths)} true patterns and {len(found)} found ones; give as many")
    if len({each.edges.shape for each in (*truths, *found)}) > 1:
        raise ValueError("patterns are not all of the same slots")
    if not all(max(each.counts, default=0) >= MIN_EDGES for each in truths):
        raise ValueError("a true pattern has no panels")
    return modes[mode]()


# --- NeuralTailor and Sewformer -------------------------------------------------------------------


def _slotwise(
    truths: Sequence[Slots], found: Sequence[Slots], units: np.ndarray, padding_columns: int
) -> dict[str, float]:
    """Slot by slot; padding is recognised by the first `padding_columns` numbers of a row."""
    shapes: list[float] = []
    right: list[bool] = []
    shares: list[float] = []
    scores: list[tuple[float, float, float]] = []
    for truth, other in zip(truths, found, strict=True):
        counts = truth.counts
        seen = [_edge_count(rows, units, padding_columns) for rows in other.edges]
        shapes += [
            _shape_distance(truth.edges[k][:n], other.edges[k][:n])
            for k, n in enumerate(counts)
            if n >= MIN_EDGES
        ]
        panels = sum(n >= MIN_EDGES for n in counts)
        right.append(panels == sum(n >= MIN_EDGES for n in seen))
        agree = sum(n >= MIN_EDGES and n == m for n, m in zip(counts, seen, strict=True))
        shares.append(agree / panels)
        scores.append(_stitch_scores(truth.stitches, other.stitches))
    precision, recall, f1 = (_mean(values) for values in zip(*scores, strict=True))
    figures = {
        "panel_l2": _mean(shapes),
        "panels": _mean(right),
        "edges": _mean(shares),
        "rotation_l2": _mean(_norms(truths, found, "rotations")),
        "translation_l2": _mean(_norms(truths, found, "translations")),
        "stitch_precision": precision,
        "stitch_recall": recall,
    }
    return figures | ({"stitch_f1": f1} if padding_columns == 2 else {})


def _edge_count(rows: np.ndarray, units: np.ndarray, padding_columns: int) -> int:
    there = np.any(np.abs(rows / units)[:, :padding_columns] > PADDING_ATOL, axis=1)
    count = int(there.sum())
    missed = rows[there, :2].sum(0) if count else np.zeros(2)
    return count + int(np.any(np.abs(missed) > CLOSED_CM))


def _norms(truths: Sequence[Slots], found: Sequence[Slots], name: str) -> list[float]:
    """Distances in all slots, padding as well."""
    return [
        float(value)
        for truth, other in zip(truths, found, strict=True)
        for value in np.linalg.norm(getattr(truth, name) - getattr(other, name), axis=1)
    ]


# --- AIpparel ------------------------------------------------------------------------------------


def _by_order(truths: Sequence[Slots], found: Sequence[Slots]) -> dict[str, float]:
    shapes, right, shares, rotations, translations, recall = [], [], [], [], [], []
    for truth, other in zip(truths, found, strict=True):
        ours = [k for k, n in enumerate(truth.counts) if n >= MIN_EDGES]
        theirs = [k for k, n in enumerate(other.counts) if n >= MIN_EDGES]
        agree = sum(k in ours and truth.counts[k] == other.counts[k] for k in theirs)
        shares.append(agree / len(theirs) if theirs else 0.0)
        right.append(len(ours) == len(theirs))
        if not right[-1]:
            continue
        pairs = list(zip(ours, theirs, strict=True))
        shapes.append(_mean([_shape_distance(truth.edges[i], other.edges[j]) for i, j in pairs]))
        for i, j in pairs:
            turned, wanted = other.rotations[j], truth.rotations[i]
            distances = (np.linalg.norm(turned - wanted), np.linalg.norm(turned + wanted))
            rotations.append(float(min(distances)))
            offset = truth.translations[i] - other.translations[j]
            translations.append(float(np.linalg.norm(offset)))
        recall.append(_stitch_scores(truth.stitches, other.stitches)[1])
    return {
        "panel_l2": _mean(shapes),
        "panels": _mean(right),
        "edges": _mean(shares),
        "rotation_l2": _mean(rotations),
        "translation_l2": _mean(translations),
        "stitch_recall": _mean(recall),
        "accuracy": _mean(right) * _mean(shares),
    }


# --- Common --------------------------------------------------------------------------------------


def _shape_distance(a: Float[np.ndarray, "edge 4"], b: Float[np.ndarray, "edge 4"]) -> float:
    """Mean distance of vertices and control points, both centred on their own mean [cm]."""
    one, two = _points(a), _points(b)
    return float(np.linalg.norm((one - one.mean(0)) - (two - two.mean(0)), axis=1).mean())


def _points(rows: Float[np.ndarray, "edge 4"]) -> Float[np.ndarray, "point 2"]:
    """The origin, then for each edge its control point and its end; n edges give 2 n + 1."""
    chord, along, left = rows[:, :2], rows[:, 2:3], rows[:, 3:]
    ends = np.cumsum(chord, axis=0)
    beside = np.stack([-chord[:, 1], chord[:, 0]], 1)
    controls = ends - chord + along * chord + left * beside
    both = np.stack([controls, ends], 1).reshape(-1, 2)
    return np.concatenate([np.zeros((1, 2)), both])


def _stitch_scores(
    truth: frozenset[SlotStitch], found: frozenset[SlotStitch]
) -> tuple[float, float, float]:
    """Precision, recall and F1; 0 where there is nothing to divide by."""
    right = len(truth & found)
    precision = right / len(found) if found else 0.0
    recall = right / len(truth) if truth else 0.0
    total = precision + recall
    return precision, recall, 2 * precision * recall / total if total else 0.0


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _row(loop: Loop, number: int) -> tuple[float, float, float, float]:
    edge = loop.edges[number]
    (x0, y0), (x1, y1) = loop.vertices[edge.start], loop.vertices[edge.end]
    return (x1 - x0, y1 - y0, *_control(loop, edge, number))


def _control(loop: Loop, edge: Edge, number: int) -> tuple[float, float]:
    """The control point of the quadratic curve with the edge's own middle."""
    if edge.curvature is None:
        return 0.0, 0.0
    if isinstance(edge.curvature, Quadratic):
        return edge.curvature.control
    (x0, y0), (mx, my), (x1, y1) = loop.curves[number].at(np.array([0.0, 0.5, 1.0]))
    length = hypot(x1 - x0, y1 - y0)
    turn = atan2(y1 - y0, x1 - x0)
    cos, sin = np.cos(turn), np.sin(turn)
    dx, dy = 2 * mx - (x0 + x1) / 2 - x0, 2 * my - (y0 + y1) / 2 - y0
    return float((dx * cos + dy * sin) / length), float((dy * cos - dx * sin) / length)
