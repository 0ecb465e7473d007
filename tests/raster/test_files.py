"""Image files: what is written is read again; what is not ours gets one sentence."""

import io
import json
import tracemalloc
import zipfile
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from garmentimage.errors import ImageError, OutputError
from garmentimage.raster.authors_layout import AUTHORS_CELL_CM
from garmentimage.raster.files import load_channels, load_image, save_image
from garmentimage.raster.image import EdgeType, GarmentImage, PanelMark
from tests.images import images
from tests.raster.test_image import one_cell

MARK = PanelMark(
    name="Vorderteil \N{GRINNING FACE}\0",
    layer=1,
    cell=(2, 5),
    matrix=((0.0, -1.0), (1.0, 0.0)),
    anchor=(1.5, 2.5),
    rotation=(1.0, 180.0, 3.0),
    translation=(4.0, 5.0, 0.1 + 0.2),
    split_of="whole \ud800",
    label="body",
    grain=(0.0, 1.0),
    divisions=((2, 5, 0, (0.25, 0.5)), (2, 5, 3, (1.0,))),
)

in_one_folder = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "garment.npz"
    save_image(replace(one_cell(), marks=(MARK,), name="garment"), path)
    return path


def refusal(path, **options):
    """The one sentence with which a file is refused; it names the file."""
    with pytest.raises(ImageError) as caught:
        load_image(path, **options)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    assert len(message) < 400
    return message


def rewritten(path, **changes):
    """The archive with some arrays exchanged (None: left out)."""
    with np.load(path) as archive:
        arrays = {**archive, **changes}
    np.savez(path, **{k: v for k, v in arrays.items() if v is not None})
    return path


def with_meta(path, **changes):
    with np.load(path) as archive:
        meta = json.loads(archive["meta"].tobytes()) | changes
    return rewritten(path, meta=np.frombuffer(json.dumps(meta).encode(), np.uint8))


# --- our own .npz


@in_one_folder
@given(images())
def test_an_npz_gives_back_the_same_image(tmp_path, image):
    save_image(image, tmp_path / "image.npz")
    again = load_image(tmp_path / "image.npz")
    assert again == image
    assert again.name == (image.name or "image")


def test_every_field_of_a_mark_survives(saved):
    defaults = PanelMark("", 0, (0, 0))
    for field in fields(PanelMark):  # a new field must come into this test and into the file
        assert getattr(MARK, field.name) != getattr(defaults, field.name), field.name
    assert load_image(saved).marks == (MARK,)


