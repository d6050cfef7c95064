"""The nonlinear program for one task: what it minimises and keeps, in SI units."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ocp import CycloidPolynomial, PointToPoint, SolveStatus, resimulate, rollout
from ocp.plan.solver import _HIDDEN
from ocp.program import task_program as program_module
from ocp.program.solution import same_minimum
from ocp.program.task_program import TaskProgram
from ocp.program.transcription import RESIDUAL
from ocp.simulation.resimulation import resimulated
from ocp.task.point_to_point import LIMITS

STEPS, TERMS = 60, 6
START = np.zeros(TERMS)
PROFILE = CycloidPolynomial(TERMS)
AT_REST = {RESIDUAL: 0.0}
CVODES_NOISE = 1e-10
"""Residual [m] below which the independent integrator's own error counts."""
QUANTITIES = [limit.removesuffix("_limit") for limit in LIMITS]


@pytest.fixture(params=["single link", "arm", "two links"])
def task(request, tasks):
    return tasks[request.param]


@pytest.fixture(scope="module")
def programs():
    """The program of a task, compiled once."""

    @cache
    def of(task, steps=STEPS):
        return TaskProgram(task, PROFILE, steps)

    return of


def _limited(task, **limits):
    return PointToPoint(task.plant, task.target, task.duration, start=task.start, **limits)


def _with_all_limits(task):
    """The task with every quantity limited; what the limits are is said in each solve."""
    return _limited(task, **dict.fromkeys(LIMITS, 1.0))


def _simulated(task, solution, steps=STEPS):
    return rollout(task, PROFILE, solution.coefficients, steps=steps).motion


# -- figures --


def test_a_solutions_figures_are_those_of_the_rollout(task, programs):
    task = _with_all_limits(task)
    solution = programs(task).solve(START, {RESIDUAL: 2e-3}, None)
    fixed = rollout(task, PROFILE, solution.coefficients, steps=STEPS)
    assert solution.energy == pytest.approx(fixed.motion.energy, rel=1e-11)
    assert solution.arrival == pytest.approx(np.array(fixed.arrival), rel=1e-8, abs=1e-13)
    assert sorted(solution.peaks) == sorted([RESIDUAL, *QUANTITIES])
    for name, peak in solution.peaks.items():
        assert peak == pytest.approx(fixed.motion.peak(name), rel=1e-9)


def test_everything_is_measured_against_the_plain_cycloid(task, programs):
    plain = rollout(task, PROFILE, START, steps=STEPS)
    states, outputs, energy = programs(task).figures(START)
    assert np.abs(states).max(axis=1) == pytest.approx(np.ones(len(states)), rel=1e-12)
    assert np.abs(outputs[:3]).max() == pytest.approx(1.0, rel=1e-12)  # the power
    reference = programs(task).reference["energy"]
    assert energy * reference == pytest.approx(plain.motion.energy, rel=1e-12)
    assert np.abs(programs(task).matrix).max() == pytest.approx(1.0, rel=1e-12)  # the residual
    assert programs(task).of_cycloid == pytest.approx(plain.motion.residual, rel=1e-9)


# -- at rest --


def test_the_solution_arrives_at_rest_with_its_energy(task, programs):
    solution = programs(task).solve(START, AT_REST, None)
    assert solution.status is SolveStatus.OPTIMAL
    assert solution.settled
    motion = _simulated(task, solution)
    assert motion.residual < 1e-12
    assert solution.residual < 1e-12
    assert solution.slope == 0.0
    # The independent integrator finds the same motion a little off rest, and the same energy.
    verified = resimulate(task, PROFILE, solution.coefficients)
    assert verified.residual < 1e-8
    assert solution.energy == pytest.approx(verified.energy, rel=1e-6)


