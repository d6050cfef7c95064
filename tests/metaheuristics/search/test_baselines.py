"""Searches that learn nothing, and budgets in evaluations."""

import math

import numpy as np
import pytest
from small_searches import assert_is_a_front

import quietarm as qa
from quietarm.metaheuristics import Job, problem_of
from quietarm.metaheuristics.score import final_share_of_box, shares_of_box

TASK = qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8)


@pytest.mark.parametrize("method", ["random", "lhs"])
def test_a_baseline_keeps_what_none_of_its_candidates_dominates(method):
    settings = {"bound": 0.2, "population": 50, "seed": 3}
    short, long = (qa.search(TASK, algorithm=method, generations=n, **settings) for n in (2, 8))
    assert_is_a_front(long)
    assert (short.record.evaluations, long.record.evaluations) == (100, 400)
    for point in short.points:  # the first generations of both are the same
        assert any(
            other.residual <= point.residual and other.energy <= point.energy
            for other in long.points
        )


def test_a_latin_hypercube_has_a_candidate_in_every_slice():
    (front,) = [qa.search(TASK, algorithm="lhs", bound=0.2, population=20, generations=1, seed=1)]
    assert front.record.evaluations == 20
    rows = np.array([point.coefficients for point in front.points])
    slices = np.floor((rows + 0.2) / 0.4 * 20)  # McKay et al.: one of 20 in each, by coordinate
    for column in slices.T:
        assert len(set(column)) == len(column)


@pytest.mark.parametrize("method", ["vepso", "nsga2", "moead", "random"])
def test_a_search_ends_exactly_at_its_evaluations(method):
    front = qa.search(TASK, algorithm=method, bound=0.2, population=20, evaluations=130)
    assert front.record.evaluations == front.history[-1].evaluations == 130
    whole = qa.search(TASK, algorithm=method, bound=0.2, population=20, evaluations=120)
    assert final_share_of_box(whole) <= final_share_of_box(front)


def test_evaluations_below_a_generation_are_refused():
    settings = {"bound": 0.2, "population": 20}
    with pytest.raises(ValueError, match="in place of generations"):
        qa.search(TASK, algorithm="vepso", evaluations=130, generations=3, **settings)
    with pytest.raises(ValueError, match="30, less than one generation of vepso, 40"):
        qa.search(TASK, algorithm="vepso", evaluations=30, **settings)


@pytest.mark.parametrize("given", ["100", math.nan, 100.5])
def test_a_budget_is_a_whole_number(given):
    problem = problem_of("single-link-30deg-0.8s-2-terms")
    with pytest.raises(ValueError, match=r"evaluations is .*; give a whole number from 1 up"):
        qa.search(TASK, algorithm="nsga2", bound=0.2, evaluations=given)
    with pytest.raises(ValueError, match=r"budget is .*; give a whole number from 1 up"):
        problem.recorded(budget=given)
    with pytest.raises(ValueError, match=r"budget is .*; give a whole number from 1 up"):
        Job(problem, "nsga2", budget=given)


@pytest.mark.parametrize("given", [-1, 0])
def test_a_recording_has_a_budget_from_one_up(given):
    problem = problem_of("single-link-30deg-0.8s-2-terms")
    with pytest.raises(ValueError, match=rf"budget is {given}; give a whole number from 1 up"):
        problem.recorded(budget=given)


def test_a_search_starts_from_the_points_of_a_front():
    front = qa.search(TASK, algorithm="gde3", bound=0.2, population=20, generations=30, seed=4)
    further = qa.search(
        TASK, algorithm="nsga2", bound=0.2, population=20, generations=2, start=front
    )
    alone = qa.search(TASK, algorithm="nsga2", bound=0.2, population=20, generations=2)
    first = final_share_of_box(front)
    assert shares_of_box(further)[0] > 0.9 * first > shares_of_box(alone)[0]
    with pytest.raises(ValueError, match="beyond the bound of 1e-06; give a wider one"):
        qa.search(TASK, algorithm="nsga2", bound=1e-6, generations=2, start=front)
    with pytest.raises(ValueError, match="another profile"):
        qa.search(TASK, algorithm="nsga2", bound=0.2, generations=2, start=front,
                  profile=qa.CycloidPolynomial(3))  # fmt: skip
