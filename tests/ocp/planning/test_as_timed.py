"""Trajectories as they are timed: figures against plans, closed forms and MuJoCo."""

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np
import pytest
from robots import BAR, END, START, UR5_JOINTS, ur5_with_bar, urdf_of
from small_robots import ARM, ARM_FILE, write_robot
from trajectories import trajectory_text, trapezoid

import quietarm as qa
from quietarm.models import TimedMotion
from quietarm.models.robot.path.joint_table import read_joint_table
from quietarm.ocp import evaluate_as_timed

NAMES = ("a", "b")
ENDS = (np.array([0.0, 0.1]), np.array([1.0, 0.6]))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return qa.Robot.load(write_robot(tmp_path_factory.mktemp("arm"), ARM, ARM_FILE))


@pytest.fixture
def trapezoid_file(tmp_path):
    """Sudden accelerations, in three swings of the first mode."""
    file = tmp_path / "trapezoid.yaml"
    file.write_text(trajectory_text(NAMES, *ENDS, 0.6, partial(trapezoid, 0.25, duration=0.6)))
    return file


def _cycloid(time, duration):
    turn = 2 * np.pi / duration
    return (
        time / duration - np.sin(turn * time) / (2 * np.pi),
        (1 - np.cos(turn * time)) / duration,
        turn * np.sin(turn * time) / duration,
    )


@pytest.mark.parametrize("entries", [3, 1])
def test_a_trajectory_is_judged_as_the_motion_that_it_was_made_of(robot, tmp_path, entries):
    """The plain cycloid, by its points and along its path: the same equations, other joints."""
    duration = 0.45
    motion = qa.evaluate_coefficients(robot.task(qa.GeometricPath.line(*ENDS), duration), [])
    file = tmp_path / "cycloid.yaml"
    law = partial(_cycloid, duration=duration)
    file.write_text(trajectory_text(NAMES, *ENDS, duration, law, step=0.005, entries=entries))
    answer = evaluate_as_timed(robot, file)
    figures = motion.candidate.in_full
    assert answer.residual == pytest.approx(figures.residual, rel=2e-3)
    assert answer.energy == pytest.approx(figures.energy, rel=2e-4)
    assert answer.peaks["torque"] == pytest.approx(figures.peak_torques, rel=2e-3)
    # of a plain cycloid over a way of 1 rad: 2 / T, 2 pi / T^2
    assert answer.peaks["speed"][0] == pytest.approx(2 / duration, rel=1e-3)
    assert answer.peaks["acceleration"][0] == pytest.approx(2 * np.pi / duration**2, rel=1e-2)


def test_joints_are_taken_by_name_and_others_named(robot, tmp_path):
    text = trajectory_text(
        ("b", "grip", "a"), np.array([0.1, 0, 0]), np.array([0.6, 0.01, 1.0]), 0.6,
        partial(trapezoid, 0.25, duration=0.6),
    )  # fmt: skip
    (tmp_path / "three.yaml").write_text(text)
    motion = TimedMotion.load(tmp_path / "three.yaml").of_joints(robot.joints)
    assert motion.points[-1] == pytest.approx(ENDS[1])
    assert motion.remarks == ("joints that the robot does not drive are left out: grip",)


def test_a_smooth_trajectory_is_few_pieces_and_passes_its_points(tmp_path):
    file = tmp_path / "cycloid.yaml"
    law = partial(_cycloid, duration=1.0)
    file.write_text(trajectory_text(NAMES, *ENDS, 1.0, law, step=0.001))
    motion = TimedMotion.load(file)
    assert len(motion.points) == 1001
    assert len(motion.lengths) < 80
    middle = motion.at(np.array([0.5]))[:, 0]
    times = (motion.times[1:] + motion.times[:-1]) / 2
    expected = [ENDS[0] + law(time)[0] * (ENDS[1] - ENDS[0]) for time in times]
    assert middle == pytest.approx(np.array(expected), abs=1e-6)


def test_cubics_between_points_jump_in_their_accelerations(tmp_path):
    """3 x^2 - 2 x^3 from rest to rest: by 6 at both ends."""
    (tmp_path / "two.yaml").write_text(
        "joint_names: [a]\npoints:\n"
        "- {positions: [0.0], velocities: [0.0], time_from_start: {sec: 0, nanosec: 0}}\n"
        "- {positions: [1.0], velocities: [0.0], time_from_start: {sec: 1, nanosec: 0}}\n"
    )
    motion = TimedMotion.load(tmp_path / "two.yaml")
    assert motion.steps[:, 0] == pytest.approx([6.0, 6.0])
    assert motion.remarks == ("without accelerations its points are joined by cubics",)


