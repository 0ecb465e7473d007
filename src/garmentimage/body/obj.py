"""A body of one's own, from a mesh file: checked, stood upright, and marked.

OBJ, PLY, STL and GLB are read, in metres, decimetres, centimetres or millimetres, with y or z up.
Nothing beside the file is opened: textures and materials do not matter here.
"""

import os
import warnings
from io import BytesIO
from pathlib import Path
from types import MappingProxyType

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body.body import Body
from garmentimage.body.marks import mark, trunk_section
from garmentimage.errors import DraftError
from garmentimage.files import shown_path

MESH_FORMATS = ("obj", "ply", "stl", "glb")
"""Endings of files that are read."""
FILE_LIMIT = 200_000_000
"""Bytes of a file."""
FACE_RANGE = (500, 400_000)
"""Triangles of a body: with fewer there is no shape, more only cost time."""
STATURES = (1.2, 2.3)
"""Least and greatest stature of a body [m]; outside of it, the unit is another."""
UNITS = {"m": 100.0, "dm": 10.0, "cm": 1.0, "mm": 0.1}
"""Units that a file may be in, and their lengths [cm]."""
FOOT = 0.03
"""Height up to which a foot is looked at for where its toes point, as a share of the stature."""
ANKLE = (0.05, 0.08)
"""Heights between which the leg lies above the heel, as shares of the stature."""
LEGS_END = 0.3
"""Below this share of the stature nothing of a standing body is in its middle."""
STRAIGHT_ARM = np.deg2rad(22.5)
"""Arms that hang down less than this are stretched out: pose `t`; else it is `a`."""


def load_body_file(path: str | os.PathLike[str]) -> Body:
    """A body from a mesh file.

    The body must be one closed surface in the T pose or the A pose, legs apart. It is scaled to
    cm, turned to y up and to face +z by its feet, and put on the floor. Loose parts (eyes, lashes)
    are left out with a warning. Landmarks come from the proportions of adults; see `marks`.

    Raises:
        DraftError: the file cannot be read, or is no such body.
    """
    try:
        points, faces = _closed(*_largest(*_read(path)))
        points = _upright(points)
        return _body(points, faces, Path(path).stem)
    except DraftError as error:
        raise DraftError(f"{shown_path(path)}: {error}") from None


def _read(
    path: str | os.PathLike[str],
) -> tuple[Float[np.ndarray, "vertex 3"], Int[np.ndarray, "face 3"]]:
    """Points in the file's units, equal ones once, and the triangles between them."""
    import trimesh

    ending = Path(path).suffix.lower().removeprefix(".")
    if ending not in MESH_FORMATS:
        raise DraftError(f"is not a mesh file; give one of {', '.join(MESH_FORMATS)}")
    raw = _bytes(path)
    try:
        # Without a resolver the reader cannot open any other file.
        mesh = trimesh.load_mesh(BytesIO(raw), file_type=ending, process=False)
        points, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    except Exception as error:  # Its readers raise whatever a damaged file makes them stumble over.
        raise DraftError(
            f"is not a mesh that can be read as {ending.upper()} ({type(error).__name__}); "
            "export it again"
        ) from None
    low, high = FACE_RANGE
    if not low <= len(faces) <= high:
        raise DraftError(f"has {len(faces)} triangles; a body has {low} to {high}")
    if not np.isfinite(points).all() or faces.min() < 0 or faces.max() >= len(points):
        raise DraftError("has points that are no numbers or do not exist; export it again")
    points, number = np.unique(points, axis=0, return_inverse=True)
    return points, number.reshape(-1)[faces]


def _bytes(path: str | os.PathLike[str]) -> bytes:
    try:
        with Path(path).open("rb") as file:
            raw = file.read(FILE_LIMIT + 1)
    except FileNotFoundError:
        raise DraftError("there is no such file; check its name") from None
    except IsADirectoryError:
        raise DraftError("is a folder; name a mesh file in it") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise DraftError(f"cannot be read ({reason})") from None
    if not raw.strip():
        raise DraftError("is empty; export the body again")
    if len(raw) > FILE_LIMIT:
        raise DraftError(f"is larger than {FILE_LIMIT // 1_000_000} MB; export a coarser body")
    return raw


