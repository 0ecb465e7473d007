"""Make the bodies that garmentimage ships, from the Anny body model; or a picture of them.

    python -m venv bodies && bodies/bin/pip install -e ".[bodies]"
    bodies/bin/python scripts/make_bodies.py build      # writes src/garmentimage/body/data
    python scripts/make_bodies.py picture docs/images/bodies.png

`build` needs the packages of the `bodies` extra. Its first run takes some minutes and a cache of
0.9 GB (`ANNY_CACHE_DIR`). Anny's code is under Apache-2.0, the mesh it deforms (MakeHuman) under
CC0; only this mesh is used, as other topologies of Anny load data under other terms.
"""

import argparse
import json
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from garmentimage.body.body import POSES, TOPOLOGY_FILE, Body, load_body, read_points, write_points
from garmentimage.body.body_measurements import SHIPPED_FILE, measurements
from garmentimage.body.measure import measure

DATA = Path(__file__).parents[1] / "src" / "garmentimage" / "body" / "data"

ADULT = {"age": 0.67, "muscle": 0.5, "proportions": 0.7, "cupsize": 0.5, "firmness": 0.5}
"""What all bodies share: about 25 to 35 years old, of average muscle."""
DESCENT = dict.fromkeys(("african", "asian", "caucasian"), 1 / 3)


@dataclass(frozen=True)
class Shape:
    """What makes one body: Anny's phenotypes (0 to 1) and local changes (-1 to 1)."""

    gender: float
    """0 male, 1 female."""
    height: float
    weight: float
    bust: float
    waist: float
    hips: float
    forearm: float

    def phenotypes(self) -> dict[str, float]:
        """Shape of the whole body."""
        varied = {"gender": self.gender, "height": self.height, "weight": self.weight}
        return ADULT | DESCENT | varied

    def changes(self) -> dict[str, float]:
        """Changes of single measurements."""
        return {
            "measure-bust-circ-incr": self.bust,
            "measure-waist-circ-incr": self.waist,
            "measure-hips-circ-incr": self.hips,
            "measure-lowerarm-length-incr": self.forearm,
        }


BODIES = {
    "mean-female": Shape(1, 0.406, 0.584, 0.068, 0.219, 0.121, 0.359),
    "mean-male": Shape(0, 0.372, 0.642, 0.100, 0.165, -0.008, -0.005),
    "tall-slim-female": Shape(1, 0.507, 0.059, -0.301, -0.204, -0.149, 0.526),
    "short-round-female": Shape(1, 0.308, 0.998, 0.789, 0.992, 0.514, 0.273),
    "tall-slim-male": Shape(0, 0.482, 0.003, -0.446, -0.307, -0.484, 0.167),
    "short-round-male": Shape(0, 0.276, 0.977, 0.687, 0.866, 0.352, -0.061),
    "slim-female": Shape(1, 0.405, 0.02, -0.36, -0.64, -0.46, 0.45),
}
"""The shipped bodies. Stature, bust, waist, hip and arm were fitted by least squares: to 166, 90,
74, 99, 54.5 cm for the mean woman, to 177, 100, 87, 100, 60 cm for the mean man, and for the others
to figures well away from these in height and girth. The slim woman, as tall as the mean one, has
79, 58.5, 85 and 54 cm, about size 32 in Europe: she fits Korosteleva's 2021 patterns better."""
MIDDLE, WAIST_BAND = 0.5, 2.0
"""Skin this near to the middle and to the waist level says how deep the waist is [cm]."""
LEG_ANGLE = np.deg2rad(8)
"""How far the legs stand out in both poses, so that trousers have room between them."""
ARM_ANGLES = {"t": 0.0, "a": np.deg2rad(45)}
"""How far the arms hang down in each pose."""

SKIN_POINTS = {
    "crown": 881,
    "forehead": 237,
    "head_back": 962,
    "cervical": 857,
    "neck_front": 1526,
    "left_neck_point": 8184,
    "scye_back": 1600,
    "left_side": 10602,
    "left_bust_point": 8435,
    "left_underbust": 8539,
    "waist_front": 4069,
    "crotch": 4374,
    "left_kneecap": 11223,
}
"""Landmarks on the skin, as vertices of MakeHuman's base mesh. They were chosen by eye on the mean
female body, near the height that surveys of adults give each as a share of the stature."""
JOINTS = {
    "neck": "neck01",
    "left_shoulder": "upperarm01.L",
    "left_elbow": "lowerarm01.L",
    "left_wrist": "wrist.L",
    "left_hip": "upperleg01.L",
    "left_knee": "lowerleg01.L",
    "left_ankle": "foot.L",
}
"""Joints inside the body, as the bones of Anny's rig that begin there."""


