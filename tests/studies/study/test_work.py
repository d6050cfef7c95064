"""The headline study: every method runs, what fails is left out, Ctrl-C keeps what was found."""

import pytest
import quietarm.metaheuristics.ensemble as ensemble
import quietarm.studies.study.work as study_pieces
from quietarm.ocp import (
    SolverFailedError,
)
from quietarm.studies.study.findings import case_findings
from quietarm.studies.study.work import amount_of_work, run_study
from small_study import CASES, METHODS, QUICK

# What is run


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
