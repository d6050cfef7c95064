"""Energy with resolved sign changes, and the diagnostics of samples."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from quietarm.models import JointMotion, SingleLinkManipulator
from quietarm.ocp import Motion, PointToPoint
from quietarm.ocp.simulation.collocation import GAUSS_NODES, NODES, mesh
from quietarm.ocp.simulation.objective import beyond_quadratic, resolved_energy
from quietarm.ocp.task.quantities import QUANTITIES

numbers = st.floats(-10.0, 10.0)


def _energy(power, h=1.0):
    """Resolved energy of one step along which the power is a function of 0 <= x <= 1."""
    return float(resolved_energy([ca.DM(float(power(x))) for x in GAUSS_NODES], h))


def _integral_of_absolute(polynomial):
    """Integral of |polynomial| over [0, 1], split at the roots that numpy finds."""
    roots = [r.real for r in polynomial.roots() if abs(r.imag) < 1e-9 and 0 < r.real < 1]
    primitive = polynomial.integ()
    return np.abs(np.diff(primitive(np.array([0.0, *sorted(roots), 1.0])))).sum()


@given(c0=numbers, c1=numbers, c2=numbers)
def test_energy_of_any_quadratic_power(c0, c1, c2):
    quadratic = np.polynomial.Polynomial([c0, c1, c2])
    expected = _integral_of_absolute(quadratic.trim(1e-12))
    assert _energy(quadratic) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_energy_adds_up_over_the_steps_of_each_candidate():
    powers = np.random.default_rng(4).normal(size=(3, 5, 7))  # nodes, candidates, steps
    together = resolved_energy([ca.DM(p) for p in powers], 0.1).full()
    assert together.shape == (5, 1)
    for row in range(5):
        steps = [resolved_energy([ca.DM(p[row, k]) for p in powers], 0.1) for k in range(7)]
        assert together[row, 0] == pytest.approx(sum(float(step) for step in steps), rel=1e-12)


# -- what the neighbouring steps tell of the power --

X = np.polynomial.Polynomial([0.0, 1.0])
VANISHING = math.prod(X - node for node in GAUSS_NODES)


@given(c0=numbers, c1=numbers, c2=numbers, cubic=numbers, quartic=numbers)
def test_terms_beyond_the_quadratic_move_work_across_its_zeros(c0, c1, c2, cubic, quartic):
    # By definition: the work of the whole quartic between the zeros of its quadratic part.
    quadratic = np.polynomial.Polynomial([c0, c1, c2])
    work = (quadratic + VANISHING * (cubic + quartic * (X - 0.5))).integ()
    roots = [r.real for r in quadratic.trim(1e-12).roots() if abs(r.imag) < 1e-9]
    breaks = [0.0, *sorted(r for r in roots if 0 < r < 1), 1.0]
    power = [ca.DM(float(quadratic(x))) for x in GAUSS_NODES]
    expected = np.abs(np.diff(work(np.array(breaks)))).sum()
    found = float(resolved_energy(power, 0.25, cubic, quartic))
    assert found == pytest.approx(0.25 * expected, rel=1e-6, abs=1e-6)


def _nodes_in_time(steps):
    """Times of the nodes, shape (steps, NODES), as fractions of the move."""
    begin, length = (x.full() for x in mesh(ca.DM(np.arange(steps)), steps))
    return begin, length, begin + length * np.array(GAUSS_NODES)


@pytest.mark.parametrize("steps", [2, 3, 10])
def test_a_power_of_degree_four_is_told_exactly(steps):
    quartic_power = np.polynomial.Polynomial([0.3, -2.0, 5.0, 7.0, -11.0])
    begin, length, times = _nodes_in_time(steps)
    at_nodes = quartic_power(times).T.reshape(1, -1)  # horzcat(*power): node after node
    found = [(ca.DM(at_nodes) @ weights).full().ravel() for weights in beyond_quadratic(steps)]
    for step in range(steps):
        local = quartic_power(begin[step, 0] + length[step, 0] * X)
        _, remainder = divmod(local, VANISHING)
        beyond = (local - remainder) // VANISHING  # cubic + quartic (x - 1/2)
        assert found[0][step] == pytest.approx(beyond(0.5), abs=1e-9)
        assert found[1][step] == pytest.approx(beyond.deriv()(0.5), abs=1e-9)


def test_a_single_step_has_no_neighbour():
    for weights in beyond_quadratic(1):
        assert weights.shape == (NODES, 1)
        assert not weights.full().any()


# -- diagnostics --


def test_peaks_are_of_absolute_values():
    task = PointToPoint(SingleLinkManipulator(), 1.0, 0.8)
    motion = Motion.from_samples(
        task,
        JointMotion(*np.array([[0.0, 0.5], [1.0, -3.0], [-7.0, 5.0], [80.0, -90.0]])),
        tips=np.array([[0.01, -0.04], [0.02, 0.03]]),
        torque=np.array([0.3, -0.6]),
        residual=0.005,
        energy=0.2,
        net_work=0.1,
    )
    assert {name: motion.peak(name) for name in QUANTITIES} == {
        "speed": 3.0, "acceleration": 7.0, "jerk": 90.0, "torque": 0.6, "deflection": 0.04,
    }  # fmt: skip
    assert (motion.peak("residual"), motion.energy, motion.net_work) == (0.005, 0.2, 0.1)


@pytest.mark.parametrize(
    ("target", "angles", "overshoot"),
    [
        (1.0, [0.0, 0.5, 1.0], 0.0),
        (1.0, [0.0, 1.25, 1.0], 0.25),
        (1.0, [0.0, -0.3, 1.0], 0.0),  # backing off first is not an overshoot
        (-1.0, [0.0, -0.5, -1.0], 0.0),
        (-1.0, [0.0, -1.25, -1.0], 0.25),
    ],
)
def test_overshoot_is_how_far_the_joint_passes_the_target(target, angles, overshoot):
    motion = Motion.from_samples(
        PointToPoint(SingleLinkManipulator(), target, 0.8),
        JointMotion(np.array(angles), *np.zeros((2, len(angles)))),
        tips=np.zeros((len(angles), 1)),
        torque=np.zeros(len(angles)),
        residual=0.0,
        energy=0.0,
        net_work=0.0,
    )
    assert (motion.peak_jerk, motion.peak("jerk")) == (None, math.inf)  # its jerk is not known
    assert motion.overshoot == pytest.approx(overshoot, abs=1e-15)
    assert math.copysign(1.0, motion.overshoot) == 1.0  # else a table prints -0


def test_what_passes_a_limit_is_named_with_its_share_of_it():
    motion = Motion(2e-3, 0.1, 0.05, 0.3, 2.0, 9.0, 0.02, 0.0)
    limits = {"torque": 0.2, "speed": 2.5, "acceleration": 10.0, "deflection": 0.016}
    assert motion.passed(limits) == pytest.approx({"torque": 1.5, "deflection": 1.25})
    assert motion.passed(limits, room=0.3) == pytest.approx({"torque": 1.5})
    assert motion.passed({"residual": 1e-3, "jerk": 1.0}) == pytest.approx(
        {"residual": 2.0, "jerk": math.inf}
    )
    assert motion.passed({"residual": 0.0}) == {}  # rest is judged elsewhere
