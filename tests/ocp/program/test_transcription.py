"""The nonlinear program: its derivatives against casadi's own, and what it states."""

from functools import cache

import numpy as np
import pytest
from derivatives import (
    assert_jacobian_is_casadis,
    assert_jacobian_is_the_limit_of_differences,
    both_hessians,
    functions_of,
)

from ocp import CycloidPolynomial, residual_matrix, rollout
from ocp.program.condensed import Condensed
from ocp.program.ipopt import Point
from ocp.program.transcription import RESIDUAL, Form, NonlinearProgram
from ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES

STEPS, TERMS, ROWS = 4, 3, 6
SAMPLES = 2 * STEPS
PROFILE = CycloidPolynomial(TERMS)
COEFFICIENTS = np.array([0.1, -0.2, 0.15])
QUIET = {"print_level": 0, "sb": "yes"}
LIMITED = {
    "no limit": (),
    "one limit": ("torque",),
    "two limits": ("deflection", "speed"),
    "all limits": ("torque", "speed", "acceleration", "deflection"),
}
# Plant, limited quantities, rows of the residual matrix, the peak that is minimised.
CASES = [
    ("single link", "no limit", 0, None),
    ("single link", "one limit", ROWS, "torque"),
    ("arm", "no limit", ROWS, None),
    ("arm", "all limits", 0, "speed"),
    ("arm", "two limits", 0, None),
    ("two links", "no limit", ROWS, RESIDUAL),
    ("two links", "two limits", ROWS, "deflection"),
    ("two links", "all limits", ROWS, None),
    ("two links", "all limits", 0, "acceleration"),
]
PROGRAMS = [
    (*case, energy)
    for case in CASES
    for energy in ("sampled", "resolved", "free")
    if energy != "free" or case[-1] is not None  # else nothing is minimised
]
SMOOTH = [program for program in PROGRAMS if program[-1] != "resolved"]
"""casadi has no derivatives of the resolved energy where zeros are complex."""


def _name(case):
    return ", ".join(map(str, case))


@pytest.fixture(scope="module")
def compiled(plants):
    """A program, compiled once."""

    @cache
    def of(name, limited, form, steps=STEPS):
        motion = Condensed(plants[name], PROFILE, steps, LIMITED[limited])
        return NonlinearProgram(motion, form, QUIET)

    return of


@pytest.fixture(params=PROGRAMS, ids=_name)
def program(request, compiled):
    name, limited, rows, least, energy = request.param
    return compiled(name, limited, Form(energy, rows, least))


def _parameters(program, seed):
    """Move, scales, weights, correction of the arrival, residual matrix by columns, basis."""
    random, motion = np.random.default_rng(seed), program.motion
    move, scale = [-0.4, 1.1, 0.7], random.uniform(0.5, 2.0, motion.scales)
    weights, offset = random.uniform(0.1, 1.0, 2), random.normal(size=motion.states)
    matrix = random.normal(size=program.form.residual_rows * motion.states)
    return np.concatenate([move, scale, weights, offset, matrix, motion.basis(move, np.eye(TERMS))])


def _random_point(program, seed):
    """Unknowns, parameters, and multipliers of the objective and the constraints."""
    random = np.random.default_rng(seed)
    x = random.uniform(-0.3, 0.3, program.unknowns)
    constraints = functions_of(program)["nlp_g"].numel_out(0)
    return x, _parameters(program, seed), random.normal(), random.normal(size=constraints)


# -- derivatives --


@pytest.mark.parametrize("seed", [0, 1])
def test_the_jacobian_is_that_of_the_constraints(program, seed):
    x, p, *_ = _random_point(program, seed)
    assert_jacobian_is_casadis(program, x, p)


@pytest.mark.parametrize("seed", [0, 2])
def test_the_jacobian_is_the_limit_of_differences(program, seed):
    x, p, *_ = _random_point(program, seed)
    directions = np.random.default_rng(seed).normal(size=(3, len(x)))
    assert_jacobian_is_the_limit_of_differences(program, x, p, directions)


