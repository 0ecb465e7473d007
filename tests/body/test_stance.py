"""Stance: bodies that wear something hold their legs upright."""

import numpy as np
import pytest

from garmentimage.body.body import Body, load_body
from garmentimage.body.body_measurements import presets
from garmentimage.body.stance import WORN_LEG_ANGLE, stand_straight
from garmentimage.drape.solver.distance_field import surface_distance


@pytest.fixture(params=presets())
def body(request):
    return load_body(request.param)


def leg_angle(body: Body) -> float:
    way = body.landmarks["left_ankle_joint"] - body.landmarks["left_hip_joint"]
    return float(np.arctan2(way[0], -way[1]))


def test_legs_are_upright_and_feet_on_the_floor(body):
    straight = stand_straight(body)
    assert leg_angle(body) > 2 * WORN_LEG_ANGLE
    assert leg_angle(straight) == pytest.approx(WORN_LEG_ANGLE, abs=np.deg2rad(1))
    assert straight.vertices[:, 1].min() == pytest.approx(0, abs=1e-9)


def test_the_trunk_and_the_arms_stay_but_for_the_floor(body):
    straight = stand_straight(body)
    above = body.vertices[:, 1] > body.landmarks["left_hip_joint"][1]
    moved = (straight.vertices - body.vertices)[above]
    np.testing.assert_allclose(moved[:, [0, 2]], 0, atol=1e-9)
    np.testing.assert_allclose(moved[:, 1], moved[0, 1], atol=1e-9)
    assert 0 < moved[0, 1] < 2


def test_legs_do_not_grow_into_each_other(body):
    straight = stand_straight(body)
    low = straight.vertices[straight.vertices[:, 1] < 0.6 * straight.landmarks["crotch"][1]]
    sides = np.sign(
        body.vertices[straight.vertices[:, 1] < 0.6 * straight.landmarks["crotch"][1], 0]
    )
    assert (low[:, 0] * sides).min() > 0


def test_a_body_that_stands_straight_stays_as_it_is(body):
    once = stand_straight(body)
    again = stand_straight(once)
    assert np.abs(again.vertices - once.vertices).max() < 0.5


@pytest.mark.slow
def test_the_inside_of_a_leg_stays_inside():
    straight = stand_straight(load_body("mean-female"))
    field = surface_distance(straight.vertices, straight.faces)
    hip, ankle = straight.landmarks["left_hip_joint"], straight.landmarks["left_ankle_joint"]
    line = hip + np.linspace(0.1, 0.95, 30)[:, None] * (ankle - hip)
    assert field.at(line).max() < 0
