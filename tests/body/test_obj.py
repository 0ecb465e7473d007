"""Bodies of one's own: any unit, any side up; what is no body is refused in one sentence."""

import numpy as np
import pytest

from garmentimage.body.body import load_body
from garmentimage.body.measurements import presets
from garmentimage.body.obj import load_body_file
from garmentimage.errors import DraftError

LEVEL_TOL_CM = 2.5
"""How far landmarks by proportion may lie from those of a shipped body, up or down."""
JOINT_TOL_CM, PLACE_TOL_CM = 4.0, 6.0


def obj_text(points, faces):
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
    return "\n".join([*lines, *("f " + " ".join(str(k + 1) for k in face) for face in faces), ""])


@pytest.fixture
def write(tmp_path):
    def write_body(points, faces, name="mine.obj"):
        (tmp_path / name).write_text(obj_text(points, faces))
        return tmp_path / name

    return write_body


@pytest.mark.parametrize("name", presets())
def test_landmarks_by_proportion_lie_near_those_of_a_shipped_body(name, write):
    body = load_body(name)
    again = load_body_file(write(body.vertices, body.faces))
    assert set(again.landmarks) <= set(body.landmarks)
    for key, place in again.landmarks.items():
        gap = np.abs(place - body.landmarks[key])
        assert gap[1] < (JOINT_TOL_CM if key.endswith("_joint") else LEVEL_TOL_CM), key
        assert np.linalg.norm(gap) < PLACE_TOL_CM or key == "crown", key


@pytest.mark.parametrize("pose", ["t", "a"])
def test_the_pose_is_recognised(pose, write):
    body = load_body("mean-male", pose)
    assert load_body_file(write(body.vertices, body.faces)).pose == pose


@pytest.mark.parametrize("size", [0.01, 0.1, 1, 10])
def test_any_unit_side_up_and_facing_gives_the_same_body(size, write):
    body = load_body()
    plain = load_body_file(write(body.vertices, body.faces))
    turned = body.vertices[:, [0, 2, 1]] * [1, -1, 1]  # z up, facing -y
    away = turned * [-1, -1, 1] + [30, 7, -90]  # facing +y, and not in the middle
    for points in (turned, away):
        again = load_body_file(write(points * size, body.faces[:, ::-1]))
        # Vertices are numbered by place, so shapes are compared.
        assert np.allclose(again.vertices.min(0), plain.vertices.min(0), atol=1e-2)
        assert np.allclose(again.vertices.max(0), plain.vertices.max(0), atol=1e-2)
        assert np.allclose(again.landmarks["crotch"], plain.landmarks["crotch"], atol=0.2)
        a, b, c = np.moveaxis(again.vertices[again.faces], 1, 0)
        assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0


def test_quads_and_other_formats_are_read(write, tmp_path):
    import trimesh

    body = load_body()
    mesh = trimesh.Trimesh(body.vertices, body.faces, process=False)
    for ending in ("ply", "stl", "glb"):
        mesh.export(tmp_path / f"mine.{ending}")
        again = load_body_file(tmp_path / f"mine.{ending}")
        assert len(again.vertices) == len(body.vertices)
    cells = [quad_of(body.faces[k], body.faces[k + 1]) for k in range(0, len(body.faces), 2)]
    if all(cells):
        assert len(load_body_file(write(body.vertices, cells)).faces) == len(body.faces)


def quad_of(first, second):
    """The quad of two triangles that share an edge, else nothing."""
    rest = set(second.tolist()) - set(first.tolist())
    if len(rest) != 1:
        return None
    shared = set(first.tolist()) & set(second.tolist())
    k = next(k for k in range(3) if first[k] not in shared)
    return [int(first[k]), int(first[(k + 1) % 3]), rest.pop(), int(first[(k + 2) % 3])]


def test_loose_parts_are_left_out_with_a_warning(write):
    body = load_body()
    eye = np.array([[0, 150, 0], [1, 150, 0], [0, 151, 0], [0, 150, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]) + len(body.vertices)
    path = write(np.vstack([body.vertices, eye]), np.vstack([body.faces, faces]))
    with pytest.warns(UserWarning, match="in 2 parts"):
        assert len(load_body_file(path).vertices) == len(body.vertices)


def bad_bodies():
    body = load_body()
    points, faces = body.vertices, body.faces
    broken = points.copy()
    broken[7] = np.nan
    mixed = faces.copy()
    mixed[::2] = mixed[::2, ::-1]
    yield "hole", points, faces[1:], "not watertight"
    yield "nan", broken, faces, "no numbers"
    yield "inside out in parts", points, mixed, "look in"
    yield "giant", points * 30, faces, "units high"
    yield "upside down", points * [1, -1, -1], faces, "on its feet"
    yield "sideways", points[:, [2, 1, 0]] * [1, 1, -1], faces, "faces sideways"
    yield "few", points[:4], np.array([[0, 1, 2]]), "triangles"


@pytest.mark.parametrize("case", list(bad_bodies()), ids=lambda case: case[0])
def test_what_is_no_body_is_refused_in_one_sentence(case, write):
    _, points, faces, message = case
    with pytest.raises(DraftError, match=message) as caught:
        load_body_file(write(points, faces))
    assert "\n" not in str(caught.value) and "mine.obj" in str(caught.value)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "glb", "txt"])
@pytest.mark.parametrize("content", [b"", b"hello there\n", b"\x00\xff\x80cos\nsystem\n" * 9])
def test_what_is_no_mesh_is_refused(ending, content, tmp_path):
    path = tmp_path / f"mine.{ending}"
    path.write_bytes(content)
    with pytest.raises(DraftError, match="mine"):
        load_body_file(path)


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(DraftError, match="no such file"):
        load_body_file(tmp_path / "none.obj")
    (tmp_path / "folder.obj").mkdir()
    with pytest.raises(DraftError, match="is a folder"):
        load_body_file(tmp_path / "folder.obj")


def test_no_other_file_is_opened(write, tmp_path):
    body = load_body()
    path = write(body.vertices, body.faces)
    (tmp_path / "trap.mtl").mkdir()  # Opening it would fail.
    path.write_text("mtllib trap.mtl\nusemtl trap\n" + path.read_text())
    assert len(load_body_file(path).vertices) == len(body.vertices)
