"""The floor: against closed forms, other answers, and what it says of itself."""

import json
import math
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from models import ArmOnFlexibleLink, Plant, SingleLinkManipulator, parameter
from ocp import (
    FileFormatError,
    Floor,
    InfeasibleTaskError,
    PointToPoint,
    SolverFailedError,
    SolveStatus,
    energy_floor,
)
from ocp.floor.answer import Level
from ocp.floor.program import FloorProgram

ROOT = Path(__file__).parents[3]
ARM = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
SHORT = {"starts": 1}


@pytest.fixture(scope="module")
def floor_of():
    """`energy_floor` that solves nothing twice."""
    return cache(lambda task, **settings: energy_floor(task, **settings))


@pytest.fixture
def rigid(_plants_of_this_test_are_forgotten):
    """A rigid joint beside a mode that nothing excites: tau = inertia theta'' + c theta'."""

    @dataclass(frozen=True)
    class Rigid(Plant):
        name: ClassVar[str] = "rigid"
        modes: ClassVar[int] = 1

        inertia: float = parameter(0.02, "kg m^2", "test")
        c: float = parameter(0.03, "N m s", "test")

        def modal_accelerations(self, joint, W, dW):
            return [-100.0 * W[0]]

        def torque(self, joint, W, dW, ddW):
            return self.inertia * joint.acceleration + self.c * joint.speed

        def tip_displacements(self, W):
            return [W[0]]

    return Rigid


# -- closed forms --


def _friction_floor(inertia, c, span, duration):
    """Least integral of |tau theta'| for tau = I theta'' + c theta', no limits.

    While the power is positive the energy is the gain of I v^2/2 plus the integral of c v^2, which
    for a given way is least at a constant speed v. While the torque is zero the joint coasts, its
    speed falling as exp(-c t/I), for nothing. So: a jolt to v, v held until t1, coasting down to
    x v, and a jolt to rest. With A = E/v^2 and D = span/v,

        A = I (1 + x^2)/2 + c t1,   D = t1 + (I/c) (1 - x),   x = exp(-c (T - t1)/I),

    and E = A (span/D)^2 is stationary where c (1 + x^2) D = 2 A (1 - x), that is
    c t1 (x^2 + 2 x - 1) = 0: the joint coasts until its speed is sqrt(2) - 1 of what it was.
    """
    x = math.sqrt(2) - 1
    t1 = duration + inertia / c * math.log(x)
    assert t1 > 0  # else it coasts from the start
    A = inertia * (1 + x * x) / 2 + c * t1
    return A * (span / (t1 + inertia / c * (1 - x))) ** 2


@pytest.mark.parametrize("smooth", [False, True])
def test_a_rigid_joint_with_friction_has_its_closed_form(rigid, smooth):
    plant = rigid()
    expected = _friction_floor(plant.inertia, plant.c, 1.5, 0.8)
    floor = energy_floor(PointToPoint(plant, 1.5, 0.8), smooth=smooth, **SHORT)
    assert floor.energy == pytest.approx(expected, rel=2e-3)
    assert floor.energy > expected * (1 - 1e-4)  # no motion is cheaper
    # A jolt takes up to 4e-5 of the move at any level.
    assert abs(floor.energy - expected) < 2 * floor.left + 1e-4 * expected


def test_a_rigid_joint_with_limited_acceleration_has_its_closed_form(rigid):
    # Without friction every motion costs I v^2 with v its top speed (up, and braked down again);
    # the least top speed is the trapezium's: span = v T - v^2/A.
    limit, span, duration = 15.0, 1.5, 0.8
    v = (limit * duration - math.sqrt((limit * duration) ** 2 - 4 * limit * span)) / 2
    task = PointToPoint(rigid(c=0.0), span, duration, acceleration_limit=limit)
    floor = energy_floor(task, **SHORT)
    assert floor.energy == pytest.approx(task.plant.inertia * v**2, rel=1e-3)
    assert floor.motion.peak_speed == pytest.approx(v, rel=2e-3)
    assert floor.motion.peak_acceleration <= limit * (1 + 1e-9)


# -- other answers --


