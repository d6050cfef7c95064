"""A plant on its drive: the simulation against closed forms, and set points by which it follows."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lsim

import quietarm as qa
from quietarm.models import Drive, LinearAxis
from quietarm.ocp.simulation.on_drive import run_on_drive
from quietarm.ocp.simulation.servo import Servo, as_held, held_mode, mode_on_servo
from quietarm.ocp.simulation.set_points import SetPoints

# the gantry and the picker of docs/drive.md, as their drives are stated
GANTRY = Drive(
    position_loop=60,
    speed_loop=40,
    reset_time=0.03,
    compliance=1 / 6e6,
    rotor=18,
    friction_motor=25,
    friction_load=20,
    dead_time=2.5e-4,
    motor_constant=30,
    recorded="held",
)
PICKER = Drive(
    position_loop=90,
    speed_loop=60,
    reset_time=0.02,
    compliance=0,
    friction_motor=3,
    friction_load=2,
    dead_time=2.5e-4,
    recorded="held",
)
SMOOTH = {"friction_motor": 0.0, "friction_load": 0.0}


def gantry(hertz=4.5, damping=0.006, drive=GANTRY):
    return LinearAxis(
        omega1=2 * np.pi * hertz, zeta1=damping, mass=82.7, load=15, friction=50, drive=drive
    )


def picker(hertz=12.0, damping=0.004, drive=PICKER):
    return LinearAxis(
        omega1=2 * np.pi * hertz, zeta1=damping, mass=6, load=1.17, friction=6, drive=drive
    )


def cycloid(span, duration, rows=2000):
    time = np.linspace(0, duration, rows + 1)
    turn = 2 * np.pi / duration
    return SetPoints(
        time,
        span * (time / duration - np.sin(turn * time) / (2 * np.pi)),
        span / duration * (1 - np.cos(turn * time)),
        span / duration * turn * np.sin(turn * time),
    )


def plain_move(plant, span=0.8, duration=1.0):
    return qa.evaluate_coefficients(qa.PointToPoint(plant, span, duration), [])


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("forward", ["acceleration", "speed", "none"])
def test_a_cascaded_servo_answers_as_its_linear_equations_do(forward):
    """Motor, carriage and a swinging load in a matrix, by scipy.signal: no line of quietarm's."""
    drive = replace(GANTRY, **SMOOTH, dead_time=0.0, feedforward=forward)
    servo = Servo(gantry(drive=drive), 0.0)
    m, M, k, load, w, z = 18.0, 64.7, 6e6, 15.0, 2 * np.pi * 4.5, 0.006
    gain, inertia, kv, ti = 82.7 * 2 * np.pi * 40, 82.7, 60.0, 0.03
    d = servo.belt[1]  # the damping of the belt is quietarm's own choice
    speed, push = forward != "none", inertia * (forward == "acceleration")
    # states: motor, its speed, carriage, its speed, load from the carriage, its rate, integral
    # the load has y'' = -2 z w y' - w^2 y - a, and the carriage bears load * (a + y'')
    error = np.array([-kv, -1.0, 0, 0, 0, 0, 0])
    by_servo = gain * error + gain * np.eye(7)[6]
    belt = np.array([k, d, -k, -d, 0, 0, 0])
    swing = np.array([0, 0, 0, 0, -(w**2), -2 * z * w, 0])
    carriage = (belt - np.array([0, 0, 0, 50.0, 0, 0, 0]) - load * swing) / (M - load)
    unit = np.eye(7)
    A = np.array(
        [unit[1], (by_servo - belt) / m, unit[3], carriage, unit[5], swing - carriage, error / ti]
    )
    asked = np.array([[kv, speed, 0.0]])
    B = np.zeros((7, 3))
    B[1] = (gain * asked[0] + [0, 0, push]) / m
    B[6] = asked[0] / ti
    points = cycloid(0.8, 1.0)
    run = run_on_drive(servo, points, 0.5, 30.0)
    times = np.append(0.0, run.time)
    exact = lsim((A, B, unit, np.zeros((7, 3))), points.at(times).T, times)[2][1:]
    assert_allclose(run.motor, exact[:, 0], atol=2e-5)  # a step of 1/8000 s at 1.6 m/s is 2e-4
    assert_allclose(run.tips[0], exact[:, 4], atol=2e-5)
    late = run.time > 1.2
    assert_allclose(run.tips[0][late], exact[late, 4], atol=2e-6)


