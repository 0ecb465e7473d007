"""A worn garment in files of other programs: nothing is lost, and nothing else gets in."""

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest

from garmentimage.body.body import load_body
from garmentimage.draft.kind import draft_pattern
from garmentimage.drape.draped_garment import DrapedGarment, DrapeReport
from garmentimage.drape.files.export import obj_text, ply_bytes, save_drape
from garmentimage.drape.files.glb import UV_CM, glb_bytes, load_drape, mesh_names, read_glb
from garmentimage.drape.files.vertex_attributes import cloth_normals, corner_edges, corner_seams
from garmentimage.drape.mesh.meshing import mesh
from garmentimage.drape.mesh.rest import peak_strain, rest_of
from garmentimage.errors import DrapeError, OutputError

GLB_TOL_CM = 1e-4
"""GLB holds 32-bit floats."""
PLY_TOL_CM = 1e-4
REPORT = DrapeReport(
    settled=True,
    frames=60,
    speed=0.5,
    penetration=0.0,
    strain=0.1,
    slid={"shoulders": 0.5},
    crossings=0,
    held=0.0,
    items=1,
    faults=("a sentence",),
    seconds=0.3,
)


@pytest.fixture(scope="module", params=["tee", "pants"])
def worn(request):
    """A garment put round the body without simulation."""
    pattern = draft_pattern(request.param)
    cloth = mesh(pattern, vertices=500)
    corners = np.concatenate(
        [p.to_world(cloth.flat[cloth.panel == k]) for k, p in enumerate(pattern.panels)]
    )
    points = cloth.sewn(corners)
    report = replace(REPORT, strain=peak_strain(rest_of(cloth), points))
    return DrapedGarment(cloth, points, load_body(), report)


def renamed(worn, names):
    """The same garment with other names for its panels."""
    old = [panel.name for panel in worn.cloth.pattern.panels]
    new = dict(zip(old, [*names, *old[len(names) :]], strict=True))
    pattern = worn.cloth.pattern
    sides = {replace(s, panel=new[s.panel]): c for s, c in worn.cloth.sides.items()}
    stitches = tuple(
        replace(s, a=replace(s.a, panel=new[s.a.panel]), b=replace(s.b, panel=new[s.b.panel]))
        for s in pattern.stitches
    )
    panels = tuple(replace(p, name=new[p.name]) for p in pattern.panels)
    return replace(
        worn,
        cloth=replace(
            worn.cloth, pattern=replace(pattern, panels=panels, stitches=stitches), sides=sides
        ),
    )


def same(a, b):
    """Whether two worn garments are the same up to rounding."""
    return (
        a.cloth.pattern == b.cloth.pattern
        and a.cloth.pattern.name == b.cloth.pattern.name
        and a.report == b.report
        and a.cloth.sides.keys() == b.cloth.sides.keys()
        and all(np.array_equal(a.cloth.sides[s], b.cloth.sides[s]) for s in a.cloth.sides)
        and all(
            np.array_equal(getattr(a.cloth, name), getattr(b.cloth, name))
            for name in ("faces", "panel", "vertex")
        )
        and np.allclose(a.cloth.flat, b.cloth.flat, rtol=0, atol=GLB_TOL_CM)
        and np.allclose(a.points, b.points, rtol=0, atol=GLB_TOL_CM)
        and np.allclose(a.body.vertices, b.body.vertices, rtol=0, atol=GLB_TOL_CM)
        and np.array_equal(a.body.faces, b.body.faces)
        and (a.body.name, a.body.pose) == (b.body.name, b.body.pose)
        and all(np.array_equal(a.body.landmarks[k], b.body.landmarks[k]) for k in b.body.landmarks)
    )


def test_reading_a_glb_gives_the_garment_back(worn, tmp_path):
    save_drape(tmp_path / "worn.glb", worn)
    assert same(load_drape(tmp_path / "worn.glb"), worn)


def test_writing_what_was_read_gives_the_same_numbers(worn):
    again = read_glb(glb_bytes(worn))
    assert same(read_glb(glb_bytes(again)), again)


