"""Sweeps of a front that are interrupted, or lose a solve."""

import signal
from types import SimpleNamespace

import numpy as np
from front_moves import CASES

from ocp import (
    CycloidPolynomial,
    Front,
    SolverFailedError,
    epsilon_front,
    weighted_front,
)
from ocp.base.status import SolveStatus
from ocp.front import checking, weighted
from ocp.front.ends import find_ends
from ocp.front.sweep import Sweep


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

    def failing(self, guess, residual_limit=np.inf, **rest):
        found = whole(self, guess, residual_limit, **rest)
        if 4e-3 < residual_limit < 6e-3:
            object.__setattr__(found, "status", SolveStatus.NUMERICAL_TROUBLE)
        solved.append(residual_limit)
        return found

    monkeypatch.setattr(Sweep, "solve", failing)
    front = epsilon_front(task, profile, bound=bound, points=8)
    assert front.failed == len(front.failures) > 0
    assert len(front.points) + front.failed == 8
    for failure in front.failures:
        assert 4e-3 < failure.asked["residual_limit"] < 6e-3
        assert failure.reason == SolveStatus.NUMERICAL_TROUBLE.text
    assert min(solved) < 4e-3 < 6e-3 < max(solved)


def test_ctrl_c_keeps_what_was_found(monkeypatch):
    task, bound = CASES["arm"]
    calls = []

    def interrupt(done, total):
        calls.append((done, total))
        if done == 4:
            raise KeyboardInterrupt

    front = epsilon_front(task, CycloidPolynomial(3), bound=bound, points=8, report=interrupt)
    assert not front.complete
    assert 3 <= len(front.points) < 8
    assert calls[-1] == (4, 8)
