"""The motion as a function of the coefficients, against casadi's derivatives of the plain rollout.

`symbolic_rollout` knows neither groups nor recursions of derivatives; its are casadi's own.
"""

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest

from ocp import CycloidPolynomial, PointToPoint, rollout
from ocp.collocation import NODES, mesh
from ocp.condensed import Condensed
from ocp.rollout import symbolic_rollout

TERMS = 3
MOVE = np.array([-0.4, 1.1, 0.7])
COEFFICIENTS = np.array([0.1, -0.2, 0.15])
QUANTITIES = {
    "none": (),
    "one": ("torque",),
    "two": ("deflection", "speed"),
    "all": ("torque", "speed", "acceleration", "deflection"),
}
CASES = [
    *((plant, "all", 4) for plant in ("single link", "arm", "two links")),
    *(("two links", quantities, 4) for quantities in ("none", "one", "two")),
    *((plant, "two", 1) for plant in ("single link", "two links")),
    ("arm", "one", 30),
]
FEW_STEPS = [case for case in CASES if case[-1] <= 4]
"""Those whose second derivatives casadi takes of the plain rollout in a moment."""


def _plain(plant, profile, steps, quantities, second):
    """Arrival, outputs of every step, and their derivatives, from the plain rollout."""
    a, move, modes = ca.SX.sym("a", profile.size), ca.SX.sym("move", 3), plant.modes
    scale = ca.SX.sym("scale", 2 * modes + 1 + len(quantities))
    plain = symbolic_rollout(plant, profile, ca.vertsplit(a), ca.vertsplit(move), steps)
    at_nodes = {
        "power": plain.power,
        "torque": plain.torque,
        "speed": [joint.speed for joint in plain.joints],
        "acceleration": [joint.acceleration for joint in plain.joints],
        "deflection": [tip for node in plain.states for tip in plant.tip_displacements(node.W)],
    }
    rows = [
        ca.vertcat(*at_nodes[name]) / scale[2 * modes + i]
        for i, name in enumerate(("power", *quantities))
    ]
    arrival, outputs = plain.arrival.T / scale[: 2 * modes], ca.vertcat(*rows)
    inputs, everything = [a, move, scale], ca.vertcat(arrival, ca.vec(outputs))
    multipliers = ca.SX.sym("lam", everything.numel())
    values = ca.Function("plain", inputs, [arrival, outputs, ca.jacobian(everything, a)])
    if not second:
        return values, None
    curvature = ca.hessian(ca.dot(multipliers, everything), a)[0]
    return values, ca.Function("plain_second", [*inputs, multipliers], [curvature])


class _Both:
    """The condensed motion and the plain rollout of the same case, with scales."""

    def __init__(self, plant, profile, quantities, steps, second):
        self.motion = motion = Condensed(plant, profile, steps, quantities)
        self.plain = _plain(plant, profile, steps, quantities, second)
        scale = np.random.default_rng(steps).uniform(0.5, 2.0, motion.scales)
        self.inputs = (np.resize(COEFFICIENTS, profile.size), MOVE, scale)
        self.symbols = motion.inputs()


@pytest.fixture(scope="module")
def both(plants):
    @cache
    def of(name, quantities, steps):
        profile = CycloidPolynomial(TERMS)
        return _Both(plants[name], profile, QUANTITIES[quantities], steps, second=steps <= 4)

    return of


def _name(case):
    return ", ".join(map(str, case))


@pytest.fixture(params=CASES, ids=_name)
def case(request, both):
    return both(*request.param)


def _full(values):
    return [value.full() for value in values]


# -- values --


def test_the_motion_is_that_of_the_plain_rollout(case):
    arrival, outputs = _full(case.motion.simulate(*case.inputs))
    expected_arrival, expected, _ = _full(case.plain[0](*case.inputs))
    assert arrival == pytest.approx(expected_arrival, rel=1e-10, abs=1e-14)
    assert outputs == pytest.approx(expected, rel=1e-10, abs=1e-13)


def test_the_figures_hold_every_state_the_same_outputs_and_the_energy(case):
    arrival, outputs = _full(case.motion.simulate(*case.inputs))
    states, same, energy = _full(case.motion.figures(*case.inputs))
    assert states[:, -1:] == pytest.approx(arrival, abs=0.0)
    assert same == pytest.approx(outputs, abs=0.0)
    assert states.shape == (case.motion.states, case.motion.steps)
    assert energy.item() > 0


@pytest.mark.parametrize("steps", [1, 7, 60])
@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_energy_is_that_of_the_rollout(tasks, name, steps):
    task, profile = tasks[name], CycloidPolynomial(TERMS)
    motion = Condensed(task.plant, profile, steps, ())
    scale = np.ones(motion.scales)
    scale[motion.states] = 0.3  # the power's
    energy = float(motion.figures(COEFFICIENTS, task.move, scale)[2])
    expected = rollout(task, profile, COEFFICIENTS, steps=steps).motion.energy
    assert energy * 0.3 * task.duration == pytest.approx(expected, rel=1e-12)


