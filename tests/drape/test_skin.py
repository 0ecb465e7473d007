"""No skin comes through the middle of a triangle, and what does is measured."""

import numpy as np
import pytest

import garmentimage as gi
from garmentimage.body.body import load_body
from garmentimage.drape.solver.distance_field import body_field
from garmentimage.drape.solver.solver import SolverSettings, solve
from garmentimage.drape.verdict.skin import deepest
from tests.corpus import unpacked
from tests.drape.sheets import SOFT, ball, lying, sheet

RADIUS = 15.0


@pytest.mark.parametrize("side", [5.0, 8.0])
def test_coarse_cloth_on_a_ball_covers_it_between_its_vertices(side):
    """A chord of 8 cm would lie 0.5 cm deeper than its ends on a ball of 15 cm."""
    flat, faces, rest = sheet(int(60 / side), int(60 / side), side)
    field = ball(RADIUS)
    start = lying(flat, RADIUS + 2) + np.array([1.03, 0.0, 2.07])
    points = solve(
        rest, start, field, SOFT, settings=SolverSettings(max_frames=90, gather_frames=2)
    ).points
    corners = points[faces]
    middles = np.concatenate(
        [corners.mean(axis=1), *(corners[:, [k, k - 1]].mean(axis=1) for k in range(3))]
    )
    assert field.at(middles).min() > 0
    # Nor does it stand off by more than it must.
    assert np.percentile(field.at(points), 10) < 1.0


def triangle_over(place, size):
    """One level triangle whose middle lies at a place."""
    turn = np.deg2rad([90, 210, 330])
    around = size * np.stack([np.cos(turn), 0 * turn, np.sin(turn)], axis=1)
    return place + around, np.array([[0, 1, 2]])


def test_the_depth_in_the_middle_of_a_triangle_counts():
    body = load_body()
    crown = body.vertices[body.vertices[:, 1].argmax()]
    points, faces = triangle_over(crown - [0, 1.0, 0], 30.0)
    assert body_field(body).at(points).min() > 5
    assert deepest(points, faces, body) == pytest.approx(1.0, abs=0.3)
    assert deepest(points + np.array([0, 3.0, 0]), faces, body) == 0.0


def test_fingers_between_the_vertices_of_a_cuff_do_not_count():
    body = load_body()
    hand = body.vertices[body.vertices[:, 0].argmax()]
    points, faces = triangle_over(hand - [2.0, 0, 0], 12.0)
    inside = body.landmarks["left_elbow_joint"]
    assert deepest(points, faces, body) == 0.0
    assert deepest(*triangle_over(inside, 12.0), body) > 1.0


@pytest.mark.corpus
def test_no_skin_shines_through_at_the_bust(tmp_path):
    folder = unpacked("faults/faults.tar.xz", tmp_path)
    files = sorted(folder.rglob("public-skin/*.json"))
    assert files
    for path in files:
        worn = gi.drape_pattern(gi.load_pattern(path))
        centres = worn.points[worn.cloth.vertex_faces].mean(axis=1)
        bust = (
            (np.abs(centres[:, 1] - 120) < 8) & (centres[:, 2] > 0) & (np.abs(centres[:, 0]) < 14)
        )
        assert bust.sum() > 20
        assert deepest(worn.points, worn.cloth.vertex_faces[bust], worn.body) < 0.05, path.name
