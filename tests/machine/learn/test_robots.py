"""Learning of a robot's moves: what torques of joints tell, controllers' files, next plans."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa
from quietarm.machine import RobotRecording
from quietarm.machine.learn.robots.joint_torques import SeenModes
from quietarm.machine.learn.robots.robot_swing import read_robot_swing
from quietarm.machine.recordings.read_recording import Columns
from quietarm.machine.recordings.read_robot_recording import read_robot_recording
from quietarm.models import JointMotion
from quietarm.ocp import FileFormatError

STEP = 0.002
ARRIVAL = 0.6
TIME = np.arange(0, 3, STEP)
DURATION = 0.5

JOINTS = ("a", "b")


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    """Two joints with a beam that swings at 4.9 Hz by the first mode."""
    robot = qa.Robot.load(write_robot(tmp_path_factory.mktemp("arm"), ARM, ARM_FILE))
    return robot.along(qa.GeometricPath.through([[0.0, 0.5], [1.0, 1.0]]))


def swinging(plant, amplitude, *, noise=0.01, frequency=1.0, ring=0.0, softens=0.0, seed=0):
    """Torques whose first mode swings by an amplitude at arrival, at so many times its frequency.

    The arm rings at 6 Hz with a damping of 0.2 besides [N m]. A swing of its largest size is slower
    by a share.
    """
    modes = SeenModes(plant, 1.0, "torques")
    value = modes.values[0] * frequency
    since = np.maximum(TIME - ARRIVAL, 0.0)
    size = np.exp(value.real * since)
    turns = value.imag * np.cumsum(1 - softens * size) * STEP
    turns -= turns[np.searchsorted(TIME, ARRIVAL)]
    swing = amplitude * size * np.exp(1j * turns)
    torques = np.outer(swing, modes.rows_at(np.full(2, value))[:, 0]).real
    arm = 2 * np.pi * 6
    torques += ring * np.outer(np.exp(-0.2 * arm * since) * np.cos(arm * since), [1.0, -0.5])
    torques[TIME < ARRIVAL] = 0.0
    random = np.random.default_rng(seed)
    torques += np.array([3.0, -1.0]) + random.normal(0, noise, torques.shape)
    return RobotRecording(TIME, torques=torques), modes


def read(recording, modes):
    found = read_robot_swing(recording, ARRIVAL, modes, late=0.0, unsure=0.0)
    return found.measured.swings[0].complex_amplitude, found


# What torques tell


def test_the_torques_of_all_joints_tell_the_swing_of_the_tip(plant):
    amplitude = 4e-3 * np.exp(0.7j)
    swing, found = read(*swinging(plant, amplitude, frequency=1.1))
    assert abs(swing - amplitude) < 0.02 * abs(amplitude)
    model = SeenModes(plant, 1.0, "torques").frequencies[0]
    assert found.measured.values["mode 1"] == pytest.approx(1.1 * model, rel=1e-3)
    assert found.notes == ()


def test_an_arm_that_rings_itself_is_told_from_the_swing_and_said(plant):
    amplitude = 4e-3 * np.exp(-2.0j)
    swing, found = read(*swinging(plant, amplitude, ring=0.6))
    assert abs(swing - amplitude) < 0.05 * abs(amplitude)
    note, stays = found.notes
    assert "the arm itself rings after arrival" in note
    assert "and stays" in stays
    assert "fitted beside the swing" in note or "read from 0.65 s" in note


def test_a_ring_of_the_arm_moves_the_tip_as_its_masses_say(plant):
    # an arm that rings along its path, by three millimetres of the tip at 6 Hz
    kinematics = plant.robot.kinematics(plant.robot.tip)
    end, beside = (np.asarray(plant.path(place)).ravel() for place in (1.0, 1.0 - 1e-4))
    tip_by_place = np.linalg.norm(kinematics.offset(beside, kinematics.pose(end))[0][:3]) / 1e-4
    still, moved = (
        np.array([float(t) for t in plant.torques(JointMotion(1.0, 0.0, a), *[[0.0, 0.0]] * 3)])
        for a in (0.0, 1.0)
    )
    rate = 2 * np.pi * 6
    size = 3e-3 / tip_by_place * rate**2
    recording, modes = swinging(plant, 4e-3, noise=1e-3)
    since = np.maximum(TIME - ARRIVAL, 0.0)
    ring = np.exp(-0.2 * rate * since) * np.cos(rate * since) * (TIME > ARRIVAL)
    torques = recording.torques + np.outer(ring, size * (moved - still))
    _, found = read(replace(recording, torques=torques), modes)
    assert found.other == pytest.approx(3e-3, rel=0.15)


def test_large_swings_whose_frequency_depends_on_them_are_read_by_their_first_periods(plant):
    amplitude = 40e-3 * np.exp(0.4j)
    swing, found = read(*swinging(plant, amplitude, softens=0.02))
    assert abs(swing - amplitude) < 0.05 * abs(amplitude)
    assert any("depend on the amplitude" in note for note in found.notes)


def test_a_delay_turns_the_phase_and_an_unsure_start_counts(plant):
    recording, modes = swinging(plant, 4e-3)
    late = read_robot_swing(recording, ARRIVAL, modes, late=0.01, unsure=1e-3).measured.swings[0]
    turned = modes.values[0].imag * 0.01
    assert late.phase == pytest.approx(turned, abs=0.02)
    # a millisecond of 4.9 Hz turns by 0.031
    assert late.deviation >= 4e-3 * 0.03 / 2**0.5


# Files of controllers


def log(plant):
    """Times in ms with gaps of 1 to 6 ms after a row that is not of the move, and torques."""
    random = np.random.default_rng(0)
    time = np.cumsum(random.choice([1, 1, 1, 2, 6], 800))
    torques = np.stack([np.sin(time / 50), 2 + np.cos(time / 50)], axis=1)
    torques += random.normal(0, 0.01, torques.shape)
    return np.append(0, 5000 + time), np.vstack([[0.0, 900.0], torques])


@pytest.mark.parametrize(
    ("names", "option"),
    [
        (["tau_ext[0]", "tau_ext[1]"], "tau_ext"),
        (["tau_1", "tau_2"], "tau"),
        (["a_effort", "b_effort"], None),
        (["effort/a", "effort/b"], None),
        (["a", "b"], None),
    ],
)
def test_columns_of_all_joints_are_found(plant, tmp_path, names, option):
    time, torques = log(plant)
    header = ",".join(["time_ms", *names, "load"])
    table = np.c_[time, torques, time * 0]
    np.savetxt(tmp_path / "log.csv", table, "%.6g", ",", header=header, comments="")
    columns = Columns({"torque": [option] if option else []})
    recording, notes = read_robot_recording(tmp_path / "log.csv", columns, "log.csv", JOINTS)
    assert recording.torques[:, 1].mean() == pytest.approx(2.0, abs=0.1)
    assert np.abs(recording.torques).max() < 4  # without the first row
    assert np.ptp(recording.time) == pytest.approx((time[-1] - time[1]) / 1e3, abs=0.01)
    assert any("first row is left out" in note for note in recording.notes)
    assert notes == ["not used: column load"]


def message(sec, names, efforts, positions="[]"):
    return (
        f"header:\n  stamp:\n    sec: {sec}\n    nanosec: 500000000\n  frame_id: ''\n"
        f"name: {names}\nposition: {positions}\nvelocity: []\neffort: {efforts}\n---\n"
    )


def test_joint_states_are_read_by_the_names_of_the_joints(plant, tmp_path):
    text = "".join(
        message(k, "[b, grip, a]", f"[{k}.5, 0.0, {2 * k}.0]") + message(k, "[other]", "[1.0]")
        for k in range(30)
    )
    (tmp_path / "states.yaml").write_text(text)
    read = read_robot_recording(tmp_path / "states.yaml", Columns({}), "states.yaml", JOINTS)
    assert read.recording.torques[:3].tolist() == [[0.0, 0.5], [2.0, 1.5], [4.0, 2.5]]
    assert read.recording.time[:3].tolist() == [0.0, 1.0, 2.0]
    assert read.notes == ["30 messages without these joints are not used"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (message(1, "[x]", "[1.0]"), "no JointState message of a, b"),
        (message(1, "[a, b]", "[]"), "1 of 1 messages have no effort"),
        (message(1, "[a, b]", "[1.0, '...']"), "full-length"),
        ("name: [a, b]\neffort: [1.0, 2.0]\n", "no header.stamp.sec"),
        ("a: [\n", "message 1 is no valid YAML"),
    ],
)
def test_messages_that_do_not_serve_are_refused_in_a_line(plant, tmp_path, text, words):
    (tmp_path / "states.yaml").write_text(text)
    with pytest.raises(FileFormatError, match=words) as refused:
        read_robot_recording(tmp_path / "states.yaml", Columns({}), "states.yaml", JOINTS)
    assert "\n" not in str(refused.value)


def test_a_csv_without_columns_of_the_joints_says_how_they_may_be_called(plant, tmp_path):
    np.savetxt(tmp_path / "log.csv", np.ones((30, 2)), header="t,force", delimiter=",", comments="")
    with pytest.raises(FileFormatError, match="such as a_effort; name what they begin with"):
        read_robot_recording(tmp_path / "log.csv", Columns({}), "log.csv", JOINTS)
    with pytest.raises(FileFormatError, match=r"'a_tau' or 'tau\[0\]'"):
        read_robot_recording(tmp_path / "log.csv", Columns({"torque": ["tau"]}), "log", JOINTS)


# The next plan


@cache
def planned(plant):
    task = qa.PointToPoint(plant, target=1.0, duration=DURATION)
    return qa.plan_move(task, qa.CycloidPolynomial(6), starts=1)


def executed(plan, *, factor=1.2, seed=0, sign=1.0):
    """A recording of a plan on springs that are so many times as stiff, and what it leaves [m]."""
    plant = replace(plan.task.plant, stiffness=factor)
    task = qa.PointToPoint(plant, target=1.0, duration=DURATION)
    moved = qa.evaluate_coefficients(task, plan.coefficients, profile=plan.profile)
    sample = moved.sampled(np.arange(0, 2, STEP)).sample
    torques = np.stack(sample.torques, axis=1)
    positions = np.stack([joint.angle for joint in sample.joints], axis=1)
    before = 100
    torques, positions = (
        np.concatenate([np.repeat(values[:1], before, axis=0), values])
        for values in (torques, positions)
    )
    torques = sign * torques + np.random.default_rng(seed).normal(0, 0.02, torques.shape)
    time = np.arange(len(torques)) * STEP
    return RobotRecording(time, torques=torques, positions=positions, name=f"run{seed}"), moved


@pytest.mark.slow
def test_springs_are_learned_and_moves_that_differ_are_not_chased(plant):
    plan = planned(plant)
    recording, moved = executed(plan)
    learned = qa.learn(plan, [recording], dearer=0.1)
    model, new = learned.changed["stiffness"]
    assert (model, new) == (1.0, pytest.approx(1.2, rel=2e-3))
    assert learned.left == pytest.approx(moved.residual, rel=0.1)
    assert learned.start["run0"] == pytest.approx(0.2, abs=5e-4)
    text = " ".join(learned.notes)
    assert "moves of robots differ by 1.8 %" in text  # no move was repeated
    assert "measured: {frequency:" in text
    assert "is not known" in text  # the delay
    task = replace(learned.plan.task.certain, plant=replace(plant, stiffness=1.2), final=None)
    following = qa.evaluate_coefficients(
        task, learned.plan.coefficients, profile=learned.plan.profile
    )
    assert following.residual < moved.residual / 50
    assert following.energy < 1.15 * moved.energy


@pytest.mark.slow
def test_what_the_tool_does_from_outside_is_said_to_have_the_other_sign(plant):
    plan = planned(plant)
    learned = qa.learn(plan, [executed(plan, factor=0.85, sign=-0.3)[0]], dearer=9.0)
    (note,) = (note for note in learned.notes if "--scale torque=-1" in note)
    assert note.startswith("warning: the torques go against the plan's")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"torques": lambda torques: -torques}, r"they have the other sign.*--scale torque=-1"),
        ({"torques": lambda torques: torques * [1, -1]}, "b with the other sign"),
        ({"torques": lambda torques: torques[:, ::-1]}, "the torques of a and b look exchanged"),
        ({"torques": lambda torques: 1e3 * torques}, r"9\d\d times .*--scale torque=0\.001"),
        ({"torques": lambda torques: 1e-3 * torques}, r"0\.0009\d+ times .*--scale torque=1000"),
        ({"time": lambda time: 1e3 * time}, r"it lasts 2198 s .* give --units time:ms"),
    ],
)
def test_a_sign_an_order_or_a_unit_that_is_wrong_is_refused_in_a_line(plant, changes, words):
    plan = planned(plant)
    recording, _ = executed(plan)
    signals = {name: change(getattr(recording, name).copy()) for name, change in changes.items()}
    with pytest.raises(ValueError, match=words) as refused:
        qa.learn(plan, [replace(recording, **signals)])
    assert "\n" not in str(refused.value)


def test_rows_without_numbers_are_left_out_and_named(plant):
    recording, _ = swinging(plant, 4e-3)
    torques = recording.torques.copy()
    torques[[3, 700], 1] = np.nan
    lost = RobotRecording(recording.time, torques=torques, name="run")
    assert len(lost.time) == len(recording.time) - 2
    assert lost.notes == (
        "run: 2 of 1500 rows are left out, the first row 4: a value there is no number",
    )


@pytest.mark.slow
def test_recordings_that_do_not_fit_the_robot_are_refused_in_a_line(plant):
    plan = planned(plant)
    recording, _ = executed(plan)
    with pytest.raises(ValueError, match=r"3 columns of torques, and robot 2 joints, a, b"):
        qa.learn(plan, [replace(recording, torques=np.ones((len(recording.time), 3)))])
    short = recording.time < 0.8
    cut = RobotRecording(
        recording.time[short],
        torques=recording.torques[short],
        positions=recording.positions[short],
    )
    with pytest.raises(ValueError, match=r"it is too short: it ends 0\.098 s after arrival"):
        qa.learn(plan, [cut])
    still = RobotRecording(recording.time, torques=np.random.default_rng(0).normal(
        0, 1, recording.torques.shape))  # fmt: skip
    with pytest.raises(ValueError, match="it is of another move"):
        qa.learn(plan, [still])
    with pytest.raises(TypeError, match="a recording of a robot, such as RobotRecording"):
        qa.learn(plan, [qa.Recording(recording.time, tip=recording.torques)])