def test_the_same_image_gives_the_same_bytes(saved, tmp_path):
    save_image(load_image(saved), tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == saved.read_bytes()


def test_plain_numpy_reads_an_npz_without_pickle(saved):
    with np.load(saved, allow_pickle=False) as archive:
        assert archive["inside"].dtype == bool
        meta = json.loads(archive["meta"].tobytes())
    assert (meta["format"], meta["version"]) == ("garmentimage", 1)
    assert meta["layer_names"] == ["front", "back"]
    assert len(meta["cell_size_cm"]) == len(meta["origin_cm"]) == 2


def test_fields_that_a_later_release_adds_do_no_harm(saved):
    mark = {"name": "a", "layer": 0, "cell": [1, 1], "drape": "bias"}
    with_meta(saved, marks=[mark], weather="fine")
    assert load_image(saved).marks == (PanelMark("a", 0, (1, 1)),)


def test_a_newer_version_asks_for_an_update(saved):
    assert "update" in refusal(with_meta(saved, version=3))


@pytest.mark.parametrize(
    ("name", "array", "words"),
    [
        ("inside", np.zeros((2, 16, 16)), "'inside'"),
        ("inside", np.zeros((2, 16, 15), bool), "'inside'"),
        ("inside", np.zeros((2, 300, 300), bool), "300"),
        ("inside", np.zeros((0, 16, 16), bool), "'inside'"),
        ("inside", None, "'inside' is missing"),
        ("edge_type", np.full((2, 2, 16, 16), 4, np.int8), "'edge_type'"),
        ("edge_type", np.full((2, 2, 16, 16), -1, np.int8), "'edge_type'"),
        ("edge_type", np.zeros((1, 2, 16, 16), np.int8), "'edge_type'"),
        ("deformation", np.full((2, 4, 2, 16, 16), np.inf, np.float32), "not finite"),
        ("deformation", np.zeros((2, 8, 16, 16), np.float32), "'deformation'"),
        ("columns", np.zeros(17), "do not increase"),
        ("rows", np.arange(17)[::-1] * 1.0, "do not increase"),
        ("rows", np.full(17, np.nan), "not finite"),
        ("meta", np.frombuffer(b"{", np.uint8), "JSON"),
        ("meta", np.frombuffer(b"[" * 100_000, np.uint8), "JSON"),
        ("meta", np.frombuffer(b"[]", np.uint8), "format"),
        ("meta", np.zeros(3), "'meta'"),
        ("meta", np.array(["{}"]), "plain numbers"),
    ],
)
def test_arrays_that_are_not_what_they_should_be_are_named(saved, name, array, words):
    assert words in refusal(rewritten(saved, **{name: array}))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"layer": 2}, "outside the grid"),
        ({"cell": [16, 0]}, "outside the grid"),
        ({"cell": [-1, 0]}, "cell"),
        ({"cell": [True, 0]}, "cell"),
        ({"name": 7}, "name"),
        ({"name": "x" * 5000}, "name"),
        ({"matrix": [[1, 0], [1, 0]]}, "not orthogonal"),
        ({"matrix": [[1, 0]]}, "matrix"),
        ({"anchor": [1, None]}, "anchor"),
        ({"anchor": [1, float("inf")]}, "anchor"),
        ({"anchor": [1, 10**400]}, "anchor"),
        ({"rotation": [1, 2]}, "rotation"),
        ({"grain": "up"}, "grain"),
        ({"divisions": 3}, "divisions"),
        ({"divisions": [[1, 1, 0, 0.5]]}, "divisions"),
        ({"divisions": [[1, 1, 4, [0.5]]]}, "divisions"),
        ({"divisions": [[1, 1, 0, [0.7, 0.5]]]}, "divisions"),
        ({"divisions": [[1, 1, 0, [1.5]]]}, "divisions"),
        ({"divisions": [[-1, 1, 0, [0.5]]]}, "divisions"),
    ],
)
def test_a_mark_that_makes_no_sense_is_refused(saved, change, words):
    mark = {"name": "a", "layer": 0, "cell": [1, 1]} | change
    assert words in refusal(with_meta(saved, marks=[mark]))


@pytest.mark.parametrize(
    "change",
    [
        {"marks": 3},
        {"marks": ["a"]},
        {"marks": [{}]},
        {"layer_names": ["front"]},
        {"layer_names": [1, 2]},
        {"layer_names": None},
        {"name": []},
        {"version": "1"},
        {"version": 0},
        {"format": "other"},
    ],
)
def test_a_meta_that_makes_no_sense_is_refused(saved, change):
    refusal(with_meta(saved, **change))


# --- the authors' .npy


def test_the_authors_layout_is_the_documented_one(tmp_path):
    """One cell of the back: column 5 is x, row 2 is y; types none, side, front-to-back, free."""
    save_image(one_cell(), tmp_path / "a.npy")
    array = np.load(tmp_path / "a.npy")
    assert (array.shape, array.dtype) == ((34, 16, 16), np.float64)
    cell = array[17:, 5, 2]
    assert cell[0] == 1
    rest = np.array([[1, 0], [0, 1], [1, 0], [0, 1]])  # bottom, left, top, right
    moved = cell[1:9].reshape(4, 2)
    expected = np.array([[10, 1], [4, 13], [12, 3], [2, 11]])
    np.testing.assert_allclose((moved + rest) * AUTHORS_CELL_CM, expected, rtol=1e-12)
    assert cell[9:13].tolist() == [0, 0, 0, 1]  # bottom: a free boundary
    assert cell[13:17].tolist() == [0, 1, 0, 0]  # left: side by side
    outside = array[17:, 6, 2]
    assert outside.tolist() == [0] * 9 + [1, 0, 0, 0] * 2


