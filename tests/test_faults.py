"""Strangers' files, a folder a kind: each comes out as it deserves, or is refused with a reason.

What each kind deserves is in the `INDEX.md` beside `faults.tar.xz`. All go through the command:
check, encode and decode, drape. Where the cloth lies is judged from the written file against the
body's landmarks, not from what the drape says of itself.
"""

import re
import tarfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from garmentimage import decode, load_image
from garmentimage.cli.app import main
from garmentimage.compare.comparison import compare_patterns
from garmentimage.drape.files.glb import load_drape
from garmentimage.drape.girths import trunk_girth
from garmentimage.drape.mesh.rest import rest_of
from garmentimage.drape.solver.distance_field import body_field
from garmentimage.drape.verdict.openings import openings
from garmentimage.metrics.similarity import likeness
from garmentimage.pattern.files.spec import read_pattern
from tests.corpus import corpus_folder, unpacked

pytestmark = pytest.mark.corpus
ARCHIVE = "faults/faults.tar.xz"
NEAR_CM = 3.0
"""How far the upper edge may lie from where it is worn."""
BAND_CM = 6.0
"""A waistband may stand over the waist by this much, and a collar over the neck."""
HIPS_CM, DRAWN_CM = 13.0, 4.0
"""An upper edge that is longer than the waist, by more than the second, lies lower, on the hips,
where the body is thick enough, but no further below the waist than the first."""
LEVEL_CM = 8.0
"""From the lowest to the highest point of an upper edge; waists are up to 4 cm lower in front."""
CHEST = 0.7
"""Height of the chest on the way from the waist to the shoulder joints."""
OFF_SKIN_CM = 3.0
"""An upper edge that is worn at waist or chest lies no further from the skin, on the average."""
SMALL_PIECE = 0.15
"""Pieces of a smaller share of the cloth, such as loose pockets, are no garments."""
DEEPEST_CM = 0.5

Place = Literal["waist", "shoulders", "chest", "both", "any"]


@dataclass(frozen=True)
class Deserved:
    """What a kind of file deserves."""

    trip: str = "same"
    """`same`: comes back; `same or error`; else the error of `encode`, as a regular expression."""
    worn: Place | None = "any"
    """Where it is worn; None where its drape must be an error."""
    or_error: bool = False
    """Its drape may also be an error."""
    says: str = ""
    """What `check` must say: a note, or its error."""
    refused: bool = False
    """Whether `check` must refuse it."""


def refused(says: str) -> Deserved:
    return Deserved(says, None, says=says, refused=True)


def noted(says: str, worn: Place | None = "shoulders") -> Deserved:
    return Deserved("same", worn, says=says)


UNPLACED = Deserved("same or error", None, says="placement: .* place them around the body")
KINDS = {
    "circle-skirt": Deserved("same or error", "waist", or_error=True),
    "clockwise-panel": noted("ran clockwise .* turned round"),
    "curvature-zero": Deserved(worn="shoulders"),
    "duplicated-stitch": noted("the same; the second was left out"),
    "empty-panel": noted("'collar': has neither vertices nor edges and was left out"),
    "fisheye-cut": Deserved(worn="shoulders"),
    "gathers-4": Deserved(worn="any", says="4.0 times as long"),
    "godet": Deserved(worn="waist"),
    "layered-skirt": Deserved("same or error", "waist", or_error=True, says="2 garments"),
    "nan": refused("panel 'front', vertex 2: .* NaN"),
    "normalize": Deserved(worn="shoulders"),
    "one-sleeve": Deserved(worn="shoulders"),
    "origin-elsewhere": Deserved(worn="any", or_error=True),
    "outfit-one-file": Deserved(worn="both", says="2 garments that no stitch joins"),
    "pants-no-band": Deserved(worn="waist", or_error=True),
    "patch-pocket": Deserved("same or error", "waist", or_error=True, says="'pocket' is sewn to"),
    "pleat": Deserved(worn="waist", or_error=True),
    "poncho": Deserved("same or error", "shoulders", or_error=True),
    "public-circle-no-band": Deserved("same or error", "waist", or_error=True),
    "public-hood": Deserved("same or error", "any", or_error=True),
    "public-strapless": Deserved("same or error", "chest", or_error=True),
    "public-skin": Deserved("same or error", "any", or_error=True),
    "rotation-matrix": Deserved(worn="shoulders"),
    "rotation-quaternion": refused("panel 'front', rotation: .* quaternion"),
    "rotation-radians": Deserved("same or error", None, says="look like radians"),
    "shuffled-edges": noted("not in the order of the loop"),
    "shuffled-vertices": Deserved(worn="shoulders"),
    "soft-shares": Deserved("same or error", "any", or_error=True),
    "stitch-missing-panel": refused("stitch 14, side 0: names panel 0"),
    "strapless": Deserved(worn="chest", or_error=True),
    "three-in-one-seam": refused("stitches 10 and 12: both sew edge 0 of panel 'band_f'"),
    "tiny-edge": Deserved("same or error", "any", or_error=True),
    "traced-polyline": Deserved(worn="any"),
    "tube-one-panel": Deserved("same or error", "waist", or_error=True),
    "unplaced": UNPLACED,
    "v2-fields": Deserved(worn="shoulders"),
    "vertices-3d": refused("panel 'front', vertex 0: must be a list of 2 numbers"),
    "waist-too-wide": Deserved(worn="waist", or_error=True),
    "wrap-skirt": Deserved("same or error", "waist", or_error=True),
    "z-up-world": Deserved("same or error", None, says="stand upright along z"),
}
"""By folder. Those with files of several sorts are below."""
FILES = {
    "inches/tee_inches.json": Deserved(worn="shoulders"),
    "inches/tee_x10.json": Deserved("same or error", None, says="properties.units_in_meter"),
    "midway-vertex/half_sewn.json": Deserved(worn="any", or_error=True, says="half|beside it"),
    "midway-vertex/one_to_two.json": refused("stitches 0 and 1: both sew edge 1"),
    "zero-length-edge/tee.json": refused("panel 'front', edge 11: has no length"),
    "zero-length-edge/tee_tiny.json": Deserved("same or error", "shoulders"),
    "petite-skirt/petite_140.json": Deserved(),
}
LEAST_WORN = {
    "skirt": "waist", "pants": "waist", "tee": "shoulders", "tank": "shoulders",
    "one-panel-dress": "shoulders", "top-pants": "shoulders",
}  # fmt: skip
"""By the first word of a file, where a kind holds several garments."""