class Model:
    """Anny with the parts of it that become a body: the outer skin, its faces, the landmarks."""

    def __init__(self) -> None:
        import anny
        import torch

        self.torch = torch
        self.anny = anny.Anny(
            local_changes="default",
            phenotypes="all",
            phenotype_blendshapes="original",
            skinning_method="lbs",
        )
        self.bones = {name: k for k, name in enumerate(self.anny.bone_labels)}
        self.skin, self.faces = _largest_part(self.anny.faces.numpy())
        base = self.anny.base_mesh_vertex_indices.numpy()[self.skin]
        where = {int(vertex): k for k, vertex in enumerate(base)}
        self.skin_points = {name: where[vertex] for name, vertex in SKIN_POINTS.items()}

    def body(self, name: str, pose: str) -> Body:
        """One body in one pose, standing at its place in the world [cm]."""
        shape = BODIES[name]
        rest = self._run(shape, np.tile(np.eye(4), (len(self.bones), 1, 1)))
        posed = self._run(shape, self._rotations(rest["rest_bone_heads"], pose))
        skin = _world(posed["vertices"][self.skin])
        joints = _world(posed["bone_poses"][:, :3, 3])
        landmarks = {key: skin[k] for key, k in self.skin_points.items()}
        landmarks |= {f"{key}_joint": joints[self.bones[bone]] for key, bone in JOINTS.items()}
        origin = _origin(skin, landmarks["waist_front"][1])
        places = MappingProxyType({key: place - origin for key, place in landmarks.items()})
        return Body(skin - origin, self.faces, name, pose, places)

    def _run(self, shape: Shape, rotations: np.ndarray) -> dict[str, np.ndarray]:
        with self.torch.no_grad():
            found = self.anny(
                pose_parameters=self.torch.tensor(rotations, dtype=self.anny.dtype)[None],
                phenotype_kwargs=shape.phenotypes(),
                local_changes_kwargs=shape.changes(),
            )
        return {key: value[0].numpy() for key, value in found.items()}

    def _rotations(self, heads: np.ndarray, pose: str) -> np.ndarray:
        """Each bone's rotation relative to its parent, as 4 x 4 matrices in Anny's frame."""
        poses = np.tile(np.eye(4), (len(self.bones), 1, 1))
        for side, sign in (("L", 1), ("R", -1)):
            angle = ARM_ANGLES[pose]
            arm = np.array([sign * np.cos(angle), 0, -np.sin(angle)])
            chain = [
                f"{bone}.{side}" for bone in ("upperarm01", "lowerarm01", "wrist", "finger3-1")
            ]
            self._aim(poses, heads, chain, arm)
            hip, ankle = (f"{bone}.{side}" for bone in ("upperleg01", "foot"))
            leg = heads[self.bones[ankle]] - heads[self.bones[hip]]
            out = np.array([sign * np.sin(LEG_ANGLE), leg[1] / np.linalg.norm(leg), -1])
            self._aim(poses, heads, [hip, ankle], out)
        return poses

    def _aim(
        self, poses: np.ndarray, heads: np.ndarray, chain: list[str], direction: np.ndarray
    ) -> None:
        """Turn the bones of a chain, each from its head to the next, into one direction."""
        turned = np.eye(3)
        for bone, after in pairwise(chain):
            rest = heads[self.bones[after]] - heads[self.bones[bone]]
            world = _turn(rest, direction)
            poses[self.bones[bone], :3, :3] = turned.T @ world
            turned = world


