"""The motion as a function of the coefficients, against casadi's derivatives of the plain rollout.

`symbolic_rollout` knows neither groups nor recursions of derivatives; its are casadi's own.
"""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from both_motions import COEFFICIENTS, MOVE, QUANTITIES, TERMS, Both, full, of_bends
from numpy.polynomial import Polynomial

from ocp import CycloidPolynomial, PointToPoint, rollout
from ocp.program.condensed import Condensed
from ocp.simulation.collocation import GAUSS_NODES, NODES, mesh

CASES = [
    *((plant, "all", 4) for plant in ("single link", "arm", "two links")),
    *(("two links", quantities, 4) for quantities in ("none", "one", "two")),
    *((plant, "two", 1) for plant in ("single link", "two links")),
    ("arm", "one", 30),
]


FEW_STEPS = [case for case in CASES if case[-1] <= 4]
"""Those whose second derivatives casadi takes of the plain rollout in a moment."""


@pytest.fixture(scope="module")
def both(plants):
    @cache
    def of(name, quantities, steps):
        profile = CycloidPolynomial(TERMS)
        return Both(plants[name], profile, QUANTITIES[quantities], steps, second=steps <= 4)

    return of


def _name(case):
    return ", ".join(map(str, case))


@pytest.fixture(params=CASES, ids=_name)
def case(request, both):
    return both(*request.param)


# -- values --


def test_the_motion_is_that_of_the_plain_rollout(case):
    arrival, outputs = case.simulated(case.inputs[0])
    expected_arrival, expected, _ = full(case.plain[0](*case.inputs))
    assert arrival == pytest.approx(expected_arrival, rel=1e-10, abs=1e-13)
    assert outputs == pytest.approx(expected, rel=1e-10, abs=1e-12)


def test_the_figures_hold_every_state_the_same_outputs_and_the_energy(case):
    arrival, outputs = case.simulated(case.inputs[0])
    states, same, energy = full(case.motion.figures(*case.inputs))
    assert states[:, -1:] == pytest.approx(arrival, rel=1e-12, abs=1e-14)
    assert same == pytest.approx(outputs, rel=1e-12, abs=1e-13)
    assert states.shape == (case.motion.states, case.motion.steps)
    assert energy.item() > 0


@pytest.mark.parametrize("steps", [1, 7, 60])
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_energy_is_that_of_each_steps_quadratic(tasks, name, steps):
    task, profile = tasks[name], CycloidPolynomial(TERMS)
    motion = Condensed(task.plant, profile, steps, ())
    scale = np.ones(motion.scales)
    scale[motion.states] = 0.3  # the power's
    _, outputs, energy = full(motion.figures(COEFFICIENTS, task.move, scale))
    by_step = outputs[0].reshape(steps, NODES)
    # |p| of a quadratic: its primitive between its zeros in the step.
    expected = 0.0
    for power, length in zip(by_step, motion.lengths, strict=True):
        quadratic = Polynomial.fit(GAUSS_NODES, power, 2, domain=[0, 1], window=[0, 1])
        zeros = [r.real for r in quadratic.roots() if abs(r.imag) < 1e-12 and 0 < r.real < 1]
        work = np.diff(quadratic.integ()(np.array([0.0, *sorted(zeros), 1.0])))
        expected += length * np.abs(work).sum()
    assert energy.item() == pytest.approx(expected, rel=1e-10)
    if steps == 1:  # no neighbours: the rollout's
        simulated = rollout(task, profile, COEFFICIENTS, steps=1).motion.energy
        assert energy.item() * 0.3 * task.duration == pytest.approx(simulated, rel=1e-11)


def test_one_motion_serves_every_move(plants):
    # Start, target and duration are inputs.
    profile, steps = CycloidPolynomial(TERMS), 20
    motion = Condensed(plants["arm"], profile, steps, ())
    for start, target, duration in ((0.0, 1.6, 0.8), (-1.6, 0.8, 1.0)):
        task = PointToPoint(plants["arm"], target, duration, start=start)
        states = motion.figures(COEFFICIENTS, task.move, np.ones(motion.scales))[0]
        expected = rollout(task, profile, COEFFICIENTS, steps=steps).arrival
        assert states.full()[:, -1] == pytest.approx(np.array(expected), rel=1e-10)


def test_the_steps_lengths_are_those_of_the_mesh(both):
    motion = both("arm", "one", 30).motion
    expected = [float(mesh(k, 30)[1]) for k in range(30)]
    assert motion.lengths == pytest.approx(np.array(expected), rel=1e-14)
    assert motion.lengths.sum() == pytest.approx(1.0, rel=1e-14)


def test_columns_of_a_quantity_are_found_by_its_name(both):
    case = both("two links", "all", 4)
    motion = case.motion
    assert [group.name for group in motion.groups] == ["state", "power", *QUANTITIES["all"]]
    outputs = case.simulated(case.inputs[0])[1]
    flat, last = ca.MX(ca.DM(outputs.ravel(order="F"))).T, 0
    for group in motion.groups[1:]:
        rows = slice(last, last + (2 if group.name == "deflection" else 1))
        last = rows.stop
        (found,) = case.evaluated(motion.of_group(flat, group.name))
        assert found.ravel().tolist() == outputs[rows].ravel(order="F").tolist()
    assert last == motion.rows


# -- first derivatives --


