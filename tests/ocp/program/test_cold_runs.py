"""Cold runs without a box: no farther than a reach at first, to the minimum of a wide box."""

import numpy as np
import pytest

from ocp.program import run
from ocp.program.run import Run
from ocp.program.solution import LEAST_ENERGY
from ocp.program.transcription import RESIDUAL, NonlinearProgram

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
    ("limits", "terms"), [(AT_REST, 6), ({RESIDUAL: 5e-3}, 10), ({RESIDUAL: 5e-3}, 16)]
)
def test_without_a_box_it_reaches_what_it_reaches_in_a_wide_one(problem, task, limits, terms):
    # In the box the solver works along the coefficients, without it along even axes.
    free, boxed = (
        problem(task, limits, bound, terms=terms, steps=80).solve(np.zeros(terms))
        for bound in (None, 1e4)
    )
    assert free.status.solved
    if free.settled:
        # Not above it by more than 1e-6; in the box some end too high, by 3.1e-4 at most.
        assert free.energy <= boxed.energy * (1 + 1e-6)
        assert free.energy == pytest.approx(boxed.energy, rel=5e-4)
    else:  # one of the nine: single link, 16 terms, 5 mm; the sampled minimum stands, 4.3e-3 above
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
