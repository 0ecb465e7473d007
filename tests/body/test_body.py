"""Shipped bodies: watertight, upright, alike on both sides, small on disk."""

from importlib.resources import files

import numpy as np
import pytest

from garmentimage.body.body import POSES, STEP, load_body, read_points, write_points
from garmentimage.body.body_measurements import presets
from garmentimage.errors import DraftError

SIZE_LIMIT = 2_500_000
ROUNDING_LIMIT_CM = 0.02
"""What the shipped files may move a point by."""
MIRROR_TOL_CM = 0.15
"""The ears are that much unlike."""
ARM_TOL = np.deg2rad(2)

BODIES = [(name, pose) for name in presets() for pose in POSES]


@pytest.fixture(params=BODIES, ids="-".join)
def body(request):
    return load_body(*request.param)


def volume(body):
    """Litres; positive where the faces look outwards."""
    a, b, c = np.moveaxis(body.vertices[body.faces], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6 / 1000


def test_the_skin_is_one_watertight_surface(body):
    sides = np.concatenate([body.faces[:, [0, 1]], body.faces[:, [1, 2]], body.faces[:, [2, 0]]])
    assert len(np.unique(sides, axis=0)) == len(sides)
    assert np.array_equal(np.unique(sides, axis=0), np.unique(sides[:, ::-1], axis=0))
    assert np.array_equal(np.unique(body.faces), np.arange(len(body.vertices)))
    # Euler: a closed surface without handles.
    assert len(body.vertices) - len(sides) // 2 + len(body.faces) == 2


def test_faces_look_outwards_round_an_adult_volume(body):
    assert 40 < volume(body) < 110


def test_a_body_stands_on_the_floor_and_looks_forward(body):
    low, high = body.vertices.min(0), body.vertices.max(0)
    assert abs(low[1]) <= STEP
    feet = body.vertices[body.vertices[:, 1] < 3, 2]
    ankle = body.landmarks["left_ankle_joint"][2]
    assert feet.max() - ankle > ankle - feet.min() > 0, "toes reach further than heels"
    assert body.landmarks["forehead"][2] > body.landmarks["head_back"][2]
    assert body.landmarks["left_wrist_joint"][0] > 0
    assert 150 < high[1] < 195


def test_both_sides_are_alike(body):
    from scipy.spatial import cKDTree

    gap, _ = cKDTree(body.vertices).query(body.vertices * [-1, 1, 1])
    assert gap.max() < MIRROR_TOL_CM


def test_arms_lie_as_the_pose_says(body):
    arm = body.landmarks["left_wrist_joint"] - body.landmarks["left_shoulder_joint"]
    down = {"t": 0, "a": np.pi / 4}[body.pose]
    straight = np.array([np.cos(down), -np.sin(down), 0])
    assert arm @ straight > np.cos(ARM_TOL) * np.linalg.norm(arm)


def test_legs_stand_apart(body):
    inner = body.vertices[body.vertices[:, 1] < 0.5 * body.landmarks["crotch"][1]]
    assert np.abs(inner[:, 0]).min() > 1


def test_the_poses_differ_in_the_arms_only():
    t, a = load_body("mean-male", "t"), load_body("mean-male", "a")
    below = t.vertices[:, 1] < t.landmarks["waist_front"][1]
    arms = np.abs(t.vertices[:, 0]) > t.landmarks["left_elbow_joint"][0]
    # The hands of the second pose hang beside the hips, so choose by the first.
    assert np.allclose(t.vertices[below], a.vertices[below], atol=2 * STEP)
    assert np.linalg.norm(t.vertices[arms] - a.vertices[arms], axis=1).min() > 10


def test_landmarks_on_the_skin_are_vertices(body):
    skin = [place for name, place in body.landmarks.items() if not name.endswith("_joint")]
    gaps = [np.abs(body.vertices - place).max(1).min() for place in skin]
    assert len(gaps) >= 10 and max(gaps) == 0


def test_all_bodies_differ_in_height_and_girth():
    sizes = [(record.stature, record.waist_girth) for record in presets().values()]
    for k, (stature, waist) in enumerate(sizes):
        for other_stature, other_waist in sizes[:k]:
            assert max(abs(stature - other_stature), abs(waist - other_waist)) > 8


def test_a_body_is_loaded_once_and_cannot_be_changed():
    body = load_body()
    assert body is load_body("mean-female", "t")
    with pytest.raises(ValueError, match="read-only"):
        body.vertices[0, 0] = 1
    with pytest.raises(TypeError):
        body.landmarks["crown"] = body.vertices[0]


def test_rounding_moves_no_point_far():
    points = np.random.default_rng(3).uniform([-110, 0, -40], [110, 200, 40], (1000, 3))
    assert np.abs(read_points(write_points(points)) - points).max() <= STEP / 2
    assert STEP / 2 < ROUNDING_LIMIT_CM


def test_the_shipped_files_are_small():
    data = files("garmentimage.body").joinpath("data")
    assert sum(len(file.read_bytes()) for file in data.iterdir()) < SIZE_LIMIT


def test_unknown_names_are_refused_in_one_sentence():
    with pytest.raises(DraftError, match="did you mean mean-male"):
        load_body("mean-mal")
    with pytest.raises(DraftError, match=r"choose 't' .* or 'a'"):
        load_body("mean-male", "x")