def _largest_part(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of the largest connected part (the skin, not eyes and teeth), and its faces."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    sides = np.concatenate([faces[:, :2], faces[:, 1:]])
    joined = coo_array((np.ones(len(sides)), tuple(sides.T)), shape=(faces.max() + 1,) * 2)
    _, part = connected_components(joined, directed=False)
    skin = np.flatnonzero(part == np.bincount(part).argmax())
    number = np.full(len(part), -1)
    number[skin] = np.arange(len(skin))
    return skin, number[faces[(number[faces] >= 0).all(1)]].astype(np.int32)


def _world(points: np.ndarray) -> np.ndarray:
    """Points of Anny (m, z up, front towards -y) in our world (cm, y up, front towards +z)."""
    return 100 * np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def _origin(skin: np.ndarray, waist: float) -> np.ndarray:
    """Where the floor meets the upright line halfway through the waist."""
    floor = skin[:, 1].min()
    middle = skin[np.abs(skin[:, 0]) < MIDDLE]
    depth = middle[np.abs(middle[:, 1] - waist) < WAIST_BAND, 2]
    return np.array([0.0, floor, (depth.min() + depth.max()) / 2])


def _turn(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The smallest rotation from one direction to another (Rodrigues)."""
    a, b = start / np.linalg.norm(start), end / np.linalg.norm(end)
    x, y, z = np.cross(a, b)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + cross + cross @ cross / (1 + a @ b)


def build() -> None:
    """Write the shipped files: faces and landmark names, points of each body, measurements."""
    model, records = Model(), {}
    for name in BODIES:
        bodies = {pose: model.body(name, pose) for pose in POSES}
        names = list(bodies["t"].landmarks)
        points = {pose: _points(body) for pose, body in bodies.items()}
        shipped = {pose: write_points(array) for pose, array in points.items()}
        np.savez_compressed(DATA / f"{name}.npz", **shipped)
        gap = max(np.abs(read_points(shipped[pose]) - points[pose]).max() for pose in POSES)
        record = measure(_rounded(bodies["t"], shipped["t"], names))
        record.check()
        records[name] = asdict(record)
        print(f"{name}: rounding moves points by up to {gap:.4f} cm")
    _check_watertight(model.faces)
    faces = model.faces.astype(np.uint16)
    np.savez_compressed(DATA / TOPOLOGY_FILE, faces=faces, landmarks=np.array(names))
    (DATA / SHIPPED_FILE).write_text(json.dumps(records, indent=2) + "\n", encoding="utf-8")


def _points(body: Body) -> np.ndarray:
    return np.vstack([body.vertices, *body.landmarks.values()])


def _rounded(body: Body, shipped: np.ndarray, names: list[str]) -> Body:
    """The body as it will be loaded, so that the shipped measurements are exactly its own."""
    points, skin = read_points(shipped), len(body.vertices)
    return Body(
        points[:skin],
        body.faces,
        body.name,
        body.pose,
        dict(zip(names, points[skin:], strict=True)),
    )


def _check_watertight(faces: np.ndarray) -> None:
    """Each side of a face must occur once in each direction."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    there = np.unique(sides, axis=0)
    back = np.unique(sides[:, ::-1], axis=0)
    if len(there) < len(sides) or not np.array_equal(there, back):
        raise SystemExit("the skin has holes: choose another topology of the body model")


PICTURE_LEVELS = dict.fromkeys(("bust", "waist", "hip", "knee"), "bottom") | {"crotch": "top"}
"""Levels that the picture shows, and which side of its name lies on the line."""
PICTURE_HALF_WIDTH = 76.0
"""Half the width of one body's place in the picture [cm]."""
PICTURE_WIDTH = 2.25
"""Width of one body's place on paper [inches]."""
LIGHT = np.array([0.3, 0.4, 0.87])
SKIN, SHADE = np.array([0.93, 0.86, 0.80]), np.array([0.38, 0.33, 0.33])


def picture(path: Path) -> None:
    """Draw all bodies from the front, with the levels at which they are measured."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, places = plt.subplots(
        1, len(BODIES), figsize=(PICTURE_WIDTH * len(BODIES), 3.5), sharey=True
    )
    for axes, name in zip(places, BODIES, strict=True):
        _draw(axes, load_body(name, "a"))
    places[0].set_ylabel("cm")
    figure.tight_layout(pad=0.4)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def _draw(axes: Any, body: Body) -> None:
    from matplotlib.collections import PolyCollection

    corners = body.vertices[body.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    order = np.argsort(corners[:, :, 2].mean(1))
    order = order[normal[order, 2] > 0]
    light = np.clip(normal[order] @ LIGHT, 0, 1)[:, None]
    colours = light * SKIN + (1 - light) * SHADE
    axes.add_collection(
        PolyCollection(
            corners[order, :, :2], facecolors=colours, edgecolors=colours, linewidths=0.3
        )
    )
    record = measurements(body.name)
    for level, side in PICTURE_LEVELS.items():
        height = getattr(record, f"{level}_height")
        axes.axhline(height, color="tab:red", linewidth=0.6)
        place = (-PICTURE_HALF_WIDTH, height + (1 if side == "bottom" else -1))
        axes.text(*place, level, va=side, color="tab:red", fontsize=6)
    girths = f"{record.bust_girth:.0f} - {record.waist_girth:.0f} - {record.hip_girth:.0f}"
    axes.set_title(f"{body.name}\n{record.stature:.0f} cm, {girths}", fontsize=8)
    axes.set(xlim=(-PICTURE_HALF_WIDTH, PICTURE_HALF_WIDTH), ylim=(0, 195), aspect="equal")
    axes.set_xticks([])
    axes.tick_params(labelsize=7)
    axes.spines[["top", "right", "bottom"]].set_visible(False)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("build", help="write the files that the package ships")
    commands.add_parser("picture", help="draw all bodies").add_argument("path", type=Path)
    options = parser.parse_args()
    if options.command == "build":
        build()
    else:
        picture(options.path)


if __name__ == "__main__":
    main()
