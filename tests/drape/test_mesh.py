from collections import Counter
from itertools import pairwise
from math import hypot

import numpy as np
import pytest
from hypothesis import given, settings

from garmentimage import draft_pattern, kinds
from garmentimage.drape.mesh.meshing import (
    MAX_EDGE_LENGTH,
    MIN_EDGE_LENGTH,
    explain_vertex_count,
    mesh,
)
from garmentimage.drape.mesh.rest import rest_of, strain
from garmentimage.drape.mesh.triangulate import triangulate
from garmentimage.errors import DrapeError
from garmentimage.examples import example_names, example_path
from garmentimage.geometry.curves import Bezier, Line
from garmentimage.pattern.files.spec import load_pattern, read_pattern
from garmentimage.pattern.model import Edge, Loop, Panel, Pattern, Side, Stitch, loop_from_curves
from tests.corpus import corpus_sample
from tests.garments import garments

FEW = 600
"""Vertices that are enough for a law."""
COUNT_SHARE = 0.15
"""How far the number of vertices may be from what was asked for."""


def polygon_panel(name, *points, holes=()):
    """A panel with straight edges."""
    closed = [*points, points[0]]
    return Panel(name, loop_from_curves([Line(a, b) for a, b in pairwise(closed)]), tuple(holes))


def square(name, size):
    return polygon_panel(name, (0.0, 0.0), (size, 0.0), (size, size), (0.0, size))


def directed_edges(faces):
    return [tuple(e) for k in range(3) for e in faces[:, (k, (k + 1) % 3)].tolist()]


def flat_areas(cloth):
    p = cloth.flat[cloth.faces]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2


def least_angles(points, faces):
    """The least angle of each triangle [degrees]."""
    p = points[faces]
    angles = []
    for k in range(3):
        u, v = p[:, (k + 1) % 3] - p[:, k], p[:, (k + 2) % 3] - p[:, k]
        cosine = (u * v).sum(axis=1) / np.hypot(*u.T) / np.hypot(*v.T)
        angles.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return np.min(angles, axis=0)


def check_cloth(cloth):
    """The laws that hold for every garment."""
    ways = np.array([np.sign(p.outline.area) for p in cloth.pattern.panels])[cloth.face_panel]
    assert np.all(flat_areas(cloth) * ways > 0)
    assert np.array_equal(cloth.face_panel[:, None].repeat(3, 1), cloth.panel[cloth.faces])
    directed = directed_edges(cloth.faces)
    known = set(directed)
    assert len(known) == len(directed)
    parts = {e for corners in cloth.sides.values() for e in pairwise(corners.tolist())}
    assert {(i, j) for i, j in directed if (j, i) not in known} == parts
    sewn = cloth.vertex_faces
    assert np.all((sewn != np.roll(sewn, 1, axis=1)).all(axis=1))
    assert np.array_equal(np.unique(sewn), np.arange(cloth.vertex_count))
    for side, corners in cloth.sides.items():
        curve = cloth.pattern.curve(side)
        ends = cloth.flat[corners[[0, -1]]]
        assert np.array_equal(ends, [curve.start, curve.end])
    for stitch in cloth.pattern.stitches:
        a, b = (cloth.vertex[cloth.sides[side]] for side in stitch.sides)
        assert np.array_equal(a, b if stitch.same_direction else b[::-1])


@given(garments())
@settings(max_examples=15)
def test_triangles_fill_the_panels_and_stitches_join_them(pattern):
    check_cloth(mesh(pattern, vertices=FEW))


@pytest.mark.parametrize("kind", sorted(kinds()))
def test_every_drafted_kind_becomes_cloth_of_about_the_chosen_size(kind):
    cloth = mesh(draft_pattern(kind))
    check_cloth(cloth)
    assert abs(cloth.vertex_count / 2000 - 1) < COUNT_SHARE
    assert np.percentile(least_angles(cloth.flat, cloth.faces), 1) > 20


@pytest.mark.parametrize("name", example_names())
def test_examples_become_cloth_of_good_triangles(name):
    cloth = mesh(load_pattern(example_path(name)))
    check_cloth(cloth)
    assert abs(cloth.vertex_count / 2000 - 1) < COUNT_SHARE
    assert least_angles(cloth.flat, cloth.faces).min() > 15


