"""The program over all joint motions: hand-assembled derivatives against casadi's own."""

import numpy as np
import pytest
from derivatives import (
    assert_jacobian_is_casadis,
    assert_jacobian_is_the_limit_of_differences,
    both_hessians,
    functions_of,
)
from quietarm.ocp.floor.transcription import FreeProgram

STEPS = 3
LIMITED = {
    "no limit": (),
    "one limit": ("torque",),
    "all limits": ("torque", "speed", "acceleration", "deflection"),
}


@pytest.fixture(scope="module", params=LIMITED)
def quantities(request):
    return LIMITED[request.param]


@pytest.fixture(scope="module", params=["smooth", "free acceleration"])
def smooth(request):
    return request.param == "smooth"


@pytest.fixture(scope="module", params=["single link", "arm", "two links"])
def program(request, plants, quantities, smooth):
    quiet = {"print_level": 0, "sb": "yes"}
    return FreeProgram(plants[request.param], smooth, STEPS, quantities, quiet)


def _random_point(program, seed):
    """Unknowns, parameters, and multipliers of the objective and the constraints."""
    random = np.random.default_rng(seed)
    lengths = random.uniform(0.1, 0.3, STEPS)
    scale = random.uniform(0.5, 2.0, program.model.scales)
    weights = random.uniform(0.1, 1.0, 1 + len(program.peaks))
    x = random.uniform(-0.5, 0.5, program._solver.size1_in("x0"))
    p = np.concatenate([lengths, scale, weights])
    return x, p, random.normal(), random.normal(size=len(program.lower))


def test_the_jacobian_is_that_of_the_constraints(program):
    x, p, *_ = _random_point(program, 0)
    assert_jacobian_is_casadis(program, x, p)


def test_the_hessian_is_that_of_the_lagrangian(program):
    found, expected = both_hessians(program, *_random_point(program, 1))
    size = np.abs(expected).max()
    assert size > 0
    assert found == pytest.approx(expected, abs=1e-11 * size)


def test_the_jacobian_is_the_limit_of_differences(program):
    x, p, *_ = _random_point(program, 2)
    directions = [np.random.default_rng(seed).normal(size=len(x)) for seed in range(3)]
    assert_jacobian_is_the_limit_of_differences(program, x, p, directions)


def test_a_simulated_motion_meets_the_equations(program, smooth):
    _, p, *_ = _random_point(program, 3)
    model = program.model
    lengths, scale = p[:STEPS], p[STEPS : STEPS + model.scales]
    initial = np.random.default_rng(3).uniform(-0.2, 0.2, len(model.after))
    unknowns, outputs = program.simulate(initial, np.array([0.3, -0.5, 0.1]), lengths, scale)
    assert unknowns[model.after, 0] == pytest.approx(initial)
    power = outputs[:3].ravel(order="F")
    x = np.concatenate([np.full(len(program.peaks), 50.0), unknowns.ravel(order="F"), abs(power)])
    g = functions_of(program)["nlp_g"](x, p).full().ravel()
    equations = len(model.after) * STEPS
    assert g[:equations] == pytest.approx(np.zeros(equations), abs=1e-13)
    two_sided = g[equations : equations + 6 * STEPS].reshape(2, -1)
    assert two_sided.min(axis=0) == pytest.approx(np.zeros(3 * STEPS), abs=1e-12)  # |power| exactly
