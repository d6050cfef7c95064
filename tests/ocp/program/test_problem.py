"""A problem: what it minimises and keeps, in SI units."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ocp import CycloidPolynomial, PointToPoint, SolveStatus, resimulate, rollout
from ocp.plan.solver import _HIDDEN
from ocp.program import run
from ocp.program.transcription import RESIDUAL
from ocp.simulation.piecewise import PiecewiseMotion
from ocp.simulation.resimulation import resimulated
from ocp.task.point_to_point import LIMITS

STEPS, TERMS = 60, 6
START = np.zeros(TERMS)
PROFILE = CycloidPolynomial(TERMS)
AT_REST = {RESIDUAL: 0.0}
CVODES_NOISE = 1e-10
"""Residual [m] below which the independent integrator's own error counts."""


QUANTITIES = [limit.removesuffix("_limit") for limit in LIMITS]


def _limited(task, **limits):
    return PointToPoint(task.plant, task.target, task.duration, start=task.start, **limits)


def _with_all_limits(task):
    """The task with every quantity limited; what the limits are is said in each solve."""
    return _limited(task, **dict.fromkeys(LIMITS, 1.0))


def _simulated(task, solution, steps=STEPS):
    return rollout(task, PROFILE, solution.coefficients, steps=steps).motion


@pytest.fixture(scope="module")
def cheapest_of(problem):
    """The cheapest motion of a task that arrives at rest, solved once."""
    return cache(lambda task: problem(task, AT_REST).solve(START))


# -- figures --


def test_a_solutions_figures_are_those_of_the_rollout(problem, task):
    task = _with_all_limits(task)
    solution = problem(task, {RESIDUAL: 2e-3}).solve(START)
    fixed = rollout(task, PROFILE, solution.coefficients, steps=STEPS)
    # The energy alone leaves out what neighbouring steps tell: 6e-6 of it at 60 steps.
    assert solution.energy == pytest.approx(fixed.motion.energy, rel=2e-5)
    assert solution.arrival == pytest.approx(np.array(fixed.arrival), rel=1e-8, abs=1e-13)
    assert sorted(solution.peaks) == sorted([RESIDUAL, *QUANTITIES])
    for name, peak in solution.peaks.items():
        assert peak == pytest.approx(fixed.motion.peak(name), rel=1e-9)


# -- at rest --


def test_the_solution_arrives_at_rest_with_its_energy(problem, task):
    solution = problem(task, AT_REST).solve(START)
    assert solution.status is SolveStatus.OPTIMAL
    assert solution.settled
    motion = _simulated(task, solution)
    assert motion.residual < 1e-11  # IPOPT's tolerance of the constraints; 4.4e-12 seen
    assert solution.residual < 1e-11
    assert solution.slope == 0.0
    # The independent integrator finds the same motion a little off rest, and the same energy but
    # for what neighbouring steps tell of it: 2e-6.
    verified = resimulate(task, PROFILE, solution.coefficients)
    assert verified.residual < 1e-8
    assert solution.energy == pytest.approx(verified.energy, rel=5e-6)


@pytest.mark.parametrize(("steps", "bound"), [(24, 0.3), (60, None)])
def test_a_corrected_solution_rests_by_the_other_integrator(problem, task, steps, bound):
    # Few steps miss the true state on arrival; what they miss is given back.
    asked = problem(task, AT_REST, bound, steps=steps)
    found = asked.solve(START)
    first = resimulated(task, PiecewiseMotion.of_profile(task, PROFILE, found.coefficients))
    motion = first.motion
    assert motion.residual > 1e-12
    corrected = asked.corrected(found, first.arrival)
    assert corrected.status is SolveStatus.OPTIMAL
    assert corrected.settled
    # By what it was told: IPOPT keeps scaled constraints to 1e-10, here 5e-12 m at most.
    assert corrected.residual < 1e-11
    verified = resimulate(task, PROFILE, corrected.coefficients)
    assert verified.residual < 1e-8
    assert verified.residual < max(1e-2 * motion.residual, CVODES_NOISE)
    # A residual as small as that was cannot have saved more than its price: the front is steep.
    assert verified.energy == pytest.approx(motion.energy, rel=1e-4)
    assert corrected.energy == pytest.approx(verified.energy, rel=1e-3)
    assert corrected.iterations >= found.iterations
    if bound is not None:
        assert np.abs(corrected.coefficients).max() <= bound * (1 + 1e-9)


def test_a_correction_tells_of_the_arrival_that_it_was_given(problem, tasks):
    task = tasks["arm"]
    asked = problem(task, AT_REST)
    found = asked.solve(START)
    missed = np.array([1e-5, -2e-4])  # W [m] and W' [m/s]
    corrected = asked.corrected(found, found.arrival + missed)
    assert corrected.arrival == pytest.approx(np.zeros(2), abs=1e-12)
    arrival = rollout(tasks["arm"], PROFILE, corrected.coefficients, steps=STEPS).arrival
    assert np.array(arrival) == pytest.approx(-missed, rel=1e-6)


