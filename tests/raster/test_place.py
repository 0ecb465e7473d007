"""Placing panels, splitting those that wrap, and the complex of seams."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from garmentimage import EncodeError
from garmentimage.geometry.polygons import polyline_length, signed_area
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Pattern, loop_from_curves
from garmentimage.pattern.placement import PELVIS_HEIGHT, floor_shift
from garmentimage.raster.encode.layout.seam_graph import build_seam_graph
from garmentimage.raster.encode.placement import place
from garmentimage.raster.image import EdgeType
from tests.corpus import corpus_sample
from tests.garments import garments
from tests.raster.panels import (
    BOTTOM,
    LEFT,
    LEFT_SIDE,
    RIGHT,
    TOP,
    gored_tube,
    polygon,
    rectangle,
    ring,
    stitch,
    tube,
)

laws = settings(max_examples=25)


def by_name(placed):
    return {p.name: p for p in placed.panels}


def lengths(panel):
    return sorted(round(polyline_length(c), 6) for c in panel.curves)


@laws
@given(garments())
def test_placing_is_rigid(garment):
    for placed in place(garment).panels:
        source = garment.by_name[placed.source]
        assert np.allclose(placed.matrix @ placed.matrix.T, np.eye(2))
        for curve, own in zip(placed.curves, source.curves, strict=True):
            ends = np.array([own.start, own.end]) @ placed.matrix.T + placed.offset
            assert np.allclose(curve[[0, -1]], ends)


@laws
@given(garments())
def test_both_sides_of_a_seam_have_the_same_face_out(garment):
    placed = place(garment)
    for seam in placed.seams:
        a, b = placed.panels[seam.a[0]], placed.panels[seam.b[0]]
        assert (a.sign * (-1) ** a.layer == b.sign * (-1) ** b.layer) == seam.crossed


@laws
@given(garments())
def test_every_edge_lies_on_one_arc_between_two_nodes(garment):
    graph = build_seam_graph(place(garment))
    assert all(arc.a != arc.b for arc in graph.arcs)
    sides = [(p, e) for arc in graph.arcs for p, e, _ in arc.sides]
    assert len(set(sides)) == len(sides)
    assert set(sides) == {
        (i, k) for i, p in enumerate(graph.placed.panels) for k in range(len(p.curves))
    }


@laws
@given(garments())
def test_edges_of_a_panel_meet_at_nodes(garment):
    graph = build_seam_graph(place(garment))
    for i, panel in enumerate(graph.placed.panels):
        for loop in panel.loops:
            for k, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                ends = []
                for edge, last in ((k, True), (following, False)):
                    arc, back = graph.owner[i, edge]
                    ends.append(graph.arcs[arc].b if last != back else graph.arcs[arc].a)
                assert ends[0] == ends[1]


def test_a_garment_round_the_pelvis_is_lifted_to_the_floor():
    standing = tube(middle=75.0)
    hanging = Pattern(
        tuple(
            replace(p, translation=(p.translation[0], p.translation[1] - 110, p.translation[2]))
            for p in standing.panels
        ),
        standing.stitches,
    )
    assert floor_shift(standing) == 0
    assert floor_shift(hanging) == PELVIS_HEIGHT
    for a, b in zip(place(standing).panels, place(hanging).panels, strict=True):
        assert np.allclose(a.outline, b.outline)


def test_front_and_back_are_on_their_layers_and_seen_from_the_front():
    placed = by_name(place(tube()))
    assert placed["front"].layer == 0 and placed["front"].sign == 1
    assert placed["back"].layer == 1 and placed["back"].sign == -1


def test_a_sleeve_that_hangs_askew_is_stretched_to_the_side_and_its_cuff_follows():
    body = rectangle("body", 40, 50, (0, 120, 20))
    sleeve = rectangle("sleeve", 40, 20, (40, 120, 20), (0, 0, -45))
    cuff = rectangle("cuff", 20, 6, (58, 102, 20), (0, 0, 45))
    pattern = Pattern(
        (body, sleeve, cuff),
        (stitch("body", RIGHT, "sleeve", LEFT), stitch("sleeve", RIGHT, "cuff", TOP)),
    )
    placed = by_name(place(pattern))
    assert np.allclose(placed["sleeve"].matrix, np.eye(2))
    assert np.allclose(placed["cuff"].matrix, [[0, -1], [1, 0]])


def cut_seams(placed):
    """Seams made by splitting a panel: their sides are of none of its edges."""
    return [s for s in placed.seams if placed.panels[s.a[0]].origin[s.a[1]] is None]


def test_a_wrapping_panel_is_cut_in_two_halves_with_a_seam():
    placed = place(gored_tube())
    halves = [p for p in placed.panels if p.source == "gore"]
    assert sorted(p.layer for p in halves) == [0, 1]
    assert all(p.is_part for p in halves)
    (cut,) = cut_seams(placed)
    assert {placed.panels[cut.a[0]].source, placed.panels[cut.b[0]].source} == {"gore"}
    area = sum(abs(signed_area(p.outline)) for p in halves)
    assert area == pytest.approx(30 * 60)


def test_halves_are_cut_halfway_along_the_hem_wherever_the_depth_lies():
    for shift in (-4.0, 0.0, 4.0):
        pattern = gored_tube()
        panels = [
            replace(p, translation=(30.0, 70.0, shift)) if p.name == "gore" else p
            for p in pattern.panels
        ]
        placed = place(Pattern(tuple(panels), pattern.stitches))
        for half in (p for p in placed.panels if p.is_part):
            assert lengths(half) == [15, 15, 60, 60]


def test_halves_are_unrolled_away_from_the_axis():
    for half in (p for p in place(gored_tube()).panels if p.is_part):
        cut = [c for c in half.curves if np.ptp(c[:, 1]) > 59]
        outer, inner = max(cut, key=lambda c: c[0, 0]), min(cut, key=lambda c: c[0, 0])
        assert outer[0, 0] - inner[0, 0] == pytest.approx(15)
        assert half.outline[:, 0].min() > 0


def test_an_edge_sewn_to_a_wrapping_panel_is_cut_with_it():
    pattern = gored_tube()
    band = rectangle("band", 30, 4, (30, 104, 0), LEFT_SIDE)
    placed = place(
        Pattern((*pattern.panels, band), (*pattern.stitches, stitch("gore", TOP, "band", BOTTOM)))
    )
    assert len([p for p in placed.panels if p.source == "band"]) == 2
    assert len(cut_seams(placed)) == 2
    between = {"gore", "band"}
    seams = [
        s
        for s in placed.seams
        if {placed.panels[s.a[0]].source, placed.panels[s.b[0]].source} == between
    ]
    assert len(seams) == 2


def test_halves_never_take_the_name_of_another_panel():
    pattern = gored_tube()
    loose = rectangle("gore:front", 10, 10, (0, 140, 20))
    names = [p.name for p in place(Pattern((*pattern.panels, loose), pattern.stitches)).panels]
    assert len(set(names)) == len(names)


def test_a_hole_goes_with_its_half():
    hole = loop_from_curves(list(rectangle("", 4, 4, (0, 0, 0)).curves))
    moved = replace(hole, vertices=tuple((x - 8, y) for x, y in hole.vertices))
    pattern = gored_tube()
    panels = [replace(p, holes=(moved,)) if p.name == "gore" else p for p in pattern.panels]
    halves = [p for p in place(Pattern(tuple(panels), pattern.stitches)).panels if p.is_part]
    assert sorted(len(p.loops) for p in halves) == [1, 2]
    assert [len(p.loops) for p in halves if p.layer == 0] == [2]


def test_a_cut_through_a_hole_is_refused():
    hole = loop_from_curves(list(rectangle("", 4, 4, (0, 0, 0)).curves))
    pattern = gored_tube()
    panels = [replace(p, holes=(hole,)) if p.name == "gore" else p for p in pattern.panels]
    with pytest.raises(EncodeError, match=r"'gore'.*hole"):
        place(Pattern(tuple(panels), pattern.stitches))


def test_right_side_to_wrong_side_needs_a_second_cloth_layer():
    pattern = tube()
    collar = rectangle("collar", 50, 8, (0, 106, 20))
    sewn = stitch("front", TOP, "collar", BOTTOM, same_direction=True)
    with pytest.raises(EncodeError, match=r"'collar'.*second cloth layer"):
        place(Pattern((*pattern.panels, collar), (*pattern.stitches, sewn)))


def test_a_dart_is_a_slit():
    points = [(-20, -20), (20, -20), (20, 20), (3, 20), (0, 8), (-3, 20), (-20, 20)]
    front = polygon("front", points, (0.0, 100.0, 20.0))
    graph = build_seam_graph(place(Pattern((front,), (stitch("front", 3, "front", 4),))))
    (dart,) = [arc for arc in graph.arcs if arc.slit]
    assert dart.kind == EdgeType.SIDE_BY_SIDE
    assert graph.node_count == 6


def test_an_edge_that_closes_on_itself_is_split():
    """A slit ring: sewing its ends together closes its inner and its outer edge to rings."""
    graph = build_seam_graph(place(ring(350, sewn=True)))
    assert len(graph.arcs) == 5
    assert all(arc.a != arc.b for arc in graph.arcs)


def test_a_bag_is_refused():
    points = [(-20.0, 0.0), (0.0, -20.0), (20.0, 0.0), (0.0, 20.0)]
    panel = polygon("bag", points, (0.0, 100.0, 20.0))
    seams = (stitch("bag", 0, "bag", 3), stitch("bag", 1, "bag", 2))
    with pytest.raises(EncodeError, match="'bag'"):
        build_seam_graph(place(Pattern((panel,), seams)))


def test_seams_between_the_layers_are_front_to_back():
    kinds = [arc.kind for arc in build_seam_graph(place(tube())).arcs]
    assert kinds.count(EdgeType.FRONT_TO_BACK) == 2
    assert kinds.count(EdgeType.NON_STITCH) == 4


@pytest.mark.corpus
@pytest.mark.slow
def test_real_garments_have_sides_that_face_out_on_both_layers():
    """Panels sewn front to back are of one garment, so only collars may be refused."""
    for path in corpus_sample(60):
        pattern, _ = read_pattern(path)
        try:
            graph = build_seam_graph(place(pattern))
        except EncodeError as error:
            assert "second cloth layer" in str(error)
            continue
        assert {p.layer for p in graph.placed.panels} == {0, 1}, path
