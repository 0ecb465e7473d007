"""Bodies as triangle meshes: adults that garments are drafted for, placed on and draped over."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from garmentimage.body.body_measurements import check_body_name
from garmentimage.errors import DraftError, quoted

POSES = {"t": "arms stretched out sideways", "a": "arms 45 degrees down"}
"""Poses of the shipped bodies; the legs stand a little apart in both."""
STEP = 1 / 256  # coordinates are shipped as whole multiples of this [cm]
MIDDLE_HEIGHT = 100.0  # heights are shipped relative to this, so that 16 bits suffice [cm]
TOPOLOGY_FILE = "topology.npz"  # faces and landmark names, which all shipped bodies share

Vector3 = Float[np.ndarray, " 3"]
Points3 = Float[np.ndarray, "_ 3"]


@dataclass(frozen=True, eq=False)
class Body:
    """A watertight body standing on the floor.

    World: cm, y up, feet at y = 0, +z the front of the body, x = the wearer's left, x = 0 the plane
    of symmetry, z = 0 halfway through the waist.
    """

    vertices: Float[np.ndarray, "vertex 3"]
    """[cm]"""
    faces: Int[np.ndarray, "face 3"]
    """Corners into `vertices`, counter-clockwise seen from outside."""
    name: str
    """Name of the shipped body."""
    pose: str
    """One of `POSES`."""
    landmarks: Mapping[str, Vector3]
    """Named points [cm]: on the skin (`cervical`, `waist_front`, `left_neck_point`, ...), and the
    joints within (`left_shoulder_joint`, ...)."""


def load_body(name: str = "mean-female", pose: str = "t") -> Body:
    """A shipped body; loaded once, its arrays are read-only.

    Raises:
        DraftError: there is no body or no pose of that name.

    Example:
        >>> load_body("mean-male", pose="a").vertices.shape
        (13348, 3)
    """
    check_body_name(name)
    if pose not in POSES:
        known = " or ".join(f"{key!r} ({text})" for key, text in POSES.items())
        raise DraftError(f"there is no pose {quoted(pose)}; choose {known}")
    return _load(name, pose)


@cache
def _load(name: str, pose: str) -> Body:
    points = read_points(_arrays(f"{name}.npz")[pose])
    topology = _arrays(TOPOLOGY_FILE)
    faces, names = topology["faces"].astype(np.int32), topology["landmarks"].tolist()
    skin = len(points) - len(names)
    for array in (points, faces):
        array.setflags(write=False)
    landmarks = MappingProxyType(dict(zip(names, points[skin:], strict=True)))
    return Body(points[:skin], faces, name, pose, landmarks)


@cache
def _arrays(file_name: str) -> dict[str, np.ndarray]:
    with (
        files("garmentimage.body").joinpath("data", file_name).open("rb") as file,
        np.load(file, allow_pickle=False) as arrays,
    ):
        return dict(arrays)


def read_points(shipped: Any) -> Float[np.ndarray, "point 3"]:
    """Points [cm] from the whole numbers of a shipped file."""
    points: np.ndarray = shipped * STEP + np.array([0.0, MIDDLE_HEIGHT, 0.0])
    return points


def write_points(points: Float[np.ndarray, "point 3"]) -> Int[np.ndarray, "point 3"]:
    """Points [cm] as the whole numbers of a shipped file; none moves by more than half a `STEP`."""
    return np.rint((points - [0.0, MIDDLE_HEIGHT, 0.0]) / STEP).astype(np.int16)
