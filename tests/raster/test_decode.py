from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from shapely.geometry import Polygon

from garmentimage.compare.comparison import compare_patterns
from garmentimage.errors import DecodeError, GarmentImageError, ImageError
from garmentimage.examples import example_path
from garmentimage.geometry.polygons import centroid
from garmentimage.pattern.checks.sewable import check_pattern
from garmentimage.pattern.files.spec import read_pattern
from garmentimage.raster.cells import cell_mesh
from garmentimage.raster.channels import CHANNELS_PER_LAYER
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.decode.unfold import unfold_cells
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType, GarmentImage, PanelMark
from garmentimage.raster.repair.repairer import LEVELS, repair
from tests.corpus import corpus_sample
from tests.garments import garments
from tests.raster.boards import CELL_CM, board, with_types

SIDE_BY_SIDE = EdgeType.SIDE_BY_SIDE
VEST = "...... .aaaa. .aaaa. .aaaa. .bbbb. ......"
SKIRT_AND_BAND = ("...... ...... .aaaa. .bbbb. .bbbb. ......",) * 2


def partners(pattern):
    """Panel names and edges that are sewn together, in no order."""
    return {frozenset({(s.a.panel, s.a.edge), (s.b.panel, s.b.edge)}) for s in pattern.stitches}