def _files(ending: str) -> list[str]:
    """Names of the files in the archive, kind/file; none where it is not there."""
    folder = corpus_folder()
    if folder is None or not (folder / ARCHIVE).is_file():
        return []
    with tarfile.open(folder / ARCHIVE) as tar:
        names = ["/".join(Path(m.name).parts[-2:]) for m in tar if m.isfile()]
    return sorted(name for name in names if name.endswith(ending))


def _params(names):
    return [pytest.param(name, id=name) for name in names]


MEASUREMENTS = re.compile(r"petite-skirt/petite_\d+\.json")
PATTERNS = [name for name in _files(".json") if not MEASUREMENTS.fullmatch(name)]
TRIPS = [name for name in PATTERNS if not name.startswith(("public-likeness", "petite-skirt"))]


@pytest.fixture(scope="module")
def faults(tmp_path_factory):
    folder = unpacked(ARCHIVE, tmp_path_factory.mktemp("faults"))
    inside = folder / "faults"
    return inside if inside.is_dir() else folder


def deserved(name) -> Deserved:
    return FILES.get(name) or KINDS[name.split("/")[0]]


def test_every_kind_has_its_line():
    known = {*KINDS, *(name.split("/")[0] for name in FILES)}
    known |= {"public-likeness", "body-rounded-3", "body-smplx-eyes", "mse-outputs", "soft-shares"}
    assert {name.split("/")[0] for name in _files("")} <= known


@pytest.mark.parametrize("name", _params(TRIPS))
def test_check_says_what_it_is(name, faults, capsys):
    wanted = deserved(name)
    assert main(["check", str(faults / name)]) == (2 if wanted.refused else 0)
    assert re.search(wanted.says, capsys.readouterr().err.replace("\n", " "))


@pytest.mark.parametrize("name", _params(TRIPS))
def test_it_comes_back_the_same_or_is_refused(name, faults, tmp_path, capsys):
    wanted = deserved(name)
    image, back = tmp_path / "image.npz", tmp_path / "back.json"
    code = main(["encode", str(faults / name), "-o", str(image)])
    said = capsys.readouterr().err
    if code == 2:
        assert wanted.trip != "same", said
        assert not image.exists() and "error: " in said
        assert wanted.trip == "same or error" or re.search(wanted.trip, said)
        return
    assert code == 0 and wanted.trip in ("same", "same or error")
    assert main(["decode", str(image), "-o", str(back)]) == 0
    result = compare_patterns(read_pattern(faults / name)[0], read_pattern(back)[0])
    assert result.success, result.reasons


@pytest.mark.parametrize("name", _params([n for n in PATTERNS if "likeness" not in n]))
def test_it_is_worn_where_it_belongs_or_the_drape_is_an_error(name, faults, tmp_path, capsys):
    kind, file = name.split("/")
    petite = kind == "petite-skirt"
    wanted = Deserved(worn="waist", or_error=True) if petite else deserved(name)
    out = tmp_path / "worn.glb"
    code = main(["drape", str(faults / name), "-o", str(out)])
    if code != 0:
        assert code == 2 and not out.exists() and "error: " in capsys.readouterr().err
        assert wanted.worn is None or wanted.or_error
        return
    assert wanted.worn is not None, "worn, although nobody can say where"
    place = wanted.worn
    if place == "any":
        place = LEAST_WORN.get(re.split(r"[_.]", file)[0], "any")
    assert_worn(out, place)


