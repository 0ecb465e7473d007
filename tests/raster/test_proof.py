"""An encoding proves itself: no image is given that would bring back another pattern."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from garmentimage import EncodeError, GarmentImageError, decode, encode, load_pattern
from garmentimage.compare.comparison import compare_patterns
from garmentimage.compare.likely import surely_same
from garmentimage.compare.stitch_graphs import stitch_graph
from garmentimage.draft.kind import draft_pattern
from garmentimage.examples import example_path
from garmentimage.geometry.curves import Bezier, Line
from garmentimage.geometry.polygons import polyline_length
from garmentimage.pattern.direction import turned_round
from garmentimage.pattern.model import (
    Edge,
    Loop,
    Panel,
    Pattern,
    Side,
    Stitch,
    loop_from_curves,
)
from garmentimage.raster.encode import encoder as encode_module
from garmentimage.raster.encode.proof import Disproof, bowed, disproof, lengthening
from tests.compare.garments import transformed_panel, without_stitch
from tests.corpus import unpacked
from tests.garments import garments
from tests.raster import panels as drawn
from tests.raster.panels import ring

slowly = settings(max_examples=10)


def rectangle(name, width, height, translation, rotation=(0.0, 0.0, 0.0)):
    x, y = width / 2, height
    corners = ((-x, 0.0), (x, 0.0), (x, y), (-x, y))
    edges = tuple(Edge(k, (k + 1) % 4) for k in range(4))
    return Panel(name, Loop(corners, edges), translation=translation, rotation=rotation)


@slowly
@given(garments(), st.sampled_from([0.99, 0.97, 0.9, 0.8]), st.integers(0, 20))
def test_what_is_surely_the_same_is_the_same_to_the_judge(garment, scale, number):
    name = garment.panels[number % len(garment.panels)].name
    other = transformed_panel(garment, name, np.eye(2) * scale)
    if surely_same(garment, other, (stitch_graph(garment), stitch_graph(other))):
        assert compare_patterns(garment, other).success


@slowly
@given(garments())
def test_a_garment_is_surely_itself(garment):
    graph = stitch_graph(garment)
    assert surely_same(garment, garment, (graph, graph))


def test_what_does_not_come_back_is_named():
    garment = draft_pattern("skirt")
    graph, image = stitch_graph(garment), encode(garment)
    assert disproof(garment, graph, image) == Disproof()
    deformation = image.deformation * np.where(image.layer_names == "back", 1.0, 1.1)
    wider = replace(image, deformation=deformation.astype(np.float32))
    found = disproof(garment, graph, wider)
    assert "does not decode to it" in found.reason and "panel '" in found.reason
    less = without_stitch(garment, 0)
    assert disproof(less, stitch_graph(less), image).reason


def test_an_image_that_is_disproven_is_not_given(monkeypatch):
    garment = draft_pattern("skirt")
    refuse = Disproof("its image does not decode to it: panel 'front' comes back with IoU 0.1")
    monkeypatch.setattr(encode_module, "disproof", lambda *_: refuse)
    with pytest.raises(EncodeError, match=r"panel 'front' comes back with IoU 0.1"):
        encode(garment)
    assert encode(garment, verify=False).inside.any()


def test_without_proof_the_same_image_is_given():
    garment = load_pattern(example_path("dress"))
    assert encode(garment, verify=False) == encode(garment)


@given(st.floats(0.5, 2.0), st.integers(3, 9), st.integers(0, 1000))
def test_bowing_keeps_the_ends_and_moves_the_rest_off_the_chord(bow, count, seed):
    points = np.cumsum(np.random.default_rng(seed).normal(size=(count, 2)), axis=0)
    moved = bowed(points, bow)
    np.testing.assert_allclose(moved[[0, -1]], points[[0, -1]])
    np.testing.assert_allclose(bowed(moved, 1 / bow), points, atol=1e-9)


def waves(chords):
    """Two panels sewn along a wave, the wave as so many chords; 0: as it is."""
    wave = Bezier((0.0, 0.0), ((25.0, 0.0), (-25.0, 40.0)), (0.0, 40.0))
    seam = [wave]
    if chords:
        points = [(float(x), float(y)) for x, y in wave.sample(chords)]
        seam = [Line(a, b) for a, b in pairwise(points)]
    rest = [
        Line((0.0, 40.0), (-30.0, 40.0)),
        Line((-30.0, 40.0), (-30.0, 0.0)),
        Line((-30.0, 0.0), (0.0, 0.0)),
    ]
    left = loop_from_curves([*seam, *rest])
    mirrored = [
        Line((0.0, 0.0), (30.0, 0.0)),
        Line((30.0, 0.0), (30.0, 40.0)),
        Line((30.0, 40.0), (0.0, 40.0)),
    ]
    right = loop_from_curves([*mirrored, *(curve.reversed() for curve in reversed(seam))])
    count = len(seam)
    stitches = [Stitch(Side("left", k), Side("right", 2 + count - k)) for k in range(count)]
    panels = (
        Panel("left", left, translation=(0.0, 100.0, 15.0)),
        Panel("right", right, translation=(0.0, 100.0, 15.0)),
    )
    return Pattern(panels, tuple(stitches))


@pytest.mark.parametrize("chords", [3, 4, 5])
def test_a_bend_is_bowed_by_what_its_chords_lose(chords):
    garment, back = waves(0), waves(chords)
    wave = garment.by_name["left"].curves[0]
    lost = wave.length - polyline_length(wave.sample(chords))
    bows = lengthening(garment, stitch_graph(garment), stitch_graph(back))
    if lost <= max(0.5, 0.02 * wave.length):
        assert bows == {}
        return
    assert set(bows) == {("left", 0), ("right", 3)} and min(bows.values()) > 1
    longer = polyline_length(bowed(wave.sample(chords), bows["left", 0]))
    assert abs(longer - wave.length) < 0.3 * lost


@pytest.mark.parametrize("grid", [8, 16])
def test_a_wave_comes_back_as_long_as_it_is_however_few_grid_edges_it_has(grid):
    garment = waves(0)
    assert compare_patterns(garment, decode(encode(garment, grid=grid))).success


@pytest.mark.parametrize("degrees", [120, 270, 350, 356])
@pytest.mark.parametrize("sewn", [False, True])
def test_a_ring_comes_back_or_is_refused(degrees, sewn):
    garment = ring(degrees, sewn)
    try:
        image = encode(garment)
    except EncodeError:
        return
    assert compare_patterns(garment, decode(image)).success
    assert compare_patterns(garment, decode(image.without_marks()), any_pose=True).success


def test_what_no_grid_can_mend_is_not_tried_on_others(monkeypatch):
    """A bag: a panel whose outline is all sewn to itself."""
    bag = rectangle("bag", 40.0, 60.0, (0.0, 40.0, 15.0))
    sewn = (Stitch(Side("bag", 0), Side("bag", 1)), Stitch(Side("bag", 2), Side("bag", 3)))
    grids = []
    once = encode_module._encode
    monkeypatch.setattr(
        encode_module, "_encode", lambda *args: grids.append(args[-1].grid) or once(*args)
    )
    with pytest.raises(EncodeError, match="closed to a bag") as told:
        encode(Pattern((bag,), sewn))
    assert told.value.remedy == "pattern" and len(grids) <= 1


def test_panels_without_a_place_on_the_body_are_refused_as_what_they_are(monkeypatch):
    dress = load_pattern(example_path("dress"))
    flat = tuple(
        replace(panel, rotation=(0.0, 0.0, 0.0), translation=(200.0 * k, 0.0, 0.0))
        for k, panel in enumerate(dress.panels)
    )
    grids = []
    once = encode_module._encode
    monkeypatch.setattr(
        encode_module, "_encode", lambda *args: grids.append(args[-1].grid) or once(*args)
    )
    with pytest.raises(EncodeError, match="side by side as on paper") as found:
        encode(replace(dress, panels=flat))
    assert found.value.remedy == "pattern" and len(grids) <= 1


def test_a_skirt_in_a_world_with_z_up_is_not_turned_over(monkeypatch):
    """Its panels only seem to face the body; turned over it would be another garment."""
    places = {
        "front": (0.0, -38.0),
        "left": (40.0, 0.0),
        "back": (0.0, 38.0),
        "right": (-40.0, 0.0),
    }
    names = list(places)
    panels = tuple(
        drawn.rectangle(name, 50.0, 60.0, (*places[name], -22.0), (45.0, 0.0, 90.0 * k))
        for k, name in enumerate(names)
    )
    sewn = tuple(Stitch(Side(names[k], 1), Side(names[(k + 1) % 4], 3)) for k in range(4))
    monkeypatch.setattr(encode_module, "turned_round", None)
    with pytest.raises(EncodeError, match="stand upright along z"):
        encode(Pattern(panels, sewn))


@slowly
@given(garments())
def test_a_garment_drawn_inside_out_comes_back_right_side_out(garment):
    names = [panel.name for panel in garment.panels]
    turned = turned_round(garment, names)
    assert turned_round(turned, names).stitches == garment.stitches
    image, plain = encode(turned), encode(garment)
    assert (image.inside == plain.inside).all() and (image.edge_type == plain.edge_type).all()
    assert compare_patterns(garment, decode(image)).success
    assert not compare_patterns(turned, decode(image)).success


def _faults(kind, target):
    folder = unpacked("faults/faults.tar.xz", target)
    return sorted(path for path in folder.rglob("*.json") if path.parent.name == kind)


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("kind", ["public-hood", "circle-skirt", "fisheye-cut", "pleat", "godet"])
def test_faults_by_others_come_back_or_are_refused(kind, tmp_path):
    files = _faults(kind, tmp_path)
    assert files
    for path in files:
        garment = load_pattern(path)
        try:
            image = encode(garment)
        except GarmentImageError as error:
            assert "panel" in str(error), path.name
            continue
        assert compare_patterns(garment, decode(image)).success, path.name
