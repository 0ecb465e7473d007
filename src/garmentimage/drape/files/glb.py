"""A draped garment as GLB: for the web, and to be read again.

glTF wants metres, y up. Every panel is a mesh of its own, with smooth normals across the seams;
its UV is the flat pattern in true scale, so that one unit of UV is `UV_CM` of cloth. Vertices carry
`_VERTEX` (corners sewn together have the same number), `_EDGE` and `_SEAM` (-1: none) as floats,
the only numbers of that size that vertices may have. The scene's `extras.garmentimage` holds the
pattern and all else that a reader needs.
"""

import os
from collections.abc import Mapping
from io import BytesIO
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body import Body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.draped_garment import DrapedGarment, DrapeReport
from garmentimage.drape.files.vertex_attributes import (
    cloth_normals,
    corner_edges,
    corner_seams,
    seam_vertices,
)
from garmentimage.drape.mesh import peak_strain, rest_of
from garmentimage.errors import DrapeError, GarmentImageError
from garmentimage.pattern import Side
from garmentimage.pattern.files import pattern_to_spec, read_spec
from garmentimage.system import errors_about, read_limited, safe_name

SCHEMA = 1  # version of what `extras.garmentimage` holds
OURS = "garmentimage"
BODY = "body"  # name of the body's mesh; no panel's mesh has it
METRE = 100.0  # [cm]
UV_CM = 100.0  # cloth that one unit of UV stands for [cm]
MAX_FILE_BYTES = 200_000_000  # bytes of a file
MAX_OFFSET = 100.0  # nothing in a file lies farther off [m]
STRAIN_TOL = 0.01
"""What the cloth is stretched by and what its report says may differ by so much."""
CLOTH_COLOUR = (0.42, 0.52, 0.66, 1.0)
SKIN_COLOUR = (0.80, 0.66, 0.57, 1.0)


class _Damaged(Exception):
    """What is damaged in a file, as a clause."""


def mesh_names(cloth: Cloth) -> list[str]:
    """A name for every panel that all programs take, none of them that of the body."""
    names = [BODY]
    for panel in cloth.pattern.panels:
        names.append(safe_name(panel.name, names))
    return names[1:]


# --- Writing -------------------------------------------------------------------------------------


def glb_bytes(garment: DrapedGarment, *, body: bool = True) -> bytes:
    """The garment as GLB; the same bytes every time."""
    import trimesh

    scene: Any = trimesh.Scene()
    for number, name in enumerate(mesh_names(garment.cloth)):
        scene.add_geometry(_panel_mesh(garment, number), node_name=name, geom_name=name)
    if body:
        skin = _mesh(garment.body.vertices, garment.body.faces, SKIN_COLOUR)
        scene.add_geometry(skin, node_name=BODY, geom_name=BODY)
    scene.metadata[OURS] = _extras(garment)
    raw: bytes = scene.export(file_type="glb", include_normals=True)
    return raw


def _panel_mesh(garment: DrapedGarment, number: int) -> Any:
    cloth = garment.cloth
    corners = np.flatnonzero(cloth.panel == number)
    first = corners[0] if len(corners) else 0
    vertex = cloth.vertex[corners]
    mesh = _mesh(
        garment.points[vertex],
        cloth.faces[cloth.face_panel == number] - first,
        CLOTH_COLOUR,
        uv=cloth.flat[corners] / UV_CM,
        normals=cloth_normals(cloth, garment.points)[vertex],
    )
    columns = {"VERTEX": cloth.vertex, "EDGE": corner_edges(cloth), "SEAM": corner_seams(cloth)}
    for key, column in columns.items():
        mesh.vertex_attributes[f"_{key}"] = column[corners].astype(np.float32)
    return mesh


