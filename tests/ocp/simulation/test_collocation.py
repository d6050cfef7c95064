"""One step of the modes: nodes and weights, the collocation conditions, order, closed forms."""

import math

import casadi as ca
import numpy as np
import pytest
from quietarm.models import (
    ArmOnFlexibleLink,
    DualLinkManipulator,
    JointMotion,
    SingleLinkManipulator,
)
from quietarm.ocp import CycloidPolynomial
from quietarm.ocp.simulation.collocation import (
    GAUSS_NODES,
    GAUSS_WEIGHTS,
    NODES,
    is_zero,
    mesh,
    modal_system,
    step,
)

AT_REST = JointMotion(0.4, 0.0, 0.0)


@pytest.fixture(params=["single link", "arm", "two links"])
def plant(request, plants):
    return plants[request.param]


def _numbers(nested):
    return np.array([[float(entry) for entry in row] for row in nested])


def _matrix_of(one):
    """The step's linear part, and its constant, as arrays."""
    constant, columns = one.transition()
    return _numbers(columns).T, np.array([float(entry) for entry in constant])


def _joints(fraction, h, terms=(0.1, -0.3, 0.2)):
    """The joint at the nodes of the step that begins at `fraction` of a move of one second."""
    profile = CycloidPolynomial(len(terms))
    return [profile.motion(terms, fraction + node * h, -0.4, 1.2, 1.0) for node in GAUSS_NODES]


# -- the quadrature --


def test_nodes_and_weights_are_those_of_gauss():
    # Three Gauss-Legendre nodes on [0, 1]: Abramowitz and Stegun, table 25.4.
    root = math.sqrt(15) / 10
    assert pytest.approx([0.5 - root, 0.5, 0.5 + root], abs=1e-15) == GAUSS_NODES
    assert pytest.approx([5 / 18, 8 / 18, 5 / 18], abs=1e-15) == GAUSS_WEIGHTS


@pytest.mark.parametrize("power", range(2 * NODES))
def test_the_weights_integrate_up_to_degree_five_exactly(power):
    integral = sum(w * x**power for w, x in zip(GAUSS_WEIGHTS, GAUSS_NODES, strict=True))
    assert integral == pytest.approx(1 / (power + 1), abs=1e-15)


# -- the steps --


@pytest.mark.parametrize("steps", [1, 2, 7, 140])
def test_the_steps_cover_the_move_once(steps):
    begins, lengths = (
        np.array([float(x) for x in xs])
        for xs in zip(*(mesh(k, steps) for k in range(steps)), strict=True)
    )
    ends = begins + lengths
    assert begins[0] == 0.0
    assert begins[1:] == pytest.approx(ends[:-1], abs=1e-15)
    assert ends[-1] == pytest.approx(1.0, abs=1e-15)
    assert lengths.min() > 0


def test_the_steps_are_finer_at_the_ends_and_the_same_from_both():
    lengths = np.array([float(mesh(k, 100)[1]) for k in range(100)])
    assert lengths == pytest.approx(lengths[::-1], rel=1e-9)
    assert np.all(np.diff(lengths[:50]) > 0)
    # Half even, half Chebyshev: 1/2 + pi/4 times the even length in the middle, 1/2 at the ends.
    assert lengths[50] == pytest.approx((1 / 2 + math.pi / 4) / 100, rel=1e-3)
    assert lengths[0] == pytest.approx(1 / 2 / 100, rel=0.05)


def test_all_steps_at_once_are_each_step():
    together = [value.full().ravel() for value in mesh(ca.DM(range(9)), 9)]
    for k in range(9):
        assert [float(x) for x in mesh(k, 9)] == [value[k] for value in together]


# -- the coefficients of the modes --


def test_modal_system_of_the_single_link():
    # Eq (9) with eq (10), at theta' = 3, theta'' = 5.
    system = modal_system(SingleLinkManipulator(), JointMotion(0.7, 3.0, 5.0))
    assert system.g == [pytest.approx(-2.555e-1 * 5.0)]
    assert [[pytest.approx(10.43**2 + 2.614e-1 * 3.0**2)]] == system.K
    assert [[pytest.approx(2 * 9.636e-3 * 10.43)]] == system.D


