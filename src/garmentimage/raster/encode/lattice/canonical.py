"""One way to look at a drawing, so that order, direction and handedness of the input cannot matter.

Arcs and nodes are numbered by where they lie and arcs run upwards; a garment that is not
symmetric is turned to the side that its arcs lean to. What is drawn is turned back afterwards, so
a mirrored garment gives exactly the mirrored image.
"""

from dataclasses import dataclass, replace

import numpy as np

from garmentimage.raster.encode.lattice.drawing import Drawing, Path

LEAN = 1e-3
"""Share of x in the sorting height: enough to tell things of one height apart."""
ROUNDING = 6
"""Decimals of a lattice coordinate that count in comparisons: float noise does not."""


@dataclass(frozen=True)
class Canonical:
    """A renumbered drawing and the way back."""

    drawing: Drawing
    arc: tuple[int, ...]
    """Arc of the original for each arc."""
    reverse: tuple[bool, ...]
    """The arc runs against the original."""
    mirrored: bool
    count: int

    def restore(self, paths: list[Path]) -> list[Path]:
        """Paths of the original drawing."""
        out: list[Path] = [np.zeros((0, 2), np.int64)] * self.count
        for arc, back, path in zip(self.arc, self.reverse, paths):
            path = path[::-1] if back else path
            out[arc] = path * [-1, 1] + [self.drawing.grid, 0] if self.mirrored else path
        return out


def canonical(drawing: Drawing) -> Canonical:
    """Renumber a drawing by place. Links that it has become plain arcs: join them afterwards."""
    curves = [c.round(ROUNDING) for c in drawing.curves]
    mirrored = drawing.axis is None and _leans_left(drawing, curves)
    if mirrored:
        flip, shift = np.array([-1.0, 1.0]), np.array([drawing.grid, 0.0])
        curves = [c * flip + shift for c in curves]
        drawing = replace(drawing, node_target=drawing.node_target * flip + shift)
    reverse = [_height(c[0]) > _height(c[-1]) for c in curves]
    curves = [c[::-1] if back else c for c, back in zip(curves, reverse)]
    order = sorted(
        range(len(curves)),
        key=lambda i: (
            round(_height(curves[i][len(curves[i]) // 2]), ROUNDING),
            round(_height(curves[i][0]), ROUNDING),
            round(_height(curves[i][-1]), ROUNDING),
            int(drawing.layers[i]),
        ),
    )
    tail = np.where(reverse, drawing.head, drawing.tail)[order]
    head = np.where(reverse, drawing.tail, drawing.head)[order]
    ends = np.stack([tail, head], axis=1).ravel()
    nodes = list(dict.fromkeys(ends.tolist()))
    number = np.zeros(len(drawing.node_target), np.int64)
    number[nodes] = np.arange(len(nodes))
    renumbered = replace(
        drawing,
        node_target=drawing.node_target[nodes].round(ROUNDING),
        node_layers=drawing.node_layers[nodes],
        node_on_axis=drawing.node_on_axis[nodes],
        tail=number[tail],
        head=number[head],
        layers=drawing.layers[order],
        free=drawing.free[order],
        on_axis=drawing.on_axis[order],
        curves=tuple(curves[i] for i in order),
        least=drawing.least[order],
        need=drawing.need[order],
        wish=drawing.wish[order],
        weight=drawing.weight[order],
        links=(),
    )
    return Canonical(
        renumbered, tuple(order), tuple(bool(reverse[i]) for i in order), mirrored, len(curves)
    )


def _height(point: np.ndarray) -> float:
    return float(point[1] + LEAN * point[0])


def _leans_left(drawing: Drawing, curves: list[np.ndarray]) -> bool:
    """Whether the arcs' third moment about the middle column lies to the left."""
    moment = 0.0
    for curve, layers in zip(curves, drawing.layers):
        x = curve[:, 0] - drawing.grid / 2
        steps = np.hypot(*np.diff(curve, axis=0).T)
        # Layers and heights weigh differently, so that few asymmetric garments balance out.
        weight = steps * (1.0 + 0.37 * (layers == 1)) * (1.0 + 0.05 * curve[1:, 1])
        moment += float((weight * ((x[1:] + x[:-1]) / 2) ** 3).sum())
    return moment < 0
