"""Laws of the continuous layout."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings, strategies as st

from garmentimage import EncodeError
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.pattern.model import Pattern
from garmentimage.raster.encode.layout.relax import one_sided_forces
from garmentimage.raster.encode.layout.seam_graph import build_seam_graph
from garmentimage.raster.encode.layout.solve import FIRST, MAX_ARCS, _largest_part, layouts
from garmentimage.raster.encode.placement import place
from tests.corpus import corpus_sample
from tests.garments import designs, garment, garments
from tests.raster.mirror import mirrored_pattern
from tests.raster.panels import LEFT, RIGHT, gored_tube, polygon, rectangle, stitch, tube

laws = settings(max_examples=15)

LIPSCHITZ_MEAN, LIPSCHITZ_MAX = 1.0, 5.0
"""Movement of the layout per movement of the vertices: measured 0.5 and 2.5."""


def first_layout(pattern):
    return next(layouts(build_seam_graph(place(pattern))))


def moved(pattern, size, seed):
    """Every vertex moved at random by up to `size` [cm] along each axis."""
    random = np.random.default_rng(seed)

    def shaken(loop):
        points = np.array(loop.vertices) + random.uniform(-size, size, (len(loop.vertices), 2))
        return replace(loop, vertices=tuple(map(tuple, points.tolist())))

    return Pattern(
        tuple(replace(p, outline=shaken(p.outline)) for p in pattern.panels), pattern.stitches
    )


def by_side(layout):
    """Curves by the side that they are drawn for, in the side's own direction."""
    panels = layout.graph.placed.panels
    return {
        (panels[p].name, edge): curve[::-1] if back else curve
        for arc, curve in zip(layout.graph.arcs, layout.curves, strict=True)
        for p, edge, back in arc.sides
    }


def movement(a, b):
    """Mean and largest distance of the points that two layouts have in common."""
    first, second = by_side(a), by_side(b)
    common = first.keys() & second.keys()
    distance = np.concatenate([np.hypot(*(first[k] - second[k]).T) for k in sorted(common)])
    return distance.mean(), distance.max()


@laws
@given(garments())
def test_plain_garments_are_clean_at_the_first_step(garment):
    layout = first_layout(garment)
    assert layout.problems == ()
    assert layout.stage == FIRST


@laws
@given(garments())
def test_arcs_that_meet_share_their_end_points_exactly(garment):
    layout = first_layout(garment)
    at = {}
    for arc, curve in zip(layout.graph.arcs, layout.curves, strict=True):
        for node, point in ((arc.a, curve[0]), (arc.b, curve[-1])):
            assert (at.setdefault(node, point) == point).all()


@laws
@given(garments(), st.randoms(use_true_random=False))
def test_order_and_names_do_not_matter(garment, random):
    names = {p.name: f"panel {k}" for k, p in enumerate(garment.panels)}
    panels = [replace(p, name=names[p.name]) for p in garment.panels]
    stitches = [
        replace(s, a=replace(s.b, panel=names[s.b.panel]), b=replace(s.a, panel=names[s.a.panel]))
        for s in garment.stitches
    ]
    random.shuffle(panels)
    random.shuffle(stitches)
    a, b = first_layout(garment), first_layout(Pattern(tuple(panels), tuple(stitches)))
    assert [arc.layers for arc in a.graph.arcs] == [arc.layers for arc in b.graph.arcs]
    assert np.allclose(np.concatenate(a.curves), np.concatenate(b.curves), atol=1e-6)


@laws
@given(garments())
def test_a_mirrored_garment_gives_the_mirrored_layout(garment):
    a, b = first_layout(garment), first_layout(mirrored_pattern(garment))
    here = shapely.MultiPoint(np.concatenate(a.curves))
    there = shapely.MultiPoint(np.concatenate(b.curves) * [-1, 1])
    assert here.hausdorff_distance(there) < 1e-6


@pytest.mark.parametrize("size", [0.01, 0.3])
@laws
@given(garments(), st.integers(0, 9))
def test_a_small_movement_of_the_pattern_is_a_small_movement_of_the_layout(size, garment, seed):
    mean, largest = movement(first_layout(garment), first_layout(moved(garment, size, seed)))
    assert mean < LIPSCHITZ_MEAN * size
    assert largest < LIPSCHITZ_MAX * size


@laws
@given(designs())
def test_sleeves_hardly_move_the_rest(design):
    without = first_layout(garment(replace(design, bodice=True, sleeves=False)))
    sleeved = first_layout(garment(replace(design, bodice=True, sleeves=True)))
    mean, _ = movement(without, sleeved)
    assert mean < 1.0


