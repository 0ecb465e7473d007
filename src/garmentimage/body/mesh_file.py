"""A body of one's own, from a mesh file: checked, stood upright, and marked.

OBJ, PLY, STL and GLB are read, in m, dm, cm, mm, feet or inches, any side up (`upright`). Small
faults of the surface are mended (`mend`). Nothing beside the file is opened.
"""

import os
import warnings
from io import BytesIO
from pathlib import Path
from types import MappingProxyType

import numpy as np
from jaxtyping import Int

from garmentimage.body.body import Body, Points3
from garmentimage.body.landmarks import mark, trunk_section
from garmentimage.body.mend import SMALL_PART, Faces, OpenSurface, parts, size, united, welded
from garmentimage.body.upright import ADULT, upright
from garmentimage.errors import DraftError
from garmentimage.system import errors_about, read_limited

MESH_FORMATS = ("obj", "ply", "stl", "glb")  # endings of files that are read
MAX_FILE_BYTES = 100_000_000
FACE_RANGE = (500, 400_000)
"""Triangles of a body: with fewer there is no shape, more only cost time."""
HOLE, SOLE = 0.1, 0.2
"""Holes up to this size are closed, as shares of the stature: eyes, mouths, cut fingers; and soles
on the floor."""
AT_END, TOP_HOLE = 0.03, 0.04
"""Within this share of the stature from the top no hole may be larger than the second share: the
head is missing."""
ANKLES, FOOT_LENGTH = 0.05, 0.1
"""Below the first share of the stature, feet are at least as long as the second."""
NECK, HEAD_WIDTH = 0.9, 0.25
"""Above the first share of the stature, a body is at most as wide as the second."""
LEGS_END = 0.3
"""Below this share of the stature nothing of a standing body is in its middle."""
STRAIGHT_ARM = np.deg2rad(22.5)
"""Arms that hang down less than this are stretched out: pose `t`; else it is `a`."""


def load_body_file(path: str | os.PathLike[str]) -> Body:
    """A body from a mesh file.

    The body must stand in the T pose or the A pose, legs apart. It is scaled to cm, turned to y up
    and to face +z by its feet, and put on the floor. Small holes are closed, and loose parts (eyes,
    lashes) left out with a warning. Landmarks come from the proportions of adults; see `landmarks`.

    Raises:
        DraftError: the file cannot be read, or is not such a body.
    """
    with errors_about(path):
        used = _joined(*_read(path))
        points, faces = united(used)
        rims = used[0].rims
        for rim in rims:
            if size(points[rim]) > SOLE * np.ptp(points, axis=0).max():
                raise _open_at(points, rim)
        standing = upright(points, faces)
        _check_rims(points, standing, rims)
        return _body(standing, faces, Path(path).stem)


def _read(path: str | os.PathLike[str]) -> tuple[Points3, Faces]:
    """Points in the file's units and the triangles between them."""
    import trimesh

    ending = Path(path).suffix.lower().removeprefix(".")
    if ending not in MESH_FORMATS:
        raise DraftError(f"is not a mesh file; give one of {', '.join(MESH_FORMATS)}")
    raw = read_limited(
        path, MAX_FILE_BYTES, DraftError, kind="mesh file", too_large="export a coarser body"
    )
    if not raw.strip():
        raise DraftError("is empty; export the body again")
    try:
        # Without a resolver the reader cannot open any other file.
        mesh = trimesh.load_mesh(BytesIO(raw), file_type=ending, process=False)
        points, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    except Exception as error:
        # A damaged file can make the readers raise anything.
        raise DraftError(
            f"is not a mesh that can be read as {ending.upper()} ({type(error).__name__}); "
            "export it again"
        ) from error
    low, high = FACE_RANGE
    if not low <= len(faces) <= high:
        raise DraftError(f"has {len(faces)} triangles; a body has {low} to {high}")
    if not np.isfinite(points).all() or faces.min() < 0 or faces.max() >= len(points):
        raise DraftError(
            "has coordinates that are not finite, or triangles without vertices; export it again"
        )
    return points, faces


def _joined(points: Points3, faces: Faces) -> list[OpenSurface]:
    """The parts of a body that are used; what is small beside it, as eyes are, is left out.

    Of parts that are open, only the largest is kept, whose holes can be recognised then.
    """
    surface = welded(points, faces)
    if not len(surface.faces):
        raise DraftError("has no triangles with an extent; export it again")
    every = parts(surface)
    least = SMALL_PART * size(every[0].points)
    kept = every[:1] + [p for p in every[1:] if size(p.points) >= least and not p.rims]
    if len(kept) < len(every):
        count, whole = sum(len(p.faces) for p in kept), len(surface.faces)
        used = "only the largest is" if len(kept) == 1 else f"the {len(kept)} that are large are"
        warnings.warn(
            f"the body is in {len(every)} parts; {used} used ({count} of {whole} triangles)",
            stacklevel=3,
        )
    return kept


def _check_rims(points: Points3, standing: Points3, rims: list[Int[np.ndarray, " _"]]) -> None:
    """Refuse holes that no cap can stand for; `standing` are the points as they stand [cm]."""
    stature = float(standing[:, 1].max())
    for rim in rims:
        low, high = standing[rim, 1].min() / stature, standing[rim, 1].max() / stature
        across = size(standing[rim]) / stature
        if across > (SOLE if high < AT_END else HOLE) or (low > 1 - AT_END and across > TOP_HOLE):
            raise _open_at(points, rim)


def _open_at(points: Points3, rim: Int[np.ndarray, " corner"]) -> DraftError:
    place = ", ".join(f"{x:.3g}" for x in (points[rim].min(0) + points[rim].max(0)) / 2)
    return DraftError(
        f"is open: a hole {size(points[rim]):.3g} units across lies at ({place}) in the file's "
        "coordinates, so that the body has no inside; close it, or export the whole body"
    )


def _body(points: Points3, faces: Faces, name: str) -> Body:
    """The body with its landmarks, z = 0 halfway through its waist."""
    _check_ends(points)
    bare = Body(points, faces.astype(np.int32), name, "t", {})
    lowest = float(trunk_section(bare)[:, 1].min())
    if lowest < LEGS_END * points[:, 1].max():
        raise DraftError(
            f"is closed down to {lowest:.0f} cm over the floor in its middle (x = 0); "
            "stand it on its feet, legs apart, alike on both sides"
        )
    if points[:, 1].max() < ADULT:
        warnings.warn(
            f"the body is {points[:, 1].max():.0f} cm high; its neck, shoulders and waist are "
            "looked for where an adult has them, which is too low on a child",
            stacklevel=3,
        )
    place, middle = mark(bare)
    shift = np.array([0.0, 0.0, middle])
    points = points - shift
    place = {key: point - shift for key, point in place.items()}
    for array in (points, bare.faces, *place.values()):
        array.setflags(write=False)
    across, down, _ = place["left_wrist_joint"] - place["left_shoulder_joint"]
    pose = "t" if -down < np.tan(STRAIGHT_ARM) * across else "a"
    return Body(points, bare.faces, name, pose, MappingProxyType(place))


def _check_ends(points: Points3) -> None:
    """Refuse a body without feet or head: all its heights would be wrong."""
    stature = points[:, 1].max()
    if np.ptp(points[points[:, 1] < ANKLES * stature, 2]) < FOOT_LENGTH * stature:
        raise DraftError("has no feet, so that its heights are unknown; export the whole body")
    if np.ptp(points[points[:, 1] > NECK * stature, 0]) > HEAD_WIDTH * stature:
        raise DraftError(
            "has no head, or lifts its arms above it; export the whole body in the T or the A pose"
        )
