"""Proof: whether an image decodes to its pattern, and if not, what is lost."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import dist, sqrt

import numpy as np
from jaxtyping import Float

from garmentimage.compare import (
    StitchGraph,
    compare_patterns,
    differences_on_cloth,
    lengths_agree,
    match_graphs,
    same_stitch_graph,
    stitch_graph,
    surely_same,
)
from garmentimage.errors import DecodeError
from garmentimage.pattern import Pattern
from garmentimage.raster.image import GarmentImage

Bows = dict[tuple[str, int | None], float]
"""For edges (panel, edge number): how many times as far as on the edge points lie off its chord."""

BOW_LIMIT = 2.0
"""A bend that must reach more than this many times as far is another shape: it is not bowed."""


@dataclass(frozen=True)
class Disproof:
    """Why an image does not decode to its pattern."""

    reason: str = ""
    """In words; "" where it does."""
    bows: Mapping[tuple[str, int | None], float] = field(default_factory=dict)
    """Where only lengths of seams are lost: what would restore them, see `Bows`."""


def disproof(pattern: Pattern, graph: StitchGraph, image: GarmentImage) -> Disproof:
    """Decode an image, and name what of its pattern is lost.

    `compare_patterns` decides; it is called only where a quicker test leaves doubt.

    Args:
        pattern: what the image should show.
        graph: its stitch graph.
        image: with the marks of its panels.
    """
    from garmentimage.raster.decode import decode

    try:
        decoded = decode(image)
    except DecodeError as error:
        return Disproof(f"its image cannot be decoded: {error}")
    back = stitch_graph(decoded)
    # With marks every panel has its name again, so that no other assignment is searched.
    same = {name: name for name in graph.panels if name in back.panels}
    lost = differences_on_cloth(pattern, decoded, same)
    if not lost and surely_same(pattern, decoded, (graph, back)):
        return Disproof()
    lost = lost or same_stitch_graph(graph, back, same)
    if not lost:
        result = compare_patterns(pattern, decoded)
        if result.success:
            return Disproof()
        lost = list(result.reasons)
    reason, *others = lost
    more = f" (and {len(others)} more)" if others else ""
    return Disproof(
        f"its image does not decode to it: {reason}{more}", lengthening(pattern, graph, back)
    )


def bowed(points: Float[np.ndarray, "n 2"], bow: float) -> Float[np.ndarray, "n 2"]:
    """Points of an edge, `bow` times as far off its chord as they are."""
    share = np.linspace(0, 1, len(points))[:, None]
    chord = (1 - share) * points[0] + share * points[-1]
    return np.asarray(chord + bow * (points - chord))


def lengthening(pattern: Pattern, graph: StitchGraph, back: StitchGraph) -> Bows:
    """What would restore the lengths of seams; nothing where more than lengths differ.

    For a flat bend of width w the length l is about sqrt(w² + h²), h growing as the bend does.
    """
    same = {name: (name,) for name in graph.panels}
    match = match_graphs(graph, back, same, check_lengths=False)
    if match is None:
        return {}
    bows: Bows = {}
    for k, m in match.sides.items():
        side, found = graph.sides[k], back.sides[m].length
        if lengths_agree(side.length, found):
            continue
        curves = [pattern.curve(edge) for edge in side.sides]
        width = sum(dist(curve.start, curve.end) for curve in curves)
        if min(found, side.length) <= width:
            return {}
        bow = sqrt((side.length**2 - width**2) / (found**2 - width**2))
        if not 1 / BOW_LIMIT <= bow <= BOW_LIMIT:
            return {}
        bows |= {
            (side.panel, edge): bow
            for edge, curve in zip(side.edges, curves, strict=True)
            if not curve.is_straight
        }
    return bows
