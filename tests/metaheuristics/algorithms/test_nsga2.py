"""NSGA-II as the paper sets it: its operators, and a run that goes on bit for bit."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pymoo.core.population import Population
from pymoo.indicators.igd import IGD
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.problems import get_problem
from pymoo.termination.max_gen import MaximumGenerationTermination
from quietarm.metaheuristics import PaperNSGA2
from quietarm.metaheuristics.algorithms.nsga2 import ExactDuplicates

# -- settings --


def test_operators_are_those_stated():
    # docs/physics.md, 'NSGA-II settings'.
    mating = PaperNSGA2().mating
    crossover, mutation = mating.crossover, mating.mutation
    assert type(crossover) is SBX
    assert type(mutation) is PM
    assert crossover.prob.value == 0.8
    assert crossover.prob_var.value == 0.5
    assert crossover.eta.value == 15
    assert mutation.prob.value == 1.0
    assert mutation.prob_var.value == 0.01
    assert mutation.eta.value == 20
    assert not mutation.at_least_once


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


@pytest.mark.parametrize("population", [3, 7])
def test_every_generation_evaluates_exactly_the_population(population):
    algorithm = PaperNSGA2(population)
    algorithm.setup(get_problem("zdt1", n_var=5), seed=1, termination=_generations(6))
    for generation in range(1, 7):
        assert algorithm.has_next()
        algorithm.next()
        assert algorithm.evaluator.n_eval == generation * population
        assert len(algorithm.pop) == population
    assert not algorithm.has_next()


def test_it_finds_the_front_of_zdt1():
    problem = get_problem("zdt1", n_var=6)
    algorithm = PaperNSGA2(100)
    algorithm.setup(problem, seed=1, termination=_generations(150))
    while algorithm.has_next():
        algorithm.next()
    # 100 points evenly spread over a front of length 1.48 are 0.004 apart on average.
    assert IGD(problem.pareto_front())(algorithm.opt.get("F")) < 0.01


# -- going on --


def _generations(count):
    # not the tolerance that pymoo's default stops at
    return MaximumGenerationTermination(count)