@pytest.mark.parametrize("steps", [24, 60])
@pytest.mark.parametrize("bound", [None, 0.3])
def test_a_corrected_solution_rests_by_the_other_integrator(task, programs, steps, bound):
    # Few steps miss the true state on arrival; what they miss is given back.
    program = programs(task, steps)
    found = program.solve(START, AT_REST, bound)
    motion, arrival = resimulated(task, PROFILE, found.coefficients)
    assert motion.residual > 1e-12
    corrected = program.corrected(found, arrival, AT_REST, bound)
    assert corrected.status is SolveStatus.OPTIMAL
    assert corrected.settled
    assert corrected.residual < 1e-12  # by what it was told
    verified = resimulate(task, PROFILE, corrected.coefficients)
    assert verified.residual < 1e-8
    assert verified.residual < max(1e-2 * motion.residual, CVODES_NOISE)
    # A residual as small as that was cannot have saved more than its price: the front is steep.
    assert verified.energy == pytest.approx(motion.energy, rel=1e-4)
    assert corrected.energy == pytest.approx(verified.energy, rel=1e-3)
    assert corrected.iterations >= found.iterations
    if bound is not None:
        assert np.abs(corrected.coefficients).max() <= bound * (1 + 1e-9)


def test_a_correction_tells_of_the_arrival_that_it_was_given(tasks, programs):
    program = programs(tasks["arm"])
    found = program.solve(START, AT_REST, None)
    missed = np.array([1e-5, -2e-4])  # W [m] and W' [m/s]
    corrected = program.corrected(found, found.arrival + missed, AT_REST, None)
    assert corrected.arrival == pytest.approx(np.zeros(2), abs=1e-12)
    arrival = rollout(tasks["arm"], PROFILE, corrected.coefficients, steps=STEPS).arrival
    assert np.array(arrival) == pytest.approx(-missed, rel=1e-6)


def test_a_correction_can_ask_for_tighter_limits(task, programs):
    program = programs(_with_all_limits(task))
    free = program.solve(START, {RESIDUAL: 2e-3}, None)
    limits = {RESIDUAL: 1.9e-3, "torque": 0.97 * free.peaks["torque"]}
    corrected = program.corrected(free, free.arrival, limits, None)
    assert corrected.status.solved
    for name, limit in limits.items():
        assert corrected.peaks[name] <= limit * (1 + 1e-6)
    cold = program.solve(START, limits, None)
    assert corrected.energy <= cold.energy * (1 + 1e-4)


# -- the residual --


@pytest.mark.parametrize("limit", [1e-4, 1e-3, 5e-3])
def test_a_residual_limit_is_met_exactly(task, programs, limit):
    solution = programs(task).solve(START, {RESIDUAL: limit}, None)
    assert solution.status is SolveStatus.OPTIMAL
    assert solution.peaks[RESIDUAL] <= limit * (1 + 1e-7)
    assert solution.peaks[RESIDUAL] == pytest.approx(limit, rel=1e-4)
    assert _simulated(task, solution).residual == pytest.approx(limit, rel=1e-4)


def test_a_free_residual_costs_least(task, programs):
    free = programs(task).solve(START, {}, None)
    limited = programs(task).solve(START, {RESIDUAL: 1e-3}, None)
    still = programs(task).solve(START, AT_REST, None)
    assert free.energy < limited.energy < still.energy
    assert free.slope == 0.0


@pytest.mark.parametrize("limit", [1e-3, 5e-3])
def test_the_slope_is_the_change_of_the_energy_with_the_limit(task, programs, limit):
    # The multiplier of the limit against a central difference of the least energy.
    program, change = programs(task), 4e-3 * limit
    below, at, above = (
        program.solve(START, {RESIDUAL: limit + d}, 0.5) for d in (-change, 0.0, change)
    )
    expected = (above.energy - below.energy) / (2 * change)
    assert at.slope < 0
    assert at.slope == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("name", ["arm", "two links"])
def test_a_weighted_sum_is_least_where_the_limits_multiplier_is_its_weight(tasks, programs, name):
    # Karush-Kuhn-Tucker: minimising energy + weight * residual meets the limit of that slope.
    program = programs(tasks[name])
    limited = program.solve(START, {RESIDUAL: 5e-3}, 0.5)
    weight = -limited.slope
    weighted = program.solve(START, {}, 0.5, minimise={"energy": 1.0, RESIDUAL: weight})
    assert weighted.peaks[RESIDUAL] == pytest.approx(5e-3, rel=1e-3)
    # Along the front one is paid for the other; their sum is what has a minimum.
    expected = limited.energy + weight * limited.residual
    assert weighted.energy + weight * weighted.residual == pytest.approx(expected, rel=1e-7)


