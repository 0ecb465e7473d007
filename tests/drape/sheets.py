"""Small pieces of cloth and simple obstacles for the tests of the solver."""

import numpy as np

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.fabric import Fabric
from garmentimage.drape.mesh.rest import Rest, rest_of
from garmentimage.drape.solver.distance_field import DistanceField
from garmentimage.pattern.model import Pattern

ROW = np.sqrt(3) / 2

SOFT = Fabric(stretch=2e4, bend=20.0, weight=0.02, friction=0.4, thickness=0.4, damping=8.0)


def strip(links: int, *, length: float = 100.0, width: float = 2.0) -> Rest:
    """A chain of springs that stands for a narrow band of cloth, along x."""
    number = np.arange(links)
    side = length / links
    area = np.full(links + 1, side * width)
    area[[0, -1]] /= 2
    return Rest(
        faces=np.zeros((0, 3), int),
        edges=np.stack([number, number + 1], axis=1),
        length=np.full(links, side),
        area=np.full(links, side * width),
        vertex_area=area,
        face_area=np.zeros(0),
        inverse=np.zeros((0, 2, 2)),
        folds=np.zeros((0, 2), int),
    )


def sheet(columns: int, rows: int, side: float) -> tuple[np.ndarray, np.ndarray, Rest]:
    """A rectangle of cloth: places in the plane, triangles, and what the solver knows of it."""
    flat, faces = triangles(columns, rows, side)
    number = np.arange(len(flat))
    cloth = Cloth(Pattern(()), flat, faces, np.zeros(len(flat), int), number, {})
    return flat, faces, rest_of(cloth)


def triangles(columns: int, rows: int, side: float):
    """Equilateral triangles: places in the plane, and the vertices of each triangle.

    `columns` counts vertices along x and `rows` rows of triangles along y; odd rows of vertices
    are cut off straight at both ends, so that the sheet is a mirror-symmetric rectangle.
    """
    places, number = [], {}
    for j in range(rows + 1):
        xs = np.arange(columns) * side
        if j % 2:
            xs = np.concatenate([xs[:1], xs[:-1] + side / 2, xs[-1:]])
        for k, x in enumerate(xs):
            number[j, k] = len(places)
            places.append((x - xs[-1] / 2, j * side * ROW))
    faces = []
    for j in range(rows):
        long, short = (j, j + 1) if j % 2 else (j + 1, j)
        for k in range(columns):
            faces.append((number[short, k], number[long, k], number[long, k + 1]))
            if k + 1 < columns:
                faces.append((number[short, k], number[long, k + 1], number[short, k + 1]))
    flat, faces = np.array(places), np.array(faces)
    a, b, c = (flat[faces[:, k]] for k in range(3))
    turned = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
    faces[turned] = faces[turned][:, ::-1]
    return flat, faces


def standing(flat, height=0.0):
    """Places in the upright plane z = 0."""
    return np.column_stack([flat[:, 0], flat[:, 1] + height, np.zeros(len(flat))])


def lying(flat, height=0.0):
    """Places in a level plane, the middle over the origin."""
    z = flat[:, 1] - flat[:, 1].mean()
    return np.column_stack([flat[:, 0], np.full(len(flat), height), z])


def field_of(distance, *, reach=60.0, cell=1.0):
    """The field of a signed distance given as a function of x, y, z."""
    ticks = np.arange(-reach, reach + cell / 2, cell)
    values = distance(*np.meshgrid(ticks, ticks, ticks, indexing="ij")).astype(np.float32)
    return DistanceField(values, np.full(3, -reach), cell)


def floor(slope=0.0):
    """A plane through the origin that falls towards +x by an angle [radians]."""
    return field_of(lambda x, y, z: np.cos(slope) * y + np.sin(slope) * x, reach=60.0, cell=2.0)


def ball(radius=15.0):
    return field_of(lambda x, y, z: np.sqrt(x * x + y * y + z * z) - radius, reach=40.0)
