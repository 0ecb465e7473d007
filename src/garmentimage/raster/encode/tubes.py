"""Tubes: panels that are sewn to themselves all round, as a skirt of one rectangle.

A tube that lies before the body has its seam behind it. It is cut at both sides: the middle stays
where it lies, and the two parts along the seam are turned over about the cuts to the other layer.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import polyline_length, signed_area
from garmentimage.pattern import TUBE_SHARE
from garmentimage.raster.encode.split import (
    SEEN_FROM_SIDE,
    PanelPart,
    SplitPattern,
    edge_starts,
    part_with_hole,
    partner_layer,
    put_parts,
    vertex_at,
)

QUARTER = 0.25
"""The cuts lie at this share of the way from seam to seam, and as far from its other end."""
CHANGE_REACH, VERTEX_REACH = 0.2, 0.05
"""How far from there, in shares of the way, a vertex may lie where the neighbours change from one
layer to the other, and any other vertex."""


def split_tubes(split: SplitPattern) -> None:
    """Cut every tube that faces front or back in three, in place.

    The middle part keeps the panel's layer, the others get the other one. They keep seams where
    they were cut. Larger tubes are cut first: one that is sewn to it finds its vertices there.

    Raises:
        EncodeError: a cut would run through a hole.
    """
    tubes = [part for part in split.parts if _rims(split, part) is not None]
    tubes.sort(key=lambda p: (-abs(signed_area(split.polygon(p))), p.translation[0]))
    undecided = list(tubes)
    for part in tubes:
        open_edges = {e for p in undecided for e in p.edges}
        places = [
            _place(split, part, rim, share, open_edges)
            for rim in _rims(split, part) or ()
            for share in (QUARTER, 1 - QUARTER)
        ]
        vertices = [vertex_at(split, part, place) for place in places]
        undecided.remove(part)
        _cut(split, part, vertices)


def _rims(split: SplitPattern, part: PanelPart) -> tuple[list[int], list[int]] | None:
    """If a panel is a tube, its two runs of edges between the sides that are sewn together."""
    if abs(part.rotation[2, 2]) < SEEN_FROM_SIDE:
        return None
    loop = part.loops[0]
    size = float(np.ptp(split.polygon(part), axis=0).max())
    middles = {edge: split.curves[edge].mean(axis=0) for edge in loop}

    def is_sewn(edge: int) -> bool:
        other = split.sewn.get(edge, (None, False))[0]
        if other not in middles:
            return False
        return bool(np.linalg.norm(middles[edge] - middles[other]) > TUBE_SHARE * size)

    begins = [k for k, edge in enumerate(loop) if is_sewn(loop[k - 1]) and not is_sewn(edge)]
    if len(begins) != 2:
        return None
    runs = []
    for first, last in (begins, begins[::-1]):
        between = loop[first:last] if first < last else loop[first:] + loop[:last]
        runs.append([edge for edge in between if not is_sewn(edge)])
    return runs[0], runs[1]


def _place(
    split: SplitPattern, part: PanelPart, rim: list[int], share: float, undecided: set[int]
) -> float:
    """Where along the loop to cut, near a share of the length of a rim.

    The best place is where the neighbours change from one layer to the other, then any vertex
    nearby.
    """
    lengths = [polyline_length(split.curves[edge]) for edge in rim]
    at = (np.cumsum(lengths)[:-1] / sum(lengths)).tolist()
    layers = [partner_layer(split, edge, undecided) for edge in rim]
    changes = [at[k] for k in range(len(at)) if {layers[k], layers[k + 1]} == {0, 1}]
    for found, reach in ((changes, CHANGE_REACH), (at, VERTEX_REACH)):
        near = min(found, key=lambda place: abs(place - share), default=np.inf)
        if abs(near - share) < reach:
            share = near
            break
    loop, starts = part.loops[0], edge_starts(split, part)
    return float((starts[loop.index(rim[0])] + share * sum(lengths)) % starts[-1])


def _cut(split: SplitPattern, part: PanelPart, vertices: list[int]) -> None:
    """Replace a panel by its middle and the two parts beside it."""
    loop = part.loops[0]
    loop = loop[loop.index(vertices[0]) :] + loop[: loop.index(vertices[0])]
    a, b, c = (loop.index(edge) for edge in vertices[1:])
    runs = loop[:a], loop[a:b], loop[b:c], loop[c:]
    start = [split.curves[run[0]][0] for run in runs]
    cuts = [next(split.numbers) for _ in range(4)]
    for edge, (i, j) in zip(cuts, ((1, 2), (2, 1), (3, 0), (0, 3)), strict=True):
        split.curves[edge] = np.stack([start[i], start[j]])
    split.sew(cuts[0], cuts[1], crossed=True)
    split.sew(cuts[2], cuts[3], crossed=True)
    split.cuts.update(cuts)
    other = 1 - part.layer
    middle = replace(part, loops=[[*runs[0], cuts[0], *runs[2], cuts[2]]], is_part=True)
    beside = [
        replace(_turned(part, start[i], start[j]), loops=[[*run, edge]], layer=other, is_part=True)
        for run, edge, i, j in ((runs[1], cuts[1], 1, 2), (runs[3], cuts[3], 3, 0))
    ]
    for hole in part.loops[1:]:
        part_with_hole(split, part, [middle, *beside], hole).loops.append(hole)
    put_parts(split, part, [middle, *beside])


def _turned(
    part: PanelPart, start: Float[np.ndarray, " 2"], end: Float[np.ndarray, " 2"]
) -> PanelPart:
    """The panel turned over in space by half a turn about a line in it."""
    axis = np.array([*(end - start), 0.0]) / np.linalg.norm(end - start)
    place = np.array([*start, 0.0])
    half_turn = 2 * np.outer(axis, axis) - np.eye(3)
    moved = part.rotation @ (place - half_turn @ place) + part.translation
    return replace(part, rotation=part.rotation @ half_turn, translation=moved)
