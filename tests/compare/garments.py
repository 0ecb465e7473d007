"""Small garments drawn by hand, and ways to write the same garment, or another one, differently."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from garmentimage.geometry.curves import Arc, Bezier, Curve, Line
from garmentimage.pattern.model import (
    Edge,
    Loop,
    Panel,
    Pattern,
    Side,
    Stitch,
    curvature_of,
    loop_from_curves,
)


def line(a, b):
    return Line((float(a[0]), float(a[1])), (float(b[0]), float(b[1])))


def polygon_loop(*points):
    return loop_from_curves([line(a, b) for a, b in pairwise([*points, points[0]])])


def sewn(*pairs):
    """Stitches from ((panel, edge), (panel, edge)) pairs, ends crossing."""
    return tuple(Stitch(Side(*a), Side(*b)) for a, b in pairs)


def darted_skirt(depths=(10, 14)):
    """Front with two waist darts of the given depths and curved hem, plain back, two side seams."""
    first, second = (60 - depth for depth in depths)
    waist = [(35, 60), (28, 60), (26, first), (24, 60), (12, 60), (10, second), (8, 60), (0, 60)]
    corners = [(40, 0), *waist]
    curves: list[Curve] = [line(a, b) for a, b in pairwise([*corners, (-5.0, 0.0)])]
    hem = Bezier((-5.0, 0.0), ((17.0, -6.0),), (40.0, 0.0))
    front = Panel("front", loop_from_curves([*curves, hem]), translation=(0, 0, 20))
    back = Panel(
        "back",
        polygon_loop((0, 0), (45, 0), (37, 60), (5, 60)),
        translation=(22, 0, -20),
        rotation=(0, 180, 0),
    )
    return Pattern(
        (front, back),
        sewn(
            (("front", 0), ("back", 3)),
            (("front", 8), ("back", 1)),
            (("front", 2), ("front", 3)),
            (("front", 5), ("front", 6)),
        ),
    )


def sleeve_with_cuff():
    """A sleeve of two halves, a cuff of one strip sewn to both, and to itself."""
    top = Panel("sleeve_front", polygon_loop((0, 0), (20, 0), (24, 50), (-2, 50)))
    under = Panel(
        "sleeve_back",
        polygon_loop((0, 0), (20, 0), (22, 50), (-4, 50)),
        translation=(20, 0, -15),
        rotation=(0, 180, 0),
    )
    strip = polygon_loop((0, 0), (40, 0), (40, 6), (20, 6), (0, 6))
    cuff = Panel("cuff", strip, translation=(0, -10, 0))
    return Pattern(
        (top, under, cuff),
        sewn(
            (("sleeve_front", 1), ("sleeve_back", 3)),
            (("sleeve_front", 3), ("sleeve_back", 1)),
            (("sleeve_front", 0), ("cuff", 2)),
            (("sleeve_back", 0), ("cuff", 3)),
            (("cuff", 1), ("cuff", 4)),
        ),
    )


def patched_cloth():
    """A square with a square hole, and the patch that fills the hole: one closed seam."""
    hole = polygon_loop((20, 20), (20, 40), (40, 40), (40, 20))
    cloth = Panel("cloth", polygon_loop((0, 0), (60, 0), (60, 60), (0, 60)), (hole,))
    patch = Panel("patch", polygon_loop((0, 0), (20, 0), (20, 20), (0, 20)), translation=(0, 0, 9))
    pairs = ((4, 3), (5, 2), (6, 1), (7, 0))
    return Pattern((cloth, patch), sewn(*((("cloth", k), ("patch", m)) for k, m in pairs)))


def six_gores():
    """Six equal gores round the body: any rotation of them is the same garment."""
    gore = polygon_loop((-15, 0), (15, 0), (8, 60), (-8, 60))
    places = [60.0 * k for k in range(6)]
    panels = tuple(
        Panel(
            f"gore_{k}",
            gore,
            translation=(20 * np.sin(np.deg2rad(a)), 0.0, 20 * np.cos(np.deg2rad(a))),
            rotation=(0.0, a, 0.0),
        )
        for k, a in enumerate(places)
    )
    return Pattern(
        panels, sewn(*(((f"gore_{k}", 1), (f"gore_{(k + 1) % 6}", 3)) for k in range(6)))
    )


def collar():
    """A collar piece whose edge lies on the neck start to start (turned over)."""
    body = Panel("body", polygon_loop((0, 0), (40, 0), (40, 50), (30, 40), (10, 40), (0, 50)))
    arc = Arc((0.0, 0.0), (20.0, 0.0), 12.0, False, True)
    piece = Panel("collar", loop_from_curves([arc, line((20, 0), (20, 8)), line((20, 8), (0, 8)),
                                              line((0, 8), (0, 0))]))  # fmt: skip
    return Pattern((body, piece), (Stitch(Side("body", 3), Side("collar", 2), True),))


GARMENTS = (darted_skirt, sleeve_with_cuff, patched_cloth, six_gores, collar)


def renamed_panels(pattern, name):
    """The same garment with every panel called `name(old name)`."""
    return replace(
        pattern,
        panels=tuple(replace(p, name=name(p.name)) for p in pattern.panels),
        stitches=tuple(
            replace(s, a=replace(s.a, panel=name(s.a.panel)), b=replace(s.b, panel=name(s.b.panel)))
            for s in pattern.stitches
        ),
    )


def reordered(pattern, rng):
    """Panels and stitches in another order, some stitches with their sides exchanged."""
    stitches = [replace(s, a=s.b, b=s.a) if rng.random() < 0.5 else s for s in pattern.stitches]
    return replace(
        pattern,
        panels=tuple(pattern.panels[k] for k in rng.permutation(len(pattern.panels))),
        stitches=tuple(stitches[k] for k in rng.permutation(len(stitches))),
    )


def rebuilt(pattern, panel, pieces):
    """`panel` with each edge replaced by `pieces[edge]`: (curve, stitch number or None) tuples.

    Returns the new panel and where each stitch's parts went: {stitch: [edge, edge, ..]}.
    """
    loops, found, first, number = [], {}, 0, 0
    for loop in panel.loops:
        parts = [part for k in range(len(loop.edges)) for part in pieces[first + k]]
        loops.append(loop_from_curves([curve for curve, _ in parts]))
        for _, key in parts:
            found.setdefault(key, []).append(number)
            number += 1
        first += len(loop.edges)
    return replace(panel, outline=loops[0], holes=tuple(loops[1:])), found


def split_edges(pattern, cuts):
    """The same garment with sewn and free edges cut up.

    Args:
        cuts: side -> share of its length where to cut; a partner is cut at the fitting share.
    """
    cuts = dict(cuts)
    for side, share in list(cuts.items()):
        if side in pattern.partners:
            stitch = next(s for s in pattern.stitches if side in s.sides)
            cuts[pattern.partners[side]] = share if stitch.same_direction else 1 - share
    panels, where = [], {}
    for panel in pattern.panels:
        pieces = []
        for k, curve in enumerate(panel.curves):
            side = Side(panel.name, k)
            halves = curve.split(curve.parameter(cuts[side])) if side in cuts else (curve,)
            pieces.append([(half, side) for half in halves])
        new, found = rebuilt(pattern, panel, pieces)
        panels.append(new)
        where |= {side: [Side(panel.name, e) for e in edges] for side, edges in found.items()}
    stitches = []
    for stitch in pattern.stitches:
        ours, theirs = where[stitch.a], where[stitch.b]
        if not stitch.same_direction:
            theirs = theirs[::-1]
        stitches += [replace(stitch, a=x, b=y) for x, y in zip(ours, theirs, strict=True)]
    # Edges of pleats are left whole.
    pleats = tuple(
        replace(pleat, edges=tuple(where[side][0].edge for side in pleat.sides))
        for pleat in pattern.pleats
    )
    return replace(pattern, panels=tuple(panels), stitches=tuple(stitches), pleats=pleats)


def shifted_loops(pattern, shift):
    """The same garment with every loop starting `shift` edges later."""
    panels, moved = [], {}
    for panel in pattern.panels:
        loops, first = [], 0
        for loop in panel.loops:
            count = len(loop.edges)
            order = [(k + shift) % count for k in range(count)]
            loops.append(replace(loop, edges=tuple(loop.edges[k] for k in order)))
            for new, old in enumerate(order):
                moved[Side(panel.name, first + old)] = Side(panel.name, first + new)
            first += count
        panels.append(replace(panel, outline=loops[0], holes=tuple(loops[1:])))
    stitches = tuple(replace(s, a=moved[s.a], b=moved[s.b]) for s in pattern.stitches)
    return replace(pattern, panels=tuple(panels), stitches=stitches)


def without_stitch(pattern, number):
    """Another garment: one stitch is left open."""
    return replace(pattern, stitches=pattern.stitches[:number] + pattern.stitches[number + 1 :])


def turned_stitch(pattern, number):
    """Another garment: one stitch joins the other ends."""
    stitches = list(pattern.stitches)
    stitches[number] = replace(stitches[number], same_direction=not stitches[number].same_direction)
    return replace(pattern, stitches=tuple(stitches))


def swapped_partners(pattern, one, other):
    """Another garment: two stitches exchange their second sides."""
    stitches = list(pattern.stitches)
    stitches[one], stitches[other] = (
        replace(stitches[one], b=stitches[other].b),
        replace(stitches[other], b=stitches[one].b),
    )
    return replace(pattern, stitches=tuple(stitches))


def transformed_panel(pattern, name, matrix):
    """One panel with its points multiplied by a 2 x 2 matrix; edges keep their numbers."""

    def moved(loop):
        curves = [_transformed(c, np.asarray(matrix, float)) for c in loop.curves]
        ends = {e.start: c.start for e, c in zip(loop.edges, curves, strict=True)}
        edges = tuple(
            Edge(e.start, e.end, curvature_of(c), e.label, e.extra)
            for e, c in zip(loop.edges, curves, strict=True)
        )
        used = tuple(ends.get(k, v) for k, v in enumerate(loop.vertices))
        return Loop(used, edges)

    panels = tuple(
        replace(p, outline=moved(p.outline), holes=tuple(moved(h) for h in p.holes))
        if p.name == name
        else p
        for p in pattern.panels
    )
    return replace(pattern, panels=panels)


def _transformed(curve, matrix):
    start, end = (tuple(map(float, matrix @ p)) for p in (curve.start, curve.end))
    if isinstance(curve, Line):
        return Line(start, end)
    if isinstance(curve, Bezier):
        controls = tuple(tuple(map(float, matrix @ c)) for c in curve.controls)
        return Bezier(start, controls, end)
    scale = float(np.sqrt(abs(np.linalg.det(matrix))))
    flipped = bool(np.linalg.det(matrix) < 0)
    return Arc(start, end, curve.radius * scale, curve.large, curve.right != flipped)