def test_a_correction_can_ask_for_tighter_limits(problem, task):
    task = _with_all_limits(task)
    free = problem(task, {RESIDUAL: 2e-3}).solve(START)
    limits = {RESIDUAL: 1.9e-3, "torque": 0.97 * free.peaks["torque"]}
    corrected = problem(task, limits).corrected(free, free.arrival)
    assert corrected.status.solved
    for name, limit in limits.items():
        assert corrected.peaks[name] <= limit * (1 + 1e-6)
    cold = problem(task, limits).solve(START)
    assert corrected.energy <= cold.energy * (1 + 1e-4)


# -- the residual --


@pytest.mark.parametrize("limit", [1e-4, 5e-3])
def test_a_residual_limit_is_met_exactly(problem, task, limit):
    solution = problem(task, {RESIDUAL: limit}).solve(START)
    assert solution.status is SolveStatus.OPTIMAL
    assert solution.peaks[RESIDUAL] <= limit * (1 + 1e-7)
    assert solution.peaks[RESIDUAL] == pytest.approx(limit, rel=1e-4)
    assert _simulated(task, solution).residual == pytest.approx(limit, rel=1e-4)


def test_a_free_residual_costs_least(problem, task):
    free = problem(task, {}).solve(START)
    limited = problem(task, {RESIDUAL: 1e-3}).solve(START)
    still = problem(task, AT_REST).solve(START)
    assert free.energy < limited.energy < still.energy
    assert abs(free.slope) < 1e-20  # IPOPT leaves some 1e-29 where there is no limit


def test_the_slope_is_the_change_of_the_energy_with_the_limit(problem, task):
    # The multiplier of the limit against a central difference of the least energy.
    limit = 5e-3
    change = 4e-3 * limit
    below, at, above = (
        problem(task, {RESIDUAL: limit + d}, 0.5).solve(START) for d in (-change, 0.0, change)
    )
    expected = (above.energy - below.energy) / (2 * change)
    assert at.slope < 0
    assert at.slope == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("name", ["arm", "two links"])
def test_a_weighted_sum_is_least_where_the_limits_multiplier_is_its_weight(problem, tasks, name):
    # Karush-Kuhn-Tucker: minimising energy + weight * residual meets the limit of that slope.
    task = tasks[name]
    limited = problem(task, {RESIDUAL: 5e-3}, 0.5).solve(START)
    weight = -limited.slope
    weighted = problem(task, {}, 0.5).solve(START, {"energy": 1.0, RESIDUAL: weight})
    assert weighted.peaks[RESIDUAL] == pytest.approx(5e-3, rel=1e-3)
    # Along the front one is paid for the other; their sum is what has a minimum.
    expected = limited.energy + weight * limited.residual
    assert weighted.energy + weight * weighted.residual == pytest.approx(expected, rel=1e-7)


def test_the_least_residual_of_one_term_is_that_of_a_scan(problem, tasks):
    # One coefficient: every value of it in turn.
    task, profile = tasks["arm"], CycloidPolynomial(1)
    found = problem(task, {}, terms=1).solve(np.zeros(1), {RESIDUAL: 1.0})
    scan = [rollout(task, profile, [a], steps=STEPS).motion.residual for a in found.coefficients +
            np.linspace(-0.3, 0.3, 61)]  # fmt: skip
    assert found.peaks[RESIDUAL] == pytest.approx(min(scan), rel=1e-6)
    assert int(np.argmin(scan)) == 30


def test_the_least_residual_of_enough_terms_is_none(problem, task):
    least = problem(task, {}).solve(START, {RESIDUAL: 1.0})
    assert least.status.solved
    assert least.residual < 1e-6 * _simulated(task, replace(least, coefficients=START)).residual


# -- peaks --

# Every quantity with two modes and with one: of the plants of one mode, each takes its share.
of_every_peak = pytest.mark.parametrize(
    ("plant", "name"),
    [
        *(("two links", name) for name in QUANTITIES),
        *(("arm" if i % 2 else "single link", name) for i, name in enumerate(QUANTITIES)),
    ],
)


@of_every_peak
def test_a_peak_can_be_minimised(problem, cheapest_of, tasks, plant, name):
    task = _with_all_limits(tasks[plant])
    cheapest = cheapest_of(task)
    least = problem(task, AT_REST).solve(cheapest.coefficients, {name: 1.0})
    assert least.status.solved
    assert least.peaks[name] == pytest.approx(_simulated(task, least).peak(name), rel=1e-9)
    assert least.peaks[name] < 0.99 * cheapest.peaks[name]
    assert least.energy > cheapest.energy
    assert _simulated(task, least).residual < 1e-8


