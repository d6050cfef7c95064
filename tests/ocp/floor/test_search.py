"""The floor: against other answers, what it says of itself, errors."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from floors import coarse_floors
from moves import ARM

import quietarm as qa
from quietarm.ocp import SolveStatus
from quietarm.ocp.floor.energy_floor import Level

pytestmark = pytest.mark.slow


@cache
def coarse_of(task, starts=1, **settings):
    """`energy_floor` from one start and on coarse grids, that solves nothing twice."""
    with coarse_floors():
        return qa.energy_floor(task, starts=starts, **settings)


def test_limited_to_200_the_arm_needs_what_other_transcriptions_find():
    # benchmarks/README.md, floor_against_peers.py: 0.101326 J by rockit at 100 intervals, 0.3 %
    # above the refined floor.
    floor = coarse_of(replace(ARM, acceleration_limit=200.0))
    assert floor.energy == pytest.approx(0.1013, rel=0.01)
    assert floor.motion.peak_acceleration <= 200 * (1 + 1e-3)


@pytest.mark.parametrize(
    "limits",
    [
        {},
        {"torque_limit": 0.5, "speed_limit": 3.6},
        {"acceleration_limit": (-60.0, 40.0), "torque_speed": ((0.6, 0.0), (0.2, 3.6))},
    ],
    ids=["no limit", "torque and speed", "direction and torque by speed"],
)
def test_no_plan_is_cheaper(solved, limits):
    task = replace(ARM, **limits)
    floor = coarse_of(task)
    plan = solved(task, 6, starts=1)
    assert floor.energy < plan.energy
    for limit in task.limits:
        assert limit.keeps(limit.peak_of(floor.motion), 1e-3)
        assert limit.peak_of(floor.motion) > 0.9 * limit.size  # the limit is in the way


def test_a_smooth_motion_comes_to_the_same_floor():
    free, smooth = coarse_of(ARM), coarse_of(ARM, smooth=True, starts=2)
    # Jolts take up to 4e-5 of the move at any level, which no level shows.
    room = free.discretisation_error + smooth.discretisation_error + 1e-4 * free.energy
    assert smooth.energy == pytest.approx(free.energy, abs=room)
    assert np.any(smooth.free.jerk)
    assert not np.any(free.free.jerk)
    h, a, jerk = smooth.free.lengths, smooth.free.acceleration, smooth.free.jerk
    assert np.append(a[1:], 0.0) == pytest.approx(a + h * jerk, abs=1e-5 * np.abs(a).max())
    assert a[0] == 0.0


def test_a_plant_of_two_modes_has_a_floor(tasks, solved):
    task = replace(tasks["two links"], acceleration_limit=60.0)
    floor = coarse_of(task)
    assert floor.residual < 1e-8
    assert 0.9 * solved(task, 10, starts=1).energy < floor.energy
    assert floor.energy < solved(task, 10, starts=1).energy


def test_the_figures_are_those_of_the_independent_integrator():
    floor = coarse_of(ARM)
    check = floor.verification
    assert floor.residual < 1e-8
    assert floor.status is SolveStatus.OPTIMAL
    assert check.fixed_step_energy == floor.levels[-1].energy
    assert check.energy_difference == pytest.approx(check.fixed_step_energy - floor.energy)
    assert abs(check.energy_difference) < 1e-3 * floor.energy
    assert check.steps == floor.levels[-1].steps == floor.free.steps
    angle, speed = floor.free.boundaries(0.0)
    assert (angle[-1], speed[-1]) == pytest.approx((math.pi / 2, 0.0), abs=1e-6)


def test_what_is_left_is_what_finer_grids_gain():
    # Against a much finer grid: the estimate is of the right size, and errs to the safe side.
    rough, fine = coarse_of(ARM), coarse_of(ARM, energy_tolerance=3e-4)
    assert fine.levels[: len(rough.levels)] == rough.levels
    assert len(fine.levels) > len(rough.levels)
    gained = rough.levels[-1].energy - fine.levels[-1].energy
    assert 0 < gained < rough.discretisation_error < 5 * gained
    assert fine.discretisation_error < rough.discretisation_error
    for level, finer in zip(fine.levels[:-1], fine.levels[1:], strict=True):
        assert 1.5 * level.steps < finer.steps < 4 * level.steps
        assert finer.energy < level.energy


@pytest.mark.parametrize(
    ("energies", "ratio", "left"),
    [
        ([1.0, 0.9], None, 0.1),
        ([1.0, 0.7, 0.5], 2 / 3, 0.4),
        ([1.0, 0.9, 0.8], 1.0, 0.4),
        ([1.0, 0.9, 1.2, 1.19], None, 0.3),
    ],
)
def test_the_estimate_continues_the_falls_of_the_energy(energies, ratio, left):
    levels = tuple(Level(100 * 2**i, energy) for i, energy in enumerate(energies))
    floor = replace(coarse_of(ARM), levels=levels)
    assert floor.ratio == (None if ratio is None else pytest.approx(ratio))
    missed = -floor.verification.energy_difference
    assert floor.discretisation_error == pytest.approx(left + missed)
    assert missed > 0


SMOOTH = {"smooth": True, "starts": 1, "energy_tolerance": 0.02}


def test_a_jerk_limit_is_kept_and_no_plan_needs_less(tasks, solved):
    task = replace(tasks["single link"], jerk_limit=1500.0)  # less than of a plan of least energy
    floor = coarse_of(task, **SMOOTH)
    assert floor.motion.peak_jerk == pytest.approx(1500.0, rel=1e-3)
    assert floor.motion.peak_jerk <= 1500.0 * (1 + 1e-6)
    assert floor.motion.peak_jerk == np.abs(floor.free.jerk).max()
    assert floor.energy < solved(task).energy
    with pytest.raises(ValueError, match="smooth"):
        qa.energy_floor(task)


def test_the_least_jerk_of_a_rigid_joint_is_its_closed_form():
    # A joint beside a link that nothing excites. From rest to rest with a continuous acceleration,
    # at rest too: +J, -J, +J for T/4, T/2, T/4 goes J T^3/32.
    # Less than that is not feasible; on a grid, only a little more is.
    rigid = qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, beta1=0.0, c=0.03)
    least = 32 * 1.5 / 1.0**3
    with pytest.raises(qa.InfeasibleTaskError, match="jerk limit") as error:
        qa.energy_floor(qa.PointToPoint(rigid, 1.5, 1.0, jerk_limit=0.9 * least), **SMOOTH)
    said = float(str(error.value).split("jerk limit ")[1].split()[0])
    assert least < said < 1.005 * least  # said with a room of 0.001
    enough = qa.PointToPoint(rigid, 1.5, 1.0, jerk_limit=1.05 * least)
    assert qa.energy_floor(enough, **SMOOTH).motion.peak_jerk <= 1.05 * least * (1 + 1e-6)


def test_limits_that_nothing_meets_are_named_with_what_would_do():
    task = replace(ARM, torque_limit=0.05, speed_limit=9.0)
    with pytest.raises(qa.InfeasibleTaskError, match="torque limit") as error:
        coarse_of(task)
    enough = float(str(error.value).split("torque limit ")[1].split(" N m")[0])
    assert 0.05 < enough < 0.5
    roomy = replace(task, torque_limit=1.1 * enough)
    assert coarse_of(roomy).motion.peak_torque < 1.11 * enough
