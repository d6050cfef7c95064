"""Cold runs without a box: no farther than a reach at first, to the minimum of a wide box."""

from dataclasses import replace

import numpy as np
import pytest

from ocp import CycloidNetwork, CycloidSpline, UncertainPlant
from ocp.base.status import SolveStatus
from ocp.program import run
from ocp.program.ipopt import Point, Stop
from ocp.program.problem import Problem
from ocp.program.run import Run
from ocp.program.solution import LEAST_ENERGY
from ocp.program.task_program import TaskProgram
from ocp.program.transcription import RESIDUAL, NonlinearProgram
from ocp.robustness.measures import tolerated_residual

AT_REST = {RESIDUAL: 0.0}


@pytest.fixture
def reaches(monkeypatch):
    """How far each run of the solver might move the coefficients' unknowns, in turn."""
    seen, solve = [], NonlinearProgram.solve

    def recorded(self, start, bounds, *others):
        lower, upper = (side[self.part("coefficients")] for side in bounds)
        seen.append((self.form.energy, float(np.max(upper - lower)) / 2))
        return solve(self, start, bounds, *others)

    monkeypatch.setattr(NonlinearProgram, "solve", recorded)
    return seen


@pytest.mark.parametrize(
    ("name", "limits", "terms"),
    [
        ("single link", AT_REST, 6),
        ("two links", {RESIDUAL: 5e-3}, 10),
        ("arm", {RESIDUAL: 5e-3}, 16),
        ("single link", {RESIDUAL: 5e-3}, 16),
    ],
)
def test_without_a_box_it_reaches_what_it_reaches_in_a_wide_one(
    problem, tasks, name, limits, terms
):
    # In the box the solver works along the coefficients, without it along even axes.
    free, boxed = (
        problem(tasks[name], limits, bound, terms=terms, steps=80).solve(np.zeros(terms))
        for bound in (None, 1e4)
    )
    assert free.status.solved
    if free.settled:
        # Not above it by more than 1e-6; in the box some end too high, by 3.1e-4 at most.
        assert free.energy <= boxed.energy * (1 + 1e-6)
        assert free.energy == pytest.approx(boxed.energy, rel=5e-4)
    else:  # the last: the sampled minimum stands, 4.3e-3 above
        assert free.energy == pytest.approx(boxed.energy, rel=5e-3)


def test_a_cold_run_without_a_box_goes_no_farther_than_its_reach_at_first(problem, task, reaches):
    found = problem(task, AT_REST).solve(np.zeros(6), finish=False)
    assert found.status.solved
    assert reaches == [("sampled", pytest.approx(run._FIRST_REACH))]


def test_where_the_reach_is_in_the_way_it_runs_again_without(problem, task, reaches, monkeypatch):
    expected = problem(task, AT_REST).solve(np.zeros(6), finish=False)
    monkeypatch.setattr(run, "_FIRST_REACH", 1e-3)
    reaches.clear()
    found = problem(task, AT_REST).solve(np.zeros(6), finish=False)
    assert [reach for _, reach in reaches] == [pytest.approx(1e-3), np.inf]
    assert found.energy == pytest.approx(expected.energy, rel=1e-4)
    assert found.iterations > expected.iterations  # those of both runs


def test_a_box_is_all_the_reach_there_is(problem, task, reaches):
    problem(task, AT_REST, 0.5).solve(np.zeros(6), finish=False)
    assert reaches == [("sampled", 0.5)]


def test_the_first_reach_holds_along_axes_of_one_size(problem, task):
    # The unknowns are even: the same step along any of them moves the joint alike.
    asked = problem(task, AT_REST, terms=16)
    axes = Run.of(asked.program, AT_REST, None, LEAST_ENERGY).axes
    assert axes is asked.program.even_axes
    assert Run.of(asked.program, AT_REST, 0.5, LEAST_ENERGY).axes.tolist() == np.eye(16).tolist()


AT_REST_BY_NETWORK = [
    -0.5, -0.5, -0.5, -0.134, 0.086, -0.5, -3.764, -3.764, -0.908, -2.107, 2.992, 4.0, 4.0, 1.952,
    4.0, 3.629,
]  # fmt: skip
"""The single link's plan by a network of 16, by `plan_move` from one start: 0.0229 J."""


def test_along_a_curved_valley_it_ends_when_the_energy_hardly_changes(tasks):
    # From the assumed plant's plan; with the options of one plant it creeps on for 500 iterations.
    plant = UncertainPlant(tasks["single link"].plant, {"frequency": 0.1})
    task = replace(tasks["single link"], plant=plant)
    program = TaskProgram(task, CycloidNetwork(), 40)
    asked = Problem(program, {RESIDUAL: tolerated_residual(task)})
    found = asked.solve(np.array(AT_REST_BY_NETWORK), finish=False)
    assert (found.status, found.iterations < 500) == (SolveStatus.ACCEPTABLE, True)
    assert found.residual <= tolerated_residual(task) * (1 + 1e-4)
    assert found.energy < 0.025


@pytest.mark.parametrize("passed", [5e-7, 5e-6])
def test_what_crept_to_the_last_iteration_counts_where_it_keeps_the_limits(tasks, passed):
    plant = UncertainPlant(tasks["single link"].plant, {"frequency": 0.1})
    stop = Stop(Point(np.zeros(4)), "Maximum_Iterations_Exceeded", 500, passed)
    of = {
        profile: Run.of(
            TaskProgram(replace(tasks["single link"], plant=plant), profile, 20),
            {RESIDUAL: 1e-3}, None, LEAST_ENERGY,
        )
        for profile in (CycloidNetwork(1), CycloidSpline(4))
    }  # fmt: skip
    found = [one._status(one.form, stop) for one in of.values()]
    crept = SolveStatus.ACCEPTABLE if passed < 1e-6 else SolveStatus.ITERATION_LIMIT
    assert found == [crept, SolveStatus.ITERATION_LIMIT]
