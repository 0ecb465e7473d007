"""Flat drawings: where panels lie, and which seams share a number."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D

from garmentimage import load_pattern
from garmentimage.examples import example_names, example_path
from garmentimage.pattern.model import Loop, Panel, Pattern, Side, Stitch
from garmentimage.render.flat.arrangement import WORN_LIMIT, _shelved, arrange, bounds
from garmentimage.render.flat.drawing import draw_pattern, seam_numbers
from tests.garments import garments

HALF_A_NUMBER = 7.0
"""[pixels at 100 dpi]"""


@pytest.fixture(params=example_names())
def example(request):
    return load_pattern(example_path(request.param))


def boxes(placed):
    return np.array([bounds([p]) for p in placed])


def overlaps(placed):
    found = boxes(placed)
    low, high = found[:, None, 0], found[:, None, 1]
    hit = ((low < high.swapaxes(0, 1)) & (low.swapaxes(0, 1) < high)).all(axis=2)
    return int(hit.sum()) - len(found)


@settings(max_examples=25)
@given(garments())
def test_no_two_panels_lie_on_each_other(garment):
    placed = arrange(garment)
    assert overlaps(placed) == overlaps(_shelved(list(placed))) == 0


def test_panels_that_all_hang_in_one_place_are_pushed_apart(example):
    heap = [replace(p, translation=(0.0, 0.0, 0.0)) for p in example.panels]
    assert overlaps(arrange(replace(example, panels=tuple(heap)))) == 0


def test_drawing_keeps_lengths(example):
    for p in arrange(example):
        np.testing.assert_allclose(p.matrix @ p.matrix.T, np.eye(2), atol=1e-9)


def test_the_back_is_seen_through_the_body(example):
    """The front runs counter-clockwise in the picture, the back clockwise."""
    for p in arrange(example):
        turn = np.sign(p.panel.outline.area) * np.sign(np.linalg.det(p.matrix))
        assert turn == (-1 if p.back else 1)


def test_what_hangs_higher_is_drawn_higher(example):
    placed = {p.panel.name: p for p in arrange(example)}
    if "waistband_front" in placed:
        band, leg = placed["waistband_front"], placed["left_leg_front"]
        assert bounds([band])[0, 1] > bounds([leg])[1, 1]


def test_thousands_of_panels_lie_on_the_table():
    square = load_pattern(example_path("dress")).panels[0]
    many = Pattern(tuple(replace(square, name=f"p{k}") for k in range(WORN_LIMIT + 1)))
    assert overlaps(arrange(many)) == 0


@settings(max_examples=25)
@given(garments())
def test_both_sides_of_a_stitch_share_a_number(garment):
    numbers = seam_numbers(garment)
    assert set(numbers) == set(garment.partners)
    for stitch in garment.stitches:
        assert numbers[stitch.a] == numbers[stitch.b]
    assert set(numbers.values()) == set(range(1, len(set(numbers.values())) + 1))


@settings(max_examples=25)
@given(garments())
def test_numbers_do_not_depend_on_the_order_of_panels_and_stitches(garment):
    turned = replace(
        garment,
        panels=garment.panels[::-1],
        stitches=tuple(replace(s, a=s.b, b=s.a) for s in garment.stitches[::-1]),
    )
    assert seam_numbers(turned) == seam_numbers(garment)


def strip(name, count, z):
    """A rectangle whose long lower side is cut into `count` edges; they come first."""
    from garmentimage.geometry.curves import Line
    from garmentimage.pattern.model import loop_from_curves

    corners = [(10.0 * k, 0.0) for k in range(count + 1)] + [(10.0 * count, 30.0), (0.0, 30.0)]
    loop: Loop = loop_from_curves(
        [Line(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    )
    return Panel(name, loop, translation=(0.0, 100.0, z))


@pytest.mark.parametrize("same_direction", [False, True])
def test_stitches_that_follow_each_other_are_one_seam(same_direction):
    partner = (0, 1, 2) if same_direction else (2, 1, 0)
    stitches = tuple(
        Stitch(Side("a", k), Side("b", m), same_direction=same_direction)
        for k, m in enumerate(partner)
    )
    pattern = Pattern((strip("a", 3, 20.0), strip("b", 3, -20.0)), stitches)
    assert set(seam_numbers(pattern).values()) == {1}
    named_otherwise = (replace(stitches[0], a=stitches[0].b, b=stitches[0].a), *stitches[1:])
    assert set(seam_numbers(replace(pattern, stitches=named_otherwise)).values()) == {1}
    crossed = replace(
        pattern, stitches=tuple(replace(s, same_direction=not same_direction) for s in stitches)
    )
    assert set(seam_numbers(crossed).values()) == {1, 2, 3}


def test_no_number_touches_the_name_of_its_panel(example):
    figure = Figure(figsize=(5, 4.4))
    axes = figure.add_axes((0, 0, 1, 1))
    draw_pattern(example, axes)
    figure.canvas.draw()
    names = [t for t in axes.texts if t.get_text() in example.by_name]
    numbers = [t for t in axes.texts if t.get_text().isdigit()]
    assert len(names) >= len(example.panels)
    for name in names:
        # The box of the letters as if they stood level, and every number seen from there.
        angle = name.get_rotation()
        level = Affine2D().rotate_deg_around(*axes.transData.transform(name.get_position()), -angle)
        name.set_rotation(0)
        box = name.get_window_extent().padded(HALF_A_NUMBER)
        name.set_rotation(angle)
        for number in numbers:
            assert not box.contains(
                *level.transform(axes.transData.transform(number.get_position()))
            )


@pytest.mark.parametrize("name", ["cutout_top", "narrow cuff"])
def test_grain_arrows_lie_on_cloth_and_off_the_names(name):
    if name == "narrow cuff":
        pattern = Pattern((replace(strip("a cuff", 3, 20.0), grain=(0.0, 1.0)),))
    else:
        pattern = load_pattern(example_path(name))
    figure = Figure(figsize=(5, 4.4))
    axes = figure.add_axes((0, 0, 1, 1))
    draw_pattern(pattern, axes)
    figure.canvas.draw()
    arrows = [shapely.LineString([t.xy, t.xyann]) for t in axes.texts if hasattr(t, "xyann")]
    cloth = [shapely.Polygon(p.polygon) for p in arrange(pattern)]
    names = [t for t in axes.texts if t.get_text() in pattern.by_name]
    assert len(arrows) == len(pattern.panels)
    for arrow in arrows:
        assert arrow.length > 1
        assert sum(panel.contains(arrow) for panel in cloth) == 1
    for text in names:
        assert text.get_rotation() == 0
        box = axes.transData.inverted().transform_bbox(text.get_window_extent())
        assert not any(arrow.intersects(shapely.box(*box.extents)) for arrow in arrows)


def test_the_two_legs_of_a_dart_share_a_number():
    pattern = load_pattern(example_path("darted_shirt"))
    darts = [s for s in pattern.stitches if s.a.panel == s.b.panel]
    assert darts
    numbers = seam_numbers(pattern)
    assert len({numbers[s.a] for s in darts}) == len(darts)
