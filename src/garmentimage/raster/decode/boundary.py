"""Boundaries of decoded panels as half-edges: directed grid edges, each with its stitch partner.

Every half-edge of the image is numbered through. Loops are walked with the cloth on the left *as
seen from outside the body*: front layers as the raster shows them, back layers, which the raster
shows through the body, the other way round. Walked so, two sewn sides always run against each
other, whatever their layers: the start of one meets the end of the other.
"""

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from garmentimage.raster.cells import NEIGHBOURS, CellMesh, half_edges
from garmentimage.raster.image import EdgeType, GarmentImage, PanelMark

NONE = -1  # no partner; or, in `following`, a half-edge that is no longer on any boundary

OPEN_SLIT = np.deg2rad(0.05)
"""Legs that open by less than this angle at their tip lie on each other."""

MAX_JOIN_GAP_CM = 15.0
"""Sides farther apart than this, each in its place in the whole panel, are not its cut."""


@dataclass(frozen=True)
class Cluster:
    """The cells of one panel on one layer, and their mesh after deforming."""

    layer: int
    mesh: CellMesh
    vertices: Float[np.ndarray, "vertex 2"]  # positions [cm]
    mark: PanelMark | None  # what the image says of the panel
    turned_cells: int = 0  # how many of its cells say that the wrong side is out

    @property
    def outward(self) -> int:
        """+1 where the raster shows the cloth from outside the body, -1 where through the body."""
        return 1 if self.layer % 2 == 0 else -1


@dataclass(frozen=True)
class Boundary:
    """The half-edges of all panels."""

    cluster: Int[np.ndarray, " half"]
    tail: Float[np.ndarray, "half 2"]
    head: Float[np.ndarray, "half 2"]
    """Start and end [cm]."""
    partner: Int[np.ndarray, " half"]  # the half-edge that it is sewn to, or `NONE`
    following: Int[np.ndarray, " half"]
    preceding: Int[np.ndarray, " half"]
    wraps: Bool[np.ndarray, " half"]
    """Whether the cloth goes on beyond it, round the body, in the panel of its partner."""
    is_onto: Bool[np.ndarray, " half"]  # whether it is sewn onto the cloth beneath it
    place: Int[np.ndarray, "half 4"]  # layer, row and column of its cell, and its side of it

    @property
    def loops(self) -> list[list[int]]:
        """Closed chains, each from its smallest half-edge on."""
        following = self.following.tolist()
        seen = [k == NONE for k in following]
        loops = []
        for first in range(len(following)):
            if seen[first]:
                continue
            chain, k = [], first
            while not seen[k]:
                seen[k] = True
                chain.append(k)
                k = following[k]
            loops.append(chain)
        return loops

    @property
    def seam_starts(self) -> Bool[np.ndarray, " half"]:
        """Where a run of half-edges with one fate begins: a seam, a leg of a dart, a free edge."""
        before = self.preceding
        mine, theirs = self.partner, self.partner[before]
        free = (mine == NONE) & (theirs == NONE)
        tip = theirs == np.arange(len(mine))
        sewn_on = (mine != NONE) & (theirs != NONE) & ~tip & (mine == before[theirs])
        changes = (self.wraps != self.wraps[before]) | (self.is_onto != self.is_onto[before])
        starts: Bool[np.ndarray, " half"] = (self.following != NONE) & (~(free | sewn_on) | changes)
        return starts


def trace_boundary(image: GarmentImage, clusters: Sequence[Cluster]) -> Boundary:
    """The half-edges of `clusters` and who is sewn to whom (paper, Section 3.3).

    `SIDE_BY_SIDE` joins a half-edge to the opposite one of the neighbouring cell, `FRONT_TO_BACK`
    and `WRAP` to the same side of the same cell on the other layer of its pair. `SHEET` joins it
    to either of the two on the other sheet, the first that is `SHEET` and chooses it, too. A
    half-edge whose partner is missing stays free.
    """
    sides = [_sides_of(image, cluster) for cluster in clusters]
    sizes = [len(each.kind) for each in sides]
    first = np.cumsum([0, *sizes[:-1]])
    onward = np.concatenate([each.onward + k for each, k in zip(sides, first, strict=True)])
    preceding = np.empty(len(onward), np.int64)
    preceding[onward] = np.arange(len(onward))
    partner = _partners(image, sides)
    kind = np.concatenate([each.kind for each in sides])
    return Boundary(
        np.repeat(np.arange(len(clusters)), sizes),
        np.concatenate([each.tail for each in sides]),
        np.concatenate([each.head for each in sides]),
        partner,
        onward,
        preceding,
        (kind == EdgeType.WRAP) & (partner != NONE),
        kind == EdgeType.ONTO,
        np.concatenate([each.place for each in sides]),
    )


