"""Creases: the panel of a pressed pleat is slit along the folds that are seen.

The two sides of such a slit are sewn to each other, so that it is drawn as the legs of a dart are:
a path that ends inside the panel. Rasterizing writes it as a crease, across which the cloth goes
on. A crease begins on the edge of its pleat, beside the end that the fold comes from or midway.
"""

import numpy as np

from garmentimage.errors import EncodeError, quoted
from garmentimage.pattern import Pattern, Pleat, creases, is_on_cloth
from garmentimage.raster.encode.split import SplitPattern


def cut_creases(split: SplitPattern, pattern: Pattern) -> None:
    """Slit panels along the creases of their pleats, in place.

    Raises:
        EncodeError: the panel of a pleat wraps round the body, is folded over itself or traced, or
            a crease leaves its cloth.
    """
    for pleat in pattern.pleats:
        _cut_pleat(split, pattern, pleat)


def _cut_pleat(split: SplitPattern, pattern: Pattern, pleat: Pleat) -> None:
    parts = [part for part in split.parts if part.source == pleat.panel]
    edges = []
    for number in pleat.edges:
        found = [e for p in parts for e in p.loops[0] if split.origin.get(e) == number]
        if len(found) != 1 or any(part.is_part for part in parts):
            raise EncodeError(
                f"a pleat of panel {quoted(pleat.panel)} cannot be drawn: the panel wraps round "
                "the body, or its outline is traced in short edges; cut it at the side, or leave "
                "out that the pleat is pressed",
                remedy="pattern",
            )
        edges += found
    first, second = edges
    _, loop = split.owner(first)
    if not is_on_cloth(pattern, pleat):
        raise EncodeError(
            f"a pleat of panel {quoted(pleat.panel)} is pressed for {pleat.pressed:.1f} cm, "
            "beyond its cloth; press it for less",
            remedy="pattern",
        )
    shown = creases(pattern, pleat)
    # The second edge runs from the fold beneath to B, and is cut where the first one is.
    split.split_edge(first, shown[0].share)
    for crease in shown:
        after = loop[loop.index((first, second)[crease.side]) + 1]
        line = np.array([split.curves[after][0], crease.end])
        there, back = next(split.numbers), next(split.numbers)
        split.curves[there], split.curves[back] = line, line[::-1]
        split.sew(there, back, crossed=True)
        split.creases |= {there, back}
        at = loop.index(after)
        loop[at:at] = [there, back]
    last = loop.index(second) + 1
    last += 2 * (loop[last] in split.creases)
    split.pleats.append(tuple(loop[loop.index(first) : last + 1]))
