"""Tape rules: known shapes give known lengths, poses do not matter, records are as measured."""

from dataclasses import asdict, fields
from functools import cache

import numpy as np
import pytest

from garmentimage.body.body import Body, load_body
from garmentimage.body.body_measurements import NAMES, BodyMeasurements, presets
from garmentimage.body.measure import (
    ACROSS,
    UP,
    cut,
    measure,
    outline_at,
    skin_on_line,
    taut_girth,
    taut_length,
    trunk_outline,
)

POSE_TOL = 0.01
"""Largest share by which a measurement may differ between poses."""

measured = cache(lambda name, pose: measure(load_body(name, pose)))


def tube(radius=10.0, height=40.0, x=0.0, sides=90):
    """A closed prism along y with its foot on the floor."""
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([x + radius * np.cos(turn), 0 * turn, radius * np.sin(turn)], axis=1)
    ends = np.array([[x, 0, 0], [x, height, 0]])
    k, n = np.arange(sides), (np.arange(sides) + 1) % sides
    faces = [(k, k + sides, n), (n, k + sides, n + sides)]
    faces += [(k, n, 0 * k + 2 * sides), (n + sides, k + sides, 0 * k + 2 * sides + 1)]
    vertices = np.concatenate([ring, ring + height * UP, ends])
    return vertices, np.concatenate([np.stack(face, axis=1) for face in faces])


def two_tubes():
    (a, faces), (b, _) = tube(), tube(radius=3.0, x=25.0)
    vertices = np.concatenate([a, b])
    faces = np.concatenate([faces, faces + len(a)]).astype(np.int32)
    return Body(vertices, faces, "tubes", "t", {})


def test_a_girth_is_taken_round_one_of_two_tubes():
    outlines = sorted(cut(two_tubes(), 20 * UP, UP), key=lambda ring: ring[:, 0].max())
    girths = [taut_girth(ring[:, [0, 2]]) for ring in outlines]
    assert np.allclose(girths, [2 * np.pi * 10, 2 * np.pi * 3], rtol=1e-3)


def test_the_trunk_is_the_tube_in_the_middle():
    assert np.abs(trunk_outline(two_tubes(), 20.0)).max(0)[0] == pytest.approx(10)
    beside = outline_at(two_tubes(), np.array([26.0, 20, 0]), UP)
    assert beside[:, 0].min() == pytest.approx(22)


def test_a_line_meets_the_skin_where_it_enters_and_leaves():
    hits = np.unique(skin_on_line(two_tubes(), 0, np.array([0.0, 20.3, 0.0])).round(6))
    assert np.allclose(hits, [-10, 10, 22, 28], atol=0.01)


def test_a_tape_bridges_a_hollow_and_follows_a_bump():
    start, end = np.array([0.0, 0.0]), np.array([10.0, 0.0])
    hollow, bump = np.array([[5.0, -3.0]]), np.array([[5.0, 3.0], [5.0, 1.0]])
    assert taut_length(hollow, start, end) == 10
    assert taut_length(bump, start, end) == pytest.approx(2 * np.hypot(5, 3))


def test_a_tape_does_not_reach_beyond_its_ends():
    start, end = np.array([0.0, 0.0]), np.array([10.0, 0.0])
    assert taut_length(np.array([[-1.0, 5.0], [11.0, 5.0]]), start, end) == 10


@pytest.mark.parametrize("name", presets())
def test_the_shipped_record_is_what_is_measured(name):
    assert measured(name, "t") == presets()[name]


@pytest.mark.parametrize("name", presets())
def test_the_pose_does_not_change_a_measurement(name):
    t, a = asdict(measured(name, "t")), asdict(measured(name, "a"))
    off = {key: (t[key], a[key]) for key in NAMES if abs(t[key] / a[key] - 1) > POSE_TOL}
    assert not off


def test_a_scaled_body_has_scaled_measurements():
    body, factor = load_body(), 1.1
    landmarks = {name: factor * place for name, place in body.landmarks.items()}
    large = Body(factor * body.vertices, body.faces, body.name, body.pose, landmarks)
    small, big = (np.array(list(asdict(measure(b)).values())) for b in (body, large))
    crotch = [field.name for field in fields(BodyMeasurements)].index("total_crotch_length")
    # The strip for the crotch tape keeps its width in cm.
    keep = np.arange(len(small)) != crotch
    assert np.allclose(big[keep], factor * small[keep], atol=0.11)
    assert big[crotch] == pytest.approx(factor * small[crotch], rel=0.01)


PLAUSIBLE = {
    "mean-female": {
        "stature": (164, 168),
        "bust_girth": (87, 93),
        "waist_girth": (71, 77),
        "hip_girth": (96, 102),
        "back_waist_length": (38, 42),
        "arm_length": (52, 58),
        "shoulder_length": (11.5, 13.5),
        "thigh_girth": (53, 60),
        "total_crotch_length": (66, 76),
        "head_girth": (52, 57),
    },
    "mean-male": {
        "stature": (175, 179),
        "bust_girth": (97, 103),
        "waist_girth": (84, 90),
        "hip_girth": (97, 103),
        "back_waist_length": (40, 47),
        "arm_length": (57, 63),
        "shoulder_length": (13, 16),
        "thigh_girth": (54, 62),
        "total_crotch_length": (66, 78),
        "head_girth": (55, 60),
    },
    "slim-female": {
        "stature": (164, 168),
        "bust_girth": (76, 80),
        "waist_girth": (57, 61),
        "hip_girth": (83, 87),
        "back_waist_length": (38, 42),
        "arm_length": (52, 58),
        "shoulder_length": (11.5, 13.5),
        "thigh_girth": (45, 51),
        "total_crotch_length": (62, 72),
        "head_girth": (52, 57),
    },
}


@pytest.mark.parametrize("name", PLAUSIBLE)
def test_bodies_of_a_usual_size_are_near_size_tables(name):
    record = asdict(measured(name, "t"))
    off = {
        key: record[key]
        for key, (low, high) in PLAUSIBLE[name].items()
        if not low <= record[key] <= high
    }
    assert not off


@pytest.mark.parametrize("name", presets())
def test_lengths_and_levels_agree(name):
    body = measured(name, "t")
    assert body.shoulder_width < 2 * body.shoulder_length + body.neck_base_girth / 2
    assert body.back_waist_length >= body.cervical_height - body.waist_height
    assert body.front_waist_length >= body.neck_point_height - body.waist_height
    assert body.total_crotch_length > 2 * (body.waist_height - body.crotch_height)
    assert body.head_girth > body.neck_base_girth
    assert body.waist_girth < body.hip_girth and body.waist_girth < body.bust_girth


@pytest.mark.parametrize("pose", ["t", "a"])
def test_arms_are_no_part_of_the_trunk(pose):
    body = load_body("short-round-male", pose)
    for name in ("waist_front", "left_underbust", "left_bust_point"):
        outline = trunk_outline(body, body.landmarks[name][1])
        assert np.abs(outline @ ACROSS).max() < body.landmarks["left_shoulder_joint"][0] * 1.3
