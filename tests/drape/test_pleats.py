"""Pressed pleats worn: folded as far as they are pressed, open below."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage import draft_pattern
from garmentimage.drape import drape_pattern
from garmentimage.drape.mesh import mesh, rest_of
from garmentimage.drape.mesh.bending import bending_matrix
from garmentimage.drape.start.pleats import folded_flat, pressed_pleats
from garmentimage.geometry import CHORDS
from garmentimage.pattern import fold_lines

KINDS = ("knife", "box", "inverted")
VERTICES = 1200


@pytest.fixture(scope="module", params=KINDS)
def pattern(request):
    return draft_pattern("pleated-skirt", pleats=request.param)


@pytest.fixture(scope="module")
def cloth(pattern):
    return mesh(pattern, vertices=VERTICES)


@pytest.fixture(scope="module")
def worn(pattern):
    return drape_pattern(pattern)


def test_triangles_have_sides_along_every_fold(pattern, cloth):
    ends = cloth.vertex_faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    sides = {frozenset(side) for side in ends.tolist()}
    assert {frozenset(fold) for fold in cloth.folds.tolist()} <= sides
    for pleat in pattern.pleats:
        for fold in fold_lines(pattern, pleat):
            middle = (np.array(fold.start) + fold.end) / 2
            own = cloth.panel == [p.name for p in pattern.panels].index(pleat.panel)
            assert np.hypot(*(cloth.flat[own] - middle).T).min() < 2.0


def test_the_cloth_is_that_of_the_garment(pattern, cloth):
    assert cloth.pattern is pattern
    area = sum(abs(panel.outline.area) for panel in pattern.panels)
    assert rest_of(cloth).face_area.sum() == pytest.approx(area, rel=2e-3)
    for side, corners in cloth.sides.items():
        points = pattern.curve(side).sample(CHORDS)
        ends = cloth.flat[corners[[0, -1]]]
        assert np.abs(ends - points[[0, -1]]).max() < 0.01
    for stitch in pattern.stitches:
        a, b = (cloth.vertex[cloth.sides[side]] for side in stitch.sides)
        assert (a == b[::-1]).all()


def test_folded_flat_a_panel_is_as_wide_as_its_waistband(pattern, cloth):
    flat, outward = folded_flat(cloth)
    names = [panel.name for panel in pattern.panels]
    widths = {}
    for name in ("skirt_front", "waistband_front"):
        line = np.concatenate(
            [
                corners
                for side, corners in cloth.sides.items()
                if side.panel == name
                and pattern.by_name[name].edges[side.edge].label in ("waist", "band_lower")
            ]
        )
        assert (cloth.panel[line] == names.index(name)).all()
        widths[name] = np.ptp(flat[line, 0])
    assert widths["skirt_front"] == pytest.approx(widths["waistband_front"], abs=0.01)
    level = 1 if pattern.pleats[0].fold == "box" else -1
    assert (level * outward >= 0).all() and (level * outward > 0).any()


def test_cloth_does_not_resist_bending_at_folds(cloth):
    rest = rest_of(cloth)
    sides = np.linalg.inv(rest.inverse).transpose(0, 2, 1)
    flat = np.concatenate([np.zeros((len(sides), 1, 2)), sides], axis=1)
    stiff = bending_matrix(rest.faces, flat, cloth.vertex_count)
    pressed = bending_matrix(rest.faces, flat, cloth.vertex_count, rest.folds)
    changed = abs(stiff - pressed).sum(axis=1) > 1e-9
    assert changed[rest.folds].any(axis=1).all()
    assert pressed.trace() < stiff.trace()


def test_a_garment_without_pleats_is_held_by_nothing(pattern):
    plain = mesh(replace(pattern, pleats=()), vertices=VERTICES)
    assert pressed_pleats(plain, np.arange(plain.vertex_count)) is None
    assert not len(plain.folds)
    assert folded_flat(plain)[0] is plain.flat


def test_pleated_skirts_are_worn_without_a_fault(worn):
    assert not worn.report.faults


def test_pleats_stay_folded_where_they_are_pressed(pattern, worn):
    held = pressed_pleats(worn.cloth, np.arange(worn.cloth.vertex_count))
    on = np.einsum("nk,nkj->nj", held.shares, worn.points[held.triangles])
    a, b, c = worn.points[held.triangles].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    away = worn.points[held.vertices] - on
    assert np.median(np.linalg.norm(away, axis=1)) < 1.0
    # Beneath the panel, or on it in a box pleat.
    side = 1 if pattern.pleats[0].fold == "box" else -1
    assert np.median(side * (away * normal).sum(axis=1)) > 0.1


def test_a_pleat_that_is_not_pressed_hangs_open(pattern):
    loose = drape_pattern(replace(pattern, pleats=()), vertices=VERTICES)
    cloth = mesh(loose.cloth.pattern, vertices=VERTICES)
    folds = replace(cloth.pattern, pleats=pattern.pleats)
    own = replace(cloth, pattern=folds)
    held = pressed_pleats(own, np.arange(own.vertex_count))
    on = np.einsum("nk,nkj->nj", held.shares, loose.points[held.triangles])
    assert np.median(np.linalg.norm(loose.points[held.vertices] - on, axis=1)) > 1.0
