"""Drawings: the lattice paths of a layout's arcs, attempt by attempt.

An attempt routes the arcs on a fine lattice, disjoint inside a layer, and compacts the drawing to
the lattice of the image. Each step keeps the drawing valid.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from garmentimage.errors import EncodeError, quoted
from garmentimage.raster.encode.lattice.canonical import canonical
from garmentimage.raster.encode.lattice.compact import compact
from garmentimage.raster.encode.lattice.drawing import (
    MAX_REQUIRED_EDGES,
    Drawing,
    DrawnPaths,
    Path,
    drawing_of,
    joined_links,
    with_links,
    with_required_edges,
)
from garmentimage.raster.encode.lattice.polish import polish
from garmentimage.raster.encode.lattice.route import route
from garmentimage.raster.encode.lattice.symmetry import find_mirror, right_half
from garmentimage.raster.encode.layout import LAST_RESORT, Layout, SeamGraph
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType

FINE_CELLS = 128
"""Fine lattice steps across the grid in the first attempt."""


class Attempt(NamedTuple):
    """How finely, and how freely, a layout is drawn."""

    fineness: float
    """Factor on `FINE_CELLS`."""
    corridor: float
    """How far paths may leave their targets [fine steps]."""
    in_order: bool
    """Arcs leave their nodes in the order that their targets have."""
    lowest: int = 1
    """Lowest grid line that may be used. Line 0 is kept for what does not fit otherwise."""


ATTEMPTS = (Attempt(1.0, 5.0, True), Attempt(1.5, 9.0, True), Attempt(2.0, 16.0, True))
"""Tried in turn."""
LAST_ATTEMPTS = (Attempt(1.5, 9.0, False),)
"""Tried when all layouts have failed ..."""
LAST_LAYOUTS = 3
"""... on so many of them."""
LOWEST_ATTEMPTS = ATTEMPTS[0]._replace(lowest=0), ATTEMPTS[2]._replace(lowest=0)
"""Tried at last on those that could be routed."""
PASSES = 3
"""Rounds of compaction along x, then y; the limits of the grid must hold in the last."""
SLIT_CM = 1.0
"""Free edges shorter than this [cm] are pointed out where a garment cannot be drawn."""


def trials(
    layouts: Iterable[Layout], routed: Collection[str]
) -> Iterator[tuple[Layout, tuple[Attempt, ...]]]:
    """Layouts with the attempts to draw each, most promising first.

    Args:
        layouts: can be gone through again and again.
        routed: stages of the layouts whose arcs could be routed so far; read at the end.
    """
    usual = (layout for layout in layouts if layout.stage != LAST_RESORT)
    for number, layout in enumerate(usual):
        yield layout, ATTEMPTS if number == 0 else ATTEMPTS[:2]
    drawn = list(layouts)
    first = [layout for layout in drawn if layout.stage != LAST_RESORT][:LAST_LAYOUTS]
    for layout in first:
        yield layout, LAST_ATTEMPTS
    for layout in drawn:
        if layout.stage == LAST_RESORT:
            yield layout, ATTEMPTS[:2]
    for layout in drawn:
        if layout.stage in routed:
            yield layout, LOWEST_ATTEMPTS


def drawings(
    layout: Layout, frame: BodyFrame, attempts: Sequence[Attempt]
) -> Iterator[list[Path] | EncodeError]:
    """Lattice paths of the arcs, best attempt first, or the error of an attempt that failed.

    A symmetric garment is drawn as its right half first.
    """
    whole = drawing_of(layout, frame)
    mirror = find_mirror(layout) if frame.is_symmetric else None
    half = right_half(whole, mirror) if mirror is not None else None
    for part in (half, None) if half is not None else (None,):
        for attempt in attempts:
            try:
                drawing = whole if part is None else part.drawing
                paths = joined_links(drawing, lattice_paths(drawing, attempt))
                yield paths if part is None else part.unfold(paths)
            except EncodeError as error:
                crossing = _crossing(layout) if error.remedy == "grid" else ""
                yield type(error)(
                    f"{error}{crossing}", remedy="either" if crossing else error.remedy
                )


def _crossing(layout: Layout) -> str:
    """For a message: the panels of two seams that cross when the garment is laid flat, if any."""
    import shapely

    arcs, panels = layout.graph.arcs, layout.graph.placed.panels
    lines = [shapely.LineString(curve) for curve in layout.curves]
    pairs = shapely.STRtree(lines).query(lines, predicate="intersects").T
    for i, j in sorted(map(tuple, pairs.tolist())):
        a, b = arcs[i], arcs[j]
        if i < j and set(a.layers) & set(b.layers) and not {a.a, a.b} & {b.a, b.b}:
            names = sorted({panels[side[0]].source for side in (*a.sides, *b.sides)})
            return (
                f" (laid flat, seams of panels {', '.join(map(quoted, names))} cross; leave a "
                "panel out or check where it is placed)"
            )
    return _slit(layout.graph)


def _slit(graph: SeamGraph) -> str:
    """For a message: the shortest free edge, where it is too short to be meant for an opening."""
    lengths: dict[tuple[int, frozenset[int]], float] = {}
    for arc in graph.arcs:
        if arc.kind == EdgeType.NON_STITCH and not arc.is_inner:
            # An edge that closes on itself is two arcs, but one opening.
            opening = arc.sides[0][0], frozenset((arc.a, arc.b))
            lengths[opening] = lengths.get(opening, 0.0) + arc.length
    length, panel = min(
        ((size, panel) for (panel, _), size in lengths.items()), default=(SLIT_CM, 0)
    )
    if length >= SLIT_CM:
        return ""
    return (
        f" (panel {quoted(graph.placed.panels[panel].source)} has a free edge of only "
        f"{length:.2g} cm; a grid has no room for so small an opening: sew it, or leave it out)"
    )


def lattice_paths(drawing: Drawing, attempt: Attempt = ATTEMPTS[0]) -> list[Path]:
    """Paths of the arcs on the image's lattice, grid lines 1 to N - 1, disjoint inside a layer.

    Raises:
        EncodeError: the drawing is too crowded for this lattice.
    """
    seen = canonical(drawing)
    plain = with_links(seen.drawing)
    fine = max(int(FINE_CELLS * attempt.fineness) // drawing.grid, 2)
    drawn = route(plain, fine, attempt.corridor, attempt.in_order)
    for limit in MAX_REQUIRED_EDGES:
        linked = with_required_edges(plain, limit)
        coarse = _compacted(linked, drawn, attempt.lowest)
        if coarse is not None:
            # Polishing knows the lines from 1 on.
            if min(path.min() for path in coarse) >= 1:
                coarse = polish(linked, coarse)
            return seen.restore(joined_links(linked, coarse))
    raise EncodeError(f"its panels do not all fit on a grid of {drawing.grid}")


def _compacted(drawing: Drawing, drawn: DrawnPaths, lowest: int) -> list[Path] | None:
    """The fine paths on the image's lattice, or None when there is no room."""
    for turn in range(PASSES):
        for along in (0, 1):
            first = lowest if along == 1 else 1
            moved = compact(drawing, drawn, along, first=first)
            if moved is None and turn < PASSES - 1:
                moved = compact(drawing, drawn, along, first=None)
            if moved is None:
                return None
            drawn = moved
    return drawn.paths
