"""Sweeps of a front that are interrupted, lose a process or a solve, or use several processes."""

import multiprocessing
import os
import signal
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from front_moves import CASES

from ocp import (
    CycloidPolynomial,
    Front,
    SolverFailedError,
    epsilon_front,
    resimulate,
    weighted_front,
)
from ocp.base.status import SolveStatus
from ocp.front import checking, weighted
from ocp.front.ends import find_ends
from ocp.front.sweep import Sweep
from ocp.plan.verification import STILL


def test_processes_find_the_same_front():
    task, bound = CASES["arm"]
    alone, shared = (
        epsilon_front(task, CycloidPolynomial(3), bound=bound, points=6, workers=workers)
        for workers in (1, 2)
    )
    np.testing.assert_allclose(shared.energies, alone.energies, rtol=1e-5)
    np.testing.assert_allclose(shared.residuals, alone.residuals, rtol=1e-5, atol=STILL)


def test_ctrl_c_ends_processes_soon_and_keeps_what_they_found(monkeypatch):
    # so that a busy machine does not cost what a process found
    monkeypatch.setattr("ocp.base.workers._PATIENCE", 120.0)
    task, bound = CASES["arm"]
    sent = []

    def interrupt(done, total):
        if done >= 8 and not sent:
            sent.append(done)
            signal.raise_signal(signal.SIGINT)

    front = epsilon_front(
        task, CycloidPolynomial(3), bound=bound, points=5000, workers=2, report=interrupt
    )
    assert len(front.points) < 2500  # of 5000: it did not go on to the end
    assert multiprocessing.active_children() == []
    assert not front.complete
    assert len(front.points) > 2  # more than the ends
    for point in front.points[1:-1:5]:
        motion = resimulate(task, front.profile, point.coefficients)
        assert (point.residual, point.energy) == (motion.residual, motion.energy)


@pytest.mark.skipif(sys.platform == "win32", reason="needs SIGKILL")
def test_a_process_that_dies_costs_its_own_stretch_only():
    task, bound = CASES["arm"]
    killed = []

    def report(done, total):
        children = multiprocessing.active_children()
        if children and not killed:
            child = min(children, key=lambda one: int(one.name.rpartition("-")[2]))
            killed.append(child.pid)
            os.kill(child.pid, signal.SIGKILL)

    front = epsilon_front(
        task, CycloidPolynomial(3), bound=bound, points=400, workers=2, report=report
    )
    assert len(killed) == 1
    assert len(front.failures) == 199  # of 398 between the ends
    for failure in front.failures:
        # the first stretch begins at the cheap end
        assert failure.asked["residual_limit"] > front.points[-2].residual
        assert failure.reason == (
            "its process died (killed by SIGKILL); where memory ran short, give fewer workers"
        )
    assert len(front.points) == 201


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
    # both ends; the point at which Ctrl-C came; those begun 0, 0.4 and 0.8 of the time after it
    assert len(front.points) == 2 + 1 + 3


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
