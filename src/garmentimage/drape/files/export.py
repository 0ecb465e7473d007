"""A draped garment as a file for other programs: GLB, OBJ or PLY.

Every format keeps the panels apart, closes the seams, carries the flat pattern in true scale as
texture coordinates, and says which edge and which stitch a vertex lies on:

| | GLB | OBJ | PLY |
|---|---|---|---|
| unit of length | m | cm | cm |
| panels | one mesh each | groups | vertex property `panel` |
| flat pattern | UV, 1 = 1 m of cloth | `vt` in cm | `flat_x`, `flat_y` in cm |
| seams | same `_VERTEX`, `_SEAM` | shared vertices, comments | same `vertex`, `seam` |
| edges | `_EDGE`, `extras` | comments | `edge` |
| body | node `body` | group `body` | - |

y is up in all of them. Only a GLB holds all that there is, and can be read again (`glb`).
"""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float

from garmentimage.drape.cloth import Cloth
from garmentimage.drape.draped_garment import DrapedGarment
from garmentimage.drape.files.glb import BODY, glb_bytes, mesh_names
from garmentimage.drape.files.vertex_attributes import (
    cloth_normals,
    corner_edges,
    corner_seams,
    seam_vertices,
)
from garmentimage.errors import OutputError, check_type, quoted
from garmentimage.system import write_atomically

DRAPE_FORMATS = (".glb", ".obj", ".ply")  # endings of files that a draped garment can be written to


def save_drape(path: str | os.PathLike[str], garment: DrapedGarment, *, body: bool = True) -> None:
    """Write a draped garment as `.glb`, `.obj` or `.ply`; a PLY never holds the body.

    Raises:
        OutputError: another ending, or a file that cannot be written.
        TypeError: it is not a DrapedGarment.
    """
    check_type(garment, DrapedGarment, "garmentimage.drape_pattern makes one")
    write_atomically(path, drape_bytes(garment, Path(path).suffix, body=body))


def drape_bytes(garment: DrapedGarment, ending: str, *, body: bool = True) -> bytes | str:
    """What `save_drape` writes to a file with this ending.

    Raises:
        OutputError: the ending is none of `DRAPE_FORMATS`.
    """
    match ending.lower():
        case ".glb":
            return glb_bytes(garment, body=body)
        case ".obj":
            return obj_text(garment, body=body)
        case ".ply":
            return ply_bytes(garment)
    known = ", ".join(DRAPE_FORMATS)
    raise OutputError(f"a garment cannot be written as {quoted(ending)}; choose {known}")


def obj_text(garment: DrapedGarment, *, body: bool = True) -> str:
    """The sewn garment as OBJ: panels as groups, `vt` the flat pattern [cm], positions in cm."""
    return "\n".join([*_obj_lines(garment, body=body), ""])


def _obj_lines(garment: DrapedGarment, *, body: bool) -> Iterator[str]:
    cloth = garment.cloth
    yield "# Lengths are cm, y is up; vt is the flat pattern in cm. Vertices count from 1."
    yield from _rows("v", garment.points)
    yield from _rows("vt", cloth.flat)
    yield from _rows("vn", cloth_normals(cloth, garment.points))
    names = mesh_names(cloth)
    where = dict(zip((panel.name for panel in cloth.pattern.panels), names, strict=True))
    for side, corners in cloth.sides.items():
        numbers = " ".join(str(v + 1) for v in cloth.vertex[corners])
        yield f"# edge {where[side.panel]} {side.edge}: {numbers}"
    for stitch, vertices in zip(cloth.pattern.stitches, seam_vertices(cloth), strict=True):
        ends = " to ".join(f"{where[side.panel]} {side.edge}" for side in stitch.sides)
        yield f"# stitch {ends}: {' '.join(str(v + 1) for v in vertices)}"
    for number, name in enumerate(names):
        yield f"g {name}"
        for face in cloth.faces[cloth.face_panel == number]:
            yield "f " + " ".join(
                f"{v}/{c + 1}/{v}" for c, v in zip(face, cloth.vertex[face] + 1, strict=True)
            )
    if body:
        yield from _rows("v", garment.body.vertices)
        yield f"g {BODY}"
        first = len(garment.points) + 1
        yield from (f"f {a} {b} {c}" for a, b, c in (garment.body.faces + first).tolist())


def _rows(word: str, rows: Float[np.ndarray, "n axis"]) -> Iterator[str]:
    # Six decimals of a cm are more than any program uses, and a sum of zeros never reads "-0".
    return (
        f"{word} " + " ".join(f"{x:.6f}" for x in row) for row in (rows.round(6) + 0.0).tolist()
    )


def ply_bytes(garment: DrapedGarment) -> bytes:
    """The garment as binary PLY: one mesh whose vertices are the corners of the panels [cm]."""
    cloth = garment.cloth
    columns: dict[str, np.ndarray] = {
        **{axis: garment.points[cloth.vertex, k] for k, axis in enumerate("xyz")},
        **{f"flat_{axis}": cloth.flat[:, k] for k, axis in enumerate("xy")},
        "panel": cloth.panel,
        "vertex": cloth.vertex,
        "edge": corner_edges(cloth),
        "seam": corner_seams(cloth),
    }
    kinds = {name: "<f4" if column.dtype.kind == "f" else "<i4" for name, column in columns.items()}
    vertices = np.empty(len(cloth.flat), list(kinds.items()))
    for name, column in columns.items():
        vertices[name] = column
    faces = np.empty(len(cloth.faces), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, cloth.faces
    return (
        _ply_header(cloth, kinds, len(vertices), len(faces)) + vertices.tobytes() + faces.tobytes()
    )


def _ply_header(cloth: Cloth, kinds: dict[str, str], vertices: int, faces: int) -> bytes:
    words = {"<f4": "float", "<i4": "int"}
    lines = [
        "ply",
        "format binary_little_endian 1.0",
        "comment lengths are cm, y is up; -1 stands for none",
        *(f"comment panel {k} {name}" for k, name in enumerate(mesh_names(cloth))),
        f"element vertex {vertices}",
        *(f"property {words[kind]} {name}" for name, kind in kinds.items()),
        f"element face {faces}",
        "property list uchar int vertex_indices",
        "end_header",
    ]
    return ("\n".join(lines) + "\n").encode("utf-8")
