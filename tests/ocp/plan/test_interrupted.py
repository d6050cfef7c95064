"""Ctrl-C while a plan is solved: the starts that were solved are not lost."""

import signal

import pytest

import ocp.plan.solver
from ocp import CycloidPolynomial, Plan, plan_move
from ocp.program.problem import Problem

TWO = CycloidPolynomial(2)


@pytest.fixture
def ctrl_c_in(monkeypatch):
    """Let Ctrl-C come when a function is called for the nth time."""

    def put(owner, name, number):
        known, calls = getattr(owner, name), []

        def interrupted(*given, **settings):
            calls.append(name)
            if len(calls) == number:
                signal.raise_signal(signal.SIGINT)
            return known(*given, **settings)

        monkeypatch.setattr(owner, name, interrupted)

    return put


@pytest.mark.parametrize("number", [2, 3])
def test_the_starts_that_were_solved_are_kept(tasks, ctrl_c_in, tmp_path, number):
    ctrl_c_in(Problem, "solve", number)
    plan = plan_move(tasks["single link"], TWO, starts=4)
    assert not plan.complete
    assert plan.provenance.stopped == f"{number - 1} of 4 starts"
    assert plan.verification.agrees
    # the first start is the plain cycloid, from which this move's minimum is found
    assert plan.energy == pytest.approx(
        plan_move(tasks["single link"], TWO, starts=1).energy, rel=1e-5
    )
    plan.save(tmp_path / "plan.json")
    assert Plan.load(tmp_path / "plan.json") == plan


def test_what_comes_after_the_starts_does_not_lose_them(tasks, ctrl_c_in):
    ctrl_c_in(Problem, "finished", 1)
    plan = plan_move(tasks["single link"], TWO, starts=2)
    assert plan.provenance.stopped == "2 of 2 starts"
    assert plan.residual < 1e-8


def test_the_verification_does_not_lose_them(tasks, ctrl_c_in):
    ctrl_c_in(ocp.plan.solver, "verified", 1)
    assert plan_move(tasks["single link"], TWO, starts=2).provenance.stopped == "2 of 2 starts"


def test_before_a_start_was_solved_there_is_nothing_to_keep(tasks, ctrl_c_in):
    ctrl_c_in(Problem, "solve", 1)
    with pytest.raises(KeyboardInterrupt):
        plan_move(tasks["single link"], TWO, starts=4)


def test_a_plan_that_ran_to_its_end_says_so(tasks, solved):
    plan = solved(tasks["single link"], 2)
    assert plan.complete
    assert plan.provenance.stopped is None