@pytest.mark.corpus
@pytest.mark.slow
def test_patterns_by_others_become_cloth():
    for path in corpus_sample(60):
        check_cloth(mesh(read_pattern(path)[0]))


def test_the_same_pattern_gives_the_same_cloth():
    pattern = load_pattern(example_path("darted_shirt"))
    one, two = mesh(pattern), mesh(pattern)
    assert np.array_equal(one.flat, two.flat) and np.array_equal(one.faces, two.faces)
    assert np.array_equal(one.vertex, two.vertex)


def test_faces_on_both_sides_of_a_seam_turn_the_same_way():
    cloth = mesh(load_pattern(example_path("trousers")), vertices=FEW)
    assert not any(s.same_direction for s in cloth.pattern.stitches)
    directed = directed_edges(cloth.vertex_faces)
    assert len(set(directed)) == len(directed)


def test_a_clockwise_panel_has_clockwise_faces():
    panel = polygon_panel("p", (0.0, 0.0), (0.0, 30.0), (30.0, 30.0), (30.0, 0.0))
    assert np.all(flat_areas(mesh(Pattern((panel,)))) < 0)


def test_a_stitch_in_the_same_direction_sews_start_to_start():
    pattern = Pattern(
        (square("a", 30.0), square("b", 30.0)), (Stitch(Side("a", 0), Side("b", 0), True),)
    )
    cloth = mesh(pattern)
    a, b = (cloth.vertex[cloth.sides[Side(name, 0)]] for name in "ab")
    assert np.array_equal(a, b)


def test_a_gathered_seam_has_the_parts_of_its_longer_side():
    pattern = Pattern(
        (square("band", 20.0), square("skirt", 50.0)), (Stitch(Side("band", 0), Side("skirt", 2)),)
    )
    cloth = mesh(pattern, vertices=FEW)
    free, sewn = cloth.sides[Side("skirt", 0)], cloth.sides[Side("band", 0)]
    assert len(sewn) == len(cloth.sides[Side("skirt", 2)]) == len(free)


def test_parts_of_an_edge_are_equally_long():
    cloth = mesh(load_pattern(example_path("dress")))
    for side, corners in cloth.sides.items():
        lengths = np.hypot(*np.diff(cloth.flat[corners], axis=0).T)
        assert np.ptp(lengths) < 0.05 * lengths.mean(), side


def test_a_hole_stays_open():
    ring = [(20.0, 20.0), (20.0, 30.0), (30.0, 30.0), (30.0, 20.0)]
    hole = loop_from_curves([Line(a, b) for a, b in pairwise([*ring, ring[0]])])
    points = [(0.0, 0.0), (50.0, 0.0), (50.0, 50.0), (0.0, 50.0)]
    cloth = mesh(Pattern((polygon_panel("p", *points, holes=[hole]),)))
    check_cloth(cloth)
    assert flat_areas(cloth).sum() == pytest.approx(2400)


def test_the_legs_of_a_dart_close_without_bridging_it():
    points = [(0, 0), (14, 0), (15, 12), (16, 0), (30, 0), (30, 40), (0, 40)]
    panel = polygon_panel("p", *((float(x), float(y)) for x, y in points))
    cloth = mesh(Pattern((panel,), (Stitch(Side("p", 1), Side("p", 2)),)), vertices=FEW)
    check_cloth(cloth)
    assert flat_areas(cloth).sum() == pytest.approx(1200 - 12)


def test_a_cone_sewn_to_itself_has_no_triangle_without_area():
    panel = polygon_panel("p", (0.0, 0.0), (12.0, -3.0), (12.0, 3.0))
    cloth = mesh(Pattern((panel,), (Stitch(Side("p", 0), Side("p", 2)),)), vertices=FEW)
    check_cloth(cloth)


def test_a_tube_is_round_even_where_it_is_narrow():
    panel = polygon_panel("p", (0.0, 0.0), (1.0, 0.0), (1.0, 60.0), (0.0, 60.0))
    wide = square("wide", 200.0)
    stitch = Stitch(Side("p", 1), Side("p", 3))
    cloth = mesh(Pattern((panel, wide), (stitch,)), vertices=FEW)
    check_cloth(cloth)
    assert len(set(cloth.vertex[cloth.sides[Side("p", 0)]].tolist())) >= 3


