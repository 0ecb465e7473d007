"""Cuts that end inside a panel: left out where no outline can be made with them."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.compare import stitch_graph
from garmentimage.compare.topology import topology_hash
from garmentimage.draft.kind import draft_pattern
from garmentimage.errors import DecodeError
from garmentimage.raster.decode.decoder import decode
from garmentimage.raster.encode.encoder import encode
from garmentimage.raster.image import LEFT, EdgeType
from garmentimage.raster.repair.walls import remove_dangling_cuts

DRESS = encode(draft_pattern("one-panel-dress"), 16)


def with_flap(kind: EdgeType, length: int):
    """The dress with a cut from the middle of its hem, without any opening."""
    types = DRESS.edge_type.copy()
    lowest = int(np.flatnonzero(DRESS.inside[0, :, 8])[0])
    layers = (0, 1) if kind == EdgeType.FRONT_TO_BACK else (0,)
    for layer in layers:
        types[layer, LEFT, lowest : lowest + length, 8] = kind
    return replace(DRESS, edge_type=types)


@pytest.mark.parametrize("kind", [EdgeType.FRONT_TO_BACK, EdgeType.NON_STITCH])
@pytest.mark.parametrize("length", [1, 3])
def test_a_cut_without_opening_is_left_out(kind, length):
    image = with_flap(kind, length)
    with pytest.raises(DecodeError, match="crosses itself"):
        decode(image, repair="none")
    word = topology_hash(stitch_graph(decode(image)))
    assert word == topology_hash(stitch_graph(decode(DRESS)))
    mended, count = remove_dangling_cuts(image)
    assert mended.same_channels(DRESS)
    assert count >= length


def test_images_without_such_cuts_stay():
    for kind in ("one-panel-jumpsuit", "top-pants", "shirt", "hoodie"):
        image = encode(draft_pattern(kind), 16)
        assert remove_dangling_cuts(image) == (image, 0)