@pytest.mark.parametrize(("entry", "factor", "words"), [
    ("velocities", np.degrees(1.0), "velocities are in rad/s, were degrees meant"),
    ("velocities", 1e3, "velocities are in m/s, were millimetres meant"),
    ("velocities", 10.0, "times what its positions and times make; give velocities of the same"),
    ("accelerations", np.degrees(1.0), r"accelerations are in rad/s\^2, were degrees meant"),
    ("velocities", 3.0, None),  # of few points, maybe
])  # fmt: skip
def test_rates_that_are_none_of_their_positions_are_refused(trapezoid_file, entry, factor, words):
    table = read_joint_table(trapezoid_file)
    table = replace(table, **{entry: factor * getattr(table, entry)})
    if words is None:
        assert TimedMotion.of_table(table).joints == table.joints
        return
    with pytest.raises(ValueError, match=words):
        TimedMotion.of_table(table)


@pytest.mark.parametrize(("change", "words"), [
    (("nanosec: 20000000}", "nanosec: 0}"), "is at 0 s at point 2 and at 0 s before; give times"),
    ((", time_from_start", ", at"), "has no times; give time_from_start at each point"),
    (("joint_names: [a, b]", "joint_names: [a, c]"), "of the joints a, c, without b, which the"),
    (("positions: [1.0000000000", "positions: [3.5000000000"), "'a' is at 3.5 at point 31 of 31"),
])  # fmt: skip
def test_what_cannot_be_judged_is_refused(robot, trapezoid_file, change, words):
    trapezoid_file.write_text(trapezoid_file.read_text().replace(*change))
    with pytest.raises(ValueError, match=words):
        evaluate_as_timed(robot, trapezoid_file)


@pytest.mark.slow
def test_sudden_accelerations_are_what_rings(robot, trapezoid_file):
    answer = evaluate_as_timed(robot, trapezoid_file)
    (frequency, left), (_, less), *_ = answer.swings
    assert left == pytest.approx(answer.residual, rel=0.02)  # the damping is half a per cent
    assert less < 0.05 * left
    words = answer.diagnosis
    assert words.startswith(
        f"{1e3 * answer.residual:.2g} mm after arrival; of these {1e3 * left:.2g} mm by mode 1 at "
        f"{frequency / (2 * np.pi):.3g} Hz; the jerk makes it ring: a step of "
    )
    assert answer.cycloid.residual < answer.residual / 3
    assert answer.plan.residual < 1e-5
    assert "with the same path and time a plan leaves " in words


@pytest.mark.slow
def test_a_plan_of_its_own_has_nothing_to_improve(robot, tmp_path):
    plan = qa.plan_move(robot.task(qa.GeometricPath.line(*ENDS), 0.8))
    qa.views.export_plan(plan, tmp_path / "move.yaml", rate=500)
    answer = evaluate_as_timed(robot, tmp_path / "move.yaml")
    left = f"{1e3 * answer.residual:.2g} mm" if answer.residual > 1e-6 else "less than 0.001 mm"
    assert answer.diagnosis == f"leaves {left}: as still as a plan; nothing to improve"


@pytest.mark.slow
def test_a_move_of_one_swing_is_a_resonance(robot, tmp_path):
    """However smooth: the plain cycloid in 1.2 swings of the first mode."""
    file = tmp_path / "fast.yaml"
    law = partial(_cycloid, duration=0.25)
    file.write_text(trajectory_text(NAMES, *ENDS, 0.25, law, step=0.005))
    answer = evaluate_as_timed(robot, file)
    assert "a resonance: the plain cycloid, as smooth as can be, leaves" in answer.diagnosis
    assert "takes 1.2 swings" in answer.diagnosis


@lru_cache
def _mujoco():
    from mujoco_robots import FlexibleRobot, Truth

    twin = FlexibleRobot(urdf_of("ur5_robot.urdf"))
    return Truth(twin, UR5_JOINTS, BAR["damping"], twin.add_bar("tool0", **BAR))


@pytest.mark.slow
def test_a_trapezoid_of_the_ur5_leaves_what_mujoco_says(tmp_path):
    file = tmp_path / "trapezoid.yaml"
    law = partial(trapezoid, 0.3, duration=1.0)
    file.write_text(trajectory_text(UR5_JOINTS, START, END, 1.0, law))
    answer = evaluate_as_timed(ur5_with_bar(), file)
    motion = answer.motion

    def followed(time):
        piece = min(np.searchsorted(motion.times, time, side="right"), len(motion.lengths)) - 1
        share = (time - motion.times[piece]) / motion.lengths[piece]
        return [motion.at(np.array([share]), order)[piece, 0] for order in range(3)]

    residual, energy, torques = _mujoco().residual_and_energy(followed, 1.0)
    assert answer.residual == pytest.approx(residual, rel=5e-3)
    assert answer.energy == pytest.approx(energy, rel=1e-3)
    assert answer.peaks["torque"] == pytest.approx(torques, rel=5e-3)