def test_one_motion_serves_every_move(plants):
    # Start, target and duration are inputs.
    profile, steps = CycloidPolynomial(TERMS), 20
    motion = Condensed(plants["arm"], profile, steps, ())
    for start, target, duration in ((0.0, 1.6, 0.8), (-1.6, 0.8, 1.0)):
        task = PointToPoint(plants["arm"], target, duration, start=start)
        arrival = motion.simulate(COEFFICIENTS, task.move, np.ones(motion.scales))[0]
        expected = rollout(task, profile, COEFFICIENTS, steps=steps).arrival
        assert arrival.full().ravel() == pytest.approx(np.array(expected), rel=1e-10)


def test_the_steps_lengths_are_those_of_the_mesh(both):
    motion = both("arm", "one", 30).motion
    expected = [float(mesh(k, 30)[1]) for k in range(30)]
    assert motion.lengths == pytest.approx(np.array(expected), rel=1e-14)
    assert motion.lengths.sum() == pytest.approx(1.0, rel=1e-14)


# -- first derivatives --


def test_first_derivatives_are_those_of_the_plain_rollout(case):
    found = case.motion.sensitivities(*case.symbols)
    arrival, outputs, of_arrival, of_outputs = _full(
        ca.Function("found", [*case.symbols], [*found])(*case.inputs)
    )
    expected_arrival, expected_outputs, expected = _full(case.plain[0](*case.inputs))
    assert arrival == pytest.approx(expected_arrival, rel=1e-10, abs=1e-14)
    assert outputs == pytest.approx(expected_outputs, rel=1e-10, abs=1e-13)
    size, states = np.abs(expected).max(), case.motion.states
    assert of_arrival == pytest.approx(expected[:states], abs=1e-12 * size)
    found_outputs = of_outputs.T
    assert found_outputs == pytest.approx(expected[states:], abs=1e-12 * size)


def test_first_derivatives_are_the_limit_of_differences(case):
    # Independent of casadi's derivatives.
    (a, move, scale), h = case.inputs, 1e-6
    found = case.motion.sensitivities(*case.symbols)
    of_arrival, of_outputs = _full(
        ca.Function("found", [*case.symbols], [*found[2:]])(*case.inputs)
    )
    for i, unit in enumerate(np.eye(len(a))):
        there, back = (_full(case.motion.simulate(a + s * h * unit, move, scale)) for s in (1, -1))
        arrival, outputs = ((x - y) / (2 * h) for x, y in zip(there, back, strict=True))
        size = np.abs(outputs).max()
        assert of_arrival[:, i] == pytest.approx(arrival.ravel(), abs=1e-8 * size)
        assert of_outputs[i] == pytest.approx(outputs.ravel(order="F"), abs=1e-8 * size)


def test_a_quantity_is_found_by_its_name(both):
    case = both("two links", "all", 4)
    motion = case.motion
    everything = motion.sensitivities(*case.symbols)
    assert [group.name for group in motion.groups] == ["state", "power", *QUANTITIES["all"]]
    last = 0
    for group in motion.groups[1:]:
        pair = motion.of_group(everything, group.name)
        of_name = ca.Function("of_name", [*case.symbols], [*pair])
        values, first = _full(of_name(*case.inputs))
        _, outputs, jacobian = _full(case.plain[0](*case.inputs))
        rows = slice(last, last + NODES * (2 if group.name == "deflection" else 1))
        last = rows.stop
        assert values.ravel() == pytest.approx(outputs[rows].ravel(order="F"), rel=1e-10)
        places = np.arange(outputs.size).reshape(outputs.shape, order="F")[rows]
        expected = jacobian[motion.states + places.ravel(order="F")]
        assert first == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


# -- second derivatives --


def _multipliers(motion, seed):
    random = np.random.default_rng(seed)
    return random.normal(size=(motion.states, 1)), random.normal(size=(motion.rows, motion.steps))


def _curvature(case, of_arrival, of_outputs, bends=None):
    given = [ca.DM(of_arrival), ca.DM(of_outputs), *([] if bends is None else [ca.DM(bends)])]
    symbols = [ca.MX.sym(f"m{i}", *value.shape) for i, value in enumerate(given)]
    found = case.motion.curvature(case.symbols, *symbols)
    return ca.Function("found", [*case.symbols, *symbols], [found])(*case.inputs, *given).full()


@pytest.mark.parametrize("case", FEW_STEPS, indirect=True, ids=_name)
@pytest.mark.parametrize("seed", [0, 1])
def test_second_derivatives_are_those_of_the_plain_rollout(case, seed):
    of_arrival, of_outputs = _multipliers(case.motion, seed)
    multipliers = np.concatenate([of_arrival.ravel(), of_outputs.ravel(order="F")])
    expected = case.plain[1](*case.inputs, multipliers).full()
    found, size = _curvature(case, of_arrival, of_outputs), np.abs(expected).max()
    assert size > 0
    assert found == pytest.approx(expected, abs=1e-11 * size)


