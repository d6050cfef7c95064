"""Names of methods, by those that their fronts and jobs state."""

import pytest

from quietarm.metaheuristics import PRESETS, Job
from quietarm.metaheuristics.methods.gradient_methods import gradient_settings
from quietarm.metaheuristics.named_method import BY_GRADIENT, NamedMethod
from quietarm.ocp.solvers.choice import SOLVERS
from quietarm.studies.bench.results import derivative_free
from quietarm.views.report.method_rows import GRADIENT_LABELS, is_gradient, label_of


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


def test_each_solver_may_be_named_and_the_usual_one_need_not():
    assert tuple(GRADIENT_LABELS) == BY_GRADIENT
    for method in BY_GRADIENT:
        assert NamedMethod.admitted(f"{method}:sqp", PRESETS) == NamedMethod(method)
        for solver in SOLVERS:
            named = NamedMethod.admitted(f"{method}:{solver}", PRESETS)
            assert gradient_settings(named)[0].name in ("points", "starts")
    job = Job("single-link-30deg-0.8s-2-terms", "epsilon:sqp", settings={"points": 3})
    assert job == Job("single-link-30deg-0.8s-2-terms", "epsilon", settings={"points": 3})


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("NSGA-II+polish", "nsga2+polish"),
        ("Epsilon:SQP.points", "epsilon.points"),
        ("epsilon:IPOPT.solver_tolerance", "epsilon:ipopt.solver_tolerance"),
        ("mine: a method", "mine: a method"),
    ],
)
def test_a_name_that_was_typed_is_written_as_it_is_here(typed, name):
    assert NamedMethod.of_typed(typed, PRESETS) == name


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("epsilon:hsl", r"unknown solver 'hsl' \(known: sqp, ipopt\)"),
        ("epsilon:ipopt+polish", "is polished already.*; give epsilon:ipopt"),
        ("nsga2:ipopt", "unknown method 'nsga2:ipopt'"),
        ("nsga2(population=20)", "unknown method"),
        ("nsgax", "unknown method 'nsgax'.*NAME:ipopt of the gradient"),
    ],
)
def test_a_name_of_no_job_is_refused_by_every_door(name, told):
    with pytest.raises(ValueError, match=told):
        NamedMethod.admitted(name, PRESETS)
    with pytest.raises(ValueError, match=told):
        Job("single-link-30deg-0.8s-2-terms", name)
