"""The nonlinear program for one task: what it minimises and keeps, in SI units."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ocp import CycloidPolynomial, PointToPoint, SolveStatus, rollout
from ocp.program import TaskProgram
from ocp.transcription import RESIDUAL

STEPS, TERMS = 60, 6
START = np.zeros(TERMS)
PROFILE = CycloidPolynomial(TERMS)


@pytest.fixture(params=["single link", "arm", "two links"])
def task(request, tasks):
    return tasks[request.param]


def _limited(task, **limits):
    return PointToPoint(task.plant, task.target, task.duration, start=task.start, **limits)


def _simulated(task, solution):
    return rollout(task, PROFILE, solution.coefficients, steps=STEPS).motion


def test_the_solution_arrives_at_rest_with_its_energy(task):
    solution = TaskProgram(task, PROFILE, STEPS, with_residual=False).solve(START, {}, None)
    assert solution.status is SolveStatus.OPTIMAL
    motion = _simulated(task, solution)
    assert motion.residual < 1e-8
    # The program sums |power| at the nodes; the rollout resolves its sign changes too.
    assert solution.energy == pytest.approx(motion.energy, rel=1e-3)
    assert solution.peaks == {}


def test_a_residual_limit_is_met_exactly(task):
    program = TaskProgram(task, PROFILE, STEPS, with_residual=True)
    solution = program.solve(START, {RESIDUAL: 5e-3}, None)
    assert solution.peaks[RESIDUAL] == pytest.approx(5e-3, rel=1e-6)
    assert _simulated(task, solution).residual == pytest.approx(5e-3, rel=1e-5)


def test_a_free_residual_costs_least(task):
    program = TaskProgram(task, PROFILE, STEPS, with_residual=True)
    free = program.solve(START, {}, None)
    limited = program.solve(START, {RESIDUAL: 1e-3}, None)
    assert free.energy < limited.energy


@pytest.mark.parametrize("name", ["torque", "speed", "acceleration", "deflection"])
def test_a_peak_can_be_minimised(task, name):
    limited = _limited(task, **{f"{name}_limit": 1.0})
    program = TaskProgram(limited, PROFILE, STEPS, with_residual=False)
    cheapest = program.solve(START, {}, None)
    least = program.solve(START, {}, None, minimise={name: 1.0})
    assert least.status.solved
    assert least.peaks[name] == pytest.approx(_simulated(task, least).peak(name), rel=1e-6)
    assert least.peaks[name] < 0.99 * _simulated(task, cheapest).peak(name)
    assert least.energy > cheapest.energy
    assert _simulated(task, least).residual < 1e-8


def test_the_least_residual_of_one_term_is_that_of_a_scan(tasks):
    # One coefficient: every value of it in turn.
    task, profile = tasks["arm"], CycloidPolynomial(1)
    program = TaskProgram(task, profile, STEPS, with_residual=True)
    found = program.solve(np.zeros(1), {}, None, minimise={RESIDUAL: 1.0})
    scan = [rollout(task, profile, [a], steps=STEPS).motion.residual for a in found.coefficients +
            np.linspace(-0.3, 0.3, 201)]  # fmt: skip
    assert found.peaks[RESIDUAL] == pytest.approx(min(scan), rel=1e-6)
    assert int(np.argmin(scan)) == 100


def test_a_bound_is_kept(task):
    program = TaskProgram(task, PROFILE, STEPS, with_residual=True)
    free = program.solve(START, {RESIDUAL: 2e-2}, None)
    bound = 0.9 * np.abs(free.coefficients).max()
    boxed = program.solve(START, {RESIDUAL: 2e-2}, bound)
    assert boxed.status.solved
    assert np.abs(boxed.coefficients).max() == pytest.approx(bound, rel=1e-6)
    assert boxed.energy > free.energy


def test_a_limit_that_cannot_be_met_is_infeasible(tasks):
    task = _limited(tasks["arm"], torque_limit=0.05)
    program = TaskProgram(task, PROFILE, STEPS, with_residual=False)
    solution = program.solve(START, {"torque": 0.05}, None)
    assert solution.status is SolveStatus.INFEASIBLE


def test_numbers_of_any_size_are_scaled(tasks):
    # A plant a million times as heavy: a million times the energy, in as good a solution.
    plant = tasks["arm"].plant
    heavy = type(plant)(**{
        **plant.parameters,
        **{name: 1e6 * plant.parameters[name] for name in ("beta1", "beta2", "beta3", "c")},
    })  # fmt: skip
    light = TaskProgram(tasks["arm"], PROFILE, STEPS, with_residual=False)
    task = PointToPoint(heavy, math.pi / 2, 0.8)
    same = TaskProgram(task, PROFILE, STEPS, with_residual=False)
    expected, found = (program.solve(START, {}, None) for program in (light, same))
    assert found.energy == pytest.approx(1e6 * expected.energy, rel=1e-6)
    assert found.coefficients == pytest.approx(expected.coefficients, abs=1e-5)


def test_the_unit_of_the_modes_does_not_matter(plants):
    # W in micrometres: beta1 a million times as large, alpha2 and phi as small.
    metres = plants["single link"]
    microns = replace(
        metres, beta1=1e6 * metres.beta1, alpha2=1e-6 * metres.alpha2, phi=1e-6 * metres.phi
    )
    found = []
    for plant in (metres, microns):
        task = PointToPoint(plant, math.pi / 6, 0.8)
        program = TaskProgram(task, PROFILE, STEPS, with_residual=True)
        found.append(program.solve(START, {RESIDUAL: 1e-3}, 0.2))
    assert found[1].status is SolveStatus.OPTIMAL
    assert found[1].energy == pytest.approx(found[0].energy, rel=1e-6)
    assert found[1].coefficients == pytest.approx(found[0].coefficients, abs=1e-5)


def test_programs_of_like_tasks_are_compiled_once(plants):
    # Start, target and duration are parameters.
    one = TaskProgram(PointToPoint(plants["arm"], 1.0, 0.8), PROFILE, STEPS, with_residual=False)
    other = TaskProgram(PointToPoint(plants["arm"], 2.0, 1.3), PROFILE, STEPS, with_residual=False)
    assert one.program is other.program


def test_a_warm_start_finds_what_a_cold_one_finds(tasks):
    program = TaskProgram(tasks["arm"], PROFILE, STEPS, with_residual=True)
    beside = program.solve(START, {RESIDUAL: 5.2e-3}, 0.5)
    cold = program.solve(START, {RESIDUAL: 5e-3}, 0.5)
    warm = program.solve(beside, {RESIDUAL: 5e-3}, 0.5)
    assert warm.status.solved
    assert warm.energy == pytest.approx(cold.energy, rel=1e-6)
    assert warm.coefficients == pytest.approx(cold.coefficients, abs=1e-3)


def test_the_slope_is_the_change_of_the_energy_with_the_limit(tasks):
    # The multiplier of the limit against a central difference of the least energy.
    program = TaskProgram(tasks["arm"], PROFILE, STEPS, with_residual=True)
    below, at, above = (
        program.solve(START, {RESIDUAL: 5e-3 + change}, 0.5) for change in (-2e-5, 0.0, 2e-5)
    )
    assert at.slope == pytest.approx((above.energy - below.energy) / 4e-5, rel=1e-3)
    assert program.solve(START, {}, 0.5).slope == 0.0


def test_a_weighted_sum_is_least_where_the_limits_multiplier_is_its_weight(tasks):
    # Karush-Kuhn-Tucker: minimising energy + weight * residual meets the limit of that slope.
    program = TaskProgram(tasks["arm"], PROFILE, STEPS, with_residual=True)
    limited = program.solve(START, {RESIDUAL: 5e-3}, 0.5)
    weighted = program.solve(START, {}, 0.5, minimise={"energy": 1.0, RESIDUAL: -limited.slope})
    assert weighted.energy == pytest.approx(limited.energy, rel=1e-5)
    assert weighted.peaks[RESIDUAL] == pytest.approx(5e-3, rel=1e-3)
