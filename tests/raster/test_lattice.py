"""The drawing stays what it is through routing, compaction and polishing."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from garmentimage import EncodeError
from garmentimage.draft.kind import draft_pattern
from garmentimage.geometry.curves import Line
from garmentimage.pattern.model import Panel, Pattern, loop_from_curves
from garmentimage.raster.encode.deform import deform_quad_mesh
from garmentimage.raster.encode.lattice.attempts import ATTEMPTS, lattice_paths
from garmentimage.raster.encode.lattice.canonical import canonical
from garmentimage.raster.encode.lattice.compact import compact
from garmentimage.raster.encode.lattice.drawing import drawing_of, joined_links, with_links
from garmentimage.raster.encode.lattice.polish import polish
from garmentimage.raster.encode.lattice.rotation import departures
from garmentimage.raster.encode.lattice.route import route
from garmentimage.raster.encode.lattice.symmetry import find_mirror, right_half
from garmentimage.raster.encode.layout.seam_graph import build_seam_graph
from garmentimage.raster.encode.layout.solve import layouts
from garmentimage.raster.encode.placement import place
from garmentimage.raster.frame import BodyFrame
from tests.garments import garments
from tests.raster.panels import square_frame

slowly = settings(max_examples=12)
FINE = 8


def first_layout(garment):
    return next(iter(layouts(build_seam_graph(place(garment)))))


def plain_drawing(garment, grid=16):
    drawing = drawing_of(first_layout(garment), BodyFrame.standard(grid))
    return with_links(canonical(drawing).drawing)


def assert_disjoint(drawing, paths):
    """Every path is a lattice path between its nodes, and no vertex of a layer has two owners."""
    owner, arcs = {}, drawing.arcs
    for i, path in enumerate(paths):
        assert (np.abs(np.diff(path, axis=0)).sum(axis=1) == 1).all()
        last = len(path) - 1
        for k, vertex in enumerate(map(tuple, path.tolist())):
            end = arcs.tail[i] if k == 0 else arcs.head[i] if k == last else None
            name = ("node", int(end)) if end is not None else ("arc", i, k)
            for layer in (0, 1):
                if arcs.layers[i] >> layer & 1:
                    assert owner.setdefault((layer, vertex), name) == name


def compacted(drawing, drawn):
    for _ in range(3):
        for along in (0, 1):
            drawn = compact(drawing, drawn, along) or compact(drawing, drawn, along, first=None)
    return drawn


@slowly
@given(garments())
def test_fine_paths_and_coarse_paths_share_no_vertex(garment):
    drawing = plain_drawing(garment)
    drawn = route(drawing, FINE, 5.0)
    assert_disjoint(drawing, drawn.paths)
    coarse, _ = compacted(drawing, drawn)
    assert_disjoint(drawing, coarse)
    assert_disjoint(drawing, polish(drawing, coarse))


@slowly
@given(garments())
def test_polishing_twice_changes_nothing(garment):
    drawing = plain_drawing(garment)
    coarse, _ = compacted(drawing, route(drawing, FINE, 5.0))
    once = polish(drawing, coarse)
    for a, b in zip(once, polish(drawing, once), strict=True):
        assert np.array_equal(a, b)


@slowly
@given(garments())
def test_arcs_leave_a_node_in_different_directions(garment):
    drawing = plain_drawing(garment)
    leaving, arcs = departures(drawing), drawing.arcs
    for layer in (0, 1):
        taken = set()
        for i in np.flatnonzero(arcs.on_layer(layer)):
            for node, direction in zip((arcs.tail[i], arcs.head[i]), leaving[i], strict=True):
                if direction >= 0:
                    assert (node, direction) not in taken
                    taken.add((node, direction))


def test_compaction_without_room_says_so():
    strip = _rectangle("strip", 60.0, 60.0)
    drawing = plain_drawing(Pattern((strip,)))
    drawn = route(drawing, FINE, 5.0)
    assert compact(replace(drawing, grid=2), drawn, 0) is None


def test_panels_far_off_the_body_are_refused_by_their_spread():
    near = _rectangle("near", 40.0, 40.0)
    far = replace(_rectangle("far", 40.0, 40.0), translation=(9e5, 100.0, 20.0))
    frame = square_frame(16, 10.0, left=-80.0, bottom=0.0)
    drawing = drawing_of(first_layout(Pattern((near, far))), frame)
    with pytest.raises(EncodeError, match="units"):
        lattice_paths(drawing, ATTEMPTS[0])


@pytest.mark.parametrize("arc", range(6))
def test_an_arc_without_length_is_drawn_inside_the_grid(arc):
    """Its vertices once had no weight and so no place: NaN became indices."""
    drawing = plain_drawing(draft_pattern("tee"))
    nodes, arcs = drawing.nodes, drawing.arcs
    curves, target = list(arcs.curves), nodes.target.copy()
    curves[arc] = np.repeat(curves[arc][:1], len(curves[arc]), axis=0)
    target[arcs.head[arc]] = target[arcs.tail[arc]]
    crushed = replace(
        drawing,
        nodes=replace(nodes, target=target),
        arcs=replace(arcs, curves=tuple(curves)),
    )
    coarse, targets = compacted(crushed, route(crushed, FINE, 9.0, in_order=False))
    assert np.isfinite(np.concatenate(targets)).all()
    assert_disjoint(crushed, polish(crushed, coarse))


def test_a_garment_without_a_place_is_refused():
    drawing = plain_drawing(draft_pattern("tee"))
    lost = replace(drawing.arcs, curves=tuple(c * np.nan for c in drawing.arcs.curves))
    with pytest.raises(EncodeError, match="no place on the grid"):
        route(replace(drawing, arcs=lost), FINE, 5.0)


def test_a_symmetric_garment_is_drawn_as_a_half_and_unfolds_to_a_symmetric_whole():
    layout = first_layout(Pattern((_rectangle("front", 40.0, 50.0),)))
    mirror = find_mirror(layout)
    assert mirror is not None
    half = right_half(drawing_of(layout, BodyFrame.standard(16)), mirror)
    assert half is not None
    paths = joined_links(half.drawing, lattice_paths(half.drawing, ATTEMPTS[0]))
    whole = half.unfold(paths)
    points = {tuple(v) for path in whole for v in path.tolist()}
    assert points == {(16 - x, y) for x, y in points}


def test_a_garment_off_the_axis_is_not_called_symmetric():
    panel = replace(_rectangle("pocket", 20.0, 20.0), translation=(30.0, 100.0, 20.0))
    assert find_mirror(first_layout(Pattern((panel,)))) is None


def test_canonical_numbering_forgets_order_and_direction():
    drawing = drawing_of(
        first_layout(Pattern((_rectangle("p", 30.0, 40.0),))), BodyFrame.standard(16)
    )
    order = np.arange(len(drawing.arcs))[::-1]
    shuffled = replace(drawing, arcs=drawing.arcs.take(order).with_reversed([True] * len(order)))
    a, b = lattice_paths(drawing, ATTEMPTS[0]), lattice_paths(shuffled, ATTEMPTS[0])
    for i, path in zip(order, b, strict=True):
        assert np.array_equal(a[i], path[::-1])


def test_a_quad_mesh_whose_boundary_stays_does_not_move():
    side = np.arange(4.0)
    rest = np.array([(x, y) for y in side for x in side])
    edges = [(i, i + 1) for i in range(16) if i % 4 < 3] + [(i, i + 4) for i in range(12)]
    rim = np.array([i for i in range(16) if i % 4 in (0, 3) or i // 4 in (0, 3)])
    moved = deform_quad_mesh(rest, np.array(edges), rim, rest[rim])
    assert np.allclose(moved, rest)


def _rectangle(name: str, width: float, height: float) -> Panel:
    w, h = width / 2, height / 2
    corners = [(-w, -h), (w, -h), (w, h), (-w, h)]
    lines = [Line(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    return Panel(name, loop_from_curves(lines), translation=(0.0, 100.0, 20.0))
