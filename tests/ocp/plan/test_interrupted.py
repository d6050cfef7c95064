"""Ctrl-C while a plan is solved: the starts that were solved are not lost."""

import signal
from contextlib import suppress

import pytest
import quietarm.ocp.plan.solver
from quietarm.ocp import CycloidGaussians, Plan, plan_move
from quietarm.ocp.program.stack import Stack

GAUSSIANS = CycloidGaussians(2)


@pytest.fixture
def ctrl_c_in(monkeypatch):
    """Let Ctrl-C come when a function is called for the nth time."""
    owners = {"evaluate": Stack, "verified": quietarm.ocp.plan.solver}
    known = {name: getattr(owner, name) for name, owner in owners.items()}

    def put(name, number):
        calls = []

        def interrupted(*given, **settings):
            calls.append(name)
            if len(calls) == number:
                signal.raise_signal(signal.SIGINT)
            return known[name](*given, **settings)

        monkeypatch.setattr(owners[name], name, interrupted)

    return put


@pytest.fixture
def stopped(tasks, ctrl_c_in):
    """The plan of the first Ctrl-C after which there is one."""
    plan, number = None, 0
    while plan is None:  # its starts end one after another: coefficients enter nonlinearly
        number += 1
        ctrl_c_in("evaluate", number)
        with suppress(KeyboardInterrupt):
            plan = plan_move(tasks["single link"], GAUSSIANS, starts=4)
    return plan


def test_the_starts_that_were_solved_are_kept(stopped, tmp_path):
    assert not stopped.complete
    assert stopped.provenance.stopped in [f"{count} of 13 starts" for count in range(1, 13)]
    assert stopped.verification.agrees
    assert stopped.residual < 1e-8
    assert stopped.energy < 0.09115  # the plain cycloid's, docs/physics.md
    stopped.save(tmp_path / "plan.json")
    assert Plan.load(tmp_path / "plan.json") == stopped


def test_before_a_start_was_solved_there_is_nothing_to_keep(tasks, ctrl_c_in):
    ctrl_c_in("evaluate", 3)
    with pytest.raises(KeyboardInterrupt):
        plan_move(tasks["single link"], starts=4)


def test_ipopt_finishes_the_start_that_it_is_at(tasks, ctrl_c_in):
    ctrl_c_in("evaluate", 3)
    plan = plan_move(tasks["single link"], starts=4, solver="ipopt")
    assert plan.provenance.stopped == "1 of 4 starts"
    assert plan.residual < 1e-8


def test_the_verification_does_not_lose_them(tasks, ctrl_c_in):
    ctrl_c_in("verified", 1)
    try:
        plan = plan_move(tasks["single link"], starts=2)
    except KeyboardInterrupt:
        pytest.fail("the starts that were solved are lost")
    assert plan.provenance.stopped == "2 of 2 starts"


def test_a_plan_that_ran_to_its_end_says_so(tasks, solved):
    plan = solved(tasks["single link"], 2)
    assert plan.complete
    assert plan.provenance.stopped is None