def _mesh(
    points: Float[np.ndarray, "n 3"],
    faces: Int[np.ndarray, "face 3"],
    colour: tuple[float, float, float, float],
    *,
    uv: Float[np.ndarray, "n 2"] | None = None,
    normals: Float[np.ndarray, "n 3"] | None = None,
) -> Any:
    import trimesh

    visuals: Any = trimesh.visual
    material = visuals.material.PBRMaterial(
        baseColorFactor=colour, metallicFactor=0.0, roughnessFactor=0.9, doubleSided=True
    )
    visual = visuals.TextureVisuals(uv=uv, material=material)
    return trimesh.Trimesh(
        points / METRE, faces, vertex_normals=normals, visual=visual, process=False
    )


def _extras(garment: DrapedGarment) -> dict[str, Any]:
    cloth, body, report = garment.cloth, garment.body, garment.report
    return {
        "schema": SCHEMA,
        "uv_cm": UV_CM,
        "panels": mesh_names(cloth),
        "name": cloth.pattern.name,
        "pattern": pattern_to_spec(cloth.pattern),
        "sides": [[s.panel, s.edge, corners.tolist()] for s, corners in cloth.sides.items()],
        "seams": [vertices.tolist() for vertices in seam_vertices(cloth)],
        "report": vars(report) | {"slid": dict(report.slid)},
        "body": {
            "name": body.name,
            "pose": body.pose,
            "landmarks": {key: place.tolist() for key, place in body.landmarks.items()},
        },
    }


# --- Reading -------------------------------------------------------------------------------------


def load_drape(path: str | os.PathLike[str]) -> DrapedGarment:
    """A draped garment from a GLB that `glb_bytes` made, body included; to 1e-4 cm.

    Raises:
        DrapeError: the file cannot be read, or does not hold a garment and a body of ours.
    """
    with errors_about(path):
        raw = read_limited(
            path, MAX_FILE_BYTES, DrapeError, kind="GLB file", too_large="drape with fewer vertices"
        )
        return read_glb(raw)


def read_glb(raw: bytes) -> DrapedGarment:
    """A draped garment from the bytes of a GLB.

    Raises:
        DrapeError: they do not hold a garment and a body of ours.
    """
    import trimesh

    try:
        # Without a resolver the reader cannot open any other file.
        scene = trimesh.load_scene(BytesIO(raw), file_type="glb", process=False)
    except Exception as error:
        # A damaged file can make the reader raise anything.
        raise DrapeError(f"is not a GLB that can be read ({type(error).__name__})") from error
    extras = scene.metadata.get(OURS)
    if not isinstance(extras, Mapping):
        raise DrapeError("holds no garment of garmentimage; drape a pattern to get one")
    if extras.get("schema") != SCHEMA:
        raise DrapeError(f"holds a garment of another version; only {SCHEMA} is read")
    if BODY not in scene.geometry:
        raise DrapeError("was written without its body; drape the pattern again with it")
    try:
        return _garment(scene.geometry, extras)
    except _Damaged as error:
        reason = str(error)
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, GarmentImageError):
        # Whatever unpacking raises where a value is missing or of another kind.
        reason = "a value is missing or of another type"
    raise DrapeError(f"holds a damaged garment ({reason}); drape the pattern again")


def _garment(geometry: Mapping[str, Any], extras: Mapping[str, Any]) -> DrapedGarment:
    panels = [geometry[name] for name in extras["panels"]]
    sizes = [len(mesh.vertices) for mesh in panels]
    first = np.cumsum([0, *sizes[:-1]])
    numbers = np.concatenate([mesh.vertex_attributes["_VERTEX"].ravel() for mesh in panels])
    corners = _near(np.concatenate([mesh.vertices for mesh in panels])) * METRE
    cloth = Cloth(
        pattern=read_spec(extras["pattern"], str(extras["name"]))[0],
        flat=_near(np.concatenate([mesh.visual.uv for mesh in panels])) * UV_CM,
        faces=np.concatenate([mesh.faces + k for mesh, k in zip(panels, first, strict=True)]),
        panel=np.repeat(np.arange(len(panels)), sizes),
        vertex=np.rint(numbers).astype(np.int64),
        sides=MappingProxyType({Side(p, int(k)): np.array(n, int) for p, k, n in extras["sides"]}),
    )
    _check(cloth)
    points, report = cloth.sewn(corners), _report(extras["report"])
    strain = peak_strain(rest_of(cloth), points)
    if abs(strain - report.strain) > STRAIN_TOL:
        raise _Damaged(
            f"its cloth is stretched by {strain:.2f}, its report says {report.strain:.2f}"
        )
    return DrapedGarment(cloth, points, _body(geometry[BODY], extras["body"]), report)