def test_a_layout_keeps_the_shape_of_panels_that_fit():
    layout = first_layout(tube(50, 60, 70))
    points = np.concatenate(layout.curves)
    assert np.allclose(points.min(axis=0), [-25, 40], atol=1e-6)
    assert np.allclose(points.max(axis=0), [25, 100], atol=1e-6)


def test_panels_that_overlap_and_share_no_seam_are_parted():
    """Two tubes side by side, as legs that are not joined, drawn 4 cm into each other."""
    panels = [
        rectangle(f"{face}{side}", 32, 60, (side * 14.0, 60.0, z), (0.0, turn, 0.0))
        for face, z, turn in (("f", 20.0, 0.0), ("b", -20.0, 180.0))
        for side in (-1, 1)
    ]
    stitches = [
        stitch("f1", RIGHT, "b1", LEFT),
        stitch("f-1", LEFT, "b-1", RIGHT),
        stitch("f1", LEFT, "b1", RIGHT),
        stitch("f-1", RIGHT, "b-1", LEFT),
    ]
    layout = first_layout(Pattern(tuple(panels), tuple(stitches)))
    assert layout.problems == ()


def test_halves_of_a_wrapping_panel_are_drawn_beside_the_front_and_the_back():
    layout = first_layout(gored_tube())
    assert layout.problems == ()
    assert np.concatenate(layout.curves)[:, 0].max() > 25


def test_panels_on_top_of_each_other_are_named():
    """What cannot be parted is still drawn, last, with its problems in words."""
    first = rectangle("pocket", 10, 10, (0, 70, 20))
    pattern = tube()
    placed = Pattern((*pattern.panels, first), pattern.stitches)
    drawn = list(layouts(build_seam_graph(place(placed))))
    assert all("pocket" in " ".join(layout.problems) for layout in drawn if layout.problems)
    assert [bool(layout.problems) for layout in drawn] == sorted(
        bool(layout.problems) for layout in drawn
    )


def test_layouts_come_lazily_and_every_step_is_drawn_once():
    drawn = list(layouts(build_seam_graph(place(tube()))))
    stages = [layout.stage for layout in drawn]
    assert stages[0] == FIRST
    assert len(set(stages)) == len(stages)


def test_a_garment_laid_out_as_on_paper_is_drawn_in_one_step_only():
    """Freer steps once took up to twenty seconds before the layout on paper was named."""
    graph = build_seam_graph(place(tube()))
    assert len(list(layouts(graph, lambda: False))) == 1
    assert len(list(layouts(graph))) > 1


def test_a_panel_whose_crossings_cannot_be_found_folds_over_itself(monkeypatch):
    """GEOS gives up on some tangles, by chance: an error of its own once left `encode`."""

    def fails(_):
        raise shapely.GEOSException("Iterated noding failed to converge")

    monkeypatch.setattr(shapely, "node", fails)
    bow_tie = shapely.Polygon([(0, 0), (10, 10), (10, 0), (0, 10)])
    part, folded = _largest_part(bow_tie)
    assert part.is_empty and folded == np.inf


def test_more_edges_than_any_grid_has_room_for_are_refused():
    turn = np.linspace(0, 2 * np.pi, MAX_ARCS + 2)[:-1]
    radius = np.where(np.arange(len(turn)) % 2, 30.0, 28.0)
    star = list(
        zip((radius * np.cos(turn)).tolist(), (radius * np.sin(turn)).tolist(), strict=True)
    )
    pattern = Pattern((polygon("star", star, (0.0, 100.0, 20.0)),))
    with pytest.raises(EncodeError, match="'star'"):
        first_layout(pattern)


@given(st.integers(0, 999), st.integers(1, 12))
def test_one_sided_forces_push_only_and_leave_nothing_missing(seed, count):
    random = np.random.default_rng(seed)
    root = random.normal(size=(count, count))
    coupling = root @ root.T + 0.1 * np.eye(count)
    missing = random.normal(size=count)
    force = one_sided_forces(coupling, missing)
    left = coupling @ force - missing
    assert (force >= 0).all()
    assert (left > -1e-7).all()
    assert np.abs(left * force).max() < 1e-6


@pytest.mark.corpus
@pytest.mark.slow
def test_nearly_all_real_garments_are_clean_at_the_first_step():
    clean, total = 0, 0
    for path in corpus_sample(60):
        try:
            graph = build_seam_graph(place(read_pattern(path)[0]))
        except EncodeError:
            continue
        first = next(layouts(graph))
        total += 1
        clean += first.stage == FIRST and not first.problems
    assert clean >= 0.93 * total
