"""Laws of encoding, over random garments."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import (
    EncodeError,
    ImageError,
    decode,
    encode,
    load_pattern,
    save_image,
    save_pattern,
)
from garmentimage.compare.comparison import compare_patterns
from garmentimage.examples import example_path
from garmentimage.geometry.curves import Line
from garmentimage.pattern.model import Loop, Panel, Pattern, Side, Stitch, loop_from_curves
from garmentimage.raster.cells import label_panels
from tests.garments import garments
from tests.raster.mirror import mirrored_pattern, mirrored_types
from tests.raster.panels import square_frame

slowly = settings(max_examples=15)


@slowly
@given(garments())
def test_decoding_undoes_encoding(garment):
    result = compare_patterns(garment, decode(encode(garment)))
    assert result.success, result.reasons


@slowly
@given(garments())
def test_decoding_from_the_channels_alone_finds_the_same_garment_in_some_pose(garment):
    image = encode(garment).without_marks()
    result = compare_patterns(garment, decode(image), any_pose=True)
    assert result.success, result.reasons


@slowly
@given(garments(), st.randoms(use_true_random=False))
def test_panel_order_stitch_order_and_names_do_not_matter(garment, random):
    names = {p.name: f"panel {k}" for k, p in enumerate(garment.panels)}
    panels = [replace(p, name=names[p.name]) for p in garment.panels]
    stitches = [
        replace(s, a=replace(s.a, panel=names[s.a.panel]), b=replace(s.b, panel=names[s.b.panel]))
        for s in garment.stitches
    ]
    random.shuffle(panels)
    random.shuffle(stitches)
    turned = [replace(s, a=s.b, b=s.a) for s in stitches]
    again = encode(Pattern(tuple(panels), tuple(turned)))
    assert again.same_channels(encode(garment))


@slowly
@given(garments())
def test_a_mirrored_garment_gives_the_mirrored_image(garment):
    inside, bottom, left = mirrored_types(encode(garment))
    again = encode(mirrored_pattern(garment))
    assert np.array_equal(again.inside, inside)
    assert np.array_equal(again.edge_type[:, 0], bottom)
    assert np.array_equal(again.edge_type[:, 1], left)


@slowly
@given(garments(), st.sampled_from([1, 2]))
def test_under_a_fixed_frame_a_garment_moved_by_a_cell_gives_the_moved_image(garment, cells):
    cell = 10.0
    frame = square_frame(24, cell, left=-12 * cell, bottom=-3 * cell)
    moved = tuple(
        replace(
            p, translation=(p.translation[0], p.translation[1] + cells * cell, p.translation[2])
        )
        for p in garment.panels
    )
    still = encode(garment, 24, frame=frame)
    image = encode(replace(garment, panels=moved), 24, frame=frame)
    assert np.array_equal(image.inside, np.roll(still.inside, cells, axis=1))
    assert np.array_equal(image.edge_type, np.roll(still.edge_type, cells, axis=2))
    assert np.allclose(image.deformation, np.roll(still.deformation, cells, axis=3), atol=1e-4)


@slowly
@given(garments(), st.sampled_from([16, 24, 32]))
def test_every_panel_is_one_cluster_and_the_border_of_the_grid_stays_free(garment, grid):
    image = encode(garment, grid)
    _, count = label_panels(image.inside, image.edge_type)
    assert count == len(image.marks)
    assert not image.inside[:, [0, -1]].any()
    assert not image.inside[:, :, [0, -1]].any()


@slowly
@given(garments())
def test_boundary_vectors_are_as_long_as_the_chords_of_the_panel(garment):
    image = encode(garment, 32)
    outside = ~image.inside[:, None, None]
    assert (image.deformation[np.broadcast_to(outside, image.deformation.shape)] == 0).all()
    for panel in garment.panels:
        (mark,) = [m for m in image.marks if m.name == panel.name]
        labels, _ = label_panels(image.inside, image.edge_type)
        mask = labels == labels[mark.layer][mark.cell]
        bottom, right, top, left = np.moveaxis(image.deformation[mark.layer], 0, 0)
        x0, y0, x1, y1 = bottom[0], bottom[1], left[0], left[1]
        x2, y2, x3, y3 = top[0], top[1], right[0], right[1]
        lower = (x0 * y1 - y0 * x1) / 2
        upper = (x2 * y3 - y2 * x3) / 2
        area = (lower + upper)[mask[mark.layer]].sum()
        true = abs(panel.outline.area) - sum(abs(h.area) for h in panel.holes)
        assert abs(area) == pytest.approx(true, rel=0.06)


def _square(name: str, x: float, y: float, z: float, size: float = 30.0) -> Panel:
    points = [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)]
    lines = [Line(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    return Panel(name, loop_from_curves(lines), translation=(x, y, z))


def test_a_square_on_the_grid_keeps_its_cells_own_edges():
    frame = square_frame(16, 10.0, left=-80.0, bottom=0.0)
    image = encode(Pattern((_square("patch", 10.0, 100.0, 20.0),)), frame=frame)
    assert image.inside.sum() == 9
    assert image.inside[0, 10:13, 9:12].all()
    bottom = image.deformation[0, 0][:, 10:13, 9:12]
    assert np.allclose(bottom[0], 10.0)
    assert np.allclose(bottom[1], 0.0)


def test_a_garment_that_is_too_crowded_says_which_grid_would_do():
    count = 9
    strips = []
    for k in range(count):
        width = 2.0
        points = [(0.0, 0.0), (width, 0.0), (width, 60.0), (0.0, 60.0)]
        lines = [Line(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
        strips.append(
            Panel(
                f"strip {k}",
                loop_from_curves(lines),
                translation=(width * (k - count / 2), 60.0, 20.0),
            )
        )
    stitches = tuple(
        Stitch(Side(f"strip {k}", 1), Side(f"strip {k + 1}", 3)) for k in range(count - 1)
    )
    pattern = Pattern(tuple(strips), stitches)
    with pytest.raises(EncodeError, match="grid of") as caught:
        encode(pattern, 8)
    assert caught.value.grid is not None
    assert f"--grid {caught.value.grid}" in str(caught.value)
    assert encode(pattern, caught.value.grid).inside.any()


def test_seams_that_cross_when_laid_flat_are_named_by_their_panels():
    """Two cuffs sewn crosswise to two sleeves that hang beside each other."""
    names = ("left", "right", "under left", "under right")
    places = ((-30.0, 100.0), (10.0, 100.0), (-30.0, 70.0), (10.0, 70.0))
    squares = [_square(name, x, y, 20.0) for name, (x, y) in zip(names, places, strict=True)]
    x, y, z = squares[0].translation
    squares[0] = replace(squares[0], translation=(x, y, z + 5.0))
    crosswise = tuple(
        Stitch(Side(above, 0), Side(below, 2))
        for above, below in (("left", "under right"), ("right", "under left"))
    )
    beside = (Stitch(Side("left", 1), Side("right", 3)),
              Stitch(Side("under left", 1), Side("under right", 3)))  # fmt: skip
    with pytest.raises(EncodeError, match=r"seams of panels .*under.* cross"):
        encode(Pattern(tuple(squares), crosswise + beside), 64)


@pytest.mark.parametrize(
    ("call", "way_out"),
    [
        (lambda: encode("dress.json"), "load_pattern"),
        (lambda: encode(Pattern((_square("patch", 0.0, 100.0, 20.0),)), grid="16"), "cells"),
        (lambda: save_image(Pattern(()), "a.npz"), "encode"),
        (
            lambda: save_pattern(encode(Pattern((_square("patch", 0.0, 100.0, 20.0),))), "a.json"),
            "decode",
        ),
    ],
)
@pytest.mark.wrong_types
def test_an_argument_of_a_wrong_type_is_told_what_to_give(call, way_out):
    with pytest.raises(TypeError, match=way_out):
        call()


@pytest.mark.wrong_types
def test_a_path_where_an_image_belongs_is_told_what_to_give():
    with pytest.raises(ImageError, match="load_image"):
        decode("dress.npz")


@pytest.mark.parametrize("grid", [0, 7, 15, 1000])
def test_odd_or_wild_grid_sizes_are_refused(grid):
    with pytest.raises(EncodeError, match="grid"):
        encode(Pattern((_square("patch", 0.0, 100.0, 20.0),)), grid)


def test_encoding_does_not_depend_on_what_was_encoded_before():
    first = Pattern((_square("patch", -15.0, 100.0, 20.0),))
    other = Pattern((_square("other", 40.0, 20.0, -20.0, 25.0),))
    before = encode(first)
    encode(other)
    assert encode(first) == before


def test_loops_that_start_at_another_edge_give_the_same_image():
    def turned(loop: Loop) -> Loop:
        return Loop(loop.vertices, loop.edges[1:] + loop.edges[:1])

    square = _square("patch", -15.0, 100.0, 20.0)
    again = replace(square, outline=turned(square.outline))
    assert encode(Pattern((again,))).same_channels(encode(Pattern((square,))))


def test_a_hole_sewn_up_by_itself_comes_back_as_a_slit():
    dress = load_pattern(example_path("dress"))
    front = dress.panels[0]
    x, y = front.outline.polygon.mean(axis=0).tolist()
    points = [(x, y - 8.0), (x + 1.5, y), (x, y + 8.0), (x - 1.5, y)]
    hole = loop_from_curves(
        [Line(b, a) for a, b in zip(points, points[1:] + points[:1], strict=True)][::-1]
    )
    first = len(front.edges)
    fish_eye = replace(
        dress,
        panels=(replace(front, holes=(hole,)), *dress.panels[1:]),
        stitches=(
            *dress.stitches,
            Stitch(Side(front.name, first), Side(front.name, first + 3)),
            Stitch(Side(front.name, first + 1), Side(front.name, first + 2)),
        ),
    )
    for grid in (16, 32):
        assert compare_patterns(fish_eye, decode(encode(fish_eye, grid))).success
