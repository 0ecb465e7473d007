"""Random GarmentImages for laws about channels and files: any flags, types and vectors."""

import numpy as np
from hypothesis import strategies as st

from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import GarmentImage, PanelMark, default_layer_names

NUMBERS = st.floats(-300, 300, width=32)
NAMES = st.text(max_size=12)


@st.composite
def marks(draw, layers, grid):
    angle = draw(st.floats(0, 6))
    c, s = float(np.cos(angle)), float(np.sin(angle))
    places = st.tuples(NUMBERS, NUMBERS, NUMBERS)
    return PanelMark(
        name=draw(NAMES),
        layer=draw(st.integers(0, layers - 1)),
        cell=(draw(st.integers(0, grid - 1)), draw(st.integers(0, grid - 1))),
        matrix=((c, -s), (s, c)),
        anchor=draw(st.tuples(NUMBERS, NUMBERS)),
        rotation=draw(st.none() | places),
        translation=draw(st.none() | places),
        split_of=draw(st.none() | NAMES),
        label=draw(st.none() | NAMES),
        grain=draw(st.none() | st.tuples(NUMBERS, NUMBERS)),
    )


@st.composite
def images(draw, layers=None, grids=(4, 5, 8, 16)):
    """Not garments, but every image that the contract allows."""
    layers = draw(st.sampled_from([1, 2, 4])) if layers is None else layers
    grid = draw(st.sampled_from(grids))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    inside = rng.random((layers, grid, grid)) < draw(st.sampled_from([0.1, 0.5, 0.9]))
    inside[:, 0, 0] = False
    deformation = rng.normal(0, 20, (layers, 4, 2, grid, grid)).astype(np.float32)
    return GarmentImage(
        inside=inside,
        edge_type=rng.integers(0, 4, (layers, 2, grid, grid)).astype(np.int8),
        deformation=np.where(inside[:, None, None], deformation, np.float32(0)),
        frame=BodyFrame.standard(grid),
        layer_names=default_layer_names(layers),
        marks=tuple(draw(st.lists(marks(layers, grid), max_size=3))),
        name=draw(NAMES),
    )
