"""Ctrl-C while casadi and the solvers are at work: it is not lost, and what was found is kept."""

import contextlib
import os
import signal
import threading
import time
from dataclasses import replace

import pytest
from quietarm.ocp import Floor, Plan, energy_floor, plan_move
from quietarm.ocp.interrupts import keep_interrupts


def _swallow_ctrl_c():
    """What casadi does: Ctrl-C comes, and is lost."""
    with contextlib.suppress(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)  # Python runs the handler at the next opportunity, at once


def test_a_swallowed_ctrl_c_comes_after_the_block_in_place_of_errors_that_it_causes():
    def work():
        with keep_interrupts():
            _swallow_ctrl_c()
            raise AttributeError("'NoneType' object has no attribute 'T'")

    with pytest.raises(KeyboardInterrupt):
        work()


WORK = {
    "plan": (Plan, lambda task: plan_move(task, starts=1000, solver="ipopt")),
    "floor": (Floor, lambda task: energy_floor(task, starts=1000)),
}


@pytest.mark.parametrize("name", WORK)
def test_ctrl_c_ends_a_solve_and_keeps_the_best_of_the_starts_until_then(tasks, tmp_path, name):
    # Of a thousand starts: they do not end before the signal. One that comes before the first has
    # ended ends the call, and a later one is tried.
    kind, work = WORK[name]
    task, answer, delay = replace(tasks["single link"], torque_limit=0.5), None, 0.5
    while answer is None:
        timer = threading.Timer(delay, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with contextlib.suppress(KeyboardInterrupt):
            answer = work(task)
        delay *= 2
    assert not answer.complete
    assert answer.provenance.stopped.endswith(" starts")
    assert answer.residual < 1e-8
    assert answer.energy < 0.09115  # the plain cycloid's, docs/physics.md
    answer.save(tmp_path / "answer.json")
    assert kind.load(tmp_path / "answer.json") == answer