def test_modal_system_of_the_arm():
    # Eq (13) with eq (15), at theta = 0.7, theta' = 3, theta'' = 5.
    system = modal_system(ArmOnFlexibleLink(), JointMotion(0.7, 3.0, 5.0))
    mass = 1 - 1.055e-1 * math.cos(0.7)
    push = (-9.949e-3 + 5.256e-2 * math.cos(0.7)) * 5 - 5.256e-2 * 9 * math.sin(0.7)
    assert float(system.g[0]) == pytest.approx(-push / mass)
    assert float(system.K[0][0]) == pytest.approx(7.320**2 / mass)
    damping = 2 * 1.500e-3 * 7.320 + 7.634e-2 * 3 * math.sin(0.7)
    assert float(system.D[0][0]) == pytest.approx(damping / mass)


def test_modal_system_of_separate_links_has_no_coupling(two_links):
    system = modal_system(two_links, JointMotion(0.7, 3.0, 5.0))
    K = _numbers(system.K)
    # docs/physics.md: omega_i^2 + b_i theta'^2 on the diagonal.
    expected = [
        (12.68 * 0.993) ** 2 + 2.004e-3 * 1.020 * 9,
        (10.71 * 0.993) ** 2 + 5.822e-3 * 1.006 * 9,
    ]
    assert np.diag(K) == pytest.approx(expected)
    assert K[0, 1] == pytest.approx(0.0, abs=1e-12)
    assert K[1, 0] == pytest.approx(0.0, abs=1e-12)


# -- the collocation conditions --


def test_the_nodes_obey_the_plants_own_equations(plant):
    h, random = 0.05, np.random.default_rng(2)
    for fraction in (0.0, 0.35, 0.9):
        joints = _joints(fraction, h)
        W, dW = random.uniform(-0.1, 0.1, (2, plant.modes)).tolist()
        one = step(plant, joints, h)
        ddW = one.accelerations(W, dW)
        for joint, node in zip(joints, one.nodes(W, dW, ddW), strict=True):
            expected = plant.modal_accelerations(joint, node.W, node.dW)
            assert [float(x) for x in node.ddW] == pytest.approx([float(x) for x in expected])


def test_the_state_between_is_the_integral_of_the_nodes_polynomials(plant):
    # Gauss collocation: W' integrates the quadratic through W'' at the nodes, and W the one through
    # W' there; with numpy.polynomial.
    h = 0.08
    W, dW = [0.03] * plant.modes, [-0.5] * plant.modes
    one = step(plant, _joints(0.2, h), h)
    ddW = one.accelerations(W, dW)
    nodes, (W_end, dW_end) = one.nodes(W, dW, ddW), one.end(W, dW, ddW)

    def integral(rates, initial):
        through = np.polynomial.Polynomial.fit(times, [float(rate) for rate in rates], 2)
        return through.integ(lbnd=0.0) + initial

    times = np.array(GAUSS_NODES) * h
    for i in range(plant.modes):
        speed = integral([node.ddW[i] for node in nodes], dW[i])
        place = integral([node.dW[i] for node in nodes], W[i])
        assert [float(node.dW[i]) for node in nodes] == pytest.approx(speed(times), rel=1e-12)
        assert [float(node.W[i]) for node in nodes] == pytest.approx(place(times), rel=1e-12)
        assert float(dW_end[i]) == pytest.approx(speed(h), rel=1e-12)
        assert float(W_end[i]) == pytest.approx(place(h), rel=1e-12)


def test_the_transition_is_the_step(plant):
    random, h = np.random.default_rng(5), 0.03
    one = step(plant, _joints(0.4, h), h)
    matrix, constant = _matrix_of(one)
    state = random.uniform(-0.1, 0.1, 2 * plant.modes)
    W, dW = state[: plant.modes].tolist(), state[plant.modes :].tolist()
    W_end, dW_end = one.end(W, dW, one.accelerations(W, dW))
    expected = [float(x) for x in (*W_end, *dW_end)]
    assert matrix @ state + constant == pytest.approx(expected, rel=1e-12)


