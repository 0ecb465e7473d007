"""Laws on whole garments: from a pattern to its rest on a body."""

import hashlib
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from garmentimage.body.body import load_body
from garmentimage.draft.kind import draft_pattern
from garmentimage.drape.components import garment_items
from garmentimage.drape.draping import check_drape, drape_pattern
from garmentimage.drape.mesh.meshing import mesh
from garmentimage.drape.solver.distance_field import body_field
from garmentimage.drape.start.placement import place_on_body
from garmentimage.drape.start.starting import start_points
from garmentimage.drape.verdict.judging import _limb_faults
from garmentimage.errors import DrapeError
from garmentimage.examples import example_names, example_path
from garmentimage.pattern.files.spec import load_pattern
from garmentimage.pattern.model import Pattern, Side, Stitch
from garmentimage.render.worn.look import photograph
from garmentimage.render.worn.photographing import body_camera, picture
from garmentimage.render.worn.surface import surfaces_of
from tests.raster.mirror import mirrored_pattern

ROOT = Path(__file__).parents[2]
FEW = 600
"""Vertices that show a law in a tenth of a second."""
SIZE = 512
NEAR = 2.5
"""Cloth lies over cloth that is nearer than this [cm]."""


def garment(name: str) -> Pattern:
    """A bundled pattern or the plain garment of a kind."""
    return load_pattern(example_path(name)) if name in example_names() else draft_pattern(name)


@cache
def worn(name: str, vertices: int = FEW):
    return drape_pattern(garment(name), vertices=vertices)


def silhouette(found, view="front"):
    surfaces = surfaces_of(found)
    return picture(surfaces, body_camera(found.body, view), size=SIZE).silhouette


def apart(points, others) -> np.ndarray:
    """Distance from each point to the nearest of the others [cm]."""
    return cKDTree(others).query(points)[0]


def renamed(pattern: Pattern, names: dict[str, str]) -> Pattern:
    def side(old: Side) -> Side:
        return Side(names[old.panel], old.edge)

    return replace(
        pattern,
        panels=tuple(replace(p, name=names[p.name]) for p in pattern.panels),
        stitches=tuple(replace(s, a=side(s.a), b=side(s.b)) for s in pattern.stitches),
    )


def together(*patterns: Pattern) -> Pattern:
    """Garments that are not sewn to each other in one pattern."""
    parts = [
        renamed(p, {panel.name: f"{k} {panel.name}" for panel in p.panels})
        for k, p in enumerate(patterns)
    ]
    return Pattern(
        tuple(panel for p in parts for panel in p.panels),
        tuple(stitch for p in parts for stitch in p.stitches),
    )


def digest(name: str) -> str:
    found = drape_pattern(garment(name), vertices=FEW)
    return hashlib.sha256(found.points.tobytes() + found.cloth.faces.tobytes()).hexdigest()


@pytest.mark.slow
def test_the_same_garment_gives_the_same_bits_in_every_process():
    code = "from tests.drape.test_garments import digest; print(digest('dress'))"
    other = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.strip()
    assert digest("dress") == digest("dress") == other


@pytest.mark.parametrize("name", ["skirt", "tank", "trousers"])
def test_a_mirrored_pattern_drapes_to_the_mirror_image(name):
    plain, flipped = worn(name, 2000), drape_pattern(mirrored_pattern(garment(name)), vertices=2000)
    seen, mirrored = silhouette(plain), silhouette(flipped)[:, ::-1]
    assert np.abs(seen - mirrored).sum() / seen.sum() < 0.01
    assert apart(flipped.points * [-1, 1, 1], plain.points).mean() < 0.5


@pytest.mark.parametrize("name", ["skirt", "tee", "trousers"])
def test_the_order_and_the_names_of_panels_do_not_matter(name):
    pattern = garment(name)
    names = {p.name: f"piece {9 - k}" for k, p in enumerate(pattern.panels)}
    other = renamed(replace(pattern, panels=pattern.panels[::-1]), names)
    stitches = tuple(Stitch(s.b, s.a, s.same_direction) for s in other.stitches[::-1])
    other = replace(other, stitches=stitches)
    found = drape_pattern(other, vertices=2000)
    seen, again = silhouette(worn(name, 2000)), silhouette(found)
    assert np.abs(seen - again).sum() / seen.sum() < 0.005
    assert apart(found.points, worn(name, 2000).points).mean() < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["skirt", "tank", "trousers", "one-panel-dress", "cutout_top"])
