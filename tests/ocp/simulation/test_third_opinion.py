"""The independent integrator against a third opinion: equations typed afresh, SciPy's DOP853."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import simpson
from third_opinion import ARM, SINGLE_LINK, ThirdOpinion

import quietarm as qa

pi = math.pi
_RANDOM = np.random.default_rng(20)
CASES = [
    # Tables 1, 4 and 6; the middle ones are made up to brake and to overshoot.
    ("single link", SINGLE_LINK["cycloid"], 0.0, pi / 6, 0.8),
    ("single link", SINGLE_LINK["6"], 0.0, pi / 6, 0.8),
    ("single link", [0.1, 0.2, -0.2, 0.15], 0.3, -1.2, 1.0),
    ("arm", ARM["6 as printed"], 0.0, pi / 2, 0.8),
    ("arm", [0.5, -0.5, 0.4], -pi / 2, pi / 4, 1.0),
    ("two links", [0.05, -0.1, 0.0, 0.2], 0.0, pi / 2, 0.9),
    *(
        (name, _RANDOM.uniform(-0.5, 0.5, 12).tolist(), 0.0, pi / 2, 1.1)
        for name in ("single link", "arm", "two links")
    ),
]


@cache
def third_opinion(case):
    """Return what SciPy finds of one of the `CASES`, solved once for all tests."""
    return ThirdOpinion(*CASES[case])


@pytest.fixture(params=range(len(CASES)))
def case(request, plants):
    """A candidate, and the third opinion of it."""
    name, a, start, target, duration = CASES[request.param]
    task = qa.PointToPoint(plants[name], target, duration, start=start)
    candidate = qa.JudgedMotion.of_profile(task, qa.CycloidPolynomial(len(a)), a)
    return candidate, third_opinion(request.param)


def test_scipy_agrees_on_what_a_motion_costs_and_asks_of_the_joint(case):
    candidate, other = case
    task, motion = candidate.task, candidate.motion
    assert motion.energy == pytest.approx(other.energy, rel=1e-9)
    # The samples after arrival miss 1.2e-6 of a peak at most.
    assert motion.residual == pytest.approx(other.residual, rel=3e-6)
    times = np.linspace(0.0, task.duration, 4001)
    joint, states = np.array(other.joint(times)).T, other.during.sol(times)
    torque = np.ravel(other.torque(joint.T, states))
    peaks = {
        "torque": np.abs(torque).max(),
        "speed": np.abs(joint[:, 1]).max(),
        "acceleration": np.abs(joint[:, 2]).max(),
        "deflection": other.phi * np.abs(states[: other.modes]).max(),
    }
    for quantity, peak in peaks.items():
        # Of a thousand samples: a peak of these motions that falls between two is 2e-4 higher.
        assert motion.peak(quantity) == pytest.approx(peak, rel=3e-4), quantity
    overshoot = max(0.0, ((joint[:, 0] - task.target) * np.sign(task.span)).max())
    assert motion.overshoot == pytest.approx(overshoot, abs=1e-5)
    power = torque * joint[:, 1]
    assert motion.net_work == pytest.approx(simpson(power, x=times), rel=1e-8)


def test_scipy_agrees_at_every_sample(case):
    candidate, other = case
    task, duration = candidate.task, candidate.task.duration
    moving, resting = np.linspace(0, duration, 50), np.linspace(duration + 0.01, duration + 1, 50)
    times = np.concatenate([moving, resting])
    found = candidate.sample(times)
    states = np.hstack([other.during.sol(moving), other.after.sol(resting)])
    joint = np.vstack([np.array(other.joint(moving)).T, [(task.target, 0.0, 0.0)] * 50])
    torque = np.ravel(other.torque(joint.T, states))
    assert found.joint == pytest.approx(joint, rel=1e-9, abs=1e-9)
    assert found.modes == pytest.approx(states[: other.modes].T, abs=1e-9)
    assert found.tips == pytest.approx(other.phi * states[: other.modes].T, abs=3e-9)
    assert found.torque == pytest.approx(torque, abs=1e-8)
    assert found.power == pytest.approx(torque * joint[:, 1], abs=1e-7)
    alone = candidate.sample(times[20])
    assert alone.modes[0] == pytest.approx(found.modes[20], abs=1e-9)
