"""A canonical numbering of nodes and arcs: file order, edge direction and mirroring have no effect.

Arcs and nodes are numbered by where they lie and arcs run upwards; a garment that is not
symmetric is mirrored to the side that its arcs lean to. What is drawn is mirrored back afterwards,
so a mirrored garment gives exactly the mirrored image.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from garmentimage.raster.encode.lattice.drawing import Drawing, Path

LEAN = 1e-3
"""Share of x in the sorting height: enough to order things of one height."""
ROUNDING = 6
"""Decimals of a lattice coordinate that count in comparisons: float noise does not."""


@dataclass(frozen=True)
class Canonical:
    """A renumbered drawing, and how its paths become those of the original."""

    drawing: Drawing
    arc: tuple[int, ...]
    """Arc of the original for each arc."""
    reverse: tuple[bool, ...]
    """The arc runs against the original."""
    mirrored: bool

    def restore(self, paths: list[Path]) -> list[Path]:
        """Paths of the original drawing."""
        out: list[Path] = [np.zeros((0, 2), np.int64)] * len(self.arc)
        for arc, back, path in zip(self.arc, self.reverse, paths, strict=True):
            path = path[::-1] if back else path
            out[arc] = path * [-1, 1] + [self.drawing.grid, 0] if self.mirrored else path
        return out


def canonical(drawing: Drawing) -> Canonical:
    """Renumber a drawing by place. Links that it has become plain arcs: join them afterwards."""
    nodes, grid = drawing.nodes, drawing.grid
    arcs = replace(drawing.arcs, curves=tuple(c.round(ROUNDING) for c in drawing.arcs.curves))
    mirrored = drawing.axis is None and _leans_left(arcs.curves, arcs.layers, grid)
    if mirrored:
        flip, shift = np.array([-1.0, 1.0]), np.array([grid, 0.0])
        arcs = replace(arcs, curves=tuple(c * flip + shift for c in arcs.curves))
        nodes = replace(nodes, target=nodes.target * flip + shift)
    reverse = tuple(_height(c[0]) > _height(c[-1]) for c in arcs.curves)
    arcs = arcs.with_reversed(reverse)
    heights = [
        [round(_height(curve[k]), ROUNDING) for k in (len(curve) // 2, 0, -1)]
        for curve in arcs.curves
    ]
    order = sorted(range(len(arcs)), key=lambda i: (*heights[i], int(arcs.layers[i])))
    arcs = arcs.take(order)
    # Nodes in the order in which the arcs meet them.
    ends = np.stack([arcs.tail, arcs.head], axis=1).ravel()
    met = list(dict.fromkeys(ends.tolist()))
    number = np.zeros(len(nodes), np.int64)
    number[met] = np.arange(len(met))
    nodes = nodes.take(met)
    renumbered = replace(
        drawing,
        nodes=replace(nodes, target=nodes.target.round(ROUNDING)),
        arcs=replace(arcs, tail=number[arcs.tail], head=number[arcs.head]),
        links=(),
    )
    return Canonical(renumbered, tuple(order), tuple(reverse[i] for i in order), mirrored)


def _height(point: Float[np.ndarray, " 2"]) -> float:
    return float(point[1] + LEAN * point[0])


def _leans_left(
    curves: Sequence[Float[np.ndarray, "_ 2"]], layers: Int[np.ndarray, " arc"], grid: int
) -> bool:
    """Whether the arcs' third moment about the middle column lies to the left."""
    moment = 0.0
    for curve, mask in zip(curves, layers.tolist(), strict=True):
        x = curve[:, 0] - grid / 2
        steps = np.hypot(*np.diff(curve, axis=0).T)
        # Layers and heights weigh differently, so that few asymmetric garments balance out.
        weight = steps * (1.0 + 0.37 * (mask == 1)) * (1.0 + 0.05 * curve[1:, 1])
        moment += float((weight * ((x[1:] + x[:-1]) / 2) ** 3).sum())
    return moment < 0
