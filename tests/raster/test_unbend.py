"""Circle skirts: ring sectors of any sweep, on a waistband."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import decode, encode
from garmentimage.compare.comparison import compare_patterns
from garmentimage.geometry.curves import Arc, Line
from garmentimage.geometry.polygons import polyline_length
from garmentimage.pattern.model import Panel, Pattern, loop_from_curves
from garmentimage.raster.encode.layout.seam_graph import build_seam_graph
from garmentimage.raster.encode.layout.solve import FIRST, layouts
from garmentimage.raster.encode.layout.unbend import MAX_ANGLE, unbent_curves
from garmentimage.raster.encode.placement import place
from tests.raster.panels import BACK, BOTTOM, LEFT, RIGHT, rectangle, stitch

WAIST = 36.0
HEM, RIGHT_SIDE, WAISTLINE, LEFT_SIDE = range(4)

sweeps = st.floats(40.0, 330.0)
laws = settings(max_examples=12)


def ring_sector(name, sweep, length, at, rotation=(0.0, 0.0, 0.0)):
    """A skirt panel: hem, right side, waistline, left side; sweep in degrees."""
    half, inner = np.radians(sweep) / 2, WAIST / np.radians(sweep)
    outer = inner + length

    def on(radius, angle):
        return (float(radius * np.sin(angle)), float(-radius * np.cos(angle)))

    curves = [
        Arc(on(outer, -half), on(outer, half), outer, sweep > 180, True),
        Line(on(outer, half), on(inner, half)),
        Arc(on(inner, half), on(inner, -half), inner, sweep > 180, False),
        Line(on(inner, -half), on(outer, -half)),
    ]
    return Panel(name, loop_from_curves(curves), translation=at, rotation=rotation)


def circle_skirt(sweep, length=40.0):
    """A front and a back on a waistband of two pieces."""
    panels, stitches = [], []
    for face, z, turn in (("front", 15.0, (0.0, 0.0, 0.0)), ("back", -15.0, BACK)):
        panels.append(ring_sector(face, sweep, length, (0.0, 100.0, z), turn))
        panels.append(rectangle(f"{face} band", WAIST, 6.0, (0.0, 108.0, z), turn))
        stitches.append(stitch(f"{face} band", BOTTOM, face, WAISTLINE))
    for a, b in ((RIGHT_SIDE, LEFT_SIDE), (LEFT_SIDE, RIGHT_SIDE)):
        stitches.append(stitch("front", a, "back", b))
    for a, b in ((RIGHT, LEFT), (LEFT, RIGHT)):
        stitches.append(stitch("front band", a, "back band", b))
    return Pattern(tuple(panels), tuple(stitches))


def bearing(panel, curves):
    """Half the angle between the two sides of a drawn ring sector [radians]."""
    side = curves[RIGHT_SIDE]
    down, out = side[0] - side[-1]
    return abs(np.arctan2(down, -out))


def drawn(sweep):
    panels = place(circle_skirt(sweep)).panels
    panel = next(p for p in panels if p.name == "front")
    return panel, unbent_curves(panel)


@given(st.floats(30.0, np.degrees(MAX_ANGLE) - 0.5))
def test_a_narrow_sector_rests_as_it_was_cut(sweep):
    panel, curves = drawn(sweep)
    assert curves == panel.curves


@given(st.floats(121.0, 335.0))
def test_a_wide_sector_rests_narrower_with_its_waistline_and_sides_as_long_as_before(sweep):
    panel, curves = drawn(sweep)
    assert MAX_ANGLE / 2 < bearing(panel, curves) < MAX_ANGLE / 2 + np.radians(20.0)
    for edge in (RIGHT_SIDE, WAISTLINE, LEFT_SIDE):
        assert polyline_length(curves[edge]) == pytest.approx(
            polyline_length(panel.curves[edge]), rel=0.01
        )


def test_a_sector_narrows_without_a_jump_where_unbending_begins():
    (_, before), (_, after) = drawn(119.99), drawn(120.01)
    assert np.allclose(np.concatenate(before), np.concatenate(after), atol=0.05)


def test_a_bodice_with_a_wide_neckline_rests_as_it_was_cut():
    """Its shoulders are short beside its depth: a bay in the outline, not a ring."""
    neck = Arc((10.0, 60.0), (-10.0, 60.0), 10.5, False, False)
    points = [(-25.0, 0.0), (25.0, 0.0), (22.0, 58.0), (10.0, 60.0), (-10.0, 60.0), (-22.0, 58.0)]
    curves = [Line(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    curves[3] = neck
    bodice = Panel("bodice", loop_from_curves(curves), translation=(0.0, 85.0, 15.0))
    back = Panel("back", bodice.outline, translation=(0.0, 85.0, -15.0), rotation=BACK)
    pattern = Pattern(
        (bodice, back), (stitch("bodice", 1, "back", 5), stitch("bodice", 5, "back", 1))
    )
    for panel in place(pattern).panels:
        assert unbent_curves(panel) == panel.curves


@laws
@given(sweeps, st.floats(15.0, 70.0))
def test_a_circle_skirt_of_any_sweep_is_clean_at_the_first_step_and_comes_back(sweep, length):
    skirt = circle_skirt(sweep, length)
    layout = next(layouts(build_seam_graph(place(skirt))))
    assert (layout.stage, layout.problems) == (FIRST, ())
    outcome = compare_patterns(skirt, decode(encode(skirt, 32)))
    assert outcome.success, outcome.reasons