def _report(facts: Mapping[str, Any]) -> DrapeReport:
    """The report, every figure of its type."""
    counts: Any = {name: int(facts[name]) for name in ("frames", "crossings", "items")}
    numbers: Any = {
        name: float(facts[name]) for name in ("speed", "penetration", "strain", "held", "seconds")
    }
    slid = {str(place): float(far) for place, far in facts["slid"].items()}
    if not np.isfinite([*numbers.values(), *slid.values()]).all():
        raise _Damaged("its report has NaN or infinite values")
    return DrapeReport(
        settled=bool(facts["settled"]),
        slid=slid,
        faults=tuple(map(str, facts["faults"])),
        notes=tuple(map(str, facts.get("notes", ()))),
        **counts,
        **numbers,
    )


def _near(places: Any) -> Float[np.ndarray, "n k"]:
    """Places [m], none of them farther off than a garment and its wearer can be."""
    checked: np.ndarray = np.asarray(places, float)
    if not (np.abs(checked) <= MAX_OFFSET).all():
        raise _Damaged(f"a vertex lies more than {MAX_OFFSET:g} m away, or is not a number")
    return checked


def _check(cloth: Cloth) -> None:
    """Refuse numbers that refer to nothing."""
    count = len(cloth.flat)
    edges = {panel.name: len(panel.edges) for panel in cloth.pattern.panels}
    corners = np.concatenate([cloth.faces.ravel(), *cloth.sides.values()])
    if not len(cloth.faces):
        raise _Damaged("it has no triangles")
    if corners.min() < 0 or corners.max() >= count:
        raise _Damaged(f"a triangle or an edge refers to a corner beyond its {count}")
    if cloth.panel.max() >= len(edges):
        raise _Damaged(f"it has more meshes than the {len(edges)} panels of its pattern")
    if any(side.edge >= edges[side.panel] for side in cloth.sides):
        raise _Damaged("it lists an edge that its pattern does not have")
    if set(cloth.pattern.partners) - set(cloth.sides):
        raise _Damaged("a sewn edge of its pattern has no corners")
    # Every vertex from 0 to the last has a corner, so that none is without a place.
    last = cloth.vertex.max()
    if last >= count or not np.array_equal(np.unique(cloth.vertex), np.arange(last + 1)):
        raise _Damaged("its vertices are not numbered from 0 without gaps")


def _body(mesh: Any, facts: Mapping[str, Any]) -> Body:
    """The wearer, with its landmarks."""
    places = {str(key): np.array(place, float) for key, place in facts["landmarks"].items()}
    if any(place.shape != (3,) for place in places.values()):
        raise _Damaged("a landmark of its body does not have three coordinates")
    if not all(np.isfinite(place).all() for place in places.values()):
        raise _Damaged("a landmark of its body is not finite")
    vertices, faces = _near(mesh.vertices) * METRE, np.asarray(mesh.faces, np.int32)
    if not len(faces) or faces.min() < 0 or faces.max() >= len(vertices):
        raise _Damaged("its body has no triangles, or they refer to vertices that it does not have")
    return Body(vertices, faces, str(facts["name"]), str(facts["pose"]), MappingProxyType(places))
