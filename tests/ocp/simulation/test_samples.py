"""Samples of the independent integrator at any times."""

import math

import numpy as np
import pytest
from quietarm.ocp import CycloidPolynomial, sample_trajectory

pi = math.pi
PLAIN = CycloidPolynomial(0)


# -- samples --


def test_the_joint_rests_after_arrival_and_the_motor_holds_it(tasks):
    # 'motor torque that keeps the joint angle at the target angle against the residual vibration':
    # eq (8) with theta' = theta'' = 0 is alpha2 W''.
    found = sample_trajectory(tasks["single link"], PLAIN, [], [0.9, 1.3, 1.8])
    assert found.joint.tolist() == [[pi / 6, 0.0, 0.0]] * 3
    W, step = found.modes[:, 0], 1e-3
    near = sample_trajectory(tasks["single link"], PLAIN, [], [1.3 - step, 1.3, 1.3 + step])
    second = np.diff(near.modes[:, 0], 2).item() / step**2
    assert found.torque[1] == pytest.approx(9.261e-2 * second, rel=1e-4)
    assert np.abs(found.power).max() == 0.0
    assert np.abs(W).max() < 0.0339


def test_samples_do_not_depend_on_the_other_samples(tasks):
    task, a, profile = tasks["arm"], [0.1, -0.2], CycloidPolynomial(2)
    many = sample_trajectory(task, profile, a, np.linspace(0, 1.6, 161))
    for k in (0, 1, 40, 80, 81, 160):
        one = sample_trajectory(task, profile, a, [many.time[k]])
        assert one.modes[0] == pytest.approx(many.modes[k], abs=1e-10)
        assert one.torque[0] == pytest.approx(many.torque[k], abs=1e-9)


def test_a_trajectory_has_a_row_for_every_time(tasks):
    found = sample_trajectory(tasks["two links"], PLAIN, [], [0.1, 0.5, 0.9, 1.0])
    shapes = {name: array.shape for name, array in vars(found).items()}
    assert shapes == {
        "time": (4,),
        "joint": (4, 3),
        "modes": (4, 2),
        "tips": (4, 2),
        "torque": (4,),
        "power": (4,),
        "jerk": (4,),
    }
    assert found.time.tolist() == [0.1, 0.5, 0.9, 1.0]


# -- bad input --
