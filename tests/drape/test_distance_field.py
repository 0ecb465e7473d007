import numpy as np
import pytest

from garmentimage.body.body import load_body
from garmentimage.drape.solver.distance_field import (
    BAND,
    CELL,
    CLOTH_BAND,
    body_field,
    empty_field,
    surface_distance,
)
from tests.drape.sheets import lying, sheet


def cube(half: float = 6.3):
    """A cube's corners and outward triangles."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def to_cube(points, half: float = 6.3):
    """The true signed distance to `cube`."""
    q = np.abs(points) - half
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)


@pytest.fixture(scope="module")
def cube_field():
    return surface_distance(*cube())


def nodes(field):
    ticks = [
        o + field.cell * np.arange(n) for o, n in zip(field.origin, field.values.shape, strict=True)
    ]
    return np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1)


def test_distances_near_a_surface_are_exact(cube_field):
    true = to_cube(nodes(cube_field))
    near = np.abs(true) < BAND - 1e-3
    assert np.abs(cube_field.values - true)[near].max() < 1e-5


def test_every_place_has_the_right_sign_at_edges_and_corners_too(cube_field):
    true = to_cube(nodes(cube_field))
    assert np.array_equal(cube_field.values < 0, true < 0)


def test_distances_far_off_are_too_great_by_no_more_than_an_eighth(cube_field):
    true = np.abs(to_cube(nodes(cube_field)))
    found = np.abs(cube_field.values)
    assert (found >= true - 1e-4).all()
    assert (found <= true * 1.13 + CELL).all()


def test_the_slope_points_away_from_the_surface(cube_field):
    points = np.array([[7.5, 0.2, 0.3], [0.1, -7.5, 0.4], [0.3, 0.2, 5.2]])
    distance, slope = cube_field.at_with_slope(points)
    assert np.allclose(slope, [[1, 0, 0], [0, -1, 0], [0, 0, 1]], atol=1e-4)
    assert np.allclose(distance, [1.2, 1.2, -1.1], atol=1e-4)


def test_beyond_the_grid_the_distance_is_that_of_its_rim(cube_field):
    assert cube_field.at(np.array([[1e3, 0.0, 0.0]]))[0] > 4.0
    assert empty_field().at(np.array([[5.0, -3.0, 1e4]]))[0] > 1e5


def test_a_body_is_solid_and_its_field_is_made_once():
    body = load_body()
    field = body_field(body)
    assert body_field(body) is field
    assert not field.values.flags.writeable
    joints = np.array([p for name, p in body.landmarks.items() if name.endswith("_joint")])
    assert (field.at(joints) < 0).all()
    litres = (field.values < 0).sum() * field.cell**3 / 1000
    assert 45 < litres < 80
    assert np.abs(field.at(body.vertices)).mean() < 0.12


def test_the_same_surface_gives_the_same_bits():
    again = surface_distance(*cube())
    assert again.values.tobytes() == surface_distance(*cube()).values.tobytes()


def test_cloth_over_a_body_is_an_obstacle_that_traps_nothing_behind_it(cube_field):
    flat, faces, _ = sheet(4, 4, 2.0)
    worn = lying(flat, 8.5)
    normal = np.cross(worn[faces[0, 1]] - worn[faces[0, 0]], worn[faces[0, 2]] - worn[faces[0, 0]])
    upward = faces if normal[1] > 0 else faces[:, ::-1]
    both = cube_field.with_cloth(worn, upward, thickness=0.4)
    above = np.array([[0.0, 8.5 + h, 0.0] for h in (1.5, 0.4, 0.0)])
    assert np.allclose(both.at(above), [1.1, 0.0, -0.4], atol=0.06)
    distance, slope = both.at_with_slope(np.array([[0.0, 8.5 - CLOTH_BAND + 1.2, 0.0]]))
    assert distance[0] < 0
    assert slope[0, 1] > 0.9
    assert np.array_equal(
        both.at(np.array([[0, -9.0, 0]])), cube_field.at(np.array([[0, -9.0, 0]]))
    )
