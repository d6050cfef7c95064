"""NSGA-II as the paper sets it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pymoo.core.population import Population
from pymoo.indicators.igd import IGD
from pymoo.problems import get_problem
from pymoo.termination.max_gen import MaximumGenerationTermination

from quietarm.metaheuristics import PaperNSGA2
from quietarm.metaheuristics.algorithms.nsga2 import ExactDuplicates

VALUES = st.sampled_from([0.0, -0.0, 1.0, 0.1 + 0.2, 0.3, -1e-9])


@given(
    X=arrays(float, st.tuples(st.integers(1, 12), st.just(2)), elements=VALUES),
    others=st.lists(arrays(float, st.tuples(st.integers(0, 6), st.just(2)), elements=VALUES)),
)
def test_duplicates_are_those_with_equal_coefficients(X, others):
    # pymoo's own elimination, by distances, may miss equal ones for rounding
    individuals = Population.new(X=X)
    kept = ExactDuplicates().do(individuals, *(Population.new(X=other) for other in others))
    known = [tuple(row) for other in others for row in other.tolist()]
    expected = []
    for individual in individuals:
        row = tuple(individual.X.tolist())
        if row not in known:
            expected.append(individual)
        known.append(row)
    assert list(kept) == expected


@pytest.mark.slow
def test_it_finds_the_front_of_zdt1():
    problem = get_problem("zdt1", n_var=6)
    algorithm = PaperNSGA2(100)
    # not the tolerance that pymoo's default stops at
    algorithm.setup(problem, seed=1, termination=MaximumGenerationTermination(150))
    while algorithm.has_next():
        algorithm.next()
    # 100 points evenly spread over a front of length 1.48 are 0.004 apart on average.
    assert IGD(problem.pareto_front())(algorithm.opt.get("F")) < 0.01
