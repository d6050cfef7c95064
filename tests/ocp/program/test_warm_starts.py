"""A problem goes on from a solution: of a neighbour, with finer steps, of another form."""

from dataclasses import replace

import numpy as np
import pytest

from ocp import SolveStatus
from ocp.program.solution import same_minimum
from ocp.program.transcription import RESIDUAL

STEPS, TERMS = 60, 6
START = np.zeros(TERMS)
AT_REST = {RESIDUAL: 0.0}


# -- from one solution to the next --


def test_a_solve_from_a_neighbour_finds_what_a_cold_one_finds_sooner(problem, task):
    iterations = np.zeros(2, dtype=int)
    for limit in (1e-4, 1e-3, 5e-3):
        asked = problem(task, {RESIDUAL: limit}, 0.5)
        beside = asked.within({RESIDUAL: 1.04 * limit}).solve(START)
        cold, warm = asked.solve(START), asked.solve(beside)
        assert warm.status is SolveStatus.OPTIMAL
        assert warm.settled
        assert warm.form == cold.form
        # The barrier that is left is a share of 1e-7 of the energy; along some directions the
        # energy is that flat.
        assert warm.energy == pytest.approx(cold.energy, rel=1e-7)
        assert warm.coefficients == pytest.approx(cold.coefficients, abs=1e-4)
        assert warm.slope == pytest.approx(cold.slope, rel=1e-2)
        iterations += warm.iterations, cold.iterations
    # One of the nine finds no minimum beside its neighbour's and starts from its coefficients.
    assert iterations[0] < 0.8 * iterations[1]


def test_a_solve_from_its_own_solution_stays_there(problem, task):
    asked = problem(task, {RESIDUAL: 1e-3}, 0.5)
    found = asked.solve(START)
    again = asked.solve(found)
    assert again.energy == pytest.approx(found.energy, rel=1e-8)
    assert again.iterations < 10  # those of the first are not counted again


@pytest.mark.parametrize("bound", [None, 0.3])
def test_refining_finds_what_a_cold_solve_finds_with_the_finer_steps(problem, task, bound):
    coarse = problem(task, AT_REST, bound, steps=40)
    finer = coarse.finer()
    assert finer.program.steps == 80
    assert (finer.limits, finer.bound) == (coarse.limits, coarse.bound)
    found = coarse.solve(START)
    cold, refined = finer.solve(START), finer.refined(found)
    assert refined.settled
    assert refined.form == cold.form
    assert refined.energy == pytest.approx(cold.energy, rel=1e-7)
    assert refined.coefficients == pytest.approx(cold.coefficients, abs=1e-4)
    assert refined.iterations < found.iterations + cold.iterations


def test_refining_a_limited_motion_finds_what_a_cold_solve_finds(problem, task):
    # Limits hold at other nodes then: it starts from the coefficients.
    task = replace(task, torque_limit=1.0)
    free = problem(task, AT_REST, steps=40).solve(START)
    limits = {**AT_REST, "torque": 0.97 * free.peaks["torque"]}
    coarse = problem(task, limits, steps=40)
    refined, cold = coarse.finer().refined(coarse.solve(START)), coarse.finer().solve(START)
    assert refined.status.solved
    assert refined.peaks["torque"] <= limits["torque"] * (1 + 1e-7)
    assert refined.energy == pytest.approx(cold.energy, rel=1e-6)


def test_a_solution_of_another_form_gives_its_coefficients(problem, tasks):
    # Neither its unknowns nor its multipliers fit: rest has no rows of the residual.
    task = tasks["arm"]
    still = problem(task, AT_REST, 0.5).solve(START)
    limited = problem(task, {RESIDUAL: 5e-3}, 0.5).solve(still)
    same = problem(task, {RESIDUAL: 5e-3}, 0.5).solve(still.coefficients)
    assert limited.coefficients.tolist() == same.coefficients.tolist()
    assert limited.energy < still.energy


def test_the_same_solve_gives_the_same_solution(problem, tasks):
    task = tasks["arm"]
    first, again = (problem(task, {RESIDUAL: 2e-3}, 0.5).solve(START) for _ in range(2))
    assert first.coefficients.tolist() == again.coefficients.tolist()
    assert first.energy == again.energy


def test_two_starts_end_at_the_same_minimum_and_another_limit_at_another(problem, tasks):
    asked = problem(tasks["arm"], AT_REST, 0.5)
    one, other = (asked.solve(a, finish=False) for a in (START, 0.05 * np.ones(TERMS)))
    assert same_minimum(one, other)
    assert same_minimum(one, replace(one, coefficients=START))  # by where the solver stopped
    assert not same_minimum(one, asked.finished(one))  # by another program
    limits = [asked.within({RESIDUAL: limit}) for limit in (1e-3, 5e-3)]
    assert not same_minimum(*(there.solve(START, finish=False) for there in limits))
