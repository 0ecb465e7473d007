"""Picture files: whole, repeatable, and drawn without touching anything global."""

import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from garmentimage import load_pattern
from garmentimage.errors import OutputError
from garmentimage.examples import example_names, example_path
from garmentimage.raster.image import EdgeType
from garmentimage.render.flat.garment_image import draw_cells, draw_image
from garmentimage.render.showing import compose, show
from garmentimage.render.style import TYPE_COLOURS, printable
from tests.raster.test_image import one_cell


@pytest.fixture
def axes():
    from matplotlib.figure import Figure

    return Figure().add_axes((0, 0, 1, 1))


def dress():
    return load_pattern(example_path("dress"))


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_the_same_sources_give_the_same_bytes(kind, tmp_path):
    for name in ("a", "b"):
        show(dress(), one_cell(), out=tmp_path / f"{name}.{kind}")
    first, second = ((tmp_path / f"{name}.{kind}").read_bytes() for name in ("a", "b"))
    assert first == second
    assert (b"PNG" if kind == "png" else b"<svg") in first[:1000]


def test_an_svg_is_xml_without_a_date(tmp_path):
    show(dress(), out=tmp_path / "a.svg")
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    assert root.tag.endswith("svg")
    assert "date" not in ElementTree.tostring(root, encoding="unicode").lower()


@pytest.mark.parametrize("name", example_names())
def test_every_example_can_be_drawn(name, tmp_path):
    show(load_pattern(example_path(name)), out=tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_names_from_files_cannot_spoil_a_picture(tmp_path):
    """Signs that the font lacks, mathematics, markup and line breaks are only signs."""
    pattern = dress()
    odd = [*"\0\n\u202e", "$x^", "\N{GRINNING FACE}" * 90, "<b>&amp;\ud800", *"abcdefgh"]
    panels = [replace(p, name=f"{n}") for p, n in zip(pattern.panels, odd, strict=False)]
    show(replace(pattern, panels=tuple(panels), stitches=()), out=tmp_path / "a.svg")
    root = ElementTree.parse(tmp_path / "a.svg").getroot()
    names = {element.tag.rpartition("}")[2] for element in root.iter()}
    assert root.tag.endswith("svg") and not names & {"b", "script", "image"}


def test_printable_keeps_plain_text_and_shortens_long():
    assert printable("left sleeve, Ärmel") == "left sleeve, Ärmel"
    assert len(printable("x" * 1000)) < 40
    assert "\n" not in printable("a\nb")


@pytest.mark.parametrize("name", ["a.gif", "a", "a.json"])
def test_another_ending_is_refused(name, tmp_path):
    with pytest.raises(OutputError, match=r"\.png or \.svg"):
        show(dress(), out=tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_pyplot_is_not_imported():
    code = (
        "import sys; from garmentimage import load_pattern; "
        "from garmentimage.render.showing import compose; "
        f"compose([load_pattern({str(example_path('dress'))!r})]); "
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_each_source_gets_its_title_and_each_step_its_word():
    figure = compose([dress(), one_cell()], titles=["left", "right"], steps=["encode"])
    assert [t.get_text() for t in figure.texts] == ["left", "encode", "right"]
    assert len(figure.axes) == 3  # the pattern; types and cells of the image


def test_typed_grid_edges_are_drawn_where_they_are_and_in_their_colour(axes):
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgba

    draw_image(one_cell(), axes)
    found = {}
    for lines in axes.collections:
        if isinstance(lines, LineCollection):
            found.setdefault(tuple(lines.get_colors()[0]), []).extend(lines.get_segments())
    (bottom,) = found[to_rgba(TYPE_COLOURS[EdgeType.NON_STITCH])]
    (left,) = found[to_rgba(TYPE_COLOURS[EdgeType.SIDE_BY_SIDE])]
    shift = bottom[0, 0] - 5  # the back stands right of the front
    assert shift > 16
    np.testing.assert_allclose(bottom - [shift, 0], [[5, 2], [6, 2]])
    np.testing.assert_allclose(left - [shift, 0], [[5, 2], [5, 3]])
    assert not found[to_rgba(TYPE_COLOURS[EdgeType.FRONT_TO_BACK])]


def test_a_deformed_cell_is_drawn_with_its_own_vectors(axes):
    from matplotlib.collections import PolyCollection

    draw_cells(one_cell(), axes)
    (quad,) = [
        p.vertices[:4]
        for c in axes.collections
        if isinstance(c, PolyCollection)
        for p in c.get_paths()
    ]
    bottom, left = quad[1] - quad[0], quad[3] - quad[0]
    np.testing.assert_allclose(bottom[1] / bottom[0], 1 / 10, atol=1e-6)
    np.testing.assert_allclose(left[0] / left[1], 4 / 13, atol=1e-6)


def test_an_empty_image_is_drawn_as_an_empty_grid(tmp_path, axes):
    image = one_cell()
    empty = replace(
        image, inside=np.zeros_like(image.inside), edge_type=np.zeros_like(image.edge_type)
    )
    show(empty, out=tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    draw_image(empty, axes, legend=False)
    lines = [path for c in axes.collections for path in c.get_paths() if len(path.vertices)]
    assert len(lines) == image.layers * 2 * (image.grid + 1)  # nothing but the grids