class _ClusterSides(NamedTuple):
    """The half-edges of one cluster, numbered from 0."""

    place: Int[np.ndarray, "half 4"]  # layer, row and column of the cell, and its side
    kind: Int[np.ndarray, " half"]  # `EdgeType` of each
    tail: Float[np.ndarray, "half 2"]
    head: Float[np.ndarray, "half 2"]
    onward: Int[np.ndarray, " half"]
    """The next one with the cloth on the left, seen from outside the body."""


def _sides_of(image: GarmentImage, cluster: Cluster) -> _ClusterSides:
    half = half_edges(cluster.mesh, image.edge_type[cluster.layer])
    cells = cluster.mesh.cells[half.cell]
    place = np.column_stack([np.full(len(cells), cluster.layer), cells, half.side])
    start, end = cluster.vertices[half.start], cluster.vertices[half.end]
    if cluster.outward > 0:
        return _ClusterSides(place, half.edge_type, start, end, half.following)
    onward = np.empty(len(cells), np.int64)
    onward[half.following] = np.arange(len(cells))
    return _ClusterSides(place, half.edge_type, end, start, onward)


def _partners(image: GarmentImage, sides: Sequence[_ClusterSides]) -> Int[np.ndarray, " half"]:
    """The half-edge that each is sewn to, by its edge type; `NONE` where there is none."""
    kind = np.concatenate([each.kind for each in sides])
    layer, row, col, side = np.concatenate([each.place for each in sides]).T
    grid = image.grid
    # One cell wider on all sides, so that what lies beyond the grid has no number either.
    number = np.full((image.layers, grid + 2, grid + 2, 4), NONE)
    number[layer, row + 1, col + 1, side] = np.arange(len(kind))
    step = np.array(NEIGHBOURS)[side]

    def beside(other: Int[np.ndarray, " half"]) -> Int[np.ndarray, " half"]:
        at = np.minimum(other, image.layers - 1)
        found = number[at, row + 1 + step[:, 0], col + 1 + step[:, 1], (side + 2) % 4]
        return np.where(other < image.layers, found, NONE)

    def opposite(other: Int[np.ndarray, " half"]) -> Int[np.ndarray, " half"]:
        found = number[np.minimum(other, image.layers - 1), row + 1, col + 1, side]
        return np.where((other < image.layers) & (kind[found] == kind), found, NONE)

    on_sheet = beside(layer ^ 2)
    on_sheet = np.where(kind[on_sheet] == kind, on_sheet, NONE)
    on_sheet = np.where(on_sheet == NONE, opposite(layer ^ 3), on_sheet)
    on_sheet[on_sheet[on_sheet] != np.arange(len(kind))] = NONE
    is_between_layers = np.isin(kind, (EdgeType.FRONT_TO_BACK, EdgeType.WRAP))
    is_sewn = [kind == EdgeType.SIDE_BY_SIDE, is_between_layers, kind == EdgeType.SHEET]
    return np.select(is_sewn, [beside(layer), opposite(layer ^ 1), on_sheet], NONE)


def close_slits(boundary: Boundary, clusters: Sequence[Cluster], chosen: set[int]) -> Boundary:
    """Sew up the slits of the `chosen` clusters from the tip as far as their legs overlap."""
    if not chosen:
        return boundary
    following, preceding = boundary.following.copy(), boundary.preceding.copy()
    tail, head = boundary.tail.copy(), boundary.head.copy()
    tips = np.flatnonzero((boundary.partner != NONE) & (boundary.partner == boundary.following))
    for k in tips.tolist():
        index = int(boundary.cluster[k])
        while index in chosen and following[k] != NONE and boundary.partner[k] == following[k]:
            leg = int(following[k])
            into, out = head[k] - tail[k], head[leg] - tail[leg]
            # At the tip of an open slit the boundary turns back on the side away from the cloth.
            turn = np.arctan2(out[0] * into[1] - out[1] * into[0], -(into @ out))
            if turn * clusters[index].outward > OPEN_SLIT or preceding[k] == leg:
                break
            before, after = int(preceding[k]), int(following[leg])
            following[before], preceding[after] = after, before
            following[[k, leg]] = preceding[[k, leg]] = NONE
            head[before] = tail[after] = (head[before] + tail[after]) / 2
            k = before
    return replace(boundary, tail=tail, head=head, following=following, preceding=preceding)


def join_parts(
    boundary: Boundary, part_of: Sequence[str | None], apart: Set[int] = frozenset()
) -> tuple[Boundary, Int[np.ndarray, " cluster"]]:
    """Join the parts of panels that were cut: along wraps, and where only marks tell, along seams.

    Points of parts with marks must already lie in the whole panel's frame. Wraps are joined first,
    the longest first; two that would close a panel to a tube are not both joined. Of the seams
    between two parts that share a mark the cut is the one whose sides lie nearest to each other.
    The second part is moved onto the first rigidly.

    Args:
        boundary: as traced.
        part_of: for each cluster the name of the panel that it is a part of, or None.
        apart: clusters that are not joined.

    Returns:
        The boundary without the cuts, and for each cluster the one it was joined to, or itself.
    """
    boundary, whole = _join_wraps(boundary, len(part_of), apart)
    for name in sorted({n for n in part_of if n is not None}):
        members = [k for k, n in enumerate(part_of) if n == name and k not in apart]
        for second in members[1:]:
            root = int(whole[members[0]])
            cut = _nearest_seam(boundary, root, second, whole) if whole[second] != root else []
            if cut:
                part = whole == whole[second]
                boundary = _join(boundary, cut, part)
                whole[part] = root
    return boundary, whole


