"""Encoding: a sewing pattern becomes a GarmentImage (paper, Section 3.2).

The garment is placed and laid out in the plane with every seam coincident, drawn on a fine
lattice with arcs that share no vertex, and compacted to the image's lattice. Each step keeps the
drawing valid, so the image is valid by construction: every panel one disk of cells, both sides of
a seam the same grid edges. That it is the image of *this* pattern is proven by decoding it.
"""

from collections.abc import Iterator
from math import dist
from numbers import Integral
from typing import Literal

from garmentimage.compare import StitchGraph, stitch_graph
from garmentimage.errors import EncodeError, check_type, quoted
from garmentimage.pattern import TUBE_SHARE, LaidOpen, Pattern, lay_open, turned_round
from garmentimage.pattern.checks import unknown_place
from garmentimage.raster.encode.lattice import (
    CrossingError,
    Path,
    drawings,
    lost_shape,
    trials,
)
from garmentimage.raster.encode.layout import (
    Layout,
    SeamGraph,
    build_seam_graph,
    check_nodes,
    layouts,
)
from garmentimage.raster.encode.placement import Placed, place
from garmentimage.raster.encode.proof import Bows, Disproof, disproof
from garmentimage.raster.encode.rasterize import rasterize, with_turned
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import GarmentImage

GRIDS = (8, 128)
"""Smallest and largest grid that can be encoded to."""
AUTO_GRIDS = (16, 32, 64)
"""Grids that are tried in turn where none is given, or for an error that suggests one."""
Grid = int | Literal["auto"]
MAX_BOW_ROUNDS = 5
"""Rounds in which bends are bowed until their seams decode with their own lengths."""


def encode(
    pattern: Pattern, grid: Grid = "auto", *, frame: BodyFrame | None = None, verify: bool = True
) -> GarmentImage:
    """Draw a sewing pattern on the grid.

    The image is decoded and compared before it is returned: it gives the same panels (each with
    an IoU of 0.9 or more), the same stitch graph, and seams as long within 2 % or 0.5 cm. From the
    channels alone the same outlines come back; names and frames of panels are lost. Panels that
    wrap round the body lie on both layers, and panels that are sewn right side to wrong side, as
    collars and lapels, are laid open; images with either need channel contract 2.

    Args:
        pattern: the garment; placement decides which layer a panel lies on. One that is drawn
            inside out, all loops clockwise seen from outside the body, is turned over.
        grid: cells along each side, N; or "auto", the smallest of 16, 32 and 64 that fits.
        frame: where the grid lies on the body; default: the standard frame of this grid, which
            is what makes images of different garments comparable.
        verify: decode the image to prove it; without, it may be that of another pattern.

    Returns:
        A valid image, the same for the same pattern every time.

    Raises:
        PatternError: the pattern is not sound.
        EncodeError: it does not fit, or its image would not decode to it; names the cause, and a
            grid that is large enough or what to change in the pattern.
        TypeError: the garment is not a Pattern, or the grid neither a whole number nor "auto".
    """
    check_type(pattern, Pattern, "load_pattern(path) reads one from a file")
    if grid != "auto":
        check_type(grid, Integral, 'give the number of cells along each side, or "auto"')
        if not GRIDS[0] <= grid <= GRIDS[1] or grid % 2:
            low, high = GRIDS
            raise EncodeError(f"grid is {grid}; wanted an even number from {low} to {high}")
        grid = int(grid)
    try:
        return _encoded(pattern, grid, frame, verify=verify)
    except EncodeError:
        unknown = unknown_place(pattern)
        if unknown is None:
            raise
        raise EncodeError(str(unknown), remedy="pattern") from None


def _encoded(given: Pattern, grid: Grid, frame: BodyFrame | None, *, verify: bool) -> GarmentImage:
    """See `encode`; errors name the grid or the garment's shape as the cause."""
    opened = lay_open(given)
    image = _encoded_plainly(opened, grid, frame, verify=verify)
    if not opened.turned:
        return image
    image = with_turned(image, given, opened.turned)
    if verify and (found := disproof(given, stitch_graph(given), image)).reason:
        raise EncodeError(found.reason)
    return image


