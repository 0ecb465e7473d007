"""Reversed seams: their two sides point against each other when all panels lie upright."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from garmentimage.geometry import centroid
from garmentimage.raster.encode.layout.samples import INNER, Samples, ramp
from garmentimage.raster.encode.layout.seam_graph import Arc, SeamGraph

REVERSED_FROM, REVERSED_FULLY = -0.3, -0.6
"""Cosine of the directions of a seam's two sides, from which on and at which it is reversed."""
SHORT_FULLY, SHORT_UP_TO = 6.0, 10.0
"""Lengths [cm] up to which fully, and from which on no more, a reversed seam of the silhouette is
laid along it."""
SHORT_SPAN = 2.5
"""Length that such a seam is given along the silhouette [cm]."""
LONG_SPAN = 0.5
"""Share of its length that a seam between two panels of one layer is given."""
SHORT_STRENGTH, LONG_STRENGTH = 30.0, 8.0
"""Strength of the targets of both."""
FIRM_FULLY, FIRM_UP_TO = 4.0, 8.0
"""Lengths [cm] up to which, and from which on no more, an arc can be held in its direction."""
FIRM_STRENGTH = 60.0
"""Strength of the target of such an arc."""
NEIGHBOUR_REACH = 4 / 15
"""How far along its neighbours, as a share of them, the direction of the silhouette is taken."""


class ArcTarget(NamedTuple):
    """A direction that an arc should have."""

    arc: int
    vector: Float[np.ndarray, " 2"]
    """From its start to its end [cm]."""
    strength: float


def reversed_seam_targets(
    graph: SeamGraph, samples: Samples, rest: Float[np.ndarray, "r 2"]
) -> list[ArcTarget]:
    """Targets for the seams whose two sides point against each other.

    On one layer (the top of a hood) the seam is laid so that each panel is on its own side.
    Between the layers (where a front yoke reaches over the shoulder seam) it is a short part of
    the silhouette, and is laid along it.
    """
    targets: list[ArcTarget] = []
    middle = _mean_positions(samples, rest)
    for i, arc in enumerate(graph.arcs):
        strength = reversal(graph, arc)
        if strength <= 0:
            continue
        if not arc.joins_faces:
            targets.append(ArcTarget(i, _between_panels(graph, arc), LONG_STRENGTH * strength))
            continue
        strength *= 1 - float(ramp(arc.length, SHORT_FULLY, SHORT_UP_TO))
        along = _along_silhouette(graph, samples, middle, i)
        if strength > 0 and along is not None:
            targets.append(ArcTarget(i, along, SHORT_STRENGTH * strength))
    return targets


def short_arc_targets(graph: SeamGraph) -> list[ArcTarget]:
    """Targets for short arcs: their direction at rest."""
    targets: list[ArcTarget] = []
    for i, arc in enumerate(graph.arcs):
        strength = 1 - float(ramp(arc.length, FIRM_FULLY, FIRM_UP_TO))
        strength *= 1 - reversal(graph, arc)
        if strength > 0:
            chord = np.mean([_chord(graph, side) for side in arc.sides], axis=0)
            targets.append(ArcTarget(i, chord, FIRM_STRENGTH * strength))
    return targets


def reversal(graph: SeamGraph, arc: Arc) -> float:
    """1 for a seam whose two sides point against each other, 0 for others, fading between."""
    if len(arc.sides) != 2 or arc.slit:
        return 0.0
    first, second = (_chord(graph, side) for side in arc.sides)
    cosine = first @ second / (np.hypot(*first) * np.hypot(*second) + 1e-9)
    return float(ramp(-cosine, -REVERSED_FROM, -REVERSED_FULLY))


def _chord(graph: SeamGraph, side: tuple[int, int, bool]) -> Float[np.ndarray, " 2"]:
    """From one end of a side to the other, in the direction of its arc [cm]."""
    panel, edge, back = side
    curve = graph.placed.panels[panel].curves[edge]
    return np.asarray((curve[0] - curve[-1]) if back else (curve[-1] - curve[0]))


def _between_panels(graph: SeamGraph, arc: Arc) -> Float[np.ndarray, " 2"]:
    """A vector along which the arc has the first side's panel on its proper hand."""
    panels = [graph.placed.panels[panel] for panel, _, _ in arc.sides]
    across = centroid(panels[0].outline) - centroid(panels[1].outline)
    across *= panels[0].sign * (-1 if arc.sides[0][2] else 1) / (np.hypot(*across) + 1e-9)
    return np.asarray(LONG_SPAN * arc.length * np.array([across[1], -across[0]]))


def _along_silhouette(
    graph: SeamGraph, samples: Samples, points: Float[np.ndarray, "sample 2"], index: int
) -> Float[np.ndarray, " 2"] | None:
    """From the front-to-back seams that continue at one end of a seam to those at the other."""
    arc = graph.arcs[index]
    reach = round(NEIGHBOUR_REACH * (INNER + 1))
    ends = []
    for node in (arc.a, arc.b):
        beyond = [
            points[samples.arcs[j, reach if other.a == node else -1 - reach]]
            for j, other in enumerate(graph.arcs)
            if j != index and other.joins_faces and node in (other.a, other.b)
        ]
        ends.append(np.mean(beyond, axis=0) if beyond else points[node])
    vector = ends[1] - ends[0]
    size = np.hypot(*vector)
    return SHORT_SPAN * vector / size if size > 1e-6 else None


def _mean_positions(
    samples: Samples, rest: Float[np.ndarray, "r 2"]
) -> Float[np.ndarray, "sample 2"]:
    """Rest position of every sample, the mean over the panels that share it."""
    total, times = np.zeros((samples.count, 2)), np.zeros(samples.count)
    np.add.at(total, samples.ids, rest)
    np.add.at(times, samples.ids, 1.0)
    return np.asarray(total / times[:, None])
