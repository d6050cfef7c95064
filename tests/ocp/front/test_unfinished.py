"""Sweeps of a front that are interrupted, or lose a solve."""

import signal
from dataclasses import replace
from types import SimpleNamespace

import pytest
from front_moves import CASES
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    SolverFailedError,
    epsilon_front,
    weighted_front,
)
from quietarm.ocp.base.status import SolveStatus
from quietarm.ocp.front import checking, weighted
from quietarm.ocp.front.ends import find_ends
from quietarm.ocp.front.sweep import InterruptedSolveError, Sweep
from quietarm.ocp.program.stack import Stack


def test_an_end_that_fails_its_check_can_be_kept(monkeypatch, tmp_path):
    task, bound = CASES["arm"]

    def failing(*_, **__):
        raise SolverFailedError("why")

    monkeypatch.setattr(checking, "verified", failing)  # the still end is checked on its own
    for method in (epsilon_front, weighted_front):
        front = method(task, CycloidPolynomial(3), bound=bound, points=2)
        assert (len(front.points), len(front.failures)) == (1, 1)
        assert front.failures[0].asked["residual_limit"] > front.points[0].residual
        front.save(tmp_path / "front.json")
        assert Front.load(tmp_path / "front.json") == front


def test_ctrl_c_while_points_are_checked_keeps_what_there_is_time_for(monkeypatch):
    task, bound = CASES["arm"]
    checked, clock = checking.checked, [0.0]

    def slow(sweep, found, asked):
        if not clock[0]:
            signal.raise_signal(signal.SIGINT)
        clock[0] += 0.4 * checking._TIME_AFTER_CTRL_C
        return checked(sweep, found, asked)

    def first(sweep):
        ends = find_ends(sweep)
        monkeypatch.setattr(checking, "checked", slow)
        return ends

    monkeypatch.setattr(checking, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    monkeypatch.setattr(weighted, "find_ends", first)
    front = weighted_front(task, CycloidPolynomial(3), bound=bound, points=10)
    assert not front.complete
    # the still end, checked before; the point at which Ctrl-C came; those that were begun after
    # 0, 0.4 and 0.8 of the time that there is then
    assert len(front.points) == 1 + 1 + 3


def test_a_solve_that_fails_does_not_end_the_sweep(monkeypatch):
    task, bound = CASES["arm"]
    profile, whole = CycloidPolynomial(3), Sweep.solve
    solved = []

    def failing(self, rows, **rest):
        limits = [ask.limits["residual"] for _, ask in rows]
        solved.extend(limits)
        return [
            replace(one, status=SolveStatus.NUMERICAL_TROUBLE) if 4e-3 < limit < 6e-3 else one
            for one, limit in zip(whole(self, rows, **rest), limits, strict=True)
        ]

    monkeypatch.setattr(Sweep, "solve", failing)
    front = epsilon_front(task, profile, bound=bound, points=8)
    assert front.failed == len(front.failures) > 0
    assert len(front.points) + front.failed == 8
    for failure in front.failures:
        assert 4e-3 < failure.asked["residual_limit"] < 6e-3
        assert failure.reason == SolveStatus.NUMERICAL_TROUBLE.text
    assert min(solved) < 4e-3 < 6e-3 < max(solved)


# The solver runs for the limits between the ends first, then for all points.
@pytest.mark.parametrize("run", [0, 1])
def test_ctrl_c_keeps_what_was_solved(monkeypatch, run):
    task, bound = CASES["arm"]
    runs, whole = [], Sweep.solve

    def interrupted(self, rows, **rest):
        found = whole(self, rows, **rest)
        runs.append(len(found))
        if len(runs) <= run:
            return found
        half, stopped = len(found) // 2, SolveStatus.ITERATION_LIMIT
        rest_of = [replace(one, status=stopped) for one in found[half:]]
        raise InterruptedSolveError([*found[:half], *rest_of])

    monkeypatch.setattr(Sweep, "solve", interrupted)
    front = epsilon_front(task, CycloidPolynomial(3), bound=bound, points=20)
    assert len(runs) == run + 1
    assert not front.complete
    assert 2 < len(front.points) < 20
    assert front.failures == ()  # those not solved yet are none


@pytest.mark.parametrize("solver", ["sqp", "ipopt"])
def test_ctrl_c_within_a_run_of_the_solver_keeps_the_ends(monkeypatch, solver):
    task, bound = CASES["arm"]
    whole, calls = Stack.evaluate, []

    def evaluate(self, *arguments):
        calls.append(self)
        if len(calls) == 3:
            signal.raise_signal(signal.SIGINT)
        return whole(self, *arguments)

    def watch(done, total):
        if done == 2:  # the ends are there, and the solver runs next
            monkeypatch.setattr(Stack, "evaluate", evaluate)

    profile = CycloidPolynomial(3)
    front = epsilon_front(task, profile, bound=bound, points=8, solver=solver, report=watch)
    assert len(calls) >= 3
    assert not front.complete
    assert 2 <= len(front.points) < 8  # IPOPT ends the row that it has begun