# -- closed forms --


def _oscillator(omega=10.0, zeta=0.0):
    return SingleLinkManipulator(omega=omega, zeta=zeta, beta2=0.0)


@pytest.mark.parametrize("h", [0.01, 0.1, 0.3])
def test_an_undamped_oscillator_keeps_its_energy(h):
    # Gauss methods keep quadratic invariants (Hairer, Lubich, Wanner, section IV.2): here
    # W'^2 + omega^2 W^2, whatever the step.
    matrix, _ = _matrix_of(step(_oscillator(), [AT_REST] * NODES, h))
    scaled = np.diag([10.0, 1.0]) @ matrix @ np.diag([0.1, 1.0])
    assert scaled.T @ scaled == pytest.approx(np.eye(2), abs=1e-13)


def test_a_free_step_is_of_order_six():
    # The matrix exponential of a damped oscillator in closed form; a step's error is O(h^7).
    omega, zeta = 10.0, 0.05
    damped, decay = omega * math.sqrt(1 - zeta**2), zeta * omega

    def error(h):
        sine, cosine = math.sin(damped * h) / damped, math.cos(damped * h)
        exact = math.exp(-decay * h) * np.array(
            [[cosine + decay * sine, sine], [-(omega**2) * sine, cosine - decay * sine]]
        )
        one = step(_oscillator(omega, zeta), [AT_REST] * NODES, h)
        return np.abs(_matrix_of(one)[0] - exact).max()

    assert error(0.02) / error(0.01) == pytest.approx(2**7, rel=0.1)
    assert error(0.01) < 1e-10


def test_a_step_along_a_polynomial_is_exact():
    # omega = 0: W'' = -beta1 theta''; for theta'' = 1 + 2 s - 3 s^2 the step has no error.
    plant = SingleLinkManipulator(omega=0.0, zeta=0.0, beta2=0.0, beta1=1.0)
    h = 0.4
    joints = [JointMotion(0.0, 0.0, 1 + 2 * c * h - 3 * (c * h) ** 2) for c in GAUSS_NODES]
    one = step(plant, joints, h)
    W, dW = one.end([0.1], [0.2], one.accelerations([0.1], [0.2]))
    assert dW[0] == pytest.approx(0.2 - (h + h**2 - h**3), rel=1e-13)
    assert W[0] == pytest.approx(0.1 + 0.2 * h - (h**2 / 2 + h**3 / 3 - h**4 / 4), rel=1e-13)


# -- element by element --


def test_a_population_takes_the_same_step_as_each_of_its_members(plant):
    rows, columns, h = 4, 3, 0.02
    random = np.random.default_rng(11)
    joints = random.uniform(-2, 2, (NODES, 3, rows, columns))
    states = random.uniform(-0.1, 0.1, (2, plant.modes, rows, columns))

    def end(of_joint, of_state):
        one = step(plant, [JointMotion(*joint) for joint in of_joint], h)
        W, dW = of_state
        W_end, dW_end = one.end(W, dW, one.accelerations(W, dW))
        return [*W_end, *dW_end]

    together = end(
        [[ca.DM(entry) for entry in joint] for joint in joints],
        [[ca.DM(entry) for entry in part] for part in states],
    )
    for row in range(rows):
        for column in range(columns):
            alone = end(joints[..., row, column].tolist(), states[..., row, column].tolist())
            here = [float(entry[row, column]) for entry in together]
            assert here == pytest.approx([float(entry) for entry in alone], rel=1e-12)


def test_modes_that_do_not_act_on_each_other_have_no_terms():
    # the two links of docs/physics.md, 'A third plant': each equation has its own W alone
    joint = JointMotion(*(ca.MX.sym("joint", 1, 5) for _ in range(3)))
    system = modal_system(DualLinkManipulator(), joint)
    for matrix in (system.K, system.D):
        assert [[is_zero(entry) for entry in row] for row in matrix] == [
            [False, True],
            [True, False],
        ]