def test_the_least_residual_of_one_term_is_that_of_a_scan(tasks):
    # One coefficient: every value of it in turn.
    task, profile = tasks["arm"], CycloidPolynomial(1)
    program = TaskProgram(task, profile, STEPS)
    found = program.solve(np.zeros(1), {}, None, minimise={RESIDUAL: 1.0})
    scan = [rollout(task, profile, [a], steps=STEPS).motion.residual for a in found.coefficients +
            np.linspace(-0.3, 0.3, 201)]  # fmt: skip
    assert found.peaks[RESIDUAL] == pytest.approx(min(scan), rel=1e-6)
    assert int(np.argmin(scan)) == 100


def test_the_least_residual_of_enough_terms_is_none(task, programs):
    least = programs(task).solve(START, {}, None, minimise={RESIDUAL: 1.0})
    assert least.status.solved
    assert least.residual < 1e-6 * _simulated(task, replace(least, coefficients=START)).residual


# -- peaks --


@pytest.mark.parametrize("name", QUANTITIES)
def test_a_peak_can_be_minimised(task, programs, name):
    task = _with_all_limits(task)
    program = programs(task)
    cheapest = program.solve(START, AT_REST, None)
    least = program.solve(cheapest.coefficients, AT_REST, None, minimise={name: 1.0})
    assert least.status.solved
    assert least.peaks[name] == pytest.approx(_simulated(task, least).peak(name), rel=1e-9)
    assert least.peaks[name] < 0.99 * cheapest.peaks[name]
    assert least.energy > cheapest.energy
    assert _simulated(task, least).residual < 1e-8


@pytest.mark.parametrize("name", QUANTITIES)
def test_a_limit_on_a_peak_is_kept_and_costs_energy(task, programs, name):
    program = programs(_with_all_limits(task))
    cheapest = program.solve(START, AT_REST, None)
    limit = 0.97 * cheapest.peaks[name]
    limited = program.solve(START, {**AT_REST, name: limit}, None)
    assert limited.status is SolveStatus.OPTIMAL
    assert limited.peaks[name] <= limit * (1 + 1e-7)
    assert limited.peaks[name] == pytest.approx(limit, rel=1e-5)
    assert limited.residual < 1e-12
    assert limited.energy > cheapest.energy


@pytest.mark.parametrize("name", ["torque", "acceleration"])
def test_energy_and_a_peak_are_weighed(task, programs, name):
    # Less of the peak than the cheapest motion, less energy than that of the least peak.
    program = programs(_with_all_limits(task))
    cheapest = program.solve(START, AT_REST, None)
    weight = 0.2 * cheapest.energy / cheapest.peaks[name]
    both = program.solve(START, AT_REST, None, minimise={"energy": 1.0, name: weight})
    assert both.status.solved
    total = [found.energy + weight * found.peaks[name] for found in (both, cheapest)]
    assert total[0] < total[1]
    assert both.energy >= cheapest.energy * (1 - 1e-6)
    limited = program.solve(START, {**AT_REST, name: both.peaks[name]}, None)
    # Where the minimum of the resolved energy is not reached, the sampled one stands.
    assert limited.energy >= both.energy * (1 - (1e-5 if both.settled else _HIDDEN))


# -- the box --


def test_a_bound_is_kept(task, programs):
    program = programs(task)
    free = program.solve(START, {RESIDUAL: 2e-2}, None)
    bound = 0.9 * np.abs(free.coefficients).max()
    boxed = program.solve(START, {RESIDUAL: 2e-2}, bound)
    assert boxed.status.solved
    assert np.abs(boxed.coefficients).max() == pytest.approx(bound, rel=1e-6)
    assert boxed.energy > free.energy


def test_a_box_that_is_not_in_the_way_changes_nothing(task, programs):
    # With a box the solver works along the coefficients, without one along even axes.
    free = programs(task).solve(START, {RESIDUAL: 5e-3}, None)
    boxed = programs(task).solve(START, {RESIDUAL: 5e-3}, 100.0)
    assert boxed.energy == pytest.approx(free.energy, rel=1e-6)
    assert boxed.coefficients == pytest.approx(free.coefficients, abs=1e-3)


