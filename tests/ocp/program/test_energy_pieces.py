"""Derivatives of the energy's pieces along the condensed motion."""

from dataclasses import replace

import numpy as np
import pytest
from both_motions import TERMS, Both, full, of_bends

from ocp import CycloidPolynomial
from ocp.program.pieces import EnergyPieces
from ocp.simulation.collocation import NODES

# -- the energy --


@pytest.mark.parametrize("steps", [1, 2, 4, 30])
def test_the_energys_gradient_by_the_power_is_the_limit_of_differences(steps):
    energy, h, random = EnergyPieces(steps), 1e-7, np.random.default_rng(6)
    power = random.normal(size=(1, NODES * steps))
    gradient = energy.first(power)[0].full().ravel()
    for away in random.normal(size=(3, *power.shape)):
        there, back = (float(energy.value(power + s * h * away)) for s in (1, -1))
        assert away.ravel() @ gradient == pytest.approx((there - back) / (2 * h), abs=1e-6)


def _weights(case, gradient):
    """Multipliers of arrival and outputs: the energy's derivatives by the power, else none."""
    motion = case.motion
    others = np.zeros((motion.rows - 1, motion.nodes))
    return np.zeros((motion.states, 1)), np.vstack([gradient.T, others])


def test_the_energys_second_derivatives_where_the_power_keeps_its_sign(plants):
    # Eq (8) without inertia: tau = c theta', so that the power is c theta'^2.
    plant = replace(plants["single link"], alpha1=0.0, alpha2=0.0)
    case = Both(plant, CycloidPolynomial(TERMS), ("torque",), 30, second=False)
    motion, (a, move, scale), h = case.motion, case.inputs, 1e-5
    power = case.simulated(a)[1][:1]
    assert power.min() > 0
    gradient, bends = full(motion.energy.first(power))
    found = case.curvature(*_weights(case, gradient)) + of_bends(case, bends)

    def energy(coefficients):
        return float(motion.figures(coefficients, move, scale)[2])

    for i, j in np.ndindex(found.shape):
        u, v = h * np.eye(TERMS)[[i, j]]
        crossed = energy(a + u + v) - energy(a + u - v) - energy(a - u + v) + energy(a - u - v)
        expected = crossed / (4 * h * h)
        assert found[i, j] == pytest.approx(expected, abs=1e-4 * np.abs(found).max())


@pytest.mark.parametrize("steps", [1, 4, 30])
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_energys_second_derivatives_where_zeros_move(plants, name, steps):
    case = Both(plants[name], CycloidPolynomial(TERMS), (), steps, second=False)
    motion, a, h = case.motion, case.inputs[0], 1e-6
    power = case.simulated(a)[1]
    assert power.min() < 0 < power.max()
    gradient, bends = full(motion.energy.first(power))
    found = case.curvature(*_weights(case, gradient)) + of_bends(case, bends)

    def slope(coefficients):
        there = case.simulated(coefficients)[1]
        return case.firsts(coefficients)[1] @ motion.energy.first(there)[0].full().ravel()

    for i, unit in enumerate(np.eye(TERMS)):
        expected = (slope(a + h * unit) - slope(a - h * unit)) / (2 * h)
        assert found[i] == pytest.approx(expected, abs=1e-6 * np.abs(found).max())