@of_every_peak
def test_a_limit_on_a_peak_is_kept_and_costs_energy(problem, cheapest_of, tasks, plant, name):
    task = _with_all_limits(tasks[plant])
    cheapest = cheapest_of(task)
    limit = 0.97 * cheapest.peaks[name]
    limited = problem(task, {**AT_REST, name: limit}).solve(START)
    assert limited.status is SolveStatus.OPTIMAL
    assert limited.peaks[name] <= limit * (1 + 1e-7)
    assert limited.peaks[name] == pytest.approx(limit, rel=1e-5)
    assert limited.residual < 1e-12
    assert limited.energy > cheapest.energy


# The second is not settled.
@pytest.mark.parametrize(("plant", "name"), [("two links", "torque"), ("arm", "acceleration")])
def test_energy_and_a_peak_are_weighed(problem, cheapest_of, tasks, plant, name):
    # Less of the peak than the cheapest motion, less energy than that of the least peak.
    task = _with_all_limits(tasks[plant])
    cheapest = cheapest_of(task)
    weight = 0.2 * cheapest.energy / cheapest.peaks[name]
    both = problem(task, AT_REST).solve(START, {"energy": 1.0, name: weight})
    assert both.status.solved
    total = [found.energy + weight * found.peaks[name] for found in (both, cheapest)]
    assert total[0] < total[1]
    assert both.energy >= cheapest.energy * (1 - 1e-6)
    limited = problem(task, {**AT_REST, name: both.peaks[name]}).solve(START)
    # Where the minimum of the resolved energy is not reached, the sampled one stands.
    assert limited.energy >= both.energy * (1 - (1e-5 if both.settled else _HIDDEN))


# -- the box --


def test_a_bound_is_kept(problem, task):
    free = problem(task, {RESIDUAL: 2e-2}).solve(START)
    bound = 0.9 * np.abs(free.coefficients).max()
    boxed = problem(task, {RESIDUAL: 2e-2}, bound).solve(START)
    assert boxed.status.solved
    # The barrier keeps it 1e-6 off.
    assert np.abs(boxed.coefficients).max() == pytest.approx(bound, rel=2e-6)
    assert boxed.energy > free.energy


def test_a_box_that_is_not_in_the_way_changes_nothing(problem, task):
    # With a box the solver works along the coefficients, without one along even axes.
    free = problem(task, {RESIDUAL: 5e-3}).solve(START)
    boxed = problem(task, {RESIDUAL: 5e-3}, 100.0).solve(START)
    assert boxed.energy == pytest.approx(free.energy, rel=1e-6)
    assert boxed.coefficients == pytest.approx(free.coefficients, abs=1e-3)


def test_a_limit_that_cannot_be_met_is_infeasible(problem, tasks):
    task = _limited(tasks["arm"], torque_limit=0.05)
    solution = problem(task, {**AT_REST, "torque": 0.05}).solve(START)
    assert solution.status is SolveStatus.INFEASIBLE


def test_numbers_of_any_size_are_scaled(problem, tasks):
    # A plant a million times as heavy: a million times the energy, in as good a solution.
    plant = tasks["arm"].plant
    heavy = type(plant)(**{
        **plant.parameters,
        **{name: 1e6 * plant.parameters[name] for name in ("beta1", "beta2", "beta3", "c")},
    })  # fmt: skip
    tasks = tasks["arm"], PointToPoint(heavy, math.pi / 2, 0.8)
    expected, found = (problem(task, AT_REST).solve(START) for task in tasks)
    assert found.energy == pytest.approx(1e6 * expected.energy, rel=1e-6)
    assert found.coefficients == pytest.approx(expected.coefficients, abs=1e-5)


def test_the_unit_of_the_modes_does_not_matter(problem, plants):
    # W in micrometres: beta1 a million times as large, alpha2 and phi as small.
    metres = plants["single link"]
    microns = replace(
        metres, beta1=1e6 * metres.beta1, alpha2=1e-6 * metres.alpha2, phi=1e-6 * metres.phi
    )
    found = []
    for plant in (metres, microns):
        task = PointToPoint(plant, math.pi / 6, 0.8)
        found.append(problem(task, {RESIDUAL: 1e-3}, 0.2).solve(START))
    assert found[1].status is SolveStatus.OPTIMAL
    assert found[1].energy == pytest.approx(found[0].energy, rel=1e-6)
    assert found[1].coefficients == pytest.approx(found[0].coefficients, abs=1e-5)


def test_programs_of_like_tasks_are_compiled_once(problem, plants):
    # Start, target and duration are parameters; the residual's rows differ by a few at most.
    one = problem(PointToPoint(plants["arm"], 1.0, 0.8), AT_REST, 0.5)
    other = problem(PointToPoint(plants["arm"], 2.0, 1.3), AT_REST, 0.5)
    before = run._compiled.cache_info()
    one.solve(START)
    between = run._compiled.cache_info()
    other.solve(START)
    after = run._compiled.cache_info()
    assert one.program.motion is other.program.motion
    assert between.hits + between.misses > before.hits + before.misses
    assert after.hits > between.hits
    assert after.misses == between.misses