def test_a_limit_that_cannot_be_met_is_infeasible(tasks):
    task = _limited(tasks["arm"], torque_limit=0.05)
    program = TaskProgram(task, PROFILE, STEPS)
    solution = program.solve(START, {**AT_REST, "torque": 0.05}, None)
    assert solution.status is SolveStatus.INFEASIBLE


def test_numbers_of_any_size_are_scaled(tasks):
    # A plant a million times as heavy: a million times the energy, in as good a solution.
    plant = tasks["arm"].plant
    heavy = type(plant)(**{
        **plant.parameters,
        **{name: 1e6 * plant.parameters[name] for name in ("beta1", "beta2", "beta3", "c")},
    })  # fmt: skip
    light = TaskProgram(tasks["arm"], PROFILE, STEPS)
    task = PointToPoint(heavy, math.pi / 2, 0.8)
    same = TaskProgram(task, PROFILE, STEPS)
    expected, found = (program.solve(START, AT_REST, None) for program in (light, same))
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
        program = TaskProgram(task, PROFILE, STEPS)
        found.append(program.solve(START, {RESIDUAL: 1e-3}, 0.2))
    assert found[1].status is SolveStatus.OPTIMAL
    assert found[1].energy == pytest.approx(found[0].energy, rel=1e-6)
    assert found[1].coefficients == pytest.approx(found[0].coefficients, abs=1e-5)


def test_programs_of_like_tasks_are_compiled_once(plants):
    # Start, target and duration are parameters; the residual's rows differ by a few at most.
    one = TaskProgram(PointToPoint(plants["arm"], 1.0, 0.8), PROFILE, STEPS)
    other = TaskProgram(PointToPoint(plants["arm"], 2.0, 1.3), PROFILE, STEPS)
    before = program_module._compiled.cache_info()
    one.solve(START, AT_REST, 0.5)
    between = program_module._compiled.cache_info()
    other.solve(START, AT_REST, 0.5)
    after = program_module._compiled.cache_info()
    assert one.motion is other.motion
    assert between.hits + between.misses > before.hits + before.misses
    assert after.misses == between.misses


# -- from one solution to the next --


@pytest.mark.parametrize("limit", [1e-4, 1e-3, 5e-3])
def test_a_warm_start_finds_what_a_cold_one_finds_sooner(task, programs, limit):
    program = programs(task)
    beside = program.solve(START, {RESIDUAL: 1.04 * limit}, 0.5)
    cold = program.solve(START, {RESIDUAL: limit}, 0.5)
    warm = program.solve(beside, {RESIDUAL: limit}, 0.5)
    assert warm.status is SolveStatus.OPTIMAL
    assert warm.energy == pytest.approx(cold.energy, rel=1e-8)
    assert warm.coefficients == pytest.approx(cold.coefficients, abs=1e-6)
    assert warm.slope == pytest.approx(cold.slope, rel=1e-2)
    assert warm.iterations < cold.iterations


def test_a_solution_of_another_form_gives_its_coefficients(tasks, programs):
    # Neither its unknowns nor its multipliers fit: rest has no rows of the residual.
    program = programs(tasks["arm"])
    still = program.solve(START, AT_REST, 0.5)
    limited = program.solve(still, {RESIDUAL: 5e-3}, 0.5)
    same = program.solve(still.coefficients, {RESIDUAL: 5e-3}, 0.5)
    assert limited.coefficients.tolist() == same.coefficients.tolist()
    assert limited.energy < still.energy


def test_the_same_solve_gives_the_same_solution(tasks, programs):
    program = programs(tasks["two links"])
    first, again = (program.solve(START, {RESIDUAL: 2e-3}, 0.5) for _ in range(2))
    assert first.coefficients.tolist() == again.coefficients.tolist()
    assert first.energy == again.energy


def test_a_start_that_leads_to_a_known_solution_gives_that(tasks, programs):
    program = programs(tasks["arm"])
    known = program.solve(START, AT_REST, 0.5)
    again = program.solve(0.05 * np.ones(TERMS), AT_REST, 0.5, known=known)
    assert again.coefficients is known.coefficients
    other = program.solve(START, {RESIDUAL: 5e-3}, 0.5, known=known)
    assert other.coefficients is not known.coefficients
    assert same_minimum(known, replace(known, coefficients=START))  # by where the solver stopped
    assert not same_minimum(known, other)