def test_dry_friction_has_the_sign_of_the_speed_and_holds_a_body_at_rest():
    servo = Servo(gantry(), 0.0)
    smooth = Servo(gantry(drive=replace(GANTRY, **SMOOTH)), 0.0)
    there, back, free = (
        run_on_drive(of, ramp(speed), 0.0, 30.0)
        for of, speed in ((servo, 0.2), (servo, -0.2), (smooth, 0.2))
    )
    late = there.time > 0.5
    # at constant speed the integral of the speed loop gives the 45 N of motor and load
    assert_allclose((there.effort - free.effort)[late], 45, rtol=0.01)
    assert_allclose(there.effort, -back.effort, atol=1e-6)
    loose = replace(GANTRY, friction_motor=500.0, friction_load=500.0, dead_time=0.0)
    stuck = run_on_drive(Servo(gantry(drive=loose), 0.0), cycloid(1e-4, 0.1), 0.0, 30.0)
    assert np.abs(stuck.effort).max() < 500  # less than what holds it
    assert_allclose(stuck.motor, 0.0, atol=1e-6)  # asked for 0.1 mm


def ramp(speed, seconds=1.0):
    time = np.linspace(0, seconds, 1001)
    return SetPoints(time, speed * time, np.full(1001, speed), np.zeros(1001))


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("forward", ["acceleration", "speed", "none"])
def test_a_load_follows_the_planned_path_by_its_set_points(forward):
    drive = replace(GANTRY, **SMOOTH, feedforward=forward)
    assert off_path(plain_move(gantry(drive=drive))) < (5e-6 if forward == "none" else 2e-7)
    recorded = replace(drive, recorded="moving")  # the planned path is the set point
    assert off_path(plain_move(gantry(drive=recorded))) > 4e-5


def off_path(plan):
    """Return how far the load is from the planned path on the way [m]."""
    run = plan.candidate.run_on_drive()
    moving = run.time <= plan.task.duration
    return np.abs(run.load[moving] - plan.path(run.time[moving])).max()


@pytest.mark.slow
def test_a_link_that_turns_follows_the_planned_path_by_its_set_points():
    drive = Drive(position_loop=30, speed_loop=20, reset_time=0.05, recorded="held")
    plain = qa.SingleLinkManipulator()
    moved = plain_move(replace(plain, drive=drive), span=qa.deg(30), duration=0.8)
    figures = moved.candidate.on_drive
    assert off_path(moved) < 1e-6
    assert figures.residual == pytest.approx(moved.residual, rel=0.01)
    assert figures.peak_torque == pytest.approx(moved.figures.peak_torque, rel=2e-3)
    assert figures.heat is None


def test_the_set_points_end_at_the_target_once_the_servo_has_settled():
    moved = plain_move(picker(), span=0.25, duration=0.314)
    points = moved.candidate.set_points(1000.0)
    assert points.time[-1] > 0.314
    assert (points.place[-1], points.speed[-1], points.acceleration[-1]) == (0.25, 0.0, 0.0)
    assert points.place[-2] == pytest.approx(0.25, abs=2e-6)
    slopes = np.gradient(points.place, points.time, edge_order=2)
    assert_allclose(points.speed[2:-2], slopes[2:-2], atol=2e-4)
    commanded = moved.commanded(1000.0)
    assert_allclose(commanded.sample.joints[0].angle, points.place)
    assert_allclose(commanded.motion.angle[-1], 0.25)


def test_the_structure_swings_on_its_servo_as_it_was_recorded_on_the_way():
    """docs/drive_recording.md has 4.484 Hz and 11.866 Hz of beams of 4.5 and 12 Hz on the way."""
    on_gantry = mode_on_servo(gantry(), 0.0)
    assert on_gantry.frequency / 2 / np.pi == pytest.approx(4.484, abs=1e-3)
    assert on_gantry.damping == pytest.approx(0.0047, abs=2e-4)
    on_picker = mode_on_servo(picker(), 0.0)
    assert on_picker.frequency / 2 / np.pi == pytest.approx(11.866, abs=2e-3)


def test_a_structure_recorded_on_the_way_has_the_modes_of_the_one_that_is_held():
    recorded = gantry(4.4838, 0.00468, replace(GANTRY, recorded="moving"))
    held = held_mode(as_held(recorded, 0.0), 0.0)
    assert held.frequency / 2 / np.pi == pytest.approx(4.5, abs=1e-4)
    assert held.damping == pytest.approx(0.006, abs=1e-5)


