"""Frequencies that were measured at postures, and the springs and the load that they tell."""

import re
from dataclasses import replace
from math import log

import numpy as np
import pytest
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa
from quietarm.models import Measured
from quietarm.ocp.saved import plain, typed

POSTURES = ((0.0, 0.0), (0.4, 1.0), (-0.5, -1.2))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return qa.Robot.load(write_robot(tmp_path_factory.mktemp("arm"), ARM, ARM_FILE))


@pytest.fixture(scope="module")
def stated(robot):
    """Frequencies of two modes at each posture [rad/s], of the robot as it is in its file."""
    return [robot.frequencies(posture)[:2] for posture in POSTURES]


def measured_of(frequencies, **others):
    """What was measured of the first mode at the postures."""
    return [
        Measured(float(values[0]), posture, **others)
        for posture, values in zip(POSTURES, frequencies)
    ]


def test_one_frequency_scales_the_springs_until_it_is_met(robot, stated):
    measured = Measured(1.1 * float(stated[1][0]), POSTURES[1])
    scaled = replace(robot, measured=measured)
    assert scaled.frequencies(POSTURES[1])[0] == pytest.approx(measured.frequency, rel=1e-9)
    assert scaled.payload == robot.payload
    assert not any("times as stiff" in note.words for note in scaled.notes)
    # 1.5 in frequency is 2.25 in stiffness, where axes are upright
    far = Measured(1.5 * float(stated[1][0]), POSTURES[1], damping=0.3)
    beam = replace(robot.beam, damping=0.5)
    words = " ".join(note.words for note in replace(robot, beam=beam, measured=far).notes)
    assert "makes the springs 2.25 times as stiff as in the robot's file" in words
    assert "damping of the beam is 50 %, which is much; was 0.5 % meant? give 0.5%" in words
    assert "damping of measured is 30 %" in words


def test_several_postures_leave_the_load_where_they_do_not_tell_it(robot, stated):
    fit = replace(robot, measured=measured_of([1.1 * values for values in stated])).fit
    # its axes are upright: gravity adds nothing, and 1.1 in frequency is 1.1^2 in stiffness
    assert fit.stiffness == pytest.approx(1.21, rel=2e-3)
    assert not fit.tells_payload
    assert fit.payload == 1


def test_a_second_bending_tells_the_load_from_the_springs(robot):
    other = replace(robot, beam=replace(robot.beam, tip_mass=0.33))
    measured = [
        Measured(float(other.frequencies(posture)[mode - 1]), posture, mode)
        for posture in POSTURES[:2]
        for mode in (1, 3)
    ]
    told = replace(robot, measured=measured)
    assert told.fit.tells_payload
    assert told.payload == pytest.approx(0.33, rel=0.01)
    assert told.fit.stiffness == pytest.approx(1.0, rel=0.01)
    # another multiple counts from the load that was told
    heavier = told.dynamics_with(1.0, 1.1)
    q = np.zeros(heavier.size)
    as_told = other.dynamics.loaded(0.1 * told.payload, other.of_one_kilogram)
    assert heavier.masses(q) == pytest.approx(as_told.masses(q), rel=0.01, abs=1e-5)


@pytest.mark.slow
def test_a_measured_damping_scales_all_dampers(robot, stated):
    scaled = replace(robot, measured=measured_of(stated, damping=0.01))
    # 0.5 % of the first mode is what the beam has in the file
    assert scaled.fit.damping == pytest.approx(2.0, rel=0.02)


@pytest.mark.slow
def test_misfits_are_what_the_frequencies_differ_by(robot, stated):
    off = [stated[0], 1.02 * stated[1]]
    fit = replace(robot, measured=measured_of(off)).fit
    first, second = fit.misfits
    assert log((1 + second) / (1 + first)) == pytest.approx(log(1.02), rel=0.05)


def test_a_robot_with_measurements_is_saved_and_loaded(robot, stated):
    measured = measured_of(stated, damping=0.006, within=0.002)
    whole = replace(robot, measured=measured)
    assert typed(plain(whole), qa.Robot) == whole
    one = replace(robot, measured=measured[0])
    # as version 2.0.0 wrote it: neither mode nor damping
    assert typed(plain(replace(one, measured=measured_of(stated)[0])), qa.Robot).measured.mode == 1


HZ = "{frequency: 3Hz, at: [0, 0]}"


@pytest.mark.parametrize(
    ("entry", "cause"),
    [
        ("[]", "measured is an empty list"),
        ("[{frequency: 3Hz, at: [0, 0], postures: 2}]", "1 of measured has no entry 'postures'"),
        ("[{frequency: 3Hz, at: 0}]", "1 of measured needs a frequency"),
        ("[{frequency: 3Hz, at: [0, 0], damping: 120%}]", "damping of 1 of measured is 120 %"),
        (f"[{HZ}, {{frequency: 3.3Hz, at: [0, 0]}}]", "with 3 Hz and with 3.3 Hz"),
        (f"[{HZ}, {{frequency: 4Hz, at: [0.4, 1]}}]", "check its posture, its mode and its load"),
    ],
)  # fmt: skip
def test_what_contradicts_or_is_not_known_is_refused_in_one_line(entry, cause, tmp_path):
    file = write_robot(tmp_path, ARM, f"{ARM_FILE}measured: {entry}\n")
    with pytest.raises(ValueError, match=re.escape(cause)) as refused:
        qa.Robot.load(file)
    assert "\n" not in str(refused.value)