def test_two_rows_of_triangles_lie_across_a_waistband():
    band = polygon_panel("p", (0.0, 0.0), (80.0, 0.0), (80.0, 2.0), (0.0, 2.0))
    cloth = mesh(Pattern((band, square("wide", 100.0))))
    low, high = (set(cloth.sides[Side("p", k)].tolist()) for k in (0, 2))
    across = [(i, j) for i, j in directed_edges(cloth.faces) if i in low and j in high]
    assert across == []


def test_a_thin_tip_is_filled():
    panel = polygon_panel("p", (0.0, 0.0), (60.0, 0.0), (30.0, 0.5), (0.0, 40.0))
    check_cloth(mesh(Pattern((panel,))))


def test_more_vertices_make_shorter_edges():
    pattern = load_pattern(example_path("dress"))
    coarse, fine = (np.median(rest_of(mesh(pattern, vertices=n)).length) for n in (500, 2000))
    assert fine == pytest.approx(coarse / 2, rel=0.1)


def test_edges_are_neither_too_fine_nor_too_coarse():
    tiny, huge = (
        np.median(rest_of(mesh(Pattern((square("p", s),)))).length) for s in (10.0, 400.0)
    )
    assert tiny == pytest.approx(MIN_EDGE_LENGTH, rel=0.1)
    assert huge == pytest.approx(MAX_EDGE_LENGTH, rel=0.1)


@pytest.mark.parametrize("vertices", [0, 10**9])
def test_a_senseless_number_of_vertices_is_refused(vertices):
    with pytest.raises(DrapeError, match="choose 50 to"):
        mesh(Pattern((square("p", 30.0),)), vertices=vertices)


def test_a_panel_that_crosses_itself_is_named():
    bow = polygon_panel("bow tie", (0.0, 0.0), (30.0, 30.0), (30.0, 0.0), (0.0, 30.0))
    with pytest.raises(DrapeError, match="bow tie"):
        mesh(Pattern((bow,)))


def test_rings_that_cross_have_no_triangles():
    crossed = np.array([[0.0, 0.0], [10.0, 0.0], [5.0, 5.0], [5.0, -5.0]])
    assert triangulate([crossed], 1.0) is None


def test_a_thin_curved_panel_is_cut_finer_until_its_sides_part():
    outer = Bezier((0.0, 0.0), ((20.0, -10.0),), (40.0, 0.0))
    back = Bezier((40.0, 0.0), ((20.0, -9.9),), (0.0, 0.0))
    panel = Panel("crescent", loop_from_curves([outer, *back.split(0.4)]))
    check_cloth(mesh(Pattern((panel, square("wide", 300.0)))))


def flat_points(cloth):
    """An unsewn cloth lying in a plane, as vertices."""
    return cloth.sewn(np.column_stack([cloth.flat, np.zeros(len(cloth.flat))]))


def test_flat_cloth_is_at_rest():
    cloth = mesh(Pattern((square("p", 30.0),)), vertices=FEW)
    rest, points = rest_of(cloth), flat_points(cloth)
    i, j = rest.edges.T
    np.testing.assert_allclose(np.linalg.norm(points[i] - points[j], axis=1), rest.length)
    np.testing.assert_allclose(strain(rest, points), 0, atol=1e-12)
    assert rest.face_area.sum() == pytest.approx(900)
    assert rest.vertex_area.sum() == pytest.approx(900)
    assert rest.area.sum() == pytest.approx(3 * 900)


def test_strain_is_the_largest_stretch():
    cloth = mesh(Pattern((square("p", 30.0),)), vertices=FEW)
    turn = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])
    points = flat_points(cloth) * [1.1, 0.9, 1.0] @ turn
    np.testing.assert_allclose(strain(rest_of(cloth), points), 0.1)


def test_a_sewn_edge_is_one_edge_between_two_triangles():
    pattern = Pattern((square("a", 30.0), square("b", 30.0)), (Stitch(Side("a", 0), Side("b", 0)),))
    cloth = mesh(pattern, vertices=FEW)
    rest = rest_of(cloth)
    assert len({tuple(e) for e in rest.edges.tolist()}) == len(rest.edges)
    sides = Counter(
        tuple(sorted(side)) for f in rest.faces.tolist() for side in pairwise([*f, f[0]])
    )
    seam = cloth.vertex[cloth.sides[Side("a", 0)]].tolist()
    assert {sides[tuple(sorted(e))] for e in pairwise(seam)} == {2}