def test_half_the_mesh_size_moves_the_silhouette_by_less_than_a_hundredth(name):
    """Of garments that hang without buckling; benchmarks/mesh_size.py has the others, too."""
    coarse, fine = (silhouette(worn(name, count)).sum() for count in (2000, 8000))
    assert abs(fine / coarse - 1) < 0.01


@pytest.mark.parametrize("name", ["tee", "skirt", "pants", "one-panel-dress"])
def test_plain_garments_are_worn_without_fault(name):
    found = worn(name, 2000)
    check_drape(found)
    assert found.report.settled and found.report.penetration < 0.5


@pytest.mark.parametrize("kind", ["skirt", "pants"])
def test_a_garment_drawn_for_a_far_slimmer_body_is_too_tight(kind):
    found = drape_pattern(draft_pattern(kind, "slim-female"), "short-round-female", vertices=FEW)
    assert any("too tight" in fault for fault in found.report.faults), found.report.faults
    with pytest.raises(DrapeError, match="larger size"):
        check_drape(found)


def test_the_smaller_a_garment_the_greater_its_strain():
    pattern = draft_pattern("shirt")
    body = load_body()
    stature = np.ptp(body.vertices[:, 1])
    strains = [
        drape_pattern(pattern, made_for=stature * share, vertices=FEW).report.strain
        for share in (0.95, 1.0, 1.15, 1.3)
    ]
    assert strains == sorted(strains)


def test_a_skirt_drawn_for_a_rounder_body_sits_on_the_hips_with_a_note():
    found = drape_pattern(
        draft_pattern("skirt", "short-round-female"), "tall-slim-female", vertices=FEW
    )
    check_drape(found)
    (note,) = found.report.notes
    assert "sits on the hips" in note and "87 cm" in note and "66" in note
    assert found.report.slid["waist"] > 5.0


@pytest.mark.parametrize("name", ["tee", "trousers"])
def test_a_garment_behind_the_body_is_a_fault(name):
    found = worn(name)
    behind = found.points - np.array([0.0, 0.0, 150.0])
    (fault,) = _limb_faults(found.cloth.vertex_faces, behind, behind, found.body)
    assert "the body is not in the garment" in fault


def test_panels_without_stitches_are_refused():
    with pytest.raises(DrapeError, match="no stitches"):
        drape_pattern(replace(draft_pattern("tee"), stitches=()))


@pytest.mark.parametrize("tucked", [False, True])
def test_a_top_lies_outside_of_the_skirt_and_tucked_in_it_lies_inside(tucked):
    found = drape_pattern(
        together(draft_pattern("tee"), draft_pattern("skirt")), vertices=2000, tucked=tucked
    )
    assert found.report.items == 2
    top, skirt = cloth_of(found, "0 "), cloth_of(found, "1 ")
    inner, outer = (top, skirt) if tucked else (skirt, top)
    field = body_field(found.body)
    gap, nearest = cKDTree(inner).query(outer)
    over = gap < NEAR
    assert over.sum() > 20
    assert np.mean(field.at(outer[over]) > field.at(inner[nearest[over]])) > 0.9


@pytest.mark.parametrize("bottom", ["skirt", "pants"])
@pytest.mark.parametrize("top", ["tee", "tank"])
def test_a_loose_top_is_worn_tucked_in_without_fault(top, bottom):
    check_drape(
        drape_pattern(
            together(draft_pattern(top), draft_pattern(bottom)), vertices=2000, tucked=True
        )
    )


def cloth_of(found, prefix: str) -> np.ndarray:
    """Vertices of the panels whose names begin so [cm]."""
    names = np.array([p.name.startswith(prefix) for p in found.cloth.pattern.panels])
    own = np.unique(found.cloth.vertex_faces[names[found.cloth.face_panel]])
    return found.points[own]


@pytest.mark.parametrize("kind", ["tee", "tank", "hoodie", "one-panel-dress"])
def test_what_lies_on_the_shoulders_hangs(kind):
    body = load_body()
    placed, placements = place_on_body(draft_pattern(kind), body)
    cloth = mesh(placed, vertices=FEW)
    (item,) = garment_items(cloth, start_points(cloth, body), body, placements)
    assert not len(item.pinned)


@pytest.mark.parametrize(
    "wrong", [{"pattern": "tee.json"}, {"body": 3}, {"fabric": 3}, {"vertices": "many"}]
)
@pytest.mark.wrong_types
def test_an_argument_of_another_type_is_a_type_error_that_helps(wrong):
    with pytest.raises(TypeError, match="wanted a"):
        drape_pattern(**{"pattern": garment("tee"), **wrong})
    with pytest.raises(TypeError, match="drape_pattern"):
        photograph(garment("tee"))
