import hashlib
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from garmentimage.drape.fabric import FABRICS, load_fabric
from garmentimage.drape.solver.distance_field import empty_field
from garmentimage.drape.solver.solver import Attachment, SolverSettings, solve
from garmentimage.errors import DrapeError
from tests.drape.sheets import SOFT, ball, lying, sheet, standing

ROOT = Path(__file__).parents[2]
FREE = empty_field()
OFF_MIDDLE = np.array([1.03, 0.0, 2.07])


def on_a_ball():
    """A sheet that falls on a ball, off its middle."""
    flat, _, rest = sheet(9, 10, 3.0)
    start = lying(flat, 17.0) + OFF_MIDDLE
    return solve(rest, start, ball(), SOFT, settings=SolverSettings(max_frames=40, gather_frames=2))


def digest(motion) -> str:
    return hashlib.sha256(motion.points.tobytes() + motion.speeds.tobytes()).hexdigest()


def test_the_same_cloth_gives_the_same_bits_in_every_process():
    code = "from tests.drape.test_solver import digest, on_a_ball; print(digest(on_a_ball()))"
    other = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.strip()
    assert digest(on_a_ball()) == digest(on_a_ball()) == other


def test_mirrored_cloth_comes_to_the_mirrored_rest():
    flat, _, rest = sheet(9, 10, 3.0)
    start = lying(flat, 17.0) + OFF_MIDDLE
    mirror = np.array([-1.0, 1.0, 1.0])
    settings = SolverSettings(max_frames=60, gather_frames=2)
    right = solve(rest, start, ball(), SOFT, settings=settings)
    left = solve(rest, start * mirror, ball(), SOFT, settings=settings)
    assert np.abs(left.points * mirror - right.points).max() < 0.05


def test_seams_that_gape_widely_close_without_strain():
    """The middle row of a sheet starts far from its neighbours, as a welded seam does."""
    flat, _, rest = sheet(9, 10, 2.5)
    start = standing(flat)
    start[flat[:, 1] > flat[:, 1].mean() + 0.1, 2] += 20.0
    motion = solve(
        rest, start, FREE, SOFT, settings=SolverSettings(max_frames=90, gather_frames=90)
    )
    a, b = motion.points[rest.edges].transpose(1, 0, 2)
    assert np.abs(np.linalg.norm(b - a, axis=1) / rest.length - 1).max() < 0.02


def test_crumpled_cloth_does_not_explode():
    flat, _, rest = sheet(9, 10, 2.5)
    start = np.random.default_rng(5).normal(0, 20, (len(flat), 3))
    motion = solve(
        rest, start, FREE, SOFT, settings=SolverSettings(max_frames=60, gather_frames=60)
    )
    assert np.isfinite(motion.points).all()
    assert motion.speeds[-1] < 20
    assert np.abs(motion.points).max() < 100


def test_a_pinned_vertex_does_not_move_and_one_pinned_in_height_slides_level():
    flat, _, rest = sheet(9, 10, 2.5)
    start = standing(flat)
    top = np.flatnonzero(flat[:, 1] > flat[:, 1].max() - 1e-6)
    firm = Attachment(top, start[top], np.full((len(top), 3), np.inf))
    moved = solve(rest, start, FREE, SOFT, attachment=firm).points[top] - start[top]
    assert np.abs(moved).max() < 1e-9
    height_only = replace(firm, stiffness=np.tile([0, 1e9, 0], (len(top), 1)))
    pushed = start + np.where(flat[:, :1] > 0, [3.0, 0, 0], [-3.0, 0, 0])
    moved = solve(rest, pushed, FREE, SOFT, attachment=height_only).points[top] - pushed[top]
    assert np.abs(moved[:, 1]).max() < 1e-3
    assert np.abs(moved[:, 0]).max() > 1.0


def test_cloth_that_starts_in_the_body_is_pushed_out_gently():
    flat, _, rest = sheet(9, 10, 2.5)
    motion = solve(rest, lying(flat, 11.0), ball(), SOFT, settings=SolverSettings(max_frames=80))
    assert ball().at(motion.points).min() > SOFT.thickness - 0.05
    assert np.abs(motion.points).max() < 30


def test_no_time_is_no_motion():
    flat, _, rest = sheet(3, 2, 2.5)
    start = standing(flat)
    motion = solve(rest, start, FREE, SOFT, settings=SolverSettings(max_frames=0))
    assert (motion.frames, motion.settled, len(motion.speeds)) == (0, False, 0)
    assert np.array_equal(motion.points, start)


def test_the_start_is_left_as_it_was():
    flat, _, rest = sheet(5, 4, 2.5)
    start = standing(flat)
    before = start.copy()
    solve(rest, start, FREE, SOFT, settings=SolverSettings(max_frames=3, gather_frames=0))
    assert np.array_equal(start, before)


def test_fabrics_go_by_name():
    assert load_fabric("denim") is FABRICS["denim"]
    with pytest.raises(DrapeError, match=r"'denin'; did you mean denim"):
        load_fabric("denin")
    with pytest.raises(DrapeError, match="choose cotton"):
        load_fabric("zzz")


@pytest.mark.parametrize("name", sorted(FABRICS))
def test_fabrics_are_those_of_everyday_clothes(name):
    fabric = FABRICS[name]
    assert 0.004 < fabric.weight < 0.05
    assert 10 <= fabric.bend <= 1000
    assert 0.2 <= fabric.friction <= 0.7
    assert 0.3 <= fabric.thickness <= 0.5
    own_weight = fabric.weight * 981 * 100 / fabric.stretch
    assert own_weight < 0.06, "a metre of it would stretch by too much under its own weight"


@pytest.mark.parametrize(
    ("name", "value"),
    [("weight", 150.0), ("stretch", -1.0), ("thickness", 0.0), ("friction", float("nan"))],
)
def test_a_fabric_that_cannot_be_is_refused(name, value):
    with pytest.raises(DrapeError, match=f"a fabric's {name} is"):
        replace(load_fabric("cotton"), **{name: value})
