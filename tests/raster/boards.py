"""Small images drawn as text, for tests of reading and mending.

A board has a line of cells per row, top row first, `.` outside and one letter per panel. Where two
panels touch they are sewn side by side; where one touches nothing it is sewn to the other layer if
that has a panel boundary at the same place and `sewn_around` is set, else free.
"""

from dataclasses import replace

import numpy as np

from garmentimage.raster.frame import BodyFrame
from garmentimage.raster.image import EdgeType, GarmentImage, default_layer_names

CELL_CM = 10.0


def square_frame(grid: int) -> BodyFrame:
    """A frame of even cells, the body's axis in the middle."""
    columns = (np.arange(grid + 1) - grid / 2) * CELL_CM
    return BodyFrame(tuple(columns.tolist()), tuple((np.arange(grid + 1) * CELL_CM).tolist()))


def board(*layers: str, sewn_around: bool = False, cell=CELL_CM, marks=()) -> GarmentImage:
    """The image of some boards, one per layer; every cell is a square of `cell` cm."""
    letters = np.array([[list(line) for line in text.split()[::-1]] for text in layers])
    count, grid, _ = letters.shape
    padded = np.full((count, grid + 1, grid + 1), ".")
    padded[:, 1:, 1:] = letters
    inside = letters != "."
    types = np.zeros((count, 2, grid, grid), np.int8)
    for h, other in enumerate((padded[:, :-1, 1:], padded[:, 1:, :-1])):
        differs = letters != other
        types[:, h][differs] = EdgeType.NON_STITCH
        types[:, h][differs & inside & (other != ".")] = EdgeType.SIDE_BY_SIDE
        if sewn_around and count > 1:
            same = (inside[0] == inside[1]) & (types[0, h] == 1) & (types[1, h] == 1)
            types[:, h][:, same] = EdgeType.FRONT_TO_BACK
    deformation = np.zeros((count, 4, 2, grid, grid), np.float32)
    deformation[:, [0, 2], 0] = cell
    deformation[:, [1, 3], 1] = cell
    deformation *= inside[:, None, None]
    frame = square_frame(grid)
    return GarmentImage(inside, types, deformation, frame, default_layer_names(count), marks)


def with_types(image: GarmentImage, changes: dict[tuple[int, int, int, int], EdgeType]):
    """The image with the types of some grid edges (layer, h, row, col) changed."""
    types = image.edge_type.copy()
    for place, kind in changes.items():
        types[place] = kind
    return replace(image, edge_type=types)