@pytest.mark.parametrize("seed", [0, 2])
def test_the_objectives_gradient_is_the_limit_of_differences(program, seed):
    # casadi has none of the resolved energy where zeros are complex: sqrt(0) there.
    x, p, *_ = _random_point(program, seed)
    functions, h = functions_of(program), 1e-6
    f, gradient = (value.full().ravel() for value in functions["nlp_grad_f"](x, p))
    assert f.item() == pytest.approx(float(functions["nlp_f"](x, p)), rel=1e-13)
    for i, unit in enumerate(np.eye(len(x))):
        there, back = (float(functions["nlp_f"](x + s * h * unit, p)) for s in (1, -1))
        expected = (there - back) / (2 * h)
        assert gradient[i] == pytest.approx(expected, abs=1e-7 * np.abs(gradient).max())


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("program", SMOOTH, indirect=True, ids=_name)
def test_the_hessian_is_that_of_the_lagrangian(program, seed):
    found, expected = both_hessians(program, *_random_point(program, seed))
    assert found == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("case", CASES, ids=_name)
def test_the_hessian_of_one_resolved_step_is_that_of_the_lagrangian(compiled, case, seed):
    # Here the zeros are real, and casadi has all derivatives of the energy.
    name, limited, rows, least = case
    program = compiled(name, limited, Form("resolved", rows, least), steps=1)
    found, expected = both_hessians(program, *_random_point(program, seed))
    size = np.abs(expected).max()
    assert size > 0
    assert found == pytest.approx(expected, abs=1e-9 * size)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("steps", [STEPS, 30, 240])
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_hessian_of_the_resolved_energy_is_that_of_differences(compiled, name, steps, seed):
    program = compiled(name, "one limit", Form("resolved", 0, None), steps=steps)
    x, p, of_objective, multipliers = _random_point(program, seed)
    functions, h = functions_of(program), 1e-6
    found = functions["nlp_hess_l"](x, p, of_objective, 0 * multipliers).full()
    for i, unit in enumerate(np.eye(len(x))):
        there, back = (functions["nlp_grad_f"](x + s * h * unit, p)[1].full() for s in (1, -1))
        expected = of_objective * (there - back).ravel()[i:] / (2 * h)  # the upper triangle
        assert found[i, i:] == pytest.approx(expected, abs=1e-3 * np.abs(found).max())


# -- what the program states --


def _samples(power):
    """The quadratic through a step's three nodes at the two Gauss nodes, step by step."""
    at = (np.polynomial.legendre.leggauss(2)[0] + 1) / 2
    steps = np.reshape(power, (-1, NODES))
    return np.concatenate([np.polyval(np.polyfit(GAUSS_NODES, step, 2), at) for step in steps])


class _Stated:
    """A motion put into a program: what it is, and the unknowns that agree with it."""

    def __init__(self, program, p, a=COEFFICIENTS):
        motion, form = program.motion, program.form
        sizes = [3, motion.scales, 2, motion.states, form.residual_rows * motion.states]
        move, scale, self.weights, offset, matrix, _ = np.split(p, np.cumsum(sizes))
        states, outputs, energy = (x.full() for x in motion.figures(a, move, scale))
        self.energy, self.arrival = energy.item(), states[:, -1] + offset
        first = motion.states
        self.values = {
            group.name: outputs[group.first - first :][: group.rows].ravel(order="F")
            for group in motion.groups[1:]
        }
        self.power = self.values.pop("power")
        self.samples = _samples(self.power)
        if form.residual_rows:
            rows = matrix.reshape(form.residual_rows, motion.states, order="F")
            self.values[RESIDUAL] = rows @ self.arrival
        self.peaks = {name: np.abs(value).max() for name, value in self.values.items()}
        self.mean = np.repeat(motion.lengths, 2) / 2 @ np.abs(self.samples)
        parts = {
            "coefficients": a,
            "peak": [] if form.least is None else [self.peaks[form.least]],
            "arrival": self.arrival if form.residual_rows else [],
            "power": np.append(np.maximum(self.samples, 0), np.maximum(-self.samples, 0))
            if form.sampled
            else [],
        }
        self.unknowns = np.concatenate(list(parts.values()))


