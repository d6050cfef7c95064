"""The registry of methods: one value for each, found by the name that a front states."""

import math

import pytest
from quietarm.metaheuristics import PRESETS
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, polish_front
from quietarm.studies.registry.methods import (
    EPSILON,
    METHODS,
    NSGA2,
    VEPSO,
    WEIGHTED,
    Kind,
    method_of,
    methods_of,
)


@pytest.mark.parametrize(("name", "method"), METHODS.items())
def test_a_method_is_found_by_the_name_that_it_has(name, method):
    assert method.name == name
    assert method_of(name) is method
    assert not method.polished


def test_every_search_with_the_papers_settings_is_in_the_registry():
    assert {method.name for method in methods_of(Kind.METAHEURISTIC)} == set(PRESETS)
    assert methods_of(Kind.GRADIENT) == (EPSILON, WEIGHTED)


@pytest.mark.parametrize("method", methods_of(Kind.GRADIENT), ids=lambda method: method.name)
def test_a_gradients_front_and_its_polished_one_name_their_method(method):
    task = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8)
    front = method.sweep(task, CycloidPolynomial(2), bound=0.2, points=2, starts=1)
    assert method_of(front.method) == method
    assert method_of(polish_front(front).front.method) == method.then_polished()


def test_a_polished_front_has_the_kind_of_what_it_was_made_of():
    polished = method_of("nsga2, polished")
    assert (polished.label, polished.kind, polished.polished) == (
        "NSGA-II polished", Kind.METAHEURISTIC, True
    )  # fmt: skip
    assert polished == NSGA2.then_polished() != VEPSO.then_polished()
    assert method_of("nsga2, polished, polished").label == "NSGA-II polished, polished"


def test_an_algorithm_that_is_not_listed_is_called_what_it_calls_itself():
    other = method_of("MOEAD")
    assert (other.label, other.kind) == ("MOEAD", Kind.OTHER)
    assert method_of("MOEAD, polished").label == "MOEAD polished"


def test_a_metaheuristic_is_not_swept():
    with pytest.raises(ValueError, match="not of the gradient"):
        VEPSO.sweep()