def test_coulomb_friction_is_in_torque_energy_and_work():
    """Its work is size times way, less what is missing about rest, where it is smooth."""
    free, rubbing = plain_move(gantry(drive=None)), plain_move(gantry())
    assert rubbing.figures.net_work - free.figures.net_work == pytest.approx(45 * 0.8, rel=1e-3)
    more = rubbing.candidate.moving.torques[0] - free.candidate.moving.torques[0]
    assert more.max() == pytest.approx(45, rel=1e-3)
    back = qa.evaluate_coefficients(qa.PointToPoint(gantry(), -0.8, 1.0), [])
    assert back.energy == pytest.approx(rubbing.energy, rel=1e-9)
    assert back.candidate.moving.torques[0].min() == pytest.approx(-rubbing.figures.peak_torque)


@pytest.mark.slow
def test_a_perturbed_motion_is_judged_on_its_drive_with_the_nominal_set_points():
    moved = plain_move(gantry())
    error = moved.candidate.perturbed({"frequency": 0.05})
    assert_allclose(error.set_points(500.0).place, moved.candidate.set_points(500.0).place)
    assert error.on_drive.residual != pytest.approx(moved.candidate.on_drive.residual, rel=0.02)


def test_a_drive_is_saved_with_its_plan_and_a_plan_without_one_as_before(tmp_path):
    moved = plain_move(gantry())
    moved.save(tmp_path / "move.json")
    assert qa.Plan.load(tmp_path / "move.json") == moved
    plain_move(gantry(drive=None)).save(tmp_path / "plain.json")
    assert "drive" not in (tmp_path / "plain.json").read_text()
    other = moved.task.plant
    changed = qa.PointToPoint(replace(other, drive=replace(GANTRY, speed_loop=41)), 0.8, 1.0)
    assert qa.ocp.task_difference(changed, moved.task) == "drive speed_loop is 41, not 40"


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"speed_loop": -1}, "speed loop is -1; give a positive number"),
        ({"speed_loop": "40"}, "speed loop is '40'; give a number"),
        ({"friction_load": -2.0}, "friction load is -2; give 0 or more"),
        ({"dead_time": 0.5}, "dead time is 0.5 s; give at most 0.02 s"),
        (
            {"position_loop": 60, "speed_loop": 40},
            "the servo shifts frequencies, and how they were recorded is not stated; give "
            "recorded=held (a brake, or --angle in the fit) or recorded=moving (on the servo)",
        ),
        ({"recorded": "never"}, "recorded is 'never'; give held or moving"),
        ({"feedforward": None}, "feedforward is None; give acceleration or speed or none"),
    ],
)
def test_a_number_out_of_range_is_refused(numbers, words):
    with pytest.raises(ValueError, match=r"; give ") as refused:
        Drive(**numbers)
    assert str(refused.value) == words


def test_a_drive_that_does_not_fit_its_plant_is_refused():
    with pytest.raises(
        ValueError, match=r"rotor is 80 kg of 67\.7 kg that move without what swings"
    ):
        qa.PointToPoint(gantry(drive=replace(GANTRY, rotor=80)), 0.8, 1.0)
    with pytest.raises(TypeError, match="drive is 40; give a drive, such as Drive"):
        qa.PointToPoint(LinearAxis(drive=40), 0.8, 1.0)
    slow = replace(GANTRY, dead_time=0.02)
    with pytest.raises(qa.ocp.SolverFailedError, match="the servo does not hold the plant"):
        plain_move(gantry(drive=slow)).candidate.on_drive  # noqa: B018


def test_a_plant_of_a_users_file_keeps_its_drive_in_another_process(tmp_path):
    """Workers get plants of files by name and entries: the drive is one of these."""
    lines = (
        "from dataclasses import dataclass",
        "from quietarm.models import LinearAxis",
        "@dataclass(frozen=True)",
        "class Gantry(LinearAxis):",
        "    name = 'gantry of a file'",
    )
    (tmp_path / "gantry.py").write_text("\n".join(lines))
    kinds = qa.models.load_plant_file(tmp_path / "gantry.py")
    plant = kinds["gantry of a file"](drive=GANTRY)
    assert pickle.loads(pickle.dumps(plant)) == plant


@pytest.mark.parametrize("limit", [40.0, (-40.0, 400.0), {"joint": 40.0}])
def test_a_limit_that_dry_friction_takes_whole_is_refused(limit):
    with pytest.raises(
        ValueError, match=r"force limit is 40 N and dry friction takes 45 N; give a"
    ):
        qa.PointToPoint(gantry(), -0.8, 1.0, torque_limit=limit)
    assert qa.PointToPoint(gantry(), 0.8, 1.0, torque_limit=46.0).plant.drive == GANTRY
