"""Our files in the authors' layout, read by that layout's description alone.

The reader here knows the table of channels and nothing of our code: cells that a type-0 edge joins
are one panel, whose cells are laid edge to edge.
"""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings

from garmentimage import EncodeError, ImageError, decode, encode, save_image
from garmentimage.compare.matching import panel_region
from garmentimage.pattern.files.spec import read_pattern
from tests.corpus import corpus_sample
from tests.garments import garments

FLAG, BOTTOM, LEFT, TOP, RIGHT, BOTTOM_TYPE, LEFT_TYPE = 0, 1, 3, 5, 7, 9, 13
NONE = 0
CELL_CM = 32 / 2.75


def panels_by_the_layout(array):
    """Areas of the plane [cm], one for each panel, from [34, x, y]."""
    panels = []
    for layer in (array[:17], array[17:]):
        inside = layer[FLAG] > 0.5
        seen = np.zeros_like(inside)
        for x, y in zip(*np.nonzero(inside), strict=True):
            if not seen[x, y]:
                panels.append(_panel(layer, inside, seen, int(x), int(y)))
    return panels


def _panel(layer, inside, seen, x, y):
    """The cells that can be reached from one without crossing a boundary, as one region."""
    corner = {(x, y): np.zeros(2)}
    queue, quads = [(x, y)], []
    seen[x, y] = True
    while queue:
        x, y = queue.pop()
        bl = corner[x, y]
        br = bl + _edge(layer, BOTTOM, x, y, (1, 0))
        tl = bl + _edge(layer, LEFT, x, y, (0, 1))
        tr = tl + _edge(layer, TOP, x, y, (1, 0))
        quads.append(np.stack([bl, br, tr, tl]))
        for there, wall in (
            ((x - 1, y), (LEFT_TYPE, x, y)),
            ((x, y - 1), (BOTTOM_TYPE, x, y)),
            ((x + 1, y), (LEFT_TYPE, x + 1, y)),
            ((x, y + 1), (BOTTOM_TYPE, x, y + 1)),
        ):
            if min(there) < 0 or max(there) >= len(inside) or seen[there] or not inside[there]:
                continue
            first, *at = wall
            if layer[(slice(first, first + 4), *at)].argmax() != NONE:
                continue
            seen[there] = True
            if there[0] < x:
                corner[there] = bl - _edge(layer, BOTTOM, *there, (1, 0))
            elif there[1] < y:
                corner[there] = bl - _edge(layer, LEFT, *there, (0, 1))
            else:
                corner[there] = br if there[0] > x else tl
            queue.append(there)
    # Cells meet in rounded corners: a hair's breadth joins them.
    return shapely.union_all([shapely.Polygon(q).buffer(1e-3) for q in quads])


def _edge(layer, channel, x, y, rest):
    return (layer[channel : channel + 2, x, y] + rest) * CELL_CM


def check_same_panels(pattern, folder):
    image = encode(pattern, grid=16).cut_at_wraps()
    save_image(image, folder / "a.npy")
    theirs = panels_by_the_layout(np.load(folder / "a.npy", allow_pickle=False))
    ours = [panel_region(panel) for panel in decode(image_without_marks(image)).panels]
    assert len(theirs) == len(ours)
    # Chords from grid point to grid point against the smooth boundaries that decoding fits.
    best = [max(_iou(region, other) for other in ours) for region in theirs]
    assert min(best) > 0.8
    assert np.mean(best) > 0.95


def image_without_marks(image):
    return type(image).from_channels(image.to_channels())


def _iou(a, b):
    a, b = (shapely.transform(g, lambda p, c=g.centroid: p - [c.x, c.y]) for g in (a, b))
    return a.intersection(b).area / a.union(b).area


@settings(max_examples=15)
@given(garments())
def test_what_the_layout_says_are_the_panels_that_we_decode(tmp_path_factory, garment):
    check_same_panels(garment, tmp_path_factory.mktemp("authors"))


@pytest.mark.corpus
def test_patterns_by_others_come_out_of_the_authors_layout_as_the_same_panels(tmp_path):
    seen = 0
    for path in corpus_sample(60):
        try:
            check_same_panels(read_pattern(path)[0], tmp_path)
        except EncodeError:
            continue
        except ImageError as error:
            assert "turned" in str(error)
            continue
        seen += 1
    assert seen >= 50
