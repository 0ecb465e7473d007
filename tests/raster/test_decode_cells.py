import numpy as np
from hypothesis import given, strategies as st

from garmentimage.geometry import connected_components
from garmentimage.raster.cells import HalfEdges, cell_mesh, half_edges, label_panels
from garmentimage.raster.image import EdgeType
from tests.raster.boards import board, with_types


def loops(half: HalfEdges) -> list[list[int]]:
    """The half-edges of each closed chain."""
    return connected_components(len(half.following), enumerate(half.following.tolist()))


@st.composite
def rasters(draw):
    """Any flags and any types on one layer."""
    grid = draw(st.integers(4, 9))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    inside = rng.random((1, grid, grid)) < draw(st.sampled_from([0.4, 0.7, 1.0]))
    types = rng.choice(4, (1, 2, grid, grid), p=[0.7, 0.1, 0.1, 0.1]).astype(np.int8)
    return inside, types


@given(rasters())
def test_every_inside_cell_belongs_to_one_panel_and_no_outside_cell_does(raster):
    labels, count = label_panels(*raster)
    assert ((labels >= 0) == raster[0]).all()
    assert sorted(set(labels[raster[0]].tolist())) == list(range(count))


@given(rasters())
def test_boundary_is_closed_loops_that_pass_each_vertex_once(raster):
    inside, types = raster
    labels, count = label_panels(inside, types)
    for k in range(count):
        mesh = cell_mesh(labels[0] == k, types[0])
        half = half_edges(mesh, types[0])
        assert len(set(half.start)) == len(half.start)
        assert (half.end == half.start[half.following]).all()
        assert sorted(k for loop in loops(half) for k in loop) == list(range(len(half.cell)))


@given(rasters())
def test_panels_of_a_layer_share_no_vertex(raster):
    inside, types = raster
    labels, count = label_panels(inside, types)
    mesh = cell_mesh(inside[0], types[0])
    owner = labels[0][tuple(mesh.cells.T)]
    for vertex in range(mesh.vertex_count):
        assert len(set(owner[(mesh.corner_ids == vertex).any(axis=1)])) == 1
    assert count == len(set(owner))


def test_slit_keeps_two_legs_that_meet_at_its_tip():
    image = board("aa.. aa.. aa.. ....")
    slit = with_types(image, {(0, 1, 1, 1): EdgeType.SIDE_BY_SIDE})
    whole = cell_mesh(image.inside[0], image.edge_type[0])
    cut = cell_mesh(slit.inside[0], slit.edge_type[0])
    assert cut.vertex_count == whole.vertex_count + 1
    (loop,) = loops(half_edges(cut, slit.edge_type[0]))
    assert len(loop) == 12


def test_ring_of_cells_has_an_outline_and_a_hole():
    image = board(".... aaa. a.a. aaa.")
    mesh = cell_mesh(image.inside[0], image.edge_type[0])
    assert sorted(map(len, loops(half_edges(mesh, image.edge_type[0])))) == [4, 12]


def test_last_row_and_column_have_a_free_boundary():
    image = board("aaaa aaaa aaaa aaaa")
    half = half_edges(cell_mesh(image.inside[0], image.edge_type[0]), image.edge_type[0])
    assert (half.edge_type == EdgeType.NON_STITCH).all()