def test_a_gathered_edge_is_as_long_as_its_shorter_side():
    pattern = Pattern(
        (square("band", 20.0), square("skirt", 50.0)), (Stitch(Side("band", 0), Side("skirt", 2)),)
    )
    cloth = mesh(pattern, vertices=FEW)
    rest = rest_of(cloth)
    corners = cloth.sides[Side("band", 0)]
    length = {tuple(e): x for e, x in zip(rest.edges.tolist(), rest.length.tolist(), strict=True)}
    for i, j in pairwise(corners.tolist()):
        own = hypot(*(cloth.flat[i] - cloth.flat[j]))
        assert length[tuple(sorted(cloth.vertex[[i, j]].tolist()))] == pytest.approx(own)


def test_a_part_of_a_cloth_is_the_cloth_of_that_part():
    both = Pattern((square("a", 30.0), square("b", 20.0)))
    cloth = mesh(both, vertices=FEW)
    rest = rest_of(cloth)
    own = np.unique(cloth.vertex[cloth.panel == 1])
    part = rest.part(own)
    assert part.face_area.sum() == pytest.approx(400)
    assert part.vertex_area.sum() == pytest.approx(400)
    points = flat_points(cloth)[own]
    i, j = part.edges.T
    np.testing.assert_allclose(np.linalg.norm(points[i] - points[j], axis=1), part.length)
    np.testing.assert_allclose(strain(part, points), 0, atol=1e-12)


def test_marked_triangles_of_a_cloth_go_with_their_own_edges_only():
    """Both sides of a seam have its vertices; the edges across to the other panel stay behind."""
    front = square("front", 30.0)
    both = Pattern((front, square("collar", 30.0)), (Stitch(Side("front", 2), Side("collar", 0)),))
    cloth = mesh(both, vertices=FEW)
    faces = cloth.face_panel == 1
    vertices = np.unique(cloth.vertex_faces[faces])
    part = rest_of(cloth).part(vertices, faces)
    assert part.face_area.sum() == pytest.approx(900)
    used = np.sort(part.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert set(map(tuple, part.edges.tolist())) == set(map(tuple, used.tolist()))


def ring(name, count):
    turn = 2 * np.pi * np.arange(count) / count
    corners = tuple(zip((30 * np.cos(turn)).tolist(), (30 * np.sin(turn)).tolist(), strict=True))
    return Panel(name, Loop(corners, tuple(Edge(k, (k + 1) % count) for k in range(count))))


@pytest.mark.parametrize(
    "panels, sentence",
    [
        ([square("front", 5000.0)], "2.5e.03 m² of cloth.*check properties.units_in_meter"),
        ([square(f"p{k}", 5.0) for k in range(501)], "501 panels; at most 500"),
        ([ring("ruff", 6000)], "6000 of them round panel 'ruff'"),
        (
            [polygon_panel("far", (1e9, 0.0), (1e9 + 50, 0.0), (1e9, 50.0))],
            "panel 'far' lies 1e.09 cm from its own origin",
        ),
    ],
)
def test_a_pattern_too_large_for_a_garment_is_refused_before_it_is_meshed(panels, sentence):
    with pytest.raises(DrapeError, match=sentence):
        mesh(Pattern(tuple(panels), (), "too much"))


@pytest.mark.parametrize("count", [300, 8000, 40_000])
def test_the_number_of_vertices_is_met(count):
    cloth = mesh(draft_pattern("tee"), vertices=count)
    assert cloth.vertex_count == pytest.approx(count, rel=0.1)


@pytest.mark.parametrize(
    "panel, asked, why",
    [
        (square("handkerchief", 30.0), 50_000, "edges shorter than 0.3 cm"),
        (ring("ruff", 900), 100, "its outlines have so many"),
        (square("cloth", 50.0), 1000, ""),
    ],
)
def test_a_vertex_count_that_is_not_met_is_explained(panel, asked, why):
    count = mesh(Pattern((panel,), ()), vertices=asked).vertex_count
    assert (
        (why in explain_vertex_count(count, asked))
        if why
        else explain_vertex_count(count, asked) == ""
    )
