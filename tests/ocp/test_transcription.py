"""The nonlinear program: hand-assembled derivatives against casadi's own, and what it states."""

import math

import casadi as ca
import numpy as np
import pytest

from ocp import CycloidPolynomial, PointToPoint, residual_matrix, rollout
from ocp.collocation import GAUSS_WEIGHTS, NODES, mesh
from ocp.transcription import RESIDUAL, NonlinearProgram

STEPS, TERMS, ROWS = 4, 3, 6
LIMITED = {
    "no limit": (),
    "one limit": ("torque",),
    "two limits": ("deflection", "speed"),
    "all limits": ("torque", "speed", "acceleration", "deflection"),
}


@pytest.fixture(params=["at rest", "with residual rows"])
def rows(request):
    return ROWS if request.param == "with residual rows" else 0


@pytest.fixture(params=LIMITED)
def quantities(request):
    return LIMITED[request.param]


@pytest.fixture(params=["single link", "arm", "two links"])
def program(request, plants, quantities, rows):
    profile, quiet = CycloidPolynomial(TERMS), {"print_level": 0, "sb": "yes"}
    return NonlinearProgram(plants[request.param], profile, STEPS, quantities, rows, quiet)


def _weights(steps):
    """Weights of the nodes in the integral over the move, as a fraction of the duration."""
    lengths = [float(mesh(k, steps)[1]) for k in range(steps)]
    return np.concatenate([length * np.array(GAUSS_WEIGHTS) for length in lengths])


def _functions(program):
    """The functions that IPOPT calls, by name."""
    return {name: program._cold.get_function(name) for name in program._cold.get_function()}


def _random_point(program, seed):
    """Unknowns, parameters, and multipliers of the objective and the constraints."""
    layout, random = program.layout, np.random.default_rng(seed)
    weights = random.uniform(0.1, 1.0, 1 + len(layout.peaks))
    scale = random.uniform(0.5, 2.0, program.model.scales)
    residual = random.normal(size=layout.residual_rows * layout.state)
    p = np.concatenate([[-0.4, 1.1, 0.7], scale, weights, residual])
    x = random.uniform(-0.3, 0.3, layout.unknowns)
    return x, p, random.normal(), random.normal(size=len(program.lower))


# -- derivatives --


@pytest.mark.parametrize("seed", [0, 1])
def test_the_jacobian_is_that_of_the_constraints(program, seed):
    x, p, *_ = _random_point(program, seed)
    functions = _functions(program)
    of_x, of_p = ca.MX.sym("x", len(x)), ca.MX.sym("p", len(p))
    g = functions["nlp_g"](of_x, of_p)
    automatic = ca.Function("automatic", [of_x, of_p], [g, ca.jacobian(g, of_x)])
    expected_g, expected = (value.full() for value in automatic(x, p))
    found_g, found = (value.full() for value in functions["nlp_jac_g"](x, p))
    assert found_g == pytest.approx(expected_g, rel=1e-13, abs=1e-13)
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-10)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_hessian_is_that_of_the_lagrangian(program, seed):
    x, p, of_objective, multipliers = _random_point(program, seed)
    functions = _functions(program)
    of_x, of_p = ca.MX.sym("x", len(x)), ca.MX.sym("p", len(p))
    lagrangian = of_objective * functions["nlp_f"](of_x, of_p)
    lagrangian += ca.dot(multipliers, functions["nlp_g"](of_x, of_p))
    automatic = ca.Function("automatic", [of_x, of_p], [ca.hessian(lagrangian, of_x)[0]])
    expected = np.triu(automatic(x, p).full())
    found = functions["nlp_hess_l"](x, p, of_objective, multipliers).full()
    size = np.abs(expected).max()
    assert size > 0
    assert found == pytest.approx(expected, abs=1e-11 * size)


def test_the_jacobian_is_the_limit_of_differences(program):
    # Independent of casadi's derivatives, along random directions.
    x, p, *_ = _random_point(program, 2)
    functions, h = _functions(program), 1e-6
    jacobian = functions["nlp_jac_g"](x, p)[1].full()
    for seed in range(3):
        direction = np.random.default_rng(seed).normal(size=len(x))
        there, back = (functions["nlp_g"](x + s * h * direction, p).full() for s in (1, -1))
        expected = (there - back).ravel() / (2 * h)
        assert jacobian @ direction == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


# -- what the program states --


def _consistent(program, a, p):
    """Unknowns whose states are the simulation's, with slacks and peaks that just suffice."""
    layout, move = program.layout, p[:3]
    scale = p[3 : 3 + program.model.scales]
    states, outputs = program.simulate(a, move, scale)
    values = {group.name: outputs[group.where] for group in program.model.groups}
    residual = p[len(p) - layout.residual_rows * layout.state :]
    matrix = residual.reshape(layout.residual_rows, layout.state, order="F")
    values[RESIDUAL] = matrix @ states[:, -1]
    peaks = [np.abs(values[name]).max() for name in layout.peaks]
    slack = np.abs(values["power"]).ravel(order="F")
    return np.concatenate([a, peaks, states.ravel(order="F"), slack]), values


