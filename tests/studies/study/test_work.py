"""The headline study: every method runs, what fails is left out, Ctrl-C keeps what was found."""

from dataclasses import replace

import pytest
import quietarm.metaheuristics.ensemble as ensemble
import quietarm.studies.study.work as study_pieces
from quietarm.metaheuristics import search
from quietarm.ocp import (
    CycloidPolynomial,
    InfeasibleTaskError,
    PointToPoint,
    SolverFailedError,
)
from quietarm.studies.comparison.measures import compare_fronts
from quietarm.studies.document.files import page as page_of
from quietarm.studies.paper import Case
from quietarm.studies.study.findings import case_findings
from quietarm.studies.study.page import study_document
from quietarm.studies.study.work import Study, amount_of_work, run_study
from small_study import CASES, METHODS, QUICK
from small_study import FLOOR as FLOOR_FOUND

# What is run


def study_page(study):
    return page_of(study_document(study))


def test_every_method_runs_on_every_task(small, announced):
    assert [found.case.task for found in small.cases] == [case.task for case in CASES]
    for found in small.cases:
        assert [run.front.method for run in found.comparison.runs] == METHODS
        assert found.failures == ()
        assert {run.front.settings["bound"] for run in found.comparison.runs} == {found.case.bound}
    assert len(announced) == amount_of_work(CASES, QUICK) == 18
    assert announced[0] == "single-link, 0 to 30 deg in 0.8 s: epsilon"


def test_polish_never_makes_worse_what_it_starts_from(small):
    for found in small.cases:
        for method in ("nsga2", "vepso"):
            first = next(r for r in found.comparison.runs if r.front.method == method)
            polished = next(
                r for r in found.comparison.runs if r.front.method == f"{method}, polished"
            )
            gained = polished.hypervolume_found - first.hypervolume_found
            assert gained > -1e-5  # the two integrators differ by that much
            assert len(found.polishes[method].gains) == len(first.front.points)


def test_a_plant_of_ones_own_needs_a_bound(two_links):
    task = PointToPoint(two_links, 1.5, 0.9)
    with pytest.raises(ValueError, match="give a bound on the coefficients"):
        Case(task)
    assert Case(task, 0.3).bound == 0.3
    with pytest.raises(ValueError, match="bound on the coefficients is -1"):
        Case(task, -1)


def searches_that_find(monkeypatch, answer):
    """Let every search of a study answer so, by its method and seed."""
    monkeypatch.setattr(ensemble, "search", lambda task, method, seed, **_: answer(method)[seed])


@pytest.fixture
def known(small, monkeypatch, let_sweep):
    """The fronts of the small study's first task, which every method then finds at once."""
    (case, _) = small.cases
    fronts = [run.front for run in case.comparison.runs]
    for front in fronts[:2]:
        let_sweep(front.method, lambda *given, found=front, **_: found)
    searches_that_find(monkeypatch, lambda method: [f for f in fronts if f.method == method])
    monkeypatch.setattr(study_pieces, "polish_front", lambda front: case.polishes[front.method])
    return fronts


def test_a_method_that_fails_is_left_out_with_its_reason(monkeypatch, let_sweep, known):
    def fail(*arguments, **settings):
        raise SolverFailedError("it would not")

    let_sweep("weighted", fail)
    monkeypatch.setattr(study_pieces, "energy_floor", fail)
    (found,) = run_study(CASES[:1], QUICK).cases
    assert "weighted" not in {run.front.method for run in found.comparison.runs}
    assert found.failures == ("weighted: it would not", "floor: it would not")
    assert found.floor is None
    assert set(found.failures) <= set(case_findings(found))


def test_the_gradient_is_not_asked_twice_for_an_infeasible_task(let_sweep, known):
    def infeasible(*arguments, **settings):
        raise InfeasibleTaskError("found no motion")

    let_sweep("epsilon", infeasible)
    let_sweep("weighted", lambda *given, **_: pytest.fail("asked"))
    (case,) = run_study(CASES[:1], QUICK).cases
    assert case.failures == (
        "epsilon: found no motion",
        "weighted: not tried, as epsilon found no motion within the limits",
    )


@pytest.mark.usefixtures("no_pictures")
def test_a_search_that_is_interrupted_ends_the_study_and_what_was_found_is_kept(monkeypatch, known):
    cut = replace(known[2], complete=False)
    searches_that_find(monkeypatch, lambda method: [cut])
    begun = []
    found = run_study(CASES, QUICK, begun.append)
    assert len(begun) == 3
    assert found.done == 2
    (case,) = found.cases
    assert [run.front for run in case.comparison.runs] == [*known[:2], cut]
    assert case.failures == (
        "nsga2 (1 of 2 seeds): interrupted, with what was found until then",
        "nsga2 (1 of 2 seeds): not done before the interruption",
        "nsga2, polished: not done before the interruption",
        "vepso (2 of 2 seeds): not done before the interruption",
        "vepso, polished: not done before the interruption",
        "floor: not done before the interruption",
    )
    assert "not done before the interruption" in study_page(found)


def test_a_study_of_which_one_front_was_found_is_a_page(small):
    (case, _) = small.cases
    alone = compare_fronts([case.comparison.runs[0].front], least=1)
    page = study_page(Study(QUICK, (replace(case, comparison=alone, polishes={}),), 1.0, done=1))
    assert "epsilon constraint" in page


def test_a_study_that_found_nothing_before_ctrl_c_is_none(let_sweep):
    def stopped(*given, **settings):
        raise KeyboardInterrupt

    let_sweep("epsilon", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_study(CASES[:1], QUICK)


def test_epsilon_has_a_point_at_every_residual_that_energies_are_compared_at(small):
    for found in small.cases:
        front = next(r.front for r in found.comparison.runs if r.front.method == "epsilon")
        for level in found.comparison.levels:
            assert level * (1 - 3e-4) < front.cheapest(level).residual <= level


def test_a_front_from_elsewhere_is_compared_with_those_of_its_task():
    case, settings = CASES[0], replace(QUICK, runs=1, methods=("gde3",))
    before = search(case.task, "rvea", bound=0.2, population=16, generations=4,
                    profile=CycloidPolynomial(2))  # fmt: skip
    mine = replace(before, method="mine", seed=None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_pieces, "energy_floor", lambda task: FLOOR_FOUND)
        found = run_study(CASES[:1], replace(settings, fronts=(mine,)))
    methods = [run.front.method for run in found.cases[0].comparison.runs]
    assert methods == ["epsilon", "weighted", "gde3", "gde3, polished", "mine"]
    assert any("mine" in line for line in case_findings(found.cases[0]))
    with pytest.raises(ValueError, match="the front by mine is of another task, single-link"):
        run_study(CASES[1:], replace(settings, fronts=(mine,)))