def _largest(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> tuple[Float[np.ndarray, "kept 3"], Int[np.ndarray, "part 3"]]:
    """The connected part with the most triangles, its vertices numbered anew."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = faces[:, [0, 1, 1, 2]].reshape(-1, 2)
    joined = coo_array((np.ones(len(ends)), tuple(ends.T)), shape=(len(points), len(points)))
    _, part = connected_components(joined, directed=False)
    sizes = np.bincount(part[faces[:, 0]])
    kept = faces[part[faces[:, 0]] == sizes.argmax()]
    if len(kept) < len(faces):
        warnings.warn(
            f"the body is in {np.count_nonzero(sizes)} parts; only the largest is used "
            f"({len(kept)} of {len(faces)} triangles)",
            stacklevel=3,
        )
    used, number = np.unique(kept, return_inverse=True)
    return points[used], number.reshape(kept.shape)


def _closed(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"]
) -> tuple[Float[np.ndarray, "vertex 3"], Int[np.ndarray, "face 3"]]:
    """The same surface, looking outwards, if it is closed."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ways = sides[:, 0] * len(points) + sides[:, 1]
    back = sides[:, 1] * len(points) + sides[:, 0]
    _, uses = np.unique(np.minimum(ways, back), return_counts=True)
    if (uses != 2).any():
        raise DraftError(
            f"is not watertight ({(uses != 2).sum()} of {len(uses)} edges do not have a triangle "
            "on each side); close its holes"
        )
    if not np.array_equal(np.sort(ways), np.sort(back)):
        raise DraftError("has triangles that look in and others that look out; make them agree")
    a, b, c = np.moveaxis(points[faces], 1, 0)
    volume = np.einsum("ij,ij->", a - points[0], np.cross(b - points[0], c - points[0]))
    return points, faces if volume > 0 else faces[:, ::-1]


def _upright(points: Float[np.ndarray, "vertex 3"]) -> Float[np.ndarray, "vertex 3"]:
    """The points in cm, y up, feet on the floor, facing +z, the middle of the span at x = 0.

    From front to back a body with its arms lifted is thinner than it is wide or high, so the
    thinnest direction tells which way is up.
    """
    thinnest = int(np.ptp(points, axis=0).argmin())
    if thinnest == 0:
        raise DraftError("faces sideways; turn it to face +z with y up, or -y with z up")
    if thinnest == 1:
        points = points[:, [0, 2, 1]] * [1, 1, -1]
    points = points * _unit(float(np.ptp(points[:, 1])))
    low, high = points.min(0), points.max(0)
    points = points - [(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2]
    return points if _toes_forward(points) else points * [-1, 1, -1]


def _unit(height: float) -> float:
    low, high = STATURES
    for size in UNITS.values():
        if low * 100 <= height * size <= high * 100:
            return size
    raise DraftError(
        f"is {height:g} units high; a body is {low:g} to {high:g} m in {', '.join(UNITS)}"
    )


def _toes_forward(points: Float[np.ndarray, "vertex 3"]) -> bool:
    height, depth = points[:, 1] / np.ptp(points[:, 1]), points[:, 2]
    foot, leg = depth[height < FOOT], depth[(height > ANKLE[0]) & (height < ANKLE[1])]
    middle = (leg.max() + leg.min()) / 2 if len(leg) else 0.0
    return bool(foot.max() - middle >= middle - foot.min())


def _body(
    points: Float[np.ndarray, "vertex 3"], faces: Int[np.ndarray, "face 3"], name: str
) -> Body:
    """The body with its landmarks, z = 0 halfway through its waist."""
    bare = Body(points, faces.astype(np.int32), name, "t", {})
    lowest = float(trunk_section(bare)[:, 1].min())
    if lowest < LEGS_END * points[:, 1].max():
        raise DraftError(
            f"is closed down to {lowest:.0f} cm over the floor in its middle (x = 0); "
            "stand it on its feet, legs apart, alike on both sides"
        )
    place, middle = mark(bare)
    shift = np.array([0.0, 0.0, middle])
    points = points - shift
    place = {key: point - shift for key, point in place.items()}
    for array in (points, bare.faces, *place.values()):
        array.setflags(write=False)
    return Body(points, bare.faces, name, _pose(place), MappingProxyType(place))


def _pose(place: dict[str, Float[np.ndarray, " 3"]]) -> str:
    across, down, _ = place["left_wrist_joint"] - place["left_shoulder_joint"]
    return "t" if -down < np.tan(STRAIGHT_ARM) * across else "a"
