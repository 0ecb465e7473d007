"""Bodies of one's own: any unit, any side up; what is not a body is refused in one sentence."""

import numpy as np
import pytest

from garmentimage.body.body import load_body
from garmentimage.body.body_measurements import presets
from garmentimage.body.mend import capped, parts, welded
from garmentimage.body.mesh_file import load_body_file
from garmentimage.drape.solver.distance_field import body_field, surface_distance
from garmentimage.errors import DraftError
from tests.corpus import unpacked

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


@pytest.mark.parametrize("size", [0.01, 0.1, 1 / 2.54, 1 / 30.48, 1, 10])
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


def turn(axis, degrees):
    """Matrix of a turn about a file axis."""
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    matrix, angle = np.eye(3), np.deg2rad(degrees)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[i, j], matrix[j, i] = -np.sin(angle), np.sin(angle)
    return matrix


TURNS = {
    "facing +x": (1, 90, ""),
    "facing -x": (1, -90, ""),
    "half left": (1, 45, ""),
    "x up": (2, 90, "on its head"),
    "upside down": (2, 180, "on its head"),
    "leaning forward": (0, 10, "leans by 10 degrees"),
    "leaning aside": (2, 10, "leans by 10 degrees"),
}


@pytest.mark.parametrize("case", TURNS.values(), ids=TURNS)
def test_a_body_turned_in_its_file_is_turned_back(case, write):
    axis, degrees, message = case
    body = load_body()
    points = body.vertices @ turn(axis, degrees).T
    if message:
        with pytest.warns(UserWarning, match=message):
            again = load_body_file(write(points, body.faces))
    else:
        again = load_body_file(write(points, body.faces))
    plain = load_body_file(write(body.vertices, body.faces))
    for key, place in plain.landmarks.items():
        assert np.linalg.norm(again.landmarks[key] - place) < 1.0, key


