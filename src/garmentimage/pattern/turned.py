"""Turned panels, which are sewn right side to wrong side: laid open, and folded over again.

A lapel or a collar is folded over along its seam, so it lies on the garment with its right side
out, and a seam joins the right side of one panel to the wrong side of the other. **Laid open** it
goes on beyond the seam as a stand-up collar does, its wrong side out, and all seams are plain.

Which panels are turned follows from the seams alone: a plain seam joins panels that show the same
side, any other joins two that do not. So the panels of a garment fall in two classes, and the one
with less cloth is turned.
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from math import dist

import numpy as np
from jaxtyping import Float

from garmentimage.errors import PatternError, quoted
from garmentimage.pattern.direction import turned_round
from garmentimage.pattern.model import Panel, Pattern, Side, Stitch, euler_angles

ALREADY_OPEN = -0.5
"""Cosine between the outer faces of two panels below which the seam between them lies open."""


MIN_CHORD_CM = 0.1  # shortest chord of an edge about which a panel can be turned


@dataclass(frozen=True)
class LaidOpen:
    """A garment with plain seams only."""

    pattern: Pattern
    turned: frozenset[str]
    """Names of the panels whose wrong side is out."""


def lay_open(pattern: Pattern) -> LaidOpen:
    """Turn over the panels that are sewn right side to wrong side, so that all seams are plain.

    Their edges run the other way round and have new numbers (see `turned_round`).

    Raises:
        PatternError: the seams contradict each other, as those of a Moebius strip.
    """
    if not any(stitch.same_direction for stitch in pattern.stitches):
        return LaidOpen(pattern, frozenset())
    turned = turned_panels(pattern)
    folds = fold_seams(pattern, turned)
    panels = [
        turned_about(panel, folds[panel.name][0].edge)
        if panel.name in folds and _is_folded(pattern, *folds[panel.name])
        else panel
        for panel in pattern.panels
    ]
    opened = _resewn(replace(pattern, panels=tuple(panels)), turned)
    return LaidOpen(turned_round(opened, turned), frozenset(turned))


def fold_over(pattern: Pattern, turned: Set[str], fold: Set[str], lift: float) -> Pattern:
    """The garment whose turned panels lie open in `pattern`, sewn right side to wrong side.

    Args:
        pattern: with plain seams.
        turned: names of the panels whose wrong side is out.
        fold: those of them that are to be folded over about their seam; the others stay in place.
        lift: how far outward from the panel that they lie on [cm].
    """
    folds = fold_seams(pattern, turned)
    panels = []
    for panel in pattern.panels:
        if panel.name in folds and panel.name in fold:
            mine, other = folds[panel.name]
            over = turned_about(panel, mine.edge)
            moved = np.array(over.translation) + lift * _outer_face(pattern.by_name[other.panel])
            x, y, z = moved.tolist()
            panel = replace(over, translation=(x, y, z))
        panels.append(panel)
    return turned_round(_resewn(replace(pattern, panels=tuple(panels)), turned), turned)


def _resewn(pattern: Pattern, turned: Set[str]) -> Pattern:
    """Seams between panels of which one is turned, as they are once it is turned over."""
    stitches = tuple(
        replace(stitch, same_direction=not stitch.same_direction)
        if (stitch.a.panel in turned) != (stitch.b.panel in turned)
        else stitch
        for stitch in pattern.stitches
    )
    return replace(pattern, stitches=stitches)


def _is_folded(pattern: Pattern, mine: Side, other: Side) -> bool:
    """Whether two panels that are sewn right side to wrong side lie on each other."""
    faces = [_outer_face(pattern.by_name[side.panel]) for side in (mine, other)]
    return bool(faces[0] @ faces[1] > ALREADY_OPEN)


def _outer_face(panel: Panel) -> Float[np.ndarray, " 3"]:
    """Unit normal of the face from which the outline runs counter-clockwise."""
    return np.asarray(panel.matrix[:, 2] * np.sign(panel.outline.area))


def turned_panels(pattern: Pattern) -> set[str]:
    """Names of the panels to be turned: of each connected garment the class with less cloth.

    Raises:
        PatternError: the seams contradict each other.
    """
    sewn: dict[str, list[tuple[str, Stitch]]] = {panel.name: [] for panel in pattern.panels}
    for stitch in pattern.stitches:
        sewn[stitch.a.panel].append((stitch.b.panel, stitch))
        sewn[stitch.b.panel].append((stitch.a.panel, stitch))
    side: dict[str, bool] = {}
    turned: set[str] = set()
    for start in sewn:
        if start in side:
            continue
        side[start] = False
        item = [start]
        for name in item:
            for other, stitch in sewn[name]:
                expected = side[name] ^ stitch.same_direction
                if other not in side:
                    side[other] = expected
                    item.append(other)
                elif side[other] != expected:
                    raise PatternError(
                        f"panels {quoted(name)} and {quoted(other)} are sewn with a twist: their "
                        "seams would have one panel show both its sides, as a Moebius strip does; "
                        "check right_wrong of the seams between them"
                    )
        if any(side[name] for name in item):
            turned |= _smaller_class(pattern, item, side)
    return turned


def _smaller_class(pattern: Pattern, item: Sequence[str], side: Mapping[str, bool]) -> set[str]:
    """Of the two classes the one on outer cloth layers, else the one with less cloth."""
    classes = [[pattern.by_name[n] for n in item if side[n] == k] for k in (False, True)]
    ranks = [
        (-sum(panel.cloth_layer > 0 for panel in each), sum(abs(p.outline.area) for p in each))
        for each in classes
    ]
    return {panel.name for panel in classes[ranks.index(min(ranks))]}


def fold_seams(pattern: Pattern, turned: Set[str]) -> Mapping[str, tuple[Side, Side]]:
    """For each turned panel the two sides of its longest seam to one that is not turned.

    Where it has none, of its longest seam to any other panel. Seams that close on themselves, as
    round a neck, have no chord to turn about.
    """
    longest: dict[str, tuple[bool, float, Side, Side]] = {}
    for stitch in pattern.stitches:
        for mine, other in (stitch.sides, stitch.sides[::-1]):
            if mine.panel in turned and mine.panel != other.panel:
                curve = pattern.curve(mine)
                chord = dist(curve.start, curve.end)
                if chord < MIN_CHORD_CM:
                    continue
                found = other.panel not in turned, chord, mine, other
                if mine.panel not in longest or found[:2] > longest[mine.panel][:2]:
                    longest[mine.panel] = found
    return {name: found[2:] for name, found in longest.items()}


def turned_about(panel: Panel, edge: int) -> Panel:
    """The panel turned over in space by half a turn about the chord of one of its edges."""
    curve = panel.curves[edge]
    start, end = (np.array([*point, 0.0]) for point in (curve.start, curve.end))
    axis = (end - start) / np.linalg.norm(end - start)
    half_turn: Float[np.ndarray, "3 3"] = 2 * np.outer(axis, axis) - np.eye(3)
    moved = panel.matrix @ (start - half_turn @ start) + np.array(panel.translation)
    x, y, z = moved.tolist()
    return replace(panel, rotation=euler_angles(panel.matrix @ half_turn), translation=(x, y, z))
