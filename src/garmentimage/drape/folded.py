"""Lapels and collars: the panels of a garment that are folded over, and what stands beside them.

A **turned** panel is sewn right side to wrong side and lies on the panel that it is folded onto,
right side out (see `pattern.turned`). A **stand** is a collar's panel that stands up beside it, and
is sewn to it but not to what it lies on. Where the two meet the collar rolls over. A turned panel
may itself be folded onto a stand, which it reaches over.
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool
from shapely import Polygon

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.world_panels import connected_garments, sewn_on_panels
from garmentimage.errors import DrapeError, PatternError
from garmentimage.pattern import Panel, Pattern, Side, Stitch, fold_seams, turned_panels

SAME_WAY = 0.5  # least cosine between the outer faces of panels of which one lies on the other
LEAST_OVERLAP = 0.02  # share of a panel that lies on another one, at least
MAX_STAND = 7.0  # height of a stand beneath a fall, at most [cm]


@dataclass(frozen=True)
class FoldedPanels:
    """The panels of a garment that are put on after the others: turned panels and stands."""

    turned: frozenset[str]  # names of the turned panels
    stands: frozenset[str]  # names of the stands
    seams: Mapping[str, tuple[Side, Side]]
    """For each of them its side of its longest seam to the cloth beneath, and the other side. What
    is sewn to none of it has no entry."""
    below: Mapping[str, tuple[tuple[Side, Side], ...]] = field(default_factory=dict)
    """For each low panel that they are folded onto, as the stand beneath a fall, its seams to the
    cloth below: its side, and the other side."""

    @property
    def names(self) -> frozenset[str]:
        """Names of turned panels and stands."""
        return self.turned | self.stands

    @property
    def bases(self) -> frozenset[str]:
        """Names of the panels that they are sewn to, and of those below these."""
        sewn = {other.panel for _, other in self.seams.values()}
        return frozenset(sewn | {o.panel for seams in self.below.values() for _, o in seams})


def folded_panels(pattern: Pattern, holding: frozenset[str] = frozenset()) -> FoldedPanels:
    """The panels that are folded over.

    None are of a garment that would fall apart or off without them: where they join what is not
    sewn together otherwise, or are among the panels `holding` it up.

    Raises:
        DrapeError: seams contradict each other, as those of a Moebius strip.
    """
    turned: set[str] = set()
    stands: set[str] = set()
    below: dict[str, tuple[tuple[Side, Side], ...]] = {}
    seams: dict[str, tuple[Side, Side]] = {}
    for part in connected_garments(pattern):
        if not any(stitch.same_direction for stitch in part.stitches):
            continue
        try:
            own = turned_panels(part)
        except PatternError as error:
            raise DrapeError(str(error)) from None
        beside = _stands(part, own)
        over = own | beside
        if over & holding or not _is_whole(part, over):
            continue
        turned |= own
        stands |= beside
        folds = {**fold_seams(part, over), **fold_seams(part, own)}
        seams |= {name: sides for name, sides in folds.items() if sides[1].panel not in over}
        low = {s[1].panel for s in folds.values() if _is_low(part.by_name[s[1].panel])} - over
        if low and _is_whole(part, over | low):
            below |= {name: _seams_below(part, name, over) for name in sorted(low)}
    return FoldedPanels(frozenset(turned), frozenset(stands), seams, below)


def overlapping_panels(pattern: Pattern, folded: FoldedPanels) -> Mapping[str, frozenset[str]]:
    """For each panel that overlaps others, as a wrapped front does, the names of those beneath it.

    It is on an outer cloth layer and sewn into the garment, and lies on panels of lower layers that
    face the same way. Turned panels and what is sewn onto cloth are laid on it otherwise.
    """
    outer = {panel.name for panel in pattern.panels if panel.cloth_layer > 0}
    if not outer:
        return {}
    laid = turned_panels(pattern) | folded.names | sewn_on_panels(pattern)
    plain = [panel for panel in pattern.panels if panel.name not in laid]
    found = {
        panel.name: frozenset(
            other.name
            for other in plain
            if other.cloth_layer < panel.cloth_layer and _lies_on(panel, other)
        )
        for panel in plain
        if panel.name in outer
    }
    return {name: beneath for name, beneath in found.items() if beneath}


def _lies_on(panel: Panel, other: Panel) -> bool:
    """Whether a panel covers part of another one that faces the same way, seen from the front."""
    towards = [p.matrix[:, 2] * np.sign(p.outline.area) for p in (panel, other)]
    if towards[0] @ towards[1] < SAME_WAY:
        return False
    # Both in the plane of the first; seams may be drawn a little across each other.
    own, beneath = (
        Polygon(p.to_world(p.outline.polygon) @ panel.matrix[:, :2]).buffer(0)
        for p in (panel, other)
    )
    return bool(own.intersection(beneath).area > LEAST_OVERLAP * own.area)


def on_panels(cloth: Cloth, names: Set[str]) -> Bool[np.ndarray, " face"]:
    """Which triangles belong to panels of these names."""
    own = np.array([panel.name in names for panel in cloth.pattern.panels])
    on: np.ndarray = own[cloth.face_panel]
    return on


def _stands(pattern: Pattern, turned: set[str]) -> set[str]:
    """Panels sewn to a turned one but not to what it lies on, and on which none lies."""
    sewn = _neighbours(pattern.stitches)
    folds = fold_seams(pattern, turned)
    bases = {other.panel for _, other in folds.values()}
    return {
        name
        for mine, other in folds.values()
        for name in sewn[mine.panel] - turned - bases
        if other.panel not in sewn[name]
    }


def _is_low(panel: Panel) -> bool:
    """Whether a panel is as low as the stand of a collar."""
    return bool(np.ptp(panel.outline.polygon, axis=0).min() < MAX_STAND)


def _seams_below(pattern: Pattern, name: str, over: Set[str]) -> tuple[tuple[Side, Side], ...]:
    """The seams of a low panel to others that are not, none of them folded over."""
    return tuple(
        (mine, other)
        for stitch in pattern.stitches
        for mine, other in (stitch.sides, stitch.sides[::-1])
        if mine.panel == name
        and other.panel not in over
        and not _is_low(pattern.by_name[other.panel])
    )


def _is_whole(pattern: Pattern, without: set[str]) -> bool:
    """Whether a garment is all sewn together without some of its panels."""
    left = tuple(panel for panel in pattern.panels if panel.name not in without)
    stitches = tuple(s for s in pattern.stitches if not {s.a.panel, s.b.panel} & without)
    onto = tuple(each for each in pattern.onto if not {each.panel, each.on} & without)
    return len(connected_garments(Pattern(left, stitches, onto=onto))) == 1


def _neighbours(stitches: Sequence[Stitch]) -> dict[str, set[str]]:
    """For each panel the names of those that it is sewn to."""
    sewn: dict[str, set[str]] = {}
    for stitch in stitches:
        sewn.setdefault(stitch.a.panel, set()).add(stitch.b.panel)
        sewn.setdefault(stitch.b.panel, set()).add(stitch.a.panel)
    return sewn