def test_loose_parts_are_left_out_with_a_warning(write):
    body = load_body()
    eye = np.array([[0, 150, 0], [1, 150, 0], [0, 151, 0], [0, 150, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]) + len(body.vertices)
    path = write(np.vstack([body.vertices, eye]), np.vstack([body.faces, faces]))
    with pytest.warns(UserWarning, match="in 2 parts"):
        assert len(load_body_file(path).vertices) == len(body.vertices)


def test_parts_that_pass_through_each_other_are_one_body(write):
    """Head, hands and trunk are often meshes of their own, each closed."""
    body = load_body()
    above, below = cut_off(body, 140.0, 1), cut_off(body, 143.0, -1)
    first = len(above[0])
    with pytest.raises(DraftError, match="has no head"):
        load_body_file(write(*below))
    both = np.vstack([above[0], below[0]]), np.vstack([above[1], below[1] + first])
    again = load_body_file(write(*both))
    assert np.ptp(again.vertices[:, 1]) == pytest.approx(np.ptp(body.vertices[:, 1]))
    assert body_field(again).at(np.array([[0, 141.5, -2.0]])) < 0


def cut_off(body, height, way):
    """The closed part of a body above (1) or below (-1) a height."""
    kept = (body.vertices[:, 1] * way > height * way)[body.faces].all(1)
    part = parts(welded(body.vertices, body.faces[kept]))[0]
    return capped(part)


def faulty_bodies():
    body = load_body()
    points, faces = body.vertices, body.faces
    eyes = np.hypot(np.abs(points[:, 0]) - 3.2, points[:, 1] - 155) < 1.2
    mixed = faces.copy()
    mixed[::2] = mixed[::2, ::-1]
    soup = points[faces].reshape(-1, 3)
    noise = np.random.default_rng(0).normal(0, 1e-3, soup.shape)
    own = np.arange(len(soup)).reshape(-1, 3)
    yield "rounded to mm", np.round(points, 1), faces
    yield "rounded to cm", np.round(points), faces
    yield "one triangle missing", points, faces[1:]
    yield "eyes open", points, faces[~(eyes & (points[:, 2] > 5))[faces].any(1)]
    yield "finger tips cut off", points, faces[(np.abs(points[:, 0]) < 81)[faces].all(1)]
    yield "inside out in parts", points, mixed
    yield "two sides", points, np.vstack([faces, faces[:, ::-1]])
    yield "no triangle shares a vertex", soup + noise, own


@pytest.mark.parametrize("case", list(faulty_bodies()), ids=lambda case: case[0])
def test_small_faults_of_a_surface_are_mended(case, write):
    name, points, faces = case
    body = load_body()
    again, plain = load_body_file(write(points, faces)), load_body_file(write(*surface(body)))
    field, right = body_field(again), body_field(plain)
    places = np.random.default_rng(1).uniform([-60, 5, -12], [60, 160, 12], (4000, 3))
    gap = np.abs(field.at(places) - right.at(places))
    assert np.percentile(gap, 99) < (0.6 if "cm" in name else 0.2), name
    assert ((field.at(places) < 0) != (right.at(places) < 0)).mean() < 0.01


def surface(body):
    return body.vertices, body.faces


def test_lips_that_lie_on_each_other_leave_no_hole_inside():
    """Vertices of two closed parts in one place: the winding number decides inside."""
    box = np.array([[x, y, z] for x in (0, 9) for y in (0, 9) for z in (0, 9.0)])
    corners = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([f for a, b, c, d in corners for f in ((a, b, c), (a, c, d))])
    above = box + np.array([0, 9, 0])
    touching = surface_distance(np.vstack([box, above]), np.vstack([faces, faces + 8]))
    inside = touching.at(np.array([[4.5, 4.5, 4.5], [4.5, 13.5, 4.5], [4.5, 22.5, 4.5]])) < 0
    assert inside.tolist() == [True, True, False]


def bad_bodies():
    body = load_body()
    points, faces = body.vertices, body.faces
    broken = points.copy()
    broken[7] = np.nan
    x, y = np.meshgrid(np.linspace(-60, 60, 30), np.linspace(0, 166, 40))
    sheet = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    at = np.arange(len(sheet)).reshape(x.shape)
    left = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:]], axis=-1).reshape(-1, 3)
    right = np.stack([at[:-1, :-1], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 3)
    low, high = points[:, 1] < 95, points[:, 1] > 7
    yield "flat sheet", sheet, np.vstack([left, right]), "is open: a hole 205 units across"
    yield "legs only", points, faces[low[faces].all(1)], "is open: a hole 39.* units across"
    yield "head missing", points, faces[(points[:, 1] < 143)[faces].all(1)], "is open"
    yield "feet missing", points, faces[high[faces].all(1)], "has no feet"
    yield "nan", broken, faces, "not finite"
    yield "giant", points * 30, faces, "units high"
    yield "lying", points @ turn(0, 40).T, faces, "leans by 40 degrees"
    yield "few", points[:4], np.array([[0, 1, 2]]), "triangles"


@pytest.mark.parametrize("case", list(bad_bodies()), ids=lambda case: case[0])
def test_what_is_not_a_body_is_refused_in_one_sentence(case, write):
    _, points, faces, message = case
    with pytest.raises(DraftError, match=message) as caught:
        load_body_file(write(points, faces))
    assert "\n" not in str(caught.value) and "mine.obj" in str(caught.value)


def test_a_child_is_taken_with_a_warning(write):
    body = load_body()
    with pytest.warns(UserWarning, match="110 cm high"):
        again = load_body_file(write(body.vertices * 110 / np.ptp(body.vertices[:, 1]), body.faces))
    assert np.ptp(again.vertices[:, 1]) == pytest.approx(110)


@pytest.mark.corpus
@pytest.mark.parametrize("name", ["body-rounded-3/rounded_mm.obj", "body-smplx-eyes/open_eyes.obj"])
@pytest.mark.filterwarnings("ignore:the body is in 3 parts")
def test_bodies_as_others_save_them_are_taken(name, tmp_path):
    folder = unpacked("faults/faults.tar.xz", tmp_path)
    body = load_body_file(next(folder.rglob(name)))
    assert np.ptp(body.vertices[:, 1]) == pytest.approx(166, abs=1)


@pytest.mark.parametrize("ending", ["obj", "ply", "stl", "glb", "txt"])
@pytest.mark.parametrize("content", [b"", b"hello there\n", b"\x00\xff\x80cos\nsystem\n" * 9])
def test_what_is_not_a_mesh_is_refused(ending, content, tmp_path):
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
