"""The energy of a motion: one step's share, its derivatives, its neighbours; peaks of samples."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

import quietarm as qa
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.simulation.objective import beyond_quadratic, resolved_energy
from quietarm.ocp.solvers.derivatives import differentiate_absolute

numbers = st.floats(-10.0, 10.0)
NODE = np.array(GAUSS_NODES)
X = Polynomial([0.0, 1.0])
# The quadratic through the nodes' values is the sum of these times the values.
BASIS = [
    math.prod((X - other) / (node - other) for other in NODE if other != node) for node in NODE
]
LEAST = 1e-3
"""Slopes above this count as they are."""

QUADRATICS = {
    "constant": Polynomial([3.0]),
    "negative": Polynomial([-3.0]),
    "complex zeros": Polynomial([1.0, -1.0, 1.0]),
    "zeros outside": (X + 1) * (X - 2),
    "ramp through zero": 2 * X - 1,
    "falling ramp": 1 - 3 * X,
    "one zero": X**2 - 1 / 4,
    "two zeros": (X - 1 / 4) * (X - 3 / 4),
    "two zeros, near the ends": -5 * (X - 0.02) * (X - 0.99),
}


def _zeros(quadratic):
    roots = quadratic.trim(1e-12).roots()
    return [r.real for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1]


def _energy(power):
    return float(resolved_energy([ca.DM(p) for p in power], 1.0))


def _derivatives(power, least=LEAST):
    """Gradient [3], second derivatives [3, 3]."""
    gradient, zeros = differentiate_absolute([ca.DM(p) for p in power], ca.DM(least))
    bends = [float(bend) * np.outer(*[[float(w) for w in weights]] * 2) for weights, bend in zeros]
    return np.array([float(x) for x in gradient]), sum(bends)


def _with_sign(quadratic, function):
    """Integral over the step of the function times the sign of the quadratic."""
    breaks = [0.0, *sorted(_zeros(quadratic)), 1.0]
    primitive, middles = function.integ(), np.add(breaks[:-1], breaks[1:]) / 2
    return np.sign(quadratic(middles)) @ np.diff(primitive(np.array(breaks)))


@pytest.mark.parametrize("name", QUADRATICS)
def test_the_gradient_is_the_integral_of_the_sign(name):
    # d/dp of the integral of |p| is the integral of sign(p): the zeros' own move adds nothing.
    quadratic = QUADRATICS[name]
    gradient, _ = _derivatives(quadratic(NODE))
    expected = [_with_sign(quadratic, function) for function in BASIS]
    assert _energy(quadratic(NODE)) == pytest.approx(_with_sign(quadratic, quadratic), abs=1e-14)
    assert gradient == pytest.approx(np.array(expected), abs=1e-13)


def test_where_the_power_touches_zero_the_gradient_is_that_of_one_sign():
    # 4 (x - 1/2)^2 has a double zero on the middle node, whose curvature has no bound.
    power = 4 * (NODE - 0.5) ** 2
    gradient, bends = _derivatives(power)
    assert _energy(power) == pytest.approx(1 / 3, rel=1e-12)
    assert gradient == pytest.approx(np.array(GAUSS_WEIGHTS), abs=1e-6)
    assert np.linalg.norm(bends) <= 2 * 2 / LEAST  # two zeros, each 2 g g' / slope with |g| = 1


VANISHING = math.prod(X - node for node in GAUSS_NODES)


@given(c0=numbers, c1=numbers, c2=numbers, cubic=numbers, quartic=numbers)
def test_terms_beyond_the_quadratic_move_work_across_its_zeros(c0, c1, c2, cubic, quartic):
    # By definition: the work of the whole quartic between the zeros of its quadratic part.
    quadratic = Polynomial([c0, c1, c2])
    work = (quadratic + VANISHING * (cubic + quartic * (X - 0.5))).integ()
    breaks = [0.0, *sorted(_zeros(quadratic)), 1.0]
    power = [ca.DM(float(quadratic(x))) for x in GAUSS_NODES]
    expected = np.abs(np.diff(work(np.array(breaks)))).sum()
    found = float(resolved_energy(power, 0.25, cubic, quartic))
    assert found == pytest.approx(0.25 * expected, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("steps", [2, 10])
def test_a_power_of_degree_four_is_told_exactly(steps):
    quartic_power = Polynomial([0.3, -2.0, 5.0, 7.0, -11.0])
    grid = Mesh(steps)
    at_nodes = quartic_power(grid.nodes).reshape(1, -1)  # horzcat(*power): node after node
    found = [(ca.DM(at_nodes) @ weights).full().ravel() for weights in beyond_quadratic(steps)]
    for step in range(steps):
        local = quartic_power(grid.boundaries[step] + grid.lengths[step] * X)
        _, remainder = divmod(local, VANISHING)
        beyond = (local - remainder) // VANISHING  # cubic + quartic (x - 1/2)
        assert found[0][step] == pytest.approx(beyond(0.5), abs=1e-9)
        assert found[1][step] == pytest.approx(beyond.deriv()(0.5), abs=1e-9)


def test_a_step_alone_has_no_neighbours():
    found = [(ca.DM([[1.0, -2.0, 5.0]]) @ weights).full() for weights in beyond_quadratic(1)]
    assert [x.tolist() for x in found] == [[[0.0]], [[0.0]]]


@pytest.mark.parametrize(
    ("target", "halfway", "overshoot"), [(1.0, 1.25, 0.25), (1.0, -0.3, 0.0), (-1.0, -1.25, 0.25)]
)
def test_overshoot_is_how_far_the_joint_passes_the_target(target, halfway, overshoot):
    # Two moves from rest to rest by constant accelerations: 0 to halfway, and on to the target.
    there, back = 25 * halfway, 25 * (target - halfway)  # a (0.2 s)^2 is the angle
    free = FreeMotion([0.0, 0.2, 0.4, 0.6, 0.8], [there, -there, back, -back], np.zeros(4))
    task = qa.PointToPoint(qa.SingleLinkManipulator(), target, 0.8)
    motion = qa.JudgedMotion.of_free_motion(task, free).motion
    assert (motion.peak_jerk, motion.peak("jerk")) == (None, math.inf)  # the acceleration jumps
    assert motion.overshoot == pytest.approx(overshoot, abs=1e-12)
    assert math.copysign(1.0, motion.overshoot) == 1.0  # else a table prints -0
