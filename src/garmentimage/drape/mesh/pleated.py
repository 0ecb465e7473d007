"""Pleated panels slit along their folds, so that triangles have sides there.

A slit is hardly open and its two sides are sewn to each other, so the mesh is whole again: its
vertices on both sides are one. The cloth is then that of the garment as it was.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from garmentimage.drape.cloth import Cloth
from garmentimage.geometry import Curve, Line, Point
from garmentimage.pattern import (
    Panel,
    Pattern,
    Pleat,
    PleatFoldLine,
    Side,
    Stitch,
    fold_lines,
    loop_from_curves,
)

SLIT_CM = 1e-4  # width of a slit where it opens


@dataclass(frozen=True)
class SlitPattern:
    """A garment whose pleated panels are slit along their folds."""

    pattern: Pattern
    pieces: Mapping[Side, tuple[Side, ...]]
    """For every edge of the garment the edges that it is here, in order."""
    legs: tuple[Stitch, ...] = ()
    """The two sides of each slit, to its tip and back."""

    def whole(self, cloth: Cloth, pattern: Pattern) -> Cloth:
        """The cloth of the garment `pattern`, made from its slit panels."""
        if not pattern.pleats:
            return cloth
        # A corner on one side of a slit is that on the other side.
        same = np.arange(len(cloth.flat))
        for leg in self.legs:
            same[cloth.sides[leg.b]] = cloth.sides[leg.a][::-1]
        sides = {
            side: np.concatenate(
                [same[cloth.sides[pieces[0]]], *(same[cloth.sides[p]][1:] for p in pieces[1:])]
            )
            for side, pieces in self.pieces.items()
        }
        flat = cloth.flat.copy()
        for side, corners in sides.items():
            curve = pattern.curve(side)
            flat[corners[[0, -1]]] = curve.start, curve.end
        kept = np.unique(same)
        inner = ~np.isin(kept, np.concatenate(list(sides.values())))
        kept = kept[np.lexsort((kept, inner, cloth.panel[kept]))]
        number = np.full(len(same), -1)
        number[kept] = np.arange(len(kept))
        lines = [cloth.vertex[cloth.sides[leg.a]] for leg in self.legs]
        return Cloth(
            pattern=pattern,
            flat=flat[kept],
            faces=number[same[cloth.faces]],
            panel=cloth.panel[kept],
            vertex=cloth.vertex[kept],
            sides={side: number[corners] for side, corners in sides.items()},
            folds=np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines]),
        )


def slit_at_folds(pattern: Pattern) -> SlitPattern:
    """The garment with slits; itself where it has no pleats."""
    pieces: dict[Side, tuple[Side, ...]] = {side: (side,) for side in pattern.sides()}
    if not pattern.pleats:
        return SlitPattern(pattern, pieces)
    panels, legs = [], []
    for panel in pattern.panels:
        own = [pleat for pleat in pattern.pleats if pleat.panel == panel.name]
        if own:
            slit = _slit(pattern, panel, own)
            panel = replace(panel, outline=loop_from_curves(slit.curves), notches=())
            pieces |= slit.pieces
            legs += slit.legs
        panels.append(panel)
    stitches = []
    for stitch in pattern.stitches:
        a, b = (pieces[side] for side in stitch.sides)
        facing = b if stitch.same_direction else b[::-1]
        stitches += [replace(stitch, a=x, b=y) for x, y in zip(a, facing, strict=True)]
    found = replace(pattern, panels=tuple(panels), stitches=(*stitches, *legs), pleats=())
    return SlitPattern(found, pieces, tuple(legs))


@dataclass
class _SlitOutline:
    """The outline of a panel while it is slit."""

    name: str
    curves: list[Curve] = field(default_factory=list)
    pieces: dict[Side, tuple[Side, ...]] = field(default_factory=dict)
    legs: list[Stitch] = field(default_factory=list)

    def add(self, curve: Curve) -> Side:
        self.curves.append(curve)
        return Side(self.name, len(self.curves) - 1)

    def slit(self, start: Point, tip: Point, end: Point) -> None:
        self.legs.append(Stitch(self.add(Line(start, tip)), self.add(Line(tip, end))))


def _slit(pattern: Pattern, panel: Panel, pleats: Sequence[Pleat]) -> _SlitOutline:
    folds: dict[int, list[PleatFoldLine]] = {}
    for pleat in pleats:
        for fold in fold_lines(pattern, pleat):
            folds.setdefault(pleat.edges[fold.side], []).append(fold)
    made = _SlitOutline(panel.name)
    for number, curve in enumerate(panel.outline.curves):
        own, done, length = [], 0.0, curve.length
        for fold in folds.get(number, []):
            # A slit opens before the end of the edge, or after any other place.
            first = min(fold.share * length, length - SLIT_CM)
            before, after = curve.split(curve.parameter((first - done) / (length - done)))
            slit, after = after.split(after.parameter(SLIT_CM / (length - first)))
            if first > done:
                own.append(made.add(before))
            made.slit(slit.start, fold.end, slit.end)
            curve, done = after, first + SLIT_CM
        if length - done > SLIT_CM / 2:
            own.append(made.add(curve))
        made.pieces[Side(panel.name, number)] = tuple(own)
    count, more = len(panel.outline.edges), len(made.curves) - len(panel.outline.edges)
    for number in range(count, len(panel.edges)):
        made.pieces[Side(panel.name, number)] = (Side(panel.name, number + more),)
    return made