def test_limited_to_200_the_arm_needs_what_other_transcriptions_find(floor_of):
    # benchmarks/README.md, floor_against_peers.py: 0.101326 J by rockit at 100 intervals, 0.3 %
    # above the refined floor.
    floor = floor_of(replace(ARM, acceleration_limit=200.0), **SHORT)
    assert floor.energy == pytest.approx(0.1013, rel=0.01)
    assert floor.motion.peak_acceleration <= 200 * (1 + 1e-3)


@pytest.mark.parametrize(
    "limits",
    [{}, {"torque_limit": 0.5, "speed_limit": 3.6}, {"deflection_limit": 5e-3}],
    ids=["no limit", "torque and speed", "deflection"],
)
def test_no_plan_is_cheaper(solved, floor_of, limits):
    task = replace(ARM, **limits)
    floor = floor_of(task, **SHORT)
    plan = solved(task, 6, starts=1)
    assert floor.energy < plan.energy
    for name, limit in task.limits.items():
        assert floor.motion.peak(name) <= limit * (1 + 1e-3)
        assert floor.motion.peak(name) > 0.9 * limit  # the limit is in the way


def test_its_jolts_cost_the_kinetic_energy_of_the_inertia_felt_at_once(floor_of):
    # Within a jolt only theta'' and W'' count: eq (13) gives W'' = -(alpha2 + alpha3 cos) theta'' /
    # (1 + alpha1 cos), and with it eq (14) an inertia m, so that the jolt's work is m v^2/2.
    floor, plant = floor_of(ARM, **SHORT), ARM.plant
    run = floor.trajectory
    moving = run.time <= ARM.duration
    time, angle, speed, acceleration = run.time[moving], *run.joint[moving].T
    power = run.power[moving]
    for jolt in (time < 2e-3, time > ARM.duration - 2e-3):
        of_jolt = jolt & (np.abs(acceleration) > 500)
        cosine = math.cos(angle[of_jolt].mean())
        coupling = plant.beta2 + plant.beta3 * cosine
        inertia = plant.beta1 - coupling * (plant.alpha2 + plant.alpha3 * cosine) / (
            1 + plant.alpha1 * cosine
        )
        reached = np.abs(speed[of_jolt]).max()
        work = abs(np.trapezoid(power[of_jolt], time[of_jolt]))
        assert reached > 1.5
        assert work == pytest.approx(inertia * reached**2 / 2, rel=0.01)


def test_a_smooth_motion_comes_to_the_same_floor(floor_of):
    free, smooth = floor_of(ARM, **SHORT), floor_of(ARM, smooth=True, **SHORT)
    # Jolts take up to 4e-5 of the move at any level, which no level shows.
    room = free.left + smooth.left + 1e-4 * free.energy
    assert smooth.energy == pytest.approx(free.energy, abs=room)
    assert np.any(smooth.free.jerk)
    assert not np.any(free.free.jerk)
    h, a, jerk = smooth.free.lengths, smooth.free.acceleration, smooth.free.jerk
    assert np.append(a[1:], 0.0) == pytest.approx(a + h * jerk, abs=1e-5 * np.abs(a).max())
    assert a[0] == 0.0


def test_a_plant_of_two_modes_has_a_floor(tasks, solved):
    task = replace(tasks["two links"], acceleration_limit=60.0)
    floor = energy_floor(task, **SHORT)
    assert floor.residual < 1e-8
    assert 0.9 * solved(task, 10, starts=1).energy < floor.energy
    assert floor.energy < solved(task, 10, starts=1).energy


def test_a_mirrored_move_needs_the_same():
    # The single link is symmetric in theta: -30 degrees cost what 30 degrees do.
    task = PointToPoint(SingleLinkManipulator(), 0.5, 0.8, acceleration_limit=150.0)
    there, back = (energy_floor(replace(task, target=t), **SHORT) for t in (0.5, -0.5))
    assert back.energy == pytest.approx(there.energy, rel=1e-3)


# -- what it says of itself --


def test_the_figures_are_those_of_the_independent_integrator(floor_of):
    floor = floor_of(ARM, **SHORT)
    check = floor.verification
    assert floor.residual < 1e-8
    assert floor.status is SolveStatus.OPTIMAL
    assert check.fixed_step_energy == floor.levels[-1].energy
    assert check.energy_difference == pytest.approx(check.fixed_step_energy - floor.energy)
    assert abs(check.energy_difference) < 1e-3 * floor.energy
    assert check.steps == floor.levels[-1].steps == floor.free.steps
    angle, speed = floor.free.boundaries(0.0)
    assert (angle[-1], speed[-1]) == pytest.approx((math.pi / 2, 0.0), abs=1e-6)