def test_a_simulated_motion_just_meets_the_constraints(program):
    _, p, *_ = _random_point(program, 3)
    layout = program.layout
    x, _ = _consistent(program, np.array([0.1, -0.2, 0.15]), p)
    g = _functions(program)["nlp_g"](x, p).full().ravel()
    steps = layout.state * layout.steps
    assert g[:steps] == pytest.approx(np.zeros(steps), abs=1e-13)  # each step continues the last
    assert g[steps:].min() == pytest.approx(0.0, abs=1e-13)  # nothing above its peak or slack
    # Every slack and every peak is tight: less of any of them breaks a constraint.
    for i in [*range(layout.coefficients, layout.first_state), *range(layout.first_slack, len(x))]:
        less = x.copy()
        less[i] -= 1e-3
        g = _functions(program)["nlp_g"](less, p).full().ravel()
        assert g[steps:].min() < -0.9e-3


def test_the_objective_weighs_energy_and_peaks(program):
    _, p, *_ = _random_point(program, 4)
    layout = program.layout
    x, values = _consistent(program, np.array([0.1, -0.2, 0.15]), p)
    first = 3 + program.model.scales
    energy_weight, *peak_weights = p[first : first + 1 + len(layout.peaks)]
    # The mean of |power| over the move, by the weights of the nodes.
    mean = _weights(STEPS) @ np.abs(values["power"]).ravel(order="F")
    peaks = [np.abs(values[name]).max() for name in layout.peaks]
    expected = energy_weight * mean + np.dot(peak_weights, peaks)
    assert float(_functions(program)["nlp_f"](x, p)) == pytest.approx(expected, rel=1e-12)


def test_the_bounds_are_equalities_for_the_steps_only(program):
    steps = program.layout.state * STEPS
    assert np.abs(program.lower).max() == 0.0
    assert np.abs(program.upper[:steps]).max() == 0.0
    assert np.all(program.upper[steps:] == np.inf)
    tips = 2 if program.layout.state == 4 else 1
    inequalities = 2 * NODES * STEPS  # of the power
    for name in program.layout.peaks:
        if name == RESIDUAL:
            inequalities += 2 * ROWS
        else:
            inequalities += 2 * NODES * STEPS * (tips if name == "deflection" else 1)
    assert len(program.lower) == steps + inequalities


# -- the same simulation as everywhere --


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_program_simulates_as_the_rollout_does(tasks, name):
    task, profile, steps = tasks[name], CycloidPolynomial(TERMS), 30
    a, quantities = np.array([0.1, -0.2, 0.15]), LIMITED["all limits"]
    program = NonlinearProgram(task.plant, profile, steps, quantities, 0, {"print_level": 0})
    states, outputs = program.simulate(a, task.move, np.ones(program.model.scales))
    fixed = rollout(task, profile, a, steps=steps)
    assert states[:, 0].tolist() == [0.0] * program.layout.state
    assert states[:, -1] == pytest.approx(fixed.arrival, rel=1e-10)
    for group in program.model.groups:
        if group.name in quantities:
            peak = np.abs(outputs[group.where]).max()
            assert peak == pytest.approx(fixed.motion.peak(group.name), rel=1e-10)
        if group.name == "power":
            net_work = task.duration * _weights(steps) @ outputs[group.where].ravel(order="F")
            assert net_work == pytest.approx(fixed.motion.net_work, rel=1e-10)


def test_scales_divide_states_and_quantities(tasks):
    task, profile, steps = tasks["arm"], CycloidPolynomial(TERMS), 10
    program = NonlinearProgram(task.plant, profile, steps, ("torque",), 0, {"print_level": 0})
    a, scale = np.array([0.1, -0.2, 0.15]), np.array([2.0, 3.0, 5.0, 7.0])
    states, outputs = program.simulate(a, task.move, np.ones(4))
    scaled_states, scaled_outputs = program.simulate(a, task.move, scale)
    assert scaled_states == pytest.approx(states / [[2.0], [3.0]], rel=1e-12, abs=1e-15)
    for group, factor in zip(program.model.groups[1:], scale[2:], strict=True):
        expected = outputs[group.where] / factor
        assert scaled_outputs[group.where] == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_one_program_serves_every_move(plants):
    # Start, target and duration are parameters.
    profile, steps = CycloidPolynomial(TERMS), 20
    program = NonlinearProgram(plants["arm"], profile, steps, (), 0, {"print_level": 0})
    a = np.array([0.1, -0.2, 0.15])
    for start, target, duration in ((0.0, math.pi / 2, 0.8), (-math.pi / 2, math.pi / 4, 1.0)):
        task = PointToPoint(plants["arm"], target, duration, start=start)
        states, _ = program.simulate(a, task.move, np.ones(program.model.scales))
        expected = rollout(task, profile, a, steps=steps).arrival
        assert states[:, -1] == pytest.approx(expected, rel=1e-10)


def test_residual_rows_bound_the_tip_after_arrival(tasks):
    # The rows of the program are those of `residual_matrix`: the peak they ask for is F1.
    task, profile = tasks["two links"], CycloidPolynomial(TERMS)
    matrix, steps = residual_matrix(task), 20
    program = NonlinearProgram(task.plant, profile, steps, (), len(matrix), {"print_level": 0})
    scale, weights = np.ones(program.model.scales), [0.0, 1.0]
    p = np.concatenate([task.move, scale, weights, matrix.ravel(order="F")])
    a = np.array([0.1, -0.2, 0.15])
    x, values = _consistent(program, a, p)
    residual = rollout(task, profile, a, steps=steps).motion.residual
    assert np.abs(values[RESIDUAL]).max() == pytest.approx(residual, rel=1e-10)
    assert float(_functions(program)["nlp_f"](x, p)) == pytest.approx(residual, rel=1e-10)
