"""Searches that use derivatives: the memetic one, and finite-difference SLSQP."""

import numpy as np
import pytest
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from quietarm import CycloidPolynomial
from quietarm.metaheuristics import PRESETS, problem_of, search
from quietarm.metaheuristics.algorithms.differences import Differences
from quietarm.metaheuristics.algorithms.memetic import spread
from quietarm.metaheuristics.evaluation.population import search_evaluator
from quietarm.metaheuristics.problems.recorded import BudgetSpentError
from quietarm.metaheuristics.score import HYPERVOLUME, objectives

PROBLEM = problem_of("single-link-30deg-0.8s-4-terms")
LIMITED = problem_of("single-link-30deg-0.8s-limits")
SMALL = {"gradient_every": 2, "gradient_points": 4}


def found(method, problem=PROBLEM, evaluations=600, seed=0, **settings):
    return search(
        problem.task,
        problem.profile,
        algorithm=method,
        bound=problem.bound,
        population=1 if PRESETS[method].is_function else 20,
        evaluations=evaluations,
        settings=settings,
        seed=seed,
    )


def test_steps_of_the_gradient_count_and_lead_to_rest():
    with_gradient = found("memetic", **SMALL)
    without = found("moead-de")
    last = with_gradient.history[-1]
    assert last.evaluations == with_gradient.record.evaluations == 600
    # a motion with derivatives counts as five: one more than there are coefficients
    assert 0 < 5 * last.gradients <= 600
    assert without.history[-1].gradients == 0
    # one is led to rest: what is left is that of the search's own, coarser steps
    stillest = [front.smallest_residual().residual for front in (with_gradient, without)]
    assert stillest[0] < 1e-5 < stillest[1]


@pytest.mark.slow
def test_the_gradient_keeps_limits():
    front = found("memetic", LIMITED, 900, **SMALL)
    assert front.history[-1].gradients > 0
    function = LIMITED.function()
    assert function(front.coefficients)[1].max() <= 0


def test_a_problem_without_derivatives_is_refused_in_one_line():
    class BlackBox(Problem):
        def _evaluate(self, x, out, *arguments, **options):
            out["F"] = np.abs(x)

    problem = BlackBox(n_var=2, n_obj=2, xl=-1, xu=1)
    with pytest.raises(ValueError, match=r"memetic takes derivatives.*as moead-de"):
        minimize(problem, PRESETS["memetic"].build(10), ("n_gen", 3))


def test_points_are_spread_evenly_from_end_to_end():
    along = np.linspace(0.0, 1.0, 101)
    F = np.column_stack([1e-3 * along, 5 - along])[::-1]
    np.testing.assert_allclose(F[spread(F, 5), 0], 1e-3 * np.array([0, 0.25, 0.5, 0.75, 1]))
    assert spread(F[:1], 5).tolist() == [0]


@pytest.mark.slow
def test_slsqp_uses_its_budget_and_comes_near_the_front():
    front = found("slsqp", evaluations=1000)
    assert front.record.evaluations == 1000
    assert PROBLEM.reference().score(objectives(front), HYPERVOLUME) > 0.8
    by_generations = search(
        PROBLEM.task, PROBLEM.profile, algorithm="slsqp", bound=PROBLEM.bound, generations=100
    )
    assert by_generations.record.evaluations == 100  # a generation is a candidate


@pytest.mark.slow
def test_the_motion_of_a_larger_limit_is_a_better_start_than_a_random_one():
    def hypervolume(continuation, seed):
        front = search(
            PROBLEM.task,
            CycloidPolynomial(12),
            algorithm="slsqp",
            bound=PROBLEM.bound,
            evaluations=1500,
            settings={"continuation": continuation},
            seed=seed,
        )
        return PROBLEM.reference().score(objectives(front), HYPERVOLUME)

    # of five seeds the least with continuation is 1.372, the median without is 1.22
    continued, random = (
        [hypervolume(continuation, seed) for seed in range(3)] for continuation in (True, False)
    )
    assert np.median(continued) > np.median(random) + 0.05


@pytest.mark.slow
def test_slsqp_keeps_limits():
    front = found("slsqp", LIMITED, 500)
    assert front.points
    assert LIMITED.function()(front.coefficients)[1].max() <= 0


def test_what_slsqp_cannot_have_is_refused():
    task = PROBLEM.task
    with pytest.raises(ValueError, match="slsqp has no population; leave it out"):
        search(task, PROBLEM.profile, algorithm="slsqp", bound=0.2, population=20)
    start = found("random", evaluations=50)
    with pytest.raises(ValueError, match="slsqp cannot start from a front; leave start"):
        search(task, PROBLEM.profile, algorithm="slsqp", bound=0.2, start=start)


def test_differences_ask_once_for_each_candidate():
    function = PROBLEM.recorded()
    differences = Differences(function, 1e-6)
    x = np.full(4, 0.05)
    values = differences.values(x)
    slopes = differences.slopes(x)
    differences.values(x)
    differences.slopes(x)
    assert function.archive.evaluations == 5
    # a step to the other side gives the same slope, but for the curvature between
    ahead, behind = (function((x + s * np.eye(4)[0])[None])[0][0] for s in (1e-4, -1e-4))
    np.testing.assert_allclose(slopes[:, 0], (ahead - behind) / 2e-4, rtol=1e-2)
    np.testing.assert_array_equal(values, function(x[None])[0][0])


def test_candidates_for_derivatives_use_up_a_budget():
    function = PROBLEM.recorded(10)
    function(np.zeros((4, 4)))
    function.charge(5)
    with pytest.raises(BudgetSpentError):
        function.charge(7)
    assert function.front("mine").record.evaluations == 10


@pytest.mark.slow
def test_a_candidate_counts_once_for_all_scenarios_of_an_uncertain_task():
    robust = problem_of("single-link-30deg-0.8s-robust")
    last = found("memetic", robust, **SMALL).history[-1]
    scenarios = len(search_evaluator(robust.task, robust.profile).scenarios)
    assert last.evaluations == 600
    assert scenarios > 1
    assert 0 < 7 * last.gradients / scenarios <= 600


@pytest.mark.parametrize(("method", "settings"), [("slsqp", {}), ("memetic", SMALL)])
def test_what_ends_on_limits_keeps_its_motions(method, settings):
    """Without room the verification keeps 6 motions of SLSQP and 5 of the memetic search."""
    problem = problem_of("linear-axis-m4-6-absolute-jerk-tight")
    front = found(method, problem, 400 if method == "slsqp" else 1000, seed=1, **settings)
    assert len(front.points) > 10
