"""Cycles there and back: what builds up, effort, heat and energy."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lsim

import quietarm as qa
from quietarm.models import Drive, LinearAxis

AXIS = LinearAxis(omega1=2 * np.pi * 4.5, zeta1=0.006, mass=82.7, load=15, friction=50)


@pytest.fixture(scope="module")
def move():
    """A plain cycloid of the gantry."""
    return qa.evaluate_coefficients(qa.PointToPoint(AXIS, 0.8, 1.0), [])


def test_what_builds_up_is_what_a_direct_simulation_of_all_moves_leaves(move):
    """The load's equation over twelve cycles at once, by scipy.signal."""
    dwell, repeat, error = 0.3, 12, -0.05
    left = move.cycle(dwell, repeat, {"frequency": error}).left
    w, z, step = 2 * np.pi * 4.5 * (1 + error), 0.006, 1e-3
    leg = round((1.0 + dwell) / step)
    time = step * np.arange(2 * repeat * leg + round(1 / step))
    number, since = np.divmod(np.arange(len(time)), leg)
    going = (since * step < 1.0) & (number < 2 * repeat)
    push = 0.8 * 2 * np.pi * np.sin(2 * np.pi * since * step)
    acceleration = np.where(going, np.where(number % 2, -push, push), 0.0)
    matrix = np.array([[0.0, 1.0], [-(w**2), -2 * z * w]])
    load = lsim((matrix, [[0.0], [-1.0]], [[1.0, 0.0]], [[0.0]]), acceleration, time)[1]
    last = (2 * repeat - 1) * leg + round(1 / step)
    assert left[-1] == pytest.approx(np.abs(load[last:]).max(), rel=1e-3)
    first = slice(round(1 / step), leg)  # until the move back begins
    assert left[0] == pytest.approx(np.abs(load[first]).max(), rel=0.02)
    assert len(left) == 2 * repeat
    assert left.max() > 1.5 * left[0]


@pytest.mark.slow
def test_a_plan_at_rest_stays_at_rest_and_its_worst_case_is_a_corner():
    plan = qa.plan_move(qa.PointToPoint(AXIS, 0.8, 1.0))
    assert plan.cycle(0.3, 12).left.max() < 1e-6
    worst = plan.cycle(0.3, 12).worst()
    assert worst.errors in ({"frequency": -0.05}, {"frequency": 0.05})
    assert worst.left.max() > 1e-3
    uncertain = plan.on(replace(plan.task, uncertainty=qa.Uncertainty({"damping": 0.5})))
    assert set(uncertain.cycle().worst().errors) == {"damping"}


def test_effort_heat_and_energy_of_a_cycle_are_integrals_over_it():
    """A light load: the force of a plain cycloid is known, and that of dry friction."""
    drive = Drive(friction_load=20, motor_constant=30)
    axis = LinearAxis(omega1=300, zeta1=0.02, mass=50, load=1e-6, friction=10, drive=drive)
    span, duration, dwell = 0.5, 0.8, 0.2
    cycle = qa.evaluate_coefficients(qa.PointToPoint(axis, span, duration), []).cycle(dwell)
    assert cycle.time == pytest.approx(2.0)
    turn = 2 * np.pi / duration
    time = np.linspace(0, duration, 20001)
    speed = span / duration * (1 - np.cos(turn * time))
    dry = 20 * speed / np.sqrt(speed**2 + 0.01**2)  # smooth about rest
    force = 50 * span / duration * turn * np.sin(turn * time) + 10 * speed + dry
    heat = 2 * np.trapezoid(force**2, time) / 30**2
    assert cycle.heat == pytest.approx(heat, rel=1e-6)
    assert cycle.rms_torque == pytest.approx(np.sqrt(heat * 30**2 / 2.0), rel=1e-6)
    power = force * speed + force**2 / 30**2
    assert cycle.energy_with_recovery == pytest.approx(2 * np.trapezoid(power, time), rel=1e-6)
    burnt = 2 * np.trapezoid(np.maximum(power, 0), time)
    assert cycle.energy == pytest.approx(burnt, rel=1e-4)
    assert cycle.energy > cycle.energy_with_recovery
    viscous = 2 * 10 * 1.5 * span**2 / duration  # the integral of the cycloid's speed squared
    assert cycle.energy_with_recovery > viscous + 0.99 * 2 * 20 * span + cycle.heat - 1e-9


def test_without_a_motor_constant_there_is_no_heat_and_of_copper_loss_it_is_the_energys(move):
    assert move.cycle().heat is None
    copper = move.on(replace(move.task, energy=qa.CopperLoss(30.0)))
    assert copper.cycle().heat == pytest.approx(2 * copper.energy, rel=1e-6)


def test_cycles_are_saved_with_a_plan_beside_their_figures(move, tmp_path):
    cycled = move.with_entries(shuttle=qa.ocp.Shuttle(0.3, 12))
    cycled.save(tmp_path / "cycled.json")
    loaded = qa.Plan.load(tmp_path / "cycled.json")
    assert loaded == cycled
    assert loaded.cycles.stated == pytest.approx(cycled.cycles.stated)
    assert '"left_after_last"' in (tmp_path / "cycled.json").read_text()
    assert move.cycles is None


def test_a_dwell_or_number_of_cycles_out_of_range_is_refused(move):
    with pytest.raises(ValueError, match=r"dwell is -1 s; give 0 or more"):
        move.cycle(dwell=-1)
    with pytest.raises(ValueError, match=r"repeat is 0; give a whole number from 1 up"):
        move.cycle(repeat=0)


@pytest.mark.slow
def test_a_robot_goes_back_along_its_path_at_rest():
    """A move of which the way back is a task of its own: the joint begins at the target."""
    plan = qa.plan_move(qa.PointToPoint(qa.DualLinkManipulator(), qa.deg(40), 0.9))
    assert plan.cycle(0.1, 3).left.max() < 1e-5
    assert_allclose(plan.cycle(0.1).legs[1].moving.path.angle[-1], 0.0, atol=1e-12)


@pytest.mark.slow
def test_cycles_on_a_drive_begin_as_a_move_and_build_up_as_the_structure_on_its_servo_does(move):
    """Twelve moves at 5 % too low a frequency: docs/servo.md has what a machine leaves."""
    drive = Drive(
        position_loop=60,
        speed_loop=40,
        reset_time=0.03,
        compliance=1 / 6e6,
        rotor=18,
        recorded="held",
    )
    moved = move.on(replace(move.task, plant=replace(AXIS, drive=drive)))
    error = {"frequency": -0.05}
    left = moved.cycle(0.3, 6, error).on_drive()
    run = moved.candidate.perturbed(error).run_on_drive()
    first = (run.time >= 1.0) & (run.time < 1.3)
    tip = run.tips[0][first] + run.load[first] - 0.8
    assert left[0] == pytest.approx(np.abs(tip).max(), rel=1e-3)
    assert len(left) == 12
    assert left.max() > 1.5 * left[0]
    assert move.cycle(0.3, 6).on_drive() is None
    assert moved.cycle(0.0, 6).on_drive() is None


@pytest.mark.parametrize(
    ("errors", "words"),
    [
        ({"freq": 0.1}, "freq"),
        ({"frequency": "5%"}, "error of frequency"),
        ({"frequency": -5}, "frequency"),
        (0.05, "give them by name"),
    ],
)
def test_errors_that_the_plant_cannot_have_are_refused_at_once(move, errors, words):
    with pytest.raises((ValueError, TypeError), match=words):
        move.cycle(errors=errors)