def _encoded_plainly(
    opened: LaidOpen, grid: Grid, frame: BodyFrame | None, *, verify: bool
) -> GarmentImage:
    """The image of a garment whose seams are all plain."""
    pattern = opened.pattern
    placed = place(pattern, opened.turned)
    if not any(panel.faces_out for panel in placed.panels):
        if unknown_place(pattern) is not None:
            raise EncodeError("all its panels face the body", remedy="pattern")
        pattern = turned_round(pattern, [panel.name for panel in pattern.panels])
        placed = place(pattern, opened.turned)
    graph = build_seam_graph(placed)
    check_nodes(graph)
    candidates = _CachedLayouts(layouts(graph, lambda: unknown_place(pattern) is None))
    expected = stitch_graph(pattern) if verify else None
    first = AUTO_GRIDS[0] if grid == "auto" else grid
    try:
        return _encode(pattern, expected, candidates, frame or BodyFrame.standard(first))
    except EncodeError as error:
        if frame is not None or error.remedy == "pattern" or unknown_place(pattern) is not None:
            raise
        tried = [larger for larger in AUTO_GRIDS if larger > first]
        for larger in tried:
            try:
                image = _encode(pattern, expected, candidates, BodyFrame.standard(larger))
            except EncodeError:
                continue
            if grid == "auto":
                return image
            raise EncodeError(
                f"{error}; it fits a grid of {larger}: --grid {larger}, or grid={larger} in Python",
                grid=larger,
            ) from None
        raise _final(error, tried, placed, expected or stitch_graph(pattern)) from None


def _final(
    error: EncodeError, tried: list[int], placed: Placed, expected: StitchGraph
) -> EncodeError:
    """The error where no grid is large enough: the cause may not be the grid at all."""
    whole = {panel.source for panel in placed.panels if not panel.is_part}
    for side in expected.sides:
        other = expected.sides[side.partner]
        apart = dist(side.middle, other.middle) > TUBE_SHARE * expected.panels[side.panel].size
        if other.panel == side.panel and side.panel in whole and apart:
            return EncodeError(
                f"panel {quoted(side.panel)} is sewn to itself to a tube, which does not lie flat; "
                "cut it into a front and a back panel",
                remedy="pattern",
            )
    if error.remedy == "either" or not tried:
        return error
    return EncodeError(f"{error}; nor does it fit a grid of {' or '.join(map(str, tried))}")


class _CachedLayouts:
    """Layouts, computed when first needed and kept for the next grid."""

    def __init__(self, source: Iterator[Layout]) -> None:
        self._source = source
        self._drawn: list[Layout] = []

    def __iter__(self) -> Iterator[Layout]:
        yield from self._drawn
        for layout in self._source:
            self._drawn.append(layout)
            yield layout


def _encode(
    pattern: Pattern, expected: StitchGraph | None, candidates: _CachedLayouts, frame: BodyFrame
) -> GarmentImage:
    """The first image that decodes to the pattern; without its graph, one that keeps its shapes.

    Bends for which the grid has too few edges are bowed, but only where no drawing of the same
    layout has more.
    """
    first: EncodeError | None = None
    routed: set[str] = set()
    for layout, attempts in trials(candidates, routed):
        drawn: list[tuple[list[Path], Disproof | None]] = []
        for paths in drawings(layout, frame, attempts):
            try:
                if isinstance(paths, EncodeError):
                    raise paths
                image = rasterize(pattern, layout.graph, paths, frame)
                reason, found = lost_shape(layout.graph, paths), None
                if not reason and expected is not None:
                    found = disproof(pattern, expected, image)
                    reason = found.reason
                if not reason:
                    return image
                drawn.append((paths, found))
                raise EncodeError(reason)
            except EncodeError as error:
                first = first or error
                if not isinstance(error, CrossingError):
                    routed.add(layout.stage)
        if expected is None:
            continue
        for paths, found in drawn:
            bowed = _bowed_image(pattern, expected, layout.graph, paths, frame, found)
            if bowed is not None:
                return bowed
    raise first or EncodeError("the pattern has no layout")


def _bowed_image(
    pattern: Pattern,
    expected: StitchGraph,
    graph: SeamGraph,
    paths: list[Path],
    frame: BodyFrame,
    found: Disproof | None,
) -> GarmentImage | None:
    """The image of a drawing whose bends are bowed until it decodes to the pattern, if it does.

    Where an edge has too few grid edges, the chords between its points are shorter than it is.
    Points farther off its chord make up for that: seams keep their lengths, panels lose a little
    of their shape. `found` is what the drawing lost without bows, where that is known already.
    """
    bows: Bows = {}
    for _ in range(MAX_BOW_ROUNDS):
        if found is None:
            image = rasterize(pattern, graph, paths, frame, bows)
            found = disproof(pattern, expected, image)
            if not found.reason:
                return image
        if not found.bows:
            return None
        bows |= {side: bows.get(side, 1.0) * bow for side, bow in found.bows.items()}
        found = None
    return None
