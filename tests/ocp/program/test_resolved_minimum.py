"""From the sampled minimum to that of the energy with its sign changes resolved."""

import numpy as np
import pytest

from ocp import CycloidPolynomial, resimulate
from ocp.plan.solver import _HIDDEN
from ocp.program.transcription import RESIDUAL

TERMS = 6
START = np.zeros(TERMS)
PROFILE = CycloidPolynomial(TERMS)
AT_REST = {RESIDUAL: 0.0}


@pytest.mark.parametrize("bound", [None, 0.3])
def test_finishing_brings_the_sampled_minimum_to_the_resolved_one(problem, task, bound):
    asked = problem(task, AT_REST, bound)
    sampled = asked.solve(START, finish=False)
    assert sampled.form.sampled
    assert not sampled.settled
    finished = asked.finished(sampled)
    assert finished.form == sampled.form._replace(energy="resolved")
    assert finished.settled
    at_once = asked.solve(START)
    assert finished.coefficients.tolist() == at_once.coefficients.tolist()
    assert finished.iterations == at_once.iterations > sampled.iterations
    assert finished.energy < sampled.energy
    assert sampled.energy <= finished.energy * (1 + _HIDDEN)


def _energies_at_rest(program, found, count, size):
    """Energies of motions at rest that lie this far from a solution, in random directions."""
    random, h = np.random.default_rng(2), 1e-6

    def arrival(a):
        return program.figures(a)[0][:, -1]

    at = found.coefficients
    columns = [(arrival(at + h * e) - arrival(at - h * e)) / (2 * h) for e in np.eye(TERMS)]
    jacobian = np.column_stack(columns)
    for _ in range(count):
        away = random.normal(size=TERMS)
        away -= np.linalg.lstsq(jacobian, jacobian @ away)[0]
        a = at + size * away / np.linalg.norm(away)
        for _ in range(6):
            a -= np.linalg.lstsq(jacobian, arrival(a))[0]
        assert np.abs(arrival(a)).max() < 1e-9
        yield program.figures(a)[2]


@pytest.mark.parametrize("size", [1e-4, 1e-3, 1e-2])
def test_no_neighbour_at_rest_has_less_resolved_energy(problem, task, size):
    # The sampled program's minimum is near; the resolved one's is what the solution stands at.
    asked = problem(task, AT_REST)
    found, program = asked.solve(START), asked.program
    assert found.settled
    best = found.energy / program.reference["energy"]
    for energy in _energies_at_rest(program, found, 20, size):
        assert energy >= best * (1 - 1e-8)


@pytest.mark.parametrize("steps", [24, 60])
def test_energy_does_not_hide_between_the_nodes(problem, task, steps):
    # The sampled program sees |power| at the nodes only; the solution's energy is the true one.
    found = problem(task, AT_REST, steps=steps).solve(START)
    verified = resimulate(task, PROFILE, found.coefficients)
    assert found.energy == pytest.approx(verified.energy, rel=1e-3)
