"""Laws of cloth: its weight, stretch, bending and friction are as computed by hand."""

from dataclasses import replace

import numpy as np
import pytest

from garmentimage.drape.mesh.bending import bending_matrix
from garmentimage.drape.solver._kernels_step import FRAME
from garmentimage.drape.solver.distance_field import empty_field
from garmentimage.drape.solver.solver import GRAVITY, Attachment, SolverSettings, solve
from tests.drape.sheets import ROW, SOFT, ball, floor, lying, sheet, standing, strip

AT_ONCE = SolverSettings(max_frames=600, gather_frames=0, stop_speed=0.01)
FREE = empty_field()


def held(points, vertices, axes="xyz"):
    """Hold vertices where they are, along some axes."""
    stiffness = np.zeros((len(vertices), 3))
    stiffness[:, ["xyz".index(a) for a in axes]] = np.inf
    return Attachment(np.asarray(vertices), points[vertices], stiffness)


def energy(rest, points, stretch):
    """Energy of the springs [erg]."""
    a, b = points[rest.edges].transpose(1, 0, 2)
    stiffness = stretch * rest.area / rest.length**2
    return 0.5 * (stiffness * (np.linalg.norm(b - a, axis=1) - rest.length) ** 2).sum()


@pytest.mark.slow
@pytest.mark.parametrize("links", [10, 20, 40])
def test_a_hanging_strip_stretches_by_the_known_amount_however_many_links_it_has(links):
    height = 100.0
    start = np.zeros((links + 1, 3))
    start[:, 1] = -np.linspace(0, height, links + 1)
    motion = solve(strip(links), start, FREE, SOFT, attachment=held(start, [0]), settings=AT_ONCE)
    assert motion.settled
    known = SOFT.weight * GRAVITY * height**2 / (2 * SOFT.stretch)
    assert -motion.points[-1, 1] - height == pytest.approx(known, rel=0.005)


@pytest.mark.parametrize("side", [4.0, 2.0])
def test_a_hanging_sheet_stretches_by_the_known_amount_at_any_mesh_size(side):
    flat, _, rest = sheet(int(24 / side) + 1, round(40 / (side * ROW)), side)
    start, height = standing(flat), np.ptp(flat[:, 1])
    top = np.flatnonzero(flat[:, 1] > height - 1e-6)
    motion = solve(rest, start, FREE, SOFT, attachment=held(start, top, "yz"), settings=AT_ONCE)
    assert motion.settled
    known = SOFT.weight * GRAVITY * height**2 / (2 * SOFT.stretch)
    assert -motion.points[flat[:, 1] < 1e-6, 1].mean() == pytest.approx(known, rel=0.06)


@pytest.mark.parametrize("side", [1.0, 0.75])
def test_a_stiff_ledge_sags_as_a_beam_does_at_any_mesh_size(side):
    """A clamped ledge sags by w l^4 / (8 B); the clamp is only as sharp as a triangle."""
    fabric = replace(SOFT, bend=4000.0, damping=20.0)
    flat, _, rest = sheet(round(12 / side) + 1, round(24 / (side * ROW)), side)
    start, x = lying(flat), flat[:, 0] - flat[:, 0].min()
    motion = solve(
        rest,
        start,
        FREE,
        fabric,
        attachment=held(start, np.flatnonzero(x < 4.01)),
        settings=AT_ONCE,
    )
    assert motion.settled
    known = fabric.weight * GRAVITY * (x.max() - x[x < 4.01].max()) ** 4 / (8 * fabric.bend)
    assert -motion.points[x > x.max() - 1e-6, 1].mean() == pytest.approx(known, rel=0.15)


@pytest.mark.parametrize("side", [2.0, 1.0])
@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2])
def test_a_roll_has_the_energy_of_a_plate_however_it_is_rolled_and_meshed(side, angle):
    flat, faces, _ = sheet(round(30 / side) + 1, round(30 / (side * ROW)), side)
    curvature = 0.05
    across = (flat - flat.mean(axis=0)) @ [np.cos(angle), np.sin(angle)]
    along = flat @ [-np.sin(angle), np.cos(angle)]
    turn = curvature * across
    rolled = np.column_stack([np.sin(turn), along * curvature, 1 - np.cos(turn)]) / curvature
    matrix = bending_matrix(faces, flat[faces], len(flat))
    found = (rolled * (matrix @ rolled)).sum() / np.prod(np.ptp(flat, axis=0))
    assert found == pytest.approx(curvature**2, rel=0.08)


def test_bending_has_no_energy_in_the_plane():
    flat, faces, _ = sheet(9, 10, 2.5)
    matrix = bending_matrix(faces, flat[faces], len(flat))
    sheared = flat @ [[1.2, 0.3], [-0.1, 0.8]]
    assert np.abs(matrix @ sheared).max() < 1e-9