def test_each_type_has_its_own_place_in_both_orders(tmp_path):
    edge_type = np.zeros((2, 2, 16, 16), np.int8)
    edge_type[0, 0, 0, :4] = list(EdgeType)[:4]
    save_image(replace(one_cell(), edge_type=edge_type), tmp_path / "a.npy")
    positions = np.load(tmp_path / "a.npy")[9:13, :4, 0].argmax(axis=0).tolist()
    names = ["none", "side-by-side", "front-to-back", "boundary"]
    assert [names[k] for k in positions] == ["none", "boundary", "front-to-back", "side-by-side"]


@in_one_folder
@given(images(layers=2))
def test_the_authors_layout_gives_back_the_channels(tmp_path, image):
    save_image(image, tmp_path / "a.npy")
    again = load_image(tmp_path / "a.npy")
    assert np.array_equal(again.inside, image.inside)
    assert np.array_equal(again.edge_type, image.edge_type)
    np.testing.assert_allclose(again.deformation, image.deformation, rtol=1e-6, atol=1e-6)
    assert again.name == "a"


def test_an_image_of_four_layers_has_no_place_in_the_authors_layout(tmp_path):
    image = one_cell()
    both = [np.concatenate([a, a]) for a in (image.inside, image.edge_type, image.deformation)]
    doubled = GarmentImage(*both, image.frame, ("a", "b", "c", "d"))
    with pytest.raises(ImageError, match="two layers"):
        save_image(doubled, tmp_path / "a.npy")
    assert not (tmp_path / "a.npy").exists()


# --- bare channels as .npy


@in_one_folder
@given(images())
def test_bare_channels_are_known_by_their_types(tmp_path, image):
    np.save(tmp_path / "c.npy", image.to_channels())
    assert load_image(tmp_path / "c.npy").same_channels(image)


@in_one_folder
@given(images(layers=2), st.floats(0.01, 0.3))
def test_soft_channels_stay_soft_in_both_orders(tmp_path, image, doubt):
    """A network's shares: none certain, each four adding up to one."""
    soft = image.to_channels().astype(np.float64)
    for group in (slice(1, 5), slice(5, 9), slice(18, 22), slice(22, 26)):
        soft[group] = doubt / 4 + (1 - doubt) * soft[group]
    np.save(tmp_path / "ours.npy", soft)
    assert np.array_equal(load_channels(tmp_path / "ours.npy"), soft)
    assert load_image(tmp_path / "ours.npy").same_channels(image)
    save_image(image, tmp_path / "theirs.npy")
    theirs = np.load(tmp_path / "theirs.npy")
    for group in (slice(9, 13), slice(13, 17), slice(26, 30), slice(30, 34)):
        theirs[group] = doubt / 4 + (1 - doubt) * theirs[group]
    np.save(tmp_path / "theirs.npy", theirs)
    again = load_channels(tmp_path / "theirs.npy")
    types = np.r_[1:9, 18:26]
    np.testing.assert_allclose(again[types], soft[types], atol=1e-12)


def test_logits_fit_neither_order_until_the_order_is_named(tmp_path):
    path = tmp_path / "logits.npy"
    channels = one_cell().to_channels()
    channels[1:9] = channels[1:9] * 9 - 5
    channels[18:26] = channels[18:26] * 9 - 5
    np.save(path, channels)
    assert "order" in refusal(path)
    assert load_image(path, order="garmentimage").same_channels(one_cell())


def test_channels_that_fit_both_orders_are_refused(tmp_path):
    """Every cell inside, and vectors that look like shares: no garment, but who knows."""
    path = tmp_path / "both.npy"
    array = np.zeros((34, 16, 16))
    array[[0, 1, 5, 9, 13, 17, 18, 22, 26, 30]] = 1
    np.save(path, array)
    assert "both" in refusal(path)
    ours, theirs = (load_image(path, order=order) for order in ("garmentimage", "authors"))
    assert not ours.same_channels(theirs)


def test_an_order_that_nobody_knows_is_refused(tmp_path):
    np.save(tmp_path / "c.npy", one_cell().to_channels())
    assert "upside" in refusal(tmp_path / "c.npy", order="upside")


# --- strangers


