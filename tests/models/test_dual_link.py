"""Two links on one hub: its equations derived anew, its coefficients, its free decay."""

import casadi as ca
import pytest
from hypothesis import given
from hypothesis import strategies as st

from quietarm.models import DualLinkManipulator, JointMotion

motions = st.floats(-10.0, 10.0)
pairs = st.tuples(motions, motions)

# docs/physics.md, 'A third plant': theoretical values times identified factors.
PUBLISHED = {
    "omega1": 12.68 * 0.993, "zeta1": 15.49e-3 * 1.214,
    "a1": 0.2266 * 0.984, "b1": 2.004e-3 * 1.020,
    "omega2": 10.71 * 0.993, "zeta2": 14.27e-3 * 1.071,
    "a2": 0.2570 * 1.003, "b2": 5.822e-3 * 1.006,
    "g1": 2.996e-2 * 1.016, "g2": 6.652e-2 * 1.018, "g3": 5.237e-2 * 1.052, "c": 4.202e-2 * 1.131,
}  # fmt: skip


def test_it_has_the_published_coefficients():
    parameters = DualLinkManipulator().parameters
    assert {name: parameters[name] for name in PUBLISHED} == PUBLISHED
    assert set(parameters) == {*PUBLISHED, "phi"}


def _by_lagrange():
    """(q, q', q'') -> M q'' + ... of Lagrange's equations without damping, q = (theta, W_1, W_2).

    The energies are those of docs/physics.md, with p_i = g_(i+1) and m_i = p_i / a_i.
    """
    p = PUBLISHED
    q, dq, ddq = ca.SX.sym("q", 3), ca.SX.sym("dq", 3), ca.SX.sym("ddq", 3)
    kinetic, potential = p["g1"] * dq[0] ** 2 / 2, 0.0
    for i in (1, 2):
        coupling = p[f"g{i + 1}"]
        mass = coupling / p[f"a{i}"]
        kinetic += mass * dq[i] ** 2 / 2 + coupling * dq[0] * dq[i]
        stiffening = p[f"b{i}"] * dq[0] ** 2
        potential += mass * (p[f"omega{i}"] ** 2 + stiffening) * q[i] ** 2 / 2
    momentum = ca.gradient(kinetic - potential, dq)
    change = ca.jacobian(momentum, dq) @ ddq + ca.jacobian(momentum, q) @ dq
    return ca.Function("lagrange", [q, dq, ddq], [change - ca.gradient(kinetic - potential, q)])


LAGRANGE = _by_lagrange()


@given(speed=motions, acceleration=motions, W=pairs, dW=pairs)
def test_the_modes_follow_from_the_energies(speed, acceleration, W, dW):
    p, plant = PUBLISHED, DualLinkManipulator()
    ddW = plant.modal_accelerations(JointMotion(0.3, speed, acceleration), W, dW)
    forces = LAGRANGE([0.3, *W], [speed, *dW], [acceleration, *ddW]).full().ravel()
    for i in (1, 2):
        mass = p[f"g{i + 1}"] / p[f"a{i}"]
        damping = 2 * p[f"zeta{i}"] * p[f"omega{i}"] * mass * dW[i - 1]
        assert forces[i] == pytest.approx(-damping, abs=1e-9)


@given(speed=motions, acceleration=motions, dW=pairs, ddW=pairs)
def test_the_torque_follows_from_the_energies(speed, acceleration, dW, ddW):
    # With straight links: the products of two amplitudes are left out, docs/physics.md.
    plant, joint = DualLinkManipulator(), JointMotion(0.3, speed, acceleration)
    force = LAGRANGE([0.3, 0, 0], [speed, *dW], [acceleration, *ddW])[0]
    torque = plant.torque(joint, [0.0, 0.0], dW, ddW)
    assert torque == pytest.approx(float(force) + PUBLISHED["c"] * speed, abs=1e-12)