def test_what_is_left_is_what_finer_grids_gain(floor_of):
    # Against a much finer grid: the estimate is of the right size, and errs to the safe side.
    rough, fine = floor_of(ARM, **SHORT), floor_of(ARM, tolerance=1.5e-4, **SHORT)
    assert fine.levels[: len(rough.levels)] == rough.levels
    assert len(fine.levels) > len(rough.levels)
    gained = rough.levels[-1].energy - fine.levels[-1].energy
    assert 0 < gained < rough.left < 5 * gained
    assert fine.left < rough.left
    for level, finer in zip(fine.levels[:-1], fine.levels[1:], strict=True):
        assert 1.5 * level.steps < finer.steps < 4 * level.steps
        assert finer.energy < level.energy


@pytest.mark.parametrize(
    ("energies", "ratio", "left"),
    [
        ([1.0, 0.9], None, 0.1),  # nothing known: first order, the last fall once more
        ([1.0, 0.8, 0.7], 0.5, 0.1),
        ([1.0, 0.7, 0.5], 2 / 3, 0.4),
        ([1.0, 0.5, 0.49], 0.02, 0.01),  # no better than first order is believed
        ([1.0, 0.9, 0.8], 1.0, 0.4),  # nor a series that does not end
        ([1.0, 0.9, 0.95], None, 0.1),  # the energy rose: no less than the fall before
        ([1.0, 0.9, 1.2, 1.19], None, 0.3),  # nor than the rise
        ([1.0, 1.1], None, 0.1),
        ([1.0, 0.9, 0.95, 0.8], None, 0.15),  # lower again: its own fall once more
    ],
)
def test_the_estimate_continues_the_falls_of_the_energy(floor_of, energies, ratio, left):
    levels = tuple(Level(100 * 2**i, energy) for i, energy in enumerate(energies))
    floor = replace(floor_of(ARM, **SHORT), levels=levels)
    assert floor.ratio == (None if ratio is None else pytest.approx(ratio))
    missed = -floor.verification.energy_difference
    assert floor.left == pytest.approx(left + missed)
    assert missed > 0


def test_where_a_finer_grid_needs_more_the_coarser_motion_is_kept(monkeypatch, floor_of):
    usual, solve = floor_of(ARM, **SHORT), FloorProgram.solve
    first, second = usual.levels[:2]
    fastest = usual.motion.peak_speed

    def worse_when_fine(self, free, limits, **settings):
        # Slower than the best motion: it arrives at rest too, and needs more.
        fine = free.steps > second.steps
        return solve(self, free, {"speed": 0.8 * fastest} if fine else limits, **settings)

    monkeypatch.setattr(FloorProgram, "solve", worse_when_fine)
    floor = energy_floor(replace(ARM, speed_limit=2 * fastest), tolerance=0.5, **SHORT)
    assert [level.energy for level in floor.levels[:2]] == pytest.approx(
        [first.energy, second.energy], rel=1e-4
    )
    assert len(floor.levels) == 3
    assert floor.levels[2].energy > 1.001 * second.energy
    assert floor.free.steps == floor.verification.steps == second.steps
    assert floor.energy == pytest.approx(second.energy, rel=1e-3)
    assert floor.left > max(first.energy - second.energy, -floor.change)


def test_a_floor_whose_refinement_failed_says_so(monkeypatch, floor_of):
    assert floor_of(ARM, **SHORT).settled
    solve = FloorProgram.solve

    def fail_when_fine(self, free, *arguments, **settings):
        found = solve(self, free, *arguments, **settings)
        return replace(found, status=SolveStatus.ITERATION_LIMIT) if free.steps > 400 else found

    monkeypatch.setattr(FloorProgram, "solve", fail_when_fine)
    stopped = energy_floor(ARM, tolerance=1e-3, **SHORT)
    assert not stopped.settled
    assert stopped.levels == floor_of(ARM, **SHORT).levels[:2]
    assert stopped.status is SolveStatus.OPTIMAL
    assert stopped.left > 1e-3 * stopped.energy


def test_a_move_of_too_many_periods_is_refused():
    with pytest.raises(ValueError, match=r"duration 200 s takes .* intervals .* shorter"):
        energy_floor(replace(ARM, duration=200.0))