@pytest.mark.parametrize("write", [glb_bytes, obj_text, ply_bytes])
def test_the_same_garment_gives_the_same_bytes(write, worn):
    assert write(worn) == write(worn)


def test_any_names_of_panels_survive_a_glb(worn):
    odd = renamed(worn, ["body", "../a b\n", "ÄÖ", "../a b "])
    assert len(set(mesh_names(odd.cloth))) == len(odd.cloth.pattern.panels)
    assert same(read_glb(glb_bytes(odd)), odd)


def test_panels_of_a_glb_are_meshes_in_metres_with_true_texture_coordinates(worn, tmp_path):
    import trimesh

    save_drape(tmp_path / "worn.glb", worn)
    scene = trimesh.load_scene(tmp_path / "worn.glb", process=False)
    assert set(scene.geometry) == {*mesh_names(worn.cloth), "body"}
    for panel in worn.cloth.pattern.panels:
        part = scene.geometry[panel.name]
        a, b, c = np.moveaxis(part.visual.uv[part.faces] * UV_CM, 1, 0)
        (ux, uy), (vx, vy) = (b - a).T, (c - a).T
        area = sum(loop.area for loop in panel.loops)
        assert (ux * vy - uy * vx).sum() / 2 == pytest.approx(area, rel=0.02)
    assert scene.geometry["body"].extents[1] == pytest.approx(1.66, abs=0.01)


def test_normals_are_smooth_across_seams_and_units(worn):
    normals = cloth_normals(worn.cloth, worn.points)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1)
    front = worn.cloth.panel[worn.cloth.faces[:, 0]] == 0
    face = worn.cloth.vertex_faces[front]
    a, b, c = np.moveaxis(worn.points[face], 1, 0)
    agree = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals[face[:, 0]])
    assert (agree > 0).mean() > 0.95


def test_every_sewn_corner_knows_its_edge_and_its_seam(worn):
    edges, seams = corner_edges(worn.cloth), corner_seams(worn.cloth)
    on_edge = np.zeros(len(edges), bool)
    sewn = np.zeros(len(edges), bool)
    for side, corners in worn.cloth.sides.items():
        on_edge[corners] = True
        sewn[corners] |= side in worn.cloth.pattern.partners
    assert np.array_equal(edges >= 0, on_edge)
    assert np.array_equal(seams >= 0, sewn)


def parsed(text):
    rows = {"v": [], "vt": [], "vn": [], "g": [], "f": []}
    for line in text.splitlines():
        word, _, rest = line.partition(" ")
        if word in rows:
            rows[word].append(rest.split())
    return rows


def test_an_obj_holds_one_closed_mesh_and_the_flat_pattern_in_cm(worn):
    rows = parsed(obj_text(worn, body=False))
    faces = np.array([[corner.split("/") for corner in face] for face in rows["f"]], int) - 1
    order = np.argsort(worn.cloth.face_panel, kind="stable")
    assert np.array_equal(faces[..., 0], worn.cloth.vertex_faces[order])
    assert np.array_equal(faces[..., 1], worn.cloth.faces[order])
    assert np.allclose(np.array(rows["v"], float), worn.points, atol=1e-6)
    assert np.allclose(np.array(rows["vt"], float), worn.cloth.flat, atol=1e-6)
    assert [name for (name,) in rows["g"]] == mesh_names(worn.cloth)


def test_an_obj_with_its_body_is_read_by_others(worn, tmp_path):
    import trimesh

    save_drape(tmp_path / "worn.obj", worn)
    mesh_read = trimesh.load_mesh(tmp_path / "worn.obj", process=False)
    assert len(mesh_read.faces) == len(worn.cloth.faces) + len(worn.body.faces)


def test_names_cannot_break_the_lines_of_a_text_file(worn):
    odd = renamed(worn, ["x\nf 1 2 3\n", "a b#"])
    assert len(parsed(obj_text(odd))["f"]) == len(parsed(obj_text(worn))["f"])
    assert ply_bytes(odd).count(b"\ncomment panel") == len(worn.cloth.pattern.panels)


