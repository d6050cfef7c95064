"""A task's numbers in the nonlinear program."""

import numpy as np
import pytest

from ocp import CycloidPolynomial, resimulate, rollout
from ocp.program.task_program import TaskProgram

STEPS, TERMS = 60, 6
PROFILE = CycloidPolynomial(TERMS)
START = np.zeros(TERMS)


def test_everything_is_measured_against_the_plain_cycloid(task):
    plain = rollout(task, PROFILE, START, steps=STEPS)
    program = TaskProgram(task, PROFILE, STEPS)
    states, outputs, energy = program.figures(START)
    assert np.abs(states).max(axis=1) == pytest.approx(np.ones(len(states)), rel=1e-12)
    assert np.abs(outputs[:3]).max() == pytest.approx(1.0, rel=1e-12)  # the power
    # The energy alone leaves out what neighbouring steps tell, of fourth order in their length.
    found = energy * program.reference["energy"]
    assert found == pytest.approx(plain.motion.energy, rel=1e-6)
    assert np.abs(program.matrix).max() == pytest.approx(1.0, rel=1e-12)  # the residual
    assert program.of_cycloid == pytest.approx(plain.motion.residual, rel=1e-9)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_energy_nears_the_true_one_with_the_fourth_power_of_the_steps(task, seed):
    # Only steps with a zero of the power are off, by the cubic h^3 there over the length h. Where
    # in its step the zero stands decides how much: 0.3 to 19 of these units.
    coefficients = np.random.default_rng(seed).uniform(-0.3, 0.3, TERMS)
    true = resimulate(task, PROFILE, coefficients).energy
    for steps in (40, 80, 160):
        program = TaskProgram(task, PROFILE, steps)
        energy = program.figures(coefficients)[2] * program.reference["energy"]
        assert abs(energy / true - 1) < 25 / steps**4