def test_a_residual_window_beyond_reason_is_refused_before_the_solves(monkeypatch):
    monkeypatch.delattr(FloorProgram, "solve")
    with pytest.raises(ValueError, match=r"residual window 10000 s .* give a shorter one"):
        energy_floor(replace(ARM, residual_window=1e4))


def test_starts_that_agree_are_counted(floor_of):
    floor = replace(floor_of(ARM, **SHORT), starts=(1.0, 1.004, 1.006, 2.0))
    assert floor.agreeing() == 2
    assert floor.agreeing(0.01) == 3


def test_the_same_seed_gives_the_same_floor(floor_of):
    task = replace(ARM, acceleration_limit=100.0)
    one, two = energy_floor(task, starts=3, seed=5), energy_floor(task, starts=3, seed=5)
    assert one == two
    assert len(one.starts) == 3
    assert one.provenance.settings.seed == 5


# -- files --


def test_a_saved_floor_is_equal(floor_of, tmp_path):
    floor = floor_of(replace(ARM, acceleration_limit=200.0), **SHORT)
    floor.save(tmp_path / "floor.json")
    again = Floor.load(tmp_path / "floor.json")
    assert again == floor
    assert again.left == floor.left
    assert again.trajectory.torque == pytest.approx(floor.trajectory.torque, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    "damage",
    [
        lambda d: d.pop("motion"),
        lambda d: d["free"].pop("jerk"),
        lambda d: d["free"]["times"].pop(),
        lambda d: d["free"].update(times="0, 1"),
        lambda d: d["free"]["times"].__setitem__(1, "0.1"),
        lambda d: d.update(levels=d["levels"][:1]),
        lambda d: d["levels"][0].update(energy="0.1"),
        lambda d: d.update(starts=[]),
        lambda d: d["task"].update(duration=0.9),
        lambda d: d.update(status="fine"),
        lambda d: d["provenance"]["settings"].pop("smooth"),
        lambda d: d["provenance"]["settings"].pop("tolerance"),
        lambda d: d.update(format="quietarm-plan"),
        lambda d: d.update(version=99),
    ],
)
def test_a_damaged_file_is_refused(floor_of, tmp_path, damage):
    path = tmp_path / "floor.json"
    floor_of(ARM, **SHORT).save(path)
    document = json.loads(path.read_text())
    damage(document)
    path.write_text(json.dumps(document))
    with pytest.raises(FileFormatError, match=r"floor\.json"):
        Floor.load(path)


# -- errors --


def test_limits_that_nothing_meets_are_named_with_what_would_do(floor_of):
    task = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8, torque_limit=0.05, speed_limit=9.0)
    with pytest.raises(
        InfeasibleTaskError, match=r"torque <= 0\.05 N m, speed <= 9 rad/s"
    ) as error:
        energy_floor(task, **SHORT)
    assert "\n" not in str(error.value)
    enough = float(str(error.value).split("torque limit ")[1].split(" N m")[0])
    assert 0.05 < enough < 0.5
    roomy = replace(task, torque_limit=1.1 * enough)
    assert floor_of(roomy, **SHORT).motion.peak_torque < 1.11 * enough


def test_a_start_that_ends_nowhere_is_no_answer(monkeypatch):
    monkeypatch.setattr(SolveStatus, "from_ipopt", lambda status: SolveStatus.ITERATION_LIMIT)
    with pytest.raises(SolverFailedError, match="ran out of iterations"):
        energy_floor(ARM, **SHORT)


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"starts": 0}, "starts is 0"),
        ({"seed": -1}, "seed is -1"),
        ({"tolerance": 0.0}, "tolerance is 0"),
        ({"tolerance": math.nan}, "tolerance is nan"),
    ],
)
def test_settings_out_of_range_are_refused(settings, named):
    with pytest.raises(ValueError, match=named):
        energy_floor(ARM, **settings)


def test_ctrl_c_ends_it_at_once():
    code = (
        "import math; from ocp import *; from models import *\n"
        "task = PointToPoint(SingleLinkManipulator(), math.pi / 2, 1.0)\n"
        "print('begun', flush=True)\n"
        "energy_floor(task, starts=50, tolerance=1e-9)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout.readline()
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert process.returncode != 0
    assert b"KeyboardInterrupt" in errors