def _join_wraps(
    boundary: Boundary, cluster_count: int, apart: Set[int]
) -> tuple[Boundary, Int[np.ndarray, " cluster"]]:
    """Join clusters along the runs of half-edges where cloth goes on; see `join_parts`."""
    whole = np.arange(cluster_count)
    runs = _wrap_runs(boundary) if boundary.wraps.any() else []
    for run in sorted(runs, key=lambda run: (-len(run), run[0])):
        ends = run[0], int(boundary.partner[run[0]])
        parts = [int(boundary.cluster[k]) for k in ends]
        first, second = sorted(int(whole[part]) for part in parts)
        if first == second or apart & set(parts):
            continue
        if whole[parts[0]] != first:
            run = boundary.partner[run][::-1].tolist()
        joined = _join(boundary, run, whole == second)
        if joined is not boundary:
            boundary = joined
            whole[whole == second] = first
    return boundary, whole


def _wrap_runs(boundary: Boundary) -> list[list[int]]:
    """Runs of half-edges where cloth goes on, each from one of its two sides."""
    starts = boundary.seam_starts
    runs = []
    for first in np.flatnonzero(boundary.wraps & starts).tolist():
        run = [first]
        while boundary.wraps[k := int(boundary.following[run[-1]])] and not starts[k]:
            run.append(k)
        if min(run) < boundary.partner[run].min():
            runs.append(run)
    return runs


def _nearest_seam(boundary: Boundary, first: int, second: int, whole: np.ndarray) -> list[int]:
    """Half-edges on the side of `first` of the likeliest cut between two parts, in order."""
    owner = whole[boundary.cluster]
    starts = boundary.seam_starts
    best: tuple[float, list[int]] = (MAX_JOIN_GAP_CM, [])
    facing = (owner == first) & (boundary.partner != NONE) & (boundary.following != NONE)
    facing[facing] = boundary.cluster[boundary.partner[facing]] == second
    for k in np.flatnonzero(facing & starts).tolist():
        run = [k]
        while facing[n := int(boundary.following[run[-1]])] and not starts[n]:
            run.append(n)
        other = boundary.partner[run]
        gap = np.hypot(*(boundary.tail[run] - boundary.head[other]).T)
        gap = np.concatenate(
            [gap, [np.hypot(*(boundary.head[run[-1]] - boundary.tail[other[-1]]))]]
        )
        best = min(best, (float(gap.mean()), run))
    return best[1]


def _join(boundary: Boundary, cut: list[int], second: Bool[np.ndarray, " cluster"]) -> Boundary:
    """Move the second part, of these clusters, onto the first along `cut`, which is then left out.

    The boundary itself where that would leave nothing of a loop.
    """
    other = boundary.partner[cut]
    here = np.concatenate([boundary.tail[cut], boundary.head[cut[-1:]]])
    there = np.concatenate([boundary.head[other], boundary.tail[other[-1:]]])
    rotation, shift = rigid(there, here)
    tail, head = boundary.tail.copy(), boundary.head.copy()
    moved = second[boundary.cluster]
    tail[moved] = tail[moved] @ rotation.T + shift
    head[moved] = head[moved] @ rotation.T + shift
    following, preceding = boundary.following.copy(), boundary.preceding.copy()
    ends = (
        (int(preceding[cut[0]]), int(following[other[0]])),
        (int(preceding[other[-1]]), int(following[cut[-1]])),
    )
    removed = np.concatenate([cut, other])
    if np.isin(np.array(ends), removed).any():
        return boundary
    for before, after in ends:
        following[before], preceding[after] = after, before
        head[before] = tail[after] = (head[before] + tail[after]) / 2
    following[removed] = preceding[removed] = NONE
    return replace(boundary, tail=tail, head=head, following=following, preceding=preceding)


# Minimises sum |R p_i - q_i|² over rotations R of centred points (orthogonal Procrustes problem).
# In the plane, with p and q as complex numbers, R turns by the argument of sum conj(p_i) q_i.
def rigid(source: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and shift that bring `source` nearest to `target` (least squares)."""
    a, b = source.mean(axis=0), target.mean(axis=0)
    p, q = source - a, target - b
    angle = np.arctan2((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum(), (p * q).sum())
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return rotation, b - rotation @ a
