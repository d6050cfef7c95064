"""What methods are called, by the names that their fronts and jobs state."""

import pytest

from quietarm.metaheuristics.named_method import GRADIENT, NamedMethod
from quietarm.studies.bench.results import derivative_free
from quietarm.views.report.method_rows import is_gradient, label_of


@pytest.mark.parametrize(
    ("method", "label", "by_gradient"),
    [
        ("epsilon", "epsilon constraint", True),
        ("weighted", "weighted sum", True),
        ("nsga2", "NSGA-II", False),
    ],
)
def test_a_front_and_its_polished_one_name_their_method(method, label, by_gradient):
    polished = f"{method}, polished"
    assert (label_of(method), label_of(polished)) == (label, f"{label}, polished")
    assert is_gradient(method) == is_gradient(polished) == by_gradient
    assert derivative_free(method) == (not by_gradient)
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


@pytest.mark.parametrize(
    ("name", "named"),
    [
        ("nsga2", NamedMethod("nsga2")),
        ("nsga2+polish", NamedMethod("nsga2", polish=True)),
        ("epsilon:ipopt", NamedMethod("epsilon", "ipopt")),
        ("weighted:ipopt(points=9)", NamedMethod("weighted", "ipopt", settings="(points=9)")),
        ("gde3+polish(cr=0.3)", NamedMethod("gde3", polish=True, settings="(cr=0.3)")),
        ("mine: a method", NamedMethod("mine: a method")),
    ],
)
def test_a_name_is_read_into_its_parts_and_written_again(name, named):
    assert NamedMethod.read(name) == named
    assert str(named) == name


def test_a_polished_front_is_read_as_a_job_would_be():
    assert str(NamedMethod.read("epsilon, polished")) == "epsilon+polish"
    assert [name for name in GRADIENT if not NamedMethod.read(name).by_gradient] == []