def test_second_derivatives_are_the_limit_of_differences(case):
    (a, move, scale), h = case.inputs, 1e-6
    of_arrival, of_outputs = _multipliers(case.motion, 2)
    first = case.motion.sensitivities(*case.symbols)[2:]
    function = ca.Function("first", [*case.symbols], [*first])
    found = _curvature(case, of_arrival, of_outputs)

    def gradient(coefficients):
        by_arrival, by_outputs = _full(function(coefficients, move, scale))
        return by_arrival.T @ of_arrival.ravel() + by_outputs @ of_outputs.ravel(order="F")

    for i, unit in enumerate(np.eye(len(a))):
        expected = (gradient(a + h * unit) - gradient(a - h * unit)) / (2 * h)
        assert found[i] == pytest.approx(expected, abs=1e-7 * np.abs(found).max())


@pytest.mark.parametrize(("name", "quantities", "steps"), [CASES[0], CASES[2], CASES[-1]])
def test_bends_count_along_the_powers_derivatives(both, name, quantities, steps):
    case = both(name, quantities, steps)
    motion, random = case.motion, np.random.default_rng(5)
    blocks = [random.normal(size=(NODES, NODES)) for _ in range(steps)]
    blocks = [block + block.T for block in blocks]
    nothing = np.zeros((motion.states, 1)), np.zeros((motion.rows, steps))
    found = _curvature(case, *nothing, np.hstack(blocks))
    _, first = motion.of_group(motion.sensitivities(*case.symbols), "power")
    of_power = ca.Function("power", [*case.symbols], [first])(*case.inputs).full()
    rows = np.split(of_power, steps)
    expected = sum(row.T @ block @ row for row, block in zip(rows, blocks, strict=True))
    assert found == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


# -- the energy --


def _energy(motion):
    """Energy, gradient and bends as a function of the outputs."""
    outputs = ca.MX.sym("outputs", motion.rows, motion.steps)
    return ca.Function("energy", [outputs], [*motion.energy(outputs)])


@pytest.mark.parametrize(("name", "quantities", "steps"), CASES)
def test_the_energys_gradient_by_the_power_is_the_limit_of_differences(
    both, name, quantities, steps
):
    motion = both(name, quantities, steps).motion
    function, h, random = _energy(motion), 1e-7, np.random.default_rng(6)
    outputs = random.normal(size=(motion.rows, steps))
    _, gradient, _ = _full(function(outputs))
    for _ in range(3):
        away = random.normal(size=outputs.shape)
        there, back = (float(function(outputs + s * h * away)[0]) for s in (1, -1))
        slope = (gradient * away[:NODES]).sum()  # nothing but the power counts
        assert slope == pytest.approx((there - back) / (2 * h), abs=1e-6)


def test_the_energys_second_derivatives_where_the_power_keeps_its_sign(plants):
    # Eq (8) without inertia: tau = c theta', so that the power is c theta'^2.
    plant = replace(plants["single link"], alpha1=0.0, alpha2=0.0)
    case = _Both(plant, CycloidPolynomial(TERMS), ("torque",), 30, second=False)
    motion, (a, move, scale), h = case.motion, case.inputs, 1e-5
    outputs = motion.simulate(*case.inputs)[1]
    assert outputs.full()[:NODES].min() > 0
    _, gradient, bends = _full(_energy(motion)(outputs))
    weights = np.vstack([gradient, np.zeros((motion.rows - NODES, 30))])
    found = _curvature(case, np.zeros((motion.states, 1)), weights, bends)

    def energy(coefficients):
        return float(motion.figures(coefficients, move, scale)[2])

    for i, j in np.ndindex(found.shape):
        u, v = h * np.eye(TERMS)[[i, j]]
        crossed = energy(a + u + v) - energy(a + u - v) - energy(a - u + v) + energy(a - u - v)
        expected = crossed / (4 * h * h)
        assert found[i, j] == pytest.approx(expected, abs=1e-4 * np.abs(found).max())


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_energys_second_derivatives_where_one_steps_zeros_move(plants, name):
    # A single step has no neighbours, whose terms alone the second derivatives leave out.
    case = _Both(plants[name], CycloidPolynomial(TERMS), (), 1, second=False)
    motion, (a, move, scale), h = case.motion, case.inputs, 1e-6
    outputs = motion.simulate(*case.inputs)[1]
    power = outputs.full().ravel()
    assert power.min() < 0 < power.max()
    _, gradient, bends = _full(_energy(motion)(outputs))
    found = _curvature(case, np.zeros((motion.states, 1)), gradient, bends)
    first = motion.sensitivities(*case.symbols)
    of_power = ca.Function("power", [*case.symbols], [motion.of_group(first, "power")[1]])

    def slope(coefficients):
        after = motion.simulate(coefficients, move, scale)[1]
        return of_power(coefficients, move, scale).full().T @ _full(_energy(motion)(after))[1]

    for i, unit in enumerate(np.eye(TERMS)):
        expected = (slope(a + h * unit) - slope(a - h * unit)).ravel() / (2 * h)
        assert found[i] == pytest.approx(expected, abs=1e-6 * np.abs(found).max())
