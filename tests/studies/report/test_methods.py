"""What methods are called, by the names that their fronts and jobs state."""

import math
from functools import partial

import pytest
from quietarm.studies.bench.results import derivative_free
from quietarm.studies.report.methods import is_gradient, label_of

import quietarm as qa


@pytest.mark.parametrize(
    ("find", "label"),
    [
        (partial(qa.epsilon_front, points=2), "epsilon constraint"),
        (partial(qa.weighted_front, points=2), "weighted sum"),
        (partial(qa.search, bound=0.2, population=20, generations=4), "NSGA-II"),
    ],
)
def test_a_front_and_its_polished_one_name_their_method(find, label):
    task = qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8)
    front = find(task, profile=qa.CycloidPolynomial(2), **{"bound": 0.2})
    polished = qa.polish_front(front).front.record.method
    assert label_of(front.record.method) == label
    assert label_of(polished) == f"{label}, polished"
    by_gradient = label != "NSGA-II"
    assert is_gradient(front.record.method) == is_gradient(polished) == by_gradient
    assert derivative_free(front.record.method) == (not by_gradient)
    assert not derivative_free(polished)


@pytest.mark.parametrize(
    ("method", "label"),
    [
        ("epsilon", "epsilon constraint, SQP"),
        ("weighted:ipopt(points=20)", "weighted sum, IPOPT (points=20)"),
        ("nsga2+polish(budget=500)", "NSGA-II, polished (budget=500)"),
        ("mine", "mine"),
    ],
)
def test_a_job_names_solver_and_settings(method, label):
    assert label_of(method, solver="sqp") == label