@pytest.mark.parametrize("name", _params(["petite-skirt/skirt_143.json"] if PATTERNS else []))
def test_a_petite_skirt_is_worn_at_the_waist_of_who_it_was_drafted_for(name, faults, tmp_path):
    out, body = tmp_path / "worn.glb", faults / "petite-skirt" / "petite_body_143.obj"
    assert main(["drape", str(faults / name), "--body", str(body), "-o", str(out)]) == 0
    assert_worn(out, "waist")


@pytest.mark.parametrize("name", _params([n for n in _files(".obj") if n.startswith("body-")]))
def test_bodies_that_people_have_are_taken(name, faults, tmp_path):
    tee, out = tmp_path / "tee.json", tmp_path / "worn.glb"
    assert main(["draft", "tee", "-o", str(tee)]) == 0
    assert main(["drape", str(tee), "--body", str(faults / name), "-o", str(out)]) == 0
    assert_worn(out, "shoulders")


@pytest.mark.parametrize("level", ["none", "paper", "full"])
@pytest.mark.parametrize("name", _params([n for n in _files(".npy") if n.startswith("soft-")]))
def test_soft_shares_give_the_garment_at_every_level_of_repair(name, level, faults, tmp_path):
    out, truth = tmp_path / "back.json", name.replace("_shares999.npy", ".json")
    assert main(["decode", str(faults / name), "--repair", level, "-o", str(out)]) == 0
    found, wanted = read_pattern(out)[0], read_pattern(faults / truth)[0]
    result = compare_patterns(wanted, found, any_pose=True)
    assert result.success, result.reasons


@pytest.mark.parametrize("name", _params([n for n in _files(".npy") if n.startswith("mse-")]))
def test_outputs_of_squared_error_networks_give_the_garment(name, faults, tmp_path):
    out = tmp_path / "back.json"
    assert main(["decode", str(faults / name), "-o", str(out)]) == 0
    wanted = read_pattern(faults / "soft-shares" / "soft_dress.json")[0]
    assert len(read_pattern(out)[0].panels) == len(wanted.panels)


@pytest.mark.parametrize("name", _params([n for n in PATTERNS if "likeness" in n]))
def test_a_perfect_decode_is_like_its_truth(name, faults, tmp_path):
    image = tmp_path / "image.npz"
    assert main(["encode", str(faults / name), "-o", str(image)]) == 0
    found = decode(load_image(image).to_channels())
    assert likeness(read_pattern(faults / name)[0], found).topology


def assert_worn(glb, place):
    """Judge where the cloth of a written drape lies, from its vertices and the body's landmarks."""
    worn = load_drape(glb)
    marks, points = worn.body.landmarks, worn.points
    waist, neck = marks["waist_front"][1], marks["left_neck_point"][1]
    shoulder = marks["left_shoulder_joint"][1]
    faces = rest_of(worn.cloth).faces
    middles = points[faces].mean(axis=1)
    field = body_field(worn.body)
    assert field.at(middles).min() > -DEEPEST_CM, "skin shines through the cloth"
    assert points[:, 1].max() < worn.body.vertices[:, 1].max() + BAND_CM, "it hangs over the head"
    if place == "any":
        return
    tops = [points[piece] for piece in _upper_edges(faces, points)]
    for top in tops:
        low, high = (np.percentile(top[:, 1], share) for share in (2, 98))
        middle = float(top[:, 1].mean())
        lowest = _holding(worn.body, waist, top) - NEAR_CM
        at_waist = lowest <= middle <= waist + BAND_CM and high - low <= LEVEL_CM
        at_neck = shoulder <= high <= neck + BAND_CM
        chest = waist + CHEST * (shoulder - waist)
        at_chest = chest - 2 * NEAR_CM <= middle <= shoulder + NEAR_CM
        is_held = field.at(top).mean() <= OFF_SKIN_CM
        right = {"waist": at_waist and is_held, "shoulders": at_neck, "chest": at_chest and is_held,
                 "both": (at_waist and is_held) or at_neck}[place]  # fmt: skip
        assert right, f"its upper edge lies at {low:.0f} to {high:.0f} cm, the waist at {waist:.0f}"


def _holding(body, waist, edge):
    """Height at which the body is thick enough to hold a closed edge: the waist, or below it."""
    length = np.linalg.norm(edge - np.roll(edge, 1, axis=0), axis=1).sum()
    levels = np.arange(waist, waist - HIPS_CM, -1.0)
    return next((y for y in levels if trunk_girth(body, y) >= length - DRAWN_CM), waist)


def _upper_edges(faces, points):
    """Of each connected piece of clothing the vertices of its highest opening."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    count = len(points)
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(count, count))
    _, piece = connected_components(graph, directed=False)
    found = [np.asarray(loop) for loop in openings(faces)]
    for label in np.unique(piece[faces]):
        mine = [loop for loop in found if piece[loop[0]] == label]
        if (piece == label).mean() >= SMALL_PIECE:
            yield max(mine, key=lambda loop: points[loop, 1].mean())