def test_a_flat_sheet_on_a_level_floor_stays():
    flat, _, rest = sheet(9, 10, 2.5)
    start = lying(flat, SOFT.thickness)
    motion = solve(
        rest, start, floor(), SOFT, settings=replace(AT_ONCE, max_frames=30, stop_speed=0)
    )
    assert np.abs(motion.points - start).max() < 1e-9


def test_flat_cloth_without_gravity_has_no_forces():
    flat, _, rest = sheet(9, 10, 2.5)
    start = standing(flat)
    motion = solve(rest, start, FREE, SOFT, settings=replace(AT_ONCE, gravity=0.0, max_frames=30))
    assert np.abs(motion.points - start).max() < 1e-7


def test_energy_does_not_grow_without_gravity():
    flat, _, rest = sheet(7, 8, 2.5)
    fabric = replace(SOFT, damping=0.0)
    start = standing(flat * 1.3) + np.random.default_rng(3).normal(0, 0.3, (len(flat), 3))
    before = energy(rest, start, fabric.stretch)
    for frames in (2, 5, 20, 60):
        settings = SolverSettings(
            max_frames=frames, gather_frames=0, stop_speed=0, gravity=0.0, max_speed=1e4
        )
        motion = solve(rest, start, FREE, fabric, settings=settings)
        mass = fabric.weight * rest.vertex_area.sum()
        moving = 0.5 * mass * motion.speeds[-1] ** 2
        now = energy(rest, motion.points, fabric.stretch) + moving
        assert now < before
        before = now * 1.05


@pytest.mark.parametrize(("side", "bend"), [(1.5, 300.0), (2.5, 1000.0)])
def test_bending_does_not_drive_the_springs_without_gravity_and_air(side, bend):
    """Bending forces are kept for several steps, which once made crumpled cloth jitter for ever."""
    flat, _, rest = sheet(9, 10, side)
    fabric = replace(SOFT, bend=bend, damping=0.0)
    start = standing(flat) + np.random.default_rng(3).normal(0, 0.5, (len(flat), 3))
    settings = SolverSettings(
        max_frames=200, gather_frames=0, stop_speed=0, gravity=0.0, max_speed=1e4
    )
    speeds = solve(rest, start, FREE, fabric, settings=settings).speeds
    assert speeds[-1] < 0.15 * speeds[5]


def test_a_free_fall_obeys_gravity():
    flat, _, rest = sheet(9, 10, 2.5)
    start, frames = lying(flat), 12
    fabric = replace(SOFT, damping=0.0)
    settings = SolverSettings(max_frames=frames, gather_frames=0, stop_speed=0, max_speed=1e4)
    motion = solve(rest, start, FREE, fabric, settings=settings)
    known = GRAVITY * (frames * FRAME) ** 2 / 2
    fallen = start[:, 1] - motion.points[:, 1]
    # The half triangles at two sides of this sheet have added inertia, and lag behind.
    assert np.median(fallen) == pytest.approx(known, rel=0.05)


def test_cloth_on_a_ball_comes_to_rest_outside_it():
    flat, _, rest = sheet(13, 14, 2.5)
    motion = solve(rest, lying(flat, 18.0), ball(), SOFT, settings=replace(AT_ONCE, stop_speed=1.0))
    assert motion.settled
    assert ball().at(motion.points).min() > SOFT.thickness - 0.05


@pytest.mark.parametrize(("share", "stays"), [(0.8, True), (1.25, False)])
def test_cloth_slides_on_slopes_steeper_than_its_friction_and_on_no_others(share, stays):
    angle = np.arctan(SOFT.friction * share)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    flat, _, rest = sheet(7, 8, 2.5)
    start = lying(flat, SOFT.thickness) @ turn
    settings = SolverSettings(max_frames=40, gather_frames=0, stop_speed=0)
    motion = solve(rest, start, floor(angle), SOFT, settings=settings)
    slid = np.linalg.norm(motion.points - start, axis=1)
    assert slid.max() < 1e-3 if stays else slid.min() > 1.0


def test_sliding_cloth_gains_speed_as_friction_allows():
    angle, frames = np.arctan(0.8), 12
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    flat, _, rest = sheet(7, 8, 2.5)
    settings = SolverSettings(max_frames=frames, gather_frames=0, stop_speed=0)
    fabric = replace(SOFT, damping=0.0)
    start = lying(flat, SOFT.thickness) @ turn
    motion = solve(rest, start, floor(angle), fabric, settings=settings)
    gain = GRAVITY * (np.sin(angle) - fabric.friction * np.cos(angle))
    assert motion.speeds[-1] == pytest.approx(gain * frames * FRAME, rel=0.1)
