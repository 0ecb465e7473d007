"""The order of arcs round a node, made that of the panels between them.

Which arc follows which round a node is a fact of the garment: two that bound a corner of a panel
follow each other. A layout may show it otherwise where a panel is a sliver, such as a lapel that
narrows to a point: its two edges cross there. Then their first steps are turned, so that the
drawing begins with the right order; where they lead stays. Only nodes of turned panels are looked
at: other garments have layouts whose order need not be mended.
"""

from collections.abc import Mapping, Sequence
from math import tau

import numpy as np
from jaxtyping import Float

from garmentimage.errors import EncodeError, quoted
from garmentimage.geometry import signed_area
from garmentimage.raster.encode.layout.seam_graph import SeamGraph
from garmentimage.raster.image import EdgeType

MAX_DEGREE = 4
"""Arcs of one layer that can leave a lattice vertex."""

STEPS = (1, 2)
"""Points of a curve, counted from its node, by which its direction there is judged."""

End = tuple[int, bool]
"""(arc, at its head): an end of an arc, seen as leaving its node."""

Curves = tuple[Float[np.ndarray, "_ 2"], ...]


def with_node_order(graph: SeamGraph, curves: Curves) -> Curves:
    """The target curves of the arcs, their first steps turned where the order round a node is not
    that of the garment.
    """
    if not graph.placed.turned:
        return curves
    found = list(curves)
    for layer in range(graph.placed.layer_count):
        after = _following_ends(graph, layer)
        for ends in _ends_by_node(graph, layer).values():
            for step in STEPS if len(ends) > 2 and _has_turned(graph, ends) else ():
                _put_in_order(graph, found, ends, after, step)
    return tuple(found)


def check_nodes(graph: SeamGraph) -> None:
    """Refuse a garment with a point where more seams meet than any drawing has room for.

    A lattice point has four grid edges. Two free edges on either side of an opening can share one.

    Raises:
        EncodeError: names the panels that meet there.
    """
    for layer in range(graph.placed.layer_count):
        after = _following_ends(graph, layer)
        for ends in _ends_by_node(graph, layer).values():
            if len(ends) <= MAX_DEGREE:
                continue
            fans = _fans(ends, after)
            openings = min(sum(_is_free(graph, fan[k]) for fan in fans) for k in (0, -1))
            if len(ends) - openings > MAX_DEGREE:
                arcs = [graph.arcs[arc] for arc, _ in ends]
                panels = graph.placed.panels
                names = sorted({panels[side[0]].source for arc in arcs for side in arc.sides})
                raise EncodeError(
                    f"{len(ends)} seams meet in one point, of panels "
                    f"{', '.join(map(quoted, names))}; a lattice point has room for {MAX_DEGREE}: "
                    "let one of them end elsewhere",
                    remedy="pattern",
                )


def _has_turned(graph: SeamGraph, ends: Sequence[End]) -> bool:
    """Whether a turned panel has an edge that ends here."""
    panels = graph.placed.panels
    sides = (side for arc, _ in ends for side in graph.arcs[arc].sides)
    return any(panels[panel].source in graph.placed.turned for panel, _, _ in sides)


def _is_free(graph: SeamGraph, end: End) -> bool:
    return graph.arcs[end[0]].kind == EdgeType.NON_STITCH


def _ends_by_node(graph: SeamGraph, layer: int) -> dict[int, list[End]]:
    ends: dict[int, list[End]] = {}
    for number, arc in enumerate(graph.arcs):
        if layer in arc.layers:
            ends.setdefault(arc.a, []).append((number, False))
            ends.setdefault(arc.b, []).append((number, True))
    return ends


def _following_ends(graph: SeamGraph, layer: int) -> dict[End, End]:
    """For each end the next one counter-clockwise, where a corner of a panel lies between them."""
    after: dict[End, End] = {}
    for index, panel in enumerate(graph.placed.panels):
        if panel.layer != layer:
            continue
        for number, loop in enumerate(panel.loops):
            outline = np.concatenate([panel.curves[k][:-1] for k in loop])
            cloth_left = (signed_area(outline) > 0) == (number == 0)
            for k, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                arc, back = graph.owner[index, k]
                arriving = arc, not back
                arc, back = graph.owner[index, following]
                leaving = arc, back
                if cloth_left:
                    after[leaving] = arriving
                else:
                    after[arriving] = leaving
    return after


def _fans(ends: Sequence[End], after: Mapping[End, End]) -> list[list[End]]:
    """Ends round a node in chains, counter-clockwise, with cloth between each and the next.

    Where cloth goes all round, the only chain begins anywhere.
    """
    begun = set(after.values())
    fans = [[end] for end in ends if end not in begun] or [[min(ends)]]
    for fan in fans:
        while (following := after.get(fan[-1])) is not None and following not in fan:
            fan.append(following)
    return fans


def _put_in_order(
    graph: SeamGraph,
    curves: list[np.ndarray],
    ends: Sequence[End],
    after: Mapping[End, End],
    step: int,
) -> None:
    """Turn points at one node, in place, if they are in another order."""
    angle = {end: _angle(curves, end, step) for end in ends}
    fans = _fans(ends, after)
    order = [end for fan in sorted(fans, key=lambda fan: angle[fan[0]]) for end in fan]
    if len(order) != len(ends):
        return
    wanted = sorted(angle.values())
    turns = [
        [(wanted[(k + shift) % len(order)] - angle[end]) % tau for k, end in enumerate(order)]
        for shift in range(len(order))
    ]
    moved = min(turns, key=lambda each: sum(min(turn, tau - turn) for turn in each))
    changed = [(end, turn) for end, turn in zip(order, moved, strict=True) if turn]
    if any(len(graph.arcs[arc].layers) > 1 for (arc, _), _ in changed):
        return  # the order on the other layer would change with it
    for end, turn in changed:
        arc, at_head = end
        curve = curves[arc].copy()
        tip, near = (-1, -1 - step) if at_head else (0, step)
        if len(curve) <= step + 1:
            continue  # its other end is not turned
        cos, sin = np.cos(turn), np.sin(turn)
        turned = np.array([[cos, -sin], [sin, cos]]) @ (curve[near] - curve[tip])
        curve[near] = curve[tip] + turned
        curves[arc] = curve


def _angle(curves: Sequence[np.ndarray], end: End, step: int) -> float:
    arc, at_head = end
    curve = curves[arc][::-1] if at_head else curves[arc]
    x, y = curve[min(step, len(curve) - 1)] - curve[0]
    return float(np.arctan2(y, x))