def test_the_unknowns_stand_in_their_order(program):
    stated = _Stated(program, _parameters(program, 3))
    assert len(stated.unknowns) == program.unknowns
    assert stated.unknowns[program.part("coefficients")].tolist() == COEFFICIENTS.tolist()
    if program.form.residual_rows:
        assert stated.unknowns[program.part("arrival")].tolist() == stated.arrival.tolist()
    if program.form.least:
        peak = stated.unknowns[program.part("peak")]
        assert peak.tolist() == [stated.peaks[program.form.least]]
    power = stated.unknowns[program.part("power")]
    assert len(power) == (2 * SAMPLES if program.form.sampled else 0)


def test_the_constraints_are_equations_and_values_to_be_bounded(program):
    stated, form = _Stated(program, p := _parameters(program, 3)), program.form
    rest = functions_of(program)["nlp_g"](stated.unknowns, p).full().ravel()
    samples, rest = np.split(rest, [SAMPLES if form.sampled else 0])
    assert np.abs(samples).max(initial=0.0) < 1e-13
    arrival, rest = np.split(rest, [program.motion.states])
    expected = np.zeros_like(arrival) if form.residual_rows else stated.arrival
    assert arrival == pytest.approx(expected, abs=1e-13)
    for name, value in stated.values.items():
        if name == form.least:  # the peak bounds its values from both sides, and is tight
            below, above, rest = np.split(rest, [len(value), 2 * len(value)])
            assert below == pytest.approx(value - stated.peaks[name], abs=1e-13)
            assert above == pytest.approx(value + stated.peaks[name], abs=1e-13)
        else:
            found, rest = np.split(rest, [len(value)])
            assert found == pytest.approx(value, rel=1e-12, abs=1e-13)
    assert not rest.size


def test_the_objective_weighs_energy_and_peak(program):
    stated, form = _Stated(program, p := _parameters(program, 4)), program.form
    energy = {"sampled": stated.mean, "resolved": stated.energy, "free": 0.0}[form.energy]
    expected = stated.weights[0] * energy
    if form.least:
        expected += stated.weights[1] * stated.peaks[form.least]
    found = float(functions_of(program)["nlp_f"](stated.unknowns, p))
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "limits", [{}, {"torque": 1.5, RESIDUAL: 0.1}, {"deflection": 0.3, "speed": 2.5}]
)
def test_limits_bound_their_own_quantity_from_both_sides(program, limits):
    lower, upper = program._constraint_bounds(limits)
    stated, form = _Stated(program, p := _parameters(program, 5)), program.form
    assert len(lower) == len(upper) == functions_of(program)["nlp_g"](stated.unknowns, p).numel()
    equations = (SAMPLES if form.sampled else 0) + program.motion.states
    assert not lower[:equations].any()
    assert not upper[:equations].any()
    place = equations
    for name, value in stated.values.items():
        count = len(value)
        if name == form.least:
            assert upper[place : place + count].tolist() == [0.0] * count
            assert lower[place : place + count].tolist() == [-np.inf] * count
            place += count
            assert lower[place : place + count].tolist() == [0.0] * count
            assert upper[place : place + count].tolist() == [np.inf] * count
        else:
            limit = limits.get(name, np.inf)
            assert upper[place : place + count].tolist() == [limit] * count
            assert lower[place : place + count].tolist() == [-limit] * count
        place += count


# -- the same figures as everywhere --


