"""From drawn panels to a pattern: seams are joined, edges cut where their partners end.

Two seams are sewn edge to edge. Where the edges of one seam end elsewhere than those of the other
(a waist in two panels over a skirt of three), both are cut at all the ends, so that every stitch
joins one edge to one edge.
"""

from bisect import bisect_right
from collections.abc import Iterable
from itertools import accumulate, islice, pairwise

from garmentimage.draft.curves import lengths_of
from garmentimage.draft.panel import EdgeRef, PanelDraft, Seam
from garmentimage.geometry import Curve, Point
from garmentimage.pattern import (
    Panel,
    Pattern,
    Pleat,
    PleatFold,
    SewnOnto,
    Side,
    Stitch,
    loop_from_curves,
)

SEAM_TOL = 0.01
"""Seams that are sewn flat are equally long within this [cm]."""
_SAME_SHARE = 1e-6
"""Ends nearer than this share of a seam are one end."""


class Assembly:
    """A garment while it is put together: panels, and what is sewn to what."""

    def __init__(self) -> None:
        self._panels: dict[str, PanelDraft] = {}
        self._lengths: dict[str, list[float]] = {}
        self._cuts: dict[tuple[str, int], list[float]] = {}
        self._stitches: list[tuple[tuple[EdgeRef, int], tuple[EdgeRef, int], bool]] = []
        self._onto: list[tuple[str, frozenset[str], str, Point]] = []
        self._pleats: list[tuple[Seam, PleatFold, float]] = []

    def add(self, *panels: PanelDraft) -> None:
        """Take panels in; their edges are measured together, so many at a time are quicker."""
        for panel in panels:
            assert panel.name not in self._panels
            self._panels[panel.name] = panel
        lengths = iter(lengths_of([named.curve for panel in panels for named in panel.outline]))
        for panel in panels:
            self._lengths[panel.name] = list(islice(lengths, len(panel.outline)))

    @property
    def panels(self) -> tuple[PanelDraft, ...]:
        """The panels so far."""
        return tuple(self._panels.values())

    def length(self, seam: Seam) -> float:
        """Length of a seam [cm]."""
        return sum([self._lengths[panel][number] for panel, number in seam])

    def sew(self, a: Seam, b: Seam, *, fullness: float = 1.0, turned: bool = False) -> None:
        """Sew two seams together, the start of one to the end of the other.

        Args:
            a: edges in the order of their loops.
            b: edges in the order of their loops; `a` meets them from the last to the first.
            fullness: how many times as long as `b` the seam `a` is: 1 where nothing is gathered.
            turned: right side to wrong side, as what is folded over: start meets start.
        """
        assert abs(self.length(a) - fullness * self.length(b)) <= SEAM_TOL * fullness, (a, b)
        for ref in (*a, *b):
            assert ref not in self._cuts, f"{ref} is sewn twice"
            self._cuts[ref] = []
        if len(a) == len(b) == 1:
            self._stitches.append(((a[0], 0), (b[0], 0), turned))
            return
        facing = b if turned else b[::-1]
        ends_a, ends_b = self._ends(a), self._ends(facing)
        ends = _merged(ends_a, ends_b)
        pieces_a = self._cut(a, ends_a, ends, backwards=False)
        pieces_b = self._cut(facing, ends_b, ends, backwards=not turned)
        self._stitches += [(p, q, turned) for p, q in zip(pieces_a, pieces_b, strict=True)]

    def sew_onto(self, panel: str, labels: Iterable[str], on: str, offset: Point) -> None:
        """Sew the edges of a panel with these labels onto another's cloth.

        Args:
            panel: what is sewn on, drawn as it lies on the other.
            labels: of its edges.
            on: the panel beneath.
            offset: where the origin of `panel` lies on it [cm].
        """
        self._onto.append((panel, frozenset(labels), on, offset))

    def press(self, edges: Seam, fold: PleatFold, pressed: float) -> None:
        """Press a pleat, whose two edges are sewn to each other, for a length [cm]."""
        self._pleats.append((edges, fold, pressed))

    def sew_pairs(self, a: PanelDraft, b: PanelDraft, label: str) -> None:
        """Sew all edges of one label on a panel to those on another, side by side of the wearer."""
        for side in sorted({n.side for n in a.outline if n.label == label}):
            self.sew(a.seam(label, side), b.seam(label, side))

    def pattern(self, name: str) -> Pattern:
        """The finished pattern."""
        cut = {
            name: [
                _split(named.curve, self._cuts.get((name, k), []))
                for k, named in enumerate(draft.outline)
            ]
            for name, draft in self._panels.items()
        }
        firsts = {name: [0, *accumulate(map(len, edges))] for name, edges in cut.items()}

        def side(ref: EdgeRef, piece: int) -> Side:
            return Side(ref.panel, firsts[ref.panel][ref.number] + piece)

        panels = tuple(_panel(draft, cut[draft.name]) for draft in self._panels.values())
        stitches = tuple(
            Stitch(side(*a), side(*b), same_direction=turned) for a, b, turned in self._stitches
        )
        by_name = {panel.name: panel for panel in panels}
        onto = tuple(
            SewnOnto(
                panel,
                tuple(k for k, e in enumerate(by_name[panel].outline.edges) if e.label in labels),
                on,
                ((1.0, 0.0), (0.0, 1.0)),
                offset,
            )
            for panel, labels, on, offset in self._onto
        )
        pleats = tuple(
            Pleat(first.panel, (side(first, 0).edge, side(second, 0).edge), fold, pressed)
            for (first, second), fold, pressed in self._pleats
        )
        return Pattern(panels, stitches, name=name, onto=onto, pleats=pleats)

    def _ends(self, seam: Seam) -> list[float]:
        """Where the edges of a seam end, as shares of its length; starts with 0."""
        ends = list(accumulate([self._lengths[p][k] for p, k in seam], initial=0.0))
        return [end / ends[-1] for end in ends]

    def _cut(
        self, seam: Seam, own: list[float], ends: list[float], *, backwards: bool
    ) -> list[tuple[EdgeRef, int]]:
        """Cut the edges of a seam at `ends`; the pieces in order."""
        shares: list[list[float]] = [[] for _ in seam]
        pieces: list[tuple[int, int]] = []
        for start, end in pairwise(ends):
            k = bisect_right(own, (start + end) / 2) - 1
            pieces.append((k, len(shares[k])))
            if own[k + 1] - end > _SAME_SHARE:
                shares[k].append((end - own[k]) / (own[k + 1] - own[k]))
        for ref, cuts in zip(seam, shares, strict=True):
            self._cuts[ref] = [1 - cut for cut in reversed(cuts)] if backwards else cuts
        if backwards:
            return [(seam[k], len(shares[k]) - piece) for k, piece in pieces]
        return [(seam[k], piece) for k, piece in pieces]


def _panel(draft: PanelDraft, cut: list[list[Curve]]) -> Panel:
    """The finished panel, whose drawn edges are cut into these pieces."""
    curves = [curve for pieces in cut for curve in pieces]
    labels = [named.label for named, pieces in zip(draft.outline, cut, strict=True) for _ in pieces]
    return Panel(
        draft.name,
        loop_from_curves(curves, labels),
        draft.holes,
        draft.translation,
        draft.rotation,
        draft.label,
        draft.grain,
        cloth_layer=draft.cloth_layer,
    )


def _merged(first: list[float], second: list[float]) -> list[float]:
    """Ends of both seams in order, near ones as one; starts with 0 and ends with 1."""
    ends = [0.0]
    for end in sorted((*first[1:-1], *second[1:-1])):
        if end - ends[-1] > _SAME_SHARE:
            ends.append(end)
    return [*ends, 1.0]


def _split(curve: Curve, cuts: list[float]) -> list[Curve]:
    """The curve cut at the given shares of its length."""
    parts, done = [], 0.0
    for cut in cuts:
        before, curve = curve.split(curve.parameter((cut - done) / (1 - done)))
        parts.append(before)
        done = cut
    return [*parts, curve]
