"""Searches that learn nothing, and budgets in evaluations."""

import math

import numpy as np
import pytest
from small_searches import assert_is_a_front

import quietarm as qa

TASK = qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8)


@pytest.mark.parametrize("method", ["random", "lhs"])
def test_a_baseline_keeps_what_none_of_its_candidates_dominates(method):
    settings = {"bound": 0.2, "population": 50, "seed": 3}
    short, long = (qa.search(TASK, method, generations=n, **settings) for n in (2, 8))
    assert_is_a_front(long)
    assert (short.evaluations, long.evaluations) == (100, 400)
    for point in short.points:  # the first generations of both are the same
        assert any(
            other.residual <= point.residual and other.energy <= point.energy
            for other in long.points
        )


def test_a_latin_hypercube_has_a_candidate_in_every_slice():
    (front,) = [qa.search(TASK, "lhs", bound=0.2, population=20, generations=1, seed=1)]
    assert front.evaluations == 20
    rows = np.array([point.coefficients for point in front.points])
    slices = np.floor((rows + 0.2) / 0.4 * 20)  # McKay et al.: one of 20 in each, by coordinate
    for column in slices.T:
        assert len(set(column)) == len(column)


def test_evaluations_stand_for_whole_generations():
    settings = {"bound": 0.2, "population": 20}
    with pytest.warns(RuntimeWarning, match="130 evaluations are 3 generations of vepso"):
        front = qa.search(TASK, "vepso", evaluations=130, **settings)
    assert front.evaluations == 120  # two swarms of 20, three times
    assert front == qa.search(TASK, "vepso", generations=3, **settings)
    with pytest.raises(ValueError, match="in place of generations"):
        qa.search(TASK, "vepso", evaluations=130, generations=3, **settings)
    with pytest.raises(ValueError, match="30, less than one generation of vepso, 40"):
        qa.search(TASK, "vepso", evaluations=30, **settings)