@st.composite
def noise(draw):
    """Any finite tensor, some of them in patches as networks make them."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    grid, layers = draw(st.integers(4, 20)), draw(st.integers(1, 4))
    shape = (CHANNELS_PER_LAYER * layers, grid, grid)
    array = rng.normal(size=shape) * draw(st.sampled_from([0.1, 1.0, 10.0, 1e3]))
    if draw(st.booleans()):
        patch = rng.normal(size=(shape[0], grid // 4 + 1, grid // 4 + 1)) * 5
        array = np.kron(patch, np.ones((4, 4)))[:, :grid, :grid] + array / 100
    return np.round(array) if draw(st.booleans()) else array


@pytest.mark.slow
@settings(max_examples=60)
@given(noise(), st.sampled_from(LEVELS))
def test_noise_gives_a_valid_pattern_or_a_typed_error(array, level):
    try:
        pattern = decode(array, repair=level)
    except DecodeError:
        return
    check_pattern(pattern)


@pytest.mark.parametrize("cell", [4.0, 10.0, 17.0])
def test_undeformed_cells_give_rectangles_of_their_own_size(cell):
    pattern = decode(board(VEST, cell=cell))
    bodice, hem = (p.outline for p in pattern.panels)
    assert sorted([abs(bodice.area), abs(hem.area)]) == pytest.approx(
        [4 * cell**2, 12 * cell**2], rel=1e-4
    )
    assert all(len(p.edges) == 4 for p in pattern.panels)


def test_neighbours_are_sewn_side_by_side_and_only_there():
    pattern = decode(board(VEST))
    (stitch,) = pattern.stitches
    assert [pattern.curve(s).length for s in stitch.sides] == pytest.approx([40.0, 40.0])
    assert not stitch.same_direction


def test_layers_are_sewn_front_to_back_all_round():
    pattern = decode(board(*SKIRT_AND_BAND, sewn_around=True))
    fronts, backs = ({p.name for p in pattern.panels if f in p.name} for f in ("front", "back"))
    assert (len(fronts), len(backs)) == (2, 2)
    crossing = [s for s in pattern.stitches if (s.a.panel in fronts) != (s.b.panel in fronts)]
    assert len(crossing) == 2 * 3
    assert len(pattern.stitches) == 2 * 3 + 2


def test_stitches_whose_partner_is_missing_become_free():
    torn = with_types(board(VEST), {(0, 1, 2, 1): EdgeType.FRONT_TO_BACK})
    alone = decode(torn, repair="none")
    assert {frozenset(x[0] for x in pair) for pair in partners(alone)} == {
        frozenset(p.name for p in alone.panels)
    }


def test_front_stands_before_the_body_and_back_behind_it_seen_from_outside():
    pattern = decode(board(VEST, VEST))
    for panel in pattern.panels:
        world = panel.to_world(panel.outline.polygon)
        outward = np.sign(world[:, 2].mean())
        assert abs(world[:, 2]).min() > 5
        # Counter-clockwise for someone who stands outside and looks at the body.
        seen = world[:, :2] * [outward, 1]
        assert Polygon(seen).exterior.is_ccw
    assert {np.sign(p.translation[2]) for p in pattern.panels} == {1.0, -1.0}


def test_cells_stand_at_the_same_height_and_side_on_the_body_as_in_the_frame():
    image = board("..... ....a ....a ..... .....")
    (panel,) = decode(image).panels
    low, high = (
        panel.to_world(panel.outline.polygon).min(0),
        panel.to_world(panel.outline.polygon).max(0),
    )
    assert (low[0], high[0]) == pytest.approx((15.0, 25.0), abs=1e-3)
    assert (low[1], high[1]) == pytest.approx((20.0, 40.0), abs=1e-3)


def test_ring_of_cells_is_a_panel_with_a_hole():
    (panel,) = decode(board(".... aaa. a.a. aaa.")).panels
    (hole,) = panel.holes
    assert abs(hole.area) == pytest.approx(CELL_CM**2)
    assert np.sign(hole.area) == -np.sign(panel.outline.area)


def opened_slit(opening):
    """A panel with a slit of two grid edges from below, its mouth open by `opening` [cm]."""
    image = board("...... .aaaa. .aaaa. .aaaa. .aaaa. ......")
    image = with_types(image, {(0, 1, 1, 3): SIDE_BY_SIDE, (0, 1, 2, 3): SIDE_BY_SIDE})
    vectors = image.deformation.copy()
    lean = opening / 4
    vectors[0, 1, 0, 1:3, 2], vectors[0, 3, 0, 1:3, 3] = lean, -lean
    vectors[0, 0, 0, 1, 2:4] = CELL_CM - 2 * lean
    vectors[0, 2, 0, 1, 2:4] = vectors[0, 0, 0, 2, 2:4] = CELL_CM - lean
    return replace(image, deformation=vectors)


def test_slit_is_a_dart_whose_legs_meet_at_its_tip():
    (panel,) = (pattern := decode(opened_slit(4.0))).panels
    (stitch,) = pattern.stitches
    first, second = sorted(stitch.sides, key=lambda s: s.edge)
    assert second.edge == first.edge + 1
    assert panel.curves[first.edge].end == panel.curves[second.edge].start
    mouth = np.subtract(panel.curves[first.edge].start, panel.curves[second.edge].end)
    assert np.hypot(*mouth) == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize("opening", [0.0, -3.0])
def test_slit_whose_legs_overlap_is_sewn_up(opening):
    pattern = decode(opened_slit(opening))
    assert not pattern.stitches
    assert len(pattern.panels[0].edges) == 4


def test_gathers_keep_the_length_of_each_side():
    image = board(VEST)
    vectors = image.deformation.copy()
    vectors[0, [0, 2], 0] *= np.where(np.arange(6) < 2, 1.6, 1.0)[:, None]
    (stitch,) = decode(replace(image, deformation=vectors)).stitches
    pattern = decode(replace(image, deformation=vectors))
    lengths = sorted(pattern.curve(s).length for s in stitch.sides)
    assert lengths == pytest.approx([40.0, 64.0])


def test_panel_that_would_cross_itself_is_pulled_back_to_the_grid():
    image = board("...... .aaaa. .aaaa. .aaaa. .aaaa. ......")
    vectors = image.deformation.copy()
    vectors[0, :, :, 2:4, 2:4] *= -3
    (panel,) = (pattern := decode(replace(image, deformation=vectors))).panels
    check_pattern(pattern)
    assert abs(panel.outline.area) > 100


def test_empty_image_and_unreadable_arrays_are_refused():
    with pytest.raises(DecodeError, match="empty"):
        decode(np.zeros((34, 8, 8)))
    with pytest.raises(ImageError):
        decode(np.zeros((35, 8, 8)))


def marked(image, *marks):
    return replace(image, marks=marks)


def test_mark_gives_a_panel_its_name_frame_and_place_back():
    mark = PanelMark(
        "yoke",
        layer=0,
        cell=(3, 2),
        matrix=((0.0, -1.0), (1.0, 0.0)),
        anchor=(3.0, -7.0),
        rotation=(0.0, 0.0, 90.0),
        translation=(1.0, 120.0, 15.0),
        label="body",
        grain=(1.0, 0.0),
    )
    panel = decode(marked(board(VEST), mark)).by_name["yoke"]
    assert (panel.rotation, panel.translation) == (mark.rotation, mark.translation)
    assert (panel.label, panel.grain) == ("body", (1.0, 0.0))
    assert centroid(panel.outline.polygon) == pytest.approx(mark.anchor)
    width, height = np.ptp(panel.outline.polygon, axis=0)
    assert (width, height) == pytest.approx((30.0, 40.0))


def test_marks_that_match_no_panel_are_ignored():
    marks = [PanelMark("ghost", layer=layer, cell=(0, 0)) for layer in (0, 7)]
    image = board(VEST)
    assert decode(marked(image, *marks)) == decode(image)


def test_parts_of_a_split_panel_are_joined_along_the_cut():
    half = "...... ...... .aaa.. .aaa.. .bbb.. ......"
    image = board(half, half, sewn_around=True)
    # Unfolded to the wearer's right, the back part lies beyond the front part's left side.
    open_ = {
        (layer, h, row, col): EdgeType.NON_STITCH
        for layer in (0, 1)
        for h, row, col in np.argwhere(image.edge_type[0] == EdgeType.FRONT_TO_BACK).tolist()
        if not (h == 1 and col == 1)
    }
    marks = [
        PanelMark("side:front", 0, (2, 1), anchor=(15.0, 0.0), split_of="side"),
        PanelMark("side:back", 1, (2, 1), ((-1.0, 0.0), (0.0, 1.0)), (-15.0, 0.0), split_of="side"),
    ]
    pattern = decode(marked(with_types(image, open_), *marks))
    side = pattern.by_name["side"]
    assert len(pattern.panels) == 3
    assert abs(side.outline.area) == pytest.approx(2 * 6 * CELL_CM**2)
    assert np.ptp(side.outline.polygon, axis=0) == pytest.approx((60.0, 20.0))
    # The free top and the two sewn lower edges; the cut is gone.
    assert len(side.edges) == 5


def test_names_say_what_where_and_whose_side():
    empty = ["." * 16]
    rows = [*empty * 4, "bbbbbaaaaaaccccc", *[".....aaaaaa....."] * 3]
    rows += [".....wwwwww....."] + ["....llll.mmmm..."] * 5 + empty * 2
    shirt = board(" ".join(rows), " ".join(rows), sewn_around=True)
    names = {p.name for p in decode(shirt.to_channels()).panels}
    fronts = {"bodice_front", "waistband_front"}
    for side in ("left", "right"):
        fronts |= {f"{side}_sleeve_front", f"{side}_leg_front"}
    assert {n for n in names if "front" in n} == fronts
    assert {n.replace("back", "front") for n in names} == fronts


def test_a_panel_with_trousers_is_that_of_a_jumpsuit():
    empty = ["." * 16] * 2
    trunk, legs = [".....aaaaaa....."] * 6, [".....aa..aa....."] * 6
    for below, kind in ((legs, "jumpsuit"), ([".....aaaaaa....."] * 6, "dress")):
        rows = " ".join([*empty, *trunk, *below, *empty])
        names = {p.name for p in decode(board(rows, rows, sewn_around=True)).panels}
        assert names == {f"{kind}_front", f"{kind}_back"}


@pytest.mark.parametrize(
    ("example", "body"),
    [("cutout_top", "bodice"), ("darted_shirt", "bodice"), ("dress", "dress"), ("trousers", None)],
)
def test_without_marks_panels_get_the_names_that_their_maker_gave_them(example, body):
    pattern, _ = read_pattern(example_path(example))
    names = {p.name for p in decode(encode(pattern).to_channels()).panels}
    whole = {"front": f"{body}_front", "back": f"{body}_back"}
    assert names == {whole.get(p.name, p.name) for p in pattern.panels}


@given(st.integers(0, 2**32 - 1))
def test_tiny_weight_lets_cells_take_any_shape_they_agree_on(seed):
    rng = np.random.default_rng(seed)
    image = board("aaaa aa.a aaaa aaaa")
    mesh = cell_mesh(image.inside[0], image.edge_type[0])
    wanted = rng.normal(size=(mesh.vertex_count, 2)) * 10
    bl, br, tr, tl = (wanted[mesh.corner_ids[:, c]] for c in range(4))
    vectors = np.stack([br - bl, tr - br, tr - tl, tl - bl], axis=1)
    found = unfold_cells(mesh, vectors, mesh.lattice * CELL_CM)
    gap = found - wanted
    assert np.abs(gap - gap.mean(axis=0)).max() < 1e-2
    assert found.mean(axis=0) == pytest.approx((mesh.lattice * CELL_CM).mean(axis=0))


def test_weight_of_the_paper_bends_panels_and_the_tiny_one_does_not():
    image = board(VEST, cell=4.0)
    mesh = cell_mesh(image.inside[0], image.edge_type[0])
    rows, cols = mesh.cells.T
    vectors = image.deformation[0][:, :, rows, cols].transpose(2, 0, 1).astype(float)
    width = [
        np.ptp(unfold_cells(mesh, vectors, mesh.lattice * CELL_CM, weight)[:, 0])
        for weight in (1e-6, 1.0)
    ]
    assert width[0] == pytest.approx(16.0, abs=1e-3)
    assert width[1] > 20.0


@settings(max_examples=12)
@given(garments())
def test_decoding_undoes_encoding(garment):
    result = compare_patterns(garment, decode(encode(garment)))
    assert result.success, result.reasons


@settings(max_examples=8)
@given(garments())
def test_geometry_and_stitches_need_no_marks(garment):
    image = encode(garment)
    if any(mark.split_of for mark in image.marks):
        return
    result = compare_patterns(garment, decode(image.without_marks()), any_pose=True)
    assert result.success, result.reasons


@settings(max_examples=8)
@given(garments())
def test_correct_images_pass_through_repair_unchanged(garment):
    image = encode(garment)
    for level in LEVELS:
        assert repair(image, level)[0] is image
        assert repair(image.to_channels(), level)[0].same_channels(image)


@pytest.mark.slow
@pytest.mark.corpus
def test_real_images_pass_through_repair_unchanged_and_come_back():
    for path in corpus_sample(40):
        try:
            pattern, _ = read_pattern(path)
            image = encode(pattern)
        except GarmentImageError:
            continue
        for level in LEVELS:
            assert repair(image, level)[0] is image, path
            assert repair(image.to_channels(), level)[0].same_channels(image), path
        check_pattern(decode(image))
        check_pattern(decode(image.without_marks()))


def test_an_image_that_falls_into_thousands_of_parts_is_refused_at_once():
    walls = np.full((2, 2, 64, 64), EdgeType.NON_STITCH, np.int8)
    inside = np.ones((2, 64, 64), bool)
    deformation = np.zeros((2, 4, 2, 64, 64), np.float32)
    image = GarmentImage(inside, walls, deformation, BodyFrame.standard(64))
    with pytest.raises(DecodeError, match="8192 parts"):
        decode(image, repair="none")


@pytest.mark.parametrize("deviation", [4.0, 8.0])
def test_noise_in_many_small_parts_is_no_garment(deviation):
    random = np.random.default_rng(3)
    channels = encode(read_pattern(example_path("dress"))[0], 16).to_channels()
    with pytest.raises(DecodeError, match=r"parts of \d\.\d cells each, as noise is"):
        decode(channels + random.normal(0, deviation, channels.shape))