@pytest.mark.parametrize("steps", [5, 30])
@pytest.mark.parametrize("energy", ["sampled", "resolved", "free"])
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_every_form_states_what_the_rollout_finds(tasks, compiled, energy, name, steps):
    task, matrix = tasks[name], residual_matrix(tasks[name])
    form = Form(energy, len(matrix), RESIDUAL)
    program = compiled(name, "all limits", form, steps)
    scale, weights = np.ones(program.motion.scales), [1.0, 0.0]
    nothing = np.zeros(program.motion.states)
    parts = [task.move, scale, weights, nothing, matrix.ravel(order="F")]
    p = np.concatenate([*parts, program.motion.basis(task.move, np.eye(TERMS))])
    stated = _Stated(program, p)
    fixed = rollout(task, PROFILE, COEFFICIENTS, steps=steps)
    assert stated.arrival == pytest.approx(np.array(fixed.arrival), rel=1e-10)
    for quantity, peak in stated.peaks.items():
        assert peak == pytest.approx(fixed.motion.peak(quantity), rel=1e-10)
    weights = np.outer(program.motion.lengths, GAUSS_WEIGHTS).ravel()
    net_work = task.duration * weights @ stated.power
    assert net_work == pytest.approx(fixed.motion.net_work, rel=1e-9)
    functions = functions_of(program)
    equations = (2 * steps if form.sampled else 0) + program.motion.states
    g = functions["nlp_g"](stated.unknowns, p).full().ravel()
    assert np.abs(g[:equations]).max() < 1e-12
    found = task.duration * float(functions["nlp_f"](stated.unknowns, p))
    if energy == "sampled":  # between the samples some hides: never less than the net work is seen
        assert found >= abs(fixed.motion.net_work)
        assert found == pytest.approx(task.duration * stated.mean, rel=1e-12)
    elif energy == "resolved":  # less what neighbouring steps tell, of fourth order in their length
        assert found == pytest.approx(task.duration * stated.energy, rel=1e-12)
        assert found == pytest.approx(fixed.motion.energy, rel=25 / steps**4)
    else:  # the peak alone, whose weight is zero here
        assert found == 0.0


def test_scales_divide_states_and_quantities(compiled):
    program = compiled("arm", "one limit", Form("resolved", 0, None))
    scale, move = np.array([2.0, 3.0, 5.0, 7.0]), [-0.4, 1.1, 0.7]
    states, outputs, energy = (
        x.full() for x in program.motion.figures(COEFFICIENTS, move, np.ones(4))
    )
    divided = [x.full() for x in program.motion.figures(COEFFICIENTS, move, scale)]
    expected = states / [[2.0], [3.0]], outputs / [[5.0], [7.0]], energy / 5
    for found, value in zip(divided, expected, strict=True):
        assert found == pytest.approx(value, rel=1e-12, abs=1e-15)


# -- a run --


def test_a_run_says_how_far_a_bound_is_passed(tasks, compiled):
    task = tasks["arm"]
    program = compiled("arm", "one limit", Form("sampled", 0, None), 12)
    basis = program.motion.basis(task.move, np.eye(TERMS))
    scale = np.ones(program.motion.scales)
    p = np.concatenate([task.move, scale, [1.0, 0.0], np.zeros(2), basis])
    stated = _Stated(program, p, np.zeros(TERMS))
    free = np.full(program.unknowns, np.inf)
    lower = -free
    lower[program.part("power")] = 0.0
    start = Point(stated.unknowns)
    fine = program.solve(start, (lower, free), {}, p)
    assert fine.return_status == "Solve_Succeeded"
    assert fine.passed < 1e-7
    assert fine.iterations > 3
    # A tenth of the torque that the cheapest motion needs is not enough.
    torque = np.abs(_Stated(program, p, fine.point.unknowns[:TERMS]).values["torque"]).max()
    refused = program.solve(start, (lower, free), {"torque": 0.1 * torque}, p)
    assert refused.return_status != "Solve_Succeeded"
    assert refused.passed > 1e-3 * torque
    again = program.solve(fine.point, (lower, free), {}, p)
    assert again.point.unknowns == pytest.approx(fine.point.unknowns, abs=1e-5)