def test_files_that_are_none_get_one_sentence(tmp_path):
    (tmp_path / "empty.npz").write_bytes(b"")
    (tmp_path / "text.npz").write_text("hello")
    (tmp_path / "zip.npz").write_bytes(b"PK\x03\x04")
    for name in ("empty.npz", "text.npz", "zip.npz", "missing.npz"):
        refusal(tmp_path / name)
    assert "folder" in refusal(tmp_path)
    with pytest.raises(ImageError, match="cannot be read"):
        load_image(tmp_path / ("x" * 5000 + ".npz"))


def test_python_objects_are_never_unpickled(tmp_path, saved):
    class Trap:
        def __reduce__(self):
            return (pytest.fail, ("unpickled",))

    trap = np.array([Trap()], dtype=object)
    np.save(tmp_path / "trap.npy", trap, allow_pickle=True)
    refusal(tmp_path / "trap.npy")
    rewritten(saved, inside=trap)
    refusal(saved)


def test_a_header_that_promises_terabytes_costs_nothing(tmp_path):
    stream = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (34, 10**6, 10**6)}
    np.lib.format.write_array_header_1_0(stream, header)
    (tmp_path / "big.npy").write_bytes(stream.getvalue())
    assert "another size" in refusal(tmp_path / "big.npy")


@pytest.mark.slow
def test_a_zip_bomb_is_not_unpacked(tmp_path, saved):
    with (
        zipfile.ZipFile(saved, "a", zipfile.ZIP_DEFLATED) as archive,
        archive.open("bomb.npy", "w", force_zip64=True) as member,
    ):
        for _ in range(200):
            member.write(bytes(2**20))
    assert load_image(saved).marks == (MARK,)  # what is not asked for is not unpacked
    bomb = tmp_path / "bomb.npz"
    with zipfile.ZipFile(saved) as old, zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as new:
        for info in old.infolist():
            if info.filename == "bomb.npy":
                new.writestr("inside.npy", old.read(info))
            elif info.filename != "inside.npy":
                new.writestr(info.filename, old.read(info))
    assert bomb.stat().st_size < 2**20
    assert "unpacks to more" in refusal(bomb)


@pytest.mark.slow
@pytest.mark.parametrize("packing", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_zip_bomb_that_lies_about_its_size_costs_no_memory(saved, packing):
    with zipfile.ZipFile(saved) as old:
        rest = {n: old.read(n) for n in old.namelist() if n != "inside.npy"}
    with zipfile.ZipFile(saved, "w", packing) as new:
        for name, data in rest.items():
            new.writestr(name, data)
        new.writestr("inside.npy", bytes(200 * 2**20))
    raw = bytearray(saved.read_bytes())
    size = raw.rindex(b"inside.npy") - 46 + 24  # of the member, in the central directory
    raw[size : size + 4] = (1000).to_bytes(4, "little")
    saved.write_bytes(raw)
    tracemalloc.start()
    refusal(saved)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50 * 2**20


@pytest.mark.parametrize("shape", [(0, 10**30), (1,) * 70, (True, True)])
def test_a_shape_that_no_array_can_have_is_refused(tmp_path, shape):
    stream = io.BytesIO()
    header = {"descr": "|b1", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(stream, header)
    (tmp_path / "odd.npy").write_bytes(stream.getvalue() + bytes(0 if 0 in shape else 1))
    refusal(tmp_path / "odd.npy")


@in_one_folder
@given(st.data())
def test_a_damaged_file_is_refused_or_read_but_never_a_traceback(tmp_path, data):
    suffix = data.draw(st.sampled_from([".npz", ".npy"]))
    path = tmp_path / f"damaged{suffix}"
    save_image(replace(one_cell(), marks=(MARK,)), path)
    raw = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(0, 6))):
        raw[data.draw(st.integers(0, min(len(raw), 400) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(raw)))
    path.write_bytes(raw[:cut] if data.draw(st.booleans()) else raw)
    try:
        load_image(path)
    except ImageError as error:
        assert str(error).startswith(str(path))


# --- writing


@pytest.mark.parametrize("name", ["a", "a.json", "a.npz.txt"])
def test_another_ending_is_refused(tmp_path, name):
    with pytest.raises(OutputError, match=r"\.npz or \.npy"):
        save_image(one_cell(), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_missing_folder_is_refused(tmp_path):
    with pytest.raises(OutputError, match="folder"):
        save_image(one_cell(), tmp_path / "no" / "a.npz")
