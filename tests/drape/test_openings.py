"""Openings of a garment, and how often they go round each limb."""

import numpy as np
import pytest

from garmentimage.body.body import load_body
from garmentimage.body.body_measurements import presets
from garmentimage.drape.verdict.openings import BONES, bones, is_beyond, openings, turns

LIMBS = tuple(BONES)[1:]
LEFT_ARM, RIGHT_ARM, LEFT_LEG, RIGHT_LEG = range(4)


def ring(middle, axis, radius, count=24):
    """A circle round an axis, turning left as seen against it."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    u = np.cross(axis, [0.3, 0.5, 0.8])
    u /= np.linalg.norm(u)
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)[:, None]
    return np.asarray(middle) + radius * (np.cos(angle) * u + np.sin(angle) * np.cross(axis, u))


def along(body, share, first="left_shoulder_joint", second="left_elbow_joint"):
    """A place on a limb and the limb's direction there."""
    a, b = body.landmarks[first], body.landmarks[second]
    return a + share * (b - a), b - a


def tube(rows=5, columns=8):
    """A sleeve: triangles between rings of vertices, and the numbers of its two rims."""
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b = number[:-1], number[1:]
    c, d = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
    faces = np.concatenate(
        [np.stack([a, c, b], axis=-1).reshape(-1, 3), np.stack([c, d, b], axis=-1).reshape(-1, 3)]
    )
    return faces, number[0], number[-1]


def test_a_tube_has_two_openings_and_a_closed_surface_none():
    faces, first, last = tube()
    assert sorted(sorted(line.tolist()) for line in openings(faces)) == [
        sorted(first.tolist()),
        sorted(last.tolist()),
    ]
    ball = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    assert openings(ball) == []


def test_openings_are_closed_where_panels_are_sewn_on_wrong_side_up():
    faces, first, last = tube()
    mixed = faces.copy()
    mixed[5:30] = mixed[5:30, ::-1]
    found = openings(mixed)
    assert sorted(sorted(line.tolist()) for line in found) == [
        sorted(first.tolist()),
        sorted(last.tolist()),
    ]
    places = tube_places()
    lines = {name: np.array([[-50.0, 0, 0], [50, 0, 0]]) for name in BONES}
    lines["head"] = lines["head"] + [0, 100, 0]
    assert sum(np.array(turns(places[line], lines)) for line in found).tolist() == [0, 0, 0, 0]


def tube_places(rows=5, columns=8):
    """Where the vertices of `tube` lie, round the x axis."""
    angle = 2 * np.pi * np.arange(columns) / columns
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.array([(x, *yz) for x in range(rows) for yz in ring], float)


def test_neighbours_in_an_opening_are_joined_by_an_edge_of_the_cloth():
    faces, _, _ = tube()
    edges = {frozenset(e) for f in faces.tolist() for e in zip(f, f[1:] + f[:1], strict=True)}
    for line in openings(faces):
        pairs = zip(line.tolist(), np.roll(line, -1).tolist(), strict=True)
        assert all(frozenset(pair) in edges for pair in pairs)


@pytest.mark.parametrize("name", presets())
def test_a_ring_round_an_arm_turns_round_that_arm_alone(name):
    body = load_body(name)
    lines = bones(body)
    middle, axis = along(body, 0.6)
    once = turns(ring(middle, axis, 9.0), lines)
    assert np.abs(once).tolist() == [1, 0, 0, 0]
    assert turns(ring(middle, -axis, 9.0), lines) == tuple(-t for t in once)


def test_a_ring_beside_the_arm_turns_round_nothing():
    body = load_body()
    middle, axis = along(body, 0.6)
    assert turns(ring(middle + np.array([0, 30.0, 0]), axis, 9.0), bones(body)) == (0, 0, 0, 0)
    assert turns(ring([0, 100.0, 60.0], [0, 1, 0], 20.0), bones(body)) == (0, 0, 0, 0)


def test_a_line_that_goes_twice_round_turns_twice():
    body = load_body()
    middle, axis = along(body, 0.6)
    line = ring(middle, axis, 9.0)
    once, twice = (turns(x, bones(body)) for x in (line, np.concatenate([line, line])))
    assert twice == tuple(2 * t for t in once)


def test_a_sleeve_that_is_pulled_along_its_arm_keeps_its_turns():
    body = load_body()
    lines = bones(body)
    counts = set()
    for share in np.linspace(0.1, 1.6, 12):
        middle, axis = along(body, share)
        counts.add(turns(ring(middle, axis, 14.0 - 4 * share), lines))
    assert len(counts) == 1


@pytest.mark.parametrize("tilt", [0.0, 0.05, -0.05])
def test_a_hem_keeps_its_turns_when_it_is_lifted_over_the_chest(tilt):
    """Below the middle of the chest it goes round both legs; above, round every limb but the legs,
    the other way round."""
    body = load_body()
    lines = bones(body)
    shoulder, neck = body.landmarks["left_shoulder_joint"][1], body.landmarks["neck_joint"][1]
    hips = body.landmarks["left_hip_joint"][1]
    chest = hips + 0.7 * (neck - hips)
    axis = [tilt, 1.0, 0.0]
    low, high = (turns(ring([0, y, 0], axis, 35.0), lines) for y in (chest - 12, chest + 2))
    assert low == high
    assert abs(low[LEFT_LEG]) == 1 and low[LEFT_LEG] == low[RIGHT_LEG]
    assert low[LEFT_ARM] == low[RIGHT_ARM] == 0
    assert chest + 2 < shoulder


def test_the_neckline_turns_round_no_limb_but_the_four_together():
    """Round the head alone is the same as round both arms and both legs the other way."""
    body = load_body()
    neck = body.landmarks["neck_joint"] + [0, 4.0, 0]
    counts = turns(ring(neck, [0, 1, 0], 9.0), bones(body))
    assert len(set(counts)) == 1 and abs(counts[0]) == 1


def test_an_arm_that_slips_out_of_its_ring_is_detected():
    body = load_body()
    middle, axis = along(body, 0.6)
    line = ring(middle, axis, 9.0)
    before, after = (turns(x, bones(body)) for x in (line, line + np.array([0, 0, 25.0])))
    changed = [limb for limb, a, b in zip(LIMBS, before, after, strict=True) if a != b]
    assert changed == ["left arm"]


def test_a_mirrored_ring_turns_round_the_other_arm():
    body = load_body()
    middle, axis = along(body, 0.6)
    line = ring(middle, axis, 9.0)
    left, right = turns(line, bones(body)), turns(line * [-1, 1, 1], bones(body))
    assert (left[LEFT_ARM], left[RIGHT_ARM]) == (-right[RIGHT_ARM], -right[LEFT_ARM])
    assert left[LEFT_ARM] != 0 and right[RIGHT_ARM] != 0


def test_an_opening_at_the_feet_is_beyond_a_leg_and_one_at_the_shins_is_not():
    body = load_body("mean-female")
    leg = bones(body)["left leg"]
    ankle = body.landmarks["left_ankle_joint"]
    at = lambda height: ring([ankle[0], height, ankle[2]], [0, 1, 0], 8)  # noqa: E731
    assert is_beyond(at(1.0), leg)
    assert not is_beyond(at(20.0), leg)
    arm = bones(body)["left arm"]
    wrist, way = along(body, 1.0, "left_elbow_joint", "left_wrist_joint")
    assert not is_beyond(ring(wrist + 5 * way / np.linalg.norm(way), way, 8), arm)
    assert is_beyond(ring(wrist + 20 * way / np.linalg.norm(way), way, 8), arm)
