"""Searches of exactly so many evaluations, and their record on the way."""

import dataclasses

import numpy as np
import pytest
from quietarm.metaheuristics.budget.record import CORNER, Scale, marks_of
from quietarm.metaheuristics.budget.run import search_within
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.ocp import CycloidPolynomial
from small_searches import BOUNDS, HALF, LIMITED, METHODS, SWARMS, TASKS

PROFILE = CycloidPolynomial(2)
SCALES = {
    "nsga2": Scale((0.0, 0.1), (0.015, 0.2)),
    "vepso": Scale((0.0, 0.02), (0.05, 0.07)),
}
BUDGET = 130


def run(method, task=None, evaluations=BUDGET, seed=3, **settings):
    task = TASKS[method] if task is None else task
    return search_within(
        task, method, evaluations, SCALES[method], profile=PROFILE, bound=BOUNDS[method],
        population=20, seed=seed, **settings,
    )  # fmt: skip


def area(points, corner):
    """What points dominate up to a corner, by adding up rectangles between falling steps."""
    inside = sorted((x, y) for x, y in points if x < corner[0] and y < corner[1])
    total, height = 0.0, corner[1]
    for x, y in inside:
        if y < height:
            total += (corner[0] - x) * (height - y)
            height = y
    return total


@pytest.fixture
def candidates(monkeypatch):
    """Residual and energy of every candidate that a search evaluates, in order."""
    evaluate, seen = PopulationObjective.__call__, []

    def watched(self, coefficients):
        values = evaluate(self, coefficients)
        if self.steps == 24:  # those of a search
            feasible = (values.violations <= 0).all(axis=1)
            seen.extend(zip(values.residual, values.energy, feasible, strict=True))
        return values

    monkeypatch.setattr(PopulationObjective, "__call__", watched)
    return seen


def watched_run(candidates, method, *task):
    """A run whose candidates alone are seen: the first of a kind has a rehearsal before it."""
    run(method, *task)
    candidates.clear()
    return run(method, *task)


@METHODS
def test_exactly_so_many_candidates_are_evaluated_also_where_no_generation_ends(method, candidates):
    found = watched_run(candidates, method)
    assert BUDGET % (20 * SWARMS[method]) != 0
    assert len(candidates) == found.front.evaluations == BUDGET
    assert [mark.evaluations for mark in found.marks] == list(marks_of(BUDGET))
    assert found.marks[-1].evaluations == BUDGET
    seconds = [mark.seconds for mark in found.marks]
    assert seconds == sorted(seconds)


@METHODS
def test_every_mark_is_the_hypervolume_of_all_candidates_until_then(method, candidates):
    scale, found = SCALES[method], watched_run(candidates, method)
    extent = np.array(scale.nadir) - np.array(scale.ideal)
    points = [(np.array(pair[:2]) - scale.ideal) / extent for pair in candidates]
    for mark in found.marks:
        expected = area(points[: mark.evaluations], (CORNER, CORNER))
        assert mark.hypervolume == pytest.approx(expected, rel=1e-12)
    assert found.marks[-1].hypervolume > found.marks[0].hypervolume


def test_candidates_beyond_a_limit_are_counted_and_not_kept(candidates):
    found = watched_run(candidates, "nsga2", LIMITED["nsga2"])
    assert found.front.infeasible == sum(not feasible for *_, feasible in candidates) > 0
    visits = dataclasses.astuple(found.visits)
    assert sum(visits) + found.front.infeasible == BUDGET
    extent = np.array(SCALES["nsga2"].nadir) - np.array(SCALES["nsga2"].ideal)
    kept = [(np.array(pair) - SCALES["nsga2"].ideal) / extent for *pair, ok in candidates if ok]
    assert found.marks[-1].hypervolume == pytest.approx(area(kept, (CORNER, CORNER)), rel=1e-12)


def test_a_longer_budget_begins_as_a_shorter_one():
    short, long = run("nsga2"), run("nsga2", evaluations=2 * BUDGET)
    known = {mark.evaluations: mark.hypervolume for mark in short.marks}
    both = [mark for mark in long.marks if mark.evaluations in known]
    assert len(both) > 5
    assert all(known[mark.evaluations] == mark.hypervolume for mark in both)


@pytest.mark.parametrize(
    "budget",
    [1, 11, 1000],
)
def test_marks_rise_by_a_twentieth_to_the_budget(budget):
    marks = np.array(marks_of(budget))
    assert marks[-1] == budget
    assert (np.diff(marks) > 0).all()
    assert (marks[1:] <= 1.05 * marks[:-1] + 1).all()


@pytest.mark.parametrize("method", ["nsga2+polish", "nsga2+seeds", "multistart"])
def test_the_gradients_iterations_count_against_the_same_budget(method, candidates):
    found = search_within(
        HALF, method, 700, SCALES["nsga2"], profile=PROFILE, bound=0.5, population=20, seed=1
    )
    assert found.front.evaluations == found.marks[-1].evaluations == 700
    assert 0 < len(candidates) < 700
    assert found.front.iterations > 0
    # 1 + 2 + 3 evaluations an iteration; the last solve may have had more than were left
    spent = len(candidates) + 6 * found.front.iterations
    assert 700 <= spent < 700 + 6 * 100
    assert found.front.method == method


def test_gradient_seeds_are_in_the_first_population(candidates):
    found = search_within(
        HALF, "nsga2+seeds", 700, SCALES["nsga2"], profile=PROFILE, bound=0.5, population=20
    )
    alone = search_within(
        HALF, "nsga2", 700, SCALES["nsga2"], profile=PROFILE, bound=0.5, population=20
    )
    # the seeds arrive at rest; a search of so few evaluations does not
    assert found.front.residuals[0] < 1e-4 < alone.front.residuals[0]
