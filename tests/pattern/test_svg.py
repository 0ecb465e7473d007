import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from hypothesis import given, strategies as st

from garmentimage.geometry.curves import Arc
from garmentimage.pattern.files.spec import pattern_from_spec
from garmentimage.pattern.files.svg import lay_out, pattern_to_svg, save_svg
from garmentimage.pattern.model import Circle, Side
from tests.garments import garments
from tests.pattern.specs import one_panel, panel, spec

NAMESPACE = "{http://www.w3.org/2000/svg}"


def drawing(pattern):
    return ElementTree.fromstring(pattern_to_svg(pattern).encode())


def paths(root):
    return root.findall(f".//{NAMESPACE}path")


def ends(path):
    numbers = [float(v) for v in re.findall(r"-?[\d.]+", path.get("d"))]
    return np.array(numbers[:2]), np.array(numbers[-2:])


@given(garments())
def test_each_edge_is_one_path_that_names_its_partner(garment):
    found = {Side(p.get("data-panel"), int(p.get("data-edge"))): p for p in paths(drawing(garment))}
    assert set(found) == set(garment.sides())
    for side, path in found.items():
        partner = garment.partners.get(side)
        if partner is None:
            assert path.get("data-stitch") is None
        else:
            assert path.get("data-partner-panel") == partner.panel
            assert int(path.get("data-partner-edge")) == partner.edge
            stitch = garment.stitches[int(path.get("data-stitch"))]
            assert side in stitch.sides


@given(garments())
def test_the_drawing_is_at_true_scale_in_mm(garment):
    root = drawing(garment)
    assert root.get("width").endswith("mm")
    assert root.get("viewBox") == f"0 0 {root.get('width')[:-2]} {root.get('height')[:-2]}"
    for path, side in zip(paths(root), garment.sides(), strict=True):
        start, end = ends(path)
        curve = garment.curve(side)
        chord = np.subtract(curve.end, curve.start)
        np.testing.assert_allclose(end - start, [chord[0] * 10, -chord[1] * 10], atol=1e-3)


@given(st.lists(st.tuples(st.floats(0.1, 200), st.floats(0.1, 200)), min_size=1, max_size=12))
def test_panels_do_not_overlap_on_the_sheet(sizes):
    spots, width, height = lay_out(sizes)
    boxes = [(s.x, s.y, s.x + w, s.y + h) for s, (w, h) in zip(spots, sizes, strict=True)]
    for k, (x0, y0, x1, y1) in enumerate(boxes):
        assert x0 > 0
        assert y0 > 0
        assert x1 < width
        assert y1 < height
        for u0, v0, u1, v1 in boxes[:k]:
            assert x1 <= u0 or u1 <= x0 or y1 <= v0 or v1 <= y0


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("right", [False, True])
def test_an_arc_is_drawn_on_its_own_side(large, right):
    # A quarter notch or bulge at the middle of the top edge, which runs to the left.
    vertices = [[0, 0], [60, 0], [60, 40], [40, 40], [20, 40], [0, 40]]
    ring = ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0))
    arc = {"type": "circle", "params": [12, int(large), int(right)]}
    pattern = pattern_from_spec(spec({"front": panel(vertices, ring, e3=arc)}, []))
    curve = pattern.panels[0].curves[3]
    assert isinstance(curve, Arc)
    (path,) = (p for p in paths(drawing(pattern)) if p.get("data-edge") == "3")
    rx, ry, _, large_flag, sweep = (float(v) for v in path.get("d").split("A ")[1].split()[:5])
    start, end = ends(path)
    middle = arc_middle(start, end, rx, bool(large_flag), bool(sweep))
    wanted = curve.at(np.array([0.5]))[0] - curve.start
    assert rx == ry == 120
    np.testing.assert_allclose(middle - start, [wanted[0] * 10, -wanted[1] * 10], atol=1e-3)


def arc_middle(start, end, radius, large, sweep):
    """The middle of an SVG arc, from the standard's own centre formula (F.6.5), y down."""
    half = (start - end) / 2
    root = np.sqrt(max(radius**2 - half @ half, 0) / (half @ half))
    sign = 1 if large != sweep else -1
    centre = sign * root * np.array([half[1], -half[0]]) + (start + end) / 2
    first = np.arctan2(*(start - centre)[::-1])
    swept = (np.arctan2(*(end - centre)[::-1]) - first) % (2 * np.pi)
    angle = first + (swept if sweep else swept - 2 * np.pi) / 2
    return centre + radius * np.array([np.cos(angle), np.sin(angle)])


@given(st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=30))
def test_any_name_gives_well_formed_xml(name):
    data = spec({name: panel()}, [])
    (group,) = drawing(pattern_from_spec(data)).findall(f"{NAMESPACE}g")
    if all(c.isprintable() for c in name):
        assert group.get("data-panel") == name


def test_half_circles_keep_their_radius():
    arc = {"type": "circle", "params": [20, 0, 1]}
    pattern = pattern_from_spec(one_panel(e1=arc))
    assert pattern.panels[0].edges[1].curvature == Circle(20.0, False, True)
    assert "A 200 200 0 0 0" in pattern_to_svg(pattern)


def test_a_saved_drawing_is_the_drawing(tmp_path):
    pattern = pattern_from_spec(spec())
    save_svg(pattern, tmp_path / "p.svg")
    assert (tmp_path / "p.svg").read_text(encoding="utf-8") == pattern_to_svg(pattern)