def test_a_ply_holds_panel_and_flat_place_of_every_corner(worn, tmp_path):
    import trimesh

    save_drape(tmp_path / "worn.ply", worn)
    read = trimesh.load_mesh(tmp_path / "worn.ply", process=False)
    data = read.metadata["_ply_raw"]["vertex"]["data"]
    assert np.array_equal(read.faces, worn.cloth.faces)
    assert np.array_equal(data["panel"].ravel(), worn.cloth.panel)
    assert np.array_equal(data["vertex"].ravel(), worn.cloth.vertex)
    flat = np.stack([data["flat_x"].ravel(), data["flat_y"].ravel()], axis=1)
    assert np.allclose(flat, worn.cloth.flat, atol=PLY_TOL_CM)
    assert np.allclose(read.vertices, worn.points[worn.cloth.vertex], atol=PLY_TOL_CM)


def test_other_endings_and_missing_folders_are_refused(worn, tmp_path):
    with pytest.raises(OutputError, match=r"choose \.glb, \.obj, \.ply"):
        save_drape(tmp_path / "worn.fbx", worn)
    with pytest.raises(OutputError, match="no folder"):
        save_drape(tmp_path / "none" / "worn.obj", worn)


def test_what_is_not_a_garment_is_refused_in_one_sentence(worn, tmp_path):
    import trimesh

    raw = glb_bytes(worn)
    ball = trimesh.Scene(trimesh.creation.icosphere()).export(file_type="glb")
    cases = {
        "not a GLB": (b"", b"glTF", raw[:3000], b"{}" * 40),
        "no garment": (ball,),
        "without its body": (glb_bytes(worn, body=False),),
        "another version": (raw.replace(b'"schema":1', b'"schema":9'),),
        "damaged": (raw.replace(b'"sides"', b'"sidez"'), raw.replace(b"_VERTEX", b"_VERTEZ")),
    }
    for message, files in cases.items():
        for k, data in enumerate(files):
            path = tmp_path / f"{k}.glb"
            path.write_bytes(data)
            with pytest.raises(DrapeError, match=message) as caught:
                load_drape(path)
            assert "\n" not in str(caught.value)
    with pytest.raises(DrapeError, match="there is no such file"):
        load_drape(tmp_path / "none.glb")
    with pytest.raises(DrapeError, match="is a folder"):
        load_drape(tmp_path)


def damaged(worn, **parts):
    """The garment as it would come from a file in which some numbers are others."""
    import trimesh

    scene = trimesh.load_scene(BytesIO(glb_bytes(worn)), file_type="glb", process=False)
    names = scene.metadata["garmentimage"]["panels"]
    for key, value in parts.items():
        first, skin = scene.geometry[names[0]], scene.geometry["body"]
        match key:
            case "uv":
                first.visual.uv[0] = value
            case "place":
                first.vertices[0] = value
            case "all_places":
                for name in names:
                    scene.geometry[name].vertices[:] = value
            case "vertex":
                numbers = first.vertex_attributes["_VERTEX"].copy()
                numbers[0] = value
                first.vertex_attributes["_VERTEX"] = numbers
            case "skin":
                skin.vertices[0] = value
            case _:
                scene.metadata["garmentimage"]["report"][key] = value
    return scene.export(file_type="glb", include_normals=True)


@pytest.mark.parametrize(
    "parts",
    [
        {"uv": np.nan},
        {"uv": 1e30},
        {"place": 1e30},
        {"all_places": 0.0},
        {"vertex": 1e9},
        {"skin": 1e6},
        {"slid": None},
        {"frames": "zz"},
        {"strain": None},
        {"faults": None},
        {"speed": "nan"},
    ],
)
def test_numbers_that_stand_for_nothing_are_refused(worn, parts):
    read_glb(damaged(worn))
    with pytest.raises(DrapeError, match="damaged garment"):
        read_glb(damaged(worn, **parts))