def test_first_derivatives_are_those_of_the_plain_rollout(case):
    of_arrival, of_outputs = (x.T for x in case.firsts(case.inputs[0]))
    expected = case.plain[0](*case.inputs)[2].full()
    size, states = np.abs(expected).max(), case.motion.states
    assert of_arrival == pytest.approx(expected[:states], abs=1e-12 * size)
    assert of_outputs == pytest.approx(expected[states:], abs=1e-12 * size)


def test_first_derivatives_are_the_limit_of_differences(case):
    # Independent of casadi's derivatives.
    a, h = case.inputs[0], 1e-6
    of_arrival, of_outputs = case.firsts(a)
    for i, unit in enumerate(np.eye(len(a))):
        there, back = (case.simulated(a + s * h * unit) for s in (1, -1))
        arrival, outputs = ((x - y) / (2 * h) for x, y in zip(there, back, strict=True))
        size = np.abs(outputs).max()
        assert of_arrival[i] == pytest.approx(arrival.ravel(), abs=1e-8 * size)
        assert of_outputs[i] == pytest.approx(outputs.ravel(order="F"), abs=1e-8 * size)


@pytest.mark.parametrize("name", ["arm", "two links"])
def test_along_other_axes_the_same_motion_is_a_function_of_other_unknowns(plants, name):
    # The coefficients are the axes times the unknowns; derivatives follow by the chain rule.
    axes = np.random.default_rng(7).uniform(-1.0, 1.0, (TERMS, TERMS))
    case = Both(plants[name], CycloidPolynomial(TERMS), ("torque",), 4, second=False, axes=axes)
    usual = Both(plants[name], CycloidPolynomial(TERMS), ("torque",), 4, second=False)
    a = np.linalg.solve(axes, COEFFICIENTS)
    for found, expected in zip(case.simulated(a), usual.simulated(COEFFICIENTS), strict=True):
        assert found == pytest.approx(expected, rel=1e-10, abs=1e-12)
    for found, expected in zip(case.firsts(a), usual.firsts(COEFFICIENTS), strict=True):
        assert found == pytest.approx(axes.T @ expected, abs=1e-11 * np.abs(expected).max())
    multipliers = _multipliers(case.motion, 0)
    case.inputs = (a, *case.inputs[1:])
    expected = axes.T @ usual.curvature(*multipliers) @ axes
    found = case.curvature(*multipliers)
    assert found == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("terms", [3, 12, 20])
def test_along_even_axes_the_input_moves_alike_and_independently(plants, terms):
    # U at the nodes moves by functions of T that are orthogonal over the move, all of one size.
    motion = Condensed(plants["arm"], CycloidPolynomial(terms), 80, ())
    basis = motion.basis(MOVE, motion.even_axes(MOVE))
    slopes = basis[3 * motion.nodes :].reshape(terms, 3, motion.nodes, order="F")
    U = slopes[:, 0]
    gram = (U * np.repeat(motion.lengths, NODES)) @ U.T
    assert gram == pytest.approx(gram[0, 0] * np.eye(terms), abs=1e-6 * gram[0, 0])
    # The first of them is that of a_1: 1 - T^2, whose integral of squares over T is 16/15.
    assert gram[0, 0] == pytest.approx(NODES * 16 / 15 / 2, rel=1e-3)


# -- second derivatives --


def _multipliers(motion, seed):
    random = np.random.default_rng(seed)
    return random.normal(size=(motion.states, 1)), random.normal(size=(motion.rows, motion.nodes))


@pytest.mark.parametrize("case", FEW_STEPS, indirect=True, ids=_name)
@pytest.mark.parametrize("seed", [0, 1])
def test_second_derivatives_are_those_of_the_plain_rollout(case, seed):
    of_arrival, of_outputs = _multipliers(case.motion, seed)
    multipliers = np.concatenate([of_arrival.ravel(), of_outputs.ravel(order="F")])
    expected = case.plain[1](*case.inputs, multipliers).full()
    found, size = case.curvature(of_arrival, of_outputs), np.abs(expected).max()
    assert size > 0
    assert found == pytest.approx(expected, abs=1e-11 * size)


def test_second_derivatives_are_the_limit_of_differences(case):
    a, h = case.inputs[0], 1e-6
    of_arrival, of_outputs = _multipliers(case.motion, 2)
    found = case.curvature(of_arrival, of_outputs)

    def gradient(coefficients):
        by_arrival, by_outputs = case.firsts(coefficients)
        return by_arrival @ of_arrival.ravel() + by_outputs @ of_outputs.ravel(order="F")

    for i, unit in enumerate(np.eye(len(a))):
        expected = (gradient(a + h * unit) - gradient(a - h * unit)) / (2 * h)
        assert found[i] == pytest.approx(expected, abs=1e-7 * np.abs(found).max())


@pytest.mark.parametrize(("name", "quantities", "steps"), [CASES[0], CASES[2], CASES[-1]])
def test_bends_count_along_the_powers_derivatives(both, name, quantities, steps):
    case, random = both(name, quantities, steps), np.random.default_rng(5)
    blocks = [random.normal(size=(NODES, NODES)) for _ in range(steps)]
    blocks = [block + block.T for block in blocks]
    found = of_bends(case, np.hstack(blocks))
    of_power = case.firsts(case.inputs[0])[1][:, :: case.motion.rows]  # the first row at a node
    columns = np.split(of_power, steps, axis=1)
    expected = sum(x @ block @ x.T for x, block in zip(columns, blocks, strict=True))
    assert found == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())
